"""Motions of a station along known directions, and assessments of all directions of them."""

from datetime import UTC, datetime

import numpy as np
from nominal import Config

from rockpulse import BlockSettings, ModelSettings, RecordSettings, SearchSettings
from rockpulse.assessment.assessment import assess
from rockpulse.record.record import Record
from rockpulse.selection.directions import conditioned_motions, plan_motions

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)
DT = 0.01
TIME = DT * np.arange(1200)
#: A burst along the azimuth of 40 degrees, and a tenth of it across.
ALONG = 4.5 * np.sin(2.0 * np.pi * TIME) * np.exp(-(((TIME - 5.0) / 1.5) ** 2))
ACROSS = 0.1 * 4.5 * np.cos(3.0 * np.pi * TIME) * np.exp(-(((TIME - 5.0) / 1.5) ** 2))
POLARISED = 40.0
WALL = BlockSettings(name="wall", width=0.4, height=3.0)
TOWER = BlockSettings(name="tower", width=3.0, height=9.0)


def channel(azimuth, station="CCC", across=ACROSS, **options):
    turn = np.radians(azimuth - POLARISED)
    code = f"{azimuth:g}"
    known = {"id": f"CI.{station}..{code}@20190706T031953", "network": "CI", "station": station, "channel": code}
    known |= {"start_time": START, "processed": True, "source": f"{station}.v1", "orientation": "horizontal"}
    return Record(ALONG * np.cos(turn) + across * np.sin(turn), DT, azimuth=azimuth, **known | options)


def upwards(station="CCC"):
    return channel(0.0, station, id=f"{station}.up", channel="Up", orientation="vertical")


def config(components, blocks=(WALL, TOWER), models=None, **records):
    records, search = RecordSettings(components=components, **records), SearchSettings(points=8)
    return Config(bodies=blocks, records=records, models=models or ModelSettings(), search=search)


def sweep(*records, **options):
    return assess(records, config("sweep", **{"azimuth_step": 20.0} | options))


def motions_under(records, options):
    """The motions that come of all channels, and the names of what they come of."""
    planned, failures = plan_motions(records, options)
    assert not failures
    motions = [(one.name, motion) for one in planned for motion in conditioned_motions(one, options)]
    return [motion for _, motion in motions], [name for name, _ in motions]
