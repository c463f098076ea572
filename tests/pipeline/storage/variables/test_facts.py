"""Facts of earthquake and site in results files: stored as the record has them, unknown where it has none."""

from dataclasses import fields, replace
from datetime import UTC, datetime

import numpy as np
import pytest
from nominal import Config

import rockpulse as rp
from rockpulse.models import Block
from rockpulse.record.record import Record
from rockpulse.storage.hdf5.results_file import load_tree, save
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
    return rp.assess(records, Config(models=rp.ModelSettings(use=("resonance",))), {"wall": Block(0.3, 3.0)})


def test_every_fact_is_a_field_of_a_record():
    plain = _record("x", 1.0)
    assert set(KNOWN) == set(FACTS) <= {field.name for field in fields(Record)}
    assert facts_of(type("Of", (), {"record": replace(plain, **KNOWN)})) == STORED


@pytest.mark.sweep
def test_an_assessment_stores_the_facts_of_each_record(assessed, tmp_path):
    save(assessed, tmp_path / "results.h5")
    summary = load_tree(tmp_path / "results.h5")["summary"].to_dataset()
    assert {name: summary[name].sel(record="known").item() for name in FACTS} == STORED
    for name, fact in FACTS.items():
        np.testing.assert_equal(summary[name].sel(record="unknown").item(), fact.absent)
        assert summary[name].attrs["units"] == fact.units
    assert summary["hypocentre_latitude"].attrs["units"] == "degrees_north"
    assert summary["station_longitude"].attrs["units"] == "degrees_east"
