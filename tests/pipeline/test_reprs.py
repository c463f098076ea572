"""The repr of every public object is one line of at most 120 characters, whatever it holds."""

import dataclasses

import numpy as np
import pytest

import rockpulse as rp
from rockpulse import models

TIME = 0.01 * np.arange(400)
BLOCKS = models.Block(width=np.linspace(0.4, 1.0, 200), height=np.full(200, 4.0), log=False)
RECORD = rp.Record(
    3.0 * np.sin(6.0 * TIME), dt=0.01, id="a long name of a network.station.location.channel@20091231T235959" * 2
)
LEVELS, RATES = np.geomspace(0.1, 10.0, 50), np.geomspace(1e-1, 1e-6, 50)
HAZARD = rp.HazardCurve("pga", LEVELS, RATES)


def sections():
    """Every section of a configuration, its texts as long as they may be."""
    needed = {"name": "wall", "value": 3.0, "width": 0.5, "height": 4.0, "path": "records/" + "a" * 200 + ".csv"}
    for cls in (getattr(rp, name) for name in rp.__all__ if name.endswith("Settings")):
        fields = dataclasses.fields(cls)
        if cls in (rp.BlockSettings, rp.DemandSettings):
            yield cls(**{item.name: needed[item.name] for item in fields if item.name in needed})
        elif all(item.default is not dataclasses.MISSING for item in fields):
            yield cls()


INSTANCES = [
    *sections(),
    RECORD,
    rp.half_waves(RECORD),
    rp.intense_phase(RECORD),
    rp.Config(bodies=tuple(rp.BlockSettings(f"body {n}", width=0.5, height=4.0) for n in range(50))),
    rp.RecordSettings(paths=["records/" + "a" * 200] * 9, confirm=["x" * 90]),
    rp.DesignSpectrum(np.arange(1.0, 41.0), np.linspace(0.8, 1.0, 5), np.ones((40, 5)), 0.2, 0.1, 5),
    HAZARD,
    rp.PowerLawHazard(1e-4, 2.5),
    rp.SiteHazards((HAZARD,) * 40, np.arange(40), np.full(40, np.nan)),
    rp.BatchOptions(written=("a" * 200,)),
    rp.BatchReport(seconds={"read": 1.0 / 3.0, "condition": 1.0 / 3.0, "solve": 2.0 / 3.0, "pack": 1.0 / 7.0}),
    rp.Pair(RECORD, dataclasses.replace(RECORD, id=RECORD.id + "2")),
    rp.load_rule(),
    BLOCKS,
    models.Uncertainty(),
    models.ImpulseSequence(np.ones(99), np.full(99, 0.1), interval=0.1, duration=10.0),
    models.ground_demand(BLOCKS, RECORD.acceleration, 0.01),
    models.resonance(BLOCKS, 0.3, 20),
    models.resonance(BLOCKS, 0.3, 20).half_cycles,
    models.Outcome.ROCKS,
    rp.plots.ModelHistory("linear", TIME, TIME),
]


@pytest.mark.parametrize("thing", INSTANCES, ids=lambda thing: type(thing).__name__)
def test_a_repr_is_one_line(thing):
    text = repr(thing)
    assert type(thing).__name__ in text
    assert "\n" not in text
    assert len(text) <= 120


def test_a_section_shows_what_is_not_the_default():
    assert repr(rp.RecordSettings(units="g", structural=True)) == "RecordSettings(structural=True, units='g')"
