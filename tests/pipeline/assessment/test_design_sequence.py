"""Bodies under a sequence in place of a record."""

import dataclasses

import numpy as np
import pytest
from site_spectra import BLOCKS as SPECTRUM_BLOCKS
from site_spectra import usual_site

import rockpulse as rp
from rockpulse import ModelSettings
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError
from rockpulse.model_table import ALL_MODELS
from rockpulse.models import Block, ImpulseSequence, resonance, resonance_critical_scale, sequence_response
from rockpulse.studies.site.calibration import design_of

SEQUENCE = ImpulseSequence(main=0.35, secondary=0.12, interval=0.15, duration=12.0, main_count=4)
BLOCKS = {"wall": Block(0.3, 3.0), "pier": Block(0.8, 3.6), "column": Block(1.0, 8.0)}
LANES = Block.stack([block.lanes(1) for block in BLOCKS.values()])


EVERY = Config(models=ModelSettings(use=ALL_MODELS))


@pytest.fixture(scope="module")
def tree():
    return rp.assess_sequence(SEQUENCE, EVERY, BLOCKS, name="design sequence 0.84", source="site.h5")


def test_the_answers_are_those_of_the_models(tree):
    summary = tree["summary"].to_dataset().isel(record=0)
    for model, response in {
        "resonance": resonance(LANES, 0.35, 4, duration=12.0),
        "sequence": sequence_response(LANES, SEQUENCE),
    }.items():
        of = summary.sel(model=model)
        for name in ("peak_rotation_ratio", "outcome", "overturning_half_cycle", "impacts"):
            np.testing.assert_array_equal(of[name], getattr(response, name), err_msg=f"{model} {name}")
    np.testing.assert_allclose(summary["impulse_ratio"], 0.35 / LANES.critical_impulse)


def test_safety_factors_are_on_the_sequence(tree):
    summary = tree["summary"].to_dataset().isel(record=0)
    resonant = resonance_critical_scale(LANES, SEQUENCE).safety_factor
    np.testing.assert_allclose(summary["safety_factor"].sel(model="resonance"), resonant, rtol=1e-9)
    factors = summary["safety_factor"].sel(model="sequence").values
    for block, factor in zip(BLOCKS.values(), factors, strict=True):
        assert sequence_response(block, SEQUENCE.scaled(factor)).outcome == 2
        assert sequence_response(block, SEQUENCE.scaled((1.0 - 3e-6) * factor)).outcome != 2


def test_what_describes_a_record_is_absent(tree):
    summary = tree["summary"].to_dataset().isel(record=0)
    assert summary["record"].item() == "design sequence 0.84"
    assert summary["source"].item() == "site.h5"
    for name in ("pga", "pgv", "arias_intensity", "intense_start", "dt", "azimuth", "uplift_ratio", "velocity_ratio"):
        assert np.isnan(summary[name]).all(), name
    assert np.isnan(summary["capacity_pga"]).all()
    assert np.isnan(summary["factor_10"]).all()
    assert set(summary["probability_source"].values.tolist()) == {0}
    assert (summary["npts"].item(), summary["half_wave_count"].item()) == (-1, -1)
    assert summary["station"].item() == summary["start_time"].item() == ""
    names = ["main_impulse", "secondary_impulse", "secondary_interval", "sequence_duration", "main_count"]
    assert [summary[name].item() for name in names] == [0.35, 0.12, 0.15, 12.0, 4]
    assert "records" not in tree.children


def test_models_that_need_a_record_are_left_out_in_words(tree):
    assert tree["summary"]["model"].values.tolist() == ["resonance", "sequence"]
    warnings = str(tree["summary"]["warnings"].values[0])
    assert "because they need a record and the input is" in warnings
    assert all(model in warnings for model in ("impulsive", "linear", "nonlinear"))
    quiet = rp.assess_sequence(SEQUENCE, Config(models=ModelSettings(use=["sequence"])), BLOCKS)
    assert quiet["summary"]["warnings"].values.tolist() == [""]
    assert quiet.attrs["title"] == "Rocking response of rigid blocks to a sequence of impulses"
    config = Config(models=ModelSettings(use=["sequence", "linear"]), site=rp.SiteSettings(name="Borgo"))
    one = rp.assess_sequence(SEQUENCE, config, BLOCKS)
    assert one["summary"]["warnings"].values.tolist() == [
        "models left out, because they need a record and the input is a sequence: linear"
    ]
    assert one.attrs["title"] == "Borgo"


