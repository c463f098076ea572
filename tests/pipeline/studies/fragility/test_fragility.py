"""From records to the tree of fragility curves."""

import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from nominal import ida

import rockpulse as rp
from rocking.body.block import Block
from rockpulse import FragilitySettings
from rockpulse.config.configuration import Config, SearchSettings
from rockpulse.record.components import Pair
from rockpulse.record.rotation import rotate

BLOCKS = {"wall": Block(0.6, 3.0), "pier": Block(1.0, 3.873)}
STATES, LEVELS = ("uplift", 0.4, "overturning"), (0.4, 0.7, 1.2)


def pulse(number, event, size=2.0):
    """A wave packet with a period and a length of its own."""
    t = np.arange(0.0, 6.0, 0.02)
    period = 0.9 + 0.15 * number
    ground = size * np.sin(2.0 * np.pi * t / period) * np.exp(-(((t - 3.0) / (0.7 + 0.1 * (number % 3))) ** 2))
    return rp.Record(ground, dt=0.02, id=f"packet.{number}", event=event, processed=True)


def options(**fragility):
    known = {"limit_states": STATES, "measures": ("pga", "velocity_ratio")}
    return Config(fragility=ida(**{**known, **fragility}), search=SearchSettings(factor_max=30.0, points=16))


@pytest.fixture(scope="module")
def records():
    return [pulse(number, event) for number, event in enumerate(["Kobe", "Kobe", "Maule", "Maule", "Izmit", "Duzce"])]


@pytest.fixture(scope="module")
def tree(records):
    return rp.fragility(records, options(), BLOCKS)


@pytest.fixture(scope="module")
def striped(records):
    return rp.fragility(records, options(data="stripes", stripe_levels=LEVELS), BLOCKS)


def test_the_facts_of_each_record_are_stored():
    known = {"magnitude": 6.3, "epicentral_distance": 5300.0, "vs30": 717.0, "event_id": "IT-2009-0009"}
    shaken = [replace(pulse(0, "Kobe"), **known), pulse(1, "Maule")]
    found = rp.fragility(shaken, options(data="cloud"), BLOCKS)["capacities"].to_dataset()
    assert {name: found[name].values[0].item() for name in known} == known
    assert np.isnan(found["epicentral_distance"].values[1])
    assert found["event_id"].values[1] == ""


def test_the_curve_of_a_measure_is_the_fit_of_factor_times_measure(tree):
    own = {"block": "wall", "limit_state": "0.4"}
    factor = tree["capacities"]["factor"].sel(own).values
    value = tree["capacities"]["measure_value"].sel(block="wall", measure="velocity_ratio").values
    fit = rp.fit_capacities(factor * value, tree["capacities"]["event"].values)
    found = tree["fragility"].to_dataset().sel({**own, "measure": "velocity_ratio"})
    assert float(found["median"]) == pytest.approx(fit.median, rel=1e-12)
    assert (float(found["beta_low"]), float(found["beta_high"])) == pytest.approx((fit.beta_low, fit.beta_high))
    assert int(found["extrapolated"]) == 0
    assert (int(found["records"]), int(found["events"]), int(found["reached"])) == (6, 4, 6)
    np.testing.assert_allclose(found["probability_high"], fit.probability(found["level"].values)[2])


def test_the_levels_of_a_body_reach_three_betas_beyond_its_medians(tree):
    found = tree["fragility"].to_dataset().sel(block="wall")
    low, high = (found["median"] * np.exp(side * found["beta"]) for side in (-3.0, 3.0))
    assert found["level"].isel(point=0).values == pytest.approx(low.min("limit_state").values)
    assert found["level"].isel(point=-1).values == pytest.approx(high.max("limit_state").values)


def test_a_body_in_a_direction_of_its_own_is_shaken_in_it():
    pair = [
        replace(pulse(number, "Kobe"), id=f"S.{name}", network="N", station="S", channel=name, azimuth=azimuth)
        for number, (name, azimuth) in enumerate([("HNE", 90.0), ("HNN", 0.0)])
    ]
    own = {"others": {}, "own": {"azimuth": 30.0}}
    blocks = tuple(rp.BlockSettings(name=name, width=0.6, height=3.0, **known) for name, known in own.items())
    config = replace(options(), bodies=blocks, records=rp.RecordSettings(components="azimuth", azimuth=75.0))
    found = rp.fragility(pair, config)["capacities"]["measure_value"].sel(measure="pga").isel(record=0)
    assert found.values.tolist() == pytest.approx([rotate(Pair(*pair), azimuth).pga for azimuth in (75.0, 30.0)])


