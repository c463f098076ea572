"""Bodies in directions of their own, on floors and on pedestals, through an assessment."""

from dataclasses import replace

import numpy as np
import pytest

import rockpulse as rp
from rocking.response import HalfCycles, Response
from rockpulse import models
from rockpulse.assessment.record_assessment import assess_scene
from rockpulse.assessment.scene import extract, floor_record, floor_scene, joined_responses, places_of
from rockpulse.config.bodies import FeltMotion, gather_bodies
from rockpulse.record.components import Pair
from rockpulse.record.intensity import pgv
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.text.overview import block_details, overview

T = np.arange(0.0, 4.0, 0.01)
GROUND = 1.5 * np.sin(2.0 * np.pi * T / 0.7) * np.exp(-(((T - 2.0) / 1.0) ** 2))
RECORD = rp.Record(GROUND, dt=0.01, id="burst", processed=True)
FLOOR = rp.FloorSettings(period=0.5, participation=1.3)


def body(name, **options):
    return rp.BlockSettings(name=name, width=0.4, height=3.0, **options)


PROBABLE = {"uncertainty": rp.UncertaintySettings(spectrum="all")}


def config(*blocks, **options):
    """Without a probability, unless it is asked for."""
    options = {"uncertainty": rp.UncertaintySettings(probability=False)} | options
    asked = rp.ModelSettings(use=("sequence", "nonlinear"), histories=True)
    return rp.Config(bodies=blocks, models=asked, search=rp.SearchSettings(intervals=True, points=16), **options)


@pytest.mark.sweep
def test_a_body_aloft_is_shaken_by_its_floor_and_the_others_by_the_ground():
    blocks = body("ground"), body("aloft", floors=(FLOOR,)), body("below", friction=0.2)
    tree = rp.assess([RECORD], config(*blocks))
    summary = tree["summary"].isel(record=0).sel(model="nonlinear")
    floor = models.floor_motion(GROUND, 0.01, 0.5, participation=1.3, quiet=1e-4 * 9.80665)
    block = body("one").block()
    aloft = models.recorded_response(block, floor.acceleration, floor.dt)
    ground = models.recorded_response(block, GROUND, 0.01)
    peaks = summary["peak_rotation_ratio"].values.tolist()
    assert peaks == [ground.peak_rotation_ratio, aloft.peak_rotation_ratio, ground.peak_rotation_ratio]
    assert summary["floor_amplification"].values.tolist() == pytest.approx([1.0, floor.amplification, 1.0])
    ratio = summary["uplift_ratio"].values
    assert ratio[1] == pytest.approx(ratio[0] * floor.amplification)
    speed = block.p * pgv(RECORD) / (block.gravity * np.tan(block.alpha_c))
    assert summary["velocity_ratio"].values[0] == pytest.approx(speed)
    asked = summary["sliding_share"].values
    assert np.isnan(asked[:2]).all()
    assert asked[2] == pytest.approx(models.sliding_demand(block, GROUND, 0.01, 0.2).share[0])
    history = {one.model: one for one in rp.plots.histories(tree, "burst", "aloft", ["nonlinear"])}["nonlinear"]
    known = np.abs(history.rotation[np.isfinite(history.rotation)])
    assert np.max(known) <= history.peak + 1e-12


@pytest.mark.sweep
def test_histories_aloft_are_at_the_times_of_the_ground_however_long_the_floor_swings():
    """A floor of little damping swings for many times the length of the record."""
    floor = rp.FloorSettings(period=0.5, participation=1.3, damping=0.01)
    tree = rp.assess([RECORD], replace(config(body("aloft", floors=(floor,))), search=rp.SearchSettings()))
    shaken = floor_record(RECORD, (floor,))
    assert (
        shaken.npts == models.floor_motion(GROUND, 0.01, 0.5, 0.01, 1.3, quiet=1e-4 * 9.80665).acceleration.size > 3000
    )
    expected = models.recorded_response(body("one").block(), shaken.acceleration, shaken.dt, history=True)
    (stored,) = rp.plots.histories(tree, "burst", "aloft", ["nonlinear"])
    angle = body("one").block().alpha_c
    np.testing.assert_allclose(angle * stored.rotation, expected.rotation[: RECORD.npts], atol=1e-12)


def response(number, lanes, samples, cycles, **others):
    """Some lanes whose values tell the part, the lane, and the sample or half-cycle."""
    lane = 10.0 * number + np.arange(lanes)
    series = lane[:, np.newaxis] + 0.01 * np.arange(samples)
    table = lane + 0.01 * np.arange(cycles)[:, np.newaxis]
    whole = lane.astype(int)
    halves = HalfCycles(
        table, table + 100.0, table + 200.0, whole + 100 * np.arange(cycles)[:, np.newaxis], table, table
    )
    return Response(
        *(lane, whole % 4, whole, lane, whole, whole),
        time=np.arange(samples),
        rotation=series,
        velocity=-series,
        half_cycles=halves,
        **others,
    )


