"""Lines that an engineer types by instinct, without the manual: they work, or the error says what to type."""

import pytest

import rockpulse as rp


@pytest.mark.sweep
def test_a_folder_and_sizes_are_enough_for_an_assessment(golden):
    tree = rp.assess(str(golden.records), bodies={"stele": (0.3, 2.4)})
    assert tree["summary"].sizes["record"] == 5
    assert tree["summary"]["width"].values.tolist() == [0.3]


@pytest.mark.sweep
def test_a_file_and_a_record_are_records(golden):
    path = sorted(golden.records.iterdir())[0]
    bodies = {"stele": rp.Block(0.3, 2.4)}
    by_path, by_record = rp.assess(path, bodies=bodies), rp.assess(rp.read(path)[0], bodies=bodies)
    assert by_path["summary"]["pga"].item() == by_record["summary"]["pga"].item()


@pytest.mark.sweep
def test_the_studies_take_paths_and_the_path_of_a_configuration(golden):
    config = golden.config
    site = rp.calibrate(golden.records, config=config)
    assert site["site"].sizes["block"] == 2
    curves = rp.fragility(golden.records, config=config)
    assert curves["fragility"].sizes["block"] == 2
    assert rp.check(rp.load_config(config)).sizes["block"] == 2


@pytest.mark.sweep
def test_risk_takes_the_file_of_a_fragility(golden):
    law = rp.PowerLawHazard(k0=1e-4, k=2.5)
    by_path, by_tree = rp.risk(golden.fragility, law, resamples=0), rp.risk(rp.load(golden.fragility), law, resamples=0)
    assert by_path["frequency"].equals(by_tree["frequency"])


@pytest.mark.sweep
def test_a_report_and_a_picture_take_the_file_of_results(golden, tmp_path):
    assert rp.report(golden.results, tmp_path / "report.html").stat().st_size > 0
    assert rp.plot(rp.load(golden.results)) is not None


def test_a_record_has_its_own_sequence(ccc):
    record = ccc[0]
    sequence = rp.record_sequence(rp.half_waves(record), phase=rp.intense_phase(record))
    assert sequence.main > sequence.secondary > 0.0


@pytest.mark.parametrize(
    ("typed", "meant"),
    [("Assess", "assess"), ("overturning_spectra", "overturning_spectrum"), ("calibrat", "calibrate")],
)
def test_a_misspelt_name_is_answered_with_the_nearest_one(typed, meant):
    with pytest.raises(AttributeError, match=f"did you mean '{meant}'"):
        getattr(rp, typed)
