"""Statements above columns that contradict each other or the samples; clocks; tables that are no records."""

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import UNITS, read
from rockpulse.readers.folders import read_all
from rockpulse.readers.format import FileSettings
from rockpulse.readers.source import NotAcceleration, TableOfResults
from rockpulse.warning_text import code_of

VALUES = pulse(400, 100.0)


def table(values=VALUES, times=None, separator=",") -> str:
    times = 0.01 * np.arange(len(values)) if times is None else times
    return "".join(f"{time:.6f}{separator}{value:.6f}\n" for time, value in zip(times, values, strict=True))


@pytest.fixture
def put(tmp_path):
    def write(text: str, name: str = "a.csv"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.mark.parametrize(
    "header",
    [
        "t [s],acc N (m/s2) [cm/s2]\n",
        "t [s],acc N (cm/s2) [m/s2]\n",
        "Units: m/s2\nt [s],acc N [cm/s2]\n",
        "Unit = g\nt [s],acc N (gal)\n",
        "units: m/s2\nunits: gal\n",
        "t [s],acc_cm_s2 [g]\n",
    ],
)
def test_two_units_are_refused_and_both_named(put, header):
    with pytest.raises(UnitError, match=r"states (two units|the unit)") as told:
        read(put(header + table()))
    assert sum(word in str(told.value) for word in ("m/s2", "cm/s2", "cm_s2", "gal", "g")) >= 2


@pytest.mark.parametrize(
    "header",
    [
        *(
            "Data in volts\n",
            "Samples are in counts\n",
            "units: V\n",
            "Unit: counts\n",
            "Units = mm\n",
            "time,N\ns,V\n",
        ),
        *("time,counts\n", "t [s],acc_volts\n", "t [s],acc [V]\n", "t [s],acc N (mV)\n"),
    ],
)
@pytest.mark.parametrize("asked", ["g", "m/s2"])
def test_a_unit_of_no_acceleration_is_refused_with_any_option(put, header, asked):
    with pytest.raises((UnitError, NotAcceleration), match=r"(?i)'(m?v|volts)'|counts|displacement"):
        read(put(header + table()), units=asked)


@pytest.mark.parametrize("header", ["UNITS ARE CM/S2\n", "Unidades: gal\n", "data units: cm/s^2\n", "birim: cm/s2\n"])
def test_a_unit_that_the_word_for_it_states_is_taken(put, header):
    assert read(put(header + table()))[0].unit_factor == 0.01


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("PGA = 0.5 g\n", "states a peak of 0.5 g"),
        ("PGA (cm/s2): 10.0\n", "states a peak of 0.0102 g"),
        ("Peak acceleration = 300\n", "states a peak of 0.3059 g"),
        ("NPTS = 200\n", "mentions 200 samples"),
        ("Number of samples: 800\n", "mentions 800 samples"),
        ("Duration: 8.0 s\n", "a duration of 8 s"),
        ("Record length = 2 s\n", "a duration of 2 s"),
        ("Scale factor: 2.5\n", "scale factor of 2.5"),
    ],
)
def test_a_stated_fact_is_held_against_the_samples_both_ways(put, header, words):
    (record,) = read(put(f"{header}t [s],acc N [cm/s2]\n{table()}"))
    assert any(words in note for note in record.warnings)


def test_facts_that_agree_are_not_told(put):
    header = "PGA = 100.0 cm/s2 at 0.12 s\nNPTS = 400\nDuration: 4 s\nSignificant duration: 1 s\n"
    (record,) = read(put(f"{header}t [s],acc N [cm/s2]\n{table()}"))
    assert record.warnings == ()


def test_a_vertical_that_is_positive_downwards_is_turned(put):
    path = put(f"Z positive down\nt [s],acc Z [cm/s2]\n{table()}")
    assert read(path)[0].acceleration == pytest.approx(-0.01 * np.round(VALUES, 6))


@pytest.mark.parametrize("kind", ["jitter", "drift"])
def test_a_clock_that_is_uneven_is_brought_to_its_mean_interval(put, kind):
    rng = np.random.default_rng(2)
    even = 0.01 * np.arange(1000)
    times = {"jitter": even + rng.uniform(-0.002, 0.002, 1000), "drift": even * (1.0 + 1e-5 * np.arange(1000))}[kind]
    values = np.sin(2.0 * np.pi * 2.0 * times)
    (record,) = read(put("t (s),a (m/s2)\n" + table(values, times)))
    assert "resampled_clock" in [code_of(note) for note in record.warnings]
    assert record.dt == pytest.approx((times[-1] - times[0]) / 999, rel=1e-4)
    at = np.round(times[0], 6) + record.dt * np.arange(1000)
    assert record.acceleration == pytest.approx(np.sin(2.0 * np.pi * 2.0 * at), abs=2e-3)


