"""Quantiles over earthquakes and their intervals, the spectrum of one motion of a site, and the file of a site."""

from dataclasses import replace

import numpy as np
import pytest
from site_spectra import BASE, BLOCKS, base_at, site_of, usual_site

import rockpulse as rp
from rocking.body.limits import RATES
from rocking.search.capacity import sequence_critical_scale
from rockpulse import CalibrationSettings
from rockpulse.assessment.spectra import LANES
from rockpulse.earthquakes import bootstrap_interval, draw_earthquakes, record_quantiles, weighted_quantile
from rockpulse.errors import ResultsError
from rockpulse.models import Block, ImpulseSequence, Outcome, critical_impulse, sequence_response
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.storage.variables.site import SITE_GROUPS
from rockpulse.studies.site.calibration import design_of
from rockpulse.studies.site.spectrum_design import fewest_events

EVENTS = np.array([0, 0, 0, 1, 2, 2, 3, 4, 5, 6, 6, 7])
WEIGHTS = 1.0 / np.bincount(EVENTS)[EVENTS]
VALUES = np.exp(np.random.default_rng(2).standard_normal((12, 2, 3)))


def quantiles(values, levels, predictive, events=EVENTS, weights=WEIGHTS):
    known = {"weights": weights, "events": events, "draws": draws_of(events), "confidence": 0.9}
    return record_quantiles(values, levels, predictive, **known)


def draws_of(events):
    return draw_earthquakes(int(events.max()) + 1, 60, 0)


def test_quantiles_and_intervals_are_those_of_the_resamples_one_by_one():
    found = quantiles(VALUES, [0.5, 0.84], False)
    for level, own in zip((0.5, 0.84), found, strict=True):
        assert own.value.shape == (2, 3)
        for place in np.ndindex(2, 3):
            of = VALUES[(slice(None), *place)]
            value = weighted_quantile(of, level, WEIGHTS)
            assert own.value[place] == value
            # Every resample with its records written out as often as their event was drawn.
            drawn = []
            for times in draws_of(EVENTS):
                rows = np.repeat(np.arange(12), times[EVENTS])
                drawn.append(weighted_quantile(of[rows], level, WEIGHTS[rows]))
            ends = bootstrap_interval(value, np.array(drawn), np.ones(8), 0.9)
            np.testing.assert_allclose((own.lower[place], own.upper[place]), ends, rtol=1e-12)


def test_more_records_of_an_earthquake_count_no_more_than_one():
    twice = np.concatenate([EVENTS, EVENTS[:3]])
    values = np.concatenate([VALUES, VALUES[:3]])
    weights = 1.0 / np.bincount(twice)[twice]
    (alone,), (more,) = quantiles(VALUES, [0.84], False), quantiles(values, [0.84], False, twice, weights)
    for name in ("value", "lower", "upper"):
        np.testing.assert_allclose(getattr(alone, name), getattr(more, name), rtol=1e-12)


def test_a_single_earthquake_has_no_interval():
    (found,) = quantiles(VALUES, [0.5], True, np.zeros(12, dtype=int), np.ones(12))
    assert np.isfinite(found.value).all()
    assert np.isnan(found.lower).all()
    assert np.isnan(found.upper).all()


@pytest.mark.parametrize(("quantile", "least"), [(0.5, 5), (0.8, 5), (0.84, 7), (0.9, 10), (0.95, 20), (0.1, 10)])
def test_one_earthquake_lies_beyond_a_stated_quantile(quantile, least):
    assert fewest_events(quantile) == least


TIME = 0.01 * np.arange(400)
MOTION = 4.0 * np.sin(2.0 * np.pi * 1.2 * TIME) * np.exp(-(((TIME - 2.0) / 0.8) ** 2))


def record(size=1.0, number=0):
    return rp.Record(size * MOTION, dt=0.01, id=f"burst{number}", event=f"Earthquake {number}", processed=True)


def spectra(word, *records, **calibration):
    config = rp.Config(calibration=CalibrationSettings(spectrum=word, bootstrap=100, **calibration))
    return rp.calibrate(records, config)["spectra"]


def test_every_word_of_the_configuration_has_a_spectrum():
    assert set(LANES) == set(CalibrationSettings.__dataclass_fields__["spectrum"].metadata["values"].words)


@pytest.fixture(scope="module")
def by_rule():
    return spectra("rule", record(), record(2.0, 1))


