"""The rule from half-waves to a sequence: its verdict, peak and safety factor in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from nominal import Config

import rockpulse as rp
from rocking import OverturningSpectrum
from rocking.half_wave_demand import HalfWaveDemand, demand_of_half_waves
from rockpulse.calibration.rule import POINTS, Rule, load_rule, sequence_of_demand
from rockpulse.errors import ConfigError
from rockpulse.models import Block, Outcome, sequence_response
from rockpulse.record.synthetic import synthetic_motion

RULE = Rule("balanced", 1.0)


def bodies():
    slenderness, radius = np.array([4.0, 6.0, 8.0, 12.0, 3.0]), np.array([1.0, 2.0, 4.0, 1.0, 8.0])
    alpha = np.arctan(1.0 / slenderness)
    return Block(half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha))


def waves(seed=4, factor=1.0):
    motion = factor * synthetic_motion(seed, duration=12.0, pga=3.5)
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


def test_the_safety_factor_is_where_the_scaled_record_overturns():
    block = bodies()
    factor = RULE.safety_factor(waves(), block)
    for lane in range(5):
        below = RULE.sequence(waves(factor=0.999 * factor[lane]), block.lane(lane))
        above = RULE.sequence(waves(factor=1.001 * factor[lane]), block.lane(lane))
        verdicts = [sequence_response(block.lane(lane), one, paired=True).outcome for one in (below, above)]
        assert verdicts[0] != Outcome.OVERTURNS
        assert verdicts[1] == Outcome.OVERTURNS


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


def test_the_spectrum_of_the_rule_is_its_demand():
    wave = waves()
    block = Block.from_parameters(p=[1.5, 2.5], alpha=0.12, restitution=[0.9, 0.95])
    rule = load_rule("balanced")
    spectrum = OverturningSpectrum(rule.spectrum_lanes(wave)).spectrum([0.9, 0.95])
    rates = np.log(rule.spectrum_lanes(wave).p)
    read = [np.exp(np.interp(np.log(block.p[i]), rates, np.log(spectrum[:, i]))) for i in range(2)]
    demand = rule.demand(wave, block) * block.gravity * np.tan(block.alpha_c) / block.p
    assert read == pytest.approx(demand, rel=0.01)  # ln S read between, and P read between


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("balanced = 1", r"\[balanced\] factor"),
        ("[balanced]\nfactor = 'one'", r"\[balanced\] factor"),
        ("[balanced]\nfactor = -1.0", "positive"),
        ("[balanced", "not valid TOML"),
        ("[conservative]\nfactor = 1.0", r"\[balanced\] factor"),
        ("[balanced]\nfactor = 1.0", r"\[range\]"),
        ("[range]\np = [2.0, 1.0]\n[balanced]\nfactor = 1.0", r"\[range\] p"),
        ("[range]\nq = [1.0, 2.0]\n[balanced]\nfactor = 1.0", "slenderness"),
    ],
)
def test_a_file_that_holds_no_rule_is_refused(tmp_path, text, words):
    path = tmp_path / "rule.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=words):
        load_rule("balanced", path)


def test_the_range_is_that_of_the_bodies_of_the_fit():
    from rockpulse.studies.accuracy.model_form import blocks

    rule = load_rule()
    assert rule.applicable(blocks()).all()
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
    assert rule.applicable(Block(0.5, 0.3, restitution=0.5)).tolist() == [False]  # no Housner's C
    assert Rule("balanced", 1.0).applicable(Block(0.5, 0.6)).tolist() == [True]


def test_the_range_in_words_names_housners_restitution():
    assert load_rule().range_text.endswith(", Housner's C")
    wider = Rule("balanced", 1.0, {"restitution_ratio": (0.9, 1.0), "radius": (1.0, 1.0)})
    assert wider.range_text == "C 0.9 to 1 times Housner's, R 1 to 1 m"


def test_assessments_mark_bodies_unlike_those_of_the_fit():
    config = Config()
    config = replace(config, models=replace(config.models, use=("balanced", "conservative", "linear")))
    record = rp.Record(synthetic_motion(4, duration=12.0, pga=3.5), dt=0.01, id="four", processed=True)
    bodies = {"pier": Block(0.2, 1.6), "tiny": Block(0.02, 0.16), "soft": Block(0.2, 1.6, restitution=0.6)}
    summary = rp.assess([record], config, blocks=bodies)["summary"]
    assert summary["applicable"].values[0].tolist() == [[1, 1, 1], [0, 0, 1], [0, 0, 1]]
    warnings = str(summary["warnings"].values[0])
    assert "balanced: 2 of 3 bodies lie outside" in warnings
    assert "slenderness 4 to 12" in warnings
    fine = rp.assess([record], config, blocks={"pier": bodies["pier"]})["summary"]
    assert "outside" not in str(fine["warnings"].values[0])


def test_a_record_with_impossible_numbers_is_a_row_of_failures():
    config = Config(models=rp.ModelSettings(use=("balanced",)), records=rp.RecordSettings(confirm=("huge",)))
    huge = rp.Record(1e8 * np.sin(0.1 * np.arange(500)), dt=0.01, id="huge", processed=True)
    fine = rp.Record(synthetic_motion(4, duration=12.0, pga=3.5), dt=0.01, id="fine", processed=True)
    tree = rp.assess([huge, fine], config, blocks={"pier": Block(0.2, 1.6)})
    assert tree["summary"]["record"].values.tolist() == ["fine"]
    (reason,) = tree["failures"]["reason"].values
    assert reason.startswith("huge: acceleration")
    assert "m/s2" in reason


def test_an_unknown_point_is_refused():
    with pytest.raises(ConfigError, match="balanced, conservative"):
        load_rule("bold")


def test_assessments_take_both_points(samples):
    config = Config()
    config = replace(
        config,
        models=replace(config.models, use=("balanced", "conservative")),
        records=replace(config.records, store="none"),
    )
    records = [record for record in rp.read(samples / "CICCC.RAW") if record.orientation == "horizontal"][:1]
    summary = rp.assess(records, config, blocks={"wall": Block(0.15, 1.2), "pier": Block(0.5, 1.25)})["summary"]
    assert summary["model"].values.tolist() == ["balanced", "conservative"]
    factor, outcome = summary["safety_factor"].values[0], summary["outcome"].values[0]
    assert np.array_equal(outcome == Outcome.OVERTURNS, factor <= 1.0)
    assert np.all(factor[..., 1] <= factor[..., 0])
    free = factor[..., 1] > 1.001 / summary["uplift_ratio"].values[0]
    # A tenth of the draws fall well before the mean one.
    assert np.all((factor[..., 0] / factor[..., 1])[free] > 1.1)
    assert math.isfinite(float(np.max(factor)))