def test_capacities_ascend_with_the_limit_state_and_uplift_is_exact(tree):
    factor = tree["capacities"]["factor"]
    assert bool((factor.diff("limit_state") > 0.0).all())
    wall = BLOCKS["wall"]
    uplift = wall.gravity * np.tan(wall.alpha_c) / tree["capacities"]["measure_value"].sel(block="wall", measure="pga")
    np.testing.assert_allclose(factor.sel(block="wall", limit_state="uplift"), uplift)
    step = tree["fragility"].to_dataset().sel(block="wall", limit_state="uplift", measure="pga")
    assert float(step["median"]) == pytest.approx(wall.gravity * np.tan(wall.alpha_c))
    assert "a step at 1.96" in str(step["statement"].values)
    assert str(tree["efficiency"]["most_efficient"].sel(block="wall", limit_state="uplift").values) == "pga"


@pytest.mark.sweep
def test_the_file_says_how_the_capacities_were_searched(records):
    few = options(limit_states=["uplift", "overturning"], measures=["pga"]).fragility
    site = rp.SiteSettings(name="Tower", description="A tower.")
    coarse = Config(site=site, fragility=few, search=SearchSettings(factor_max=25.0, points=9))
    found = rp.fragility(records[:2], coarse, BLOCKS)
    assert (found.attrs["title"], found.attrs["site_description"]) == ("Tower", "A tower.")
    capacities = found["capacities"].to_dataset()
    assert (capacities.attrs["points"], capacities.attrs["factor_max"]) == (9, 25.0)
    start = capacities["factor"].sel(limit_state="uplift")
    np.testing.assert_allclose(capacities["search_step"], (25.0 / start) ** (1 / 8), rtol=1e-9)


@pytest.mark.sweep
def test_one_record_that_overturns_several_bodies_is_one_record(records):
    """All bodies put together hold three capacities, of one record."""
    block = {f"wall {size:g}": Block(half_width=0.3 * size, half_height=1.5 * size) for size in (1.0, 1.02, 1.04)}
    strong = rp.Record(30.0 * records[0].acceleration, dt=0.02, id="strong", event="Kobe", processed=True)
    search = SearchSettings(factor_max=1.0, points=16)
    confirmed = rp.RecordSettings(confirm=("strong",))  # its peak is 6 g
    config = Config(fragility=options(measures=["velocity_ratio"]).fragility, search=search, records=confirmed)
    found = rp.fragility([strong, *records[1:]], config, block)
    assert int((found["capacities"]["reached"].sel(limit_state="overturning") == 1).sum()) == 3
    pooled = found["efficiency"].to_dataset().sel(limit_state="overturning", measure="velocity_ratio")
    assert np.isnan(float(pooled["pooled_median"]))
    assert "records reached the limit state (at" in str(pooled["pooled_statement"].values)


def test_the_order_of_the_records_does_not_matter(records):
    few = options(data="cloud", limit_states=[0.4], measures=["pga"])
    one, other = (rp.fragility(every, few, BLOCKS) for every in (records, records[::-1]))
    xr.testing.assert_identical(one, other)


@pytest.mark.sweep
@pytest.mark.parametrize("data", ["stripes", "cloud"])
def test_stripes_and_clouds_count_what_is_reached(records, striped, data):
    found = striped if data == "stripes" else rp.fragility(records, options(data=data), BLOCKS)
    capacities = found["capacities"].to_dataset()
    value = capacities["measure_value"].sel(measure="velocity_ratio")
    if data == "stripes":
        np.testing.assert_allclose(
            (capacities["factor"] * value).transpose("stripe", ...).mean(["record", "block"]), LEVELS
        )
    else:
        assert bool((capacities["factor"] == 1.0).all())
    curve = found["fragility"].to_dataset().sel(block="pier", limit_state="0.4", measure="velocity_ratio")
    reached = capacities["reached"].sel(block="pier", limit_state="0.4")
    assert int(curve["reached"]) == int(reached.sum())
    fit = rp.fit_stripes(
        (capacities["factor"] * value).sel(block="pier").values.ravel(),
        reached.values.ravel() == 1,
        np.repeat(capacities["event"].values, reached.sizes["stripe"]),
        np.repeat(capacities["record"].values, reached.sizes["stripe"]),
    )
    np.testing.assert_equal(float(curve["median"]), fit.median)
    assert str(curve["statement"].values) == fit.statement