@pytest.mark.sweep
def test_the_rule_overturns_where_its_demand_does(by_rule):
    found = by_rule["spectrum"].sel(record="burst0").values
    p, c = (values.ravel() for values in np.meshgrid(RATES[[4, 8, 12]], RESTITUTIONS[[1, 4]], indexing="ij"))
    own = found[[4, 8, 12]][:, [1, 4]].ravel()
    # At higher p uplift decides: there the spectrum folds the uncertainty in, and the demand ends at PGA.
    waves = rp.half_waves(record())
    effective = []
    for slenderness in (4.0, 12.0):
        blocks = Block.from_parameters(p=p, alpha=np.arctan(1.0 / slenderness), restitution=c, log=False)
        effective.append(rp.load_rule().demand(waves, blocks) * blocks.gravity * np.tan(blocks.alpha_c) / p)
    # S is one for bodies of any slenderness; a spectrum has other lanes than a body, few of them with a C near 1.
    np.testing.assert_allclose(effective[0], effective[1], rtol=1e-9)
    np.testing.assert_allclose(effective[0], own, rtol=0.2)
    assert np.std(np.log(effective[0] / own)) < 0.07


def test_the_spectrum_is_proportional_to_the_record(by_rule):
    # But for the fixed levels of x on which the probability is known, and its falls between them.
    np.testing.assert_allclose(by_rule["spectrum"][1], 2.0 * by_rule["spectrum"][0], rtol=1e-3)


@pytest.mark.sweep
def test_the_site_reads_the_spectrum_that_python_gives(by_rule):
    own = rp.overturning_spectrum(record(), restitution=RESTITUTIONS, method="rule")
    np.testing.assert_allclose(by_rule["spectrum"][0], own["spectrum"], rtol=1e-12)
    assert own.attrs["method"] == "rule"


@pytest.mark.slow
def test_the_nonlinear_spectrum_is_that_of_the_record_scaled_to_the_target():
    found = spectra("nonlinear", record(), scale_to="pga", target=2.0 * record().pga)["spectrum"]
    own = rp.overturning_spectrum(record(2.0))["spectrum"]
    np.testing.assert_allclose(found[0], own, rtol=1e-6)


STRENGTHS = np.linspace(0.5, 1.4, 10)
#: Between the fifth and the sixth, and at 0.84 x 11 = 9.24 of ten, in the logarithm.
MEDIAN, DESIGNED = np.sqrt(0.9 * 1.0), 1.3 * (1.4 / 1.3) ** 0.24
WALL, PIER = BLOCKS["wall"], BLOCKS["pier"]


def sequence_of(one):
    main, ratio, interval, count = (float(one[name]) for name in ("main", "ratio", "interval", "main_count"))
    return ImpulseSequence(main, ratio * main, interval, np.inf, int(count))


def speed(block):
    return block.gravity * np.tan(block.alpha_c) / block.p


@pytest.mark.sweep
def test_the_quantiles_are_those_of_the_records():
    spectra = usual_site()["spectra"]
    for name, strength in (("spectrum_50", MEDIAN), ("spectrum_84", DESIGNED), ("spectrum_design", DESIGNED)):
        np.testing.assert_allclose(spectra[name], strength * BASE, rtol=1e-12)
        assert (spectra[f"{name}_lower"] < spectra[name]).all()
        assert (spectra[name] < spectra[f"{name}_upper"]).all()
    site = usual_site()["site"]
    assert [float(site[name]) for name in ("ratio", "interval", "main_count")] == [
        np.linspace(0.1, 0.5, 10)[4],
        pytest.approx(np.linspace(0.1, 0.2, 10)[4]),
        6.0,
    ]


def test_every_body_has_its_effective_impulse_and_a_sequence_of_that_effect():
    site = usual_site()["site"].to_dataset()
    for name, block in (("wall", WALL), ("pier", PIER)):
        one = site.sel(block=name)
        assert float(one["effective_impulse"]) == pytest.approx(DESIGNED * base_at(block), rel=1e-12)
        assert float(one["design_factor"]) == pytest.approx(speed(block) / (DESIGNED * base_at(block)), rel=1e-12)
        sequence = sequence_of(one)
        critical = sequence_critical_scale(block, sequence).safety_factor[0]
        assert critical == pytest.approx(float(one["design_factor"]), rel=0.003)
        response = sequence_response(block, sequence)
        assert float(one["rotation_ratio"]) == pytest.approx(response.peak_rotation_ratio)
        assert (response.outcome == Outcome.OVERTURNS) == (float(one["design_factor"]) <= 1.0)
        counts = response.half_cycles.impulse_count
        assert (int(one["least_count"]), int(one["most_count"])) == (counts[0], counts.max())
        assert float(one["critical_impulse_2"]) == pytest.approx(critical_impulse(block, 2))
        overturned = np.mean(STRENGTHS * base_at(block) >= speed(block))
        assert float(one["overturned_share"]) == pytest.approx(overturned)


