"""From paths to records: files, folders, globs, archives, and a row for everything that is no record."""

import gzip
import hashlib
import os
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from record_writers import csmip_equal, pulse
from source_files import ONE, TWO, VELOCITY, ids, kinds, make_zip

from rockpulse.errors import ConfigError, UnitError
from rockpulse.readers import FileSettings, folders
from rockpulse.readers.folders import Found, check_patterns, find_files, read_all, settled
from rockpulse.readers.format import ReadOptions
from rockpulse.record.record import Record


@pytest.fixture
def folder(tmp_path):
    """Two records in nested folders, and what lies beside records."""
    (tmp_path / "sub" / ".cache").mkdir(parents=True)
    (tmp_path / "b.AT2").write_bytes(ONE)
    (tmp_path / "sub" / "a.AT2").write_bytes(TWO)
    (tmp_path / "sub" / "a.VT2").write_bytes(VELOCITY)
    (tmp_path / "notes.txt").write_text("nothing to read here\n")
    for quiet in ["README.md", "site.toml", "XX.ABC.xml", "results.h5", ".hidden", "sub/.cache/c.AT2"]:
        (tmp_path / quiet).write_bytes(b"<FDSNStationXML/>" if quiet.endswith(".xml") else ONE)
    return tmp_path


@pytest.mark.sweep
def test_the_samples_give_their_channels_in_order(samples):
    records, failures = read_all([samples])
    assert ids(records) == [
        *[f".HSES.20.{channel}@20161113T110220" for channel in ("N10E", "N80W", "Up")],
        ".2555..360@20110823T175056",
        *[f"CI.CCC..{channel}@20190706T031937" for channel in ("360", "90", "Up")],
        *[f"CI.CLC..{channel}@20190706T031608" for channel in ("360", "90", "Up")],
        *[f"CI.TOW2..{channel}@20190706T031931" for channel in ("360", "90", "Up")],
        "NP.8040.01.HNE@20181130T172906",
    ]
    assert failures == []
    assert all(
        record.source_sha256 == hashlib.sha256((samples / record.source).read_bytes()).hexdigest() for record in records
    )


def test_a_folder_is_searched_to_any_depth_and_the_rest_is_listed(folder):
    records, failures = read_all(folder)
    assert ids(records) == ["b.090", "a.090"]
    assert kinds(failures) == [("notes.txt", "skipped"), ("a.VT2", "skipped")]
    assert failures[0].reason == f"{folder}/notes.txt: no record"
    assert "expected an acceleration series" in failures[1].reason


PROSE = b"These data are provided as they are.\nNo 1 of 2, see page 3.\n"
SPECTRA = b"-- Summary of spectra --\n" + b"0.01 0.5 0.6\n0.02 0.7 0.8\n0.03 0.9 1.0 1.1\n" * 9 + b"end\n"
UNEVEN = b"somebody's recorder, m/s2\n" + b"0.01 0.5 0.6\n0.02 0.7\n0.03\n" * 9 + b"end\n"


@pytest.mark.parametrize(
    ("name", "content", "may_be"),
    [
        ("DISCLAIMER.TXT", PROSE, False),
        ("readme.txt", SPECTRA, False),
        ("_SearchResults.csv", SPECTRA, False),
        ("map.jpg", b"\xff\xd8\x00\x01", False),
        ("list.csv", b"station,latitude,event\nA,40.1,Kobe\nB,40.2,Kobe\n", False),
        ("motion.txt", UNEVEN, True),
        ("motion.v2", PROSE, True),
        ("CHAN1.DAT", PROSE, True),
        ("record.012", PROSE, True),
        ("record.bin", b"\x00\x01\x02\x03" * 99, True),
    ],
)
def test_what_may_be_a_record_in_an_unknown_format_is_told_apart_from_texts_beside_records(
    tmp_path, name, content, may_be
):
    """A lost station is not listed among readme and disclaimer, nor hidden as one of them."""
    (tmp_path / name).write_bytes(content)
    ((failure,), (named,)) = (read_all(path)[1] for path in (tmp_path, tmp_path / name))
    assert (failure.kind, named.kind) == (
        "failed" if may_be else "skipped",
        "skipped" if name == "list.csv" else "failed",
    )
    assert ("no reader recognises the file" in failure.reason) == may_be
    assert failure.reason.endswith(f"{name}: no record") != may_be
    assert ("no reader recognises the file" in named.reason) == (name != "list.csv")


