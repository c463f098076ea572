"""The table of intensity measures: what it computes, and that every part takes its rows."""

from functools import cache

import numpy as np
import pytest
from nominal import scene_of_record

import rockpulse as rp
from rocking.body.block import Block
from rocking.march.demand import ground_demand
from rockpulse.config.configuration import Config
from rockpulse.readers import UNITS
from rockpulse.record.intensity import fajfar_index, largest_change, pgv, spectral_acceleration, spectrum_intensity
from rockpulse.record.measures import DEMAND, FRAGILITY, HAZARD, MEASURES, ROWS, SCALING, STORED
from rockpulse.studies.fragility.motion_capacity import record_measures

BLOCKS = Block(half_width=[0.3, 0.5], half_height=[1.5, 1.9365])


@cache
def scene(factor=1.0):
    t = np.arange(0.0, 6.0, 0.02)
    ground = factor * 2.0 * np.sin(2.0 * np.pi * t) * np.exp(-((t - 3.0) ** 2))
    return scene_of_record(rp.Record(ground, dt=0.02, id="pulse", processed=True), Config())


@pytest.mark.sweep
def test_every_measure_is_proportional_to_the_factor():
    one, three = (record_measures(scene(factor), BLOCKS, FRAGILITY) for factor in (1.0, 3.0))
    assert np.shape(one) == (len(FRAGILITY), 2)
    assert np.all(np.greater(one, 0.0))
    np.testing.assert_allclose(three, 3.0 * np.array(one), rtol=1e-9)


@pytest.mark.sweep
def test_measures_against_their_definitions():
    motion = scene()
    value = dict(zip(FRAGILITY, record_measures(motion, BLOCKS, FRAGILITY), strict=True))
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
    motion = scene_of_record(
        rp.Record(np.r_[np.full(21, 3.0), np.zeros(400)], dt=0.01, id="one", processed=True), Config()
    )
    names = ("demand_largest", "demand_rms", "demand_cubic", "demand_build_up")
    largest, rms, cubic, build_up = record_measures(motion, BLOCKS, names)
    np.testing.assert_allclose(cubic, largest)
    np.testing.assert_allclose(build_up, largest)
    np.testing.assert_allclose(rms, largest / np.sqrt(6.0))


def test_a_quadratic_measure_serves_nothing_that_scales():
    for name, one in MEASURES.items():
        assert one.proportional or name not in {*FRAGILITY, *DEMAND, *HAZARD, *SCALING}, name


def test_what_knows_no_body_depends_on_the_record_alone():
    """Hazards and scaling, and the variables along records, have no body to give."""
    assert not any(MEASURES[name].of_bodies for name in (*HAZARD, *SCALING, *(row.name for row in STORED)))


def test_hazards_are_given_in_units_of_the_kind_of_the_measure():
    kinds = {name: MEASURES[name].known_units.keys() & {"g", "cm/s"} for name in ("pga", "sa_0.5", "pgv", "si")}
    assert kinds == {"pga": {"g"}, "sa_0.5": {"g"}, "pgv": {"cm/s"}, "si": {"cm/s"}}
    assert all(MEASURES[name].openquake in {"", *MEASURES[name].known_units} for name in HAZARD)
    assert all(factor == pytest.approx(UNITS[unit]) for unit, factor in MEASURES["pga"].known_units.items())


def test_a_member_of_a_family_is_named_by_its_period():
    one = ROWS["sa"].at(0.75)
    assert (one.name, one.title, one.long_name) == ("sa_0.75", "Sa(0.75 s)", "Sa(0.75 s), 5 %")
    assert one.column == ("Sa(0.75 s)", "g", 9.80665)
