"""The site file by the spectrum, of given spectra."""

import numpy as np
import pytest
from site_spectra import BASE, BLOCKS, base_at, site_of, usual_site

import rockpulse as rp
from rockpulse.errors import ResultsError
from rockpulse.models import ImpulseSequence
from rockpulse.storage.variables.site import SITE_GROUPS
from rockpulse.studies.site.statistics import weighted_quantile

STRENGTHS = np.linspace(0.5, 1.4, 10)
WALL, PIER = BLOCKS["wall"], BLOCKS["pier"]


def speed(block):
    return block.gravity * np.tan(block.alpha_c) / block.p


def test_the_quantiles_are_those_of_the_records():
    spectra = usual_site()["spectra"]
    for name, strength in (("spectrum_50", 0.9), ("spectrum_84", 1.3), ("spectrum_design", 1.3)):
        np.testing.assert_allclose(spectra[name], strength * BASE, rtol=1e-12)
        assert (spectra[f"{name}_lower"] < spectra[name]).all()
        assert (spectra[name] < spectra[f"{name}_upper"]).all()
    assert (spectra["main_count"] == 6).all()
    np.testing.assert_allclose(spectra["ratio"], np.linspace(0.1, 0.5, 10)[4])


def test_every_body_has_its_effective_impulse_and_a_sequence_of_that_effect():
    site = usual_site()["site"].to_dataset()
    for name, block in (("wall", WALL), ("pier", PIER)):
        one = site.sel(block=name)
        assert float(one["effective_impulse"]) == pytest.approx(1.3 * base_at(block), rel=1e-12)
        assert float(one["design_factor"]) == pytest.approx(speed(block) / (1.3 * base_at(block)), rel=1e-12)
        main, ratio = float(one["main"]), float(one["ratio"])
        sequence = ImpulseSequence(main, ratio * main, np.nan, np.inf, int(one["main_count"]), spacing="continuous")
        critical = block.critical_impulse / sequence.effective_impulse(block.restitution)
        assert critical == pytest.approx(float(one["design_factor"]), rel=1e-12)
        overturned = np.mean(STRENGTHS * base_at(block) >= speed(block))
        assert float(one["overturned_share"]) == pytest.approx(overturned)


def test_a_stronger_effect_is_a_smaller_factor_and_the_ends_go_together():
    site = usual_site()["site"].sel(block=["wall", "pier"])
    for end, opposite in (("lower", "upper"), ("upper", "lower")):
        both = site[f"effective_impulse_{end}"] * site[f"design_factor_{opposite}"]
        np.testing.assert_allclose(both, site["effective_impulse"] * site["design_factor"], rtol=1e-12)
        kept = site[f"main_{end}"] / site[f"effective_impulse_{end}"]
        np.testing.assert_allclose(kept, site["main"] / site["effective_impulse"], rtol=1e-12)
        assert (site[f"main_count_{end}"] % 1.0 == 0.0).all()


def test_a_body_outside_the_spectrum_has_no_design_and_is_named():
    site = usual_site()["site"].to_dataset()
    assert str(site["remarks"].item()) == "outside the spectrum, and without a design: chest"
    chest = site.sel(block="chest")
    assert np.isnan([chest[name] for name in ("effective_impulse", "design_factor", "main", "overturned_share")]).all()
    assert float(chest["p"]) == BLOCKS["chest"].p


def test_earthquakes_are_alike_by_default_and_records_where_asked():
    events = [0] * 6 + [1, 2, 3, 4, 5, 6]
    strengths = np.arange(1.0, 13.0)
    alike = 1.0 / np.array([6.0] * 6 + [1.0] * 6)
    for weights, expected in ((None, alike), ("equal", np.ones(12))):
        tree = site_of(strengths, events, weights=weights, quantile=0.6)
        value = weighted_quantile(strengths, 0.6, expected)
        np.testing.assert_allclose(tree["spectra"]["spectrum_design"], value * BASE, rtol=1e-12)
    assert tree["site"].attrs["weights"] == "equal"


def test_too_few_earthquakes_are_said_in_one_line_and_give_no_number():
    tree = site_of(STRENGTHS, [0, 1, 2, 3, 4, 5] + [5] * 4)
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    assert str(site["remarks"].item()) == "not enough earthquakes (6; at least 7 for the quantile 0.84)"
    for name, one in {**site.data_vars, **spectra.data_vars}.items():
        if one.dims in (("block",), ("p",), ("p", "restitution")) and name not in (
            *("alpha_c", "p", "restitution", "critical_impulse"),
        ):
            assert np.isnan(one).all(), name
    np.testing.assert_allclose(spectra["spectrum"].isel(record=3), STRENGTHS[3] * BASE)


def test_without_bodies_the_spectrum_stands_alone():
    tree = site_of(STRENGTHS, blocks=None)
    assert tree["site"].sizes["block"] == 0
    np.testing.assert_allclose(tree["spectra"]["spectrum_design"], 1.3 * BASE, rtol=1e-12)


def test_the_file_holds_what_is_declared_and_nothing_else():
    tree = usual_site()
    for group in ("site", "spectra"):
        declared = SITE_GROUPS[f"/{group}, by the spectrum"]
        stored = tree[group].to_dataset(inherit=False).variables
        assert set(stored) == set(declared), group
        for name, one in stored.items():
            assert one.dims == declared[name].dims, name
            assert one.attrs["units"] == declared[name].units


def test_the_stored_design_is_the_one_that_bodies_are_assessed_under(tmp_path):
    rp.save(usual_site(), tmp_path / "site.h5")
    design = rp.load_design(tmp_path / "site.h5")
    np.testing.assert_allclose(design.effective_impulse(WALL), 1.3 * base_at(WALL), rtol=1e-12)
    rp.save(site_of(STRENGTHS[:3]), tmp_path / "few.h5")
    with pytest.raises(ResultsError, match=r"few.h5: no design: not enough earthquakes \(3; at least 7"):
        rp.load_design(tmp_path / "few.h5")