STATION = b"<?xml version='1.0'?>\n<fsx:FDSNStationXML xmlns:fsx='x' schemaVersion='1.1'/>\n"
EARTHQUAKE = b"<?xml version='1.0'?>\n<q:quakeml xmlns:q='x'/>\n"
WAVE = b"<wave dt='0.01'>" + b"0.12 -0.34 " * 99 + b"</wave>\n"


@pytest.mark.parametrize("packed", [False, True])
def test_xml_of_stations_and_earthquakes_is_passed_over_and_other_xml_is_listed(tmp_path, packed):
    files = {"a.AT2": ONE, "s.xml": STATION, "q.XML": EARTHQUAKE, "w.xml": WAVE, "empty.xml": b"", "b.xml": b"<a>b</a>"}
    if packed:
        make_zip(tmp_path / "all.zip", **files)
    else:
        for name, content in files.items():
            (tmp_path / name).write_bytes(content)
    for given in (tmp_path, str(tmp_path / "*")):
        records, failures = read_all(given)
        assert ids(records) == ["a.090"]
        told = {failure.file.replace("!", "/").rpartition("/")[2]: failure for failure in failures}
        assert sorted(told) == ["b.xml", "empty.xml", "w.xml"]
        assert "no reader recognises the file" in told["w.xml"].reason
        assert told["b.xml"].reason.endswith(": no record")
        assert told["empty.xml"].kind == "failed"


def test_a_pipe_that_is_called_xml_is_listed_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.xml")
    _, (failure,) = read_all(tmp_path)
    assert "expected a file, found a " in failure.reason


def test_a_file_without_accelerations_tells_whose_they_would_be(tmp_path, samples):
    (tmp_path / "a.VT2").write_bytes(VELOCITY)
    title = "Response and Fourier amplitude spectra\nStation No. 89146   40.9N, 123.6W   Etna\nWillow Creek   CGS\n"
    (tmp_path / "b.V3").write_text(title)
    velocity, spectra = read_all(tmp_path)[1]
    assert "expected an acceleration series of station Station One, found" in velocity.reason
    assert "expected an accelerogram of station 89146, Willow Creek, found response" in spectra.reason


def test_what_is_not_there_does_not_hide_what_comes_behind_it(folder):
    found, failures = find_files(["", folder / "none", str(folder / "*.none"), folder / "sub" / "a.AT2"])
    assert [Path(item.path).name for item in found] == ["a.AT2"]
    assert [failure.reason.rpartition(": ")[2][:16] for failure in failures] == [
        *("an empty path wa", "no such file or ", "the pattern matc")
    ]


