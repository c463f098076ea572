"""Which files a pattern of the options of reading chooses."""

import gzip
import io
import math

import numpy as np
import pytest
from make_format_samples import FORMATS, SAMPLES, format_samples, read_options, source_channels, table
from record_writers import pulse
from source_files import ONE, make_zip, raises_if

from rockpulse.errors import ConfigError, RockpulseError
from rockpulse.readers import FORMATS as READERS
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.format import FileSettings, ReadOptions
from rockpulse.readers.source import HEAD, SourceFile
from rockpulse.record.record import STANDARD_GRAVITY, Record


@pytest.mark.parametrize(
    ("pattern", "name", "chosen"),
    [
        ("ARL [1].g3", "columns/ARL [1].g3", True),
        ("ARL [1].g3", "columns/ARL 1.g3", False),
        ("*[[]1].g3", "columns/ARL [1].g3", False),
        ("site 2\\*.g3", "site 2/ARL.g3", True),
        ("./columns/*.g3", "columns/ARL.g3", True),
        (".\\columns\\?RL.g3", "columns/ARL.g3", True),
        ("./columns/*.g3", "other/ARL.g3", False),
        ("old.zip", "old.zip!sub/ARL.g3", True),
        ("sub/ARL.g3", "old.zip!sub/ARL.g3", True),
        ("new.zip", "old.zip!new.zip.g3", False),
        ("*.g3", "old.zip.gz!ARL.G3", False),
        ("ARL.g3", "columns/ARL.g3.gz", True),
        ("ARL.g3", "columns/ARL.g3.GZ", True),
        ("ARL.g", "columns/ARL.g3", False),
        ("old.zip", "old.zip.gz!ARL.g3", True),
    ],
)
def test_a_pattern_has_no_signs_but_those_that_the_manual_names(pattern, name, chosen):
    assert FileSettings(match=pattern, units="g").chooses(name) == chosen


@pytest.mark.parametrize("dt", [0.0, -0.01, math.nan, math.inf, "0.01"])
def test_an_interval_that_is_none_is_refused(dt):
    with pytest.raises(ConfigError, match="option dt: expected a sampling interval in s above 0"):
        ReadOptions(dt=dt)


@pytest.mark.parametrize(
    ("given", "fits"),
    [({"units": "gal"}, True), ({"units": "mm/s2"}, False), ({"dt": 0.01001}, True), ({"dt": 0.0100101}, False)],
)
def test_a_row_may_spell_a_unit_otherwise_and_print_fewer_digits(given, fits):
    record = Record([0.0, 1.0, 0.0], dt=0.01, id="x", source="x.v1", source_unit="cm/s2")
    told = r"x\.v1: the file states .*correct the wrong one, or the pattern"
    with raises_if(not fits, RockpulseError, told):
        ReadOptions(files=(FileSettings(match="*", **given),)).check([record])


def test_the_options_of_one_file_are_those_of_the_last_row_that_gives_them():
    first, second = FileSettings(match="*.a", units="g", dt=0.5), FileSettings(match="*.a", units="cm/s2")
    third, other = FileSettings(match="*.a", units="m/s2", dt=0.25), FileSettings(match="*.b", dt=2.0)
    options = ReadOptions("mm/s2", 0.125, files=(third, first, second, other))
    found = [options.of_file(f"folder/x.{end}") for end in "abc"]
    assert [(one.units, one.dt) for one in found] == [("cm/s2", 0.5), ("mm/s2", 2.0), ("mm/s2", 0.125)]
    assert [one.files for one in found] == [(first, second), (other,), ()]
    assert [one.said_by("units") for one in found] == [second.where, "the option units", "the option units"]
    assert [one.said_by("dt") for one in found] == [first.where, other.where, "the option dt"]
    assert [one.advice("dt") for one in found[:2]] == ["correct the wrong one, or the pattern"] * 2
    assert "--dt 0.125 is meant for other files" in found[2].advice("dt")
    assert "--units mm/s2 is meant for other files" in found[2].advice("units")
    plain = ReadOptions("g", 0.5)
    assert plain.of_file("x.a") is plain


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({}, "expected units, dt or both, found neither"),
        ({"units": "stone"}, r"option units of \[\[records.file\]\] match = .x.: unknown unit"),
        ({"dt": 0.0}, "dt"),
        ({"match": " ", "units": "g"}, "a pattern that is not empty"),
        ({"match": 3, "units": "g"}, "a pattern that is not empty"),
    ],
)
def test_a_row_that_says_nothing_or_no_sense_is_refused(row, message):
    with pytest.raises(ConfigError, match=message):
        FileSettings(**{"match": "x"} | row)


