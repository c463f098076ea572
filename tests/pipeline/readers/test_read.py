"""What all readers share: recognition, encodings, import weight, the errors (damage: test_fuzz.py)."""

import io
import pickle

import header_facts
import numpy as np
import pytest
from header_facts import HeaderFact, facts

from rockpulse.errors import RecordRefused
from rockpulse.readers import FORMATS, read
from rockpulse.readers.source import NotAcceleration, Unrecognised


def test_every_format_has_a_row_with_a_name_of_its_own():
    assert len({row.name for row in FORMATS}) == len(FORMATS)
    assert all(row.what and row.recognised and row.unit and row.processed for row in FORMATS)
    assert FORMATS[-1].name == "columns"  # the least specific comes last


def test_the_largest_sample_is_parsed_in_a_fraction_of_a_second(samples):
    import time

    began = time.process_time()
    records = read(samples / "CITOW2.RAW")
    assert sum(record.npts for record in records) == 106812
    # 0.02 s when measured; a float() per sample takes several times this bound's share.
    assert time.process_time() - began < 0.5


@pytest.mark.parametrize("error", [Unrecognised, NotAcceleration])
def test_the_readers_own_errors_survive_pickling(error):
    copy = pickle.loads(pickle.dumps(error("file.AT2:3: reason")))
    assert type(copy) is error
    assert str(copy) == "file.AT2:3: reason"


def test_station_metadata_may_be_given_with_a_file_in_memory(samples):
    formats = samples.parent / "formats"
    content, metadata = ((formats / f"CI.CLC.{suffix}").read_bytes() for suffix in ("mseed", "xml"))
    by_path = read(formats / "CI.CLC.mseed")
    for given in (io.BytesIO(metadata), formats / "CI.CLC.xml", str(formats / "CI.CLC.xml")):
        records = read(io.BytesIO(content), stationxml=given)
        assert [record.id for record in records] == [record.id for record in by_path]
        assert all(
            np.array_equal(one.acceleration, two.acceleration) for one, two in zip(records, by_path, strict=True)
        )
    with pytest.raises(RecordRefused, match="counts"):
        read(io.BytesIO(content))


FACTS = list(facts())


@pytest.mark.sweep
def test_every_format_that_is_read_has_facts():
    assert {fact.format for fact in FACTS} == {row.name for row in FORMATS if row.unit != "-"}


@pytest.mark.sweep
def test_a_fact_that_differs_from_its_partner_is_told():
    wrong = [
        f"{fact.what} of {fact.sample}: {told}" for fact in FACTS if (told := fact.told()) == "silent" and fact.partner
    ]
    assert wrong == [], "changed without its partner, and nobody tells"
    named = [f"{fact.what} of {fact.sample}" for fact in FACTS if not fact.partner and fact.told() != "silent"]
    assert named == [], "told: name its partner"


@pytest.mark.sweep
def test_a_reader_that_says_nothing_is_seen(monkeypatch, capsys):
    silent = HeaderFact("CLC090.AT2", "interval", rb"(?<=DT= )0\.0100", b"0.0200", "a partner that nobody asks")
    monkeypatch.setattr(header_facts, "facts", lambda: iter([silent, next(facts())]))
    assert header_facts.main() == 1
    assert "2 facts with a partner: 1 told by a warning, 0 by a refusal, 1 silent; 0 facts" in capsys.readouterr().out
