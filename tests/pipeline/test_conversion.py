"""Where converted records go, and what is never touched."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from record_writers import pulse

import rockpulse as rp
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.record import Record

EAST = Record(pulse(300, 2.0), 0.01, "CI.CLC..90", "CI", "CLC", channel="90", orientation="horizontal", azimuth=90.0)
UP = replace(EAST, id="CI.CLC..Up", channel="Up", orientation="vertical", azimuth=float("nan"))


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_one_record_goes_where_it_was_told(tmp_path):
    (written,) = rp.write([EAST], tmp_path / "out.AT2")
    assert (written.path, written.records) == (tmp_path / "out.AT2", (("CI.CLC..90", ""),))
    assert names(tmp_path) == ["out.AT2"]


def test_several_records_have_their_channels_in_the_names(tmp_path):
    rp.write([EAST, UP], tmp_path / "out.csv")
    assert names(tmp_path) == ["out.90.csv", "out.Up.csv"]


def test_records_of_several_stations_have_their_ids_in_the_names(tmp_path):
    rp.write([EAST, replace(EAST, id=".X..90")], tmp_path / "out.csv")
    assert names(tmp_path) == ["out.CI.CLC..90.csv", "out.X..90.csv"]


def test_a_folder_is_filled_with_the_ids(tmp_path):
    rp.write([EAST, replace(EAST, id=".X..90")], tmp_path / "new", format="at2")
    assert names(tmp_path / "new") == ["CI.CLC..90.AT2", "X..90.AT2"]
    rp.write([UP], tmp_path / "new", format="csv")
    assert "CI.CLC..Up.csv" in names(tmp_path / "new")


def test_miniseed_holds_all_and_has_a_station_file(tmp_path):
    (written,) = rp.write([UP, EAST], tmp_path / "out.mseed")
    assert written.records == (("CI.CLC..Up", "CI.CLC..HNZ"), ("CI.CLC..90", "CI.CLC..HNE"))
    assert names(tmp_path) == ["out.mseed", "out.xml"]
    back = {record.channel: record for record in rp.read(tmp_path / "out.mseed")}
    assert back["HNE"].azimuth == 90.0
    assert back["HNZ"].orientation == "vertical"
    assert back["HNE"].start_time is None


@pytest.mark.parametrize(
    ("out", "format", "message"),
    [
        ("out", None, "expected a format, one of at2, csv, mseed, found 'none'"),
        ("out.dat", None, r"found '\.dat'"),
        ("out.dat", "xls", "found 'xls'"),
        ("out.txt", "csv", r"a file of the format csv ends in \.csv, found '\.txt'"),
        ("out.csv", "at2", "the name says csv, the format at2"),
        ("new", "mseed", "miniSEED holds all records in one file; name it, such as"),
        ("missing/new/out.csv", None, "there is no folder"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused(tmp_path, out, format, message):
    if not message.startswith("there"):
        tmp_path.joinpath("missing").mkdir()
    with pytest.raises(ConfigError, match=message):
        rp.write([EAST], tmp_path / out, format)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_no_record_is_an_error(tmp_path):
    with pytest.raises(ConfigError, match="no record to write"):
        rp.write([], tmp_path / "out.csv")


def test_a_file_that_exists_is_replaced_only_where_that_is_allowed(tmp_path):
    rp.write([EAST], tmp_path / "out.AT2")
    before = (tmp_path / "out.AT2").read_bytes()
    with pytest.raises(ConfigError, match=r"out\.AT2: the file exists"):
        rp.write([UP], tmp_path / "out.AT2")
    assert (tmp_path / "out.AT2").read_bytes() == before
    rp.write([UP], tmp_path / "out.AT2", overwrite=True)
    assert (tmp_path / "out.AT2").read_bytes() != before
    (tmp_path / "out.csv").mkdir()
    with pytest.raises(ConfigError, match="expected a format"):
        rp.write([UP], tmp_path / "out.csv", overwrite=True)


def test_the_file_a_record_came_from_is_never_replaced(tmp_path):
    rp.write([EAST], tmp_path / "in.AT2")
    (record,) = rp.read(tmp_path / "in.AT2")
    (tmp_path / "link.AT2").symlink_to("in.AT2")
    for name in ("in.AT2", "link.AT2"):
        with pytest.raises(ConfigError, match="a record comes from this file"):
            rp.write([record], tmp_path / name, overwrite=True)


def test_a_station_file_of_others_is_never_replaced(tmp_path):
    (tmp_path / "out.xml").write_text("<FDSNStationXML/>")
    with pytest.raises(ConfigError, match=r"out\.xml: a StationXML that rockpulse did not write is never replaced"):
        rp.write([EAST], tmp_path / "out.mseed", overwrite=True)
    (tmp_path / "out.xml").unlink()
    rp.write([EAST], tmp_path / "out.mseed")
    rp.write([EAST], tmp_path / "out.mseed", overwrite=True)


def test_a_second_gain_in_the_folder_is_found_before_anything_is_kept(tmp_path):
    start = rp.from_trace(rp.to_trace(EAST)).start_time
    assert start is None
    rp.write([EAST], tmp_path / "first.mseed")
    text = (tmp_path / "first.xml").read_text().replace("<Value>1.0<", "<Value>2.0<")
    (tmp_path / "first.xml").write_text(text)
    with pytest.raises(RecordRefused, match=r"would not be read again .*2 different sensitivities.* another folder"):
        rp.write([EAST], tmp_path / "out.mseed")
    assert names(tmp_path) == ["first.mseed", "first.xml"]


def test_an_interval_that_the_format_cannot_hold_is_refused_and_nothing_stays(tmp_path, monkeypatch):
    monkeypatch.setattr("rockpulse.conversion._STEP_TOLERANCE", -1.0)
    with pytest.raises(RecordRefused, match=r"the interval of CI\.CLC\.\.90, 0\.01 s, comes back as 0\.01 s"):
        rp.write([EAST], tmp_path / "new", format="csv")
    assert names(tmp_path) == []


def test_samples_that_do_not_come_back_are_refused_and_nothing_stays(tmp_path, monkeypatch):
    from rockpulse import conversion

    wrong = replace(conversion.WRITERS["csv"], one=lambda record: conversion.csv_bytes(UP_HALF))
    monkeypatch.setitem(conversion.WRITERS, "csv", wrong)
    with pytest.raises(RecordRefused, match=r"the samples of CI\.CLC\.\.90 do not come back as written"):
        rp.write([EAST], tmp_path / "out.csv")
    assert names(tmp_path) == []


UP_HALF = replace(UP, acceleration=0.5 * UP.acceleration)


def test_ids_that_one_folder_cannot_hold_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="expected records of different ids"):
        rp.write([EAST, replace(UP, id="ci.clc..90")], tmp_path, format="csv")


def test_the_samples_are_written_as_they_are(tmp_path):
    rp.write([EAST], tmp_path / "out.csv")
    table = np.loadtxt(tmp_path / "out.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table[:, 1], EAST.acceleration)
    assert table[:, 0] == pytest.approx(EAST.time, abs=1e-12)
