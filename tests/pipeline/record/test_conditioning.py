"""Conditioning: baselines, the filter's response and phase, resampling, and what is written down."""

import logging
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.errors import ConfigError
from rockpulse.record.conditioning import BASELINES, condition, quiet_samples
from rockpulse.record.half_wave import half_waves
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record
from rockpulse.warning_text import find

properties = settings(derandomize=True, deadline=None, max_examples=25)
coefficients = st.tuples(*[st.floats(-5.0, 5.0)] * 3)


def record(values, dt=0.01, processed=False):
    return Record(values, dt=dt, id="test", processed=processed)


def noise(count=2000, seed=1):
    return np.random.default_rng(seed).normal(size=count)


def event(offset=0.0, quiet=15.0, dt=0.01, length=60.0):
    """Faint noise, then from `quiet` on [s] a 2 Hz shaking that begins and ends at rest, all on an offset."""
    time = dt * np.arange(round(length / dt) + 1)
    since = np.maximum(time - quiet, 0.0)
    velocity = 0.1 * np.sin(4.0 * np.pi * since) * since * np.exp(-0.4 * since)
    return record(offset + np.gradient(velocity, dt) + 1e-5 * noise(time.size), dt)


def sine(frequency, dt=0.01, length=40.0, phase=0.3):
    time = dt * np.arange(round(length / dt) + 1)
    return record(np.sin(2.0 * np.pi * frequency * time + phase), dt)


def amplitude_and_phase(motion, frequency, start=10.0, end=30.0):
    """Least-squares sine of one frequency in the middle of a record."""
    inside = (motion.time >= start) & (motion.time <= end)
    angle = 2.0 * np.pi * frequency * motion.time[inside]
    sine_part, cosine_part = np.linalg.lstsq(
        np.column_stack((np.sin(angle), np.cos(angle))), motion.acceleration[inside], rcond=None
    )[0]
    return math.hypot(sine_part, cosine_part), math.atan2(cosine_part, sine_part)


@properties
@given(coefficients, st.integers(3, 500))
@pytest.mark.parametrize(("baseline", "degree"), [("mean", 0), ("linear", 1), ("quadratic", 2)])
def test_polynomial_of_the_degree_is_removed_exactly(baseline, degree, chosen, count):
    time = np.linspace(0.0, 3.0, count)
    values = np.polynomial.polynomial.polyval(time, chosen[: degree + 1])
    conditioned = condition(record(values), baseline=baseline)
    assert np.max(np.abs(conditioned.acceleration)) <= 1e-12 * (1.0 + np.max(np.abs(values)))


@pytest.mark.parametrize("baseline", [name for name in BASELINES if name != "none"])
def test_baseline_removed_twice_is_removed_once(baseline):
    once = condition(event(offset=0.7), baseline=baseline)
    twice = condition(once, baseline=baseline)
    np.testing.assert_allclose(twice.acceleration, once.acceleration, rtol=0, atol=1e-13)
    assert len(twice.processing) == 2


@pytest.mark.parametrize("baseline", BASELINES)
def test_mirrored_record_is_conditioned_to_the_mirror_image(baseline):
    motion = event(offset=0.2)
    mirrored = replace(motion, acceleration=-motion.acceleration)
    options = {"baseline": baseline, "highpass_hz": 0.1, "lowpass_hz": 20.0, "resample_s": 0.02}
    np.testing.assert_array_equal(
        condition(mirrored, **options).acceleration, -condition(motion, **options).acceleration
    )


@pytest.mark.parametrize(
    ("baseline", "note"),
    [
        ("mean", "mean of all samples, 3 m/s2, subtracted"),
        ("linear", "line of all samples, 1 m/s2 at the start, 5 at the end, subtracted"),
    ],
)
def test_the_note_of_a_baseline_says_what_was_subtracted(baseline, note):
    assert condition(record(np.arange(1.0, 6.0)), baseline).processing == (f"baseline: {note}",)


