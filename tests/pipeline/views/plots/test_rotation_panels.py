"""Rotation histories show every model's motion, its impacts and its overturning; what cannot be shown says why."""

import re
from dataclasses import replace

import numpy as np
import pytest
from drawn import named_rows

import rockpulse as rp
from rockpulse import ModelSettings, SearchSettings
from rockpulse.errors import ResultsError
from rockpulse.views.plots.drawing import draw
from rockpulse.views.plots.ground_motion import stored_record
from rockpulse.views.plots.model_histories import ModelHistory, histories
from rockpulse.views.plots.rotation_panels import rotation_history
from rockpulse.views.plots.selection import block_of

COLUMN = "column of $one$ piece"


@pytest.fixture(scope="module")
def drawn(assessed, first):
    models = ["nonlinear", "linear", "impulsive", "sequence", "resonance"]
    found = histories(assessed, first, "wall", models)
    return found, rotation_history(found, title="wall")


def curves(ax):
    return [line for line in ax.lines if line.get_label() and not line.get_label().startswith("_")]


def test_every_model_has_a_curve_of_its_own_look_and_the_nonlinear_is_thickest_and_on_top(drawn):
    found, (moving, _) = drawn
    leading, *others = curves(moving)
    assert len(others) + 1 == len(found) == 5
    assert len({line.get_color() for line in curves(moving)}) == 5
    assert len({str(line._dash_pattern) for line in curves(moving)}) == 5  # not by colour alone
    assert leading.get_label().startswith("nonlinear")
    assert leading.get_linewidth() > max(line.get_linewidth() for line in others)
    assert leading.get_zorder() > max(line.get_zorder() for line in others)
    assert list(moving.texts) == []  # nothing is at rest


def test_the_curves_are_the_histories(drawn):
    found, (moving, _) = drawn
    first, last = moving.get_xlim()
    for history, line in zip(found, curves(moving), strict=True):
        shown = (history.time >= first) & (history.time <= last)
        assert np.nanmax(line.get_ydata()) == np.nanmax(history.rotation[shown])
        assert np.nanmin(line.get_ydata()) == np.nanmin(history.rotation[shown])
        assert np.isin(line.get_xdata(), history.time).all()
        moves = history.time[np.abs(history.rotation) > 0.02]
        assert first <= moves[0]
        assert last >= moves[-1]
    assert {line.get_ydata()[0] for line in moving.lines if len(set(line.get_ydata())) == 1} >= {-1.0, 0.0, 1.0}
    low, high = moving.get_ylim()
    assert low == -high < -1.0
    crosses = [line for line in moving.lines if line.get_marker() == "X"]
    assert len(crosses) == sum(np.isfinite(history.overturning) for history in found) > 0
    assert all(abs(line.get_ydata()[0]) <= 1.5 for line in crosses)


def test_the_computed_history_reaches_the_stored_peak(assessed, first, changed):
    for history in histories(assessed, first, COLUMN, ["nonlinear", "linear", "impulsive"]):
        assert np.nanmax(np.abs(history.rotation)) == pytest.approx(history.peak, rel=0.02)
        assert history.warning == ""
    peak = assessed["summary"]["peak_rotation_ratio"].values.copy()
    peak[..., 3] = 0.9
    (found,) = histories(changed(peak_rotation_ratio=peak), first, COLUMN, ["linear"])
    assert "stored peak 0.9" in found.warning


def test_impacts_are_ticks_in_a_row_of_each_model_and_the_legend_says_how_it_ends(drawn, assessed, first):
    found, (_, below) = drawn
    assert [line.get_xdata().tolist() for line in below.lines] == [history.impacts.tolist() for history in found]
    assert [set(line.get_ydata()) <= {place} for place, line in enumerate(below.lines)] == [True] * 5
    for history in found[:3]:  # between two samples of opposite sign
        after = np.searchsorted(history.time, history.impacts)
        assert np.all(history.rotation[after - 1] * history.rotation[after] <= 0.0)
    assert all(line.get_marker() == "|" for line in below.lines)
    assert [tick.get_text().split(" ")[0] for tick in below.get_yticklabels()] == [h.model for h in found]
    assert found[1].impacts.size > 10
    words = [line.get_label() for line in curves(drawn[1][0])]
    assert words[3].startswith("sequence: overturns by")
    assert words[4].startswith("resonance (upper-bound input): overturns by")
    peak = float(assessed["summary"]["peak_rotation_ratio"].sel(record=first, block="wall", model="linear"))
    assert words[1] == f"linear: peak {peak:.3g}"
    start = float(assessed["summary"]["intense_start"].sel(record=first))
    assert drawn[0][3].time[0] == drawn[0][4].time[0] == start  # of the sequences