def test_responses_are_joined_at_the_places_of_their_lanes():
    """The ground has five samples; a floor two in each interval and swings on, another is only longer."""
    lanes = [np.array([3, 0]), np.array([1]), np.array([2, 4])]
    moved = [np.array([True, False]), np.array([True]), np.array([False, True])]
    parts = [
        response(
            number, own.size, samples, cycles, active_samples=10 * number + np.arange(own.size), ground_contact=told
        )
        for (number, own), samples, cycles, told in zip(enumerate(lanes), (5, 12, 17), (1, 3, 2), moved, strict=True)
    ]
    whole = joined_responses(parts, lanes, 5, [1, 2, 1])
    assert whole.time is None
    for part, own, step in zip(parts, lanes, (1, 2, 1), strict=True):
        back, count = whole.take(own), len(part.half_cycles.peak)
        for name in ("peak_rotation_ratio", "outcome", "impacts", "active_samples", "ground_contact"):
            np.testing.assert_array_equal(getattr(back, name), getattr(part, name), err_msg=name)
        for name in ("rotation", "velocity"):
            np.testing.assert_array_equal(getattr(back, name), getattr(part, name)[:, ::step][:, :5], err_msg=name)
        for name, unknown in (("start_velocity", np.nan), ("duration", np.nan), ("impulse_count", -1)):
            found, given = (getattr(one.half_cycles, name) for one in (back, part))
            np.testing.assert_array_equal(found[:count], given)
            np.testing.assert_array_equal(found[count:], np.full((3 - count, own.size), unknown))
    # Where one part has no histories the whole has none, and one part is itself.
    parts[2] = replace(parts[2], rotation=None)
    assert joined_responses(parts, lanes, 5, [1, 2, 1]).rotation is None
    assert joined_responses(parts[1:2], [np.array([0])], 5, [2]).rotation.tolist() == whole.rotation[1:2].tolist()


def test_the_vertical_of_a_floor_is_that_of_the_ground_and_ends_with_it():
    asked = config(body("one"))
    ground = replace(extract(RECORD, asked), vertical=1.0 + RECORD.time)
    there = floor_scene(ground, FeltMotion(None, (FLOOR,)), asked)
    times = there.record.time
    inside = times <= RECORD.duration + 1e-9
    assert not inside.all()
    assert there.vertical == pytest.approx(np.where(inside, 1.0 + times, 0.0))
    assert floor_scene(replace(ground, vertical=None), FeltMotion(None, (FLOOR,)), asked).vertical is None


def test_a_body_has_a_direction_of_its_own_where_it_differs_from_the_record():
    pair = Pair(*PAIR)
    asked = replace(config(), records=rp.RecordSettings(components="azimuth", azimuth=30.0))
    bodies = gather_bodies([body("others"), body("own", azimuth=30.0)], asked.records)
    for azimuth, count in ((30.0, 1), (30.0 + 5e-7, 1), (30.0001, 2), (30.9, 2)):
        found = places_of(bodies, replace(RECORD, azimuth=azimuth), pair, asked)
        assert [place.azimuth for place, _ in found] == [None, 30.0][:count]


@pytest.mark.sweep
def test_the_spectrum_of_the_results_is_that_of_the_ground():
    for blocks, known in (
        ((body("aloft", floors=(FLOOR,)), body("ground")), True),
        ((body("aloft", floors=(FLOOR,)),), False),
    ):
        asked = config(*blocks, **PROBABLE)
        scene, bodies = extract(RECORD, asked), gather_bodies(asked.bodies)
        spectrum = assess_scene(scene, bodies, asked).spectrum
        assert (spectrum is not None) is known
        if known:
            alone = assess_scene(scene, gather_bodies(blocks[1:]), config(*blocks[1:], **PROBABLE)).spectrum
            assert np.array_equal(spectrum.p, alone.p)
            assert np.array_equal(spectrum.probability(np.array([0.9])), alone.probability(np.array([0.9])))


@pytest.mark.sweep
def test_aloft_the_strength_of_the_ground_is_brought_to_a_demand():
    demand = rp.DemandSettings(name="ULS", value=3.0)
    tree = rp.assess([RECORD], replace(config(body("ground"), body("aloft", floors=(FLOOR,))), demands=(demand,)))
    assert tree["summary"]["demand_factor"].values.ravel() == pytest.approx([3.0 / RECORD.pga] * 2)


