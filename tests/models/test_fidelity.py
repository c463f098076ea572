"""The choice of the cheapest model, against the nonlinear equation on every lane."""

import numpy as np
import pytest
from recorded_cases import block_a, synthetic

from rocking import (
    Block,
    Outcome,
    Rung,
    choose_response,
    ground_demand,
    impulsive_response,
    recorded_response,
)
from rocking.fidelity import MEASURED_RANGE, SAFE_BUILD_UP, within_measured_range

DT = 0.01
FACTORS = np.array([0.1, 0.3, 0.6, 1.0])


def half_waves(acceleration):
    """Times and impulses of the half-waves of samples: sums between changes of sign, at their centroids."""
    edges = np.flatnonzero(np.diff(np.sign(acceleration)) != 0) + 1
    parts = np.split(np.arange(acceleration.size), edges)
    impulse = np.array([DT * acceleration[part].sum() for part in parts])
    weight = [np.abs(acceleration[part]) + 1e-300 for part in parts]
    centre = np.array([DT * np.average(part, weights=w) for part, w in zip(parts, weight, strict=True)])
    return centre, impulse


def blocks(seed=0, count=120):
    rng = np.random.default_rng(seed)
    alpha = rng.uniform(0.05, 0.3, count)
    ratio = rng.choice([1.0, 0.95, 0.87], count)
    return Block.from_parameters(
        np.exp(rng.uniform(0.0, np.log(8.0), count)), alpha, ratio * (1 - 1.5 * np.sin(alpha) ** 2)
    )


def chosen(ground, lanes=None, scale=FACTORS, **options):
    return choose_response(lanes or blocks(), ground, DT, *half_waves(ground), scale=scale, **options)


@pytest.fixture(scope="module", params=[11, 12, 13, 14])
def held_out(request):
    """A motion that no limit was measured on, with the choice and the truth."""
    ground = synthetic(request.param, n=2500)
    return ground, chosen(ground), recorded_response(blocks(), ground, DT, scale=FACTORS)


def test_outcomes_are_those_of_the_nonlinear_equation(held_out):
    _, (response, used), truth = held_out
    assert np.array_equal(response.outcome, truth.outcome)
    assert {Outcome.AT_REST, Outcome.ROCKS, Outcome.OVERTURNS} <= set(np.unique(truth.outcome))
    assert {Rung.STATIC, Rung.IMPULSIVE, Rung.NONLINEAR} <= set(np.unique(used))


def test_static_lanes_are_at_rest_and_so_are_all_that_stay_at_rest(held_out):
    _, (response, used), truth = held_out
    static = used == Rung.STATIC
    assert np.array_equal(static, truth.outcome == Outcome.AT_REST)
    assert np.all(response.peak_rotation_ratio[static] == 0.0)
    assert np.all(response.impacts[static] == 0)
    assert np.all(response.active_samples[static] == 0)


def test_lanes_of_the_nonlinear_rung_are_the_nonlinear_response_to_the_last_bit(held_out):
    _, (response, used), truth = held_out
    nonlinear = used == Rung.NONLINEAR
    for name in ("peak_rotation_ratio", "overturning_time", "impacts", "overturning_half_cycle", "active_samples"):
        answer, direct = getattr(response, name)[nonlinear], getattr(truth, name)[nonlinear]
        assert np.array_equal(answer, direct, equal_nan=True), name


def test_every_lane_carries_an_answer(held_out):
    _, (response, used), truth = held_out
    rocks = response.outcome == Outcome.ROCKS
    assert np.all(np.isfinite(response.peak_rotation_ratio[rocks]) & (response.peak_rotation_ratio[rocks] > 0.0))
    assert np.all(np.isinf(response.peak_rotation_ratio[response.outcome == Outcome.OVERTURNS]))
    assert np.all(np.isnan(response.overturning_time) == (response.outcome != Outcome.OVERTURNS))
    assert np.all(response.active_samples[used == Rung.IMPULSIVE] == -1)
    settled = used == Rung.SETTLED
    rocking = settled & (response.outcome == Outcome.ROCKS)
    assert np.all(response.impacts[rocking] == -1)
    assert np.all(response.active_samples[settled] <= truth.active_samples[settled])
    fallen = response.outcome == Outcome.OVERTURNS
    assert np.all(response.overturning_time[fallen] <= truth.overturning_time[fallen])