@pytest.mark.parametrize(("share", "touching"), [(0.3, 0), (0.9, 3)])
def test_bodies_that_march_through_the_ground_are_counted_in_a_warning(share, touching):
    through = dataclasses.replace(SEQUENCE, spacing="start", secondary=share * SEQUENCE.main)
    assert np.count_nonzero(sequence_response(LANES, through).ground_contact) == touching
    summary = rp.assess_sequence(through, Config(models=ModelSettings(use=["sequence"])), BLOCKS)["summary"]
    (warnings,) = summary["warnings"].values.tolist()
    assert (f"{touching} of 3 bodies" in warnings) is (touching > 0)
    assert (warnings == "") is (touching == 0)


def test_a_configuration_without_a_sequence_model_is_refused():
    with pytest.raises(ConfigError, match="nonlinear cannot be used with a sequence; use resonance or seq"):
        rp.assess_sequence(SEQUENCE, Config(models=ModelSettings(use=["nonlinear"])), BLOCKS)


def test_several_sequences_and_no_body_are_refused():
    with pytest.raises(ConfigError, match="expected one sequence, found 2"):
        rp.assess_sequence(SEQUENCE.scaled([1.0, 2.0]), bodies=BLOCKS)
    with pytest.raises(ConfigError, match="no body to assess"):
        rp.assess_sequence(SEQUENCE)


def test_a_sequence_without_limits_is_told_as_such():
    endless = dataclasses.replace(SEQUENCE, main=0.01, secondary=0.0, main_count=None, duration=np.inf)
    with pytest.raises(ConfigError, match="needs main_count or duration"):
        rp.assess_sequence(endless, EVERY, BLOCKS)
    summary = rp.assess_sequence(endless, Config(models=ModelSettings(use=["sequence"])), BLOCKS)["summary"]
    assert summary["main_count"].values.tolist() == [-1]
    assert summary["sequence_duration"].values.tolist() == [np.inf]


@pytest.mark.sweep
def test_under_a_design_spectrum_every_body_has_its_own_sequence():
    design = design_of(usual_site())
    bodies = {name: SPECTRUM_BLOCKS[name] for name in ("wall", "pier")}
    lanes = Block.stack([block.lanes(1) for block in bodies.values()])
    tree = rp.assess_sequence(design, EVERY, bodies, name="design", source="site.h5")
    summary = tree["summary"].to_dataset().isel(record=0)
    assert summary["model"].values.tolist() == ["sequence"]
    found = summary["safety_factor"].sel(model="sequence").values
    np.testing.assert_allclose(found, design.factor(lanes), rtol=0.005)
    site = usual_site()["site"].to_dataset().sel(block=["wall", "pier"])
    np.testing.assert_allclose(found, site["design_factor"], rtol=0.005)
    # The verdicts and rotations are those of the calibration's own table.
    assert (summary["outcome"].sel(model="sequence") == np.where(site["design_factor"] <= 1.0, 2, 1)).all()
    np.testing.assert_array_equal(summary["peak_rotation_ratio"].sel(model="sequence"), site["rotation_ratio"])
    assert np.isnan(summary["main_impulse"].item())
    words = "the input is a design spectrum: resonance, impulsive, linear, nonlinear"
    assert words in summary["warnings"].item()


def test_a_body_outside_the_design_spectrum_is_refused_by_name():
    (name,) = list(SPECTRUM_BLOCKS)[2:]
    with pytest.raises(ConfigError, match=rf"^\[\[block\]\] {name}: outside the spectrum's range; remove them"):
        rp.assess_sequence(design_of(usual_site()), bodies=SPECTRUM_BLOCKS)
    with pytest.raises(ConfigError, match=r"slenderness 3.5 or more, .* not 1 of 3 blocks, the first at index 2"):
        rp.assess_sequence(design_of(usual_site()), bodies=SPECTRUM_BLOCKS)
    with pytest.raises(ConfigError, match="resonance cannot be used with a design spectrum; use sequence"):
        rp.assess_sequence(design_of(usual_site()), Config(models=ModelSettings(use=["resonance"])), BLOCKS)