@pytest.mark.sweep
def test_what_is_told_of_a_floor_is_a_warning_of_the_record_once():
    asked = rp.Config(models=rp.ModelSettings(use=("balanced",)))
    squat = [rp.BlockSettings(name=f"{number}", width=1.0, height=1.0, floors=floors)
             for number, floors in enumerate(((FLOOR,), (rp.FloorSettings(period=0.3),), ()))]  # fmt: skip
    for blocks in (squat[:2], squat):
        told = rp.assess([RECORD], replace(asked, bodies=tuple(blocks)))["summary"]["warnings"].item()
        assert told.count("1 of 1 bodies are outside the range") == 1


def test_a_body_heavy_beside_its_floor_gets_a_warning():
    floor = rp.FloorSettings(period=0.5, mass=1e4)
    summary = rp.assess([RECORD], config(body("heavy", mass=2e3, floors=(floor,))))["summary"]
    assert "is 0.2 times the mass of its floor" in str(summary["block_warnings"].values[0])


def test_what_is_of_the_ground_refuses_bodies_aloft():
    aloft = config(body("aloft", floors=(FLOOR,)))
    with pytest.raises(rp.ConfigError, match=r"\[\[block.floor\]\] of aloft: a calibration uses the ground"):
        rp.calibrate([RECORD], aloft)
    sequence = models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    with pytest.raises(rp.ConfigError, match=r"\[\[block.floor\]\] of aloft: a design sequence"):
        rp.assess_sequence(sequence, aloft)


def channel(name, azimuth, seed):
    rng = np.random.default_rng(seed)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * T + rng.uniform(0.0, 6.0)) for f in (0.5, 0.9, 1.7))
    return rp.Record(
        1.6 * waves * np.exp(-(((T - 2.5) / 1.2) ** 2)),
        dt=0.01,
        id=f"XX.STA..{name}",
        network="XX",
        station="STA",
        channel=name,
        azimuth=azimuth,
        orientation="horizontal",
        processed=True,
    )


PAIR = [channel("HNE", 90.0, 1), channel("HNN", 0.0, 2)]
ANSWERS = ("peak_rotation_ratio", "safety_factor", "overturning_probability", "factor_50", "uplift_ratio")
LEANING = {"one_sided": True}


def turned(*blocks, records=PAIR, sections=None, **options):
    return rp.assess(records, config(*blocks, records=rp.RecordSettings(**options), **sections or {}))


@pytest.mark.parametrize(
    ("options", "direction"),
    [
        ({"azimuth": 30.0}, 30.0),
        pytest.param(LEANING | {"facing": 210.0}, 210.0, marks=pytest.mark.sweep),
        pytest.param(LEANING | {"facing": 300.0}, 300.0, marks=pytest.mark.sweep),
    ],
)
def test_each_body_is_shaken_in_its_own_direction(options, direction):
    blocks = body("others"), body("own", **options)
    common = {"components": "azimuth", "sections": PROBABLE}
    together = turned(*blocks, **common, azimuth=75.0)["summary"].isel(record=0)
    alone = {
        "others": turned(body("others"), **common, azimuth=75.0),
        "own": turned(body("own", **options), **common, azimuth=direction),
    }
    for name, tree in alone.items():
        for what in ANSWERS:
            assert np.array_equal(
                together[what].sel(block=name), tree["summary"][what].isel(record=0, block=0), equal_nan=True
            ), (name, what)
    peaks = together["peak_rotation_ratio"].sel(model="nonlinear").values
    assert peaks[0] != peaks[1]
    assert together["record"].item() == "XX.STA..H075"
    assert together["body_azimuth"].values.tolist() == pytest.approx([np.nan, direction], nan_ok=True)


@pytest.mark.sweep
def test_a_direction_of_its_own_is_the_same_in_every_direction_of_a_sweep():
    tree = turned(body("others"), body("own", azimuth=30.0), components="sweep", azimuth_step=90.0)
    peaks = tree["summary"]["peak_rotation_ratio"].sel(model="nonlinear")
    assert len(set(peaks.sel(block="own").values.tolist())) == 1
    assert len(set(peaks.sel(block="others").values.tolist())) == 2


@pytest.mark.sweep
def test_a_turned_body_on_a_floor_is_shaken_by_the_floor_in_its_direction():
    tree = turned(body("one", azimuth=30.0, floors=(FLOOR,)), components="azimuth", azimuth=75.0)
    same = turned(body("one", floors=(FLOOR,)), components="azimuth", azimuth=30.0)
    for name in (*ANSWERS, "floor_amplification"):
        assert np.array_equal(tree["summary"][name], same["summary"][name], equal_nan=True), name


