"""K-NET: offset, scale, time and direction, against an independent parse."""

import time
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from record_writers import knet, pulse

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.record.defects import deciding

COUNTS = (np.round(pulse(500, peak=40000.0)) - 18000).astype(int)
NAME = "AKT0139608110312.EW"


def test_obspy_s_own_file_against_an_independent_parse():
    import obspy.io.nied

    path = Path(obspy.io.nied.__file__).parent / "tests" / "data" / "test.knet"
    if not path.exists():
        pytest.skip(f"this obspy comes without its test data ({path})")
    (record,) = read(path)
    counts = np.array(path.read_text().partition("Memo.")[2].partition("\n")[2].split(), dtype=float)
    assert record.npts == counts.size == 5900
    # 2000(gal)/8388608; the offset is the mean; 1 gal = 0.01 m/s2.
    expected = (counts - counts.mean()) * 2000.0 / 8388608.0 * 0.01
    assert record.acceleration == pytest.approx(expected, rel=1e-12, abs=1e-15)
    assert record.pga == pytest.approx(0.04383, abs=0.5e-5)  # Max. Acc. 4.383 gal
    assert record.header_peak == pytest.approx(0.04383)
    # Record Time 1996/08/11 03:12:39 in Japan (UTC + 9 h), which is 15 s after the first sample.
    assert record.start_time == datetime(1996, 8, 10, 18, 12, 24, tzinfo=UTC)
    assert record.id == "BO.AKT013..EW@19960810T181224"
    assert (record.azimuth, record.orientation, record.dt) == (90.0, "horizontal", 0.01)
    assert record.warnings == ()
    assert "offset removed" in record.processing[0]


@pytest.mark.parametrize(("full", "counts"), [(2000, 8388608), (7845, 8223790), (3920.5, 6182761)])
def test_scale_styles(write, full, counts):
    values = (COUNTS - COUNTS.mean()) * full / counts
    (record,) = read(write(knet(COUNTS, scale=f"{full}(gal)/{counts}", peak_gal=np.max(np.abs(values)))))
    assert record.acceleration == pytest.approx(0.01 * values, rel=1e-12, abs=1e-12)
    assert record.warnings == ()


@pytest.mark.parametrize(
    ("name", "component", "orientation"),
    [
        ("A.EW", "EW", "horizontal"),
        ("A.NS2", "NS", "horizontal"),
        ("A.UD", "UD", "vertical"),
        ("A.dat", "EW", "horizontal"),
    ],
)
def test_the_extension_tells_the_direction_and_says_so(write, name, component, orientation):
    (record,) = read(write(knet(COUNTS, peak_gal=11.0), name))
    assert (record.component, record.orientation) == (component, orientation)
    assert any("the file name is used" in warning for warning in record.warnings) is (name not in {"A.EW", "A.dat"})
    assert bool(deciding(record)) is (name == "A.UD")  # the header says E-W


@pytest.mark.parametrize(
    ("number", "channel", "orientation"),
    [("3", "UD1", "vertical"), ("4", "NS2", "horizontal"), ("6", "UD2", "vertical")],
)
def test_the_numbers_of_kik_net_s_directions(write, number, channel, orientation):
    (record,) = read(write(knet(COUNTS, direction=number, peak_gal=11.0), "A.dat"))
    assert (record.channel, record.component, record.orientation) == (channel, channel[:2], orientation)
    assert any("borehole" in warning for warning in record.warnings) is channel.endswith("1")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\n".join(knet(COUNTS).split(b"\n")[:-20]), "expected 500 samples .* found"),
        (b"\n".join(knet(COUNTS).split(b"\n")[:9]), "expected 17 header lines"),
        (knet(COUNTS, scale="2000(gal)/0"), ":14: expected 'Scale Factor'"),
        (knet(COUNTS, scale="0(gal)/8388608"), ":14: expected 'Scale Factor'"),
        (knet(COUNTS).replace(b"Time(s)  5", b"Time(s)  0"), ":11: expected a sampling frequency and a duration that"),
        (knet(COUNTS).replace(b"-18000", b"-18x00", 1), r":18: expected a finite number, found '-18x00'"),
        (knet(COUNTS).replace(b"Station Code", b"Station Cake"), "obspy cannot read it as KNET"),
        (knet(COUNTS).replace(b"100Hz", b"0Hz  "), "expected|obspy cannot read"),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises(RecordFormatError, match=message):
        read(write(content))


@pytest.mark.parametrize(("surplus", "refused"), [(0, False), (99, False), (100, False), (101, True), (443, True)])
def test_more_samples_than_the_duration_are_another_record(write, surplus, refused):
    content = knet(np.append(COUNTS, COUNTS[:surplus])).replace(f"  {(500 + surplus) / 100:g}\n".encode(), b"  5\n")
    if not refused:
        (record,) = read(write(content))
        assert record.npts == 500 + surplus
        said = f"duration and sampling frequency of the header give 500 samples, but the file has {500 + surplus}"
        assert any(note.startswith(said) for note in record.warnings) is (surplus > 0)
        return
    with pytest.raises(RecordFormatError, match=rf"expected 500 .* found {500 + surplus}; .* more than one"):
        read(write(content))


def test_a_scale_factor_of_many_digits_costs_no_time(write):
    path = write(knet(COUNTS, scale="2000" + "1" * 500_000 + "(gal)/8388608"))
    begin = time.process_time()
    with pytest.raises(RecordFormatError, match=r"AKT0139608110312.EW:14: expected 'Scale Factor'"):
        read(path)
    assert time.process_time() - begin < 1.0
