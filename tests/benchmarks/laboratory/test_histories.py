"""The checks of codes against time histories: cases of small motions, and rates worked by hand."""

from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pandas as pd
import pytest

import rockpulse as rp
from laboratory.ensemble import StrongMotion, blocks, strong_motions
from laboratory.histories import ALLOWED, ENDS, PANELS, check_rates, draw, motion_cases, overview, spectrum_at_bodies
from laboratory.record_criterion import demand_cases, record_verdicts, verdict_counts
from rockpulse.config.study_settings import CheckSettings
from rockpulse.record.intensity import spectral_acceleration

pytestmark = pytest.mark.slow

SURE = CheckSettings(confidence_factor=1.0)


def motion(seed):
    times = np.arange(0.0, 8.0, 0.02)
    rng = np.random.default_rng(seed)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * times + rng.uniform(0.0, 6.0)) for f in (0.5, 0.9, 2.1))
    waves *= 3.0 / np.max(np.abs(waves)) * np.exp(-(((times - 4.0) / 2.0) ** 2))
    return StrongMotion(rp.Record(waves, dt=0.02, id=f"r{seed}", event=str(seed)), f"event {seed}")


@pytest.fixture(scope="module")
def cases():
    return pd.concat([motion_cases(motion(seed), SURE) for seed in range(2)], ignore_index=True)


def test_each_channel_is_its_own_code(cases):
    assert len(cases) == 2 * 12
    bodies, record = blocks(), motion(0).record
    first = cases[cases["record"] == "r0"].reset_index(drop=True)
    # Linear: a_0* over PGA/q. Nonlinear: 0.4 d_0 over the displacement of the record's own spectrum at T_s.
    assert first["linear"].to_numpy() == pytest.approx(9.80665 * np.tan(bodies.alpha_c) / (record.pga / 2.0))
    lane = 5
    furthest = bodies.radius[lane] * np.sin(bodies.alpha_c[lane])
    period = 2.0 * np.pi * (0.16 * furthest / (0.84 * 9.80665 * np.tan(bodies.alpha_c[lane]))) ** 0.5
    asked = spectral_acceleration(record, period) * (period / (2.0 * np.pi)) ** 2
    assert first["nonlinear"][lane] == pytest.approx(0.4 * furthest / asked)
    assert (first["both"] == first[["linear", "nonlinear"]].min(axis=1)).all()


def test_the_confidence_factor_lowers_what_is_allowed(cases):
    sure = cases[cases["record"] == "r0"].reset_index(drop=True)
    unsure = motion_cases(motion(0), CheckSettings(confidence_factor=1.35))
    assert unsure["linear"].to_numpy() == pytest.approx(sure["linear"].to_numpy() / 1.35)
    assert (unsure["displacement"] <= sure["displacement"]).all()


def table(rows):
    frame = pd.DataFrame(rows, columns=["event", "factor_50", "allowed"])
    frame = frame.assign(factor_10=0.7 * frame["factor_50"], uplift_factor=0.5 * frame["factor_50"])
    return frame.assign(**dict.fromkeys(ALLOWED, frame["allowed"]))


def test_rates_are_those_counted_by_hand():
    """At factor 1 two overturn, one of them allowed up to 1.2 (missed); two stand, one allowed only to 0.9 (false)."""
    found = check_rates(table([("a", 0.8, 1.2), ("a", 0.9, 0.4), ("b", 3.0, 0.9), ("b", 1.5, 4.0)]))
    one = found[(found["check"] == "linear") & (found["factor"] == 1.0)].iloc[0]
    assert one[["overturned", "missed", "standing", "false"]].tolist() == [2, 1, 2, 1]
    # Allowed at 1 are the first and the last: f_10 0.56 and 1.05, uplift 0.4 and 0.75.
    assert one[["passed", "missed_10", "passed_lifted"]].tolist() == [2, 1, 2]
    assert (one["missed_share"], one["false_share"]) == (0.5, 0.5)
    assert np.isnan(one["missed_low"])  # two earthquakes have no interval
    whole = found[(found["check"] == "linear") & found["factor"].isna()].iloc[0]
    parts = found[(found["check"] == "linear") & found["factor"].notna()]
    assert whole["missed"] == parts["missed"].sum()
    assert whole["overturned"] + whole["standing"] == 12


def test_intervals_are_over_earthquakes():
    """Forty copies of a case tell no more than one: the interval of ten earthquakes is as wide with one case each."""
    rng = np.random.default_rng(0)
    single = [(f"e{k}", 0.8, 1.2 if rng.uniform() < 0.3 else 0.5) for k in range(10)]
    one, many = (check_rates(table(rows)) for rows in (single, [row for row in single for _ in range(40)]))
    for name in ("missed_low", "missed_high"):
        assert many[name].to_numpy() == pytest.approx(one[name].to_numpy(), nan_ok=True)
    at_one = one[(one["check"] == "linear") & (one["factor"] == 1.0)].iloc[0]
    assert at_one["missed_low"] < at_one["missed_share"] < at_one["missed_high"]


