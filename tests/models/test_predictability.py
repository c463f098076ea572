"""Answers that a change in the ninth digit turns over."""

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from recorded_cases import block_a, synthetic

import rockpulse as rp
from rocking import Block, Outcome, impulsive_response, predictable, recorded_response

DT = 0.01
SAMPLES = Path(__file__).parents[2] / "data" / "samples" / "records"


def checked(ground, block, scale=1.0, **options):
    def respond(lanes, factors):
        return recorded_response(lanes, ground, DT, scale=factors)

    return predictable(respond(block, np.atleast_1d(scale)), respond, block, np.atleast_1d(scale), **options)


def test_sensitive_wall_under_a_sample_record_is_marked():
    # The boundary wall of data/samples/site.toml: a factor of 1 +- 1e-9 on CLC 90 moves the peak by some 4e-4.
    record = next(rp.condition(r) for r in rp.read(SAMPLES / "CICLC.v1") if "..90@" in r.id)
    wall = Block(half_width=0.125, half_height=1.1)
    peaks = recorded_response(wall, record.acceleration, record.dt, scale=[1 - 1e-9, 1.0, 1 + 1e-9]).peak_rotation_ratio
    assert 1e-4 < np.ptp(peaks) < 1e-2
    assert checked(record.acceleration, wall)[0] == 0
    assert checked(record.acceleration, wall, tolerance=0.01)[0] == 1


def test_calm_lanes_are_predictable_and_the_edge_of_overturning_is_not():
    block = block_a(restitution=0.9)

    def respond(lanes, factors):
        return impulsive_response(lanes, [0.0], [block.critical_impulse], scale=factors)

    factors = np.array([0.2, 0.5, 1.0 - 1e-10, 1.5])
    assert predictable(respond(block, factors), respond, block, factors).tolist() == [1, 1, 0, 1]


def test_without_a_tolerance_only_the_outcome_counts():
    block = block_a(restitution=0.9)

    def respond(lanes, factors):
        return impulsive_response(lanes, [0.0], [block.critical_impulse], scale=factors)

    factors = np.array([0.5, 1.0 - 1e-10])
    marks = predictable(respond(block, factors), respond, block, factors, tolerance=1e-12)
    assert marks.tolist() == [0, 0]  # the peak at half the critical impulse moves by some 1e-9
    marks = predictable(respond(block, factors), respond, block, factors, tolerance=None)
    assert marks.tolist() == [1, 0]


def test_wider_perturbation_turns_more_lanes_over():
    ground = synthetic(3, n=2500)
    lanes = Block.from_parameters(np.linspace(1.0, 6.0, 60), 0.08, 0.98)
    fine, coarse = (np.count_nonzero(checked(ground, lanes, perturbation=size) == 1) for size in (1e-12, 1e-2))
    assert coarse < fine <= 60


def test_restitution_stays_within_its_range():
    seen = []

    def respond(lanes, factors):
        seen.append(np.array(lanes.restitution))
        return recorded_response(lanes, synthetic(1), DT, scale=factors)

    block = Block.from_parameters([2.0, 2.0, 2.0], 0.2, [0.0, 0.5, 1.0])
    predictable(respond(block, np.array([0.4])), respond, block, np.array([0.4]))
    base, both, again = seen
    assert both.tolist() == [0.0, 0.5 * (1 - 1e-9), 1 - 1e-9, 0.0, 0.5 * (1 + 1e-9), 1.0]
    assert np.array_equal(base, again)


def test_unresolved_lanes_are_not_checked():
    ground, up = synthetic(1), np.full(1500, -20.0)
    block = block_a()

    def respond(lanes, factors):
        return recorded_response(lanes, ground, DT, scale=factors, vertical=up)

    answer = respond(block, np.array([1.0]))
    assert answer.outcome[0] == Outcome.UNRESOLVED
    assert predictable(answer, respond, block, np.array([1.0])).tolist() == [-1]


def test_axes_of_scalars_are_dropped():
    ground = synthetic(1)

    def respond(lanes, factors):
        return recorded_response(lanes, ground, DT, scale=factors)

    block = block_a()
    mark = predictable(respond(block, 0.3), respond, block, 0.3)
    assert isinstance(mark, int)
    assert mark == 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"perturbation": 0.0}, "perturbation: expected a relative change"),
        ({"perturbation": 0.5}, "perturbation: expected a relative change"),
        ({"perturbation": "x"}, "perturbation: expected a relative change"),
        ({"tolerance": 0.0}, "tolerance: expected a positive spread"),
        ({"tolerance": np.inf}, "tolerance: expected a positive spread .* finite, got inf"),
        ({"tolerance": "x"}, "tolerance: expected a positive spread .* got 'x'"),
    ],
)
def test_bad_arguments_are_named(options, message):
    with pytest.raises(ValueError, match=message):
        checked(synthetic(1), block_a(), **options)


