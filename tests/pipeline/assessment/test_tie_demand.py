"""Ties at the demand: what is stored for each record, what governs, and what is said of it."""

import numpy as np
import pytest

import rockpulse as rp
from rocking import recorded_response
from rocking.body.restraint import TieState
from rockpulse.assessment.answers import answers_of
from rockpulse.assessment.verdict import tie_findings, verdicts
from rockpulse.storage.variables.summary import SUMMARY
from rockpulse.views.shared.words import writing
from rockpulse.views.text.overview import overview
from synthetic import synthetic_motion

FACADE = rp.BlockSettings(
    name="facade",
    width=0.8,
    height=9.0,
    density=1800.0,
    length=1.0,
    one_sided=True,
    ties=(
        rp.TieSettings(height=8.0, stiffness=6.3e6, yield_force=1.5e4, ultimate=0.5),
        rp.TieSettings(height=4.0, stiffness=1e5, gap=0.001),
    ),
)
SCREEN = rp.BlockSettings(name="screen", width=0.4, height=2.5)
CONFIG = rp.Config(bodies=(FACADE, SCREEN), demands=(rp.DemandSettings(name="ULS", value=3.5),))


@pytest.fixture(scope="module")
def tree():
    motions = [synthetic_motion(seed=seed, duration=6.0, pga=2.5) for seed in (1, 2)]
    records = [rp.Record(one, dt=0.01, id=f"r{k}", azimuth=0.0, processed=True) for k, one in enumerate(motions)]
    return rp.assess(records, CONFIG)


@pytest.mark.sweep
def test_each_record_has_the_demand_of_the_worse_sense(tree):
    summary = tree["summary"].to_dataset()
    for name in ("demand_tie_elongation", "demand_tie_force", "demand_tie_share", "demand_tie_state"):
        assert summary[name].dims == tuple(dim for dim in SUMMARY[name].dims if dim != "case")
        assert summary[name].attrs["units"] == SUMMARY[name].units
    block = FACADE.block()
    for seed, row in ((1, 0), (2, 1)):
        motion = synthetic_motion(seed=seed, duration=6.0, pga=2.5)
        factor = float(summary["demand_factor"][row, 0, 0])
        found = [recorded_response(block, sign * factor * motion, 0.01) for sign in (1.0, -1.0)]
        worse = max(found, key=lambda one: one.peak_rotation_ratio)
        held = summary.isel(record=row, block=0, demand=0)
        assert worse.peak_rotation_ratio == pytest.approx(float(held["demand_rotation_ratio"]), rel=1e-12)
        turned = worse.corner_rotation[0]
        moved = np.array([8.0 * np.sin(turned), max(4.0 * np.sin(turned) - 0.001, 0.0)])
        assert held["demand_tie_elongation"].values == pytest.approx(moved, rel=1e-9)
        force = np.minimum(moved * [6.3e6, 1e5], [1.5e4, np.inf])
        assert held["demand_tie_force"].values == pytest.approx(force, rel=1e-9)
        assert held["demand_tie_share"].values == pytest.approx([moved[0] / 0.5, np.nan], nan_ok=True)
        yields = moved[0] > 1.5e4 / 6.3e6
        assert held["demand_tie_state"].values[0] == (TieState.YIELDED if yields else TieState.ELASTIC)
    assert np.isnan(summary["demand_tie_elongation"][:, 1]).all()
    assert (summary["demand_tie_state"][:, 1] == -1).all()


@pytest.mark.sweep
def test_the_largest_elongation_governs_and_sizes_the_anchor(tree):
    answers = answers_of(tree)
    first, second = tie_findings(answers, verdicts(answers))
    stored = answers.summary["demand_tie_elongation"].values[:, 0, 0]
    assert first.elongation == stored[:, 0].max()
    assert first.governing == stored[:, 0].argmax()
    assert first.share == pytest.approx(first.elongation / 0.5)
    assert (first.number, first.tie.yield_force, first.broken, first.motions) == (1, 1.5e4, 0, 2)
    assert (second.yielded, np.isnan(second.share)) == (0, True)
    screen = overview(tree)
    assert "the anchor must take" in screen
    assert "facade, tie 2" in screen


@pytest.mark.sweep
def test_a_tie_without_ultimate_is_warned_of_by_code_and_in_both_languages(tree):
    from rockpulse.views.report.writing import _in_language

    summary = tree["summary"].to_dataset()
    assert summary["block_warning_codes"].values.tolist() == ["tie_unlimited", ""]
    assert "tie 2 at 4 m never breaks" in summary["block_warnings"].item(0)
    with writing("it"):
        translated = _in_language(tree)["summary"]["block_warnings"].item(0)
    assert "la catena 2 a 4 m non si rompe mai" in translated


def test_without_ties_nothing_is_stored():
    still = rp.Record(synthetic_motion(seed=1, duration=2.0, pga=0.1), dt=0.01, id="r", azimuth=0.0, processed=True)
    found = rp.assess(still, rp.Config(bodies=(SCREEN,), demands=CONFIG.demands))
    assert "tie" not in found["summary"].dims
    assert tie_findings(answers_of(found), verdicts(answers_of(found))) == []
