"""Unit and interval of some files, by patterns of their paths."""

from __future__ import annotations

import gzip

import pytest
from record_writers import pulse
from source_files import ONE, make_zip

from rockpulse.errors import ConfigError
from rockpulse.readers import FileSettings
from rockpulse.readers.folders import read_all

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
    with pytest.raises(ConfigError, match=r'match = ".*": expected the end of the path .* none among 5 files, such as'):
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
        ({"units": "cm/s2"}, 'states the unit g, [[records.file]] match = "*.AT2" says cm/s2; correct the wrong one'),
        ({"dt": 0.02}, 'states an interval of 0.01 s, [[records.file]] match = "*.AT2" says 0.02 s; correct the wrong'),
    ],
)
def test_a_file_that_states_something_else_than_its_pattern_fails(bare, given, words):
    found, failures = read_in(bare, FileSettings(match="*.AT2", **given), units="g", dt=0.01)
    assert "d.090" not in found
    assert [row.kind for row in failures] == ["failed"]
    assert words in failures[0].reason
    assert "--" not in failures[0].reason


def test_a_heading_that_states_something_else_names_the_pattern_and_no_option(tmp_path):
    table = "time (s),acc (cm/s2)\n" + "".join(f"{0.01 * k:.2f},{v:.6f}\n" for k, v in enumerate(pulse(peak=0.3)))
    (tmp_path / "a.csv").write_text(table)
    for given, words in (
        ({"units": "g"}, 'is headed cm/s2, [[records.file]] match = "*.csv" says g; correct the wrong one, or the pat'),
        ({"dt": 0.02}, '0.02 s ([[records.file]] match = "*.csv"); correct the wrong one, or the pattern'),
    ):
        found, failures = read_in(tmp_path, FileSettings(match="*.csv", **given))
        assert found == {}
        assert words in failures[0].reason
    assert read_in(tmp_path, FileSettings(match="*.csv", units="gal", dt=0.01))[1] == []
