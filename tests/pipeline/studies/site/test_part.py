"""Records of a site as bytes and back."""

import math
import pickle
from dataclasses import fields, replace
from datetime import UTC, datetime

import numpy as np
import pytest

from rocking.sequence import ImpulseSequence
from rockpulse.record.record import Record
from rockpulse.remark import Remark, code_of
from rockpulse.studies.site.part import pack_site_record, unpack_site_record
from rockpulse.studies.site.record import SiteRecord


def one(**changes):
    record = Record(
        np.sin(np.arange(50.0)),
        0.005,
        "IT.NRC..HNE@20161030T064000",
        network="IT",
        station="NRC",
        start_time=datetime(2016, 10, 30, 6, 40, 0, 123457, tzinfo=UTC),
        station_name='Nòrcia "<b>',
        orientation="horizontal",
        azimuth=np.float64(90.0),
        processed=np.bool_(True),
        warnings=("scaled by 5", Remark("baseline_drift", velocity=1.0 / 3.0, pgv=0.5)),
        processing=("mean removed",),
    )
    sequence = ImpulseSequence(np.float64(0.1) + 0.2, 0.1 / 3.0, 1.0 / 7.0, math.inf, main_count=np.int64(7))
    site = SiteRecord(
        record=record,
        channel="IT.NRC..HNE@20161030T064000",
        factor=1.0 / 3.0,
        pga=np.float64(3.1),
        pgv=np.pi,
        impulse=5e-324,
        sequence=sequence,
        intervals={"main": (np.float64(0.2), 0.4), "interval": (math.nan, math.inf)},
        peaks=np.array([0.0, 0.1, np.inf, np.nan]),
        misfit=math.nan,
        unsafe_share=0.25,
        remarks=("few blocks rock",),
    )
    return replace(site, **changes)


def same(first, second):
    if isinstance(first, np.ndarray):
        return np.array_equal(first, second, equal_nan=True)
    if isinstance(first, float):
        return first == second or (math.isnan(first) and math.isnan(second))
    if isinstance(first, dict):
        return list(first) == list(second) and all(same(first[name], second[name]) for name in first)
    if isinstance(first, tuple):
        return len(first) == len(second) and all(same(a, b) for a, b in zip(first, second, strict=True))
    if isinstance(first, Record | ImpulseSequence | SiteRecord):
        return type(first) is type(second) and all(
            same(getattr(first, field.name), getattr(second, field.name)) for field in fields(first)
        )
    return first == second


def test_the_remarks_on_the_record_keep_their_codes():
    back = unpack_site_record(pack_site_record(one()))
    assert [code_of(text) for text in back.record.warnings] == ["plain", "baseline_drift"]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"sequence": ImpulseSequence(0.4, 0.1, 0.3, 12.5)},
        {"sequence": ImpulseSequence(0.4, 0.1, np.nan, 12.5, intermediate_count=4, spacing="start"), "intervals": {}},
        {"peaks": np.zeros(0), "remarks": ()},
    ],
    ids=["all", "no count", "spacing", "empty"],
)
def test_every_field_comes_back_to_the_last_bit_and_no_samples(changes):
    site = one(**changes)
    packed = pack_site_record(site)
    back = unpack_site_record(packed)
    assert same(back, replace(site, record=site.record.without_samples()))
    assert back.record.start_time == site.record.start_time
    assert pack_site_record(back) == packed


def test_samples_add_nothing():
    record = replace(one().record, acceleration=np.ones(100_000))
    assert len(pack_site_record(one(record=record))) < 3000


@pytest.mark.parametrize("packed", [b"", b"RPA1{}", pickle.dumps(one().remarks)], ids=["nothing", "arrays", "pickle"])
def test_other_bytes_are_refused(packed):
    with pytest.raises(ValueError, match="expected a packed record of a site"):
        unpack_site_record(packed)
