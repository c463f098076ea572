"""Responses of lanes, alone and among others: codes, words and pictures."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking import Block, ImpulseSequence, recorded_response, resonance, sequence_response
from rocking.lanes import squeezed
from rocking.pictures import BLUE, RED
from rocking.response import Outcome, Reason, Response


def test_outcomes_and_reasons_count_up_from_0_and_each_has_a_word():
    assert [one.word for one in Outcome] == ["at_rest", "rocks", "overturns", "unresolved"]
    words = ["none", "impact_limit", "free_flight", "half_cycle_limit", "no_sequence", "short_interval", "not_modelled"]
    assert [one.name.lower() for one in Reason] == words
    for every in (Outcome, Reason):
        assert [*every] == list(range(len(every)))


BODIES = Block(half_width=0.5, half_height=[2.0, 3.0], restitution=0.9, gravity=9.81)
KNOWN = np.array([True, False, True])


def test_where_there_is_no_answer_nothing_is_said():
    found = Response.unresolved((2, 3), Reason.FREE_FLIGHT)
    assert found.outcome.tolist() == [[Outcome.UNRESOLVED] * 3] * 2
    assert found.reason.tolist() == [[Reason.FREE_FLIGHT] * 3] * 2
    assert found.overturning_half_cycle.tolist() == found.impacts.tolist() == [[-1] * 3] * 2
    assert np.isnan([found.peak_rotation_ratio, found.overturning_time]).all()


@pytest.mark.parametrize("impulse", [0.1, [0.1, 0.2]])
def test_answers_keep_their_places_among_blocks_that_have_none(impulse):
    some = resonance(BODIES, impulse, 3, table_rows=5)
    whole = some.among(KNOWN, Reason.FREE_FLIGHT)
    nothing = {"outcome": Outcome.UNRESOLVED, "reason": Reason.FREE_FLIGHT, "peak_rotation_ratio": np.nan}
    assert_among(whole, some, nothing | {"overturning_half_cycle": -1, "impacts": -1})
    columns = dict.fromkeys(("start_velocity", "peak", "duration", "interval", "impact_speed"), np.nan)
    assert_among(whole.half_cycles, some.half_cycles, columns | {"impulse_count": -1})


def assert_among(whole, some, nothing):
    """Fields of the blocks that have answers, the first and the last, are theirs; those of the other are nothing."""
    for name, value in nothing.items():
        found = np.asarray(getattr(whole, name))
        assert np.array_equal(found[..., KNOWN], getattr(some, name), equal_nan=True), name
        assert np.array_equal(found[..., 1], np.full(found[..., 1].shape, value), equal_nan=True), name


def test_histories_of_blocks_without_an_answer_are_nan():
    motion = 4.0 * np.sin(0.1 * np.arange(200))
    some = recorded_response(BODIES, motion, 0.01, scale=[0.5, 1.0], history=True)
    whole = some.among(KNOWN, Reason.FREE_FLIGHT)
    assert_among(whole, some, {"active_samples": 0, "impacts": -1, "overturning_half_cycle": -1})
    assert whole.velocity.shape == whole.rotation.shape == (2, 3, 200)
    for name in ("rotation", "velocity"):
        assert np.array_equal(getattr(whole, name)[:, KNOWN], getattr(some, name), equal_nan=True)
        assert np.isnan(getattr(whole, name)[:, 1]).all()


def test_ground_contact_of_blocks_without_an_answer_is_none():
    sequence = ImpulseSequence(0.3, 0.27, 0.1, 5.0, spacing="start")
    some = sequence_response(BODIES, sequence)
    assert np.asarray(some.ground_contact).dtype == bool
    whole = some.among(KNOWN, Reason.NOT_MODELLED)
    assert whole.ground_contact.tolist() == [bool(some.ground_contact[0]), False, bool(some.ground_contact[1])]


@pytest.mark.parametrize(("drop", "shape"), [((False, False), (4, 2, 3)), ((True, False), (4, 3))])
def test_axes_of_scalars_are_dropped_from_the_last_two(drop, shape):
    values = np.arange(24.0).reshape(4, 2, 3)[:, : 1 if drop[0] else 2]
    assert squeezed(values, drop).shape == shape
    assert squeezed(np.ones((2, 1)), (False, True)).shape == (2,)
    assert squeezed(np.full((1, 1), 7.0), (True, True)) == 7.0


def test_a_history_loses_the_axes_of_scalars_and_keeps_that_of_time():
    motion = 4.0 * np.sin(0.1 * np.arange(200))
    every = recorded_response(BODIES, motion, 0.01, scale=[0.5, 1.0], history=True)
    for scale, block, place in (
        (1.0, BODIES, (1,)),
        ([0.5, 1.0], BODIES.lane(1), (slice(None), 1)),
        (0.5, BODIES.lane(0), (0, 0)),
    ):
        one = recorded_response(block, motion, 0.01, scale=scale, history=True)
        for name in ("rotation", "velocity"):
            assert np.array_equal(getattr(one, name), getattr(every, name)[place], equal_nan=True)
        assert one.time == pytest.approx(0.01 * np.arange(200))
    assert not np.array_equal(every.rotation, every.velocity, equal_nan=True)


SVG = "{http://www.w3.org/2000/svg}"
DT = 0.01
SHAKING = 3.2 * np.sin(2.0 * np.pi * np.arange(0.0, 6.0, DT))


def made(outcome, peak):
    count = np.shape(outcome)
    nothing = np.full(count, -1)
    return Response(peak, outcome, np.zeros(count, dtype=int), np.full(count, np.nan), nothing, nothing)


EVERY = made(np.arange(4), np.array([0.0, 0.4, np.inf, np.nan]))


def drawn(response):
    return ET.fromstring(response._repr_html_()).find(f".//{SVG}svg")


def test_overturned_is_a_bool_for_one_lane_and_an_array_for_several():
    one = resonance(Block(width=0.5, height=2.0), 1.0, half_cycles=2)
    assert one.overturned is True
    assert one.outcome_name == "overturns"
    assert EVERY.overturned.tolist() == [False, False, True, False]
    assert EVERY.overturned.dtype == bool


@pytest.mark.sweep
def test_names_of_outcomes_are_those_that_results_store():
    from rockpulse.storage.variables.summary import SUMMARY

    stored = SUMMARY["outcome"].variable(np.zeros((1, 1, 1)), ("record", "block", "model")).attrs["flag_meanings"]
    assert EVERY.outcome_name.tolist() == str(stored).split() == [outcome.word for outcome in Outcome]


def test_a_response_is_told_in_a_line():
    rocks = recorded_response(Block(width=0.6, height=2.2), 0.9 * SHAKING, DT)
    assert repr(rocks) == f"<Response rocks, peak {rocks.peak_rotation_ratio:.4g} alpha_c, impacts {rocks.impacts}>"
    falls = recorded_response(Block(width=0.25, height=2.2), 4.0 * SHAKING, DT, history=True)
    assert repr(falls).startswith(f"<Response overturns by {falls.overturning_time:.4g} s, impacts ")
    assert repr(falls).endswith(f"history of {falls.time.size} samples>")
    told = "<Response of 4 lanes, at_rest 1, rocks 1, overturns 1, unresolved 1, peak of those that rock 0.4 alpha_c>"
    assert repr(EVERY) == told


def test_peaks_are_bars_in_the_colour_of_their_outcome():
    heights = {}
    for path in drawn(EVERY).findall(f"{SVG}path"):
        base, tip = path.attrib["d"].partition(" ")[2].split("V")
        heights[path.attrib["stroke"]] = float(base) - float(tip)
    assert heights[RED] / heights[BLUE] == pytest.approx(3.0, rel=0.02)  # an overturning one reaches 1.2, this one 0.4
    assert len(heights) == 4


def test_a_history_is_a_line_that_stays_short():
    long = recorded_response(Block(width=0.6, height=2.2), np.tile(0.9 * SHAKING, 40), DT, history=True)
    lines = drawn(long).findall(f"{SVG}polyline")
    assert lines[-1].attrib["stroke"] == BLUE
    assert 100 < len(lines[-1].attrib["points"].split()) <= 600
    assert len(long._repr_html_()) < 12_000
