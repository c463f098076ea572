"""Warming up: afterwards neither the samples nor a rotated pair needs a kernel that is not there."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

#: In a process of its own: here, other tests have loaded kernels already. Each kind of work is done in a fork of it.
SCRIPT = """
import json
import os
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import rockpulse as rp
from rockpulse import ModelSettings, RecordSettings, SearchSettings
from rockpulse.assessment.assessment import Assessment
from rockpulse.run.tasks import warm_up
from rockpulse.run.analysis import run
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration

ROOT = Path(import_module("rocking").__file__).parent
KERNELS = [".".join(path.relative_to(ROOT.parent).with_suffix("").parts) for path in ROOT.rglob("[a-z]*.py")]
BLOCKS = [rp.models.Block(half_width=0.2 + 0.2 * i, half_height=1.0 + i) for i in range(3)]


def compiled():
    found = {}
    for module in KERNELS:
        for name, value in vars(import_module(module)).items():
            if hasattr(value, "nopython_signatures"):
                found[name] = len(value.signatures)
    return found


def work(kind):
    read = [channel for name in ("CICCC.RAW", "CITOW2.RAW") for channel in rp.read(Path(sys.argv[1]) / name)]
    records = [replace(channel, acceleration=channel.acceleration[2700:3000]) for channel in read]
    blocks = dict(zip("abc", BLOCKS))
    if kind in ("calibrate", "fragility"):
        analysis = {"calibrate": SiteCalibration, "fragility": FragilityAnalysis}[kind](rp.Config(), blocks)
        warm_up(type(analysis), analysis.config)
        yield
        run(analysis, records[:1] if kind == "calibrate" else records[1:3])
        return
    everything = ("resonance", "sequence", "balanced", "conservative", "impulsive", "linear", "nonlinear")
    config = rp.Config()
    if kind == "everything":
        config = rp.Config(
            records=RecordSettings(include_vertical=True, components="strongest"),
            models=ModelSettings(use=everything, histories=True),
            search=SearchSettings(models=everything, intervals=True, points=16, step=1.2),
        )
    warm_up(Assessment, config)
    yield
    rp.assess(records, config, bodies=blocks)
    rp.assess(records[:1], config, bodies={"a": rp.models.Block(0.6, 4.0)})


for module in KERNELS:
    import_module(module)
for kind in sys.argv[2:]:
    child = os.fork()
    if not child:
        stages = work(kind)
        next(stages)
        warm = compiled()
        next(stages, None)
        print(json.dumps([warm, compiled()]), flush=True)
        os._exit(0)
    os.waitpid(child, 0)
"""


@pytest.mark.slow
def test_nothing_is_compiled_after_warming_up(samples):
    kinds = ("default", "calibrate", "fragility", "everything")
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, samples, *kinds],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    lines = run.stdout.splitlines()
    assert len(lines) == len(kinds), run.stderr
    for kind, (warm, after) in zip(kinds, map(json.loads, lines), strict=True):
        assert sum(warm.values()) > 0, kind
        assert after == warm, kind
