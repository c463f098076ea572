"""Where converted records go, and what is never touched."""

import errno
import gzip
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from record_writers import pulse
from source_files import raises_if

import rockpulse as rp
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.readers.conversion import check_output
from rockpulse.record.record import Record

EAST = Record(pulse(300, 2.0), 0.01, "CI.CLC..90", "CI", "CLC", channel="90", orientation="horizontal", azimuth=90.0)
UP = replace(EAST, id="CI.CLC..Up", channel="Up", orientation="vertical", azimuth=float("nan"))


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize(
    ("channels", "labels"),
    [
        (("90", "Up"), ["90", "Up"]),
        (("hne", "HNE"), ["CI.CLC..90", "CI.CLC..Up"]),
        (("90", ""), ["CI.CLC..90", "CI.CLC..Up"]),
        (("9 0 (x)", "~a-B_/1"), ["9_0_x_", "~a-B__1"]),
    ],
)
def test_channels_tell_files_apart_where_they_are_distinct(tmp_path, channels, labels):
    records = [replace(record, channel=channel) for record, channel in zip((EAST, UP), channels, strict=True)]
    written = rp.write(records, tmp_path / "out.csv")
    assert [one.path.name for one in written] == [f"out.{label}.csv" for label in labels]
    assert [one.records for one in written] == [((record.id, ""),) for record in records]


def test_the_writer_of_a_path(tmp_path):
    assert [check_output(tmp_path / f"a.{end}").suffix for end in ("at2", "CSV", "ms", "MiniSeed")] == [
        *(".AT2", ".csv", ".mseed", ".mseed")
    ]
    assert check_output(tmp_path, "csv").suffix == ".csv"


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
        ("out.txt", "csv", r"expected the suffix \.csv for the format csv, found '\.txt'"),
        ("out.csv", "at2", "the suffix belongs to the format csv, but the format is at2"),
        ("new", "mseed", "miniSEED holds all records in one file; name that file, such as"),
        ("missing/new/out.csv", None, "there is no folder .*missing/new; create it first"),
        ("missing/out.csv", None, "there is no folder .*missing; create it first"),
        ("missing/new", "csv", "there is no folder .*missing; create it first"),
        ("noext", "csv", r"noext: expected a folder, or a name that ends in \.csv, found a file"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused(tmp_path, out, format, message):
    (tmp_path / "noext").write_text("mine")
    with pytest.raises(ConfigError, match=message):
        rp.write([EAST], tmp_path / out, format, overwrite=True)
    assert [path.read_text() for path in tmp_path.rglob("*") if path.is_file()] == ["mine"]
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


def test_a_station_file_of_others_is_never_replaced(tmp_path):
    (tmp_path / "out.xml").write_text("<FDSNStationXML/>")
    with pytest.raises(ConfigError, match=r"out\.xml: a StationXML that rockpulse did not write is never replaced"):
        rp.write([EAST], tmp_path / "out.mseed", overwrite=True)
    (tmp_path / "out.xml").unlink()
    rp.write([EAST], tmp_path / "out.mseed")
    rp.write([EAST], tmp_path / "out.mseed", overwrite=True)


def test_a_station_file_of_others_with_the_same_codes_leaves_another_location(tmp_path):
    rp.write([EAST], tmp_path / "out.mseed")
    own = (tmp_path / "out.xml").read_text()
    other = own.replace("<Value>1.0<", "<Value>2.0<").replace("written by rockpulse", "of others")
    (tmp_path / "agency.xml").write_text(other)
    assert rp.read(tmp_path / "out.mseed")[0].unit_factor == 1.0  # the file of the same name comes first
    (written,) = rp.write([EAST], tmp_path / "second.mseed")
    assert written.records == (("CI.CLC..90", "CI.CLC.00.HNE"),)
    assert np.array_equal(rp.read(tmp_path / "second.mseed")[0].acceleration, EAST.acceleration)


def test_a_station_file_of_another_time_leaves_the_codes_alone(tmp_path):
    early, late = (replace(EAST, start_time=datetime(year, 1, 2, tzinfo=UTC)) for year in (2001, 2002))
    rp.write([early], tmp_path / "early.mseed")
    for azimuth, code in ((90.0, "CI.CLC..HNE"), (91.0, "CI.CLC..HNE")):
        (written,) = rp.write([replace(late, azimuth=azimuth)], tmp_path / f"{azimuth}.mseed")
        assert written.records[0][1] == code
        (tmp_path / f"{azimuth}.xml").unlink()
    (written,) = rp.write([replace(early, azimuth=91.0)], tmp_path / "again.mseed")
    assert written.records[0][1] == "CI.CLC.00.HNE"


def test_a_damaged_station_file_in_the_folder_is_named_and_nothing_stays(tmp_path):
    (tmp_path / "agency.xml").write_text("<FDSNStationXML> CLC")
    with pytest.raises(RecordRefused, match=r"a StationXML in its folder is damaged .*agency\.xml: cannot be read"):
        rp.write([EAST], tmp_path / "out.mseed")
    assert names(tmp_path) == ["agency.xml"]


def test_the_station_file_of_a_converted_record_serves_no_other_miniseed_file(tmp_path):
    rp.write([EAST], tmp_path / "out.mseed")
    (tmp_path / "counts.mseed").write_bytes((tmp_path / "out.mseed").read_bytes())
    with pytest.raises(RecordRefused, match=r"out\.xml, which applies only to the miniSEED file of the same name"):
        rp.read(tmp_path / "counts.mseed")
    # Unless that is asked for.
    (record,) = rp.read(tmp_path / "counts.mseed", stationxml=tmp_path / "out.xml")
    assert np.array_equal(record.acceleration, EAST.acceleration)


@pytest.mark.parametrize("name", ["out.ms", "out.MSEED", "out.seed", "out", "out.mseed.gz"])
def test_two_miniseed_files_that_would_share_a_station_file_are_refused(tmp_path, name):
    rp.write([EAST], tmp_path / "other.mseed")
    content = (tmp_path / "other.mseed").read_bytes()
    (tmp_path / name).write_bytes(gzip.compress(content) if name.endswith(".gz") else content)
    (tmp_path / "out.log").touch()
    with pytest.raises(ConfigError, match=rf"its StationXML, out\.xml, would also be read with {name}"):
        rp.write([UP], tmp_path / "out.mseed", overwrite=True)
    assert not (tmp_path / "out.xml").exists()
    (tmp_path / name).unlink()
    rp.write([UP], tmp_path / "out.mseed")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"acceleration": 1.000000001 * EAST.acceleration}, r"the samples of CI\.CLC\.\.90 would differ after reading"),
        ({"azimuth": np.nan, "component": "", "channel": "HN1"}, "the azimuth would be read back as nan instead of 90"),
    ],
)
def test_miniseed_that_does_not_come_back_whole_is_refused_and_nothing_stays(tmp_path, monkeypatch, changes, message):
    from rockpulse.readers import conversion, writers

    def wrong(records, beside):
        content, metadata, _ = writers.miniseed_bytes([replace(one, **changes) for one in records], beside)
        return content, metadata, writers.miniseed_bytes([replace(records[0], channel="HN1")], beside)[2]

    monkeypatch.setattr(conversion, "miniseed_bytes", wrong)
    with pytest.raises(RecordRefused, match=message):
        rp.write([replace(EAST, channel="HN1")], tmp_path / "out.mseed")
    assert names(tmp_path) == []


