"""ASA (Mexico: UNAM, CIRES): channels from the header, accents, times across midnight, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.asa import asa

from rockpulse.errors import RecordFormatError, RockpulseError
from rockpulse.readers import read

TABLE = np.round(np.column_stack([pulse(400, 5.0), pulse(400, -12.0), pulse(400, 9.0)]), 3)
TITLE = b"ARCHIVO ESTANDAR DE ACELERACION"
NAME = "test.012"


def test_the_three_channels(write):
    records = read(write(asa(TABLE)))
    for record, column in zip(records, TABLE.T, strict=True):
        assert record.acceleration == pytest.approx(0.01 * column, abs=1e-12)
        assert (record.dt, record.processed, record.source_unit, record.warnings) == (0.004, False, "gal", ())
        assert record.header_peak == pytest.approx(record.pga, abs=5.1e-5)
    assert [record.component for record in records] == ["V", "N90E", "N00E"]
    assert [record.orientation for record in records] == ["vertical", "horizontal", "horizontal"]
    assert (records[1].azimuth, records[2].azimuth) == (90.0, 0.0)
    assert records[1].id == ".CLC..N90E@20040102T000001"
    assert (records[0].station, records[0].station_name) == ("CLC", "China Lake")
    assert records[0].event == "2004/01/01 23:58:02.7 Mw=7.1"


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "cp850", "mac-roman"])
def test_accents_in_any_encoding(write, encoding):
    content = asa(TABLE, encoding=encoding)
    assert TITLE not in content
    assert [record.azimuth for record in read(write(content))][1:] == [90.0, 0.0]


@pytest.mark.parametrize(
    ("date", "origin", "start", "expected"),
    [
        ("2004/01/01", "23:58:02.7", "00:00:01", datetime(2004, 1, 2, 0, 0, 1, tzinfo=UTC)),
        ("2004/01/02", "00:00:12.0", "23:59:58.5", datetime(2004, 1, 1, 23, 59, 58, 500000, tzinfo=UTC)),
        ("1985/09/19", "13:17:47,4", "13:18:30,25", datetime(1985, 9, 19, 13, 18, 30, 250000, tzinfo=UTC)),
        ("1985/09/19", "", "13:18:30", datetime(1985, 9, 19, 13, 18, 30, tzinfo=UTC)),
        *(
            (date, "06:13:40", "06:13:50", datetime(2000, 7, 21, 6, 13, 50, tzinfo=UTC))
            for date in ("21/JUL/2000", "21/07/2000", "2000/07/21", "21-julio-2000")
        ),
        ("1985/09/19", "13:17:47", "", None),
        ("", "13:17:47", "13:18:30", None),
        ("1985/09/19", "13:17:47", "17:18:30", None),
        ("1985/09/19", "13:17:47", "13:78:30", None),
    ],
)
def test_the_first_sample_is_on_the_day_nearest_to_the_earthquake(write, date, origin, start, expected):
    record = read(write(asa(TABLE, date=date, origin=origin, start=start)))[0]
    assert record.start_time == expected
    assert bool(record.warnings) is (expected is None and bool(start))


def test_local_time_and_a_wrong_clock_are_no_start_time(write):
    local = read(write(asa(TABLE, start_key="HORA DE LA PRIMERA MUESTRA (LOCAL)")))[0]
    wrong = read(write(asa(TABLE, quality="Registro digital completo sin tiempo absoluto")))[0]
    assert (local.start_time, wrong.start_time, "does not say that" in local.warnings[0]) == (None, None, True)
    assert [warning[:20] for warning in wrong.warnings] == ["the clock of the rec", "quality of the recor"]


@pytest.mark.parametrize(
    ("word", "orientation", "azimuth", "sign", "noted"),
    [
        ("N90W", "horizontal", 270.0, 1.0, False),
        ("S00E;+", "horizontal", 180.0, 1.0, False),
        ("N00E;-", "horizontal", 180.0, 1.0, True),
        ("V;+", "vertical", np.nan, 1.0, False),
        ("V;-", "vertical", np.nan, -1.0, True),
        ("L", "horizontal", np.nan, 1.0, False),
        ("N00E;?", "horizontal", 0.0, 1.0, True),
        ("N90W;-", "horizontal", 90.0, 1.0, True),
        ("C-5", "unknown", np.nan, 1.0, False),
    ],
)
def test_directions_and_senses(write, word, orientation, azimuth, sign, noted):
    record = read(write(asa(TABLE, words=(word, "T", "N45E"))))[0]
    assert record.orientation == orientation
    assert record.azimuth == pytest.approx(azimuth, nan_ok=True)
    assert record.acceleration == pytest.approx(sign * 0.01 * TABLE[:, 0], abs=1e-12)
    assert bool(record.warnings) is noted


@pytest.mark.parametrize(
    ("before", "after", "note"),
    [
        (b"/400/400/400", b"/398/398/398", "the header states 398 samples, but the file has 400 rows; all are kept"),
        (b"CANALES                      : 3", b"CANALES                      : 6", "the header states 6 channels, but"),
    ],
)
def test_other_counts_in_the_header_are_told(write, before, after, note):
    record = read(write(asa(TABLE).replace(before, after)))[0]
    assert record.npts == 400
    assert record.warnings[0].startswith(note)


def test_more_than_six_channels(write):
    words = ("V", "N90E", "N00E", "V", "N90E", "N00E", "S45E", "L")
    table = np.round(np.column_stack([pulse(100, 1.0 + number) for number in range(8)]), 3)
    records = read(write(asa(table, words=words, rate=[100] * 6 + [200] * 2, layout="8F10.3")))
    assert [record.dt for record in records] == [0.01] * 6 + [0.005] * 2
    assert [record.channel for record in records] == ["1", "2", "3", "4", "5", "6", "S45E", "L"]
    assert records[7].pga == pytest.approx(0.08)
    assert all(not record.warnings for record in records)


def test_channels_of_different_lengths(write):
    records = read(write(asa(TABLE, counts=(250, 400, 320))))
    assert [record.npts for record in records] == [250, 400, 320]
    for record, column in zip(records, TABLE.T, strict=True):
        assert record.acceleration == pytest.approx(0.01 * column[: record.npts], abs=1e-12)
    assert "different lengths: 250, 400, 320" in records[0].warnings[0]
    content = asa(TABLE, counts=(250, 400, 320)).splitlines()
    content[113] = content[113][:29] + b"x"
    with pytest.raises(RecordFormatError, match=r"test.012:114: expected a finite number"):
        read(write(b"\n".join(content)))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b"CANAL-", b"canal-"),
        (b"3F10.3", b"3f10.3"),
        (b": 3F10.3", b":"),
        (b"ORIENTACION C1-C6", b"O"),
        (b"DATOS DE ACELERACION:\r\n" + b"---------+" * 8 + b"\r\n", b"DATOS DE ACELERACION:\r\n"),
        (b"   CANAL-1", b"-----\r\n   CANAL-1"),
        (b"N00E\r\n" + b"---------+" * 8 + b"\r\n", b"N00E\r\n"),
        (b"DATOS DE ACELERACION:", b"DATOS DE ACELERACION, CANAL 1 A 3:"),
        (b"=" * 80 + b"\r\nDATOS DE ACELERACION:", b"CANAL-2 SIN RUIDO\r\nDATOS DE ACELERACION:"),
        (b"/0.004/0.004/0.004", b"/0/0/0"),
        (b"/250/250/250", b"/252/251/248"),
        (b"NUMERO DE CANALES                      : 3", b"NUMERO DE CANALES                      : x"),
    ],
    ids=str,
)
def test_spellings_of_the_header(write, before, after):
    content = asa(TABLE)
    assert before in content
    records = read(write(content.replace(before, after)))
    for record, column, word in zip(records, TABLE.T, ["V", "N90E", "N00E"], strict=True):
        assert record.acceleration == pytest.approx(0.01 * column, abs=1e-12)
        assert (record.dt, record.component, record.warnings) == (0.004, word, ())


def test_the_facts_of_the_header(write):
    content = asa(TABLE).replace(b"/Mw=7.1", b"/Mb=5.2/Ms=5.8").split(b"\r\n")
    soil = next(index for index, line in enumerate(content) if line.startswith(b"TIPO DE SUELO"))
    content[soil : soil + 3] = [content[soil] + b" ROCA BASALTICA", b" : CON", b" : GRIETAS", b" : Y MAS"]
    for record in read(write(b"\r\n".join(content))):
        assert record.origin_time == datetime(2004, 1, 1, 23, 58, 2, 700_000, tzinfo=UTC)
        assert (record.magnitude, record.magnitude_type) == (5.8, "Ms")
        assert (record.hypocentre_latitude, record.hypocentre_longitude) == (35.77, -117.599)
        assert (record.station_latitude, record.station_longitude) == (35.81574, -117.59751)
        assert (record.hypocentre_depth, record.site_class) == (8_000.0, "ROCA BASALTICA CON GRIETAS")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b"HORA EPICENTRO (GMT)", b"HORA EPICENTRO (LOC)"),
        (b"FECHA DEL SISMO [GMT]", b"FECHA DEL SISMO [LOC]"),
        (b"23:58:02.7", b"tarde"),
        (b"2004/01/01", b"enero"),
    ],
)
def test_an_origin_that_is_not_known_to_be_utc_is_left_out(write, before, after):
    assert read(write(asa(TABLE).replace(before, after)))[0].origin_time is None


SPIKE = np.zeros((100, 3))
SPIKE[50] = 7.0, -5.0, 3.0


@pytest.mark.parametrize(("sample", "told"), [(51, 0), (53, 0), (54, 1), (49, 0), (48, 1)])
def test_the_number_of_the_largest_sample_is_held_against_the_samples(write, sample, told):
    content = asa(SPIKE).replace(b"/51/51/51", b"/51/%d/51" % sample)
    assert [len(record.warnings) for record in read(write(content))] == [0, told, 0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (asa(TABLE, unit="Cuentas"), r"test.012:78: unknown unit of acceleration 'Cuentas'"),
        (asa(TABLE, counts=(4000, 4000, 4000)), r"test.012:509: expected 4000 rows \(header\), found 400"),
        (asa(TABLE).replace(b"/400/400/400", b"/400/x/400"), r"test.012:72: expected 'NUM. TOTAL DE MUESTRAS"),
        (asa(TABLE).replace(b"/400/400/400", b"/400/0/400"), r"test.012:72: expected .* and 3 numbers above 0"),
        (asa(TABLE).replace(b"/400/400/400", b"/400/1/400"), "channel 2: expected at least 2 samples"),
        (asa(TABLE, intervals=(0.004, 0.004, 0.004), rate=(250, 250, 253)), r"test.012:47: expected intervals"),
        (asa(TABLE, layout="FREE"), r"test.012:80: expected the format 3F10.3"),
        (asa(TABLE).replace(b"CANAL-3", b"CANAL-4"), "expected 'NUM. TOTAL DE MUESTRAS"),
        (asa(TABLE).replace(b"CANAL-1", b"%s\r\n" % (b"-" * 80) * 2 + b"CANAL-1"), "expected 'DATOS DE ACELERACION:'"),
        (b"\n".join(asa(TABLE).splitlines()[:109]), "expected 400 rows .* found 0"),
        (b"\n".join(asa(TABLE).splitlines()[:108]), "expected 'DATOS DE ACELERACION:'"),
        (asa(TABLE, intervals=(0, 0, 0), rate=(1e-9, 250, 250)), r"test.012:47: expected intervals"),
        (asa(TABLE, intervals=(0, 0, 0)).replace(b"/250/250/250", b"/0/0/0"), r"found '/0/0/0' and '/0/0/0'"),
        (asa(TABLE).replace(b"NUM. TOTAL DE MUESTRAS", b"N"), r"test.012:1: expected 'NUM. TOTAL DE MUESTRAS"),
        (asa(TABLE, headings=("V", "N00E", "N90E")), r"test.012:108: expected the directions of 3 channels"),
        (asa(TABLE)[:3000], "expected 'DATOS DE ACELERACION:'"),
        (asa(TABLE).replace(b"  0.000    -0.000", b"  0.000    -0.0x0", 1), "test.012:110: expected a finite number"),
        (asa(TABLE).replace(b"  0.000    -0.000", b"  0.000   -0.000", 1), "test.012:110: expected 3 fields of 10"),
    ],
)
def test_damage_is_named(write, content, message):
    with pytest.raises(RockpulseError, match=message):
        read(write(content))


def test_the_line_above_the_values_may_be_a_ruler_of_eight_channels(write):
    content = asa(TABLE)
    line = next(line for line in content.split(b"\n") if b"CANAL-1" in line)
    ruler = b"".join(b"   CANAL-%d" % number for number in range(1, 9))
    expected = [record.acceleration for record in read(write(content))]
    found = [record.acceleration for record in read(write(content.replace(line, ruler + line[len(line.rstrip()) :])))]
    assert np.array_equal(found, expected)


@pytest.mark.parametrize("layout", ["3E16.7", "3(1PE16.7)", "(3E16.7)"])
def test_fields_with_exponents(write, layout):
    content = asa(TABLE)
    lines = content.decode("latin-1").split("\n")
    first = len(lines) - len(TABLE) - (not lines[-1].strip())
    rows = ["".join(f"{value:16.7E}" for value in row) for row in TABLE]
    text = "\n".join([*lines[:first], *rows]) + "\n"
    old = next(line for line in lines if line.startswith("FORMATO DATOS"))
    changed = text.replace(old, f"{old.partition(':')[0]}: {layout}")
    for record, column in zip(read(write(changed.encode("latin-1"))), TABLE.T, strict=True):
        assert record.acceleration == pytest.approx(0.01 * column, abs=1e-9)