def test_a_tight_tolerance_on_the_peak_leaves_the_static_and_the_nonlinear_rung(held_out):
    ground, _, truth = held_out
    response, used = chosen(ground, output="peak", tolerance=1e-9)
    assert set(np.unique(used)) == {Rung.STATIC, Rung.NONLINEAR}
    assert np.array_equal(response.peak_rotation_ratio, truth.peak_rotation_ratio, equal_nan=True)


@pytest.mark.parametrize("tolerance", [1.0, 0.05])
def test_peaks_are_right_to_the_tolerance(held_out, tolerance):
    ground, _, truth = held_out
    response, used = chosen(ground, output="peak", tolerance=tolerance)
    assert np.array_equal(response.outcome, truth.outcome)
    assert Rung.SETTLED not in used
    if tolerance == 1.0:
        assert Rung.IMPULSIVE in used
    rocks = truth.outcome == Outcome.ROCKS
    assert np.max(np.abs(response.peak_rotation_ratio[rocks] - truth.peak_rotation_ratio[rocks])) <= tolerance


def test_impulses_answer_only_where_the_build_up_bounds_the_peak_by_the_tolerance(held_out):
    """The peak is at most 1.3 times the square of the build-up."""
    ground, _, _ = held_out
    build_up = np.multiply.outer(FACTORS, ground_demand(blocks(), ground, DT).build_up)
    used = chosen(ground, output="peak", tolerance=0.3)[1]
    assert np.all(1.3 * build_up[used == Rung.IMPULSIVE] ** 2 <= 0.3)


def test_a_wider_tolerance_never_leaves_more_to_the_nonlinear_equation(held_out):
    ground, _, _ = held_out
    left = [
        np.count_nonzero(chosen(ground, output="peak", tolerance=t)[1] == Rung.NONLINEAR) for t in (1e-6, 0.01, 1.0)
    ]
    assert left[0] >= left[1] >= left[2]
    assert left[0] > left[2]


def test_a_weaker_record_never_needs_a_dearer_rung_than_static():
    ground = synthetic(3)
    _, used = chosen(ground, scale=np.array([0.001, 0.01, 0.1, 1.0]))
    static = used == Rung.STATIC
    assert np.all(static[0])
    assert np.all(static[:-1] >= static[1:])


def test_threshold_itself_does_not_lift_and_a_hair_above_is_left_to_the_equation():
    block = block_a()
    threshold = block.gravity * np.tan(block.alpha_c)
    below, above = (np.array([0.0, factor * threshold, 0.0]) for factor in (1.0 - 1e-8, 1.0 + 1e-8))
    assert choose_response(block, below, DT)[1] == Rung.STATIC
    response, used = choose_response(block, above, DT)
    assert used != Rung.STATIC
    assert response.outcome == Outcome.ROCKS


def test_without_half_waves_the_impulsive_rung_is_not_used():
    ground = synthetic(5)
    _, used = choose_response(blocks(), ground, DT, scale=FACTORS)
    assert Rung.IMPULSIVE not in used


@pytest.mark.parametrize("name", ["p", "alpha", "restitution"])
def test_lanes_outside_the_measured_range_are_left_to_the_equation(name):
    low = MEASURED_RANGE[name][0]
    values = {"p": 0.8, "alpha": 0.15, "restitution": 0.95, name: 0.9 * low}
    housner = 1.0 - 1.5 * np.sin(values["alpha"]) ** 2
    outside = Block.from_parameters([values["p"]], [values["alpha"]], values["restitution"] * housner)
    inside = Block.from_parameters([0.8], [0.15], 0.95 * (1.0 - 1.5 * np.sin(0.15) ** 2))
    ground, scale = synthetic(2), np.linspace(0.02, 3.0, 60)
    assert {Rung.STATIC, Rung.NONLINEAR} == set(chosen(ground, outside, scale=scale)[1].ravel())
    assert {Rung.IMPULSIVE, Rung.SETTLED} <= set(chosen(ground, inside, scale=scale)[1].ravel())


def test_the_ends_of_the_measured_range_belong_to_it():
    alpha = np.array([0.04, 0.32])
    housner = 1.0 - 1.5 * np.sin(alpha) ** 2
    ends = Block.from_parameters([0.7, 9.0], alpha, housner * [0.85, 1.0])
    assert within_measured_range(ends, 0.1 / 9.0).all()
    beyond = Block.from_parameters([0.699, 9.01], alpha, housner * [0.85, 1.0])
    assert not within_measured_range(beyond, 0.1 / 9.01).any()
    for p, angle, share, dt in ((3.0, 0.0399, 0.9, 0.01), (3.0, 0.3201, 0.9, 0.01), (3.0, 1.2, 0.9, 0.01),
                                (3.0, 0.1, 0.849, 0.01), (3.0, 0.1, 1.001, 0.01), (3.0, 0.1, 0.9, 0.0334)):  # fmt: skip
        housner_of = abs(1.0 - 1.5 * np.sin(angle) ** 2)
        one = Block.from_parameters([3.0, p], [0.1, angle], [0.9 * (1.0 - 1.5 * np.sin(0.1) ** 2), share * housner_of])
        assert within_measured_range(one, dt).tolist() == [dt < 0.0333, False]