def test_baseline_none_changes_nothing_and_says_nothing():
    conditioned = condition(event(offset=0.7), baseline="none")
    np.testing.assert_array_equal(conditioned.acceleration, event(offset=0.7).acceleration)
    assert conditioned.processing == ()


def test_auto_leaves_a_processed_record_unchanged():
    motion = replace(event(offset=0.7), processed=True)
    conditioned = condition(motion)
    np.testing.assert_array_equal(conditioned.acceleration, motion.acceleration)
    assert conditioned.processing == ("baseline: unchanged, as the record is processed",)


def test_auto_takes_the_pre_event_mean_from_a_raw_record():
    motion = event(offset=0.7)
    conditioned = condition(motion)
    assert conditioned.acceleration == pytest.approx(motion.acceleration - 0.7, abs=1e-5)
    assert conditioned.processing == (
        "baseline: mean of the pre-event window 0 to 15 s (detected), 0.7 m/s2, subtracted",
    )
    assert conditioned.warnings == ()


def test_auto_takes_the_mean_with_one_warning_where_nothing_is_known(caplog):
    motion = replace(event(offset=0.7), processed=None)
    with caplog.at_level(logging.WARNING, logger="rockpulse"):
        conditioned = condition(condition(motion))
    assert conditioned.acceleration == pytest.approx(motion.acceleration - np.mean(motion.acceleration), abs=1e-13)
    assert [warning.partition(":")[0] for warning in conditioned.warnings] == [
        "the format does not state whether the record is processed"
    ]
    assert len(caplog.records) == 1


def test_velocity_that_does_not_come_back_is_a_warning_until_it_does():
    motion = event()
    step = 0.001 * (motion.time > 30.0)
    drifting = condition(condition(replace(motion, acceleration=motion.acceleration + step)))
    assert len(drifting.warnings) == 1
    stated = float(drifting.warnings[0].removeprefix("baseline drift: the ground velocity ends at ").split()[0])
    assert stated == pytest.approx(0.03, rel=0.02)
    assert condition(drifting, "linear").warnings == ()
    assert condition(motion).warnings == ()


def test_pre_event_window_of_raw_records_ends_before_the_shaking(ridgecrest):
    for motion in ridgecrest:
        conditioned = condition(motion)
        length = float(conditioned.processing[0].split(" s (detected)")[0].split()[-1])
        departure = np.abs(motion.acceleration - np.median(motion.acceleration[:500]))
        shaking = motion.dt * np.argmax(departure > 0.01 * np.max(departure))
        assert 10.0 < length < shaking
        assert conditioned.pga == pytest.approx(abs(motion.header_peak), abs=0.01)


def test_pre_event_window_too_short_takes_the_mean_and_says_so():
    conditioned = condition(event(offset=0.7, quiet=0.3), baseline="pre-event")
    assert np.mean(conditioned.acceleration) == pytest.approx(0.0, abs=1e-13)
    assert "no pre-event window, the record is quiet for 0.3" in conditioned.processing[0]
    assert conditioned.processing[1].startswith("baseline: mean of all samples")


@pytest.mark.parametrize(("samples", "length"), [([0.3] * 500, 4.99), ([0.0, 0.0, 0.0, 1.0, 0.0], 0.02)])
def test_quiet_length_is_from_the_first_quiet_sample_to_the_last(samples, length):
    assert 0.01 * (quiet_samples(record(np.array(samples))) - 1) == pytest.approx(length)


@pytest.mark.parametrize("seed", range(3))
def test_the_window_ends_where_the_energy_reaches_a_millionth(seed):
    """The energy of the first samples about their own mean is their number times their variance."""
    values = 4.0 + np.random.default_rng(seed).normal(size=400) * np.exp(0.05 * np.arange(400))
    energy = [count * np.var(values[:count]) for count in range(1, 401)]
    quiet = next(count for count in range(1, 401) if energy[count - 1] > 1e-6 * energy[-1]) - 1
    assert 10 < quiet < 390
    assert quiet_samples(record(values)) == quiet


