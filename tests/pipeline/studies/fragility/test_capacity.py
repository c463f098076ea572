"""The capacities of bodies under one motion: qualities of the record, and its reverse."""

from types import SimpleNamespace

import numpy as np
import pytest

import rockpulse as rp
from rockpulse.assessment.scene import prepare
from rockpulse.config.configuration import Config
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.studies.fragility.capacity import _reversed, record_qualities


def scene():
    t = np.arange(0.0, 6.0, 0.01)
    ground = 2.0 * np.sin(2.0 * np.pi * t) * np.exp(-((t - 3.0) ** 2))
    return prepare(rp.Record(ground, dt=0.01, id="pulse", processed=True), Config())


def test_qualities_of_a_sine():
    t = np.arange(0.0, 10.005, 0.01)
    found = record_qualities(prepare(rp.Record(np.sin(np.pi * t), dt=0.01, id="sine", processed=True), Config()))
    assert found["duration"] == pytest.approx(9.0, abs=0.5)
    assert found["period"] == pytest.approx(4.0, rel=0.01)  # the velocity of a sine from rest is (1 - cos)/pi
    assert found["strong_half_waves"] == 10


def test_strong_half_waves_are_those_above_half_the_largest_of_the_intense_phase():
    motion = scene()
    sizes = [0.9, 0.1, -0.2, 0.10001, 0.19, 0.05, 0.9]
    waves = SimpleNamespace(between=lambda start, end: SimpleNamespace(impulse=np.array(sizes[int(start) : int(end)])))
    known = SimpleNamespace(record=motion.record, waves=waves)
    for start, end, count in ((1, 6, 3), (0, 6, 1), (1, 2, 1), (1, 1, 0)):
        known.phase = SimpleNamespace(start=start, end=end, duration=end - start)
        found = record_qualities(known)
        assert (found["strong_half_waves"], found["duration"]) == (count, end - start)
        assert found["period"] == pytest.approx(2.0 * np.pi * pgv(motion.record) / motion.record.pga)


def test_the_reverse_of_a_motion_has_the_half_waves_of_its_record():
    back = _reversed(scene())
    assert np.array_equal(back.record.acceleration, -scene().record.acceleration)
    again = half_waves(back.record)
    np.testing.assert_allclose(back.waves.impulse, again.impulse)
    np.testing.assert_allclose(back.waves.peak, again.peak)