def test_a_channel_on_a_structure_is_logged(tmp_path, caplog):
    rp.write(replace(EAST, orientation="structural"), tmp_path / "out.AT2")  # which has a word for it
    assert not caplog.messages
    rp.write([EAST, replace(UP, orientation="structural")], tmp_path / "out.csv")
    assert caplog.messages == ["CI.CLC..Up: the sensor is on a structure, which .csv files cannot state"]


@pytest.mark.parametrize("name", ["a!b/in.AT2", "a; b/in.AT2", "a; b!c; d.AT2", "plain.AT2"])
def test_no_sign_in_a_path_uncovers_the_file_a_record_came_from(tmp_path, name):
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    rp.write([EAST], path)
    before = path.read_bytes()
    (record,) = rp.read(path)
    assert record.source == str(path)
    (tmp_path / "link.AT2").symlink_to(path)
    for source in (record.source, f"{record.source}; {tmp_path}/other.AT2", f"other.zip!x; {record.source}!inside.AT2"):
        for target in (path, tmp_path / "link.AT2"):
            with pytest.raises(ConfigError, match="this is an input file"):
                rp.write([replace(record, source=source)], target, overwrite=True)
    assert path.read_bytes() == before


def test_a_symbolic_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "real").mkdir()
    rp.write([EAST], tmp_path / "real" / "in.AT2")
    (tmp_path / "link.AT2").symlink_to("real/in.AT2")
    rp.write([UP], tmp_path / "link.AT2", overwrite=True)
    assert (tmp_path / "link.AT2").is_symlink()
    assert rp.read(tmp_path / "real" / "in.AT2")[0].orientation == "vertical"
    assert names(tmp_path / "real") == ["in.AT2"]
    (tmp_path / "nowhere.AT2").symlink_to("missing.AT2")
    with pytest.raises(FileNotFoundError, match="the target of the symbolic link"):
        rp.write([UP], tmp_path / "nowhere.AT2", overwrite=True)