def test_only_free_bodies_alike_on_both_sides_were_measured():
    plain, unlike = Block.from_parameters(3.0, 0.2, 0.9), Block.from_corners(0.2, 0.21, 1.0, 0.6, 0.9)
    wall = Block.from_parameters(3.0, 0.2, "housner", one_sided=True, rebound=0.9)
    assert within_measured_range(Block.stack([plain, unlike, wall]), 0.01).tolist() == [True, False, False]


def test_between_the_threshold_and_its_rounding_the_equation_tells():
    for block in (block_a(), Block(width=0.5, height=3.0, one_sided=True), Block.from_corners(0.2, 0.3, 1.0, 0.6)):
        threshold = block.gravity * np.tan(block.alpha_c)
        for below, rung in ((2e-9, Rung.STATIC), (2e-10, Rung.NONLINEAR)):
            record = np.array([0.0, -(1.0 - below) * threshold, 0.0])
            response, used = choose_response(block, record, DT)
            assert used == rung
            assert response.outcome == Outcome.AT_REST


def test_bodies_that_are_not_free_are_static_until_their_own_corner_lifts():
    """Plain, before a wall, and its mirror image, which a push towards theta > 0 leaves at rest."""
    wall = Block(width=0.5, height=3.0, one_sided=True)
    some = Block.stack([Block(width=0.5, height=3.0), wall, wall.mirrored(), Block.from_corners(0.2, 0.3, 1.0, 0.6)])
    record = np.zeros(100)
    record[10:14] = -1.0
    scale = some.gravity * np.array([0.99 / 6.0, 1.01 / 6.0, 0.199, 0.201])
    response, used = choose_response(some, record, DT, scale=scale)
    static = [[True] * 4, [False, False, True, True], [False, False, True, True], [False, False, True, False]]
    assert (used == Rung.STATIC).tolist() == static
    truth = recorded_response(some, record, DT, scale=scale)
    assert np.array_equal(response.outcome, truth.outcome)
    assert np.all(used[:, 1:][used[:, 1:] != Rung.STATIC] == Rung.NONLINEAR)
    down = np.full(100, -0.5 * some.gravity)
    halved = choose_response(some, record, DT, scale=[0.99 / 12.0 / 0.5, 1.01], vertical=down)[1]
    assert halved.shape == (2, 4)


@pytest.mark.parametrize("strength", [1.0, 1.8])  # of the impulses, beside the record that they are taken for
def test_which_lanes_the_impulses_answer(strength):
    """A build-up of 0.8 at most, or of 1.0 where no lobe is above 0.4 and 1.4 times the impulses do not overturn."""
    ground = synthetic(12, n=2500)
    lanes, factors = blocks(3, 400), np.linspace(0.15, 0.9, 12)
    times, impulses = half_waves(ground)
    impulses = strength * impulses
    response, used = choose_response(lanes, ground, DT, times, impulses, scale=factors)
    strongest = np.sort(np.argsort(np.abs(impulses))[-32:])
    assert times.size > 40
    demand = ground_demand(lanes, ground, DT)
    measured = within_measured_range(lanes, DT)
    seen = np.zeros(3, dtype=int)
    for row, factor in enumerate(factors):
        marched, raised = (
            impulsive_response(lanes, times[strongest], impulses[strongest], scale=more * factor, gain="exact")
            for more in (1.0, 1.4)
        )
        low = factor * demand.build_up <= 0.8
        middle = ~low & (factor * demand.build_up <= 1.0) & (factor * demand.largest <= 0.4)
        rocks, sure = marched.outcome == Outcome.ROCKS, raised.outcome == Outcome.ROCKS
        lifted = factor * np.max(np.abs(ground)) > lanes.gravity * np.tan(lanes.alpha_c)
        expected = lifted & measured & rocks & (low | (middle & sure))
        assert np.array_equal(used[row] == Rung.IMPULSIVE, expected)
        for name in ("peak_rotation_ratio", "impacts", "overturning_half_cycle"):
            assert np.array_equal(getattr(response, name)[row, expected], getattr(marched, name)[expected])
        seen += [np.sum(expected & low), np.sum(expected & middle), np.sum(lifted & measured & middle & ~expected)]
    assert np.all(seen > (0, 0, -1 if strength == 1.0 else 0))
    static = used == Rung.STATIC
    assert np.all(response.overturning_half_cycle[static] == -1)
    assert np.all(response.reason[static] == 0)
    assert np.all(np.isnan(response.overturning_time[static]))