def test_stored_histories_are_those_computed_again(assessed, with_histories, first):
    again = histories(assessed, first, COLUMN, ["nonlinear", "linear"])
    for stored, computed in zip(histories(with_histories, first, COLUMN), again, strict=True):
        assert np.array_equal(stored.rotation, computed.rotation)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_body_beside_a_wall_is_drawn_away_from_it(clc, config, sign):
    """Whichever sense of the record is worse, from the stored history and from the computed one."""
    turned = [replace(clc[0], acceleration=sign * clc[0].acceleration)]
    body = {"parapet": rp.models.Block(0.3, 2.2, one_sided=True)}
    motions = []
    for stored in (True, False):
        models = ModelSettings(use=("nonlinear",), histories=stored)
        tree = rp.assess(turned, replace(config, models=models, search=SearchSettings(models=())), bodies=body)
        (found,) = histories(tree)
        moving, _ = rotation_history([found])
        assert np.nanmin(found.rotation) == 0.0 < np.nanmax(found.rotation) <= found.peak
        low, high = moving.get_ylim()
        assert -0.1 * high < low < 0.0
        assert -1.0 not in {line.get_ydata()[0] for line in moving.lines}
        motions.append(found.rotation)
    assert motions[0].tolist() == motions[1].tolist()


def test_what_the_model_could_not_say_and_a_vertical_that_is_not_stored_are_reported(changed, assessed, first):
    outcome = assessed["summary"]["outcome"].values.copy()
    outcome[..., 3] = 3
    found = histories(changed(outcome=outcome), first, "wall", ["nonlinear", "linear"])
    moving, _ = rotation_history(found)
    assert "linear: unresolved" in [line.get_label() for line in curves(moving)]
    tree = changed(vertical_channel=["CI.CLC..Up"] * 2)
    with pytest.raises(ResultsError, match=r"\[models\] histories = true"):
        histories(tree, first, "wall", ["nonlinear"])
    assert len(histories(tree, first, "wall", ["linear"])) == 1


@pytest.mark.sweep
def test_a_design_sequence_has_its_own_time_and_no_accelerogram():
    sequence = rp.models.ImpulseSequence(0.2, 0.05, interval=0.1, duration=5.0, main_count=3, spacing="middle")
    config = rp.Config(models=rp.ModelSettings(use=["resonance", "sequence"]))
    tree = rp.assess_sequence(sequence, config, {"wall": rp.models.Block(0.5, 3.0)})
    (spacing,) = re.findall(r'(?m)^spacing = "(\w+)"', tree.attrs["configuration"])
    assert spacing == "middle"
    found = histories(tree, None, None)
    assert [history.model for history in found] == ["sequence", "resonance"]
    assert found[0].time[0] == 0.0
    peak = float(tree["summary"]["peak_rotation_ratio"].sel(model="sequence").squeeze())
    assert np.nanmax(np.abs(found[0].rotation)) == pytest.approx(peak, rel=1e-3)
    assert rotation_history(found)[1].get_xlabel() == "time from the first main impulse [s]"
    with pytest.raises(ResultsError, match="a sequence of impulses, which has no accelerogram"):
        draw(tree, "accelerogram")


@pytest.mark.sweep
def test_a_motion_far_below_alpha_c_is_shown_large_and_rest_is_drawn_too():
    time = np.arange(0.0, 5.0, 0.1)
    moving, _ = rotation_history([ModelHistory("linear", time, 1e-5 * np.cos(time), peak=1e-5)])
    moving.figure.draw_without_rendering()
    assert moving.get_ylim() == pytest.approx((-1.3e-5, 1.3e-5))
    assert "1e-05" in named_rows(moving)
    time = np.arange(5.0)
    still = [ModelHistory(model, time, 0.0 * time, peak=0.0) for model in ("nonlinear", "linear")]
    moving, below = rotation_history(still)
    assert [line.get_label() for line in curves(moving)] == ["nonlinear: at rest", "linear: at rest"]
    assert [text.get_text() for text in moving.texts] == ["at rest"]
    assert moving.get_ylim() == (-0.01, 0.01)
    assert all(len(line.get_xdata()) == 0 for line in below.lines)


def test_a_factor_on_the_record_is_the_motion_of_the_stronger_record(assessed, first):
    (found,) = histories(assessed, first, COLUMN, ["nonlinear"], factor=0.7)
    record, body = stored_record(assessed, first), block_of(assessed["summary"].to_dataset(), COLUMN)
    own = rp.models.recorded_response(body, 0.7 * record.acceleration, record.dt, history=True)
    np.testing.assert_allclose(found.rotation, own.rotation / body.alpha_c, rtol=1e-9, atol=1e-12)
    assert found.peak == pytest.approx(float(own.peak_rotation_ratio))
    figure = draw(assessed, "rotation-history", record=first, block=COLUMN, model=["nonlinear"], factor=0.7)
    assert "scale factor 0.7" in " ".join(figure.get_suptitle().split())


@pytest.mark.parametrize(
    ("model", "factor", "message"),
    [
        ("nonlineer", 1.0, "nearest: nonlinear"),
        ("sequence", 2.0, "expected a model that can use a scaled record"),
        ("nonlinear", -1.0, "expected a positive scale factor, got -1"),
    ],
)
def test_a_model_or_a_factor_without_a_motion_is_refused(assessed, first, model, factor, message):
    with pytest.raises(ResultsError, match=message):
        histories(assessed, first, COLUMN, [model], factor=factor)