def test_an_endless_sequence_overturns_in_a_half_cycle_or_stabilises():
    site = usual_site()["site"].to_dataset()
    for name, block in (("wall", WALL), ("pier", PIER)):
        one = site.sel(block=name)
        endless = sequence_response(block, replace(sequence_of(one), main_count=None))
        assert int(one["half_cycle"]) == max(endless.overturning_half_cycle, 0)
        assert float(one["stabilised_rotation"]) == pytest.approx(endless.peak_rotation_ratio)
        # The last main impulse of the design overturns no later than its number.
        if float(one["design_factor"]) <= 1.0:
            assert 1 <= int(one["half_cycle"]) <= int(one["main_count"])


def test_a_stronger_effect_is_a_smaller_factor_and_the_ends_go_together():
    site = usual_site()["site"].sel(block=["wall", "pier"])
    for end, opposite in (("lower", "upper"), ("upper", "lower")):
        both = site[f"effective_impulse_{end}"] * site[f"design_factor_{opposite}"]
        np.testing.assert_allclose(both, site["effective_impulse"] * site["design_factor"], rtol=1e-12)
        kept = site[f"main_{end}"] / site[f"effective_impulse_{end}"]
        np.testing.assert_allclose(kept, site["main"] / site["effective_impulse"], rtol=1e-12)
        assert float(site[f"main_count_{end}"]) % 1.0 == 0.0


def test_a_body_outside_the_spectrum_has_no_design_and_is_named():
    site = usual_site()["site"].to_dataset()
    assert str(site["site_warnings"].item()) == "no design for bodies outside the range of the spectrum: chest"
    chest = site.sel(block="chest")
    assert np.isnan([chest[name] for name in ("effective_impulse", "design_factor", "main", "overturned_share")]).all()
    assert float(chest["p"]) == BLOCKS["chest"].p


@pytest.mark.sweep
def test_earthquakes_are_alike_by_default_and_records_where_asked():
    events = [0] * 6 + [1, 2, 3, 4, 5, 6]
    strengths = np.arange(1.0, 13.0)
    alike = 1.0 / np.array([6.0] * 6 + [1.0] * 6)
    for weights, expected in (("event", alike), ("equal", np.ones(12))):
        tree = site_of(strengths, events, weights=weights, quantile=0.6)
        sums = np.bincount(events, expected)
        count = sums.sum() ** 2 / np.sum(sums**2)
        share = (np.cumsum(expected) - 0.5 * expected) / expected.sum()
        value = np.exp(np.interp((0.6 * (count + 1.0) - 0.5) / count, share, np.log(strengths)))
        np.testing.assert_allclose(tree["spectra"]["spectrum_design"], value * BASE, rtol=1e-12)
    assert tree["site"].attrs["weights"] == "equal"


def test_too_few_earthquakes_are_said_in_one_line_and_give_no_number():
    tree = site_of(STRENGTHS, [0, 1, 2, 3, 4, 5] + [5] * 4)
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    assert str(site["site_warnings"].item()) == "not enough earthquakes (6; at least 7 for the quantile 0.84)"
    for name, one in {**site.data_vars, **spectra.data_vars}.items():
        if one.dims in (("block",), ("p",), ("p", "restitution")) and name not in (
            *("alpha_c", "p", "restitution", "critical_impulse", "critical_impulse_2"),
            *("half_cycle", "least_count", "most_count"),
        ):
            assert np.isnan(one).all(), name
    np.testing.assert_allclose(spectra["spectrum"].isel(record=3), STRENGTHS[3] * BASE)


@pytest.mark.sweep
def test_without_bodies_the_spectrum_stands_alone():
    tree = site_of(STRENGTHS, blocks=None)
    assert tree["site"].sizes["block"] == 0
    np.testing.assert_allclose(tree["spectra"]["spectrum_design"], DESIGNED * BASE, rtol=1e-12)


def test_the_file_holds_what_is_declared_and_nothing_else():
    tree = usual_site()
    for group in ("site", "spectra"):
        declared = SITE_GROUPS[f"/{group}"]
        stored = tree[group].to_dataset(inherit=False).variables
        assert set(stored) == set(declared), group
        for name, one in stored.items():
            assert one.dims == declared[name].dims, name
            assert one.attrs["units"] == declared[name].units


@pytest.mark.sweep
def test_the_stored_design_is_the_one_that_bodies_are_assessed_under(tmp_path):
    rp.save(usual_site(), tmp_path / "site.h5")
    design = rp.load_design(tmp_path / "site.h5")
    np.testing.assert_allclose(design.effective_impulse(WALL), DESIGNED * base_at(WALL), rtol=1e-12)
    with pytest.raises(ResultsError, match=r"few: no design spectrum: not enough earthquakes \(3; at least 7"):
        design_of(site_of(STRENGTHS[:3]), "few")