def test_a_missing_row_and_a_wrong_time_stay_errors(put):
    rng = np.random.default_rng(2)
    times = 0.01 * np.arange(1000) + rng.uniform(-0.002, 0.002, 1000)
    gap = np.delete(times, 500)
    with pytest.raises(RecordFormatError, match="rows are missing"):
        read(put("t (s),a (m/s2)\n" + table(np.ones(999), gap)))
    wrong = 0.01 * np.arange(1000)
    wrong[500] += 0.004
    with pytest.raises(RecordFormatError, match="rows are missing or the times are damaged"):
        read(put("t (s),a (m/s2)\n" + table(np.ones(1000), wrong)))


@pytest.mark.parametrize(
    "stamp", ["2024-01-31T23:59:59.{:03d}Z", '"2024-01-31 23:59:59.{:03d}+00:00"', "23:59:59.{:03d}"]
)
def test_dates_and_times_are_a_column_of_times(put, stamp):
    rows = [f"{stamp.format(10 * at)},{value:.5f}" for at, value in enumerate(pulse(90))]
    (record,) = read(put("timestamp,acc N [g]\n" + "\n".join(rows)))
    assert (record.npts, record.dt, record.azimuth) == (90, 0.01, 0.0)
    assert (record.start_time is None) == (not stamp.strip('"').startswith("2024"))


def test_of_two_columns_of_times_that_in_seconds_is_taken(put):
    rows = "".join(
        f"{1700000000000000000 + 10**7 * at},{0.01 * at:.6f},{value:.5f}\n" for at, value in enumerate(VALUES)
    )
    (record,) = read(put("time,seconds_elapsed,z (cm/s2)\n" + rows))
    assert (record.dt, record.npts) == (0.01, 400)
    assert "columns of times left out: time" in record.warnings[0]


def test_of_two_columns_of_times_in_no_named_unit_the_first_is_taken(put):
    rows = "".join(f"{0.01 * at:.2f},{1000 + 0.02 * at:.2f},{value:.5f}\n" for at, value in enumerate(VALUES))
    (record,) = read(put("time,t,z (cm/s2)\n" + rows))
    assert (record.dt, record.warnings) == (0.01, ("further columns of times left out: t",))


FLAT = "file,NPTS,DT,PGA\nm.AT2,2000,0.01,0.43\nn.AT2,4000,0.005,0.21\n"
NUMBERS = "RSN,Magnitude,Rrup,Vs30\n" + "".join(f"{at},6.{at % 10},{at}.5,3{at:02d}\n" for at in range(60))
OWN = "record,block,model,npts,dt,pga,factor_10\nm.acc_N,wall,sequence,2000,0.01,4.2,0.5\n"


WAVES = "record,wave,start\n" + "m.acc_N,1,0.5\n" * 60


@pytest.mark.parametrize("text", [FLAT, NUMBERS, OWN, WAVES], ids=["flat", "numbers", "own", "half-waves"])
def test_tables_beside_the_records_are_skipped_also_where_they_are_named(put, text):
    path = put(text, "beside.csv")
    with pytest.raises(TableOfResults, match="not a record"):
        read(path, units="g", dt=0.01)
    assert [row.kind for row in read_all([path], units="g", dt=0.01)[1]] == ["skipped"]


def test_a_series_with_a_station_in_its_headings_is_none_of_them(put):
    rows = "".join(f"{0.01 * at:.2f},{value:.4f},1,2\n" for at, value in enumerate(pulse()))
    assert len(read(put("time [s],acc N [g],vs30,pga\n" + rows))) == 1


