"""Bodies before a wall, with corners and with restraints, through an assessment."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import rockpulse as rp
from rocking import Block
from rocking.search.factors import ScaleIntervals
from rockpulse import models
from rockpulse.assessment.scene import Senses, acting, senses
from rockpulse.config.bodies import gather_bodies
from rockpulse.views.plots.selection import block_of
from rockpulse.views.shared.record_facts import Known

INF, NAN = np.inf, np.nan
T = np.arange(0.0, 4.0, 0.01)
ONE_WAY = np.where(T < 0.8, 1.6 * np.sin(np.pi * T / 0.8), 0.0) - 0.8 * np.exp(-(((T - 2.0) / 0.5) ** 2))


def record(azimuth=None, sign=1.0, name="pulse"):
    return rp.Record(sign * ONE_WAY, dt=0.01, id=name, azimuth=azimuth, processed=True)


def settings(**options):
    return rp.BlockSettings(name="façade", width=0.5, height=5.0, one_sided=True, **options)


def config(*blocks, **uncertainty):
    return rp.Config(
        bodies=blocks,
        models=rp.ModelSettings(use=("sequence", "linear", "nonlinear"), histories=True),
        search=rp.SearchSettings(intervals=True, points=16),
        uncertainty=rp.UncertaintySettings(**uncertainty),
    )


@pytest.mark.sweep
def test_the_worse_sense_counts_and_a_known_one_decides():
    answers = {}
    for facing, azimuth in ((None, None), (90.0, 90.0), (90.0, 270.0)):
        tree = rp.assess([record(azimuth)], config(settings(facing=facing)))
        answers[azimuth] = tree["summary"].isel(record=0, block=0)
    body = settings().block()
    along, against = (models.recorded_response(one, ONE_WAY, 0.01) for one in (body, body.mirrored()))
    peaks = along.peak_rotation_ratio, against.peak_rotation_ratio
    assert peaks[0] != peaks[1]
    nonlinear = {name: one.sel(model="nonlinear") for name, one in answers.items()}
    assert float(nonlinear[90.0]["peak_rotation_ratio"]) == peaks[0]
    assert float(nonlinear[270.0]["peak_rotation_ratio"]) == peaks[1]
    assert float(nonlinear[None]["peak_rotation_ratio"]) == max(peaks)
    for name in ("overturning_probability", "safety_factor"):
        both = [float(nonlinear[azimuth][name]) for azimuth in (90.0, 270.0)]
        worse = max(both) if name == "overturning_probability" else min(both)
        assert float(nonlinear[None][name]) == worse
    # A mirrored record and the other azimuth are the same motion.
    turned = rp.assess([record(270.0, -1.0)], config(settings(facing=90.0)))["summary"].isel(record=0, block=0)
    assert float(turned.sel(model="nonlinear")["peak_rotation_ratio"]) == peaks[0]
    assert float(turned["overturning_probability"]) == pytest.approx(float(nonlinear[90.0]["overturning_probability"]))


@pytest.mark.sweep
def test_each_model_answers_for_what_it_knows():
    held = rp.TieSettings(height=4.0, stiffness=1e6)
    blocks = (
        rp.BlockSettings(name="free", width=0.5, height=5.0),
        settings(),
        rp.BlockSettings(name="leaning", width=0.5, height=5.0, lean=0.01),
        rp.BlockSettings(name="tied", width=0.5, height=5.0, mass=1e3, ties=(held,)),
    )
    tree = rp.assess([record()], config(*blocks))
    summary = tree["summary"].isel(record=0)
    reason = summary["reason"].transpose("model", "block").values
    told = [models.Reason(code).name for code in reason.ravel()]
    assert told == [
        *("NONE", "NOT_MODELLED", "NOT_MODELLED", "NOT_MODELLED"),  # sequence, by the rule
        *("NONE", "NONE", "NONE", "NOT_MODELLED"),  # linear
        *("NONE",) * 4,
    ]
    assert summary["applicable"].sel(model="linear").values.tolist() == [1, 1, 1, 0]
    unknown = np.isnan(summary["safety_factor"].transpose("model", "block").values)
    assert np.array_equal(unknown, reason == models.Reason.NOT_MODELLED)
    assert np.isfinite(summary["overturning_probability"].values).all()


@pytest.mark.sweep
def test_what_is_stored_makes_the_same_body_again(tmp_path):
    ties = (rp.TieSettings(height=4.0, stiffness=1e5),)
    corners = rp.BlockSettings(name="corners", b_1=0.2, b_2=0.3, centre=1.0, gyration=0.6)
    tied = rp.BlockSettings(name="tied", width=0.5, height=5.0, mass=1e3, ties=ties)
    blocks = (settings(rebound=0.4), corners, tied)
    asked = rp.ModelSettings(use=("nonlinear",), histories=True)
    tree = rp.assess([record()], replace(config(*blocks, probability=False), models=asked, search=rp.SearchSettings()))
    rp.save(tree, tmp_path / "results.h5")
    loaded = rp.load(tmp_path / "results.h5")
    summary = loaded["summary"].to_dataset()
    for block in blocks:
        body, again = block.block(), block_of(summary, block.name)
        for name in ("alpha_c", "alpha_2", "p", "p_2", "restitution", "restitution_2", "side", "restraints"):
            assert getattr(again, name) == getattr(body, name), (block.name, name)
        history = rp.plots.histories(loaded, "pulse", block.name, ["nonlinear"])[0]
        assert np.nanmax(np.abs(history.rotation)) <= history.peak + 1e-12
    told = [Known(summary, block=block.name).support for block in blocks]
    assert told == ["against a wall", "different corners, alpha 0.197 rad and 0.291 rad", "1 tie"]
    figure = rp.plots.draw(loaded, "bodies")
    assert [ax.get_title() for ax in figure.axes if ax.get_visible()] == ["façade", "corners", "tied"]


@pytest.mark.sweep
def test_fragility_takes_both_senses_of_an_earthquake():
    records = [record(name=f"pulse {number}") for number in range(3)]
    levels = rp.FragilitySettings(stripe_levels=(0.5, 1.0), measures=("pga", "velocity_ratio"))
    asked = replace(config(settings()), models=rp.ModelSettings(), fragility=levels)
    tree = rp.fragility(records, asked)
    ids = tree["capacities"]["record"].values.tolist()
    assert len(ids) == 6
    assert sum(name.endswith("reversed") for name in ids) == 3
    assert len(set(tree["capacities"]["event"].values.tolist())) == 1
    assert tree["fragility"]["uplift_acceleration"].item() == pytest.approx(9.80665 * 0.5 / 5.0)  # whichever way
    turned = rp.fragility([record(sign=-1.0, name="pulse 0")], asked)
    one, other = (found["capacities"].to_dataset() for found in (tree, turned))
    assert not np.array_equal(one["reached"].sel(record="pulse 0"), one["reached"].sel(record="pulse 0 reversed"))
    for name in ("pulse 0", "pulse 0 reversed"):
        back = "pulse 0" if name.endswith("reversed") else "pulse 0 reversed"
        for variable in ("factor", "reached", "measure_value", "weight", "duration"):
            assert np.array_equal(one[variable].sel(record=name), other[variable].sel(record=back)), (name, variable)


@pytest.mark.parametrize(
    ("azimuth", "facing", "expected"),
    [
        (50.0, 50.0, (1,)),
        (30.0, 0.0, (1,)),
        (0.0, 30.0, (1,)),
        (30.1, 0.0, (1, -1)),
        (120.0, 0.0, (1, -1)),
        (149.9, 0.0, (1, -1)),
        (0.0, 150.0, (-1,)),
        (225.0, 45.0, (-1,)),
        (350.0, 15.0, (1,)),
        (np.nan, 0.0, (1, -1)),
        (0.0, np.nan, (1, -1)),
    ],
)
def test_a_record_within_thirty_degrees_of_the_fall_tells_the_sense(azimuth, facing, expected):
    assert acting(azimuth, facing) == expected


def test_only_bodies_before_a_wall_have_two_senses():
    free = rp.BlockSettings(name="free", width=0.5, height=5.0, restitution=(0.9, 0.8))
    bodies = gather_bodies(
        [free, replace(settings(), rebound=(0.3, 0.4)), replace(settings(facing=90.0), name="known")]
    )
    found = senses(bodies, record(280.0))
    assert (found.count, found.both.tolist()) == (6, [2, 3])
    assert np.asarray(found.block.side).tolist() == [0, 0, 1, 1, -1, -1, -1, -1]
    each = senses(bodies, record(280.0), step=2)
    assert (each.count, each.both.tolist()) == (3, [1])
    assert np.asarray(each.block.side).tolist() == [0, 1, -1, -1]


def lanes_of(both):
    """Three lanes, some of them with a second sense behind them."""
    return Senses(
        Block.from_parameters(p=np.ones(3 + len(both)), alpha=0.1, restitution=0.9), np.array(both, dtype=int)
    )


@pytest.mark.parametrize(
    ("outcomes", "peaks", "places"),
    [
        ([1, 1, 1, 1, 1], [0.5, 0.1, 0.3, 0.7, 0.2], [3, 1, 2]),
        ([1, 1, 1, 1, 1], [0.5, 0.1, 0.3, 0.5, 0.3], [0, 1, 2]),  # of two alike the first
        ([1, 0, 2, 3, 3], [0.5, 0.0, INF, NAN, NAN], [3, 1, 2]),
        ([2, 0, 3, 2, 2], [INF, 0.0, NAN, INF, INF], [0, 1, 4]),
        ([3, 2, 1, 1, 0], [NAN, INF, 0.3, 9.0, 0.0], [0, 1, 2]),
    ],
)
def test_overturning_is_worse_than_no_answer_and_that_than_rocking(outcomes, peaks, places):
    response = SimpleNamespace(outcome=np.array(outcomes), peak_rotation_ratio=np.array(peaks), take=np.copy)
    assert lanes_of([0, 2]).worse(response).tolist() == places


def test_the_likelier_sense_is_that_of_the_smaller_factor_where_both_are_alike():
    both = lanes_of([0, 2])
    factor = np.array([2.0, 1.0, 3.0, 1.5, 3.5])
    assert both.higher_probability(np.array([0.2, 0.9, 0.1, 0.1, 0.3]), factor).tolist() == [0, 1, 4]
    assert both.higher_probability(np.zeros(5), factor).tolist() == [3, 1, 2]


def test_the_intervals_of_the_smaller_factor_are_kept_in_the_order_of_the_lanes():
    lane = np.array([0, 1, 1, 2, 3, 3, 4])
    number = np.arange(7.0)
    found = ScaleIntervals(
        safety_factor=np.array([2.0, 3.0, NAN, 1.5, 2.5]),
        safe_up_to=np.array([1.9, 2.9, NAN, 1.4, 2.4]),
        lane=lane,
        lower=number,
        upper=number + 0.5,
        open=lane == 4,
        step=np.array([1.0, 1.1, 1.2, 1.3, 1.4]),
        resolved=lane != 3,
    )
    smaller = lanes_of([0, 2]).smaller(found)
    assert smaller.lane.tolist() == [0, 0, 1, 1, 2]
    assert smaller.lower.tolist() == [4.0, 5.0, 1.0, 2.0, 6.0]
    assert smaller.upper.tolist() == [4.5, 5.5, 1.5, 2.5, 6.5]
    assert smaller.open.tolist() == [False, False, False, False, True]
    assert smaller.resolved.tolist() == [False, False, True, True, True]
    assert smaller.safety_factor.tolist() == [1.5, 3.0, 2.5]
    assert smaller.safe_up_to.tolist() == [1.4, 2.9, 2.4]
    assert smaller.step.tolist() == [1.3, 1.1, 1.4]
    one = lanes_of([1])  # of the first and the last lane there is one sense
    two = replace(found, lane=np.array([0, 1, 1, 2, 3, 3, 3]))
    assert one.smaller(replace(two, safety_factor=found.safety_factor[:4])).lower.tolist() == [0.0, 4.0, 5.0, 6.0, 3.0]
