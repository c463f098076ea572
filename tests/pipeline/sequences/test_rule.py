"""The rule from half-waves to a sequence: its verdict, peak and safety factor in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from nominal import Config

import rockpulse as rp
from rocking import OverturningSpectrum
from rocking.spectrum.half_waves import HalfWaveDemand, demand_of_half_waves, half_wave_lanes
from rockpulse.errors import ConfigError
from rockpulse.models import Block, Outcome, sequence_response
from rockpulse.sequences.rule import POINTS, Rule, load_rule, sequence_of_demand
from synthetic import synthetic_motion

RULE = Rule("balanced", 1.0)


def bodies():
    slenderness, radius = np.array([4.0, 6.0, 8.0, 12.0, 3.0]), np.array([1.0, 2.0, 4.0, 1.0, 8.0])
    alpha = np.arctan(1.0 / slenderness)
    return Block(half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha))


def waves(seed=4, factor=1.0):
    motion = factor * synthetic_motion(seed, duration=8.0, pga=3.5)
    return rp.half_waves(rp.Record(motion, dt=0.01, id="synthetic", processed=True))


def asked(count, ratio):
    size = np.size(count)
    unused = np.full(size, np.nan)
    return HalfWaveDemand(unused, unused, np.asarray(count), np.asarray(ratio), unused)


def test_the_sequence_overturns_where_the_demand_reaches_one_and_peaks_in_closed_form():
    random = np.random.default_rng(8)
    count, ratio = random.integers(1, 45, 300), random.uniform(0.0, 0.5, 300)
    demand = np.concatenate([random.uniform(0.01, 2.0, 200), [1.0 - 1e-9, 1.0, 1.0 + 1e-9, 0.999] * 25])
    alpha = random.uniform(0.05, 0.3, 300)
    block = Block.from_parameters(
        p=random.uniform(0.7, 8.0, 300), alpha=alpha, restitution=random.uniform(0.6, 1.0, 300)
    )
    sequence = sequence_of_demand(demand, asked(count, ratio), block, np.full(300, True))
    response = sequence_response(block, sequence, paired=True)
    assert np.array_equal(response.outcome == Outcome.OVERTURNS, demand >= 1.0)
    survives = demand < 1.0
    assert response.peak_rotation_ratio[survives] == pytest.approx(1.0 - np.sqrt(1.0 - demand[survives] ** 2), rel=1e-6)
    just = (demand >= 1.0) & (demand < 1.0 + 1e-6)
    assert np.array_equal(response.overturning_half_cycle[just], count[just])


@pytest.mark.sweep
def test_a_record_has_a_sequence_for_every_block():
    block, wave = bodies(), waves()
    demand, sequence = RULE.demand(wave, block), RULE.sequence(wave, block)
    assert sequence.shape == (5,)
    response = sequence_response(block, sequence, paired=True)
    lifted = np.max(np.abs(wave.peak)) > block.gravity * np.tan(block.alpha_c)
    assert np.array_equal(response.outcome == Outcome.OVERTURNS, lifted & (demand >= 1.0))
    assert np.all(sequence.secondary <= 0.5 * sequence.main)
    for lane in (0, 3):
        alone = RULE.sequence(wave, block.lane(lane))
        assert alone.main == pytest.approx(sequence.main[lane : lane + 1])


@pytest.mark.sweep
def test_the_safety_factor_is_where_the_scaled_record_overturns():
    block = bodies()
    factor = RULE.safety_factor(waves(), block)
    for lane in (0, 4):
        below = RULE.sequence(waves(factor=0.999 * factor[lane]), block.lane(lane))
        above = RULE.sequence(waves(factor=1.001 * factor[lane]), block.lane(lane))
        verdicts = [sequence_response(block.lane(lane), one, paired=True).outcome for one in (below, above)]
        assert verdicts[0] != Outcome.OVERTURNS
        assert verdicts[1] == Outcome.OVERTURNS


@pytest.mark.sweep
def test_what_does_not_lift_rests_and_the_safety_factor_is_at_least_that_of_uplift():
    block, wave = bodies(), waves(factor=0.1)
    ratio = np.max(np.abs(wave.peak)) / (block.gravity * np.tan(block.alpha_c))
    assert np.any(ratio < 1.0)
    response = sequence_response(block, Rule("conservative", 1e6).sequence(wave, block), paired=True)
    assert np.array_equal(response.outcome == Outcome.AT_REST, ratio <= 1.0)
    assert Rule("conservative", 1e6).safety_factor(wave, block) == pytest.approx(1.0 / ratio)


def test_a_record_of_zeros_asks_for_nothing():
    block = bodies()
    silent = rp.half_waves(rp.Record(np.zeros(100), dt=0.01, id="silence", processed=True))
    assert RULE.demand(silent, block).tolist() == [0.0] * 5
    assert np.all(np.isinf(RULE.safety_factor(silent, block)))
    assert np.all(sequence_response(block, RULE.sequence(silent, block), paired=True).outcome == Outcome.AT_REST)


@pytest.mark.sweep
def test_the_shipped_points_are_the_mean_capacity_and_the_factor_of_ten_per_cent():
    rules = {point: load_rule(point) for point in POINTS}
    assert {rule.point for rule in rules.values()} == set(POINTS)
    wave, block = waves(), bodies()
    asked = demand_of_half_waves(block, wave.start, wave.centroid, wave.end, wave.impulse)
    lifting = np.max(np.abs(wave.peak)) / (block.gravity * np.tan(block.alpha_c))
    for point, march in (("balanced", asked.march), ("conservative", asked.march_10)):
        assert rules[point].demand(wave, block) == pytest.approx(np.minimum(rules[point].factor * march, lifting))
        assert 0.9 < rules[point].factor < 1.1  # the march is all but unbiased
    assert np.all(rules["balanced"].demand(wave, block) <= rules["conservative"].demand(wave, block))


@pytest.mark.sweep
def test_the_spectrum_of_the_rule_is_its_demand():
    wave = waves()
    block = Block.from_parameters(p=[1.5, 2.5], alpha=0.12, restitution=[0.9, 0.95])
    rule = load_rule("balanced")
    spectrum = OverturningSpectrum(rule.spectrum_lanes(wave)).spectrum([0.9, 0.95])
    rates = np.log(rule.spectrum_lanes(wave).p)
    read = [np.exp(np.interp(np.log(block.p[i]), rates, np.log(spectrum[:, i]))) for i in range(2)]
    demand = rule.demand(wave, block) * block.gravity * np.tan(block.alpha_c) / block.p
    # The spectrum is read between its p, and has other lanes than the march at the p and C of a body. Each has a
    # standard deviation of 0.02 (docs/decisions/018), and 0.08 is nearly three times that of their difference.
    assert np.array(read) == pytest.approx(demand, rel=0.08)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("balanced = 1", r"key factor of \[balanced\]"),
        ("[range]\np = [1.0, 2.0]\n[balanced]\nfactor = -1.0", "positive"),
        ("[balanced", "not valid TOML"),
        ("[range]\np = [1.0, 2.0]\n[conservative]\nfactor = 1.0", r"key factor of \[balanced\]"),
        ("[balanced]\nfactor = 1.0", r"in \[range\], two numbers"),
        ("[range]\np = [nan, 1.0]\n[balanced]\nfactor = 1.0", r"in \[range\], two numbers"),
        ("[range]\np = [2.0, 1.0]\n[balanced]\nfactor = 1.0", r"in \[range\], two numbers"),
        ("[range]\nq = [1.0, 2.0]\n[balanced]\nfactor = 1.0", "slenderness"),
        ("[range]\np = 1.0\n[balanced]\nfactor = 1.0", r"two numbers \[lowest, highest\]"),
    ],
)
def test_a_file_that_holds_no_rule_is_refused(tmp_path, text, words):
    path = tmp_path / "rule.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=words):
        load_rule("balanced", path)


def test_the_range_is_that_of_the_bodies_of_the_fit():
    rule = load_rule()
    slenderness, radius = np.array([(a, r) for a in (4.0, 6.0, 8.0, 12.0) for r in (1.0, 2.0, 4.0)]).T
    of_fit = np.arctan(1.0 / slenderness)
    assert rule.applicable(Block(half_width=radius * np.sin(of_fit), half_height=radius * np.cos(of_fit))).all()
    alpha = np.arctan(1.0 / 8.0)
    usual = {"p": 2.0, "alpha": alpha, "restitution": 1.0 - 1.5 * np.sin(alpha) ** 2}
    for other, inside in (
        ({}, True),
        ({"p": 1.34}, False),
        ({"p": 2.72}, True),  # within the slack
        ({"p": 2.75}, False),
        ({"restitution": 0.9 * usual["restitution"]}, False),
        ({"restitution": 0.98}, True),
        ({"radius": 0.9}, True),  # that of its own: the motion is that of the rectangle with its p
        ({"alpha": np.arctan(1.0 / 3.5)}, False),
        ({"alpha": np.arctan(1.0 / 13.0)}, False),
    ):
        assert rule.applicable(Block.from_parameters(**usual | other)).tolist() == [inside], other
    assert rule.applicable(Block(1.0, 0.6, restitution=0.5)).tolist() == [False]  # no Housner's C
    assert Rule("balanced", 1.0).applicable(Block(1.0, 1.2)).tolist() == [True]


def test_a_file_of_whole_numbers_and_of_one_value_is_a_rule(tmp_path):
    path = tmp_path / "rule.toml"
    path.write_text("[range]\np = [1, 2]\nradius = [1.5, 1.5]\n[balanced]\nfactor = 1\n")
    assert load_rule("balanced", path) == Rule("balanced", 1.0, {"p": (1.0, 2.0), "radius": (1.5, 1.5)})


def test_every_factor_from_the_safety_factor_on_overturns_up_to_the_largest_that_is_asked_for():
    block, wave = bodies(), waves()
    factor = RULE.safety_factor(wave, block)
    largest = float(np.sort(factor)[2])  # the very safety factor of one of them
    found = RULE.intervals(wave, block, largest)
    inside = factor <= largest
    assert np.count_nonzero(inside) == 3
    assert found.safety_factor.tolist() == np.where(inside, factor, np.inf).tolist()
    assert found.safe_up_to.tolist() == np.where(inside, factor, largest).tolist()
    assert found.lane.tolist() == np.flatnonzero(inside).tolist()
    assert found.lower.tolist() == factor[inside].tolist()
    assert found.upper.tolist() == [largest] * 3
    assert found.open.tolist() == found.resolved.tolist() == [True] * 3
    assert found.step.tolist() == [1.0] * 5


def test_a_factor_on_the_march_moves_the_lanes_of_the_spectrum():
    """x is the impulse at which a lane overturns, so the factor divides it; no lane overturns before it is lifted."""
    wave = waves()
    p = np.array([0.8, 2.0, 5.0])
    plain = half_wave_lanes(wave.start, wave.centroid, wave.end, wave.impulse, p)
    lifted = np.log(p / np.max(np.abs(wave.peak)))
    for factor in (1.0, 1.6):
        found = Rule("balanced", factor).spectrum_lanes(wave, p)
        assert found.log_x == pytest.approx(plain.log_x - np.log(factor), rel=1e-12)
        assert found.bottom == pytest.approx(np.maximum(plain.bottom - np.log(factor), lifted), rel=1e-12)
        assert found.top == pytest.approx(np.maximum(plain.top - np.log(factor), found.bottom), rel=1e-12)
        early = found.log_x <= found.bottom[:, np.newaxis]
        assert np.array_equal(found.weight, np.where(early, 0.0, plain.weight))
    assert np.any(early)
    assert not np.all(early)


def test_a_sequence_has_number_ratio_and_interval_of_the_half_waves():
    block = Block.from_parameters(p=[2.0, 3.0, 4.0], alpha=0.1, restitution=0.9)
    nothing = np.full(3, np.nan)
    of_waves = HalfWaveDemand(
        nothing, nothing, np.array([1, 3, 2]), np.array([0.4, 0.2, 0.0]), np.array([0.3, 0.5, 0.7])
    )
    found = sequence_of_demand(np.array([0.5, 0.8, 1.2]), of_waves, block, np.array([True, True, False]))
    # The bracket: 1 - 0.2; 0.8 (1 + 0.9 + 0.81) + 0.1.
    main = np.array([0.5 / 0.8, 0.8 / (0.8 * 2.71 + 0.1), 0.0]) * block.critical_impulse
    assert found.main == pytest.approx(main)
    assert found.secondary == pytest.approx(main * [0.4, 0.2, 0.0])
    assert found.interval.tolist() == [0.3, 0.5, 0.7]
    assert found.main_count.tolist() == [1, 3, 2]
    assert np.all(np.isinf(found.duration))
    assert found.spacing == "continuous"


def test_a_record_that_just_does_not_lift_a_body_has_no_impulse():
    wave = waves()
    alpha = np.arctan(np.max(np.abs(wave.peak)) / 9.80665 * np.array([1.0 - 1e-9, 1.0 + 1e-9]))
    block = Block.from_parameters(p=2.0, alpha=alpha, restitution=0.9)
    assert (RULE.sequence(wave, block).main > 0.0).tolist() == [True, False]


def test_the_range_in_words_names_housners_restitution():
    assert load_rule().range_text.endswith(", Housner's C")
    wider = Rule("balanced", 1.0, {"restitution_ratio": (0.9, 1.0), "radius": (1.0, 1.0)})
    assert wider.range_text == "C 0.9 to 1 times Housner's, R 1 to 1 m"


@pytest.mark.sweep
def test_assessments_mark_bodies_unlike_those_of_the_fit():
    config = Config()
    config = replace(config, models=replace(config.models, use=("balanced", "conservative", "linear")))
    record = rp.Record(synthetic_motion(4, duration=6.0, pga=3.5), dt=0.01, id="four", processed=True)
    bodies = {"pier": Block(0.4, 3.2), "tiny": Block(0.04, 0.32), "soft": Block(0.4, 3.2, restitution=0.6)}
    summary = rp.assess([record], config, bodies=bodies)["summary"]
    assert summary["applicable"].values[0].tolist() == [[1, 1, 1], [0, 0, 1], [0, 0, 1]]
    warnings = str(summary["warnings"].values[0])
    assert "balanced: 2 of 3 bodies are outside" in warnings
    assert "slenderness 4 to 12" in warnings
    fine = rp.assess([record], config, bodies={"pier": bodies["pier"]})["summary"]
    assert "outside" not in str(fine["warnings"].values[0])