def test_a_direction_needs_a_pair():
    own = body("own", azimuth=30.0)
    with pytest.raises(rp.ConfigError, match=r'"own" azimuth: a body with its own direction needs pairs of channels'):
        config(own)
    with pytest.raises(rp.ConfigError, match="needs pairs of channels"):
        rp.assess(PAIR, bodies=[own])
    # A channel that faces the direction of the records stands for it, and not for another one.
    tree = turned(body("others"), own, records=PAIR[:1], components="azimuth", azimuth=90.0)
    assert tree["summary"].sizes["record"] == 0
    assert "rotated to the direction of a body, 30 degrees" in str(tree["failures"]["reason"].values[-1])


@pytest.mark.sweep
def test_histories_of_a_turned_body_are_those_that_are_stored():
    blocks = body("others"), body("own", azimuth=30.0)
    records = rp.RecordSettings(components="azimuth", azimuth=75.0)
    for histories in (True, False):
        asked = rp.ModelSettings(use=("nonlinear",), histories=histories)
        tree = rp.assess(PAIR, rp.Config(bodies=blocks, records=records, models=asked))
        if histories:
            own = rp.plots.histories(tree, "XX.STA..H075", "own")[0]
            assert np.nanmax(np.abs(own.rotation)) == pytest.approx(own.peak, rel=0.05)
            continue
        assert rp.plots.histories(tree, "XX.STA..H075", "others")[0].warning == ""
        with pytest.raises(rp.ResultsError, match="the motion in the direction of this body is not in the file"):
            rp.plots.histories(tree, "XX.STA..H075", "own")


@pytest.mark.sweep
def test_fragility_of_each_body_is_that_of_its_place():
    blocks = body("others"), body("own", azimuth=30.0), body("aloft", floors=(FLOOR,))
    there, here = (rp.RecordSettings(components="azimuth", azimuth=azimuth) for azimuth in (75.0, 30.0))
    levels = rp.FragilitySettings(stripe_levels=(0.5, 1.0), measures=("pga", "velocity_ratio"))
    tree = rp.fragility(PAIR, rp.Config(bodies=blocks, records=there, fragility=levels))["capacities"]
    own = rp.fragility(PAIR, rp.Config(bodies=[body("own")], records=here, fragility=levels))["capacities"]
    for name in ("factor", "reached", "measure_value"):
        assert np.array_equal(tree[name].sel(block="own"), own[name].sel(block="own"), equal_nan=True), name
    # Aloft the measure is that of the ground: at the same factors the body is asked about its floor's motion.
    assert np.array_equal(tree["measure_value"].sel(block="aloft"), tree["measure_value"].sel(block="others"))
    reached = [np.sum(tree["reached"].sel(block=name).values == 1) for name in ("others", "aloft")]
    assert reached[0] != reached[1]


@pytest.mark.sweep
def test_a_body_on_a_pedestal_is_assessed_alone_and_as_one_with_it():
    part = rp.PedestalSettings(width=0.5, height=1.0, mass=500.0)
    statue = body("statue", mass=900.0, friction=0.01, pedestals=(part,))
    tree = rp.assess([RECORD], config(body("other"), statue))
    summary = tree["summary"].isel(record=0)
    assert summary["block"].values.tolist() == ["other", "statue", "statue with pedestal"]
    assert summary["pedestal_of"].values.tolist() == ["", "", "statue"]
    whole = models.with_pedestal(statue.block(), 0.5, 1.0, 500.0)
    expected = models.recorded_response(whole, GROUND, 0.01).peak_rotation_ratio
    assert float(summary["peak_rotation_ratio"].sel(model="nonlinear", block="statue with pedestal")) == expected
    told = " ".join(overview(tree).split())
    assert "statue: assessed alone and as one body with its pedestal; the worse result governs: statue" in told
    assert "Slides first: the friction is smaller" in told
    asked = float(models.impact_friction(statue.block()))
    assert Known(tree["summary"].to_dataset(), block="statue").impact_friction(statue.block().restitution) == asked
    assert f"friction required by an impact  {asked:.3g}, for information" in block_details(
        tree["summary"].to_dataset(), "statue"
    )
    with pytest.raises(rp.ConfigError, match=r'"statue" pedestal 1: pedestal width: expected at least'):
        rp.assess([RECORD], config(replace(statue, width=0.6)))
    with pytest.raises(rp.ConfigError, match="a pedestal needs a free-standing body"):
        body("leaning", one_sided=True, pedestals=(part,))
    with pytest.raises(rp.ConfigError, match='two bodies have the name "statue with pedestal"'):
        rp.assess([RECORD], config(statue, body("statue with pedestal")))


def test_a_floor_is_followed_until_it_oscillates_by_less_than_a_thousandth_of_an_uplift():
    """Of a body of slenderness 10, which lifts at a tenth of gravity."""
    found = floor_record(RECORD, (rp.FloorSettings(period=0.5, damping=0.01),))
    assert found.duration > RECORD.duration + 1.0
    assert np.abs(found.acceleration[-round(0.5 / found.dt) :]).max() < 2e-4 * 9.80665
