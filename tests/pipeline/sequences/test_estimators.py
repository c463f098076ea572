"""Calibration of one record: every estimator by hand, and what must hold for all of them."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.intensity import IntensePhase, intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import INTERVAL, MAIN, SECONDARY, record_sequence

properties = settings(derandomize=True, deadline=None, max_examples=40)
impulses = st.lists(st.floats(1e-3, 10.0), min_size=4, max_size=40)
estimators = list(itertools.product(MAIN, SECONDARY, INTERVAL))


def waves(sizes, centroids=None):
    """Half-waves of alternate signs, by default 1 s long and centred."""
    sizes = np.asarray(sizes, dtype=float) * (-1.0) ** np.arange(len(sizes))
    centroids = 0.5 + np.arange(len(sizes)) if centroids is None else np.asarray(centroids, dtype=float)
    return HalfWaves(
        impulse=sizes,
        centroid=centroids,
        start=np.floor(centroids),
        end=np.floor(centroids) + 1.0,
        peak=2.0 * sizes,
        lobes=np.ones(len(sizes)),
        dt=0.01,
        record_id="NET.STA.LOC.CHA",
    )


FIVE = waves([1.0, 3.0, 5.0, 4.0, 2.0], [0.1, 1.2, 2.3, 3.9, 4.5])


@pytest.mark.parametrize(
    ("options", "main", "others"),
    [
        ({"main": "largest"}, 5.0, [1.0, 2.0, 3.0, 4.0]),
        ({"main": "mean-largest", "m": 3}, 4.0, [1.0, 2.0]),
        ({"main": "mean-largest"}, 4.0, [1.0, 2.0]),
        ({"main": "quantile"}, 4.8, [1.0, 2.0, 3.0, 4.0]),  # at 0.95
        ({}, 5.0, [1.0, 2.0, 3.0, 4.0]),
        ({"main": "mean-largest", "m": 1}, 5.0, [1.0, 2.0, 3.0, 4.0]),
        ({"main": "mean-largest", "m": 4}, 3.5, [1.0]),
        ({"main": "quantile", "quantile": 0.7}, 3.8, [1.0, 2.0, 3.0]),
        ({"main": "quantile", "quantile": 0.75}, 4.0, [1.0, 2.0, 3.0, 4.0]),
        ({"main": "quantile", "quantile": 1.0}, 5.0, [1.0, 2.0, 3.0, 4.0]),
        ({"main": "quantile", "quantile": 0.0}, 1.0, [1.0]),
    ],
)
def test_secondary_impulse_is_over_the_others(options, main, others):
    by_hand = {"mean": np.mean(others), "median": np.median(others), "rms": math.sqrt(np.mean(np.square(others)))}
    for secondary, value in by_hand.items():
        sequence = record_sequence(FIVE, secondary=secondary, **options)
        assert (sequence.main, sequence.secondary) == (pytest.approx(main), pytest.approx(value))


def test_interval_is_over_the_centroid_spacings():
    assert record_sequence(FIVE, interval="mean").interval == pytest.approx(1.1)
    assert record_sequence(waves([1.0] * 4, [0.0, 0.5, 2.5, 3.25]), interval="median").interval == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("main_count", "count"), [("half-largest", 3), ("none", None), (1, 1), (7, 7), (np.int64(2), 2)]
)
def test_number_of_main_impulses(main_count, count):
    assert record_sequence(FIVE, main_count=main_count).main_count == count


def test_phase_selects_half_waves_by_their_centroid_and_gives_the_duration():
    sequence = record_sequence(FIVE, secondary="mean", phase=IntensePhase(1.2, 4.2))
    assert (sequence.main, sequence.secondary, sequence.duration) == (5.0, pytest.approx(3.5), pytest.approx(3.0))
    assert sequence.interval == pytest.approx((1.1 + 1.6) / 2.0)


def test_duration_is_from_the_first_to_the_last_wave_without_a_phase():
    assert record_sequence(FIVE).duration == 5.0
    assert record_sequence(waves([1.0, 2.0, 3.0], [3.2, 4.3, 6.1])).duration == 4.0  # from 3 s to 7 s


@pytest.mark.parametrize("phase", [None, IntensePhase(0.0, 5.0)])
def test_given_duration_comes_first(phase):
    assert record_sequence(FIVE, duration_s=20.0, phase=phase).duration == 20.0


@pytest.mark.parametrize(("main", "secondary", "interval"), estimators)
def test_sine_is_its_own_secondary_sequence(main, secondary, interval):  # VALIDATION V16, D
    dt = 0.01
    sine = Record(np.sin(2.0 * np.pi * dt * np.arange(1001)), dt=dt, id="sine")
    sequence = record_sequence(half_waves(sine), main, secondary, interval, phase=intense_phase(sine))
    assert sequence.main == pytest.approx(dt / math.tan(math.pi * dt), rel=1e-12)
    assert sequence.secondary == pytest.approx(sequence.main, rel=1e-12)
    assert sequence.interval == pytest.approx(0.5, rel=1e-12)


@pytest.mark.sweep
@properties
@given(impulses, st.sampled_from(estimators), st.floats(0.0, 1.0), st.integers(1, 3))
def test_secondary_impulse_is_never_above_the_main_one(sizes, chosen, quantile, m):
    sequence = record_sequence(waves(sizes), *chosen, quantile=quantile, m=m)
    assert 0.0 < sequence.secondary <= sequence.main <= max(sizes) * (1.0 + 1e-15)
    assert 1 <= sequence.main_count <= len(sizes)


@pytest.mark.parametrize("size", [0.3, 0.6])  # sqrt(mean(size^2)) rounds up
def test_rounding_does_not_put_the_secondary_impulse_above_an_equal_main_one(size):
    sequence = record_sequence(waves([size] * 4), secondary="rms")
    assert sequence.main == sequence.secondary == size


@pytest.mark.sweep
@properties
@given(impulses, st.sampled_from(estimators), st.sampled_from([2.0**-3, 2.0, 2.0**5]))
def test_scaled_and_mirrored_waves_give_the_scaled_sequence(sizes, chosen, factor):
    sequence, scaled = (
        record_sequence(waves(sizes), *chosen),
        record_sequence(waves(np.multiply(sizes, -factor)), *chosen),
    )
    assert scaled.main == pytest.approx(factor * sequence.main, rel=1e-14)
    assert scaled.secondary == pytest.approx(factor * sequence.secondary, rel=1e-14)
    assert (scaled.interval, scaled.duration) == (sequence.interval, sequence.duration)
    assert scaled.main_count == sequence.main_count


@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_half_waves_are_refused_with_their_number(count):
    with pytest.raises(
        RecordRefused, match=rf"NET\.STA\.LOC\.CHA: {count} half-waves in all, but a sequence needs at least 3; choose"
    ):
        record_sequence(waves([1.0] * count))


def test_too_few_half_waves_in_the_phase_are_refused_with_the_phase():
    with pytest.raises(RecordRefused, match="1 half-waves centred in the intense phase 2 to 3 s"):
        record_sequence(FIVE, phase=IntensePhase(2.0, 3.0))


def test_mean_of_all_half_waves_leaves_none_for_the_secondary_impulse():
    with pytest.raises(RecordRefused, match=r"CHA: 5 half-waves: the mean of the 5 largest leaves no half-wave"):
        record_sequence(FIVE, main="mean-largest", m=5)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"main": "biggest"}, "main: expected one of largest, mean-largest, quantile, got 'biggest'"),
        ({"secondary": "max"}, "secondary: expected one of median, mean, rms, got 'max'"),
        ({"interval": "mode"}, "interval: expected one of median, mean, got 'mode'"),
        ({"spacing": "centre"}, "spacing: expected one of end, middle, start, open, continuous, got 'centre'"),
        (
            {"main_count": "all"},
            "main_count: expected one of half-largest, none or a whole number of at least 1, got 'all'",
        ),
        ({"main_count": 0}, "main_count: expected"),
        ({"main_count": True}, "main_count: expected"),
        ({"duration_s": 0.0}, "duration_s: expected a positive duration"),
        ({"quantile": -0.1}, "quantile: expected a probability from 0 to 1"),
        ({"m": 0}, "m: expected a whole number of at least 1"),
    ],
)
def test_wrong_arguments_are_named(wrong, message):
    with pytest.raises(ConfigError, match=message):
        record_sequence(FIVE, **wrong)
