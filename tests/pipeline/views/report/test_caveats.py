"""What the verdict does not say: caveats on a design sequence and its site, on directions and restitutions."""

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, motions, summary_of, verdict

from rocking.response import Outcome
from rockpulse.views.report.caveats import caveats
from rockpulse.views.shared.files_used import FilesUsed


def site(peaks, design=0.2, upper=0.3):
    """A site of one block, with the rotations that its records gave."""
    peaks = np.atleast_2d(peaks)
    coverage = ("coverage", "coverage_lower", "coverage_upper", "coverage_in_sample", "coverage_all")
    scalars = dict.fromkeys(coverage, np.nan)
    of_parameter = {"design": design, "design_lower": 0.1, "design_upper": upper}
    variables = {
        **scalars,
        "quantile": 0.84,
        "confidence": 0.9,
        "judged_pairs": 0,
        "judged_events": 0,
        **{name: (("parameter",), [value]) for name, value in of_parameter.items()},
        "rotation_ratio": (("record", "block"), peaks.T),
    }
    return xr.Dataset(
        variables, {"parameter": ["main"], "block": ["b"], "record": np.arange(peaks.shape[1]), "site_event": ["e"]}
    )


def heads(summary, kind="sequence", **options):
    of = motions(summary.sizes["record"], kind=kind)
    found = caveats(answers(summary, of), [verdict(summary, of)], FilesUsed(1), **options)
    return {one.head: one for one in found}


def with_codes(factors, *codes, **options):
    summary = summary_of(factors, **options)
    return summary.assign(warning_codes=(("record",), list(codes))) if codes else summary


def test_a_demand_that_a_sequence_cannot_be_held_against_is_said_loudly():
    found = heads(with_codes([1.6], "plain demand_not_compared"))
    told = found["The demand of the site is not checked"]
    assert told.loud
    assert told.text.startswith("A sequence has no PGA: its capacity is not compared with the demand of the site")
    assert "The demand of the site is not checked" not in heads(with_codes([1.6]))


@pytest.mark.parametrize(("factor", "told"), [(1.4, True), (1.6, False)])
def test_a_body_that_overturns_within_the_interval_of_the_design(factor, told):
    found = heads(with_codes([factor]), site=site([0.1, 0.2]))
    words = [head for head in found if head.startswith("Within the 90% interval")]
    assert bool(words) == told
    assert all("b (SF 1.40)" in word for word in words)


def test_records_of_the_site_that_overturn_a_body_which_stands_under_its_design():
    found = heads(with_codes([1.6]), site=site([0.1, np.inf, np.inf]))
    assert found["Records of the site, scaled as they were calibrated, overturn b (2 of 3)"].loud
    assert not [head for head in heads(with_codes([1.6]), site=site([0.1])) if "overturn" in head]


@pytest.mark.parametrize(("step", "told"), [(1.01, False), (1.12, True)])
def test_a_search_too_coarse_for_the_margin_is_said_loudly(step, told):
    summary = with_codes([1.6, 2.0], outcomes=[Outcome.ROCKS] * 2, step=step)
    said = heads(summary, "record").get("1 of 1 body stands with hardly a margin")
    assert (said is not None) == told
    assert said is None or (said.loud and "steps of up to 12.0%" in said.text and "below 1.8" in said.text)


def test_channels_as_recorded_need_not_point_where_a_body_rocks():
    summary = with_codes([1.6, 2.0], outcomes=[Outcome.ROCKS] * 2)
    head = "Every channel is taken as it was recorded"
    assert head in heads(summary, "record", components="horizontal")
    assert head not in heads(summary, "record", components="azimuth")
