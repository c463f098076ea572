"""The overturning spectrum of one motion of a site."""

import numpy as np
import pytest

import rockpulse as rp
from rocking.spectrum_lanes import RATES
from rockpulse import CalibrationSettings
from rockpulse.assessment.overturning import LANES
from rockpulse.config.settings import SPECTRA
from rockpulse.models import Block
from rockpulse.storage.variables.probability import RESTITUTIONS

TIME = 0.01 * np.arange(400)
MOTION = 4.0 * np.sin(2.0 * np.pi * 1.2 * TIME) * np.exp(-(((TIME - 2.0) / 0.8) ** 2))


def record(size=1.0, number=0):
    return rp.Record(size * MOTION, dt=0.01, id=f"burst{number}", event=f"Earthquake {number}", processed=True)


def spectra(word, *records, **calibration):
    config = rp.Config(calibration=CalibrationSettings(spectrum=word, bootstrap=100, **calibration))
    return rp.calibrate_site(records, config)["spectra"]


def test_every_word_of_the_configuration_has_a_spectrum():
    assert set(LANES) == set(SPECTRA)


@pytest.fixture(scope="module")
def by_rule():
    return spectra("rule", record(), record(2.0, 1))


def test_the_rule_overturns_where_its_demand_does(by_rule):
    found = by_rule["spectrum"].sel(record="burst0").values
    p, c = (values.ravel() for values in np.meshgrid(RATES[[4, 8, 12]], RESTITUTIONS[[1, 4]], indexing="ij"))
    own = found[[4, 8, 12]][:, [1, 4]].ravel()
    # At higher p uplift decides: there the spectrum folds the uncertainty in, and the demand ends at PGA.
    waves = rp.half_waves(record())
    for slenderness in (4.0, 12.0):  # S is one for bodies of any slenderness
        blocks = Block.from_parameters(p=p, alpha=np.arctan(1.0 / slenderness), restitution=c, log=False)
        speed = blocks.gravity * np.tan(blocks.alpha_c) / p
        np.testing.assert_allclose(rp.load_rule().demand(waves, blocks), own / speed, rtol=1e-6)


def test_the_spectrum_is_proportional_to_the_record(by_rule):
    # But for the fixed levels of x on which the probability is known.
    np.testing.assert_allclose(by_rule["spectrum"][1], 2.0 * by_rule["spectrum"][0], rtol=1e-4)
    assert (by_rule["record_main_count"][1] == by_rule["record_main_count"][0]).all()
    np.testing.assert_allclose(by_rule["record_ratio"][1], by_rule["record_ratio"][0])


def test_the_site_reads_the_spectrum_that_python_gives(by_rule):
    own = rp.overturning_spectrum(record(), restitution=RESTITUTIONS, method="rule")["spectrum"]
    np.testing.assert_allclose(by_rule["spectrum"][0], own, rtol=1e-12)


def test_number_and_ratio_are_those_of_the_rule(by_rule):
    block = Block.from_parameters(p=RATES[[6, 18]], alpha=0.1, restitution=0.9, log=False)
    sequence = rp.load_rule().sequence(rp.half_waves(record()), block)
    assert by_rule["record_main_count"].values[0, [6, 18]].tolist() == sequence.main_count.tolist()
    np.testing.assert_allclose(by_rule["record_ratio"].values[0, [6, 18]], sequence.secondary / sequence.main)


@pytest.mark.sweep
def test_the_nonlinear_spectrum_is_that_of_the_record_scaled_to_the_target():
    found = spectra("nonlinear", record(), scale_to="pga", target=2.0 * record().pga)["spectrum"]
    own = rp.overturning_spectrum(record(2.0))["spectrum"]
    np.testing.assert_allclose(found[0], own, rtol=1e-6)


def test_a_record_of_zeros_is_left_out_with_its_reason():
    still = rp.Record(np.zeros(400), dt=0.01, id="still", event="Earthquake Z", processed=True)
    tree = rp.calibrate_site([record(), still], rp.Config(calibration=CalibrationSettings(bootstrap=100)))
    assert tree["site"]["record"].values.tolist() == ["burst0"]
    assert "still" in str(tree["failures"]["reason"].values)