def test_a_disk_that_is_full_is_told_of_the_file_that_was_asked_for(tmp_path, monkeypatch):
    def full(path, content):
        raise OSError(errno.EFBIG, "File too large")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="File too large") as fault:
        rp.write([EAST], tmp_path / "out.csv")
    assert fault.value.filename == str(tmp_path / "out.csv")
    assert names(tmp_path) == []


def test_where_one_file_cannot_be_placed_all_stay_as_they_were(tmp_path, monkeypatch):
    rp.write([EAST], tmp_path / "out.90.csv")
    before = (tmp_path / "out.90.csv").read_bytes()
    place = Path.replace

    def stubborn(path, target):
        if target.name == "out.Up.csv" and path.suffix == ".part":
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return place(path, target)

    monkeypatch.setattr(Path, "replace", stubborn)
    louder = replace(EAST, acceleration=2.0 * EAST.acceleration)
    for records in ([louder, UP], [replace(louder, id="c", channel="c"), UP]):
        with pytest.raises(PermissionError) as fault:
            rp.write(records, tmp_path / "out.csv", overwrite=True)
        assert fault.value.filename == str(tmp_path / "out.Up.csv")
        assert names(tmp_path) == ["out.90.csv"]
        assert (tmp_path / "out.90.csv").read_bytes() == before


def test_ids_that_one_folder_cannot_hold_are_refused(tmp_path):
    with pytest.raises(ConfigError, match="expected records with different ids"):
        rp.write([EAST, replace(UP, id="ci.clc..90")], tmp_path, format="csv")


def changed(format, monkeypatch, change):
    """Have a format write the content of a changed record."""
    from rockpulse.readers import conversion

    writer = conversion.WRITERS[format]
    monkeypatch.setitem(conversion.WRITERS, format, replace(writer, one=lambda record: change(writer.one, record)))


@pytest.mark.parametrize(
    ("format", "share", "kept"), [("at2", 1e-8, True), ("at2", 2e-7, False), ("csv", 1e-12, False)]
)
def test_the_digits_of_a_format_tell_how_far_samples_may_be_off(tmp_path, monkeypatch, format, share, kept):
    changed(
        format, monkeypatch, lambda one, record: one(replace(record, acceleration=record.acceleration * (1.0 + share)))
    )
    with raises_if(not kept, RecordRefused, "would differ after reading; use another format"):
        rp.write(EAST, tmp_path / f"out.{format}")


@pytest.mark.parametrize(("share", "kept"), [(5e-8, True), (-5e-8, True), (2e-7, False), (-2e-7, False), (0.5, False)])
def test_an_interval_comes_back_to_seven_digits(tmp_path, monkeypatch, share, kept):
    changed("at2", monkeypatch, lambda one, record: one(replace(record, dt=record.dt * (1.0 + share))))
    told = r"the sampling interval of CI\.CLC\.\.90, 0\.01 s, would be read back as"
    with raises_if(not kept, RecordRefused, told):
        rp.write(EAST, tmp_path / "out.AT2")


def test_samples_and_records_come_back_in_their_number(tmp_path, monkeypatch):
    changed("csv", monkeypatch, lambda one, record: one(replace(record, acceleration=record.acceleration[:-1])))
    with pytest.raises(RecordRefused, match="would differ after reading"):
        rp.write(EAST, tmp_path / "out.csv")
    monkeypatch.undo()
    rows = "".join(f"{0.01 * k:.2f},{k % 7},{k % 5}\n" for k in range(300)).encode()
    changed("csv", monkeypatch, lambda one, record: b"time,acc_E,acc_N\n" + rows)
    with pytest.raises(RecordRefused, match="only 2 of 1 records can be read back; use another format"):
        rp.write(EAST, tmp_path / "out.csv")
    assert names(tmp_path) == []


@pytest.mark.parametrize(("format", "kept"), [("at2", True), ("csv", False)])
def test_what_a_format_of_few_digits_may_lose_near_zero(tmp_path, monkeypatch, format, kept):
    tiny = replace(EAST, acceleration=np.where(np.arange(300) == 7, 1e-98, EAST.acceleration))
    lost = np.where(np.arange(300) == 7, 0.0, EAST.acceleration)
    changed(format, monkeypatch, lambda one, record: one(replace(record, acceleration=lost)))
    with raises_if(not kept, RecordRefused, "would differ after reading"):
        rp.write(tiny, tmp_path / f"out.{format}")


def test_a_file_that_would_not_be_read_again_is_not_kept(tmp_path, monkeypatch):
    changed("csv", monkeypatch, lambda one, record: b"no table")
    with pytest.raises(RecordRefused, match=r"out\.csv: the file could not be read back .*; no file was kept"):
        rp.write(EAST, tmp_path / "out.csv")
    assert names(tmp_path) == []
