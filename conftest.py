"""The names and files that the examples in the docstrings use."""

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

FILES = {
    "site.toml": """
[hazard]
k0 = 1e-4
k = 2.5

[check]
ag = 0.25
f0 = 2.4
tc_star = 0.35

[[block]]
name = "pier"
width = 1.0
height = 4.0
""",
    "curve.csv": "pga [g],rate\n0.1,0.01\n0.4,0.0005\n",
    "curves.csv": """# investigation_time=1.0, imt='PGA'
lon,lat,depth,poe-0.1,poe-0.4
12,42,0,0.02,0.001
13,42,0,0.03,0.002
""",
    "velocity.csv": "time [s],velocity [m/s]\n0.00,0.0\n0.01,0.1\n0.02,0.0\n",
    "inventory.csv": "name,width [m],height [m]\nfirst,0.6,3.0\nsecond,0.5,4.0\n",
    "rocks.csv": "name,width [m],height [m]\nfirst,0.6,3.0\nsecond,0.5,4.0\n",
    "bodies.csv": "name,width [cm],height [m],restitution\nstatue,50,1.8,\ncabinet,40,2,0.85\n",
    "history.csv": "acceleration\n" + "".join(f"{100.0 * np.sin(0.1 * step):.1f}\n" for step in range(400)),
}


class Examples(NamedTuple):
    """The folder of the files, and the names."""

    folder: Path
    names: dict[str, object]


@pytest.fixture(scope="session")
def example_names(tmp_path_factory: pytest.TempPathFactory) -> Examples:
    """Five short records of 0.3 to 0.5 g, two bodies, and every study of them, also as files in a new folder."""
    import rocking
    import rockpulse as rp

    time = np.arange(0.0, 8.0, 0.01)
    envelope = 9.80665 * np.exp(-(((time - 4.0) / 1.2) ** 2))
    records = [
        rp.Record(
            (0.30 + 0.05 * number) * envelope * np.sin(2.0 * np.pi * frequency * time),
            dt=0.01,
            id=f"burst.{number}" if number < 4 else "CI.CCC",
            event=f"Quake {number}, 6/12/{1980 + number}",
            processed=True,
            orientation="horizontal",
            azimuth=90.0 * (number % 2),
        )
        for number, frequency in enumerate((0.7, 0.9, 1.0, 1.2, 1.4))
    ]
    config = rp.Config(
        bodies=[rp.BlockSettings("stele", width=0.3, height=2.4), rp.BlockSettings("pier", width=1.0, height=4.0)],
        uncertainty=rp.UncertaintySettings(spectrum="all"),
        fragility=rp.FragilitySettings(
            limit_states=("uplift", "overturning"),
            measures=("pga", "pgv"),
            data="ida",
            factors=(0.1, 10.0),
            overturning_model="lognormal",
        ),
        calibration=rp.CalibrationSettings(quantile=0.5, bootstrap=100),
        hazard=rp.HazardSettings(k0=1e-4, k=2.5),
    )
    trees = {
        "results": rp.assess(records, config),
        "site": rp.calibrate(records, config),
        "fragility": rp.fragility(records, config),
    }
    folder = tmp_path_factory.mktemp("examples")
    (folder / "data").symlink_to(Path(__file__).parent / "data", target_is_directory=True)
    for name, tree in trees.items():
        rp.save(tree, folder / f"{name}.h5")
    for copy in ("before.h5", "after.h5"):
        shutil.copy(folder / "results.h5", folder / copy)
    shutil.copy(folder / "site.h5", folder / "design.h5")
    shutil.copy(folder / "data" / "samples" / "records" / "CICLC.v1", folder)
    (folder / "records").mkdir()
    rp.write(records, folder / "records", "at2")
    for name, text in FILES.items():
        (folder / name).write_text(text)
    names = {"record": records[2], "records": records, "config": config, "pier": rocking.Block(1.0, 4.0)}
    names["pair"] = rp.Pair(records[2], records[3])
    return Examples(folder, {"np": np, "rp": rp, "rocking": rocking, **names, **trees})


@pytest.fixture(autouse=True)
def _example(request: pytest.FixtureRequest) -> Iterator[None]:
    """Run an example of a docstring in the folder of the examples, with their names."""
    if not isinstance(request.node, pytest.DoctestItem):
        yield
        return
    examples = request.getfixturevalue("example_names")
    request.node.dtest.globs.update(examples.names)
    before = Path.cwd()
    os.chdir(examples.folder)
    yield
    os.chdir(before)
