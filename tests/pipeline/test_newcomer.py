"""Lines that an engineer types by instinct, without the manual: they work, or the error says what to type."""

import pytest

import rockpulse as rp


@pytest.mark.sweep
def test_records_are_a_folder_a_file_or_a_record_and_sizes_are_full(golden, ccc):
    tree = rp.assess(str(golden.records), bodies={"stele": (0.3, 2.4)})
    assert tree["summary"].sizes["record"] == 5
    assert tree["summary"]["width"].values.tolist() == [0.3]
    path = sorted(golden.records.iterdir())[0]
    bodies = {"stele": rp.Block(0.3, 2.4)}
    by_path, by_record = rp.assess(path, bodies=bodies), rp.assess(rp.read(path)[0], bodies=bodies)
    assert by_path["summary"]["pga"].item() == by_record["summary"]["pga"].item()
    tree = rp.assess(ccc[0], bodies=rp.Block(0.5, 3.0))
    assert (tree["summary"]["width"].item(), tree["summary"]["height"].item()) == (0.5, 3.0)


@pytest.mark.sweep
def test_studies_take_paths_of_records_configurations_results_and_hazards(golden, tmp_path, monkeypatch):
    assert rp.calibrate(golden.records, config=golden.config)["site"].sizes["block"] == 2
    assert rp.fragility(golden.records, config=golden.config)["fragility"].sizes["block"] == 2
    assert rp.check(config=golden.config).sizes["block"] == 2
    assert rp.check(golden.results, code="en_1998")["probability"].notnull().all()
    curve = tmp_path / "hazard.csv"
    curve.write_text("pga [g],rate\n0.05,0.05\n0.2,0.005\n1.0,0.00005\n")
    by_path = rp.risk(golden.fragility, curve, resamples=0, years=100)
    by_tree = rp.risk(rp.load(golden.fragility), rp.load_hazard(curve), resamples=0)
    assert by_path["frequency"].equals(by_tree["frequency"])
    assert rp.risk(golden.fragility, resamples=0).attrs["hazard"].startswith("power law")  # [hazard] of the fragility
    assert rp.plot(rp.load(golden.results)) is not None
    assert rp.plot(golden.results, "critical-scale", block="pier", model="nonlinear") is not None
    monkeypatch.chdir(tmp_path)
    assert rp.report(golden.results, config=golden.config).name == "report.html"


@pytest.mark.parametrize(("typed", "meant"), [("Assess", "assess"), ("overturning_spectra", "overturning_spectrum")])
def test_a_misspelt_name_is_answered_with_the_nearest_one(typed, meant):
    with pytest.raises(AttributeError, match=f"did you mean '{meant}'"):
        getattr(rp, typed)


@pytest.mark.sweep
def test_a_folder_is_read_whole(golden, tmp_path):
    records = rp.read(golden.records)
    assert [record.id for record in records] == [record.id for record in rp.read_all(golden.records)[0]]
    with pytest.raises(rp.RecordRefused, match="no record in the folder"):
        rp.read(tmp_path)


@pytest.mark.sweep
def test_two_results_are_compared_by_path_or_in_memory(golden, ccc):
    assert rp.diff(golden.results, rp.load(golden.results)).same
    before, after = (rp.assess(ccc[0], bodies={"wall": (width, 3.0)}) for width in (0.3, 0.6))
    changes = rp.diff(before, after)
    assert not changes.same
    assert "The results differ" in str(changes)


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (lambda: rp.DemandSettings("SLV", measure="PGA", value=3.0), "pga"),
        (lambda: rp.HazardSettings(k0=1e-4, k=2.0, measure="SI"), "si"),
        (lambda: rp.FragilitySettings(measures=["PGV"]), "pgv"),
        (lambda: rp.PowerLawHazard(1e-4, 2.0, "Sa_1"), "sa_1"),
        (lambda: rp.CalibrationSettings(scale_to="PGV"), "pgv"),
    ],
)
def test_a_measure_in_capitals_or_misspelt_is_offered_the_right_one(typed, meant):
    with pytest.raises(rp.ConfigError, match=f'did you mean "{meant}"'):
        typed()


def test_a_configuration_in_the_place_of_results_is_told():
    with pytest.raises(rp.ConfigError, match="give it as config="):
        rp.check(rp.Config())