@pytest.mark.parametrize(
    ("quiet", "note"), [(101, "pre-event window 0 to 1 s (detected)"), (100, "quiet for 0.99 s only")]
)
def test_a_window_of_one_second_is_long_enough(quiet, note):
    values = np.append(np.zeros(quiet), sine(5.0).acceleration)
    assert note in condition(record(values), "pre-event").processing[0]


def test_drift_is_the_velocity_at_the_last_sample():
    """By trapezoids: 0.1 s x (2/2 + 1 + 5/2) m/s2, which is the PGV too."""
    (warning,) = condition(record([2.0, 1.0, 5.0], 0.1), "none").warnings
    assert "ends at 0.45 m/s" in warning
    assert find(condition(record(np.zeros(9)), "none").warnings, "baseline_drift") is None


def test_given_pre_event_window_is_taken():
    values = np.concatenate((np.full(101, 2.0), np.full(400, 5.0)))
    conditioned = condition(record(values), pre_event_s=1.0)
    assert conditioned.acceleration[[0, -1]].tolist() == [0.0, 3.0]
    assert conditioned.processing == ("baseline: mean of the pre-event window 0 to 1 s (given), 2 m/s2, subtracted",)
    # 0.29/0.01 is a little below 29 in the computer.
    note = condition(record(np.append(np.full(29, 3.0), [6.0] * 99)), pre_event_s=0.29).processing[0]
    assert "window 0 to 0.29 s (given), 3.1 m/s2" in note


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("frequency", [0.25, 0.5, 1.0, 5.0, 10.0, 20.0])
def test_filter_has_the_squared_butterworth_response_and_no_phase(order, frequency):
    filtered = condition(sine(frequency), "none", highpass_hz=0.5, lowpass_hz=10.0, order=order)
    amplitude, phase = amplitude_and_phase(filtered, frequency)
    # The bilinear transform maps f to tan(pi f dt).
    warped, low, high = (math.tan(math.pi * value * 0.01) for value in (frequency, 0.5, 10.0))
    gain = 1.0 / (1.0 + (low / warped) ** (2 * order)) / (1.0 + (warped / high) ** (2 * order))
    assert amplitude == pytest.approx(gain, rel=1e-3, abs=1e-6)
    assert math.remainder(phase - 0.3, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-3)


def test_high_pass_takes_the_impulse_of_a_one_sided_pulse_and_the_note_says_so():
    time = 0.01 * np.arange(4001)
    motion = record(np.exp(-(((time - 20.0) / 0.5) ** 2)))
    filtered = condition(motion, "none", highpass_hz=0.3)
    before, after = (np.max(np.abs(half_waves(one).impulse)) for one in (motion, filtered))
    assert after < 0.8 * before
    assert f"PGV {pgv(motion):.4g} -> {pgv(filtered):.4g} m/s" in filtered.processing[-1]
    assert f"largest half-wave impulse {before:.4g} -> {after:.4g} m/s" in filtered.processing[-1]


def test_long_pads_would_not_change_the_filtered_record():
    motion = event()
    padded = replace(motion, acceleration=np.pad(motion.acceleration, 20000))
    short, long = (condition(one, "none", highpass_hz=0.1, taper_s=0.0) for one in (motion, padded))
    assert short.acceleration == pytest.approx(long.acceleration[20000:-20000], abs=2e-6 * motion.pga)


@pytest.mark.parametrize(("corner", "share"), [({"lowpass_hz": 5.0}, 0.5), ({"highpass_hz": 0.5}, 0.0)])
def test_half_of_an_impulse_at_the_first_sample_is_cut_off_with_the_pad(corner, share):
    """By symmetry: without phase half of it comes before the first sample, of a gain of 1 at rest or of 0."""
    motion = record([2.0] + [0.0] * 4000)
    note = condition(motion, "none", taper_s=0.0, **corner).processing[-1]
    stated = float(note.split("(velocity at the first sample: ")[1].split()[0])
    assert stated == pytest.approx(share * 2.0 * 0.01, rel=1e-3, abs=1e-6)