def test_patterns_are_not_held_against_the_inside_of_a_pipe(tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr(folders.source, "is_archive", lambda path: pytest.fail("to open it would wait for its writer"))
    options = ReadOptions(files=(FileSettings(match="x", units="g"),))
    with pytest.raises(ConfigError, match="matches none of the files to read"):
        check_patterns([Found(str(tmp_path / "pipe"), True)], options)
    check_patterns([], options)


def test_a_named_file_counts_as_named_even_if_its_folder_is_given_too(folder):
    _, failures = read_all([folder, folder / "notes.txt", folder / "sub" / "a.VT2"])
    assert kinds(failures) == [("notes.txt", "failed"), ("a.VT2", "failed")]


def test_files_of_the_run_are_no_input_whatever_leads_to_them(folder):
    (folder / "run.log").write_text("2026 INFO rockpulse\n")
    (folder / "link.txt").symlink_to(folder / "run.log")
    os.link(folder / "run.log", folder / "again.txt")
    for paths in (
        folder,
        [folder, folder / "run.log"],
        [str(folder / "*")],
        [folder / "sub" / ".." / "link.txt", folder],
    ):
        found, failures = find_files(paths, (folder / "run.log", folder / "none.h5"))
        assert sorted(Path(item.path).name for item in found) == ["a.AT2", "a.VT2", "b.AT2", "notes.txt"]
        assert failures == []


def test_journals_of_other_outputs_lie_beside_records_without_a_row(folder):
    before = [item.path for item in find_files(folder)[0]]
    for name in ("other.h5.journal", "other.h5.journal-journal", "other.h5.0123abcd.part"):
        (folder / name).write_bytes(b"SQLite format 3\0")
    assert [item.path for item in find_files(folder)[0]] == before


@pytest.mark.parametrize(("pattern", "expected"), [("*.AT2", ["b.090"]), ("**/*.AT2", ["b.090", "a.090"])])
def test_globs(folder, pattern, expected):
    records, _ = read_all([str(folder / pattern)])
    assert ids(records) == expected


def test_a_folder_that_cannot_be_listed_is_a_row(folder, monkeypatch):
    scan = os.scandir

    def fail(path):
        if str(path).endswith("sub"):
            raise PermissionError(13, "Permission denied", str(path))
        return scan(path)

    monkeypatch.setattr(os, "scandir", fail)
    records, failures = read_all(folder)
    assert ids(records) == ["b.090"]
    assert kinds(failures) == [("notes.txt", "skipped"), ("sub", "failed")]


def test_nothing_found_is_a_failure_not_silence(folder):
    (folder / "empty").mkdir()
    make_zip(folder / "empty.zip")
    paths = [str(folder / "*.V9"), str(folder / "empty"), str(folder / "empty.zip")]
    records, failures = read_all(paths)
    assert records == []
    assert [failure.kind for failure in failures] == ["failed"] * 3
    assert "the pattern matches no file" in failures[0].reason


def test_a_file_with_glob_characters_in_its_name_is_a_file(tmp_path):
    (tmp_path / "a[1].AT2").write_bytes(ONE)
    records, failures = read_all([str(tmp_path / "a[1].AT2")])
    assert (ids(records), failures) == (["a_1_.090"], [])


def test_the_same_samples_in_another_component_or_interval_are_no_duplicate(folder):
    (folder / "c.AT2").write_bytes(ONE.replace(b", 090", b", 180"))
    (folder / "d.AT2").write_bytes(ONE.replace(b"DT= 0.0100", b"DT= 0.0200"))
    records, _ = read_all(folder)
    assert ids(records) == ["b.090", "c.180", "d.090", "a.090"]


def columns(*headings, scale=1.0, dead=False):
    """A table of time and a motion in as many columns as there are headings."""
    motion = np.zeros(300) if dead else scale * pulse(300)
    rows = np.column_stack([0.01 * np.arange(300), *(motion * (1 + place) for place in range(len(headings)))])
    body = "\n".join(",".join(f"{value:.6f}" for value in row) for row in rows)
    return f"time [s],{','.join(headings)}\n{body}\n"


@pytest.mark.parametrize(
    ("first", "second", "kept"),
    [
        ("acc [g]", "Acceleration (g)", ["a.acc"]),
        ("acc [g]", "acc N [g]", ["b.acc_N"]),
        ("acc N [g]", "acc [g]", ["a.acc_N"]),
        ("acc N [g]", "NS acc (g)", ["a.acc_N"]),
        ("acc Up [g]", "Z acc (g)", ["a.acc_Up"]),
        ("acc N [g]", "acc E [g]", ["a.acc_N", "b.acc_E"]),
        ("acc N [g]", "acc Up [g]", ["a.acc_N", "b.acc_Up"]),
    ],
)
def test_the_same_motion_under_another_heading_counts_once_unless_it_faces_elsewhere(tmp_path, first, second, kept):
    (tmp_path / "a.csv").write_text(columns(first))
    (tmp_path / "b.csv").write_text(columns(second))
    records, failures = read_all(tmp_path)
    assert ids(records) == kept
    assert len(failures) == 2 - len(kept)
    assert all("same samples and interval as" in row.reason and row.kind == "duplicate" for row in failures)


def test_dead_channels_and_channels_of_one_file_are_no_duplicates_of_each_other(tmp_path):
    (tmp_path / "a.csv").write_text(columns("acc N [g]", "acc E [g]", dead=True))
    (tmp_path / "b.csv").write_text(columns("sensor 1 acc [g]", dead=True))
    assert len(read_all(tmp_path)[0]) == 3


def test_one_id_with_other_content_gets_a_number_by_sorted_path(tmp_path):
    for name, peak in [("z", 0.1), ("a", 0.2), ("m", 0.3)]:
        (tmp_path / f"{name}.RAW").write_bytes(csmip_equal(np.round(pulse(peak=peak), 6)))
    records, _ = read_all([tmp_path / "z.RAW", tmp_path / "a.RAW", tmp_path / "m.RAW"])
    plain = ".14403..90@20190706T031608"
    assert [(record.source[-5:], record.id) for record in records] == [
        ("a.RAW", plain),
        ("m.RAW", f"{plain}~2"),
        ("z.RAW", f"{plain}~3"),
    ]


def test_unreadable_and_empty_files_are_rows(folder):
    (folder / "dangling.AT2").symlink_to(folder / "nowhere")
    (folder / "corrupt.AT2.gz").write_bytes(gzip.compress(ONE)[:-40])
    (folder / "empty.AT2").touch()
    records, failures = read_all(folder)
    assert len(records) == 2
    assert [row for row in kinds(failures) if row[1] == "failed"] == [
        ("corrupt.AT2.gz", "failed"),
        ("dangling.AT2", "failed"),
        ("empty.AT2", "failed"),
    ]
    _, (failure,) = read_all(folder / "dangling.AT2")
    assert "dangling.AT2: the target of the symbolic link" in failure.reason
    assert "Errno" not in failure.reason


def test_every_file_is_reported_to_the_callback_once(folder):
    seen: list[str] = []
    read_all([folder], on_file=seen.append)
    assert [name.removeprefix(str(folder)) for name in seen] == ["/b.AT2", "/notes.txt", "/sub/a.AT2", "/sub/a.VT2"]


def test_unit_and_interval_reach_the_columns(folder):
    (folder / "c.txt").write_text("\n".join(f"{value:.6f}" for value in pulse()))
    _, failures = read_all(folder)
    assert ("c.txt", "failed") in kinds(failures)
    records, failures = read_all(folder, units="g", dt=0.01)
    assert ids(records) == ["b.090", "c.1", "a.090"]


def test_an_unknown_unit_is_the_caller_s_mistake(folder):
    with pytest.raises(UnitError, match="option units"):
        read_all(folder, units="stone")


PLAIN = Record([0.0, 1.0, 0.0], 0.01, "a.1", source="m", channel="1", component="x")
TIME = datetime(2011, 3, 11, tzinfo=UTC)


@pytest.mark.parametrize(
    "known",
    [
        [{}, {"event": "Kobe"}, {"start_time": TIME}, {"orientation": "horizontal"}],
        [{"event": "Kobe"}, {"start_time": TIME, "event": "Kobe"}],
        [{"start_time": TIME, "event": "Kobe"}, {"orientation": "vertical"}],
        [{"orientation": "vertical"}, {"orientation": "vertical", "event": "Kobe"}],
    ],
)
def test_of_equal_motions_the_one_stays_that_knows_most(known):
    """In order: the direction, the time, the event; the first of those that know as much."""
    records = [replace(PLAIN, source=f"f{place}", **facts) for place, facts in enumerate(known)]
    for order in (records, records[::-1]):
        ((kept, pieces),), rows = settled(order, lambda record: "same")
        assert (kept, pieces) == (records[-1], (records[-1],))
        assert [row.file for row in rows] == [record.source for record in records[:-1]]
        assert all(row.reason.endswith(f"same samples and interval as a.1 of {kept.source}") for row in rows)
    again = [replace(record, source=f"{record.source}b") for record in records[-1:]]
    assert settled([*again, records[-1]], lambda record: "same")[0][0][0] == records[-1]