def test_the_verdict_by_records_counts_every_record():
    """Three earthquakes: a set of three is all of them, a set of seven does not exist."""
    rotations = {0: (0.5, 0.1, 0.1), 1: (0.1, 0.1, 0.1), 2: (np.inf, 0.1, 0.1)}
    rows = [
        {"demand": 0.2, "lane": lane, "event": f"e{event}", "rotation": one, "probability": 0.1 * event}
        for lane, peaks in rotations.items()
        for event, one in enumerate(peaks)
    ]
    found = record_verdicts(pd.DataFrame(rows), sizes=(3,))
    assert found["probability"].to_numpy() == pytest.approx([0.1] * 3)
    assert found["slv_all"].tolist() == found["slv_3"].tolist() == [1.0, 0.0, 1.0]
    assert found["slc_all"].tolist() == found["slc_3"].tolist() == [0.0, 0.0, 1.0]


def test_the_picture_and_the_text_hold_every_check(cases):
    rates = check_rates(cases)
    told = overview(cases, rates, SURE)
    assert "2 channels of 2 earthquakes, 12 bodies" in told
    whole = rates[(rates["check"] == "linear") & rates["factor"].isna()].iloc[0]
    stood = whole["standing"] - whole["false"]
    assert f"{ALLOWED['linear']}: {stood} of {stood + whole['missed']} cases that pass stand" in told
    figure = draw(cases, SURE)
    assert len(figure.axes) == len(PANELS)
    ratio = np.clip(cases["factor_50"] / cases["linear"], *ENDS)
    shown = np.concatenate([np.asarray(points.get_offsets())[:, 1] for points in figure.axes[0].collections])
    assert np.sort(shown) == pytest.approx(np.sort(ratio))


def percent(value, low=np.nan, high=np.nan):
    shown, *ends = (f"{float(f'{100.0 * one:.2g}'):g}" for one in (value, low, high))
    return f"{shown} %" if np.isnan(low) else f"{shown} % ({'-'.join(ends)})"


NAMES = {
    "linear": "linear",
    "nonlinear": "nonlinear, 2009",
    "both": "both of 2009",
    "displacement": "displacement, 2019",
    "free": "linear, free to vibrate",
    "free_displacement": "displacement, free to vibrate",
}


def manual_rows(rates):
    """The rows of the table in docs/theory/safety.md."""
    for place, row in enumerate(rates.sort_values("factor", kind="stable").itertuples()):
        first = place % len(NAMES) == 0
        factor = "all" if np.isnan(row.factor) else f"{row.factor:g}"
        cases = row.overturned + row.standing
        yield " | ".join(
            (
                f"| {factor} | {row.overturned} of {cases}" if first else "| |",
                NAMES[row.check],
                percent(row.missed_share, row.missed_low, row.missed_high),
                f"{row.missed_10} of {row.passed} ({row.passed_lifted})",
                f"{percent(row.false_share, row.false_low, row.false_high)} |",
            )
        )


def verdict_rows(counts):
    """The rows of the table of verdicts by records in docs/theory/safety.md."""
    for one in counts.itertuples():
        demand = "all" if np.isnan(one.demand) else f"{one.demand:g} g"
        sets = (f"{100.0 * getattr(one, name) / one.bodies:.0f} %" for name in ("slv_7", "slc_7", "slv_3", "slc_3"))
        fails = (f"{one.slv_all:.0f}", f"{one.slc_all:.0f}", *sets)
        yield f"| {demand} | {one.overturns} | {one.may_overturn} | {' | '.join(fails)} |"


@pytest.mark.slow
def test_the_table_of_the_manual_is_what_comes_out_on_fema_p695(records_folder, tmp_path):
    """43 channels, 12 bodies, factors 0.5, 1 and 2."""
    told = pd.read_csv(records_folder / "fema_p695" / "events.tsv", sep="\t")
    with ZipFile(records_folder / "fema_p695" / "records.zip") as archive:
        archive.extractall(tmp_path / "p695")
    events = pd.DataFrame({"record": told["file"].str[:-4] + ".1", "event": told["event"] + " " + told["date"]})
    records = rp.read_all([tmp_path / "p695"], "g")[0]
    motions, _ = strong_motions(records, titles=dict(zip(events["record"], events["event"], strict=True)))
    assert len(motions) == 43
    spectra = [(one, spectrum_at_bodies(one)) for one in motions]
    rates = check_rates(pd.concat([motion_cases(one, SURE, own) for one, own in spectra], ignore_index=True))
    counts = verdict_counts(record_verdicts(pd.concat([demand_cases(*one) for one in spectra], ignore_index=True)))
    page = (Path(__file__).parents[3] / "docs" / "theory" / "safety.md").read_text(encoding="utf-8")
    assert rates["passed"].max() > 500
    missing = [row for row in (*manual_rows(rates), *verdict_rows(counts)) if row not in page]
    assert missing == []