def test_a_way_to_remove_the_response_is_one_of_two():
    assert [ReadOptions(response=way).response for way in ("sensitivity", "remove")] == ["sensitivity", "remove"]
    with pytest.raises(ConfigError, match="option response: expected one of sensitivity, remove, found 'none'"):
        ReadOptions(response="none")


ROWS = b"\n".join(b"%.6f" % value for value in pulse(peak=0.3))


@pytest.fixture
def bare(tmp_path):
    """Columns without unit and interval, plain, compressed and in an archive, and a file that states both."""
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "b.g3").write_bytes(ROWS + b"\n0.1")
    (tmp_path / "a.g3.gz").write_bytes(gzip.compress(ROWS))
    make_zip(tmp_path / "c.zip", in__c_dot_g3=ROWS + b"\n0.2")
    (tmp_path / "d.AT2").write_bytes(ONE)
    return tmp_path


def read_in(folder, *files, **options):
    """Peak in the unit of the file, unit and interval of what was read, and the failures."""
    records, failures = read_all(folder, files=files, **options)
    return {one.id: (one.source_unit, one.dt) for one in records}, failures


def test_unit_and_interval_are_those_of_the_last_pattern_that_gives_them(bare):
    everything = FileSettings(match="*.g3", units="g", dt=0.02)
    found, failures = read_in(bare, everything)
    assert found == {"a.1": ("g", 0.02), "b.1": ("g", 0.02), "c.1": ("g", 0.02), "d.090": ("g", 0.01)}
    assert failures == []
    rows = (everything, FileSettings(match="old/*", units="cm/s2"), FileSettings(match="c.zip", dt=0.005))
    found, failures = read_in(bare, *rows, units="mm/s2", dt=1.0)
    assert found == {"a.1": ("g", 0.02), "b.1": ("cm/s2", 0.02), "c.1": ("g", 0.005), "d.090": ("g", 0.01)}
    assert failures == []
    found, failures = read_in(bare, FileSettings(match="in/*", units="gal", dt=0.04), units="g", dt=0.03)
    assert found["c.1"] == ("gal", 0.04)
    assert found["a.1"] == found["b.1"] == ("g", 0.03)


@pytest.mark.parametrize("pattern", ["*.G3", "old", "b", "g3", "other/*"])
def test_a_pattern_that_chooses_no_file_is_an_error(bare, pattern):
    with pytest.raises(
        ConfigError, match=r'match = ".*": the pattern matches none of the files to read \(5 in all, such as'
    ):
        read_all(bare, files=[FileSettings(match="*.g3", units="g"), FileSettings(match=pattern, dt=0.01)])


def test_without_a_file_the_rows_say_what_is_wrong_and_no_pattern(tmp_path):
    records, failures = read_all(tmp_path / "gone", files=[FileSettings(match="*", units="g")])
    assert records == []
    assert "no such file or folder" in failures[0].reason


def test_patterns_are_looked_for_beside_a_damaged_archive(bare):
    (bare / "e.zip").write_bytes(b"PK\x03\x04 damaged")
    found, failures = read_in(bare, FileSettings(match="in/c.g3", units="g", dt=0.02), units="g", dt=0.02)
    assert len(found) == 4
    assert [row.file for row in failures] == [str(bare / "e.zip")]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"units": "cm/s2"}, 'states the unit g, but [[records.file]] match = "*.AT2" says cm/s2; correct the wrong'),
        ({"dt": 0.02}, 'states an interval of 0.01 s, but [[records.file]] match = "*.AT2" says 0.02 s; correct'),
    ],
)
def test_a_file_that_states_something_else_than_its_pattern_fails(bare, given, words):
    found, failures = read_in(bare, FileSettings(match="*.AT2", **given), units="g", dt=0.01)
    assert "d.090" not in found
    assert [row.kind for row in failures] == ["failed"]
    assert words in failures[0].reason
    assert "--" not in failures[0].reason


