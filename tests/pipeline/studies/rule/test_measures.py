"""Other measures of a motion, each against its definition or a published identity."""

import numpy as np
import pytest

import rockpulse as rp
from rocking import Block
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.studies.rule.measures import ISHIYAMA, ishiyama_velocity, other_measures

BODIES = Block(half_width=[0.1, 0.3, 0.5], half_height=[0.8, 1.2, 3.0])


def motion():
    time = np.arange(0.0, 8.0, 0.01)
    samples = 3.0 * np.sin(4.0 * time) * np.exp(-0.2 * time)
    return rp.Record(samples, dt=0.01, id="motion", processed=True)


def test_ishiyamas_root_is_housners_speed_of_a_rectangle():
    # VALIDATION V26: an identity.
    expected = 2.0 * BODIES.gravity * np.sin(0.5 * BODIES.alpha_c) / (BODIES.p * np.cos(BODIES.alpha_c))
    assert ishiyama_velocity(BODIES) == pytest.approx(expected, rel=1e-12)
    by_radius = np.sqrt(8.0 * BODIES.gravity * BODIES.radius * (1.0 - np.cos(BODIES.alpha_c)) / 3.0) / np.cos(
        BODIES.alpha_c
    )
    assert ishiyama_velocity(BODIES) == pytest.approx(by_radius, rel=1e-12)


def test_every_measure_is_proportional_to_the_record():
    record = motion()
    twice = rp.Record(2.0 * record.acceleration, dt=0.01, id="twice", processed=True)
    one, two = (other_measures(BODIES, some, half_waves(some)) for some in (record, twice))
    for name in set(one) - {"single_ratio"}:
        assert two[name] == pytest.approx(2.0 * one[name]), name
    safety = rp.models.critical_scale(BODIES, record.acceleration, 0.01, factor_max=10.0).safety_factor
    assert one["single_ratio"] == pytest.approx(1.0 / safety)
    capacity = BODIES.gravity * np.tan(BODIES.alpha_c)
    assert one["uplift_ratio"] == pytest.approx(record.pga / capacity)
    assert one["velocity_ratio"] == pytest.approx(BODIES.p * pgv(record) / capacity)
    assert one["ishiyama_ratio"] == pytest.approx(pgv(record) / (ISHIYAMA * ishiyama_velocity(BODIES)))
