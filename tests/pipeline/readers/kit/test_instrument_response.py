"""The sensitivity of an instrument: its unit, its sign, and the gains of the stages."""

from types import SimpleNamespace

import numpy as np
import pytest
from obspy.core.inventory.response import InstrumentSensitivity, PolynomialResponseStage, Response
from scipy.signal import lsim

from rockpulse.errors import RecordFormatError, RecordRefused
from rockpulse.readers import read
from rockpulse.readers.kit.instrument_response import (
    first_stage,
    measured,
    pass_band,
    sensitivity_factor,
    sensitivity_notes,
    without_response,
)
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY


def response(value, unit="M/S**2", gains=(), first="M/S**2"):
    """Stages of some gains, the last first, as a file may hold them."""
    stages = [
        SimpleNamespace(stage_gain=gain, stage_sequence_number=number, input_units=first if number == 1 else "V")
        for number, gain in enumerate(gains, 1)
    ]
    whole = SimpleNamespace(value=value, input_units=unit)
    return SimpleNamespace(instrument_sensitivity=whole, response_stages=stages[::-1] or None)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        *((unit, ("displacement", scale)) for unit, scale in (("M", 1.0), ("cm", 0.01))),
        *((unit, ("velocity", scale)) for unit, scale in (("UM/S", 1e-6), ("nm/sec", 1e-9), ("m s-1", 1.0))),
        *((unit, ("acceleration", scale)) for unit, scale in (("MM/S**2", 0.001), ("M/S/S", 1.0), ("(M/S^2)", 1.0))),
        *((unit, ("acceleration", 0.01)) for unit in ("cm s-2", "Gal", "gals")),
        ("g", ("acceleration", STANDARD_GRAVITY)),
    ],
)
def test_units_of_motion_in_any_spelling(unit, expected):
    quantity, scale = measured("x", unit)
    assert (quantity, scale) == (expected[0], pytest.approx(expected[1], rel=1e-12))
    if quantity == "acceleration":
        assert sensitivity_factor("x", response(-50.0, unit)) == pytest.approx(-scale / 50.0, rel=1e-12)


def test_sensitivities_of_no_acceleration_are_refused():
    for value in (None, 0.0):
        with pytest.raises(RecordRefused, match=r"^x is in counts and its response states no sensitivity"):
            sensitivity_factor("x", response(value))
    with pytest.raises(RecordRefused, match="states no sensitivity"):
        sensitivity_factor("x", SimpleNamespace(instrument_sensitivity=None))
    for value in (float("inf"), float("nan")):
        with pytest.raises(RecordFormatError, match=rf"^x: expected a finite sensitivity .*, found {value}"):
            sensitivity_factor("x", response(value))
    with pytest.raises(NotAcceleration, match=r"^x records CM/S, expected an acceleration"):
        sensitivity_factor("x", response(2.0, "CM/S"))
    with pytest.raises(NotAcceleration, match=r"^x records hPa, expected ground motion"):
        measured("x", "hPa")
    with pytest.raises(RecordRefused, match="unknown input unit None"):
        measured("x", None)


