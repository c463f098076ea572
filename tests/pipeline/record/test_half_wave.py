"""Half-waves: exact lobes against rational arithmetic, the sums of F10, and mergers worked by hand."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rockpulse.errors import ConfigError
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record

properties = settings(derandomize=True, deadline=None, max_examples=25)
samples = st.lists(
    st.one_of(st.integers(-9, 9).map(float), st.floats(-10.0, 10.0, allow_subnormal=False), st.just(0.0)),
    min_size=2,
    max_size=60,
)
intervals = st.sampled_from([0.005, 0.01, 1.0 / 60.0, 1.0])
options = st.fixed_dictionaries(
    {
        "threshold": st.sampled_from([0.0, 0.02, 0.3, 1.0]),
        "min_duration_s": st.sampled_from([0.0, 0.015, 2.5]),
        "merge": st.booleans(),
    }
)


def record(values, dt=1.0):
    return Record(values, dt=dt, id="test")


def triangles(*peaks):
    """One triangle of 2 s for every peak: impulse = peak, centroids 1, 3, 5 ... s."""
    return record([0.0, *(value for peak in peaks for value in (peak, 0.0))])


def exact_pieces(values, dt):
    """Pieces of one sign as (start, end, value at the start, value at the end), in rational numbers."""
    dt = Fraction(dt)
    for index, (left, right) in enumerate(zip(map(Fraction, values), map(Fraction, values[1:]), strict=False)):
        start, end = index * dt, (index + 1) * dt
        if left * right < 0:
            crossing = start + dt * left / (left - right)
            yield start, crossing, left, Fraction(0)
            yield crossing, end, Fraction(0), right
        else:
            yield start, end, left, right


def exact_lobes(values, dt):
    """(start, end, impulse, first moment about zero) of the lobes, in rational numbers."""
    lobes, last_sign = [], 0
    for start, end, left, right in exact_pieces(values, dt):
        impulse = (end - start) * (left + right) / 2
        moment = start * impulse + (end - start) ** 2 * (left + 2 * right) / 6
        sign = (impulse > 0) - (impulse < 0)
        if sign and sign == last_sign:
            first, _, before, moment_before = lobes[-1]
            lobes[-1] = (first, end, before + impulse, moment_before + moment)
        elif sign:
            lobes.append((start, end, impulse, moment))
        last_sign = sign
    return lobes


def velocity_and_displacement(values, dt, time):
    """Both at one time, from rest, in rational numbers."""
    velocity = displacement = Fraction(0)
    for start, end, left, right in exact_pieces(values, dt):
        if start >= time:
            break
        length = min(end, time) - start
        slope = (right - left) / (end - start)
        displacement += velocity * length + left * length**2 / 2 + slope * length**3 / 6
        velocity += left * length + slope * length**2 / 2
    return velocity, displacement


@properties
@given(samples, intervals)
def test_lobes_equal_rational_arithmetic(values, dt):
    waves = half_waves(record(values, dt))
    exact = [lobe for lobe in exact_lobes(values, dt) if abs(lobe[2]) > 1e-290]
    found = [index for index, impulse in enumerate(waves.impulse) if abs(impulse) > 1e-290]
    assert len(found) == len(exact)
    length = dt * len(values)
    for index, (start, end, impulse, moment) in zip(found, exact, strict=True):
        assert waves.impulse[index] == pytest.approx(float(impulse), rel=1e-13)
        assert waves.start[index] == pytest.approx(float(start), abs=1e-15 * length)
        assert waves.end[index] == pytest.approx(float(end), abs=1e-15 * length)
        assert waves.centroid[index] == pytest.approx(float(moment / impulse), abs=1e-14 * length)


@properties
@given(samples, intervals, options)
@example([-1.0, 1e-20, -1.0], 1.0, {"threshold": 0.5, "min_duration_s": 0.0, "merge": True})
def test_impulses_keep_velocity_and_displacement_at_every_wave_boundary(values, dt, chosen):  # VALIDATION F10, D
    waves = half_waves(record(values, dt), **chosen)
    gross = float(np.sum(np.abs(values))) * dt + 1e-300
    length = dt * len(values)
    for index, time in [*enumerate(waves.end), (len(waves) - 1, dt * (len(values) - 1))]:
        velocity, displacement = velocity_and_displacement(values, dt, Fraction(float(time)))
        impulse, centroid = waves.impulse[: index + 1], waves.centroid[: index + 1]
        assert abs(math.fsum(impulse) - float(velocity)) <= 1e-12 * gross
        assert abs(math.fsum(impulse * (time - centroid)) - float(displacement)) <= 1e-12 * gross * length


@properties
@given(samples, intervals, options)
def test_waves_are_ordered_disjoint_and_hold_their_centroid_and_sign(values, dt, chosen):
    waves = half_waves(record(values, dt), **chosen)
    assert np.all(waves.start <= waves.centroid)
    assert np.all(waves.centroid <= waves.end)
    assert np.all(waves.end[:-1] <= waves.start[1:])
    assert np.all(np.sign(waves.peak) == np.sign(waves.impulse))
    assert np.all(waves.lobes % 2 == 1)
    assert waves.lobes.sum() == len(half_waves(record(values, dt), merge=False))


@properties
@given(samples, intervals, options)
def test_merged_waves_keep_half_of_the_absolute_impulses_of_their_lobes(values, dt, chosen):
    lobes, waves = half_waves(record(values, dt)), half_waves(record(values, dt), **chosen)
    parts = np.split(np.abs(lobes.impulse), np.cumsum(waves.lobes)[:-1])
    for impulse, part in zip(waves.impulse, parts, strict=False):
        assert abs(impulse) >= 0.5 * part.sum() * (1.0 - 1e-12)


@properties
@given(samples, options)
def test_scaled_and_mirrored_record_has_scaled_and_mirrored_waves(values, chosen):
    waves, scaled = half_waves(record(values), **chosen), half_waves(record(np.multiply(values, -4.0)), **chosen)
    np.testing.assert_allclose(scaled.impulse, -4.0 * waves.impulse, rtol=1e-14)
    np.testing.assert_allclose(scaled.peak, -4.0 * waves.peak, rtol=1e-14)
    np.testing.assert_allclose(scaled.centroid, waves.centroid, rtol=1e-14)
    np.testing.assert_array_equal(scaled.lobes, waves.lobes)


@properties
@given(st.lists(st.integers(-9, 9), min_size=2, max_size=40), st.integers(2, 5))
def test_more_samples_on_the_same_lines_change_nothing(values, parts):
    fine = np.interp(np.arange((len(values) - 1) * parts + 1) / parts, np.arange(len(values)), values)
    # A zero between two samples of one sign is no stretch at zero, whatever the interval; a value that is not exactly
    # zero is no zero.
    fine[np.abs(fine) < 1e-13] = 0.0
    coarse, fine_waves = half_waves(record(values)), half_waves(record(fine, 1.0 / parts))
    np.testing.assert_allclose(fine_waves.impulse, coarse.impulse, rtol=1e-12)
    np.testing.assert_allclose(fine_waves.centroid, coarse.centroid, rtol=0, atol=1e-12)
    np.testing.assert_allclose(fine_waves.peak, coarse.peak, rtol=1e-12)


def test_triangle_has_its_area_at_its_centre_of_gravity():  # VALIDATION V16, D
    waves = half_waves(record([0.0, 0.75, 1.5, 2.25, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0], dt=0.01))
    assert waves.impulse == pytest.approx([0.15], rel=1e-14)
    assert waves.centroid == pytest.approx([0.14 / 3.0], rel=1e-14)
    assert waves.centroid[0] == pytest.approx(0.046667, abs=5e-7)
    assert (waves.start[0], waves.end[0], waves.peak[0]) == (0.0, pytest.approx(0.1), 3.0)


def test_sampled_sine_has_the_impulse_of_its_chords():  # VALIDATION V16, D
    dt = 0.01
    sine = np.sin(2.0 * np.pi * dt * np.arange(1001))
    sine[-1] = 0.0  # its rounding would be a half-wave of 1e-30 m/s
    waves = half_waves(record(sine, dt))
    assert np.abs(waves.impulse) == pytest.approx(np.full(20, dt / math.tan(math.pi * dt)), rel=1e-12)
    assert np.abs(waves.impulse[0]) == pytest.approx(0.318205, abs=5e-7)
    assert waves.centroid == pytest.approx(0.25 + 0.5 * np.arange(20), abs=1e-12)


def test_record_of_zeros_has_no_half_waves():
    waves = half_waves(record(np.zeros(50)), threshold=0.1, min_duration_s=0.1)
    assert len(waves) == 0
    assert len(waves.between(0.0, 100.0)) == 0


def test_noise_lobe_goes_with_both_neighbours():
    waves = half_waves(triangles(4.0, -1.0, 4.0), threshold=0.5)
    assert waves.impulse == pytest.approx([7.0])
    assert waves.centroid == pytest.approx([(4.0 * 1.0 - 1.0 * 3.0 + 4.0 * 5.0) / 7.0])
    assert (waves.start[0], waves.end[0], waves.peak[0], waves.lobes[0]) == (0.0, 6.0, 4.0, 3)


def test_lobe_at_the_threshold_is_no_noise():
    assert len(half_waves(triangles(4.0, -2.0, 4.0), threshold=0.5)) == 3


def test_noise_lobe_at_an_end_stays():
    assert half_waves(triangles(-1.0, 4.0, -1.0), threshold=0.5).impulse == pytest.approx([-1.0, 4.0, -1.0])


@pytest.mark.parametrize(("middle", "count"), [(-2.5, 1), (-8.0 / 3.0 * 0.999, 1), (-8.0 / 3.0 * 1.001, 3), (-3.0, 3)])
def test_merger_that_loses_more_than_half_of_the_impulses_is_refused(middle, count):
    # 8 - x >= (8 + x)/2 up to x = 8/3
    assert len(half_waves(triangles(4.0, middle, 4.0), threshold=1.0)) == count


def test_merger_against_the_neighbours_sign_is_refused():
    # The impulses sum to -0.8 of 1.2, but a wave of the lobe in the middle would not have the neighbours' sign.
    assert len(half_waves(record([0.0, 0.1, 0.0, -0.5, -0.5, 0.0, 0.1, 0.0]), min_duration_s=10.0)) == 3


def test_merger_that_puts_the_centroid_outside_is_refused():
    # 0.1, -9 and 33 m/s at 1, 7 and 13 s: together at 15.19 s, but the wave ends at 14 s.
    values = [0.0, 0.1, 0.0, *[-1.0] * 9, 0.0, 33.0, 0.0]
    assert half_waves(record(values), threshold=0.1).impulse == pytest.approx([0.1, -9.0, 33.0])


def test_merger_that_keeps_just_half_of_the_impulses_is_made():
    assert half_waves(triangles(1.5, -1.0, 1.5), threshold=0.8).impulse == pytest.approx([2.0])


def test_the_peak_of_a_merged_wave_is_the_higher_of_its_sign():
    for peaks in ((4.0, -1.0, 6.0), (6.0, -1.0, 4.0), (-4.0, 1.0, -6.0)):
        assert half_waves(triangles(*peaks), threshold=0.5).peak.tolist() == [max(peaks, key=abs)]


def test_smallest_impulse_is_merged_first():
    # In order of time -1.5 would go into the 9 and leave the lobes as 3 + 1.
    assert half_waves(triangles(9.0, -1.5, 1.0, -1.5), threshold=0.5).lobes.tolist() == [1, 3]


def test_earlier_of_two_equal_impulses_is_merged_first():
    assert half_waves(triangles(9.0, -1.0, 1.0, -9.0), threshold=0.5).lobes.tolist() == [3, 1]


def test_refused_merger_is_tried_again_when_a_neighbour_has_grown():
    # -1 between 1.2 and 1.2 is refused (1.4 of 3.4); once -2 has joined 1.2 to 30 it passes.
    waves = half_waves(triangles(1.2, -1.0, 1.2, -2.0, 30.0), threshold=0.1)
    assert waves.lobes.tolist() == [5]
    assert waves.impulse == pytest.approx([29.4])
    assert waves.centroid == pytest.approx([(1.2 - 3.0 + 6.0 - 14.0 + 270.0) / 29.4])


def test_short_spike_is_noise_by_its_duration_and_the_peak_keeps_the_waves_sign():
    waves = half_waves(record([0.0, 2.0, 2.0, 2.0, -3.0, 2.0, 2.0, 3.5, 0.0]), min_duration_s=1.5)
    assert waves.lobes.tolist() == [3]
    assert waves.peak.tolist() == [3.5]


def test_without_merging_the_thresholds_are_not_looked_at():
    assert len(half_waves(triangles(4.0, -1.0, 4.0), threshold=0.5, min_duration_s=9.0, merge=False)) == 3


def test_between_selects_by_the_centroid_and_includes_both_limits():
    waves = half_waves(triangles(1.0, -1.0, 1.0, -1.0))
    assert waves.between(1.0, 3.0).centroid.tolist() == [1.0, 3.0]
    assert waves.between(1.1, 4.9).centroid.tolist() == [3.0]
    assert waves.between(1.1, 4.9).record_id == "test"


def test_arrays_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        half_waves(triangles(1.0)).impulse[0] = 2.0


@pytest.mark.parametrize(
    ("name", "value"),
    [(name, value) for name in ("threshold", "min_duration_s") for value in (-0.1, math.inf, math.nan)],
)
def test_options_outside_their_ranges_are_errors(name, value):
    with pytest.raises(ConfigError, match=rf"{name}: expected a (fraction of the PGA|duration)"):
        half_waves(triangles(1.0), **{name: value})


@pytest.mark.sweep
@pytest.mark.parametrize("chosen", [{}, {"threshold": 0.05, "min_duration_s": 0.02}, {"threshold": 0.3}])
def test_impulses_of_a_real_record_keep_its_velocity_and_displacement(ccc, chosen):  # VALIDATION F10, D
    for motion in ccc:
        waves = half_waves(motion, **chosen)
        left, right = motion.acceleration[:-1], motion.acceleration[1:]
        velocity = motion.dt * math.fsum(0.5 * (left + right))
        moments = motion.dt * 0.5 * (left + right) * (motion.duration - motion.time[:-1])
        displacement = math.fsum(moments - motion.dt**2 * (left + 2.0 * right) / 6.0)
        gross = math.fsum(np.abs(waves.impulse))
        assert math.fsum(waves.impulse) == pytest.approx(velocity, abs=1e-12 * gross)
        assert math.fsum(waves.impulse * (motion.duration - waves.centroid)) == pytest.approx(
            displacement, abs=1e-12 * gross * motion.duration
        )


def test_half_waves_are_told_in_a_line_and_drawn():
    samples = [0.0, 3.0, -3.0, 0.0, 1.0, 0.0]
    fainter = half_waves(Record([*samples, -0.02, 0.0, 0.03, 0.0], dt=0.1, id="five"))._repr_html_()
    assert fainter.count("M") == 4  # below a hundredth of the largest a wave is not drawn
    waves = half_waves(Record(samples, dt=0.1, id="three triangles"))
    assert repr(waves) == "<HalfWaves of three triangles, waves 3, largest impulse 0.225 m/s, from 0 to 0.5 s>"
    card = waves._repr_html_()
    assert card.count('stroke="#D55E00"') == 1  # the two strong ones, as one path
    assert card.count("M") == 3
