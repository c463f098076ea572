"""COSMOS 1.20: series, units, gains, intervals, directions, damaged files."""

from datetime import UTC, datetime

import numpy as np
import pytest
from record_writers import pulse
from record_writers.cosmos import cosmos, counts, series

from rockpulse.errors import RecordFormatError, RecordRefused, UnitError
from rockpulse.readers import read
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

G = STANDARD_GRAVITY
CM = {"what": "acceleration", "unit": "cm/sec2", "code": "(04),", "layout": "(8F10.5)", "field": "{:10.5f}"}
NAME = "test.V1C"


def test_an_uncorrected_channel(write):
    values = np.round(pulse(403), 6)
    (record,) = read(write(cosmos(values)))
    assert record.acceleration == pytest.approx(G * values, abs=1e-12)
    assert (record.dt, record.processed, record.source_unit, record.format) == (0.005, False, "g", "cosmos")
    assert (record.orientation, record.azimuth, record.component) == ("horizontal", 0.0, "360 deg")
    assert record.start_time == datetime(2018, 8, 29, 2, 33, 7, 250000, tzinfo=UTC)
    assert record.id == "CE.23837..HNN@20180829T023307"
    assert record.station_name == "Pomona - Orange Grove & Fairplex"
    assert record.event == "Tue Aug 28, 2018 19:33:00.0 PDT"
    assert record.header_peak == pytest.approx(0.3 * G, abs=1e-6)
    assert record.warnings == ()


def test_the_closing_line_of_older_files(write):
    content = cosmos(pulse(), close="/&  ----------  End of data for channel {:2d}  ----------", end="\n")
    second = content.replace(b"360 deg", b" 90 deg").replace(b"     360", b"      90").replace(b"Chan  1:", b"Chan  2:")
    assert read(write(content + second))[1].npts == 400


def test_corrected_acceleration_beside_velocity_and_displacement(write):
    values = np.round(pulse(100, 150.0), 5)
    sections = [
        series(values, 0.01, **CM),
        series(values, 0.01, **CM | {"what": "velocity", "unit": "cm/sec", "code": "(05),"}),
        series(values, 0.01, **CM | {"what": "displacement", "unit": "cm", "code": "(06),"}),
    ]
    (record,) = read(write(cosmos(values, kind="Corrected acceleration", dt=0.01, sections=sections)))
    assert record.acceleration == pytest.approx(0.01 * values, rel=1e-12)
    assert (record.processed, record.dt, record.source_unit, record.warnings) == (True, 0.01, "cm/s2", ())


def test_a_channel_of_another_kind_is_left_out_with_a_warning(write):
    other = cosmos(pulse(), kind="Corrected velocity", number=2)
    (record,) = read(write(cosmos(pulse()) + other))
    assert "another channel of the file is left out" in record.warnings[-1]


@pytest.mark.parametrize(
    ("unit", "code", "factor"),
    [
        ("g.", "(02)", G),
        ("cm/sec2", "(04)", 0.01),
        ("in/sec2", "(07)", 0.0254),
        ("gal", "(10)", 0.01),
        ("mg", "(11)", 1e-3 * G),
        ("ug", "(12)", 1e-6 * G),
        ("", "(04)", 0.01),
        ("mm/sec2", "", 0.001),
    ],
)
def test_units_by_name_and_by_code(write, unit, code, factor):
    (record,) = read(write(cosmos(pulse(), unit=unit, code=code)))
    assert record.unit_factor == pytest.approx(factor, rel=1e-12)
    assert record.pga == pytest.approx(0.3 * factor, rel=1e-5)


def test_counts_with_every_factor_of_the_gain(write):
    number = np.round(pulse(400, 100_000.0)).astype(int) - 160_916
    (record,) = read(write(counts(number)))
    assert record.acceleration == pytest.approx(number * 0.298024e-6 / 1.25 * G, rel=1e-12)
    assert (record.source_unit, record.processed, record.warnings) == ("counts", False, ())


@pytest.mark.parametrize(
    "reals",
    [{43: -999}, {44: 0}, {42: 0.3125, 47: 4.0}, {42: 0.3125, 47: 4.0, 43: 0.625, 44: 0.5}, {42: 1.2553, 43: 2.5106}],
)
def test_gains_that_the_header_confirms_or_does_not_question(write, reals):
    (record,) = read(write(counts(np.arange(100), reals=reals)))
    assert record.unit_factor == pytest.approx(0.298024e-6 / 1.25 * G, rel=0.01)