def test_taper_is_a_cosine_that_leaves_the_middle_alone():
    tapered = condition(record(np.ones(1001)), "none", taper_s=2.0).acceleration
    # Of 4 s of 10 s 3/8 are left; of three equal impulses that in the middle.
    impulses = np.where(np.isin(np.arange(1001), [0, 500, 1000]), 1.0, 0.0)
    motions = (record(own) for own in (np.ones(1001), np.zeros(1001), impulses))
    notes = [condition(motion, "none", taper_s=2.0).processing[0].partition("removes ")[2] for motion in motions]
    assert notes == ["25 % of the energy", "0 % of the energy", "67 % of the energy"]
    assert tapered[[0, 50, 100, 150, 200, 500, 800, 900, 1000]] == pytest.approx(
        [0.0, 0.5 - 0.125**0.5, 0.5, 0.5 + 0.125**0.5, 1.0, 1.0, 1.0, 0.5, 0.0]
    )


@pytest.mark.parametrize(
    ("corners", "length"),
    [
        ({"highpass_hz": 0.1}, "2 s"),
        ({"highpass_hz": 1.0}, "1 s"),
        ({"lowpass_hz": 8.0}, "0.125 s"),
        ({"highpass_hz": 1.0, "lowpass_hz": 8.0}, "1 s"),
    ],
)
def test_default_taper_is_one_period_of_the_corner_or_five_percent(corners, length):
    note = condition(sine(2.0), "none", **corners).processing[0]
    assert note.startswith(f"taper: cosine, {length} at each end")


@pytest.mark.parametrize(("old", "new"), [(0.01, 0.005), (0.01, 0.02), (0.005, 0.02), (0.01, 0.004), (0.0025, 0.01)])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.79])
def test_resampled_sine_keeps_amplitude_and_phase(old, new, share):
    frequency = share * 0.5 / max(old, new)
    resampled = condition(sine(frequency, old), "none", resample_s=new)
    amplitude, phase = amplitude_and_phase(resampled, frequency)
    assert resampled.dt == new
    assert resampled.duration == pytest.approx(40.0, abs=new)
    assert amplitude == pytest.approx(1.0, abs=1e-4)
    assert phase == pytest.approx(0.3, abs=1e-4)


def test_coarser_record_has_no_aliases():
    resampled = condition(sine(26.0), "none", resample_s=0.02)  # Nyquist 25 Hz; the alias would be at 24 Hz
    middle = (resampled.time > 5.0) & (resampled.time < 35.0)
    assert np.max(np.abs(resampled.acceleration[middle])) < 1e-4


@pytest.mark.parametrize(
    ("new", "count", "words"),
    [(0.005, 999, "2/1, passes up to 40 Hz"), (0.004, 1248, "5/2"), (0.02, 250, "1/2, passes up to 20 Hz")],
)
def test_a_line_makes_no_steps_at_the_ends_when_resampled(new, count, words):
    resampled = condition(record(7.0 + 0.02 * np.arange(500)), "none", resample_s=new)
    assert resampled.acceleration == pytest.approx(7.0 + 2.0 * new * np.arange(count), abs=1e-11)
    assert f"(polyphase {words}" in resampled.processing[0]


