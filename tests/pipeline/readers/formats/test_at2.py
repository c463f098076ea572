"""PEER AT2 and files like it (SHAKE2000, NRC, RspMatch): spellings of the header, number layouts, refused series."""

import io
import math
import time

import numpy as np
import pytest
from record_writers import at2, pulse
from record_writers.columns import wrapped
from source_files import make_zip

from rockpulse.errors import RecordFormatError, RockpulseError, UnitError
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.formats.at2 import is_at2
from rockpulse.record.record import STANDARD_GRAVITY

NAME = "RSN1.AT2"


@pytest.mark.parametrize(
    "line",
    [
        "NPTS= {n:6d}, DT= {dt:.4f} SEC,",
        "{n}    {dt:.4f}    NPTS, DT",
        "{n}  .01000 SEC  NPTS,DT",
        "NUMBER OF POINTS= {n}, TIME STEP= .01",
        "  {n}   {dt:.5f}",
        "{n}, .01 SEC",
        "DT= {dt:.3f}, NPTS= {n}",
        "NPTS, DT = {n}, {dt}",
        "npts: {n}  dt: 1.0E-2",
        "NPTS= {n}, DT= 1.E-2 SEC,   0 POLE @    30.00000 HZ,  -5 POLE @      .12000",
        "NPTS= {n}, DT= 0.1D-01 SEC",
        "NPTS, DT (SEC): {n}, 0.01",
        "{n}, .010, NPTS,DT",
        "NPTS= {n}, DT(s)= 0.01",
        "{n}    0.01000 NPTS, DT\n(5E15.7)",
        "dt= {dt}, npts= {n}",
        "{n} .01 npts, dt",
        "npts, dt = {n}, .01",
        "{n}, .01 sec",
        "NPTS= {n}, DT= .01 SEC" + "\nwords" * 9,
        "NPTS= 5,000, DT= .01 SEC",
        "5,000 .01 NPTS, DT",
        "NPTS, DT = 5,000, 0.01",
    ],
)
def test_spellings_of_count_and_step(write, line):
    values = pulse(5000 if "5,000" in line else 203)
    (record,) = read(write(at2(values, count_line=line)))
    assert (record.npts, record.dt, record.warnings) == (values.size, 0.01, ())
    assert record.acceleration == pytest.approx(values * STANDARD_GRAVITY, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("field", "per_row", "digits"),
    [
        ("{:15.7E}", 5, 1e-8),
        ("{:10.5f}", 8, 1e-5),
        (" {:.8f}", 1, 1e-8),
        # Fields that touch: "-0.12345" fills 8 characters.
        ("{:8.5f}", 10, 1e-5),
        ("{:10.7f}", 8, 1e-7),
        ("{:12.9f}", 6, 1e-9),
        ("{:16.9E}", 5, 1e-9),
    ],
)
@pytest.mark.parametrize("count", [5, 167])
def test_number_layouts_touching_or_not(write, field, per_row, digits, count):
    values = -np.abs(pulse(count)) - 0.00001
    (record,) = read(write(at2(values, field=field, per_row=per_row)))
    assert record.acceleration == pytest.approx(values * STANDARD_GRAVITY, abs=digits * STANDARD_GRAVITY)


@pytest.mark.parametrize(
    ("title", "event", "station", "channel"),
    [
        ("Loma Prieta, 10/18/1989, Gilroy - Gavilan, 67", "Loma Prieta, 10/18/1989", "Gilroy - Gavilan", "67"),
        ("El Centro", "El Centro", "", "1"),
        ("Event, 90", "Event", "", "090"),
        ("Event, Station One, 90", "Event", "Station One", "090"),
        ("Event, 1/2/2003, 90", "Event, 1/2/2003", "", "090"),
        ("Event, 1/2/2003, One, 3/4/2003, 90", "Event, 1/2/2003", "One, 3/4/2003", "090"),
        ("1/2/2003, Station, 90", "1/2/2003", "Station", "090"),
        ("Event, 1/2/2003, Station,", "Event, 1/2/2003", "Station", "1"),
    ],
)
def test_titles_with_and_without_a_date(write, title, event, station, channel):
    (record,) = read(write(at2(pulse(), title=title)))
    assert (record.event, record.station_name, record.id) == (event, station, f"RSN1.{channel.lstrip('0')}")


def test_a_header_without_unit_asks_for_one(write):
    path = write(at2(pulse(), series="ACCELERATION TIME SERIES"))
    with pytest.raises(UnitError, match="option units"):
        read(path)
    assert read(path, units="g")[0].pga == pytest.approx(0.3 * STANDARD_GRAVITY, rel=1e-6)