@pytest.mark.parametrize(
    ("arguments", "channel"),
    [({"component": "", "azimuth": 75}, "1"), ({"number": 7}, "360"), ({"number": 7, "site": 10}, "7")],
)
def test_a_channel_without_a_code_of_seed(write, arguments, channel):
    (record,) = read(write(cosmos(pulse(), comments=["none"], **arguments)))
    assert record.channel == channel
    assert record.id == f"CE.23837..{channel}@20180829T023307"


@pytest.mark.parametrize(
    ("peak", "real", "told"),
    [
        (0.3, 0.306, ""),
        (0.3, 0.3064, "the header states peaks of 0.3 g (text) and 0.3064 g (floating-point value 64)"),
        (0.3, 0.2936, "the header states peaks of 0.3 g (text) and 0.2936 g (floating-point value 64)"),
        (0.004, 0.00449, ""),
        (0.004, 0.00456, "the header states peaks of 0.004 g (text) and 0.00456 g (floating-point value 64)"),
        (0.0044, -999, ""),  # for which the text has 0.004
    ],
)
def test_the_peaks_of_the_text_and_of_the_reals(write, peak, real, told):
    (record,) = read(write(cosmos(pulse(peak=peak), reals={64: real})))
    assert "".join(record.warnings[:1]).startswith(told)
    assert [warning for warning in record.warnings if "value 64)" in warning] == ([told] if told else [])
    if real == -999:
        assert record.header_peak == pytest.approx(0.004 * G, rel=1e-12)
        assert record.warnings == ()


def test_a_peak_in_m_s2_is_no_peak_in_counts(write):
    content = cosmos(pulse(peak=3.0), unit="mm/sec2", code="", reals={64: 3.0})
    content = content.replace(b"0.003 mm/sec2", b"0.003 m/sec2 ").replace(b"3.000 mm/sec2", b"0.006 m/sec2 ")
    (record,) = read(write(content))
    assert "the header states peaks of 0.0006118 g (text) and 0.0003059 g (floating-point value 64)" in record.warnings


@pytest.mark.parametrize(
    ("reals", "dt", "warned"),
    [
        ({34: 0.005, 62: 10.0, 63: 4.0}, 0.01, True),
        ({34: 0.01, 62: 5.0, 63: 3.99}, 0.01, True),
        ({34: -999, 63: -999}, 0.01, False),
        ({34: -999, 62: 20.0, 63: -999}, 0.02, True),
        ({62: -999, 63: -999}, 0.005, False),
        ({34: 0.007813, 63: 3.125}, 0.0078125, False),
        ({63: 4.0}, 0.005, True),
        ({63: 2.017}, 0.005, False),
        ({63: 2.018}, 0.005, True),
        ({63: 1.983}, 0.005, False),
        ({63: 1.982}, 0.005, True),
        ({62: -1.0, 63: -999}, 0.005, False),
        ({34: 0.010009}, 0.01, False),
    ],
)
def test_the_interval_is_that_of_the_series_not_of_the_raw_record(write, reals, dt, warned):
    (record,) = read(write(cosmos(pulse(), dt=dt / 2.0 if 20.0 in reals.values() else dt, reals=reals)))
    assert record.dt == pytest.approx(dt, rel=1e-12)
    assert bool(record.warnings) is warned


@pytest.mark.parametrize(("number", "scale"), [(13, "Mw"), (14, "Ms"), (15, "ML"), (16, "")])
def test_the_facts_of_the_header(write, number, scale):
    reals = {1: 34.5, 2: -117.25, 10: 35.5, 11: -118.75, 12: 7.5, 17: 42.5, number: 6.5}
    (record,) = read(write(cosmos(pulse(), reals=reals, comments=["x", " RcrdId: US.1000hyfh.NP.8040.HNE.01"])))
    assert (record.station_latitude, record.station_longitude) == (34.5, -117.25)
    assert (record.hypocentre_latitude, record.hypocentre_longitude) == (35.5, -118.75)
    assert (record.hypocentre_depth, record.epicentral_distance) == (7500.0, 42500.0)
    assert (record.event_id, record.magnitude, record.magnitude_type) == ("US.1000hyfh", 6.5, scale)


def test_a_sensor_that_may_lie_at_depth_is_named(write):
    (record,) = read(write(cosmos(pulse(), site=50)))
    assert "geotechnical array" in record.warnings[0]


def test_another_null_and_a_null_sample(write):
    content = cosmos(pulse(), unknown="   -888, -888.0", integers={19: -888}, reals={64: -888.0})
    (record,) = read(write(content))
    assert record.header_peak == pytest.approx(0.3 * G, rel=1e-9)  # that of the text
    values = np.round(pulse(400, 50.0), 2)
    values[[100, 250]] = -999.0
    with pytest.raises(RecordRefused, match=r"test.V1C:45: 2 of 400 samples \(the first is sample 101\) are -999"):
        read(write(cosmos(values, **CM)))


