"""The pictures of the report: of a motion the model of the verdict alone."""

import re

import pytest

from rocking.response import Outcome
from rockpulse.views.report.content import page_content
from rockpulse.views.report.report_pictures import Pictures


def motion(tree, place=0):
    return Pictures(tree, None, None, page_content(tree).found).motion(place)


def labels(picture):
    """Models of the rows of impacts."""
    return re.findall(r">(\w+) \(\d+\)<", picture.svg)


@pytest.mark.sweep
def test_a_motion_is_that_of_the_model_of_the_verdict_where_it_has_one(results):
    found = motion(results)
    assert labels(found) == ["nonlinear"]
    assert found.words.endswith("which overturns it at the smallest scale factor; nonlinear model.")
    assert ">at rest<" not in found.svg
    by_rule = results.copy(deep=True)
    names = [str(name).replace("nonlinear", "balanced") for name in results["summary"]["model"].values]
    by_rule["summary"] = type(results)(by_rule["summary"].to_dataset().assign_coords(model=names))
    assert motion(by_rule) is None


@pytest.mark.sweep
def test_a_body_at_rest_is_said_to_be_and_a_motion_that_is_not_known_is_no_picture(results):
    still = results.copy(deep=True)
    still["records"]["acceleration"].values[:] *= 1e-3
    for name, value in (("outcome", Outcome.AT_REST), ("peak_rotation_ratio", 0.0), ("impacts", 0)):
        still["summary"][name].values[:] = value
    found = motion(still)
    assert ">at rest<" in found.svg
    assert "nonlinear: at rest" in found.svg
    unresolved = results.copy(deep=True)
    unresolved["summary"]["outcome"].values[:] = Outcome.UNRESOLVED
    found = motion(unresolved)
    assert not found.svg
    assert found.words.endswith(": unresolved")
