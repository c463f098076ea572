"""Marks of doubtful peaks, made of what the readers really say."""

import numpy as np

from rockpulse.readers.kit.channel import build_record
from rockpulse.readers.source import SourceFile
from rockpulse.remark import with_codes
from rockpulse.views.shared.record_marks import doubt, doubt_notes
from rockpulse.views.shared.table import Cell, Mark


def signs(pga, codes):
    return Cell("", marks=doubt(pga, codes)).marked


def read(samples, unit="g", **header):
    """A record as a reader makes it."""
    return build_record(
        SourceFile("a.txt", b"x", lambda: b"x"),
        1,
        np.asarray(samples),
        0.01,
        unit,
        format="test",
        processed=False,
        **header,
    )


def test_the_remarks_of_the_readers_are_marked():
    wave = 0.3 * np.round(1000.0 * np.sin(0.2 * np.arange(100))) / 1000.0
    for samples, header, expected in (
        (wave, {}, ""),
        (wave, {"header_peak": (0.4, 0.0), "peak_factor": 9.80665}, ""),
        (wave, {"header_peak": (0.5, 0.0), "peak_factor": 9.80665}, " (peak?)"),
        (np.minimum(wave, 0.21), {}, " (clipped?)"),
        (1000.0 * wave, {}, " (peak?)"),
        (1e-7 * wave, {}, " (peak?)"),
    ):
        record = read(samples, **header)
        assert signs(record.pga, with_codes(record.warnings)[1]) == expected, record.warnings


def test_peaks_out_of_all_bounds_are_marked_and_explained_once():
    found = [signs(pga, "") for pga in (0.0, 5e-6, 2e-5, 49.0, 49.1, np.nan)]
    assert found == [" (peak?)", " (peak?)", "", "", " (peak?)", ""]
    assert signs(60.0, "plain clipped") == " (peak?) (clipped?)"
    assert signs(6.0, "of_vertical/full_scale of_channel/header_peak") == " (peak?) (clipped?)"
    doubtful = [Cell(name, marks=doubt(60.0, "")) for name in "ab"]
    assert [note[:8] for note in doubt_notes(doubtful)] == ["(peak?):"]
    assert doubt_notes([Cell("a"), Cell("b (peak?)", marks=(Mark("?", "?: another"),))]) == []
