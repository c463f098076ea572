"""Fitting and judging: limits come from the other earthquakes, small ensembles get a statement."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rockpulse as rp
from rockpulse.assessment.scene import extract
from rockpulse.calibration.rule import POINTS, Rule, load_rule
from rockpulse.errors import ConfigError
from rockpulse.failures import Failure
from rockpulse.ladder import MODELS
from rockpulse.models import Outcome
from rockpulse.record.intensity import pgv
from rockpulse.record.synthetic import synthetic_motion
from rockpulse.remark import Remark
from rockpulse.storage.rule_variables import RULE_TABLES
from rockpulse.studies.rule.cases import TRUTH, StrongMotion, motion_cases, rule_cases, strong_motions
from rockpulse.studies.rule.judgement import fit_rules, judge_rules, too_few
from rockpulse.views.text.rule import rule_overview, rule_text

SCHEMA = Path(__file__).parents[4] / "docs" / "schema.md"
GIVEN = {point: Rule(point, 1.0) for point in POINTS}


def made_up(seed=0, events=6, cases=50):
    """March that tells well, PGV that tells badly, an earthquake whose overturnings have low scores."""
    random = np.random.default_rng(seed)
    over = random.uniform(size=events * cases) < 0.3
    event = np.repeat([f"event {k}" for k in range(events)], cases)
    march = np.exp(random.normal(0.0, 0.2, over.size) + np.where(over, 0.6, -0.6)) * np.where(
        event == "event 0", 0.5, 1.0
    )
    return pd.DataFrame(
        {
            "record": [f"record {k // 10}" for k in range(over.size)],
            "event": event,
            "slenderness": 4.0,
            "radius": 1.0,
            "scale": 1.0,
            "march": march,
            "build_up": 2.0 * march,
            "uplift_ratio": 10.0,
            "velocity_ratio": np.exp(random.normal(0.0, 0.7, over.size) + np.where(over, 0.6, -0.6)),
            "overturns": over,
            "peak": np.where(over, np.inf, 0.3),
        }
    )


def table(tree, name):
    return tree[name].to_dataset().to_dataframe()


def test_the_factor_misses_no_more_than_its_share():
    cases = made_up()
    rules, fallen = fit_rules(cases), cases[cases["overturns"]]
    for point, share in POINTS.items():
        missed = np.mean(rules[point].factor * fallen["march"] * (1.0 + 1e-12) < 1.0)
        assert missed <= share
        assert missed > share - 1.5 / len(fallen)


def test_a_case_is_judged_by_limits_without_its_earthquake():
    cases = made_up()
    tree = judge_rules(cases, GIVEN, resamples=40)
    stored = table(tree, "cases")
    for event in ("event 0", "event 3"):
        out = cases["event"] == event
        factor = fit_rules(cases[~out])["balanced"].factor
        expected = factor * cases["march"][out].to_numpy()
        assert stored["left_out_march"].to_numpy()[out] == pytest.approx(expected, rel=1e-4)
        # Whatever the left-out earthquake says changes nothing about its own limits.
        silent = cases.assign(overturns=cases["overturns"] & ~out)
        assert fit_rules(silent)["balanced"].factor == factor
    rates = table(tree, "rates").set_index(["score", "kind", "point"])
    low = rates.loc[("march", "left-out", "balanced")]
    assert low.missed > rates.loc[("march", "in-sample", "balanced")].missed  # event 0 is not like the others
    assert low.missed == np.sum(cases["overturns"].values & (stored["left_out_march"].values < 1.0))
    assert low["false"] == np.sum(~cases["overturns"].values & (stored["left_out_march"].values >= 1.0))
    assert (rates.overturnings + rates.survivors == len(cases)).all()
    given = rates.loc[("march", "as-given", "balanced")]
    assert given.missed == np.sum(cases["overturns"] & (cases["march"] < 1.0))


def test_both_scores_go_through_the_same_protocol():
    cases = made_up()
    swapped = cases.assign(march=cases["velocity_ratio"], velocity_ratio=cases["march"])
    one, other = (table(judge_rules(some, {}, resamples=40), "at_missed") for some in (cases, swapped))
    for name in ("march", "velocity_ratio"):
        assert np.array_equal(one[name], other["march" if name == "velocity_ratio" else "velocity_ratio"])
    assert np.allclose(one["difference"], -other["difference"])
    assert np.allclose(one["difference_low"], -other["difference_high"])


def test_peaks_are_those_of_the_sequence():
    cases = made_up().assign(march=0.6, overturns=np.arange(300) % 3 == 0, peak=0.3)
    rates = table(judge_rules(cases, {"balanced": Rule("balanced", 1.0)}, resamples=2), "rates")
    given = rates[rates.kind == "as-given"].iloc[0]
    assert given.peaks == 200
    assert given.peak_bias == pytest.approx((1.0 - 0.8) / 0.3)
    assert given.peak_dispersion == pytest.approx(0.0, abs=1e-12)


def test_a_small_ensemble_gets_a_statement_not_a_number():
    cases = made_up()
    one = cases[cases["event"] == "event 1"]
    assert "in 1 earthquake:" in too_few(one)
    assert too_few(cases.assign(overturns=True))
    assert too_few(cases.assign(overturns=False))
    assert not too_few(cases)
    with pytest.raises(ConfigError, match="add records"):
        fit_rules(one)
    tree = judge_rules(one, GIVEN)
    assert table(tree, "rates").empty
    assert len(table(tree, "cases")) == len(one)
    assert rule_overview(tree).startswith("no verdict on the rule: 5 strong channels of 1 earthquake,")


def test_the_statement_counts_one_as_one():
    cases = made_up()
    one = cases[cases["event"] == "event 1"].iloc[:2].assign(record="a", overturns=[True, False])
    assert too_few(one).startswith("1 strong channel of 1 earthquake, 1 of 2 cases overturns, in 1 earthquake: a rule")


def test_the_schema_has_every_variable_with_dimensions_unit_and_meaning():
    section = SCHEMA.read_text(encoding="utf-8").split("## The file of rule verdicts\n")[1].split("\n## ")[0]
    lines = [line.strip("| ").split(" | ") for line in section.splitlines()]
    found = {(group, name): rest for group, name, *rest in (line for line in lines if len(line) == 5)}
    tree = judge_rules(made_up(), GIVEN, resamples=2)
    since = " (since 1.1)"
    found = {key: [word.removesuffix(since) for word in rest] for key, rest in found.items()}
    expected = {("group", "variable"): ["dimensions", "unit", "meaning"]}
    for group in tree.children:
        for name, variable in tree[group].to_dataset().variables.items():
            flag = ""
            if variable.dtype == np.int8:
                pairs = zip(variable.attrs["flag_values"], variable.attrs["flag_meanings"].split(), strict=True)
                flag = f" (flag: {', '.join(f'{value} {word}' for value, word in pairs)})"
            rest = [*variable.dims, variable.attrs["units"], variable.attrs["long_name"] + flag]
            expected[f"`/{group}`", f"`{name}`"] = rest
    assert found == expected
    assert set(tree.children) == set(RULE_TABLES)


def test_flags_say_what_was_not_computed():
    cases = made_up()
    one = judge_rules(cases[cases["event"] == "event 1"], GIVEN)["cases"].to_dataset()
    for name in ("overturns", "balanced", "conservative"):
        assert one[name].attrs["flag_meanings"].split() == ["not_computed", "no", "yes"]
        assert one[name].attrs["flag_values"].tolist() == [-1, 0, 1]
    assert set(one["balanced"].values) == {-1}
    assert set(one["overturns"].values) == {0, 1}


def test_a_truth_that_overturns_without_uplift_gives_no_range():
    cases = made_up()
    asleep = np.arange(len(cases)) == np.flatnonzero(~cases["overturns"])[0]
    shaken = cases.assign(uplift_ratio=np.where(asleep, 0.9, 10.0), **{f"{TRUTH}0": cases["overturns"] | asleep})
    shaken.loc[asleep, "peak"] = 0.0
    with np.errstate(all="raise"):
        rates = table(judge_rules(shaken, GIVEN, resamples=2), "rates").set_index(["score", "kind", "point"])
    for kind in ("in-sample", "left-out"):  # 1 % of the overturnings is none: the limit is 0, all would be alarms
        row = rates.loc[("march", kind, "conservative")]
        assert np.isnan([row.missed_least, row.missed_most, row.false_least, row.false_most]).all()
        assert np.isfinite([row.missed_share, row.false_share]).all()
        assert np.isfinite(rates.loc[("velocity_alone", kind, "conservative")].false_most)
    assert np.isfinite(rates.loc[("march", "in-sample", "balanced")].false_most)
    assert np.isfinite(rates.loc[("march", "as-given", "conservative")].false_most)


def test_the_text_of_a_rule_loads_back_to_it(tmp_path):
    cases = made_up()
    rules = fit_rules(cases)
    tree = judge_rules(cases, rules, resamples=40)
    path = tmp_path / "rule.toml"
    path.write_text(rule_text(rules, tree, {"records": ['a "b"'], "n": 3}))
    for point, rule in rules.items():
        loaded = load_rule(point, path)
        assert loaded.factor == pytest.approx(rule.factor, rel=1e-5)
        assert loaded.within.keys() == rule.within.keys()
        for name, ends in rule.within.items():
            assert loaded.within[name] == pytest.approx(ends, rel=1e-5)
    shown = rule_overview(tree)
    assert "left-out" in shown
    assert "area under the curve" in shown


def test_the_protocol_takes_strong_horizontal_channels(ridgecrest):
    weak = rp.Record(0.1 * ridgecrest[0].acceleration, dt=0.01, id="weak", orientation="horizontal")
    motions, failures = strong_motions([*ridgecrest, weak])
    assert len(motions) == 6
    assert sorted(failure.kind for failure in failures) == ["vertical"] * 3
    assert len({motion.event for motion in motions}) == 1
    for motion in motions:
        record = motion.record
        peak = np.argmax(np.abs(record.acceleration)) * record.dt
        assert peak <= 25.0 + 1e-9
        assert record.duration <= 68.0 + 1e-9
        assert np.all(record.acceleration[-round(8.0 / record.dt) :] == 0.0)
        assert record.pga > 0.15 * 9.80665


def test_a_channel_above_five_g_is_no_case_before_it_is_confirmed(ridgecrest):
    odd = replace(ridgecrest[0], acceleration=100.0 * ridgecrest[0].acceleration, id="odd", station="")
    motions, failures = strong_motions([odd])
    assert motions == []
    ((stage, kind, reason),) = [(row.stage, row.kind, row.reason) for row in failures]
    assert (stage, kind) == ("rule", "failed")
    assert reason.startswith("odd: peak ")
    assert reason.endswith("correct the unit (--units, or the file), or, if it is right, give --confirm odd")
    assert [motion.record.id for motion in strong_motions([odd], ["o*"])[0]] == ["odd"]


def test_what_is_confirmed_votes_in_the_protocol_too(ridgecrest):
    (record,) = (one for one in ridgecrest if one.id.startswith("CI.CCC..90"))
    odd = Remark("odd_peak", peak=7.0, unit="g", readings="0.007 g if it were cm/s2")
    processed = replace(record, id="b", source="b", processed=True, warnings=(odd,))
    raw = replace(record, id="a", source="a", processed=False)
    for confirm, votes in (([], "a"), (["b"], "b")):
        (motion,), (row,) = strong_motions([raw, processed], confirm)
        assert motion.record.id == votes
        assert (row.kind, "[records]" in row.reason) == ("duplicate", False)


def test_a_pattern_that_fits_no_record_is_no_silent_one(ridgecrest):
    with pytest.raises(ConfigError, match=r"^--confirm: no record has an id that fits typo\*"):
        strong_motions(ridgecrest[:1], ["typo*"])
    unread = Failure("x", "read", "x: damaged", "failed")
    row = strong_motions(ridgecrest[:1], ["typo*"], [unread])[1][0]
    assert (row.file, row.kind) == ("--confirm", "failed")


def test_the_protocol_gives_these_figures_on_a_sample(ridgecrest):
    # Pinned: another order, band, taper, stretch or spread of the copies gives others by more than the tolerance.
    (motion,), _ = strong_motions([record for record in ridgecrest if record.id.startswith("CI.CCC..90")])
    cases = motion_cases(motion)
    assert motion.record.pga == pytest.approx(5.06060, rel=1e-5)
    case = cases[np.isclose(cases.slenderness, 8.0) & np.isclose(cases.radius, 2.0) & (cases.scale == 1.0)].iloc[0]
    assert case.uplift_ratio == pytest.approx(motion.record.pga * 8.0 / 9.80665)
    assert case.velocity_ratio == pytest.approx(0.649399, rel=1e-5)
    assert case.march == pytest.approx(1.32787, rel=2e-3)  # one copy that flips by rounding moves it by 0.7 %
    assert (len(cases), int(cases.overturns.sum())) == (24, 5)
    frequency = np.sqrt(0.75 * 9.80665 / 2.0)
    assert case.velocity_ratio == pytest.approx(frequency * pgv(motion.record) * 8.0 / 9.80665)
    truths = cases.filter(regex=f"^{TRUTH}")
    assert truths.shape == (24, 10)
    assert np.array_equal(truths, motion_cases(motion).filter(regex=f"^{TRUTH}"))
    assert 0.0 < truths.ne(cases.overturns, axis=0).to_numpy().mean() < 0.2


def test_nobody_raises_an_alarm_where_nothing_lifts_but_the_score_without_that_condition():
    cases = made_up()
    sleeping = ~cases["overturns"] & (cases["slenderness"].index % 2 == 0)
    shaken = cases.assign(uplift_ratio=np.where(sleeping, 0.9, 10.0))
    shaken.loc[sleeping, ["march", "velocity_ratio", "peak"]] = 1e3, 1e3, 0.0
    rates = table(judge_rules(shaken, GIVEN, resamples=2), "rates").set_index(["score", "kind", "point"])
    for key, row in rates.iterrows():
        assert (row["false"] >= sleeping.sum()) == (key[0] == "velocity_alone")
        assert row["false"] <= row.survivors - (0 if key[0] == "velocity_alone" else sleeping.sum())


def test_perturbed_truths_give_the_range_of_the_rates():
    cases = made_up()
    random = np.random.default_rng(3)
    truths = {f"{TRUTH}{k}": cases["overturns"] ^ (random.uniform(size=len(cases)) < 0.05) for k in range(4)}
    tree = judge_rules(cases.assign(**truths), GIVEN, resamples=2)
    rates = table(tree, "rates")
    for name in ("missed", "false"):
        assert (rates[f"{name}_least"] <= rates[f"{name}_share"]).all()
        assert (rates[f"{name}_most"] >= rates[f"{name}_share"]).all()
    given = rates[(rates.kind == "as-given") & (rates.point == "balanced")].iloc[0]
    among = [np.mean(cases["march"][truth] < 1.0) for truth in (cases["overturns"], *truths.values())]
    assert (given.missed_least, given.missed_most) == pytest.approx((min(among), max(among)))
    assert table(tree, "cases")["flips"].sum() == sum(np.sum(truth != cases["overturns"]) for truth in truths.values())
    alone = table(judge_rules(cases, GIVEN, resamples=2), "rates")
    assert (alone["false_most"] == alone["false_share"]).all()


def test_intervals_know_that_limits_are_fitted():
    # Every earthquake has its own level: a limit that stays would count none missed beyond those of the whole.
    cases = made_up(events=5, cases=60)
    level = cases["event"].str[-1].astype(int)
    cases = cases.assign(march=cases["march"] * 1.5**level)
    rates = table(judge_rules(cases, {}, resamples=200), "rates").set_index(["score", "kind", "point"])
    inside = rates.loc[("march", "in-sample", "balanced")]
    assert inside.missed_high <= 0.05  # refitted: never more than the share, however the earthquakes fall
    assert rates.loc[("march", "left-out", "balanced")].missed_high > 0.05


def test_a_motion_with_impossible_numbers_is_a_failure():
    record = rp.Record(1e8 * np.sin(0.1 * np.arange(500)), dt=0.01, id="huge", orientation="horizontal")
    cases, failures = rule_cases([StrongMotion(record, "none")])
    assert cases.empty
    assert "huge: acceleration" in failures[0].reason


def test_cases_are_those_of_the_models():
    motion = synthetic_motion(5, duration=15.0, pga=4.0)
    record = rp.Record(motion, dt=0.01, id="five", orientation="horizontal", processed=True)
    cases = motion_cases(StrongMotion(record, "made up"), scales=(1.0,))
    assert len(cases) == 12
    scene = extract(record, rp.Config())
    from rockpulse.studies.accuracy.model_form import blocks

    truth = MODELS["nonlinear"].respond(blocks(), scene)
    assert np.array_equal(cases["overturns"], truth.outcome == Outcome.OVERTURNS)
    alarm = np.minimum(load_rule("balanced").factor * cases["march"], cases["uplift_ratio"]) >= 1.0
    assert np.array_equal(alarm, MODELS["balanced"].respond(blocks(), scene).outcome == Outcome.OVERTURNS)
    half = motion_cases(StrongMotion(record, "made up"), scales=(0.5,))
    assert np.allclose(half["march"], 0.5 * cases["march"])


@pytest.mark.slow
def test_the_shipped_rule_holds_on_motions_that_no_choice_was_made_on():
    # Synthetic motions other than those of docs/decisions/012. They have no pulses, and p PGV does badly on them.
    motions = []
    for seed in range(500, 560):
        record = rp.Record(
            np.concatenate([synthetic_motion(seed), np.zeros(800)]), dt=0.01, id=f"s{seed}", orientation="horizontal"
        )
        motions.append(StrongMotion(record, record.id))
    tree = judge_rules(rule_cases(motions)[0], {point: load_rule(point) for point in POINTS}, resamples=100)
    at = table(tree, "at_missed").set_index(["kind", "missed_share"])
    for kind in ("in-sample", "left-out"):
        assert at.loc[(kind, 0.05)].difference < -0.08
        assert at.loc[(kind, 0.01)].difference < -0.1
    rates = table(tree, "rates").set_index(["kind", "score", "point"])
    assert rates.loc[("as-given", "march", "balanced")].missed_share < 0.1
    assert rates.loc[("as-given", "march", "conservative")].missed_share < 0.03


#: Folders of records that came after the fit of the shipped rule: no part of its set.
LATER = {"dyna_asc_afad", "sigma_itaca", "fema_p695"}


@pytest.mark.slow
def test_the_acceptance_figures_on_real_records(records_folder, samples):
    folders = [folder for folder in sorted(records_folder.iterdir()) if folder.is_dir() and folder.name not in LATER]
    records, _ = rp.read_all([*folders, samples])
    motions, _ = strong_motions(records)
    cases, refused = rule_cases(motions)
    assert not refused
    assert len(motions) >= 20
    for point, rule in fit_rules(cases).items():  # the shipped rule is the one that these records give
        assert load_rule(point).factor == pytest.approx(rule.factor, rel=1e-3)
    tree = judge_rules(cases, {})
    at = table(tree, "at_missed").set_index(["kind", "missed_share"])
    assert at.loc[("in-sample", 0.05)].difference < -0.05
    assert at.loc[("left-out", 0.05)].difference < -0.05
    assert at.loc[("in-sample", 0.01)].difference_high < 0.0
    assert at.loc[("in-sample", 0.05)].difference_alone_high < 0.0
    rates = table(tree, "rates").set_index(["kind", "point", "score"])
    rule, usual = (rates.loc[("left-out", "conservative", score)] for score in ("march", "velocity_ratio"))
    assert rule.missed_share <= 0.01
    assert rule.false_share < usual.false_share - 0.1
    assert usual.false_difference_high < 0.0
    balanced = rates.loc[("left-out", "balanced", "march")]
    assert balanced.missed_share <= 0.05
    assert balanced.false_share < rates.loc[("left-out", "balanced", "velocity_ratio")].false_share - 0.05
    assert balanced.missed_most < 0.08  # over perturbed truths
    assert balanced.false_most < 0.09
