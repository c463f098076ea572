"""Pairs of files of one channel each: [[records.pair]] and their table make two components of one recording."""

import re
from dataclasses import replace

import numpy as np
import pytest
from batch_runs import CONFIG
from record_writers import pulse

import rockpulse as rp
from rockpulse.errors import ConfigError
from rockpulse.readers.folders import read_all
from rockpulse.run.batch import assess_files
from rockpulse.run.options import BatchOptions
from rockpulse.selection.events import events_by_id

PAIR = rp.PairSettings(north="a.txt", east="b.txt")


def write(path, samples, dt=0.01, heading=""):
    """A file of one column, or of times and accelerations."""
    rows = [f"{value:.6f}" for value in samples]
    if dt is not None:
        rows = [f"{dt * number:.4f} {row}" for number, row in enumerate(rows)]
    path.write_text("\n".join([heading] * bool(heading) + rows) + "\n")


@pytest.fixture
def folder(tmp_path):
    """Two files that are a pair, and another one."""
    for number, name in enumerate(("a.txt", "b.txt", "c.txt")):
        write(tmp_path / name, pulse(300, 0.3 + 0.1 * number) * (1.0 + 0.2 * np.sin(np.arange(300) * number)))
    return tmp_path


def read(folder, *pairs, **options):
    return read_all(folder, "g", pairs=pairs or (PAIR,), **options)


def test_two_files_are_one_recording_in_two_directions(folder):
    records, failures = read(folder)
    assert failures == []
    assert [one.azimuth for one in records[:2]] == [0.0, 90.0]
    assert [one.orientation for one in records] == ["horizontal", "horizontal", "unknown"]
    (pair,), rows = rp.find_pairs(records)
    assert [one.source[-5:] for one in pair.channels] == ["a.txt", "b.txt"]
    assert [row.file[-5:] for row in rows] == ["c.txt"]
    events, _ = events_by_id(records, {}, [])
    assert events[records[0].id] == events[records[1].id]


def test_files_without_times_and_headings_and_in_an_archive_are_pairs(tmp_path):
    import zipfile

    with zipfile.ZipFile(tmp_path / "far.zip", "w") as archive:
        for number in (120111, 120112, 120121, 120122):
            write(tmp_path / "one.txt", pulse(300, 1e-6 * number), dt=None)
            archive.write(tmp_path / "one.txt", f"{number}.txt")
    (tmp_path / "one.txt").unlink()
    pairs = [rp.PairSettings(north=f"{one}1.txt", east=f"far.zip!{one}2.txt") for one in (12011, 12012)]
    records, failures = read(tmp_path / "far.zip", *pairs, dt=0.01)
    assert failures == []
    found, rows = rp.find_pairs(records)
    assert [[one.id[:6] for one in pair.channels] for pair in found] == [["120111", "120112"], ["120121", "120122"]]
    assert rows == []


@pytest.mark.parametrize(
    ("samples", "dt", "expected"),
    [
        (301, 0.01, r"expected equal numbers of samples in a.txt and b.txt .*, found 300 and 301; if both begin"),
        (300, 0.02, r"expected equal intervals in a.txt and b.txt .*, found 0.01 and 0.02 s"),
    ],
)
def test_files_of_other_length_or_interval_are_not_used(folder, samples, dt, expected):
    write(folder / "b.txt", pulse(samples, 0.4), dt)
    records, failures = read(folder)
    assert [one.source[-5:] for one in records] == ["c.txt"]
    assert [(row.file[-5:], row.stage, row.remedy) for row in failures] == [
        ("a.txt", "pair", "pair"),
        ("b.txt", "pair", "pair"),
    ]
    assert re.search(expected, failures[0].reason)


@pytest.mark.parametrize(
    ("heading", "expected"),
    [
        ("time [s] acc_N[g]", r"the file states the direction 0 degrees, but .*a.txt. calls it east; correct one"),
        ("time [s] acc_Up[g]", "the file states the orientation vertical, "),
    ],
)
def test_a_direction_that_the_file_states_must_agree(folder, heading, expected):
    write(folder / "b.txt", pulse(300, 0.4), heading=heading)
    records, (row,) = read(folder)
    assert len(records) == 2
    assert re.search(expected, row.reason)


def test_a_file_of_two_channels_is_no_component(folder):
    rows = [f"{0.01 * number:.2f} {value:.6f} {value:.6f}" for number, value in enumerate(pulse(300, 0.4))]
    (folder / "b.txt").write_text("\n".join(["time acc_N[g] acc_E[g]", *rows]))
    _, (row,) = read(folder)
    assert "expected one channel, because [[records.pair]] north = " in row.reason


@pytest.mark.parametrize(
    ("east", "expected"),
    [
        ("missing.txt", r'\]\] east = "missing.txt": no such file among the files'),
        ("./b.txt", r'"./b.txt": the file is already in \[\[records.pair\]\] n'),
        ("d.txt", '"d.txt": 2 files have this name: .*; give a longer part'),
    ],
)
def test_a_file_must_be_there_once_and_in_one_pair(folder, east, expected):
    for name in ("x", "y"):
        (folder / name).mkdir()
        write(folder / name / "d.txt", pulse(300, 0.4))
    with pytest.raises(ConfigError, match=expected):
        read(folder, PAIR, rp.PairSettings(north="c.txt", east=east))


@pytest.mark.sweep
def test_a_run_over_files_rotates_pairs_of_a_table(folder, tmp_path):
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "pairs.csv").write_text("north;east\na.txt;b.txt\n")
    settings = rp.RecordSettings(components="azimuth", azimuth=30.0, pair_table="pairs.csv", units="g")
    config = replace(CONFIG, records=settings, folder=tmp_path / "tables")
    assert (config.records.pairs, config.records.pair_table) == ((PAIR,), None)
    files = [folder / "a.txt", folder / "b.txt"]
    assess_files(files, config, tmp_path / "results.h5", BatchOptions(workers=1))
    tree = rp.load(tmp_path / "results.h5")
    assert tree["summary"]["azimuth"].values.tolist() == [30.0]
    assert rp.assess(files, config)["summary"]["pga"].values == tree["summary"]["pga"].values


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("north,west\na,b\n", "expected a CSV table with the columns north and east; missing: east"),
        ("north,east\na,a\n", r"row 1: \[\[records.pair\]\] north = .a.: expected two files, found .a. twice"),
        ("north,east\na,\n", "row 1: .*east: expected the name of one file, without wildcards, found ''"),
        ("north,east\n", "expected a row for each pair, found none"),
        (None, "no such file; expected a CSV table with the columns north and east"),
    ],
)
def test_a_table_of_pairs_is_checked(tmp_path, text, expected):
    if text is not None:
        (tmp_path / "pairs.csv").write_text(text)
    with pytest.raises(ConfigError, match=expected):
        rp.Config(records=rp.RecordSettings(pair_table="pairs.csv"), folder=tmp_path)