COLUMNS = "".join(f"{0.01 * index:.2f} {value:.6f}\n" for index, value in enumerate(pulse(1000)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (at2(pulse(), count_line="NPTS= 500, DT= .0100 SEC"), "expected 500 samples .* found 400"),
        (at2(pulse(), count_line="NPTS= {n}, DT= 0.0 SEC"), r"RSN1.AT2:4: expected a positive DT"),
        (at2(pulse(), count_line="NPTS= {n}, DT= 5 MSEC"), r"RSN1.AT2:4: expected a positive DT in s"),
        (at2(pulse(), count_line="NPTS= {n}, DT= .01E SEC"), r"RSN1.AT2:4: expected 'NPTS= 4000"),
        (at2(pulse(), count_line="NPTS= {n}, DT= VARIABLE"), r"RSN1.AT2:4: expected 'NPTS= 4000"),
        (at2(pulse(), series="ACCELERATION IN UNITS OF ELLS"), r"RSN1.AT2:3: unknown unit"),
        (at2([*pulse(20), np.nan, 0.1]), r"RSN1.AT2:9: expected a finite number, found 'NAN'"),
        (at2([], count_line="NPTS= 2, DT= .01 SEC\nno\nnumbers"), r"RSN1.AT2:5: expected a finite number, found 'no'"),
        (at2(pulse())[:150], "expected 400 samples|expected 'NPTS"),
        (at2(pulse(), series="ACCELERATION (FT/SEC/SEC)"), r"RSN1.AT2:3: unknown unit"),
        (at2(pulse(), series="VELOCITY TIME SERIES IN UNITS OF CM/S"), "RSN1.AT2:3: expected an acceleration series"),
        (f"# NPTS= 1000, DT= 0.01\n# units: g\n{COLUMNS}".encode(), r"RSN1.AT2:\d: expected 1000 numbers .* of 2: col"),
        (at2(pulse(206), count_line="NPTS= 200, DT= .01 SEC"), "found 206"),
        (at2(pulse(1000), per_row=1, count_line="NPTS= 998, DT= .01 SEC"), "found 1000"),
        (at2(pulse(5000), count_line="NPTS= 5 000, DT= .01 SEC"), "expected 5 numbers .* found 5000"),
        (at2(pulse(), count_line="NPTS= {n}, DT= 1/200 SEC"), r"RSN1.AT2:4: expected 'NPTS= 4000"),
        (at2(pulse(), count_line=f"DT= .01, NPTS={'1' * 5000}"), "expected 1{180,} samples"),
        (at2(pulse(), count_line=f"NPTS=4, DT=1E{'1' * 100}"), "expected a positive DT"),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises(RockpulseError, match=message):
        read(write(content), units="g")


@pytest.mark.parametrize(
    ("first_line", "processed"),
    [
        ("PEER NGA STRONG MOTION DATABASE RECORD", True),
        ("PEER STRONG MOTION DATABASE RECORD. PROCESSING BY PACIFIC ENGINEERING.", True),
        ("PACIFIC ENGINEERING AND ANALYSIS STRONG-MOTION DATA", True),
        ("CORRECTED RECORD, WRITTEN BY ROCKPULSE", True),
        ("UNCORRECTED RECORD, WRITTEN BY ROCKPULSE", False),
        ("RECORD, WRITTEN BY ROCKPULSE", None),
        ("RAW RECORD OF MY OWN LOGGER", None),
    ],
)
def test_only_files_of_peer_are_known_to_be_corrected(write, first_line, processed):
    (record,) = read(write(at2(pulse(), first_line=first_line)))
    assert record.processed is processed


@pytest.mark.parametrize(
    ("series", "unit"),
    [
        ("ACCELERATION TIME SERIES IN UNITS OF CM/S**2", "cm/s2"),
        ("ACCELERATION TIME SERIES (CM/SEC/SEC)", "cm/s2"),
        ("ACCELERATION [ cm s-2 ]", "cm/s2"),
        ("Acceleration time history, gal (GAL)", "gal"),
        ("ACCELERATION TIME HISTORY IN CM/SEC**2", "cm/s2"),
        ("ACC. TIME HISTORY (GALS)", "gal"),
        ("ACCELERATION IN G", "g"),
        ("ACCELERATION TIME SERIES (CORRECTED)", "mm/s2"),
    ],
)
def test_a_unit_with_or_without_the_word_units_is_believed(write, series, unit):
    series = series.replace(", gal", "")
    (record,) = read(write(at2(pulse(), series=series)), units="mm/s2")
    assert record.source_unit == unit


@pytest.mark.parametrize(
    "line", ["NPTS DT " + "NPTS=1 " * 200_000, "NPTS " + "DT=" + "1" * 1_000_000 + "E", "NPTS, DT = " + "1 " * 500_000]
)
def test_a_header_line_without_end_costs_no_time(write, line):
    path = write(b"a\nb, 1/1/2000, c, " + b"(" * 500_000 + f"\nACCELERATION IN UNITS OF G\n{line}\n0.1 0.2\n".encode())
    begin = time.process_time()
    with pytest.raises(RecordFormatError):
        read(path)
    assert time.process_time() - begin < 1.0


@pytest.mark.parametrize(("word", "azimuth"), [("9", 9.0), ("0", 0.0), ("67", 67.0), ("090", 90.0), ("999", np.nan)])
def test_digits_at_the_end_of_the_title_are_an_azimuth(write, word, azimuth):
    (record,) = read(write(at2(pulse(), title=f"Northridge-01, 1/17/1994, Beverly Hills - 14145 Mulhol, {word}")))
    assert record.orientation == ("unknown" if np.isnan(azimuth) else "horizontal")
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)


PEKNOLD = (
    "Data for El Centro 1940 North South Component (Peknold Version)\n"
    "61 points at equal spacing of 0.02 sec, in the format of 8F10.5, 8 points across in a row\n"
    "The units are (g)\nNPTS=  61, DT= .02000 SEC\n"
)


def test_words_behind_the_numbers_end_them(tmp_path):
    values = np.round(pulse(61), 5)
    rows = "\n".join("".join(f"{value:10.5f}" for value in values[at : at + 8]) for at in range(0, 61, 8)) + "\n"
    path = tmp_path / "elCentro.at2"
    stop = "line 13: the numbers stop at 'Velocity'; 8 rows"
    for behind, told in (("*** End data ***\n", ""), (f"Velocity\n{rows}", stop)):
        path.write_text(PEKNOLD + rows + behind)
        (record,) = read(path)
        assert record.acceleration / STANDARD_GRAVITY == pytest.approx(values, abs=1e-9)
        assert "".join(record.warnings).startswith(told)
        assert bool(told) is bool(record.warnings)
    path.write_text(PEKNOLD + rows + PEKNOLD + rows.replace("1", "2"))
    with pytest.raises(RecordFormatError, match=r"elCentro.at2:13: .* the beginning of another record"):
        read(path)
    path.write_text(PEKNOLD + rows[:200] + "\nEnd\n")
    with pytest.raises(RecordFormatError, match="found 'End'"):
        read(path)


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        (b"PEER\nEvent, Station\nACCELERATION IN UNITS OF G\nNPTS= 400, DT= .0100 SEC\n", True),
        (b"PEER\nEvent, Sta\0tion\nACCELERATION IN UNITS OF G\nNPTS= 400, DT= .0100 SEC\n", False),
        (b"PEER\nEvent, Station\nACCELERATION IN UNITS OF G\nNPTS= 400\n", False),
        (b"PEER\nEvent, Station\nACCELERATION TIME HISTORY IN UNITS OF G\n400 .0100\n", True),
        (b"Event, Station\n400 .0100\n0.1\n0.2\n", False),
        (b"Event, Station\nACCELERATION TIME HISTORY\n400 .0100\n0.1\n0.2\n", False),
        (b"Event, Station\nUNITS ARE G\n400 .0100\n0.1\n0.2\n", False),
        (b"ACCELERATION TIME HISTORY IN UNITS OF G\n400 .0100\n", True),
        (b"words\n" * 9 + b"NPTS= 400, DT= .0100 SEC\n", True),
        (b"words\n" * 10 + b"NPTS= 400, DT= .0100 SEC\n", False),
    ],
)
def test_count_and_interval_in_a_header_of_text_make_the_format(header, expected):
    assert is_at2(header, "a.txt") is expected


