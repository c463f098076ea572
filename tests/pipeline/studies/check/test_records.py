"""The criterion on rotations under records (C8.7.1.2.1.9) by hand, and from motions of an independent integration."""

import dataclasses
import math

import numpy as np
import pytest
from report_cases import motions, probable, turned
from scipy.integrate import solve_ivp

import rockpulse as rp
from rockpulse.assessment.answers import Answers
from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError
from rockpulse.studies.check.check import check, check_records, history_results, rotations_at, rotations_of
from rockpulse.studies.check.mechanism import Force, Mechanism, Weight
from rockpulse.views.text.check import check_overview

G, INF, NAN = 9.80665, math.inf, math.nan
WALL = Mechanism((Weight(1.0, 0.2, 2.0, True),))  # 0.4 x 4 m: d_0 = 0.2 m
RULE = "NTC 2018, 7.3.5"


@pytest.mark.parametrize(
    ("rotations", "demand", "slv", "slc"),
    [
        ([0.3, 0.1, 0.2], 0.06, 0.08 / 0.06, 0.12 / 0.06),  # fewer than seven: the largest
        ([0.5, 0.1, 0.1], 0.1, 0.8, 1.2),
        ([0.9, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1], 0.3 / 7.0, 0.2 / 0.18, 0.2 / 0.18),  # the mean; d_0 passed by none
        ([1.05] + [0.0] * 6, 0.03, 0.2 / 0.21, 0.2 / 0.21),  # one passes d_0 and comes back
        ([INF] + [0.0] * 20, INF, 0.0, 0.0),
        ([0.0] * 3, 0.0, INF, INF),
    ],
)
def test_limits_by_hand(rotations, demand, slv, slc):
    found = [check_records((WALL,), rotations_of(np.array(rotations)), state, RULE) for state in ("slv", "slc")]
    assert [one.displacement for one in found] == pytest.approx([0.08, 0.12])
    assert [one.displacement_demand for one in found] == pytest.approx([demand] * 2)
    assert [one.displacement_ratio for one in found] == pytest.approx([slv, slc])
    assert {one.records for one in found} == {len(rotations)}


@pytest.mark.parametrize(
    ("rotations", "told"),
    [
        ([0.1, 0.1], "2 records at the demand, but NTC 2018, 7.3.5 requires three or more"),
        ([INF], "1 records at the demand"),
        ([], "0 records"),
        ([0.1, NAN, 0.2], "1 of 3 records have no rotation at the demand"),
    ],
)
def test_too_few_records_have_no_verdict(rotations, told):
    found = check_records((WALL,), rotations_of(np.array(rotations)), "slv", RULE)
    assert math.isnan(found.displacement_ratio)
    assert told in found.statement


def test_a_record_that_overturns_decides_although_another_is_unknown():
    assert check_records((WALL,), rotations_of(np.array([NAN, INF, 0.1])), "slv", RULE).displacement_ratio == 0.0


def test_d_0_is_that_of_the_forces_that_last():
    """A roof of 0.5 W with friction 0.4 at the top lasts: theta_0 = (0.2 + 0.1 + 0.8)/(2 + 2) = 0.275, d_0 = 0.55 m."""
    held = Mechanism((Weight(1.0, 0.2, 2.0, True), Weight(0.5, 0.2, 4.0, False)), (Force(0.2, 4.0),))
    found = check_records((held,), rotations_of(np.array([1.0, 0.5, 0.5])), "slv", RULE)
    assert found.displacement == pytest.approx(0.4 * 0.55)
    assert found.displacement_demand == pytest.approx(0.2)  # at alpha_c
    assert found.displacement_ratio == pytest.approx(1.1)


def test_records_count_as_in_the_verdict():
    """A record that cannot be scaled to the demand is excluded, and a pair counts by its worst direction."""
    found = rotations_at(Answers(turned([0.1, 0.2, 0.3, 0.9], to_demand=[1.0, 1.0, 1.0, 5.0])), "ULS")["b"]
    assert (found.records, found.compared) == (3, 0.3)
    rows = motions(6, rows=[[0, 1], [2, 3], [4, 5]], kind="pair")
    found = rotations_at(Answers(turned([0.1, 0.2, INF, NAN, 0.3, 0.1]), rows), "ULS")["b"]
    assert (found.records, found.compared) == (3, INF)
    found = rotations_at(Answers(turned([0.1, 0.2, 0.2, NAN, 0.3, 0.1]), rows), "ULS")["b"]
    assert (found.records, found.unknown) == (3, 1)


BODIES = (rp.BlockSettings("stele", 0.4, 3.2), rp.BlockSettings("wall", 0.5, 3.5))
TIME = np.arange(0.0, 5.0, 0.01)
DEMAND = 1.5  # PGA [m/s2]


def pulse(number):
    """A burst of about one cycle, of its own frequency."""
    burst = np.sin((4.5 + 1.5 * number) * (TIME - 2.0)) * np.exp(-(((TIME - 2.0) / 0.8) ** 2))
    name = f"S{number}"
    own = {"id": name, "station": name, "network": "XX", "component": "X", "azimuth": 0.0, "source": name}
    return rp.Record(2.0 * burst, dt=0.01, event=f"quake {number}", orientation="horizontal", processed=True, **own)


