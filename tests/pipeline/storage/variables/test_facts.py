"""Facts of earthquake and site in results files: stored as the record has them, unknown in files of before."""

from dataclasses import fields, replace
from datetime import UTC, datetime

import h5py
import numpy as np
import pytest
import xarray as xr
from nominal import Config

import rockpulse as rp
from rockpulse.models import Block
from rockpulse.record.record import Record
from rockpulse.storage.hdf5.results_file import load, open_results, save
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.storage.variables.summary import FACTS, facts_of

TIME = 0.01 * np.arange(400)
KNOWN = {
    "event_id": "us6000jllz",
    "origin_time": datetime(2023, 2, 6, 1, 17, 34, tzinfo=UTC),
    "magnitude": 7.7,
    "magnitude_type": "Mw",
    "hypocentre_latitude": 37.288,
    "hypocentre_longitude": 37.043,
    "hypocentre_depth": 8600.0,
    "epicentral_distance": 61000.0,
    "station_latitude": 37.76,
    "station_longitude": 38.26,
    "vs30": 391.0,
    "site_class": "B",
    "sensor_depth": 2.5,
}
STORED = KNOWN | {"origin_time": "2023-02-06T01:17:34+00:00"}


def _record(name, size, **known):
    return Record(size * np.sin(6.0 * TIME), dt=0.01, id=name, event=name, processed=True, **known)


@pytest.fixture(scope="module")
def assessed():
    records = [_record("known", 2.0, **KNOWN), _record("unknown", 1.0)]
    return rp.assess(records, Config(), {"wall": Block(0.15, 1.5)})


def test_every_fact_is_a_field_of_a_record():
    plain = _record("x", 1.0)
    assert set(KNOWN) == set(FACTS) <= {field.name for field in fields(Record)}
    assert facts_of(type("Of", (), {"record": replace(plain, **KNOWN)})) == STORED


def test_an_assessment_stores_the_facts_of_each_record(assessed, tmp_path):
    save(assessed, tmp_path / "results.h5")
    summary = load(tmp_path / "results.h5")["summary"].to_dataset()
    assert {name: summary[name].sel(record="known").item() for name in FACTS} == STORED
    for name, fact in FACTS.items():
        np.testing.assert_equal(summary[name].sel(record="unknown").item(), fact.absent)
        assert summary[name].attrs["units"] == fact.units
    assert summary["hypocentre_latitude"].attrs["units"] == "degrees_north"
    assert summary["station_longitude"].attrs["units"] == "degrees_east"


def test_in_a_file_of_before_the_facts_are_unknown(assessed, tmp_path):
    before = assessed.copy()
    before["summary"] = xr.DataTree(assessed["summary"].to_dataset().drop_vars(list(FACTS)))
    path = tmp_path / "before.h5"
    save(before, path)
    with h5py.File(path, "a") as file:
        file.attrs["schema_version"] = "1.1"
    with open_results(path) as file:
        for summary in (load(path)["summary"].to_dataset(), file.dataset("summary").load()):
            assert np.isnan(summary["magnitude"].values).all()
            assert summary["magnitude"].dims == ("record",)
            assert summary["site_class"].values.tolist() == ["", ""]


@pytest.mark.parametrize(
    ("kind", "group"), [(SITE_KIND, "site"), ("fragility", "capacities")], ids=["site calibration", "fragility"]
)
def test_in_other_files_of_before_too(kind, group, tmp_path):
    def made(schema):
        names = {"record": ("record", ["a", "b"], {"units": "1", "long_name": "record id"})}
        groups = {"/": xr.Dataset(attrs={"kind": kind}), f"/{group}": xr.Dataset(coords=names)}
        path = tmp_path / f"{schema}.h5"
        save(xr.DataTree.from_dict({"/fragility": xr.Dataset(), **groups}), path)
        with h5py.File(path, "a") as file:
            file.attrs["schema_version"] = schema
        with open_results(path) as file:
            return load(path)[group].to_dataset(), file.dataset(group).load()

    for found in made("1.1"):
        assert np.isnan(found["vs30"].values).tolist() == [True, True]
    for found in made("1.2"):  # lacks what it should have: nothing is made up
        assert "vs30" not in found
