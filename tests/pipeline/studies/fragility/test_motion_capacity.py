"""The capacities of bodies under one motion: qualities of the record, and its reverse.

Fragility of records that were chosen elsewhere, with weights.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bursts import packet
from nominal import scene_of_record

import rockpulse as rp
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.studies.fragility.curves import fit_curve
from rockpulse.studies.fragility.ensemble import stored_ensemble
from rockpulse.studies.fragility.likelihood import ABOVE, NOT_ABOVE, Observations
from rockpulse.studies.fragility.motion_capacity import _reversed, reached_at, record_qualities, scale_capacities


def scene():
    t = np.arange(0.0, 6.0, 0.01)
    ground = 2.0 * np.sin(2.0 * np.pi * t) * np.exp(-((t - 3.0) ** 2))
    return scene_of_record(rp.Record(ground, dt=0.01, id="pulse", processed=True), Config())


def test_qualities_of_a_sine():
    t = np.arange(0.0, 10.005, 0.01)
    found = record_qualities(
        scene_of_record(rp.Record(np.sin(np.pi * t), dt=0.01, id="sine", processed=True), Config())
    )
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


BLOCKS = Block(half_width=[0.3, 0.5], half_height=[1.5, 1.9365])
STATES = ("uplift", 0.4, "overturning")


@pytest.mark.parametrize("equation", ["nonlinear", "linear"])
def test_a_capacity_is_where_the_response_reaches_the_limit_state(equation):
    block, motion = BLOCKS, scene()
    factors, _ = scale_capacities(motion, block, STATES, equation, 30.0, 64)
    for state, factor in enumerate(factors):
        around = np.stack([factor * (1.0 - 1e-5), factor * (1.0 + 1e-5)])
        assert reached_at(motion, block, STATES, equation, around)[state].tolist() == [[0, 0], [1, 1]]


def test_a_capacity_above_the_search_is_not_known():
    """Uplift, known in closed form, ends with the search as the others do."""
    block, motion = BLOCKS, scene()
    (lifted,), step = scale_capacities(motion, block, ["uplift"], "nonlinear", 1e6, 8)
    assert np.all(np.isfinite(lifted))
    assert np.all(step == 1.0)  # a closed form misses nothing
    between = float(np.mean(lifted))
    factors, step = scale_capacities(motion, block, STATES, "nonlinear", between, 8)
    reached = lifted <= between
    assert sorted(reached.tolist()) == [False, True]
    np.testing.assert_array_equal(factors[0], np.where(reached, lifted, np.inf))
    assert np.all(np.isinf(factors[-1]))
    np.testing.assert_allclose(step, np.where(reached, (between / lifted) ** (1 / 7), 1.0))


def test_uplift_at_the_very_factor_is_none_and_a_peak_of_the_very_state_is_one():
    block, motion = BLOCKS, scene()
    lifting = block.gravity * np.tan(block.alpha_c) / motion.record.pga
    lifted = scale_capacities(motion, block, ["uplift"], "nonlinear", 1e6, 8)[0][0]
    assert lifted == pytest.approx(lifting, rel=1e-12)
    assert reached_at(motion, block, ["uplift"], "nonlinear", lifted[np.newaxis])[0].tolist() == [[0, 0]]
    peaks = recorded_response(block, motion.record.acceleration, motion.record.dt, block_scale=1.5).peak_rotation_ratio
    states = [float(peaks[0]), float(peaks[1])]
    reached = reached_at(motion, block, states, "nonlinear", np.full((1, 2), 1.5))
    assert reached[:, 0].tolist() == [[int(peak >= state) for peak in peaks] for state in states]
    assert reached[0, 0, 0] == reached[1, 0, 1] == 1


@pytest.mark.sweep
def test_the_vertical_acceleration_belongs_to_the_nonlinear_equation():
    block, motion = BLOCKS, scene()
    shaken = replace(motion, vertical=np.full(motion.record.npts, -3.0))  # all is lighter by 3 m/s2
    for equation, same in (("nonlinear", False), ("linear", True)):
        one, other = (scale_capacities(scene, block, STATES, equation, 30.0, 32)[0] for scene in (motion, shaken))
        assert np.array_equal(one, other) is same
        one, other = (
            reached_at(scene, block, STATES, equation, np.array([[0.9, 0.9], [1.4, 1.4]])) for scene in (motion, shaken)
        )
        assert np.array_equal(one, other) is same


WALL = {"wall": rp.models.Block(0.4, 3.0)}


RECORDS = [packet(number, number, 6.0, 3.0, 1.5) for number in range(10)]
LEVELS = (0.25, 0.4, 0.6, 0.9)


def options(**more):
    known = {"measures": ("pga", "velocity_ratio"), "limit_states": ("overturning",)}
    return rp.FragilitySettings(**known, overturning_model="lognormal", **more)


def curves(tmp_path, text):
    (tmp_path / "chosen.csv").write_text(text)
    config = rp.Config(fragility=options(selection="chosen.csv"), folder=tmp_path)
    return rp.fragility(RECORDS, config, WALL)


def table(weight=""):
    """A row for each record and level; records below the fifth have another weight."""
    rows = ((number, level) for number in range(10) for level in LEVELS)
    if not weight:
        return "record,level\n" + "".join(f"r{number},{level}\n" for number, level in rows)
    return "record,level,weight\n" + "".join(f"r{n},{level},{weight if n < 5 else 1.0}\n" for n, level in rows)


@pytest.fixture(scope="module")
def alike(tmp_path_factory):
    return curves(tmp_path_factory.mktemp("alike"), table())


def test_a_row_of_weight_two_counts_as_two():
    rng = np.random.default_rng(1)
    level = np.exp(rng.normal(0.0, 0.5, 40))
    kind = np.where(np.exp(rng.normal(0.0, 0.4, 40)) < level, NOT_ABOVE, ABOVE)
    clusters = [f"e{k % 10}" for k in range(40)]
    weight = rng.integers(1, 4, 40)
    weighted = fit_curve(Observations.of(level, kind, clusters, None, None, weight))
    again = np.repeat(np.arange(40), weight)
    repeated = fit_curve(Observations.of(level[again], kind[again], [clusters[k] for k in again]))
    for name in ("median", "beta", "median_low", "median_high", "beta_low"):
        assert getattr(weighted, name) == pytest.approx(getattr(repeated, name), rel=1e-9), name
    # Only the shares matter.
    scaled = fit_curve(Observations.of(level, kind, clusters, None, None, 100.0 * weight))
    assert scaled.median == pytest.approx(weighted.median, rel=1e-12)
    plain = fit_curve(Observations.of(level, kind, clusters))
    assert abs(plain.median / weighted.median - 1.0) > 1e-3


@pytest.mark.sweep
def test_factors_of_the_table_are_looked_at_and_nothing_else(tmp_path):
    rows = [(f"r{number}", factor) for number in range(8) for factor in (0.6, 1.2, 2.4, 8.0)][:-1]
    tree = curves(tmp_path, "record,factor\n" + "".join(f"{name},{factor}\n" for name, factor in rows))
    table = tree["capacities"].to_dataset()
    assert table["record"].values.tolist() == [f"r{number}" for number in range(8)]
    assert table["factor"].sel(record="r0", block="wall").values.tolist() == [0.6, 1.2, 2.4, 8.0]
    last = table.sel(record="r7", block="wall", limit_state="overturning")
    assert np.isnan(last["factor"].values[3])
    assert last["reached"].values[3] == -1
    assert (last["weight"].values == [1.0, 1.0, 1.0, 0.0]).all()
    found = tree["fragility"].to_dataset().sel(block="wall", limit_state="overturning", measure="pga")
    assert found["observations"].item() == len(rows)
    failures = tree["failures"].to_dataset()
    assert "2 of 10 records or pairs are not in the table: r8, r9" in failures["reason"].values[0]
    assert failures["kind"].values[0] == "skipped"


@pytest.mark.sweep
def test_the_same_rows_as_stripes_give_the_same_curve(alike):
    stripes = options(stripe_levels=LEVELS, factors=(1e-6, 1e6))
    plain = rp.fragility(RECORDS, rp.Config(fragility=stripes), WALL)
    for name in ("median", "beta", "median_low", "median_high"):
        np.testing.assert_array_equal(alike["fragility"][name].values, plain["fragility"][name].values)


@pytest.mark.sweep
def test_weights_move_the_curve_and_the_annual_frequency(alike, tmp_path):
    weighted = curves(tmp_path, table("5.0"))
    place = {"block": "wall", "limit_state": "overturning", "measure": "pga"}
    medians = [tree["fragility"]["median"].sel(place).item() for tree in (weighted, alike)]
    assert abs(medians[0] / medians[1] - 1.0) > 1e-3
    hazard = rp.PowerLawHazard(k0=1e-3, k=2.0)
    found, beta = rp.risk(weighted, hazard, resamples=0), weighted["fragility"]["beta"].sel(place).item()
    # The closed form of the weighted curve, for nothing below uplift matters here.
    assert found["frequency"].item() == pytest.approx(1e-3 * medians[0] ** -2.0 * np.exp(2.0 * beta**2), rel=0.2)
    assert stored_ensemble(weighted).weight.max() == 5.0


def test_records_that_are_not_there_are_an_error(tmp_path):
    with pytest.raises(ConfigError, match=r"\[fragility\] selection: no record id matches nobody"):
        curves(tmp_path, "record,factor\nr0,1\nnobody,1\n")