def test_all_bodies_together_are_clustered_by_event(tree):
    capacities = tree["capacities"].to_dataset().sel(limit_state="overturning", measure="velocity_ratio")
    product = capacities["factor"] * capacities["measure_value"]
    event = capacities["event"].broadcast_like(product)
    fit = rp.fit_capacities(product.values.ravel(), event.values.ravel(), model="logistic")
    found = tree["efficiency"].to_dataset().sel(limit_state="overturning", measure="velocity_ratio")
    assert float(found["pooled_beta"]) == pytest.approx(fit.beta, rel=1e-9)
    assert (float(found["pooled_median_low"]), float(found["pooled_median_high"])) == pytest.approx(
        (fit.median_low, fit.median_high)
    )
    assert np.isnan(tree["efficiency"]["pooled_beta"].sel(measure="pga")).all()  # no common scale


@pytest.mark.sweep
def test_the_acceleration_that_lifts_a_body_is_told_where_the_ground_does_it_alone(tree, records):
    capacity = [block.gravity * np.tan(block.alpha_c) for block in BLOCKS.values()]
    assert tree["fragility"]["uplift_acceleration"].values == pytest.approx(capacity, rel=1e-12)
    floors = {"ground": (), "aloft": (rp.FloorSettings(period=0.5),)}
    bodies = tuple(rp.BlockSettings(name=name, width=0.6, height=3.0, floors=own) for name, own in floors.items())
    few = options(limit_states=["uplift"], measures=["pga"])
    for vertical, known in ((False, [True, False]), (True, [False, False])):
        config = replace(few, bodies=bodies, records=rp.RecordSettings(include_vertical=vertical))
        found = rp.fragility(records[:2], config)["fragility"]["uplift_acceleration"].values
        assert np.isfinite(found).tolist() == known


def test_a_tree_of_no_motion_has_every_variable_and_no_row():
    shapes = {}
    for data in ("ida", "stripes", "cloud"):
        config = options(data=data, stripe_levels=(0.4, 0.7))
        silent = rp.Record(np.zeros(100), dt=0.02, id="silent", processed=True)
        found = rp.fragility([silent], config, BLOCKS)
        table = found["capacities"].to_dataset()
        assert table.sizes["record"] == 0
        shapes[data] = dict(table.sizes)
        assert set(found["fragility"]["statement"].values.ravel()) == {"no curve: no record"}
        assert set(found["efficiency"]["most_efficient"].values.ravel()) == {""}
        assert found.attrs["title"] == "Fragility of rigid blocks under recorded ground motions"
    usual = {"record": 0, "block": 2, "measure": 2, "limit_state": 3}
    assert shapes == {"ida": usual, "stripes": usual | {"stripe": 2}, "cloud": usual | {"stripe": 1}}


def of_two(number):
    """A record of a peak of 2 m/s2."""
    one = pulse(number, f"event {number}")
    return replace(one, acceleration=2.0 * one.acceleration / one.pga)


def test_a_record_is_scaled_within_the_factors_and_both_ends_belong_to_them():
    chosen = {"limit_states": ["uplift", 0.2], "measures": ["pga"], "factors": (0.5, 2.0), "pga_min": 2.0}
    stripes = {"stripe_measure": "pga", "stripe_levels": (0.99, 1.0, 3.0, 4.0, 4.01)}
    weaker = replace(of_two(1), acceleration=0.999 * of_two(1).acceleration, id="weaker")
    found = rp.fragility([of_two(0), weaker], options(data="stripes", **chosen, **stripes), BLOCKS)
    table = found["capacities"].to_dataset()
    assert table["record"].values.tolist() == ["packet.0"]  # as strong as pga_min
    assert table["factor"].sel(block="wall").values.ravel() == pytest.approx([0.495, 0.5, 1.5, 2.0, 2.005])
    reached = table["reached"].sel(block="wall").isel(record=0).transpose("limit_state", "stripe").values
    assert (reached != -1).tolist() == [[False, True, True, True, False]] * 2
    lifting = BLOCKS["wall"].gravity * np.tan(BLOCKS["wall"].alpha_c)
    assert reached[0, 1:4].tolist() == [int(level > lifting) for level in (1.0, 3.0, 4.0)]
    # A cloud takes each record as it is, whatever the factors are.
    cloud = rp.fragility([of_two(0)], options(data="cloud", **chosen | {"factors": (3.0, 5.0)}), BLOCKS)
    table = cloud["capacities"].to_dataset()
    assert np.all(table["reached"].values != -1)
    assert np.all(table["factor"].values == 1.0)
    assert table["weight"].values.tolist() == [[1.0]]
    # An incremental analysis ends at the factor or at the search, whichever is less.
    for end, most in ((1.5, 30.0), (20.0, 1.5)):
        config = options(**chosen | {"factors": (0.5, end)})
        config = replace(config, search=SearchSettings(factor_max=most, points=16))
        table = rp.fragility([of_two(0)], config, BLOCKS)["capacities"].to_dataset()
        start = table["factor"].sel(block="wall", limit_state="uplift").item()
        assert start == pytest.approx(lifting / 2.0)
        assert table["search_step"].sel(block="wall").item() == pytest.approx((1.5 / start) ** (1 / 15))


