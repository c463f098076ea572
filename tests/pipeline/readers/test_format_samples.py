"""The format samples that come with the project: what the generator writes, and what the readers find in them."""

from __future__ import annotations

import io

import numpy as np
import pytest
from make_format_samples import FORMATS, SAMPLES, format_samples, read_options, source_channels, table

from rockpulse.readers import FORMATS as READERS
from rockpulse.readers import read
from rockpulse.readers.source import HEAD
from rockpulse.record.record import STANDARD_GRAVITY

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


def test_no_detector_claims_a_text_of_the_project():
    top = SAMPLES.parents[1]
    texts = [path for path in (*top.iterdir(), *top.glob("docs/**/*"), *SAMPLES.iterdir()) if path.is_file()]
    assert len(texts) > 10
    for path in [*texts, *FORMATS.glob("*.xml")]:
        head = path.read_bytes()[:HEAD]
        assert [row.name for row in READERS if head and row.detect(head, path.name)] == [], path