HEADS = (
    "Result ID, Spectral Ordinate, Record Sequence Number, MSE, Scale Factor, Tp-Pulse (s), Arias Intensity (m/sec), "
    "Earthquake Name, Year, Station Name, Magnitude, Mechanism, Rjb (km), Rrup (km), Vs30 (m/sec), "
    "Lowest Useable Frequency (Hz), Horizontal-1 Acc. Filename, Horizontal-2 Acc. Filename, Vertical Acc. Filename"
)
ROWS = (
    '1, SRSS, 763, 0.1, 1, -, 1.0, "Loma Prieta", 1989, "Gilroy - Gavilan Coll.", 6.93, Reverse Oblique, 9.19, 9.96, '
    "729.65, 0.25, RSN763_LOMAP_GIL067.AT2, RSN763_LOMAP_GIL337.AT2, RSN763_LOMAP_GIL-UP.AT2",
    '2, SRSS, 1, 0.1, 1, -, 1.0, "Helena, Montana-01", 1935, "Carroll College", 6, strike slip, 2.07, 2.86, -999, '
    "0.2, RSN1_HELENA.A_A-HMC180.AT2, RSN1_HELENA.A_A-HMC270.AT2, ---",
)


def table(*rows, heads=HEADS):
    before = "PEER Ground Motion Database\n\n -- Summary of Metadata of Selected Records --\n"
    after = "\n\n -- Scaled Spectra used --\nPeriod (sec), RSN-763 Horizontal-1 pSa (g)\n0.01,0.36\n"
    return (before + "\n".join([heads, *rows]) + after).encode()