def test_dispersions_are_compared_with_that_of_the_velocity_ratio(tree):
    curves = tree["fragility"].to_dataset()
    found = tree["efficiency"].to_dataset()
    ratio = found["beta_ratio"].transpose(*curves["beta"].dims)
    own = {"limit_state": "0.4"}
    expected = curves["beta"].sel(own) / curves["beta"].sel(own | {"measure": "velocity_ratio"})
    np.testing.assert_allclose(ratio.sel(own).values, expected.values, rtol=1e-9)
    one = found.sel(own | {"block": "pier"})
    assert float(one["beta_ratio_low"].sel(measure="pga")) < float(one["beta_ratio"].sel(measure="pga"))
    for name in ("beta_ratio", "beta_ratio_low", "beta_ratio_high"):
        assert float(one[name].sel(measure="velocity_ratio")) == 1.0
        assert np.isnan(
            found[name].sel(limit_state="uplift", measure="pga")
        ).all()  # a step has no dispersion to divide
    for block in BLOCKS:
        for state in ("0.4", "overturning"):
            beta = curves["beta"].sel(block=block, limit_state=state)
            best = str(beta["measure"].values[np.argmin(beta.values)])
            assert str(found["most_efficient"].sel(block=block, limit_state=state).values) == best
    assert {name: tree.attrs[name] for name in ("kind", "data", "confidence")} == {
        "kind": "fragility",
        "data": "ida",
        "confidence": 0.9,
    }


@pytest.mark.sweep
def test_weak_records_and_bad_ones_are_left_out_and_reported(records):
    silent = rp.Record(np.zeros(100), dt=0.02, id="silent", processed=True)
    weak = pulse(9, "weak", size=0.2)
    weakest = options(pga_min=1.0, limit_states=["uplift"])
    found = rp.fragility([*records, weak, silent], weakest, BLOCKS)
    assert found["capacities"].sizes["record"] == 6
    failures = found["failures"].to_dataset().to_dataframe()
    assert sorted(failures["kind"]) == ["failed", "skipped"]
    assert failures["reason"].str.contains(re.escape("is below [fragility] pga_min = 1 m/s2")).sum() == 1


def test_limit_states_are_kept_in_the_order_of_severity():
    assert FragilitySettings(limit_states=["overturning", 1, 0.1, "uplift"]).limit_states == (
        "uplift",
        0.1,
        1.0,
        "overturning",
    )


@pytest.mark.slow
def test_the_lobes_of_the_impulse_on_the_time_scale_of_the_block_are_efficient_on_real_records(records_folder):
    from rockpulse.config.settings import ConditioningSettings
    from rockpulse.readers.folders import read_all

    strong, _ = read_all([str(records_folder / name) for name in ("at2", "csmip_v1", "geonet", "csmip_v2", "renadic")])
    config = Config(
        conditioning=ConditioningSettings(baseline="mean", highpass_hz=0.1, lowpass_hz=24.0),
        fragility=ida(pga_min=1.471, factors=(0.001, 1000.0), limit_states=[0.4, "overturning"]),
    )
    alpha = np.arctan(1.0 / np.array([4.0, 8.0]))
    bodies = {
        f"{a:.3f} R {r:g}": Block(half_width=r * np.sin(a), half_height=r * np.cos(a))
        for a in alpha
        for r in (1.0, 4.0)
    }
    efficiency = rp.fragility(strong, config, bodies)["efficiency"].to_dataset()
    ratio = efficiency["pooled_beta_ratio"].sel(limit_state="overturning")
    print(ratio.to_series())
    assert float(ratio.sel(measure="demand_build_up")) < 0.85
    assert float(ratio.sel(measure="uplift_ratio")) > 1.2
    assert float(ratio.sel(measure="impulse_ratio")) == pytest.approx(1.0, abs=0.2)
