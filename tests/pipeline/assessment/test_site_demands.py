"""The factors that bring motions to the demands of a site, and the probability there: as by records scaled by hand."""

import dataclasses
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import xarray as xr

import rockpulse as rp
from rocking import Block
from rockpulse.assessment.answers import answers_of
from rockpulse.assessment.site_demands import demand_factors, stored_demands
from rockpulse.assessment.verdict import verdicts
from rockpulse.config.settings import DemandSettings
from rockpulse.record.intensity import pgv, spectral_acceleration, spectrum_intensity
from rockpulse.record.measures import DEMAND, PERIODIC, ROWS, RecordOnBodies

BODIES = {"wall": Block(0.3, 2.4), "stele": Block(0.4, 3.0)}
LANES = Block.stack([body.lanes(1) for body in BODIES.values()])
TIME = np.arange(0.0, 8.0, 0.02)


def channel(number, azimuth, amplitude):
    """A burst of its own frequency, recorded by the station and in the earthquake of a number."""
    burst = np.sin((4.0 + 0.5 * number) * TIME + azimuth) * np.exp(-(((TIME - 4.0) / 1.5) ** 2))
    return rp.Record(
        amplitude * burst,
        dt=0.02,
        id=f"S{number}.{azimuth:g}",
        station=f"S{number}",
        network="XX",
        azimuth=azimuth,
        orientation="horizontal",
        component=f"{azimuth:g}",
        start_time=datetime(2020, 1, 1, tzinfo=UTC) + timedelta(days=100 * number),
        source=f"{number}.txt",
        event=f"quake {number}",
        processed=True,
    )


RECORDS = [channel(number, azimuth, 2.0 + number * 0.2) for number in range(5) for azimuth in (0.0, 90.0)]


@pytest.mark.parametrize(
    ("demand", "measured"),
    [
        ({"measure": "pga", "value": 3.0}, lambda one: one.pga),
        ({"value": 3.0}, lambda one: one.pga),
        ({"measure": "pgv", "value": 0.4}, pgv),
        pytest.param({"measure": "si", "value": 0.5}, spectrum_intensity, marks=pytest.mark.sweep),
        ({"measure": "sa", "value": 5.0, "period": 0.7}, lambda one: spectral_acceleration(one, 0.7)),
    ],
)
def test_a_pair_has_one_factor_from_the_geometric_mean_of_its_channels(demand, measured):
    asked = DemandSettings(name="ULS", **demand)
    pair = RECORDS[:2]
    found = demand_factors(pair, LANES, rp.Config(demands=(asked,)))
    assert found == pytest.approx(np.full((2, 1), asked.strength / np.sqrt(measured(pair[0]) * measured(pair[1]))))
    alone = demand_factors(pair[:1], LANES, rp.Config(demands=(asked,)))[0, 0]
    scaled = dataclasses.replace(pair[0], acceleration=alone * pair[0].acceleration)
    assert measured(scaled) == pytest.approx(asked.strength, rel=1e-9)


def test_the_demands_of_a_file_are_told_with_their_measure_and_unit():
    columns = {
        "demand_acceleration": [3.0, np.nan, np.nan, np.nan],
        "demand_value": [3.0, 0.41239, 5.0, 0.6],
        "demand_measure": ["pga", "pgv", "sa", "velocity_ratio"],
        "demand_period": [np.nan, np.nan, 0.7, np.nan],
        "demand_units": ["m s^-2", "m s^-1", "m s^-2", "1"],
        "limit_state": ["SLV", "", "SLC", ""],
    }
    summary = xr.Dataset(
        {name: ("demand", own) for name, own in columns.items()}
        | {"demand_factor": (("record", "demand"), [[1.0, 2.0, 3.0, 4.0]])},
        {"demand": ["a", "b", "c", "d"]},
    )
    assert stored_demands(summary) == {
        "a": (3.0, "SLV", "PGA 3 m/s2", "PGA"),
        "b": (0.41239, "", "PGV 0.4124 m/s", "PGV"),
        "c": (5.0, "SLC", "Sa(0.7 s) 5 m/s2", "Sa(0.7 s)"),
        "d": (0.6, "", "p PGV/(g tan alpha_c) 0.6", "p PGV/(g tan alpha_c)"),
    }
    assert stored_demands(xr.Dataset()) == {}