def test_rows_serve_the_files_they_name(tmp_path):
    (tmp_path / "_SearchResults.csv").write_bytes(table(*ROWS))
    title = "Loma Prieta, 10/18/1989, Gilroy - Gavilan Coll., 67"
    (tmp_path / "RSN763_LOMAP_GIL067.AT2").write_bytes(at2(pulse(), title=title))
    (tmp_path / "rsn1_helena.a_a-hmc180.at2").write_bytes(at2(pulse(peak=0.2), title=""))
    (tmp_path / "RSN2.AT2").write_bytes(at2(pulse(peak=0.1)))
    (record,) = read(tmp_path / "RSN763_LOMAP_GIL067.AT2")
    assert (record.magnitude, record.vs30, record.event) == (6.93, 729.65, "Loma Prieta, 10/18/1989")
    # Rjb and Rrup are no epicentral distances, and the list does not say which scale the magnitude has.
    assert math.isnan(record.epicentral_distance)
    assert record.magnitude_type == ""
    (record,) = read(tmp_path / "rsn1_helena.a_a-hmc180.at2")
    assert (record.event, record.station_name) == ("Helena, Montana-01 1935", "Carroll College")
    assert record.magnitude == 6.0
    assert math.isnan(record.vs30)
    (record,) = read(tmp_path / "RSN2.AT2")
    assert math.isnan(record.magnitude)
    assert record.warnings == ()


def test_the_list_is_found_in_archives_and_beside_open_files(tmp_path):
    files = {"in__RSN763_LOMAP_GIL067_dot_AT2": at2(pulse()), "in___SearchResults_dot_csv": table(*ROWS)}
    archive = make_zip(tmp_path / "PEER.zip", **files, out__RSN763_LOMAP_GIL337_dot_AT2=at2(pulse(peak=0.2)))
    records, failures = read_all(archive)
    assert [record.magnitude for record in records] == pytest.approx([6.93, math.nan], nan_ok=True)
    assert [(row.file.rpartition("/")[2], row.kind) for row in failures] == [("_SearchResults.csv", "skipped")]
    (tmp_path / "_SearchResults.csv").write_bytes(table(*ROWS))
    path = tmp_path / "RSN763_LOMAP_GIL337.AT2"
    path.write_bytes(at2(pulse()))
    with path.open("rb") as stream:
        assert read(stream)[0].vs30 == 729.65
    assert math.isnan(read(io.BytesIO(at2(pulse())))[0].vs30)


VALUES = np.round(pulse(400), 6)


@pytest.mark.parametrize(("width", "per_row"), [(10, 8), (11, 7), (12, 5), (13, 6), (14, 5), (15, 5), (16, 5)])
def test_numbers_that_touch_without_a_sign_are_told_apart_by_the_width_that_all_of_them_fit(write, width, per_row):
    """Five fields of 12 characters are as long as six of 10."""
    values = np.abs(pulse(4 * per_row)) + 0.01
    (record,) = read(write(at2(values, field=f"{{:{width}.{width - 6}E}}", per_row=per_row)))
    assert record.acceleration / record.unit_factor == pytest.approx(values, rel=0.1 ** (width - 6))


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
    assert any("an interval of 0.005 s, but line 5 0.01 s" in note for note in record.warnings)
    assert any("scale factor of 1.5" in note for note in record.warnings)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", ""),
        (b"no list at all", ""),
        (table(*ROWS, heads="Result ID, Year"), ""),
        (table(ROWS[0].rpartition(",")[0]), ""),
        (table(ROWS[1]) + ROWS[0].encode(), ""),
        (b'"' + 200_000 * b"x" + b'"\n', "_SearchResults.csv in the same folder cannot be read, magnitude and Vs30"),
    ],
)
def test_a_list_without_the_file_tells_nothing(tmp_path, content, told):
    (tmp_path / "_SearchResults.csv").write_bytes(content)
    path = tmp_path / "RSN763_LOMAP_GIL067.AT2"
    path.write_bytes(at2(pulse()))
    (record,) = read(path)
    assert math.isnan(record.magnitude)
    assert len(record.warnings) == bool(told)
    assert "".join(record.warnings).startswith(told)


def test_the_output_of_rspmatch(write):
    text = b"Time history matched to spectrum: a.tgt\n  400 0.0100 656\n" + wrapped(VALUES, 5, field="{:15.7E}")
    (record,) = read(write(text), units="g")
    assert (record.dt, record.npts) == (0.01, 400)
    with pytest.raises(UnitError, match="do not state their unit"):
        read(write(text))