#: obspy may write these in other bytes one day; their content is compared instead.
BY_OBSPY = (".mseed", ".sac")
#: How the warning of a sample begins that cannot be without one.
KNOWN = {"clc_rows.g3": "rows of 5 numbers were read as one series of 1200"}
PATHS = sorted(path for path in FORMATS.iterdir() if path.suffix != ".xml")


@pytest.fixture(scope="module")
def written():
    return format_samples()


@pytest.fixture(scope="module")
def channels():
    return source_channels()


def samples_of(content, name):
    """All numbers of a file that is said to lie among the samples, where the gains are."""
    stream = io.BytesIO(content)
    stream.name = str(FORMATS / name)
    return np.concatenate([record.acceleration for record in read(stream, **read_options().get(name, {}))])


@pytest.mark.sweep
def test_the_committed_files_are_what_the_generator_writes(written):
    assert sorted(path.name for path in FORMATS.iterdir()) == list(written), "make samples"
    for name, content in written.items():
        committed = (FORMATS / name).read_bytes()
        if name.endswith(BY_OBSPY):
            assert np.array_equal(samples_of(committed, name), samples_of(content, name)), f"{name}: make samples"
        else:
            assert committed == content, f"{name}: make samples"
    assert table() in (SAMPLES / "README.md").read_text(encoding="utf-8"), "make samples"


def test_the_files_are_small_and_say_what_they_are(written):
    assert sum(map(len, written.values())) < 1_500_000
    for name, content in written.items():
        assert len(content) <= 120_000, name
        # miniSEED has no room for words; its StationXML has. Rows of numbers alone have none either.
        assert name.endswith((".mseed", ".g3")) or b"ROCKPULSE" in content.upper(), name


@pytest.mark.sweep
def test_every_reader_has_a_sample():
    claimed = {read(path, **read_options().get(path.name, {}))[0].format for path in PATHS}
    assert {row.name for row in READERS if row.unit != "-"} == claimed


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_a_sample_gives_back_the_channel_to_the_written_digits(path, channels):
    for record in read(path, **read_options().get(path.name, {})):
        # Printed to 1e-3 g/10 at the coarsest.
        fits = [
            channel
            for channel in channels
            if np.max(np.abs(record.acceleration - channel.acceleration)) <= 0.51e-4 * STANDARD_GRAVITY
        ]
        assert len(fits) == 1, f"{record.channel}: no channel of {len(channels)} has these numbers"
        (channel,) = fits
        assert (record.npts, record.dt) == (channel.npts, pytest.approx(channel.dt, rel=1e-9))
        if record.start_time is not None:
            assert abs((record.start_time - channel.start_time).total_seconds()) <= 0.01
        if record.orientation != "unknown":
            assert record.orientation == channel.orientation
        if np.isfinite(record.azimuth):
            assert record.azimuth == channel.azimuth
        assert [note for note in record.warnings if not note.startswith(KNOWN.get(path.name, "none"))] == []


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_only_one_detector_claims_a_sample(path):
    claims = [row.name for row in READERS if row.detect(path.read_bytes()[:HEAD], path.name)]
    assert claims == [read(path, **read_options().get(path.name, {}))[0].format]


@pytest.mark.parametrize("row", READERS, ids=lambda row: row.name)
def test_a_reader_that_is_named_refuses_a_file_of_another_format(row):
    for content in (b"no record\n", b"no record\n" * 100, bytes(1000)):
        with pytest.raises(RockpulseError, match=r"no_record\.txt") as refusal:
            row.read(SourceFile("no_record.txt", content[:HEAD], lambda content=content: content), ReadOptions())
        if row.name in ("dyna", "sac", "smc"):
            assert f"is it a{'n' * (row.name == 'smc')} {row.name.upper()} file?" in str(refusal.value)


def test_no_detector_claims_a_text_of_the_project():
    top = SAMPLES.parents[1]
    texts = [path for path in (*top.iterdir(), *top.glob("docs/**/*"), *SAMPLES.iterdir()) if path.is_file()]
    assert len(texts) > 10
    for path in [*texts, *FORMATS.glob("*.xml")]:
        head = path.read_bytes()[:HEAD]
        assert [row.name for row in READERS if head and row.detect(head, path.name)] == [], path
