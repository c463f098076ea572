"""What the verdict does not say: warnings on a design sequence and its site, on directions and restitutions."""

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, probable, summary_of, verdict

from rocking.response import Outcome
from rockpulse.views.report.report_warnings import GRADES, limits, warnings
from rockpulse.views.shared.files_used import FilesUsed


def site(share=0.0, lower=1.2):
    """A site of one block, with the share of its records that overturn it and the lower end of its scale factor."""
    counts = {"quantile": 0.84, "confidence": 0.9, "record_count": 9, "event_count": 9}
    bodies = {"overturned_share": (("block",), [share]), "design_factor_lower": (("block",), [lower])}
    return xr.Dataset({**counts, **bodies}, {"block": ["b"]})


def heads(summary, kind="sequence", **options):
    of = motions(summary.sizes["record"], kind=kind)
    found = warnings(answers(summary, of), [verdict(summary, of)], FilesUsed(1), **options)
    return {one.head: one for one in found}


def test_the_gravest_stand_first_and_three_lines_at_most_stand_on_the_first_page():
    summary = probable([0.9, np.nan, 0.2], at_demand=[0.1, 0.2, 0.3], demand=0.5)
    of = motions(3)
    said = warnings(answers(summary, of), [verdict(summary, of)], FilesUsed(1))
    assert [one.grade for one in said] == sorted((one.grade for one in said), key=GRADES.index)
    decides, earthquakes, not_covered = limits(said, [verdict(summary, of)], answers(summary, of))
    assert decides.startswith("What may change a verdict: at the demand “ULS” there is no verdict, because only")
    assert earthquakes.startswith("The results rest on 3 earthquakes")
    assert not_covered.startswith("Not covered: sliding")
    assert "[" not in "".join((decides, earthquakes, not_covered))  # no key of the configuration


def with_codes(factors, *codes, **options):
    summary = summary_of(factors, **options)
    return summary.assign(warning_codes=(("record",), list(codes))) if codes else summary


def test_a_demand_without_a_check_and_records_of_the_site_that_overturn_are_said_loudly():
    found = heads(with_codes([1.6], "plain demand_not_compared"))
    shown = found["the demand of the site is not checked"]
    assert shown.grade == "decides"
    assert shown.text.startswith(
        "A sequence has no PGA or other intensity that could be scaled to the demand of the site"
    )
    assert "the demand of the site is not checked" not in heads(with_codes([1.6]))
    found = heads(with_codes([1.6]), site=site(0.25))
    assert found["some records of the site, scaled as in the calibration, overturn b (25 %)"].grade == "decides"
    assert not [head for head in heads(with_codes([1.6]), site=site()) if "overturn" in head]


@pytest.mark.parametrize(("lower", "shown"), [(0.9, True), (1.1, False)])
def test_a_body_that_overturns_within_the_interval_of_the_design(lower, shown):
    found = heads(with_codes([1.4]), site=site(lower=lower))
    assert [head for head in found if head.startswith("at the upper end of its 90 % interval")] == (
        ["at the upper end of its 90 % interval the design overturns b"] if shown else []
    )


def test_what_is_not_known_of_some_motions_is_said_loudly():
    head = "in 1 of 3 cases (motion and body) the answer is not known"
    said = heads(probable([np.nan, 0.0, 0.9]), "record")[head]
    assert said.grade == "decides"
    assert "why" not in said.text
    assert head not in heads(probable([0.1, 0.0, 0.9]), "record")
    unresolved = summary_of([np.nan, 2.0, 3.0], outcomes=[Outcome.UNRESOLVED, Outcome.ROCKS, Outcome.ROCKS])
    assert "The table of all answers gives the reasons" in heads(unresolved, "record")[head].text


def test_the_earthquakes_that_can_be_brought_to_the_demand_limit_the_verdict():
    summary = probable([0.0] * 3, at_demand=[0.0] * 3, demand=0.5, to_demand=[1.0, 1.0, 5.0])
    of = motions(3)
    found = [verdict(summary, of)]
    said = warnings(answers(summary, of), found, FilesUsed(1))
    shown = limits(said, found, answers(summary, of))
    assert [line for line in shown if line.startswith("The results rest on 2 earthquakes: ") and "57 %" in line]
    assert [one for one in said if "2 earthquakes" in one.head and "57 %" in one.text]


def test_few_earthquakes_tell_no_small_probability_and_motions_that_lift_nothing_count():
    said = heads(probable([0.0, 0.0], at_demand=[0.0, 0.0], demand=1.0), "record")["the results rest on 2 earthquakes"]
    assert said.grade == "limits"
    assert "A probability of 0.05 cannot be estimated from 2 earthquakes" in said.text
    assert "by up to 57 % of the motions" in said.text
    summary = probable([0.0] * 12, at_demand=[0.0] * 12, demand=1.0)
    said = heads(summary, "record")["the results rest on 12 earthquakes"]
    assert "cannot be estimated" not in said.text
    said = heads(probable([0.0] * 12), "record")["there is no verdict, because no demand is stated"]
    assert "A verdict needs the demand at the site" in said.text
    found = heads(probable([0.0, 0.2], uplift=np.array([0.0, 1.0])), "record")
    assert "are counted with probability 0" in found["in 1 of 2 cases (motion and body) the body is not lifted"].text
    found = heads(probable([0.0, 0.0], uplift=0.0, outcomes=[Outcome.AT_REST] * 2), "record")
    assert found["1 of 1 body not lifted by any of these motions"].grade == "decides"


def test_channels_as_recorded_need_not_point_where_a_body_rocks():
    summary = with_codes([1.6, 2.0], outcomes=[Outcome.ROCKS] * 2)
    head = "every channel is taken as it was recorded"
    assert head in heads(summary, "record", components="horizontal")
    assert head not in heads(summary, "record", components="azimuth")
