"""Results shared by many tests: five short records on two bodies, by every study, made once for all workers."""

import fcntl
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from assess_command import write_at2

from rockpulse.cli import main

DT = 0.01
TIME = DT * np.arange(400)

CONFIGURATION = """
[search]
intervals = true
points = 24

[models]
use = ["resonance", "sequence", "impulsive", "linear", "nonlinear"]

[calibration]
bootstrap = 100

[fragility]
limit_states = ["uplift", "overturning"]
measures = ["pga", "velocity_ratio"]
data = "ida"
factors = [0.01, 100.0]
pga_min = 0.0

[hazard]
k0 = 1e-4
k = 2.5

[check]
ag = 0.25
f0 = 2.4
tc_star = 0.35

[[block]]
name = "stele"
width = 0.3
height = 2.4

[[block]]
name = "pier"
width = 1.0
height = 3.0

[[demand]]
name = "ULS"
measure = "pga"
value = 3.0
"""


#: The command that writes each file.
VERBS = {
    "results": ("assess", "records"),
    "site": ("calibrate", "records"),
    "fragility": ("fragility", "records"),
    "risk": ("risk", "fragility.h5"),
}


def golden(folder: Path) -> SimpleNamespace:
    """The results in a folder: made by the worker that comes first, while the others wait for its lock.

    `records`, the folder of five AT2 files, each of an earthquake of its own; `config`, the configuration of every
    study; `results`, `site`, `fragility` and `risk`, the files that the verbs wrote. No test writes to them.
    """
    paths = {name: folder / f"{name}{'.csv' if name == 'risk' else '.h5'}" for name in VERBS}
    found = SimpleNamespace(folder=folder, records=folder / "records", config=folder / "site.toml", **paths)
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "made").exists():
            make(found)
            (folder / "made").touch()
    return found


def make(found: SimpleNamespace) -> None:
    found.records.mkdir()
    for number, frequency in enumerate((0.7, 0.9, 1.0, 1.2, 1.4)):
        burst = np.sin(2.0 * np.pi * frequency * TIME) * np.exp(-(((TIME - 2.0) / 0.7) ** 2))
        event = f"Quake {'ABCDE'[number]}, 6/12/{1980 + number}"
        write_at2(found.records / f"burst{number}.AT2", (0.30 + 0.05 * number) * burst, event=event)
    found.config.write_text(CONFIGURATION)
    for name, (verb, source) in VERBS.items():
        wanted = [verb, found.folder / source, "--config", found.config, "-o", getattr(found, name), "--quiet"]
        assert main([str(word) for word in wanted]) == 0, name