@pytest.mark.parametrize(("count", "timed"), [(3, False), (2, False), (4, True)])
def test_the_example_of_the_hint_typed_above_the_file_names_its_columns(put, count, timed):
    noise = 1e-3 * np.random.default_rng(4).normal(size=(400, count))
    values = np.outer(0.01 * VALUES, 1.0 + 0.1 * np.arange(count)) + noise
    cells = np.column_stack([0.01 * np.arange(400), values]) if timed else values
    text = "".join(" ".join(f"{value:.5f}" for value in row) + "\n" for row in cells)
    with pytest.raises(RecordFormatError, match="name the columns in the line above") as told:
        read(put(text), units="g", dt=0.01)
    example = str(told.value).rpartition("such as '")[2].partition("'")[0]
    assert len(example.split()) == count + timed
    assert len(read(put(f"{example}\n{text}"), units="g", dt=0.01)) == count


@pytest.mark.parametrize(
    ("name", "channel"), [("a_E.txt", "090"), ("a.NS", "000"), ("a_UP.txt", "UP"), ("a.L", "L"), ("a.txt", "1")]
)
def test_without_headings_the_channel_is_the_direction_or_the_suffix_in_the_name_of_the_file(put, name, channel):
    (record,) = read(put("".join(f"{value:.5f}\n" for value in VALUES), name), units="gal", dt=0.01)
    assert (record.channel, record.id) == (channel, f"{name.partition('.')[0]}.{channel}")


def test_a_column_with_the_magnitude_of_three_components_is_left_out_even_where_it_is_zero(put):
    cells = VALUES[:, np.newaxis] * [1.0, 0.5, -0.2]
    cells[:20] = 0.0
    cells = np.column_stack([cells, np.linalg.norm(cells, axis=1)])
    rows = "".join(",".join(f"{value:.6f}" for value in row) + "\n" for row in cells)
    records = read(put("N [gal],E [gal],Z [gal],all [gal]\n" + rows), dt=0.01)
    assert [record.azimuth for record in records[:2]] == [0.0, 90.0]
    assert [record.orientation for record in records[2:]] == ["vertical"]


def test_the_hint_for_files_of_one_suffix_is_a_row_of_the_configuration(put):
    path = put("".join(f"{value:.5f}\n" for value in VALUES), "a.dat")
    with pytest.raises(UnitError, match=r'\[\[records.file\]\]\nmatch = "\*.dat"\nunits = "g"'):
        read(path)
    with pytest.raises(RecordFormatError, match=r'\nmatch = "\*.dat"\ndt = 0.01'):
        read(path, units="gal")
    chosen = FileSettings(match="*.dat", units="gal", dt=0.01)
    assert len(read_all(path, files=[chosen])[0]) == 1


PLAIN = "".join(f"{value:.5f}\n" for value in VALUES)
ROWS = "".join(" ".join(f"{value:.5f}" for value in row) + "\n" for row in VALUES.reshape(-1, 8))
#: Remedies of one file after the other: unit, interval, and those that the file states.
UNIT, STEP, GAL, HUNDREDTH = ("units", tuple(UNITS)), ("dt", ()), ("units", ("gal",)), ("dt", ("0.01",))


@pytest.mark.parametrize(
    ("text", "given", "remedies"),
    [
        (PLAIN, {}, [[UNIT], [STEP]]),
        (ROWS, {}, [[UNIT, STEP]]),
        ("time [s],acc [gal]\n" + table(), {"units": "g"}, [[GAL]]),
        ("acc\nunit: gal\n" + table(), {"units": "g", "dt": 0.02}, [[GAL], [HUNDREDTH]]),
    ],
)
def test_a_file_is_read_with_the_remedies_of_its_failures(put, text, given, remedies):
    path, settings = put(text), dict(given)
    for expected in remedies:
        files = [FileSettings(match="a.csv", **settings)] if settings else []
        (row,) = read_all(path, files=files)[1]
        assert [(one.key, one.choices) for one in row.remedies] == expected
        for key, choices in expected:
            settings[key] = float((*choices, 0.01)[0]) if key == "dt" else choices[0]
    assert read_all(path, files=[FileSettings(match="a.csv", **settings)])[0]


@pytest.mark.parametrize(("sign", "turned"), [(1.0, ""), (-1.0, " with the opposite sign")])
def test_a_component_whose_samples_are_those_of_another_file_is_told(put, sign, turned):
    put("time (s),acc E (g)\n" + table(0.003 * VALUES), "e.csv")
    path = put("time (s),acc N (g)\n" + table(0.003 * sign * VALUES), "n.csv")
    records, failures = read_all(path.parent)
    assert (len(records), failures) == (2, [])
    for record, other in zip(records, ("n.csv", "e.csv"), strict=True):
        assert f"the samples are those of {other}{turned}: one of them is a copy" in record.warnings