def raw(reals=None, integers=None) -> bytes:
    return counts(np.arange(100), reals=reals or {}, integers=integers or {})


@pytest.mark.parametrize(
    ("error", "content", "message"),
    [
        (NotAcceleration, cosmos(pulse(), kind="Corrected velocity"), ":1: expected acceleration, found 'Corrected v"),
        (NotAcceleration, cosmos(pulse(), kind="Corrected velocity", integers={2: 2}), "found 'Corrected velocity'"),
        (NotAcceleration, cosmos(pulse(), what="angular acceleration"), ":45: expected acceleration, found 'angular"),
        (NotAcceleration, raw(integers={52: 1001}), "counts of a velocity sensor"),
        (NotAcceleration, raw(integers={52: 1999}), "counts of a velocity sensor"),
        (RecordRefused, raw({22: -999}), r":48: .* floating-point value 22 \(microvolts per count\); read the V1"),
        (RecordRefused, raw({42: -999, 47: -999}), r"value 42 \(sensor sensitivity, V/g\), 47 \(sensor gain\)"),
        (RecordRefused, raw({47: 0.0}), "lacks floating-point value 47"),
        (RecordRefused, raw({42: 0.625}), "counts with a doubtful gain: .* is 0.625 V/g, .* give 1.25 V/g"),
        (RecordRefused, raw({42: 10.0, 43: 23.0}), "counts with a doubtful gain: .* is 10 V/g, .* give 11.5 V/g"),
        (RecordRefused, raw({47: 4.0, 43: -999}), "counts with a doubtful gain: .* is 5 V/g, .* give nan V/g"),
        (UnitError, cosmos(pulse(), unit="m/sec2", code="(50)"), "the unit has the name 'm/sec2' and the code 50"),
        (RecordFormatError, cosmos(pulse(), integers={2: 2}), "integer 2 of the header says 2, velocity"),
        (RecordFormatError, cosmos(pulse(), integers={2: 10}), "integer 2 of the header says 10, angular acceleration"),
        (RecordFormatError, cosmos(pulse(), reals={34: -999, 62: -999}), ":1: expected a sampling interval above 0"),
        (RecordFormatError, cosmos(pulse(), reals={62: 10.0, 63: 60.0}), "of 0.005 and 0.01 s, .* does not decide"),
        (RecordFormatError, cosmos(pulse(), reals={62: 10.0, 63: -999}), "does not decide between them"),
        (RecordFormatError, cosmos(pulse(), reals={34: 0.005006}), "of 0.005006 and 0.005 s, .* does not decide"),
        (RecordFormatError, cosmos(pulse(), sections=[["j" * 70, *series(pulse())]]), rf":45: .* found '{'j' * 60}';"),
        (
            RecordFormatError,
            cosmos(pulse())[: cosmos(pulse()).index(b"     400 accel")],
            ":45: .* the end of the chann",
        ),
        (RecordFormatError, cosmos(pulse())[: cosmos(pulse()).index(b"(8f9.6)") + 7], ":45: expected 400 .*, found 0"),
        (
            RecordFormatError,
            cosmos(pulse(), sections=[series(pulse()), series(2.0 * pulse())]),
            r":96: expected one series of acceleration in the channel, found a second one \(the first is in line 45",
        ),
        (RecordFormatError, cosmos(pulse(), count=0), "expected a positive number of samples"),
        (RecordFormatError, cosmos(pulse(), count=999999999), "expected"),
        (RecordFormatError, cosmos(pulse())[:1500], r":\d+: expected 100 numbers"),
        (RecordFormatError, cosmos(pulse())[:400], "expected 13 text lines"),
        (
            RecordFormatError,
            b"\n".join(cosmos(pulse()).splitlines()[:13]),
            "number of integer values .*, found the end",
        ),
        (RecordFormatError, cosmos(pulse(), sections=[]), ":45: expected a line such as '13400 acceleration pts"),
        (RecordFormatError, cosmos(pulse())[:-800], "expected 400 numbers"),
        (RecordFormatError, cosmos(pulse()).replace(b"(8f9.6)", b"(8x9.6)"), ":45: expected a format such as"),
        (RecordFormatError, cosmos(pulse()).replace(b"|<SCNL>", b" <SCNL>"), ":44: expected comment 1 of 1"),
        (RecordFormatError, cosmos(pulse()).replace(b"100 Real-", b"100 Bean-"), ":25: expected the number of real"),
        (RecordFormatError, cosmos(pulse()).replace(b" 0.000000", b" 0.0o0000"), ":46: expected a finite number"),
    ],
)
def test_damage_is_named(write, error, content, message):
    with pytest.raises(error, match=message) as refusal:
        read(write(content))
    assert type(refusal.value) is error