def integrated(body, acceleration):
    """Largest |theta|/alpha_c of a rectangle by Housner's equation and restitution, by solve_ivp between impacts."""
    alpha, radius = math.atan(body.width / body.height), 0.5 * math.hypot(body.width, body.height)
    square, kept = 0.75 * G / radius, 1.0 - 1.5 * math.sin(alpha) ** 2
    peak, sample, state = 0.0, 0, (0.0, 0.0)
    time = 0.0

    def turning(t, y, side):
        along = alpha * side - y[0]
        return y[1], -square * (math.sin(along) + np.interp(t, TIME, acceleration) / G * math.cos(along))

    def impact(t, y, side):
        return side * y[0] if t > time + 1e-6 else 1.0

    impact.terminal, impact.direction = True, -1.0
    while True:
        side = math.copysign(1.0, state[1])
        if abs(state[1]) < 1e-6:  # at rest until the ground lifts it
            lifts = np.flatnonzero((np.abs(acceleration) > G * math.tan(alpha)) & (time < TIME))
            if not lifts.size:
                return peak
            sample = lifts[0]
            low, high = np.abs(acceleration[sample - 1 : sample + 1])
            time = TIME[sample - 1] + 0.01 * max(0.0, (G * math.tan(alpha) - low) / (high - low))
            side, state = -math.copysign(1.0, acceleration[sample]), (0.0, 0.0)
        run = solve_ivp(
            turning, (time, 12.0), state, "DOP853", args=(side,), events=impact, max_step=0.01, rtol=1e-9, atol=1e-11
        )
        peak = max(peak, float(np.max(np.abs(run.y[0]))) / alpha)
        if peak > 2.0:
            return math.inf
        if run.status == 0:
            return peak
        time, state = float(run.t[-1]), (0.0, kept * float(run.y[1, -1]))


def at_demands(*demands):
    config = rp.Config(
        models=rp.ModelSettings(use=["nonlinear"]),
        uncertainty=rp.UncertaintySettings(probability=False),
        bodies=BODIES,
        demands=demands,
        check=CheckSettings(ag=0.2, f0=2.4, tc_star=0.3),
    )
    return rp.assess([pulse(number) for number in range(3)], config)


@pytest.fixture(scope="module")
def assessed():
    return at_demands(rp.DemandSettings(name="strong", value=DEMAND))


@pytest.mark.sweep
def test_three_records_and_two_bodies_by_hand(assessed):
    """The largest of three rotations of an independent integration, times d_0 = b, against 0.4 b and 0.6 b."""
    found = check(assessed)
    for body in BODIES:
        half = 0.5 * body.width
        moved = max(
            integrated(body, DEMAND / one.pga * one.acceleration) for one in (pulse(number) for number in range(3))
        )
        for state, share in (("slv", 0.4), ("slc", 0.6)):
            own = found.sel(block=body.name, code=f"records_{state}")
            assert own["displacement"].item() == pytest.approx(share * half)
            assert own["displacement_demand"].item() == pytest.approx(moved * half, rel=2e-3)
            assert own["displacement_ratio"].item() == pytest.approx(min(share, 1.0) / moved, rel=2e-3)
            assert own["records"].item() == 3
    verdicts = found["displacement_ratio"].sel(code=["records_slv", "records_slc"]).values >= 1.0
    assert verdicts.tolist() == [[False, True], [True, True]]
    shown = " ".join(check_overview(found).split())
    assert "SLV, records" in shown
    assert "NTC 2018, 7.3.5" in shown


@pytest.mark.sweep
def test_a_demand_that_names_a_limit_state_is_that_of_this_one_only():
    demands = [rp.DemandSettings(name=name, value=DEMAND) for name in ("SLV", "at SLC", "other")]
    found = check(at_demands(*demands), code="circolare_2019_records")
    expected = ["slv, SLV", "slc, at SLC", "slv, other", "slc, other"]
    assert found["code"].values.tolist() == [f"records_{one}" for one in expected]


@pytest.mark.sweep
def test_bodies_and_codes_without_rotations_are_stated(assessed):
    stored = rp.Config(
        bodies=(*BODIES, rp.BlockSettings("urn", 0.3, 0.9)), check=CheckSettings(spectrum="en_1998_1", ag=0.2)
    )
    changed = dataclasses.replace(stored, bodies=(dataclasses.replace(BODIES[0], width=0.5), *stored.bodies[1:]))
    found = check(assessed, changed, code="circolare_2019_records")
    told = found["statement"].sel(code="records_slv").values.tolist()
    assert "another body of this name (width 0.4 there, 0.5 here)" in told[0]
    assert (told[1], told[2]) == ("", "the results have no body of this name")
    assert np.isnan(found["displacement_ratio"].values[[0, 2]]).all()
    assert "EN 1998-1, 4.3.3.4.3" in " ".join(check_overview(found).split())
    with pytest.raises(ConfigError, match=r"expected results with a \[\[demand\]\]"):
        check(config=stored, code="circolare_2019_records")


def test_the_median_over_pairs_is_that_of_the_margins():
    """Of each pair the direction with the smaller factor counts: 1.3 and 5.2, with a median of 3.25."""
    pairs = motions(2, rows=[[0, 1], [2, 3]], kind="pair")
    found = history_results(Answers(probable([0.0] * 4, factor_10=[1.0, 2.0, 8.0, 4.0]), pairs), {"b": ""})
    assert found["factor_50"] == pytest.approx([3.25])
