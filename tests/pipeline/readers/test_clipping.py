"""Clipped records are said to be clipped, and whole ones are not."""

from __future__ import annotations

import io
import shutil

import numpy as np
import pytest
from record_writers import at2, csmip_equal, knet, pulse, smc
from record_writers.miniseed import station_xml

from rockpulse.readers import read
from rockpulse.readers.kit.channel import clipping_warning

WAVE = np.round(pulse(2000, peak=5e5, dt=0.005))


@pytest.mark.parametrize(("low", "high"), [(-np.inf, 3e5), (-2e5, np.inf)])
def test_either_polarity(low, high):
    (warning,) = clipping_warning(np.clip(WAVE, low, high), "counts")
    assert ("largest" if np.isinf(low) else "smallest") in warning
    assert clipping_warning(WAVE, "counts") == []


@pytest.mark.parametrize(("length", "warned"), [(4, False), (5, True)])
def test_five_samples_in_a_row_at_the_edge_are_clipping(length, warned):
    wave = np.concatenate([np.arange(0, 1000, 20), np.full(length, 1000), np.arange(980, -900, -20), [-881]])
    assert bool(clipping_warning(wave, "counts")) is warned


def test_both_polarities_are_named():
    assert len(clipping_warning(np.clip(WAVE, -2e5, 2e5).astype(np.int32), "counts")) == 2


@pytest.mark.parametrize("offset", [0.0, 1e7, -1e7])
def test_an_offset_does_not_matter(offset):
    assert clipping_warning(np.minimum(WAVE, 3e5) + offset, "g")
    assert not clipping_warning(WAVE + offset, "g")


@pytest.mark.parametrize(("top", "warned"), [(200, True), (199, False)])
def test_the_extremes_are_two_hundred_of_the_smallest_steps_apart(top, warned):
    wave = np.r_[0, 1, 50, 100, np.full(5, top), 100, 50]
    assert bool(clipping_warning(wave)) is bool(clipping_warning(3.0 - 7.0 * wave, "g")) is warned


@pytest.mark.parametrize(("left", "right", "warned"), [(9, 9, False), (10, 9, True), (9, 10, True)])
@pytest.mark.parametrize("length", [5, 6, 7])
def test_half_a_run_beside_it_the_trace_has_fallen_by_ten_steps(left, right, warned, length):
    near = [3, 4, 5][: length // 2]
    crest = np.r_[20, left, near[::-1], np.zeros(length), near, right, 20]
    notes = clipping_warning(1000.0 - np.r_[1000, 999, 500, crest, 300])
    assert notes == ([f"{length} samples in a row at the largest value: the record may be clipped"] if warned else [])


@pytest.mark.parametrize(("outside", "warned"), [([], False), ([20], True), ([9], False)])
def test_half_a_run_beside_it_may_lie_beyond_the_record(outside, warned):
    wave = 1000.0 - np.r_[outside, np.zeros(5), 3, 4, 9, 20, 500, 999, 1000]
    assert bool(clipping_warning(wave)) is bool(clipping_warning(wave[::-1])) is warned


@pytest.mark.parametrize("lengths", [(7, 4, 5), (4, 7, 5), (4, 5, 7)])
def test_the_longest_run_is_told(lengths):
    runs = [np.r_[20, 10, 3, 3, 3, np.zeros(length), 3, 3, 3, 9, 20] for length in lengths]
    notes = clipping_warning(1000.0 - np.concatenate([[1000, 999], *runs]))
    assert notes == ["7 samples in a row at the largest value: the record may be clipped"]


def test_one_end_does_not_hide_the_other():
    spread = np.r_[np.tile([1000, 0], 5), np.arange(0, 500, 10), 1]
    (note,) = clipping_warning(np.r_[spread, np.full(6, -300), 0])
    assert note == "6 samples in a row at the smallest value: the record may be clipped"
    (note,) = clipping_warning(-np.r_[spread, np.full(6, -300), 0])
    assert note == "6 samples in a row at the largest value: the record may be clipped"


@pytest.mark.parametrize("amplitude", [20, 150, 1000, 30_000])
@pytest.mark.parametrize("period", [50, 500, 5000])
def test_a_smooth_crest_that_rounding_made_flat_is_no_clipping(amplitude, period):
    crest = np.round(amplitude * np.sin(2.0 * np.pi * np.arange(3 * period) / period))
    assert clipping_warning(crest, "counts") == []


@pytest.mark.parametrize("samples", [np.zeros(100), np.full(100, 7.0), np.r_[np.zeros(50), 1.0, np.zeros(50)]])
def test_a_dead_channel_or_one_step_is_no_clipping(samples):
    assert clipping_warning(samples, "counts") == []


def test_a_record_that_begins_or_ends_clipped():
    clipped = np.minimum(WAVE, 3e5)[12:]
    for trace in (clipped, clipped[::-1]):
        assert clipping_warning(trace, "counts")


@pytest.mark.parametrize(
    ("peak", "expected"),
    [(8_368_524, 1), (8_388_608, 1), (8_388_609, 0), (0.99 * 2**23, 1), (8_304_721, 0), (16_000_000, 0)],
)
def test_counts_at_the_end_of_24_bits(peak, expected):
    trace = np.r_[np.arange(100.0), -float(peak), np.arange(50.0)]
    assert len(clipping_warning(trace, "counts")) == expected
    assert clipping_warning(trace, "g") == []


@pytest.mark.parametrize("write", [csmip_equal, lambda values: smc(values, "1 UNCORRECTED ACCELEROGRAM")])
def test_raw_text_formats_warn(write):
    whole, clipped = (read(io.BytesIO(write(np.round(wave, 6))))[0] for wave in (pulse(), np.minimum(pulse(), 0.2)))
    assert not [note for note in whole.warnings if "clipped" in note]
    assert "samples in a row at the largest value: the record may be clipped" in " ".join(clipped.warnings)


def test_counts_warn_once():
    clipped = np.minimum(np.round(pulse(peak=5e5)), 3e5).astype(int)
    (record,) = read(io.BytesIO(knet(clipped, peak_gal=67.0)))
    assert sum("clipped" in note for note in record.warnings) == 1


def test_corrected_volumes_do_not():
    (record,) = read(io.BytesIO(at2(np.minimum(pulse(), 0.2))))
    assert not [note for note in record.warnings if "clipped" in note]


def test_the_real_clipped_record(records_folder, tmp_path):
    name = "HV.HSSD..HHE__20190414T030832Z__20190414T031602Z.mseed"
    shutil.copy(records_folder / "mseed_clipped" / name, tmp_path)
    station = station_xml("made up", [("HHE", 90.0, 0.0)], gain=1e6)
    station = station.replace(b'"CI"', b'"HV"').replace(b'"CLC"', b'"HSSD"')
    (tmp_path / "HV.HSSD.xml").write_bytes(station)
    (record,) = read(tmp_path / name)
    assert any("where the range of a 24-bit recorder ends" in note for note in record.warnings)
