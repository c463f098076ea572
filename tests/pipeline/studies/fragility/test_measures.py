"""The table of intensity measures."""

from types import SimpleNamespace

import numpy as np
import pytest

import rockpulse as rp
from rocking.body.block import Block
from rocking.march.demand import ground_demand
from rockpulse.assessment.scene import prepare
from rockpulse.config.configuration import Config
from rockpulse.config.fragility_settings import MEASURES as WORDS
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import fajfar_index, largest_change, pgv, spectral_acceleration, spectrum_intensity
from rockpulse.studies.fragility.capacity import _reversed
from rockpulse.studies.fragility.measures import MEASURES, record_measures, record_qualities

BLOCKS = Block(half_width=[0.3, 0.5], half_height=[1.5, 1.9365])


def scene(factor=1.0):
    t = np.arange(0.0, 6.0, 0.01)
    ground = factor * 2.0 * np.sin(2.0 * np.pi * t) * np.exp(-((t - 3.0) ** 2))
    return prepare(rp.Record(ground, dt=0.01, id="pulse", processed=True), Config())


def test_the_words_of_the_configuration_are_the_names_of_the_table():
    assert tuple(MEASURES) == WORDS


@pytest.mark.parametrize("name", MEASURES)
def test_every_measure_is_proportional_to_the_factor(name):
    one, three = (record_measures(scene(factor), BLOCKS, (name,)) for factor in (1.0, 3.0))
    assert one.shape == (1, 2)
    assert np.all(one > 0.0)
    np.testing.assert_allclose(three, 3.0 * one, rtol=1e-9)


def test_bodies_are_put_together_in_measures_without_a_unit_only():
    together = {name for name, measure in MEASURES.items() if measure.dimensionless}
    assert {"velocity_ratio"} <= together
    assert together.isdisjoint({"pga", "pgv"})


def test_measures_against_their_definitions():
    motion = scene()
    value = dict(zip(MEASURES, record_measures(motion, BLOCKS, tuple(MEASURES)), strict=True))
    capacity = BLOCKS.gravity * np.tan(BLOCKS.alpha_c)
    np.testing.assert_allclose(value["uplift_ratio"], motion.record.pga / capacity)
    np.testing.assert_allclose(value["velocity_ratio"], BLOCKS.p * value["pgv"] / capacity)
    np.testing.assert_allclose(value["impulse"], np.max(np.abs(motion.waves.impulse)))
    np.testing.assert_allclose(value["impulse_ratio"], value["impulse"] / BLOCKS.critical_impulse)
    record = motion.record
    for name, expected in {
        "pga": record.pga,
        "pgv": pgv(record),
        "si": spectrum_intensity(record),
        "fajfar": fajfar_index(record),
        "sa_0.5": spectral_acceleration(record, 0.5),
        "sa_1": spectral_acceleration(record, 1.0),
        "sa_2": spectral_acceleration(record, 2.0),
        "si_ratio": BLOCKS.p * spectrum_intensity(record) / capacity,
        "change_ratio": BLOCKS.p * [largest_change(record, 2.0 / p) for p in BLOCKS.p] / capacity,
    }.items():
        np.testing.assert_allclose(value[name], np.broadcast_to(expected, 2), err_msg=name)
    demand = ground_demand(BLOCKS, record.acceleration, record.dt)
    assert np.all(demand.lobes[:, 6] > 0.0)  # more than six of them
    np.testing.assert_allclose(value["demand_largest"], demand.lobes[:, 0])
    np.testing.assert_allclose(value["demand_rms"], np.sqrt(np.sum(demand.lobes[:, :6] ** 2, axis=1) / 6.0))
    np.testing.assert_allclose(value["demand_cubic"] ** 3, np.sum(demand.lobes**3, axis=1))
    shares = (0.9 * BLOCKS.restitution[:, np.newaxis]) ** np.arange(demand.lobes.shape[1])
    np.testing.assert_allclose(value["demand_build_up"], np.sum(shares * demand.lobes, axis=1))
    # The norms of the lobes lie in the order of norms: mean of six below the largest, sums above it.
    assert np.all(value["demand_rms"] < value["demand_largest"])
    assert np.all(value["demand_largest"] < value["demand_cubic"])
    assert np.all(value["demand_cubic"] < value["demand_build_up"])


def test_one_pulse_has_one_lobe_and_all_norms_agree():
    motion = prepare(rp.Record(np.r_[np.full(21, 3.0), np.zeros(400)], dt=0.01, id="one", processed=True), Config())
    names = ("demand_largest", "demand_rms", "demand_cubic", "demand_build_up")
    largest, rms, cubic, build_up = record_measures(motion, BLOCKS, names)
    np.testing.assert_allclose(cubic, largest)
    np.testing.assert_allclose(build_up, largest)
    np.testing.assert_allclose(rms, largest / np.sqrt(6.0))


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
