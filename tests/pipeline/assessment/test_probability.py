"""The probability of overturning of bodies under a record: what it is read from, and what it does not depend on."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from bursts import DT, WALL, motion, record
from nominal import Config as nominal
from nominal import scene_of_record
from numpy.testing import assert_allclose, assert_array_equal

import rockpulse as rp
from rocking.body.limits import RATES
from rockpulse.assessment.assessment import assess
from rockpulse.assessment.probability import record_probability
from rockpulse.assessment.record_assessment import assess_scene
from rockpulse.assessment.spectra import stored_spectrum_values
from rockpulse.config.bodies import gather_bodies
from rockpulse.models import Block, OverturningSpectrum, Uncertainty, overturning_probability, spectrum_lanes
from rockpulse.storage.variables.probability import PROBABILITY, READ, SOURCES

NONLINEAR = rp.ModelSettings(use=("nonlinear",))
NAMES = [name + end for name in READ for end in ("", "_low", "_high")]
PIER = rp.BlockSettings(name="pier", width=0.9, height=5.0)
CHEST = rp.BlockSettings(name="chest", width=0.4, height=0.9)
NONE, SPECTRUM, LIMIT, NONLINEAR_EQUATION, SHARED = range(5)
#: The spectrum of each record is computed, and slender bodies are read from it.
ALL = rp.UncertaintySettings(spectrum="all")


def configured(*blocks, **sections):
    return rp.Config(**{"models": NONLINEAR, "bodies": blocks} | sections)


def probabilities(one, config):
    """By name, of all bodies and their restitutions."""
    return record_probability(scene_of_record(one, config), gather_bodies(config.bodies), config)[0]


@cache
def lanes():
    """Lanes of the motion of the record "one"."""
    return spectrum_lanes(motion(), DT)


def named(found):
    """The factors of a result of `rocking`, by their names in the file."""
    return {name + end: getattr(found, own + end) for name, own in READ.items() for end in ("", "_low", "_high")}


def seed_of(name, seed=0):
    return int(np.random.SeedSequence([seed, *name.encode()]).generate_state(1)[0])


@pytest.fixture(scope="module")
def found():
    """A wall, a pier, and a chest that is too squat for the limit of slender blocks."""
    return probabilities(record("one"), configured(WALL, PIER, CHEST))


def test_every_body_has_samples_of_its_own(found):
    """By the limit of slender blocks, or the nonlinear equation for the chest."""
    own = overturning_probability(Block(half_width=[0.2, 0.45, 0.2], half_height=[1.5, 2.5, 0.45]), motion(), DT,
                                  seed=seed_of("one"))  # fmt: skip
    assert found["probability_source"].tolist() == [LIMIT, LIMIT, NONLINEAR_EQUATION]
    for name, values in named(own).items():
        assert found[name].tolist() == values.tolist(), name
    assert 0.0 < found["overturning_probability"][0] < 1.0  # a case that could tell something
    assert 1.0 < found["factor_10"][2] < found["factor_50"][2] < 10.0


@pytest.mark.sweep
def test_slender_bodies_have_what_the_spectrum_of_the_record_tells_if_all_of_it_is_asked_for(found):
    demands = (rp.DemandSettings(name="ULS", value=4.0),)
    read = probabilities(record("one"), configured(WALL, PIER, CHEST, uncertainty=ALL, demands=demands))
    block = Block(half_width=np.array([0.2, 0.45]), half_height=np.array([1.5, 2.5]))
    spectrum = OverturningSpectrum(lanes())
    assert read["probability_source"].tolist() == [SPECTRUM, SPECTRUM, NONLINEAR_EQUATION]
    for name, values in named(spectrum.factors(block, factor_max=10.0)).items():
        assert read[name][:2].tolist() == values.tolist(), name
        assert read[name][2] == found[name][2], name
    factor = read["demand_factor"][:2]
    assert_allclose(read["demand_probability"][:2], spectrum.overturning(block, factor))
    # The lanes of both differ, and what they estimate does not: on the plateau of the pier P is 0.43 to 0.58 over a
    # third of ln f.
    for name in ("factor_10", "factor_50", "factor_mean"):
        assert np.all((read[f"{name}_low"] < found[name]) & (found[name] < read[f"{name}_high"]))
        assert np.median(np.abs(np.log(read[name] / found[name]))) < 0.1


def test_the_probability_of_uplift_is_that_of_draws(found):
    block, rng = Block(0.9, 5.0), np.random.default_rng(5)
    strength = 1.8 * np.exp(0.1 * rng.standard_normal(200_000))
    alpha = block.alpha_c * np.exp(-0.05 * np.abs(rng.standard_normal(200_000)))
    drawn = np.mean(strength > block.gravity * np.tan(alpha))
    near = probabilities(record("one", peak=1.8), configured(PIER))["uplift_probability"][0]
    # In closed form tan(alpha) is taken as proportional to alpha.
    assert 0.6 < near == pytest.approx(drawn, abs=0.005)
    assert found["uplift_probability"][:2].tolist() == [1.0, 1.0]


def test_bodies_do_not_change_each_others_numbers(found):
    for place, one in ((0, WALL), (2, CHEST)):
        alone = probabilities(record("one"), configured(one))
        for name in PROBABILITY:
            assert alone[name][0] == found[name][place], (one.name, name)


def test_where_the_vertical_acts_every_body_has_lanes_of_its_own():
    records = [record("one", orientation="horizontal", station="S")]
    records.append(replace(record("up", 3, 3.0, orientation="vertical", station="S"), source="one.txt"))
    config = configured(WALL, records=rp.RecordSettings(include_vertical=True, store="none"))
    summary = assess(records, config)["summary"]
    assert summary["probability_source"].values.tolist() == [[NONLINEAR_EQUATION]]
    own = overturning_probability(Block(0.4, 3.0), motion(), DT, vertical=motion(3, 3.0), seed=seed_of("one"))
    assert summary["factor_50"].values[0, 0] == own.factor_50[0]


@pytest.mark.sweep
def test_each_restitution_of_a_list_has_the_probability_that_it_has_alone():
    several, one = replace(WALL, restitution=(0.95, 0.8)), record("one")
    demands = (rp.DemandSettings(name="ULS", value=4.0),)
    summary = assess([one], configured(several, PIER, demands=demands))["summary"]
    assert summary["factor_50"].dims == ("record", "block", "case")
    for case, restitution in enumerate(several.restitution):
        alone = probabilities(one, configured(replace(WALL, restitution=restitution), demands=demands))
        for name in (*NAMES, "demand_probability", "probability_source"):
            assert summary[name].sel(block="wall").isel(case=case).values.ravel() == pytest.approx(
                alone[name].ravel()
            ), name
    wall = summary["factor_50"].sel(block="wall").values.ravel()
    assert wall[0] < wall[1]  # the livelier one overturns before
    # A body with one value has it in both cases.
    pier = probabilities(one, configured(PIER))
    assert_array_equal(summary["factor_50"].sel(block="pier").values.ravel(), pier["factor_50"].repeat(2))


@pytest.mark.sweep
def test_the_uncertainty_is_that_of_the_configuration():
    known = rp.UncertaintySettings(factor=0.05, restitution=(0.8, 0.95), geometry=0.0)
    config = configured(WALL, uncertainty=known, search=rp.SearchSettings(factor_max=3.0))
    found = probabilities(record("one"), config)
    expected = overturning_probability(Block(0.4, 3.0), motion(), DT, known.of_draws(), factor_max=3.0)
    assert known.of_draws() == Uncertainty(factor=0.05, restitution=(0.8, 0.95), geometry=0.0)
    for name, values in named(expected).items():
        assert_array_equal(found[name], values, err_msg=name)


def test_a_factor_beyond_the_search_is_inf_from_the_end_of_the_search_on():
    found = probabilities(record("one", peak=0.5), configured(WALL, search=rp.SearchSettings(factor_max=2.0)))
    assert (found["overturning_probability"], found["probability_source"]) == ([0.0], [LIMIT])
    for name in ("factor_10", "factor_50", "factor_mean"):
        assert [found[name + end][0] for end in ("", "_low", "_high")] == [np.inf, 2.0, np.inf]


@pytest.mark.parametrize("strength", [0.0, 1e-3])
@pytest.mark.parametrize(("known", "source"), [(rp.UncertaintySettings(), LIMIT), (ALL, SPECTRUM)])
def test_a_record_that_lifts_nothing_overturns_nothing(strength, known, source):
    config = configured(WALL, CHEST, uncertainty=known)
    scene, bodies = scene_of_record(record("one"), config), gather_bodies(config.bodies)
    still = replace(scene, record=replace(scene.record, acceleration=strength * motion()))
    found, spectrum = record_probability(still, bodies, config)
    # A record of zeros has no spectrum.
    assert (spectrum is not None) == (source == SPECTRUM and strength > 0.0)
    assert found["probability_source"].tolist() == [source if spectrum else LIMIT, NONLINEAR_EQUATION]
    assert found["overturning_probability_high"] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert found["overturning_probability"] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert found["uplift_probability"] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert found["factor_10_low"].tolist() == [10.0, 10.0]
    assert_array_equal([found[name] for name in ("factor_10", "factor_50", "factor_mean")], np.inf)


@pytest.mark.parametrize(
    "sections",
    [
        {"uncertainty": rp.UncertaintySettings(probability=False)},
        {"models": rp.ModelSettings(use=("sequence", "impulsive", "linear"))},
    ],
    ids=["switched off", "no nonlinear model"],
)
def test_what_is_not_asked_for_is_not_known(sections):
    config = configured(WALL, CHEST, **sections)
    one = assess_scene(scene_of_record(record("one"), config), gather_bodies(config.bodies), config)
    assert one.spectrum is None
    assert one.probability["probability_source"].tolist() == [NONE, NONE]
    assert all(np.isnan(one.probability[name]).all() for name in PROBABILITY if name != "probability_source")
    assert SOURCES[NONE] == "none"


def test_lanes_of_a_body_are_drawn_by_the_seed_and_the_record():
    def tell(name, seed):
        config = configured(CHEST, run=rp.RunSettings(seed=seed))
        return probabilities(record(name), config)["factor_10_low"][0]

    first = tell("one", 0)
    assert first == tell("one", 0)
    assert len({first, tell("one", 1), tell("two", 0)}) == 3


@pytest.mark.sweep
def test_factors_that_are_searched_wait_for_the_key():
    config = nominal(bodies=(WALL,), models=rp.ModelSettings(use=("resonance", "sequence", "balanced", "nonlinear")))
    searched = assess([record("one")], config)
    plain = assess([record("one")], replace(config, search=rp.SearchSettings()))
    factors = [tree["summary"]["safety_factor"].values[0, 0] for tree in (searched, plain)]
    assert_array_equal(factors[0][:3], factors[1][:3])
    assert np.isfinite(factors[0][3])
    assert np.isnan(factors[1][3])
    assert set(plain["overturning_intervals"]["model_index"].values) <= {0, 1, 2}
    assert_allclose(plain["summary"]["interval_count"].values[0, 0, 3], -1)


def test_at_a_demand_the_probability_is_that_of_the_samples_at_its_factor():
    found = probabilities(record("one"), configured(WALL, demands=(rp.DemandSettings(name="ULS", value=4.0),)))
    factor = found["demand_factor"]
    assert 0.25 < factor[0, 0] < 4.0
    own = overturning_probability(Block(0.4, 3.0), motion(), DT)
    assert_allclose(found["demand_probability"], own.overturning(factor))
    assert 0.0 < found["demand_probability"][0, 0] < 1.0


def test_a_demand_from_which_the_record_is_far_has_no_probability():
    """On a slender body, and on one by the nonlinear equation."""
    times = [0.249, 0.251, 3.99, 4.01]
    demands = tuple(rp.DemandSettings(name=f"{one}", value=one * record("one").pga) for one in times)
    found = probabilities(record("one"), configured(WALL, CHEST, demands=demands))
    assert_allclose(found["demand_factor"], [times] * 2)
    assert np.isfinite(found["demand_probability"]).tolist() == [[False, True, True, False]] * 2


@pytest.mark.sweep
def test_the_spectrum_is_stored_at_all_of_its_parameters_if_it_is_asked_for():
    for known, stored in ((ALL, True), (rp.UncertaintySettings(), False)):
        config = configured(WALL, uncertainty=known)
        one = assess_scene(scene_of_record(record("one"), config), gather_bodies(config.bodies), config)
        assert (one.spectrum is not None) is stored
        assert ("spectra" in assess([record("one")], config).children) is stored
        if stored:
            assert_array_equal(one.spectrum.p, RATES)
            for name, values in stored_spectrum_values(one.spectrum).items():
                assert_array_equal(one.spectra[name], values)
                assert np.isfinite(values).all(), name


def test_a_record_that_lifts_many_bodies_in_one_sense_only_is_assessed_in_this_sense():
    pushing = rp.Record(np.abs(motion()), DT, id="one", processed=True)
    walls = [rp.BlockSettings(name=f"wall {k}", width=0.4, height=4.0 + 0.01 * k, one_sided=True) for k in range(70)]
    config = configured(*walls)
    bodies = gather_bodies(config.bodies).lanes
    senses = [overturning_probability(bodies, sign * pushing.acceleration, DT).at_one for sign in (1.0, -1.0)]
    assert min(map(np.max, senses)) == 0.0 < max(map(np.max, senses))
    assert_allclose(probabilities(pushing, config)["overturning_probability"], np.maximum(*senses), atol=0.05)


@pytest.mark.sweep
def test_many_bodies_share_marches_and_none_depends_on_the_others():
    heights = np.random.default_rng(5).uniform(4.0, 5.0, 140)
    many = [rp.BlockSettings(name=f"wall {k}", width=0.8, height=height) for k, height in enumerate(heights)]
    shared, fewer = (probabilities(record("one"), configured(*some, CHEST)) for some in (many, many[:130]))
    assert shared["probability_source"].tolist() == [SHARED] * 140 + [NONLINEAR_EQUATION]
    for name in NAMES:
        assert_array_equal(fewer[name][:130], shared[name][:130])
    none = rp.UncertaintySettings(spectrum="none")
    own = probabilities(record("one"), configured(*many[:12], uncertainty=none))
    assert set(own["probability_source"]) == {LIMIT}
    assert 0.0 < np.max(np.abs(shared["overturning_probability"][:12] - own["overturning_probability"])) < 0.05
    for name in ("factor_10", "factor_50", "factor_mean"):  # a factor on a plateau of P may be far off
        assert np.median(np.abs(np.log(shared[name][:12] / own[name]))) < 0.03