def test_a_velocity_ratio_asks_each_body_for_its_own_factor():
    found = demand_factors(
        RECORDS[:1], LANES, rp.Config(demands=(DemandSettings(name="ULS", measure="velocity_ratio", value=0.8),))
    )
    expected = 0.8 * LANES.gravity * np.tan(LANES.alpha_c) / (LANES.p * pgv(RECORDS[0]))
    assert found[:, 0] == pytest.approx(expected)


#: The others differ in the factor to the demand alone, which has tests of its own.
MARKS = {"pga": (), "velocity_ratio": pytest.mark.sweep}


@pytest.mark.parametrize("measure", [pytest.param(one, marks=MARKS.get(one, pytest.mark.slow)) for one in DEMAND])
def test_the_verdict_at_a_demand_is_that_of_the_records_scaled_by_hand(measure):
    bodies = dict([*BODIES.items()][:1])  # a velocity ratio asks another factor of another body
    row, period = ROWS[measure], 0.8 if measure in PERIODIC else None
    on = RecordOnBodies.slender(RECORDS[0], lambda: rp.half_waves(RECORDS[0]), LANES.take(slice(1)))
    value = (0.6 if measure == "velocity_ratio" else 0.8) * float(np.squeeze(row.at(period).value(on)))
    asked = DemandSettings(name="ULS", measure=measure, value=value, period=period)
    config = rp.Config(models=rp.ModelSettings(use=["nonlinear"]), demands=(asked,))
    tree = rp.assess(RECORDS, config, bodies)
    factor = tree["summary"]["demand_factor"].squeeze().values
    assert np.all(factor[::2] == factor[1::2])
    assert np.all((factor > 0.25) & (factor < 4.0))
    pairs = zip(RECORDS, factor, strict=True)
    by_hand = [dataclasses.replace(one, acceleration=scale * one.acceleration) for one, scale in pairs]
    other = rp.assess(by_hand, dataclasses.replace(config, demands=()), bodies)
    expected = other["summary"]["overturning_probability"].squeeze().values
    assert 0.05 < expected.mean() < 0.95
    # P is read between levels of the scale factor that are 4 % apart, which lie elsewhere for a record scaled by hand.
    np.testing.assert_allclose(tree["summary"]["demand_probability"].squeeze().values, expected, atol=0.01)
    (at_demand,), (as_scaled,) = verdicts(answers_of(tree)), verdicts(answers_of(other))
    assert at_demand.share.value == pytest.approx(as_scaled.share.value, abs=0.01)
    for name in ("overturned", "motions", "median_rotation", "others_rotation"):  # the same march, scaled
        found, expected = getattr(at_demand.deciding, name), getattr(as_scaled.recorded, name)
        assert found == pytest.approx(expected, rel=1e-9, nan_ok=True)


@pytest.mark.sweep
def test_mirrored_records_leave_every_number_at_the_demand_as_it_is():
    """A free symmetric body has no side."""
    config = rp.Config(models=rp.ModelSettings(use=["nonlinear"]), demands=(DemandSettings(value="0.18 g"),))
    bodies = dict([*BODIES.items()][:1])
    mirrored = [dataclasses.replace(one, acceleration=-one.acceleration) for one in RECORDS[:2]]
    plain, mirror = (
        verdicts(answers_of(rp.assess(own, config, bodies)))[0].deciding for own in (RECORDS[:2], mirrored)
    )
    assert repr(mirror) == repr(plain)


def test_beyond_a_factor_of_four_there_is_no_probability_and_a_lone_channel_says_so():
    asked = DemandSettings(name="ULS", value=9.0)
    tree = rp.assess(RECORDS[:1], rp.Config(models=rp.ModelSettings(use=["nonlinear"]), demands=(asked,)), BODIES)
    summary = tree["summary"]
    assert np.all(summary["demand_factor"] > 4.0)
    assert np.isnan(summary["demand_probability"]).all()
    assert "scaled to the demand by its own intensity, not by that of a pair" in str(summary["warnings"].values[0])
    assert str(summary["demand_units"].values[0]) == "m s^-2"
    (one, _) = verdicts(answers_of(tree))
    assert (one.deciding.word, one.demands[0].left_out, one.demands[0].earthquakes) == ("", 1, 0)
    assert np.isnan(summary["demand_rotation_ratio"]).all()
    assert np.all(summary["demand_outcome"] == -1)