@pytest.mark.skipif("ROCKPULSE_RECORDS" not in os.environ, reason="ROCKPULSE_RECORDS is not set")
def test_records_have_lanes_of_both_kinds():
    folder = Path(os.environ["ROCKPULSE_RECORDS"])
    record = rp.condition(rp.read(folder / "at2" / "NIS090.AT2")[0])
    lanes = Block.from_parameters(np.linspace(1.0, 8.0, 80), 0.1, 0.98)

    def respond(blocks, factors):
        return recorded_response(blocks, record.acceleration, record.dt, scale=factors)

    marks = predictable(respond(lanes, np.array([1.0])), respond, lanes, np.array([1.0]), tolerance=1e-6)
    assert {0, 1} <= set(marks.ravel())


def told(shape, peak=0.5):
    """An answer of lanes of which all rock to one peak."""
    return SimpleNamespace(peak_rotation_ratio=np.full(shape, peak), outcome=np.full(shape, int(Outcome.ROCKS)))


@pytest.mark.parametrize("name", ["peak_rotation_ratio", "outcome"])
@pytest.mark.parametrize(("run", "places"), [(0, (2, 6)), (1, (4, 3))])
def test_each_of_the_four_runs_is_compared_lane_by_lane(run, places, name):
    """Two factors on three blocks: restitutions down and up side by side, factors down and up one below the other."""
    blocks, factors = Block.from_parameters([1.0, 2.0, 3.0], 0.2, [0.5, 0.6, 0.7], log=False), np.array([0.4, 2.0])
    for place in np.ndindex(*places):
        asked = []

        def respond(block, scale, place=place, asked=asked):
            asked.append((np.array(block.restitution), scale))
            answer = told((scale.size, block.shape[0]))
            if len(asked) == run + 1:
                getattr(answer, name)[place] += 1
            return answer

        marks = predictable(told((2, 3)), respond, blocks, factors, perturbation=0.01)
        expected = np.ones((2, 3))
        expected[place[0] % 2, place[1] % 3] = 0
        assert marks.tolist() == expected.tolist()
        (bounced, as_given), (as_they_are, scaled) = asked
        assert bounced == pytest.approx([0.495, 0.594, 0.693, 0.505, 0.606, 0.707])
        assert as_given.tolist() == [0.4, 2.0]
        assert as_they_are.tolist() == [0.5, 0.6, 0.7]
        assert scaled == pytest.approx([0.396, 1.98, 0.404, 2.02])


def test_a_spread_of_the_tolerance_is_the_same_and_overturned_peaks_are_none():
    block = Block.from_parameters([1.0], 0.2, 0.9, log=False)

    def marks_of(peak, answer, **options):
        return predictable(answer, lambda one, scale: told((scale.size, one.shape[0]), peak), block, [1.0], **options)

    assert marks_of(0.75, told((1, 1)), tolerance=0.25).tolist() == [[1]]
    assert marks_of(0.75, told((1, 1)), tolerance=0.2499).tolist() == [[0]]
    assert marks_of(0.5 + 9.9e-5, told((1, 1))).tolist() == [[1]]
    assert marks_of(0.5 + 1.01e-4, told((1, 1))).tolist() == [[0]]
    assert marks_of(np.inf, told((1, 1), np.inf)).tolist() == [[1]]
    assert marks_of(np.nan, told((1, 1), np.nan)).dtype == np.int8


def test_the_largest_perturbation_is_a_tenth():
    block = Block.from_parameters([1.0], 0.2, 0.9, log=False)
    answers = predictable(
        told((1, 1)), lambda one, scale: told((scale.size, one.shape[0])), block, [1.0], perturbation=0.1
    )
    assert answers.tolist() == [[1]]
    with pytest.raises(ValueError, match="perturbation"):
        predictable(told((1, 1)), None, block, [1.0], perturbation=0.1001)


def test_the_record_as_it_is_is_looked_at_where_no_factor_is_given():
    scales = []

    def respond(one, scale):
        scales.append(scale.tolist())
        return told((scale.size, one.shape[0]))

    predictable(told((1, 1)), respond, Block.from_parameters([1.0], 0.2, 0.9, log=False))
    assert scales == [[1.0], [1.0 - 1e-9, 1.0 + 1e-9]]
