"""From records to the tree of fragility curves."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from nominal import ida

import rockpulse as rp
from rocking.block import Block
from rockpulse import FragilitySettings
from rockpulse.assessment.scene import prepare
from rockpulse.config.configuration import Config, SearchSettings
from rockpulse.errors import ConfigError
from rockpulse.record.components import Pair
from rockpulse.record.rotation import rotate
from rockpulse.studies.fragility.limit_states import limit_state_names, reached_at, scale_capacities

BLOCKS = {"wall": Block(half_width=0.3, half_height=1.5), "pier": Block(half_width=0.5, half_height=1.9365)}
STATES = ("uplift", 0.4, "overturning")
SCHEMA = Path(__file__).parents[4] / "docs" / "schema.md"


def pulse(number, event, size=2.0):
    """A wave packet with a period and a length of its own."""
    t = np.arange(0.0, 6.0, 0.02)
    period = 0.9 + 0.15 * number
    ground = size * np.sin(2.0 * np.pi * t / period) * np.exp(-(((t - 3.0) / (0.7 + 0.1 * (number % 3))) ** 2))
    return rp.Record(ground, dt=0.02, id=f"packet.{number}", event=event, processed=True)


def options(**fragility):
    known = {"limit_states": STATES, "measures": ("pga", "velocity_ratio")}
    return Config(fragility=ida(**{**known, **fragility}), search=SearchSettings(factor_max=30.0, points=32))


@pytest.fixture(scope="module")
def records():
    return [pulse(number, event) for number, event in enumerate(["Kobe", "Kobe", "Maule", "Maule", "Izmit", "Duzce"])]


@pytest.fixture(scope="module")
def tree(records):
    return rp.fragility_curves(records, options(), BLOCKS)


def test_the_facts_of_each_record_are_stored():
    known = {"magnitude": 6.3, "epicentral_distance": 5300.0, "vs30": 717.0, "event_id": "IT-2009-0009"}
    shaken = [replace(pulse(0, "Kobe"), **known), pulse(1, "Maule")]
    found = rp.fragility_curves(shaken, options(data="cloud"), BLOCKS)["capacities"].to_dataset()
    assert {name: found[name].values[0].item() for name in known} == known
    assert np.isnan(found["epicentral_distance"].values[1])
    assert found["event_id"].values[1] == ""


def test_capacity_is_tested_to_depend_on_what_the_files_state(records, tree):
    magnitudes = {"Kobe": 6.9, "Maule": 8.8, "Izmit": 7.6, "Duzce": np.nan}
    stated = [replace(record, magnitude=magnitudes[record.event], vs30=300.0) for record in records]
    found = rp.fragility_curves(stated, options(), BLOCKS)["efficiency"].to_dataset()
    qualities = ["duration", "period", "strong_half_waves", "strength", "magnitude", "epicentral_distance", "vs30"]
    assert found["quality"].values.tolist() == qualities
    assert found["quality_records"].values.tolist() == [6, 6, 6, 6, 5, 0, 6]
    assert found["quality_events"].values.tolist() == [4, 4, 4, 4, 3, 0, 4]
    known = np.isfinite(found["pooled_p_value"].sel(limit_state="0.4", measure="velocity_ratio"))
    assert dict(zip(qualities[4:], known.values[4:].tolist(), strict=True)) == {
        "magnitude": True,
        "epicentral_distance": False,  # nobody states it
        "vs30": False,  # the same for all
    }
    others = {"quality": qualities[:4]}
    before = tree["efficiency"].to_dataset().sel(others)
    xr.testing.assert_equal(found.sel(others), before)  # a fact of some records changes nothing else


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


def test_the_levels_of_a_curve_reach_three_dispersions_beyond_the_medians_on_both_sides(tree):
    found = tree["fragility"].to_dataset().sel(block="wall", measure="velocity_ratio")
    median, beta, level = found["median"].values, found["beta"].values, found["level"].values
    assert level[0] == pytest.approx(np.nanmin(median * np.exp(-3.0 * beta)), rel=1e-12)
    assert level[-1] == pytest.approx(np.nanmax(median * np.exp(3.0 * beta)), rel=1e-12)


def test_a_body_in_a_direction_of_its_own_is_shaken_in_it():
    pair = [
        replace(pulse(number, "Kobe"), id=f"S.{name}", network="N", station="S", channel=name, azimuth=azimuth)
        for number, (name, azimuth) in enumerate([("HNE", 90.0), ("HNN", 0.0)])
    ]
    own = {"others": {}, "own": {"azimuth": 30.0}}
    blocks = tuple(rp.BlockSettings(name=name, width=0.6, height=3.0, **known) for name, known in own.items())
    config = replace(options(), blocks=blocks, records=rp.RecordSettings(components="azimuth", azimuth=75.0))
    found = rp.fragility_curves(pair, config)["capacities"]["measure_value"].sel(measure="pga").isel(record=0)
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


@pytest.mark.parametrize("equation", ["nonlinear", "linear"])
def test_a_capacity_is_where_the_response_reaches_the_limit_state(records, equation):
    block = Block.stack(list(BLOCKS.values()))
    motion = prepare(records[0], Config())
    factors = scale_capacities(motion, block, STATES, equation, 30.0, 64).factors
    for state, factor in enumerate(factors):
        around = np.stack([factor * (1.0 - 1e-5), factor * (1.0 + 1e-5)])
        assert reached_at(motion, block, STATES, equation, around)[state].tolist() == [[0, 0], [1, 1]]


def test_a_capacity_above_the_search_is_not_known(records):
    """Uplift, known in closed form, ends with the search as the others do."""
    block = Block.stack(list(BLOCKS.values()))
    motion = prepare(records[0], Config())
    lifted = scale_capacities(motion, block, ["uplift"], "nonlinear", 1e6, 8)
    assert np.all(np.isfinite(lifted.factors))
    assert np.all(lifted.step == 1.0)  # a closed form misses nothing
    between = float(np.mean(lifted.factors))
    found = scale_capacities(motion, block, STATES, "nonlinear", between, 8)
    reached = lifted.factors[0] <= between
    assert sorted(reached.tolist()) == [False, True]
    np.testing.assert_array_equal(found.factors[0], np.where(reached, lifted.factors[0], np.inf))
    assert np.all(np.isinf(found.factors[-1]))
    np.testing.assert_allclose(found.step, np.where(reached, (between / lifted.factors[0]) ** (1 / 7), 1.0))


def test_the_file_says_how_the_capacities_were_searched(records):
    few = options(limit_states=["uplift", "overturning"], measures=["pga"]).fragility
    coarse = Config(fragility=few, search=SearchSettings(factor_max=25.0, points=9))
    capacities = rp.fragility_curves(records[:2], coarse, BLOCKS)["capacities"].to_dataset()
    assert (capacities.attrs["points"], capacities.attrs["factor_max"]) == (9, 25.0)
    start = capacities["factor"].sel(limit_state="uplift")
    np.testing.assert_allclose(capacities["search_step"], (25.0 / start) ** (1 / 8), rtol=1e-9)


def test_one_record_that_overturns_several_bodies_is_one_record(records):
    """All bodies put together hold three capacities, of one record."""
    block = {f"wall {size:g}": Block(half_width=0.3 * size, half_height=1.5 * size) for size in (1.0, 1.02, 1.04)}
    strong = rp.Record(30.0 * records[0].acceleration, dt=0.02, id="strong", event="Kobe", processed=True)
    search = SearchSettings(factor_max=1.0, points=16)
    confirmed = rp.RecordSettings(confirm=("strong",))  # its peak is 6 g
    config = Config(fragility=options(measures=["velocity_ratio"]).fragility, search=search, records=confirmed)
    found = rp.fragility_curves([strong, *records[1:]], config, block)
    assert int((found["capacities"]["reached"].sel(limit_state="overturning") == 1).sum()) == 3
    pooled = found["efficiency"].to_dataset().sel(limit_state="overturning", measure="velocity_ratio")
    assert np.isnan(float(pooled["pooled_median"]))
    assert "one record only reached the limit state" in str(pooled["pooled_statement"].values)


def test_the_order_of_the_records_does_not_matter(tree, records):
    xr.testing.assert_identical(rp.fragility_curves(records[::-1], options(), BLOCKS), tree)


@pytest.mark.parametrize("data", ["stripes", "cloud"])
def test_stripes_and_clouds_count_what_is_reached(records, data):
    levels = (0.4, 0.7, 1.2)
    found = rp.fragility_curves(records, options(data=data, stripe_levels=levels), BLOCKS)
    capacities = found["capacities"].to_dataset()
    value = capacities["measure_value"].sel(measure="velocity_ratio")
    if data == "stripes":
        np.testing.assert_allclose(
            (capacities["factor"] * value).transpose("stripe", ...).mean(["record", "block"]), levels
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


def test_nothing_overturns_everything_overturns_one_record_only(records):
    own = {"block": "wall", "limit_state": "overturning", "measure": "velocity_ratio"}

    def verdict(records, config):
        curve = rp.fragility_curves(records, config, BLOCKS)["fragility"].to_dataset().sel(own)
        assert np.isnan([float(curve[name]) for name in ("median", "median_low", "beta", "beta_high")]).all()
        assert np.isnan(curve["probability"]).all()
        names = curve["status"].attrs["flag_meanings"].split()
        return names[int(curve["status"])], str(curve["statement"].values)

    one = {"limit_states": ["overturning"], "measures": ["velocity_ratio"]}
    weak = Config(fragility=options(**one).fragility, search=SearchSettings(factor_max=1.0))
    status, words = verdict(records, weak)
    assert status == "nothing_reached"
    assert words.startswith("no curve: none of 6 records reached the limit state, looked at up to")
    status, words = verdict(records, options(data="stripes", stripe_levels=[20.0, 40.0], **one))
    assert status == "everything_reached"
    assert words == "no curve: all of 6 records reached the limit state at every level, from 20; look at lower levels"
    status, words = verdict(records[:1], options(**one))
    assert status == "one_record"
    assert words.startswith("no curve: one record only")


def test_records_of_one_event_give_a_curve_without_a_band():
    alone = rp.fragility_curves(
        [pulse(number, "Kobe") for number in range(4)], options(limit_states=["overturning"]), BLOCKS
    )
    curve = alone["fragility"].to_dataset().sel(block="wall", limit_state="overturning", measure="pga")
    assert np.isfinite(float(curve["median"]))
    assert np.isnan(float(curve["median_low"]))
    assert str(curve["statement"].values) == "no band: the records come from 1 event, it needs 3"


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


def test_weak_records_and_bad_ones_are_left_out_and_told(records):
    silent = rp.Record(np.zeros(100), dt=0.02, id="silent", processed=True)
    weak = pulse(9, "weak", size=0.2)
    found = rp.fragility_curves([*records, weak, silent], options(pga_min=1.0, limit_states=["uplift"]), BLOCKS)
    assert found["capacities"].sizes["record"] == 6
    failures = found["failures"].to_dataset().to_dataframe()
    assert sorted(failures["kind"]) == ["failed", "skipped"]
    assert failures["reason"].str.contains(re.escape("is below [fragility] pga_min = 1 m/s2")).sum() == 1


def test_a_list_of_restitutions_makes_bodies_of_their_own(records):
    several = {"wall": Block(half_width=0.3, half_height=1.5, restitution=[0.85, 0.9])}
    found = rp.fragility_curves(records, options(limit_states=["overturning"], measures=["pga"]), several)
    assert found["fragility"]["block"].values.tolist() == ["wall C 0.85", "wall C 0.9"]


def test_two_records_of_one_id_are_refused(records):
    with pytest.raises(ConfigError, match=r"more than one record with id packet\.0"):
        rp.fragility_curves([records[0], records[0]], options(), BLOCKS)


def test_it_comes_back_from_the_file_the_same(tree, tmp_path):
    rp.save(tree, tmp_path / "f.h5")
    again = rp.load(tmp_path / "f.h5")
    for group in ("fragility", "capacities", "efficiency", "failures"):
        xr.testing.assert_equal(again[group].to_dataset(), tree[group].to_dataset())


def test_the_schema_names_every_variable(tree, records):
    text = SCHEMA.read_text(encoding="utf-8").partition("## The fragility file")[2].partition("\n## ")[0]
    cloud = rp.fragility_curves(records[:2], options(data="cloud", limit_states=["uplift"]), BLOCKS)
    for one in (tree, cloud):
        for group in ("fragility", "capacities", "efficiency"):
            for name in one[group].to_dataset().variables:
                assert f"`{name}`" in text, (group, name)


def test_names_of_limit_states():
    assert limit_state_names(FragilitySettings().limit_states) == ["uplift", "0.1", "0.4", "0.6", "1", "overturning"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"limit_states": ["uplifts"]}, 'found .*did you mean "uplift"'),
        ({"limit_states": []}, "expected a list"),
        ({"limit_states": [0.1, 0.1]}, "each once"),
        ({"limit_states": [1.5]}, r"numbers in \(0, 1\]"),
        ({"limit_states": [True]}, r"numbers in \(0, 1\]"),
        ({"stripe_levels": [1.0, 0.5]}, "positive numbers that ascend"),
        ({"measures": ["PGA"]}, "did you mean|expected a list"),
        ({"data": "msa"}, "expected one of"),
        ({"confidence": 0.2}, "0.5"),
    ],
)
def test_the_section_is_strict(values, message):
    with pytest.raises(ConfigError, match=message):
        FragilitySettings(**values)


def test_limit_states_are_kept_in_the_order_of_severity():
    assert FragilitySettings(limit_states=["overturning", 1, 0.1, "uplift"]).limit_states == (
        "uplift",
        0.1,
        1.0,
        "overturning",
    )


@pytest.mark.slow
def test_the_lobes_of_the_impulse_on_the_time_scale_of_the_block_are_efficient_on_real_records(records_folder):
    from rockpulse.config.configuration import ConditioningSettings
    from rockpulse.readers.folders import read_all

    strong, _ = read_all([str(records_folder / name) for name in ("at2", "csmip_v1", "geonet", "csmip_v2", "renadic")])
    config = Config(
        conditioning=ConditioningSettings(baseline="mean", highpass_hz=0.1, lowpass_hz=24.0),
        fragility=ida(pga_min=1.471, factors=(0.001, 1000.0), limit_states=[0.4, "overturning"]),
    )
    alpha = np.arctan(1.0 / np.array([4.0, 8.0]))
    bodies = {f"{a:.3f} R {r:g}": Block(r * np.sin(a), r * np.cos(a)) for a in alpha for r in (1.0, 4.0)}
    efficiency = rp.fragility_curves(strong, config, bodies)["efficiency"].to_dataset()
    ratio = efficiency["pooled_beta_ratio"].sel(limit_state="overturning")
    print(ratio.to_series())
    assert float(ratio.sel(measure="demand_build_up")) < 0.85
    assert float(ratio.sel(measure="uplift_ratio")) > 1.2
    assert float(ratio.sel(measure="impulse_ratio")) == pytest.approx(1.0, abs=0.2)