def test_what_is_asked_unless_it_is_told():
    """The outcome at the record's own strength; peaks to a ten-thousandth of the critical angle."""
    ground = synthetic(13, n=2500)
    plain, told = chosen(ground, scale=1.0), choose_response(blocks(), ground, DT, *half_waves(ground))
    outcome = chosen(ground, scale=1.0, output="outcome")
    for other in (told, outcome):
        assert np.array_equal(plain[1], other[1])
        assert np.array_equal(plain[0].peak_rotation_ratio, other[0].peak_rotation_ratio, equal_nan=True)
    scale = np.geomspace(0.05, 1.0, 8)
    peaks = [chosen(0.2 * ground, scale=scale, output="peak", **more)[1] for more in ({}, {"tolerance": 1e-4})]
    assert np.array_equal(*peaks)


def test_vertical_acceleration_is_static_only_where_its_largest_value_lifts_nothing():
    block = block_a()
    tangent = np.tan(block.alpha_c)
    ground, up = np.zeros(200), np.zeros(200)
    ground[50], up[50] = 0.6 * block.gravity * tangent, -0.39 * block.gravity
    assert choose_response(block, ground, DT, vertical=up)[1] == Rung.STATIC
    up[50] = -0.41 * block.gravity
    response, used = choose_response(block, ground, DT, vertical=up)
    assert used == Rung.NONLINEAR
    assert response.outcome == recorded_response(block, ground, DT, vertical=up).outcome == Outcome.ROCKS


def test_scalar_arguments_drop_their_axes():
    ground = synthetic(4)
    one, used = chosen(ground, block_a(), scale=1.0)
    assert isinstance(used, int)
    assert isinstance(one.outcome, int)
    row, used = chosen(ground, scale=1.0)
    assert row.outcome.shape == used.shape == (120,)
    column, used = chosen(ground, block_a())
    assert column.outcome.shape == used.shape == FACTORS.shape


def test_threads_do_not_change_the_answer():
    ground = synthetic(6)
    (one, first), (two, second) = (chosen(ground, threads=threads) for threads in (1, 2))
    assert np.array_equal(first, second)
    assert np.array_equal(one.peak_rotation_ratio, two.peak_rotation_ratio, equal_nan=True)


def test_all_zero_record_and_no_factor_at_all():
    _, used = choose_response(blocks(), np.zeros(50), DT, scale=FACTORS)
    assert np.all(used == Rung.STATIC)
    _, used = choose_response(blocks(), synthetic(1), DT, scale=0.0)
    assert np.all(used == Rung.STATIC)
    response, used = choose_response(blocks(), synthetic(1), DT, scale=np.array([]))
    assert response.outcome.shape == used.shape == (0, 120)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"output": "verdict"}, "output: expected 'outcome' or 'peak', got 'verdict'"),
        ({"tolerance": 0.0}, "tolerance: expected a positive error"),
        ({"tolerance": np.nan}, "tolerance: expected a positive error"),
        ({"tolerance": np.inf}, "tolerance: expected a positive error .* finite, got inf"),
        ({"tolerance": "x"}, "tolerance: expected a positive error .* got 'x'"),
        ({"tolerance": None}, "tolerance: expected a positive error"),
        ({"tolerance": [1e-4]}, "tolerance: expected a positive error .* got shape"),
        ({"impulses": None}, "times, impulses: expected both or none"),
        ({"scale": -1.0}, "scale: expected a factor >= 0"),
    ],
)
def test_bad_arguments_are_named(options, message):
    ground = synthetic(1)
    times, impulses = half_waves(ground)
    with pytest.raises(ValueError, match=message):
        choose_response(block_a(), ground, DT, **{"times": times, "impulses": impulses, **options})


def test_a_record_that_is_no_record_is_refused_even_where_nothing_would_lift():
    with pytest.raises(ValueError, match="NaN"):
        choose_response(block_a(), [0.0, np.nan, 0.0], DT)
    assert SAFE_BUILD_UP < 1.0
