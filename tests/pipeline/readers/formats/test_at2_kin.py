"""Files like AT2: numbers that touch, headers of SHAKE2000 and NRC, output of RspMatch."""

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import wrapped

from rockpulse.errors import UnitError
from rockpulse.readers import read

VALUES = np.round(pulse(400), 6)
NAME = "a.AT2"
SERIES = "ACCELERATION TIME SERIES IN UNITS OF G"


def test_numbers_that_touch_are_told_apart_at_their_signs(write):
    rows = ["".join(f"{value:13.6E}" for value in VALUES[at : at + 5]) for at in range(0, 400, 5)]
    assert any(row[1:].replace("E-", "").count("-") > row.count(" -") for row in rows)
    head = ["A RECORD", "EQ, 1/1/2000, Nowhere, 90", SERIES, "NPTS=  400, DT= .0100 SEC"]
    text = "\n".join([*head, *rows])
    (record,) = read(write(text.encode()))
    assert record.acceleration / record.unit_factor == pytest.approx(VALUES, abs=1e-9)


def test_a_block_of_shake(write):
    head = [
        '"An Eqk","A Station","H1_90","init. vel:"," .307 c/s"',
        '"Total No. of Points :",400,"@ DT =",.01',
        f'"Peak Acceleration (g) =",{np.max(np.abs(VALUES)):.6f},"@ Time (sec) :",.3',
    ]
    text = "\n".join(head).encode() + b"\n" + wrapped(VALUES, 8, field="{:10.6f}")
    (record,) = read(write(text))
    assert (record.dt, record.npts, record.azimuth, record.source_unit) == (0.01, 400, 90.0, "g")
    assert (record.event, record.station_name, record.warnings) == ("An Eqk", "A Station", ())
    (doubted,) = read(write(text.replace(b'=",0.3', b'=",0.6')))
    assert "states a peak of 0.6" in doubted.warnings[0]


def test_the_header_of_nrc(write):
    head = ["NRC RECORD", "OUTPUT ACCELERATION TIME HISTORY (G'S): NIT = 2", "  16384     DT =      .0050 SEC", "*****"]
    head.append("NPTS=  400, DT= .01000 SEC, SCALED BY 1.5")
    text = "\n".join(head).encode() + b"\n" + wrapped(VALUES, 5, field="{:15.7E}")
    (record,) = read(write(text))
    assert (record.dt, record.npts, record.source_unit) == (0.01, 400, "g")
    assert any("an interval of 0.005 s, line 5 one of 0.01 s" in note for note in record.warnings)
    assert any("scale factor of 1.5" in note for note in record.warnings)


def test_the_output_of_rspmatch(write):
    text = b"Time history matched to spectrum: a.tgt\n  400 0.0100 656\n" + wrapped(VALUES, 5, field="{:15.7E}")
    (record,) = read(write(text), units="g")
    assert (record.dt, record.npts) == (0.01, 400)
    with pytest.raises(UnitError, match="do not state their unit"):
        read(write(text))