@pytest.mark.parametrize("times", [2, 3])
def test_finer_samples_are_those_of_a_kaiser_low_pass_of_a_hundred_decibels(times):
    """Length and shape of the window by the formulas of Kaiser (1974), of a pass band up to 0.8 of 50 Hz."""
    motion = record([0.0] * 300 + [1.0] + [0.0] * 300)
    taps = math.ceil((100.0 - 7.95) / (2.285 * math.pi * 0.2 / times) + 1.0) | 1
    place = np.arange(taps) - taps // 2
    kernel = np.sinc(0.9 * place / times) * np.kaiser(taps, 0.1102 * (100.0 - 8.7))
    found = condition(motion, "none", resample_s=0.01 / times).acceleration
    around = found[300 * times - taps // 2 : 300 * times + taps // 2 + 1]
    assert around == pytest.approx(times * kernel / kernel.sum(), abs=1e-12)
    assert np.abs(found).sum() == pytest.approx(np.abs(around).sum())


@pytest.mark.parametrize(("new", "taken"), [(1e-5, True), (0.01 / 1001, False), (10.0, True), (10.01, False)])
def test_intervals_in_a_ratio_of_a_thousand_are_taken(new, taken):
    motion = record(np.zeros(11 if new < 0.01 else 2001))
    if taken:
        assert condition(motion, "none", resample_s=new).dt == new
    else:
        with pytest.raises(ConfigError, match="is not a ratio of whole numbers"):
            condition(motion, "none", resample_s=new)


def test_resampling_to_the_interval_it_has_does_nothing():
    motion = event()
    assert np.array_equal(condition(motion, "none", resample_s=0.01).acceleration, motion.acceleration)


def test_steps_are_written_down_in_their_order_and_the_rest_is_kept():
    motion = replace(event(), station="ABC", processing=("earlier",))
    conditioned = condition(motion, "linear", highpass_hz=0.1, lowpass_hz=20.0, order=3, taper_s=1.0, resample_s=0.02)
    assert [step.partition(":")[0] for step in conditioned.processing] == [
        "earlier",
        "baseline",
        "taper",
        "filter",
        "resampled",
    ]
    assert (
        "high-pass 0.1 Hz and low-pass 20 Hz, zero phase, order 3 each way (effective 6), pads of 45 s"
        in (conditioned.processing[3])
    )
    assert conditioned.station == "ABC"
    assert motion.processing == ("earlier",)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"baseline": "median"}, "baseline: expected one of auto, none, mean"),
        ({"highpass_hz": 0.0}, "highpass_hz: expected a frequency above 0"),
        ({"lowpass_hz": 50.0}, "below the Nyquist frequency 50 Hz of test, got 50.0"),
        ({"lowpass_hz": math.nan}, "lowpass_hz: expected a frequency"),
        ({"highpass_hz": 5.0, "lowpass_hz": 5.0}, "expected highpass_hz below lowpass_hz"),
        ({"order": 0}, "order: expected a whole number from 1 to 10"),
        ({"order": True}, "order: expected a whole number from 1 to 10"),
        ({"taper_s": -1.0}, "taper_s: expected 0 to 30 s"),
        ({"taper_s": 30.1}, "taper_s: expected 0 to 30 s, half the length of test"),
        ({"resample_s": 0.0}, "resample_s: expected a positive interval"),
        ({"resample_s": math.nan}, "resample_s: expected a positive interval"),
        ({"resample_s": 61.0}, "resample_s: expected a positive interval in s, no longer than test"),
        ({"resample_s": 0.01 * math.sqrt(2.0)}, "is not a ratio of whole numbers up to 1000"),
        ({"baseline": "mean", "pre_event_s": 2.0}, "pre_event_s applies only to baseline 'pre-event' or 'auto'"),
        ({"pre_event_s": 0.001}, "pre_event_s: expected a window of at least two samples"),
    ],
)
def test_wrong_arguments_are_named(wrong, message):
    with pytest.raises(ConfigError, match=message):
        condition(event(), **wrong)


def test_two_samples_can_be_conditioned():
    conditioned = condition(record([1.0, 3.0]), "quadratic", highpass_hz=1.0, taper_s=0.0)
    assert conditioned.acceleration == pytest.approx([0.0, 0.0], abs=1e-12)


def test_corner_far_below_the_record_is_refused_before_its_pads_are_made():
    with pytest.raises(ConfigError, match=r"needs 3e\+14 samples of padding at each end, expected at most 1e\+07"):
        condition(sine(1.0), "none", highpass_hz=1e-12)