@pytest.mark.parametrize(
    ("value", "unit", "gains", "first", "told"),
    [
        (600.0, "M/S**2", (2.0, None, 300.0), "M/S**2", ""),
        (600.0, "M/S**2", (), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 314.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 320.0), "M/S**2", "differs from the sensitivity of the response by 6.67 %"),
        (6.0, "CM/S**2", (2.0, 300.0), "M/S**2", ""),
        (600.0, "M/S**2", (2.0, 3.0), "CM/S**2", ""),
        (600.0, "M/S", (2.0, 300.0), "M/S**2", "for velocity, but the stages of the response begin with acceleration"),
        (600.0, "COUNTS", (2.0, 300.0), "CM/S**2", ""),
        (600.0, "M/S**2", (2.0, float("nan")), "M/S**2", "by nan %"),
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_sensitivity_against_the_gains_of_the_stages(value, unit, gains, first, told, sign):
    signed = tuple(gain and gain * (sign if number == 0 else 1.0) for number, gain in enumerate(gains))
    notes = sensitivity_notes(response(sign * value, unit, signed, first))
    assert notes[: len(notes) - bool(told)] == (
        [f"the sensitivity is negative, {-value:g}: the polarity is reversed"] if sign < 0.0 else []
    )
    assert not told or notes[-1].endswith(told)


def test_the_first_stage_is_that_of_the_lowest_number():
    assert first_stage(response(1.0, gains=(7.0, 8.0, 9.0))).stage_gain == 7.0


pytestmark = pytest.mark.filterwarnings("ignore:ObsPy can not map unit", "ignore:The unit .* is not known to ObsPy")

DT, COUNT = 0.01, 4000
TIME = DT * np.arange(COUNT)
#: Corner [rad/s], damping and counts per unit of the sensors.
CORNER, DAMPING, GAIN = 2.0 * np.pi, 0.7, 5.0e4
POLES = [CORNER * (-DAMPING + sign * 1j * np.sqrt(1.0 - DAMPING**2)) for sign in (1.0, -1.0)]


def wavelet(time, frequency, centre):
    """An acceleration that begins and ends at rest, without a net velocity, and has a band of its own."""
    phase = (np.pi * frequency * (time - centre)) ** 2
    return (1.0 - 2.0 * phase) * np.exp(-phase)


def paz(zeros, poles, unit, frequency=5.0):
    response = Response.from_paz(
        zeros, poles, GAIN, frequency, input_units=unit, output_units="COUNTS", normalization_frequency=frequency
    )
    at = 2j * np.pi * frequency
    answer = np.prod([at - zero for zero in zeros]) / np.prod([at - pole for pole in poles])
    response.response_stages[0].normalization_factor = 1.0 / abs(answer)
    response.instrument_sensitivity.value = GAIN
    return response


@pytest.mark.sweep
def test_a_velocity_sensor_gives_back_the_acceleration():
    fine = DT / 20.0 * np.arange(20 * COUNT)
    truth = wavelet(TIME, 2.0, 15.0)
    # Seismometer: velocity in, gain s^2 / (s^2 + 2 h w s + w^2); from acceleration one s less. In the time domain.
    system = ([1.0, 0.0], [1.0, 2.0 * DAMPING * CORNER, CORNER**2])
    _, output, _ = lsim(system, wavelet(fine, 2.0, 15.0), fine)
    scale = GAIN / abs((10j * np.pi) ** 2 / np.polyval(system[1], 10j * np.pi))  # GAIN holds at 5 Hz
    removed = without_response("test", scale * output[::20], DT, paz([0.0, 0.0], POLES, "M/S"))
    # The pass band begins at 0.1 Hz, where the answer has fallen to a hundredth.
    assert removed.samples * removed.factor == pytest.approx(truth, abs=1e-3)
    assert "M/S to m/s2" in removed.processing[0]
    assert removed.warnings == (
        "the sensor records velocity, which was differentiated: check that it did not reach its limit",
        "the pass band begins at 0.101 Hz: impulses longer than about 2 s are reduced; use an accelerometer for "
        "near-fault pulses",
    )


def test_the_impulses_that_a_geophone_damps_are_those_the_warning_names():
    sensor = paz([0.0, 0.0], POLES, "M/S")
    band = pass_band(sensor, DT, COUNT)
    longest = 0.2 / band[1]
    shares = []
    for duration in (0.5 * longest, longest, 2.0 * longest):
        # One cycle of a sine from rest, as counts of the geophone: two half-waves of the duration.
        motion = np.where(np.abs(TIME - 20.0) < duration, np.sin(np.pi * (TIME - 20.0) / duration), 0.0)
        frequency = np.fft.rfftfreq(COUNT, DT)
        answer = sensor.get_evalresp_response_for_frequencies(frequency, output="ACC")
        counts = np.fft.irfft(np.fft.rfft(motion) * np.nan_to_num(answer), COUNT)
        removed = without_response("test", counts, DT, sensor)
        back = removed.samples * removed.factor
        half = motion > 0.0
        shares.append(np.sum(back[half]) / np.sum(motion[half]))
        assert "impulses longer than about 2 s are reduced" in removed.warnings[-1]
    assert shares[0] > 0.98
    assert 0.9 < shares[1] < 0.98
    assert shares[2] < 0.9


@pytest.mark.parametrize(
    ("unit", "scale", "frequency"),
    [
        *(("CM/S**2", 0.01, 1.0), ("NM/S**2", 1e-9, 1.0), ("M/S^2", 1.0, 1.0), ("GAL", 0.01, 1.0)),
        *(("G", STANDARD_GRAVITY, 1.0), ("M/S**2", 1.0, 0.05), ("M/S**2", 1.0, 0.3), ("M/S**2", 1.0, 5.0)),
    ],
)
def test_an_accelerometer_in_any_unit_keeps_pulses_of_any_length_without_a_false_warning(unit, scale, frequency):
    motion = wavelet(TIME, frequency, 20.0)
    # Second-order accelerometer at 200 Hz: its answer to these pulses is a delay of 2 h / w = 1.1 ms.
    corner = 2.0 * np.pi * 200.0
    poles = [corner * (-DAMPING + sign * 1j * np.sqrt(1.0 - DAMPING**2)) for sign in (1.0, -1.0)]
    counts = GAIN / scale * wavelet(TIME - 2.0 * DAMPING / corner, frequency, 20.0)
    removed = without_response("test", counts, DT, paz([], poles, unit, 1.0))
    assert removed.warnings == ()
    assert removed.samples * removed.factor == pytest.approx(motion - motion.mean(), abs=2e-3)
    assert removed.factor == pytest.approx(scale / GAIN, rel=1e-3)
    assert f"{unit} to m/s2" in removed.processing[0]
    assert "pass band from 0 Hz to 40 Hz" in removed.processing[0]


def test_the_response_that_was_given_stays_as_it_is_and_a_sensitivity_that_contradicts_it_is_told():
    response = paz([], POLES, "MM/S**2", 0.2)
    response.instrument_sensitivity.value *= -0.9
    polarity, share = without_response("test", 1e4 * wavelet(TIME, 1.0, 20.0), DT, response).warnings
    assert "the polarity is reversed" in polarity
    assert "by 11.1 %" in share
    assert response.response_stages[0].input_units == "MM/S**2"


def test_the_pass_band_follows_sensor_and_record():
    sensor, accelerometer = paz([0.0, 0.0], POLES, "M/S"), paz([], POLES, "M/S**2", 0.2)
    assert pass_band(sensor, DT, COUNT) == pytest.approx((0.05, 0.1, 40.0, 47.5), rel=0.03)
    assert pass_band(sensor, DT, 500)[:2] == pytest.approx((0.1, 0.2))  # one cycle in 5 s
    assert pass_band(accelerometer, DT, COUNT)[0] < 0.0
    # This one falls to a hundredth at 10 Hz.
    assert pass_band(accelerometer, DT, COUNT)[2:] == pytest.approx((8.0, 9.5), rel=0.03)


def test_a_response_that_does_not_serve_is_refused():
    counts = 1e4 * wavelet(TIME, 1.0, 20.0)
    sensitivity = InstrumentSensitivity(GAIN, 1.0, input_units="M/S**2", output_units="COUNTS")
    with pytest.raises(RecordRefused, match="no stages of the response"):
        without_response("test", counts, DT, Response(instrument_sensitivity=sensitivity))
    with pytest.raises(NotAcceleration, match="test records PA, expected ground motion"):
        without_response("test", counts, DT, paz([], POLES, "PA"))
    with pytest.raises(RecordRefused, match="unknown input unit 'V' of the response; expected M, M/S"):
        without_response("test", counts, DT, paz([], POLES, "V"))
    stage = PolynomialResponseStage(1, 1.0, 1.0, "M/S**2", "V", 0.0, 1.0, 0.0, 1.0, 0.0, [0.0, 2.0])
    with pytest.raises(RecordRefused, match="polynomial"):
        without_response("test", counts, DT, Response(instrument_sensitivity=sensitivity, response_stages=[stage]))
    with pytest.raises(RecordRefused, match="2 samples are too few to remove the response"):
        without_response("test", counts[:2], DT, paz([0.0, 0.0], POLES, "M/S"))
    broken = paz([], POLES, "M/S**2")
    broken.response_stages[0].normalization_factor = None
    with pytest.raises(RecordFormatError, match="obspy cannot evaluate the response"):
        without_response("test", counts, DT, broken)


@pytest.mark.parametrize(("channel", "share"), [("HNE", 0.04), ("HNN", 0.01)])
def test_a_real_accelerometer_with_and_without_its_response(records_folder, channel, share):
    path = records_folder / "mseed_xml" / f"CI.WCS2..{channel}.mseed"
    (plain,), (removed,) = read(path), read(path, response="remove")
    motion = plain.acceleration - plain.acceleration.mean()
    # The response is that of an EpiSensor: 1 % above its sensitivity at 10 Hz, and late by 2 ms.
    assert removed.pga == pytest.approx(np.max(np.abs(motion)), rel=share)
    spectra = [np.fft.rfft(values) for values in (motion, removed.acceleration)]
    frequency = np.fft.rfftfreq(plain.npts, plain.dt)
    for low, high, tolerance in ((0.01, 0.1, 1e-3), (0.1, 1.0, 0.008), (1.0, 5.0, 0.04)):
        band = (frequency >= low) & (frequency < high)
        gap = np.linalg.norm(spectra[1][band] - spectra[0][band]) / np.linalg.norm(spectra[0][band])
        assert gap < tolerance, (low, high)
    velocities = [np.max(np.abs(np.cumsum(values))) * plain.dt for values in (motion, removed.acceleration)]
    assert velocities[1] == pytest.approx(velocities[0], rel=3e-3)
    assert removed.processing[0].startswith("instrument response removed, M/S**2 to m/s2: mean removed, pass band")
    assert removed.unit_factor == pytest.approx(plain.unit_factor, rel=1e-4)


def test_what_the_c_library_prints_becomes_a_warning_of_the_record(records_folder, capfd):
    (record,) = read(next((records_folder / "mseed_xml").glob("AV.CKT*.mseed")), response="remove")
    assert capfd.readouterr().err == ""
    assert [warning for warning in record.warnings if "FIR normalized" in warning]
