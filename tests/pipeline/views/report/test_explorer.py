"""What the page holds to explore: the motions of the models, of the records that tell most, at five factors."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest
from report_cases import probable

import rockpulse as rp
from rockpulse.assessment.answers import Answers
from rockpulse.models import Block, recorded_response
from rockpulse.views.report import explorer as part
from rockpulse.views.report.explorer import TimeColumns, explorer, factor_steps, packed, selected_records
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared.words import section

CONTROLS = section("explorer")


def unpacked(one):
    """(2, count) as the script of the page reads it."""
    whole = np.frombuffer(base64.b64decode(one["data"]), dtype="<i2").reshape(2, -1)
    return np.where(whole == part.NONE, np.nan, whole * one["scale"])


@pytest.fixture(scope="module")
def shown(results):
    return json.loads(explorer(results, "some.h5").data)


def with_summary(tree, **values):
    """A copy of the results with other values of variables of /summary."""
    other = tree.copy(deep=True)
    for name, value in values.items():
        other["summary"][name].values[...] = value
    return other


def test_extremes_are_those_of_the_samples_in_each_column_and_keep_sixteen_bits():
    time, values = 0.01 * np.arange(1000), np.sin(np.arange(1000.0))
    values[900:] = np.nan
    found = TimeColumns(1.0, 9.99, 100).extremes(time, values)
    assert found.shape == (2, 100)
    assert found[:, 10] == pytest.approx([own(values[np.abs(time - 1.944) < 0.045]) for own in (np.min, np.max)])
    assert np.nanmin(found) == values[100:900].min()
    assert np.nanmax(found) == values[100:900].max()
    assert np.isnan(found[:, 89:]).all()
    assert np.isfinite(found[:, :88]).all()
    extremes = np.array([[-3.0, np.nan, 0.1], [1.0, np.nan, 0.2]])
    one = packed(extremes)
    np.testing.assert_allclose(unpacked(one), extremes, atol=3.0 / 32767)
    assert packed(np.zeros((2, 4)))["scale"] == 1.0


def test_the_motions_on_the_page_are_those_of_the_model(shown, results, bursts):
    summary = results["summary"].to_dataset()
    at_end = set()
    for place, body in enumerate(shown["bodies"][:2]):
        block = {"stele": Block(0.2, 3.0)}.get(body["name"], Block(1.0, 4.0))
        assert body["scenes"], place
        for scene in body["scenes"]:
            record = bursts[[one.id for one in bursts].index(summary["record"].values[scene["record"]])]
            assert len(scene["steps"]) == 5
            edges = np.linspace(scene["start"], scene["end"], scene["columns"] + 1)
            for step in scene["steps"]:
                own = recorded_response(block, record.acceleration, record.dt, scale=step["factor"], history=True)
                assert (step["ends"] == "overturns") == np.isinf(own.peak_rotation_ratio)
                at_end.add(step["ends"])
                if "rotation" not in step:
                    assert own.peak_rotation_ratio == 0.0
                    continue
                ratio = own.rotation / block.alpha_c
                inside = (own.time >= edges[0]) & (own.time < edges[-1]) & np.isfinite(ratio)
                low, high = unpacked(step["rotation"])
                column = np.minimum(np.searchsorted(edges, own.time[inside], "right") - 1, scene["columns"] - 1)
                near = [np.clip(column + shift, 0, scene["columns"] - 1) for shift in (-1, 0, 1)]
                margin = 2.0 * step["rotation"]["scale"]
                lowest = np.nanmin([low[one] for one in near], axis=0)
                highest = np.nanmax([high[one] for one in near], axis=0)
                assert (ratio[inside] >= lowest - margin).all()
                assert (ratio[inside] <= highest + margin).all()
                assert max(np.nanmax(high), -np.nanmin(low)) == pytest.approx(np.nanmax(np.abs(ratio)), abs=margin)
    assert at_end >= {"overturns", "rocks"}
    scene = shown["bodies"][0]["scenes"][0]
    record = bursts[scene["record"]]
    low, high = unpacked(scene["ground"])
    assert max(high.max(), -low.min()) == pytest.approx(np.max(np.abs(record.acceleration)), rel=1e-3)
    assert scene["whole"] == pytest.approx(record.time[-1])


def test_the_slider_and_the_curve_have_the_stored_factors_and_probabilities(shown, results):
    summary = results["summary"].to_dataset()
    scenes = [(place, scene) for place, body in enumerate(shown["bodies"]) for scene in body["scenes"]]
    for place, scene in scenes:
        steps = {step["label"]: step for step in scene["steps"]}
        assert steps["as recorded"]["factor"] == 1.0
        own = summary.isel(record=scene["record"], block=place)
        for name, share in (("factor_10", 0.1), ("factor_50", 0.5)):
            if CONTROLS[name] in steps:
                assert steps[CONTROLS[name]]["factor"] == pytest.approx(float(own[name]), rel=0.005)
                assert steps[CONTROLS[name]]["probability"] == pytest.approx(share, abs=1e-3)
        chance = float(own["overturning_probability"])
        assert steps["as recorded"]["probability"] == pytest.approx(chance, abs=1e-3)
        if scene["curve"] is not None:
            assert np.interp(0.0, np.log(scene["curve"][0]), scene["curve"][1]) == pytest.approx(chance, abs=0.05)
    assert any(scene["curve"] is not None for _, scene in scenes)


def test_factors_too_near_to_each_other_are_one_and_the_demand_is_its_own():
    answers = Answers(probable([0.5], factor_10=[1.01]))  # f_50 is 1.313
    steps = factor_steps(answers, 0, 0, CONTROLS)
    assert steps == {0.5: "", 0.7: "", 1.0: "as recorded", 1.31: "P = 50 %", 2.0: ""}
    answers = Answers(probable([0.0], factor_10=[np.inf], demand=2.5, at_demand=[0.07]))
    steps = factor_steps(answers, 0, 0, CONTROLS)
    assert steps[2.5] == "demand ULS"
    assert len(steps) == 5


def test_three_records_are_chosen_and_each_says_why():
    summary = probable([0.9, 0.4, 0.2, 0.0, 0.0], factor_10=[0.4, 0.8, 1.1, 2.0, np.inf])
    answers = Answers(summary.assign(uplift_ratio=(("record", "block"), np.arange(5.0)[:, None])))
    assert selected_records(answers, 0) == {0: ["worst"], 1: ["nearest"], 2: ["median"]}
    summary = probable([0.0, 0.0, 0.0], factor_10=[np.inf] * 3)
    answers = Answers(summary.assign(uplift_ratio=(("record", "block"), np.array([[0.3], [0.9], [0.6]]))))
    assert selected_records(answers, 0) == {1: ["worst"], 2: ["median"]}


@pytest.mark.sweep
def test_without_accelerograms_the_page_says_that_there_is_no_motion(results, undrawn):
    other = results.copy(deep=True)
    other["records"] = type(results)(other["records"].to_dataset().drop_vars(["acceleration", "row_size"]))
    assert explorer(other).data == ""
    page = report_page(other)
    assert "so there is no motion to show; they must be stored with the results." in page
    assert "data-motions" not in page


def test_a_vertical_that_is_not_stored_leaves_the_stored_history_alone(bursts, bodies, config):
    wanted = replace(config, models=rp.ModelSettings(use=("nonlinear",), histories=True))
    tree = rp.assess(bursts[:1], wanted, {"stele": bodies["stele"]})
    found = json.loads(explorer(with_summary(tree, vertical_channel="up")).data)
    steps = found["bodies"][0]["scenes"][0]["steps"]
    assert [step["factor"] for step in steps if "rotation" in step] == [1.0]
    assert {step["reason"] for step in steps if step["factor"] != 1.0} == {
        "burst0: the file lacks the vertical channel, which was used: assess again with [models] histories = true, or "
        "draw other models (--model)"
    }


def test_a_body_before_a_wall_turns_away_from_it(bursts, config):
    wanted = replace(
        config, models=rp.ModelSettings(use=("nonlinear",)), uncertainty=replace(config.uncertainty, probability=False)
    )
    tree = rp.assess(bursts[:1], wanted, {"parapet": Block(0.2, 3.0, one_sided=True)})
    (body,) = json.loads(explorer(tree).data)["bodies"]
    assert body["wall"]
    for scene in body["scenes"]:
        for step in scene["steps"]:
            if "rotation" in step:
                assert np.nanmin(unpacked(step["rotation"])) >= 0.0


def test_a_body_is_outlined_and_nothing_moves_under_a_design_sequence(shown, results):
    stele = shown["bodies"][0]
    assert stele["outline"] == [[-0.1, 0.0], [0.1, 0.0], [0.1, 3.0], [-0.1, 3.0]]
    assert stele["centre"] == 1.5
    assert stele["alpha"] == pytest.approx([np.arctan(0.1 / 1.5)] * 2, abs=1e-6)
    assert explorer(with_summary(results, npts=-1)) is None
    by_rule = results.copy(deep=True)
    names = [str(name).replace("nonlinear", "balanced") for name in results["summary"]["model"].values]
    by_rule["summary"] = type(results)(by_rule["summary"].to_dataset().assign_coords(model=names))
    assert explorer(by_rule) is None
