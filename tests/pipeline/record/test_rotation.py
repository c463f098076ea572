"""The motion of a pair in another direction: against closed forms, itself turned back, and a finer search."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from rockpulse.errors import RecordRefused
from rockpulse.record.components import Pair
from rockpulse.record.conditioning import condition
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from rockpulse.record.rotation import condition_pair, pair_id, rotate, strongest_azimuth

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)
DT = 0.01
TIME = DT * np.arange(1000)


def noise(seed, n=1000, quiet=0):
    rng = np.random.default_rng(seed)
    t = DT * np.arange(n)
    shaking = sum(rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for f in (0.4, 0.9, 2.3, 5.1, 8.7))
    return np.where(np.arange(n) < quiet, 0.0, shaking)


def channel(acceleration, azimuth, **options):
    code = f"{azimuth:g}"
    known = {"id": f"CI.CCC..{code}@20190706T031953", "network": "CI", "station": "CCC", "channel": code}
    known |= {"start_time": START, "processed": True, "source": "a.v1", "source_sha256": "0" * 64, "header_peak": 3.0}
    return Record(acceleration, azimuth=azimuth, orientation="horizontal", **{"dt": DT, **known, **options})


def facing(north, east, first, second, **options):
    """Two channels that face these azimuths on a ground that moves like this."""
    return Pair(
        *(channel(north * np.cos(np.radians(z)) + east * np.sin(np.radians(z)), z, **options) for z in (first, second))
    )


@pytest.mark.parametrize(("first", "second"), [(90.0, 0.0), (0.0, 90.0), (67.0, 337.0), (10.0, 55.0), (350.0, 125.0)])
def test_in_the_direction_of_a_channel_the_motion_is_that_channel_bit_for_bit(first, second):
    pair = Pair(channel(noise(0), first), channel(noise(1), second))
    for one in pair.channels:
        assert np.array_equal(rotate(pair, one.azimuth).acceleration, one.acceleration)
        assert np.array_equal(rotate(pair, one.azimuth + 180.0).acceleration, -one.acceleration)


def test_earthquake_and_site_stay_known():
    known = {"event_id": "ci38457511", "origin_time": START, "magnitude": 7.1, "magnitude_type": "Mw", "vs30": 500.0}
    pair = condition_pair(facing(noise(0), noise(1), 90.0, 0.0, station_latitude=35.5, **known))
    turned = rotate(pair, 30.0)
    assert {name: getattr(turned, name) for name in known} == known
    assert turned.station_latitude == 35.5


@pytest.mark.parametrize(("first", "second"), [(90.0, 0.0), (12.0, 33.0), (200.0, 31.0), (0.0, 169.0)])
@pytest.mark.parametrize("azimuth", [0.0, 33.3, 90.0, 147.0, 301.0])
def test_any_angle_between_the_channels_gives_the_ground_motion_in_any_direction(first, second, azimuth):
    north, east = noise(2), noise(3)
    expected = north * np.cos(np.radians(azimuth)) + east * np.sin(np.radians(azimuth))
    turned = rotate(facing(north, east, first, second), azimuth).acceleration
    assert np.max(np.abs(turned - expected)) < 1e-14 * np.max(np.abs(expected)) / np.sin(np.radians(11.0))


@pytest.mark.parametrize("second", [0.0, 180.0, 5.0, 9.78, 171.0, 360.0, np.nan])
def test_channels_that_are_almost_parallel_are_refused(second):
    pair = Pair(channel(noise(0), 0.0), channel(noise(1), second))
    for use in (lambda: rotate(pair, 30.0), lambda: condition_pair(pair), lambda: strongest_azimuth(pair)):
        with pytest.raises(RecordRefused, match=r'at least 9.79 degrees from parallel, found 0 and .*"horizontal"'):
            use()


@pytest.mark.parametrize("other", [{"dt": 0.02}, {"acceleration": np.ones(999)}])
def test_channels_with_other_samples_are_no_pair_to_rotate(other):
    with pytest.raises(RecordRefused, match="expected the same sample times in both"):
        rotate(Pair(channel(noise(0), 90.0), replace(channel(noise(1), 0.0), **other)), 30.0)
    almost = channel(noise(1), 0.0, dt=DT * (1.0 + 1e-10))
    assert rotate(Pair(channel(noise(0), 90.0), almost), 30.0).dt == DT


@pytest.mark.parametrize(
    ("unit", "factor", "expected"),
    [("cm/s2", 0.01, ("cm/s2", 0.01)), ("cm/s2", 0.02, ("", np.nan)), ("g", 0.01, ("", np.nan))],
)
def test_the_unit_is_told_where_both_channels_have_it(unit, factor, expected):
    one = channel(noise(0), 90.0, source_unit="cm/s2", unit_factor=0.01)
    turned = rotate(Pair(one, channel(noise(1), 0.0, source_unit=unit, unit_factor=factor)), 30.0)
    assert (turned.source_unit, turned.unit_factor) == pytest.approx(expected, nan_ok=True)


def test_a_rotated_record_says_what_it_is_made_of():
    one = channel(noise(0), 90.0, warnings=("clipped", "of both"), processing=("mean",))
    known = {"warnings": ("of both", "late"), "source": "n.v1", "source_sha256": "1" * 64, "processing": ("mean",)}
    two = channel(noise(1), 0.0, **known)
    turned = rotate(Pair(one, two), 30.0)
    assert turned.id == "CI.CCC..H030@20190706T031953"
    assert (turned.azimuth, turned.orientation, turned.channel) == (30.0, "horizontal", "H030")
    assert (turned.source, turned.source_sha256) == ("a.v1; n.v1", f"{'0' * 64}; {'1' * 64}")
    assert turned.warnings == ("90: clipped", "of both", "0: late")
    assert turned.processing[0] == "mean"
    assert "0.5 x CI.CCC..90@20190706T031953 (90 degrees) +0.866025 x CI.CCC..0@" in turned.processing[1]
    assert np.isnan(turned.header_peak)
    assert pair_id(Pair(one, two)) == "CI.CCC..90-0@20190706T031953"


def test_a_fraction_of_a_degree_is_rounded_in_the_id_alone():
    turned = rotate(Pair(channel(noise(0), 90.0), channel(noise(1), 0.0)), 28.92)
    assert (turned.id, turned.azimuth) == ("CI.CCC..H029@20190706T031953", 28.92)


def test_without_a_station_the_name_of_the_file_stays():
    unnamed = {"station": "", "start_time": None}
    pair = Pair(channel(noise(0), 90.0, id="motion.E", **unnamed | {"channel": "E"}), channel(noise(1), 0.0, **unnamed))
    assert rotate(pair, 45.0).id == "motion.H045"


# --- the same samples in both --------------------------------------------------------------------------------------


def test_channels_that_start_apart_are_aligned_and_cut_with_a_warning():
    north, east = noise(0), noise(1)
    late = START + timedelta(seconds=0.5)
    pair = Pair(channel(east, 90.0), channel(north[50:900], 0.0, start_time=late))
    first, second = condition_pair(pair).channels
    assert np.array_equal(first.acceleration, east[50:900])
    assert np.array_equal(second.acceleration, north[50:900])
    assert first.start_time == second.start_time == late
    assert "0.5 s at its start and 1 s at its end left out" in " ".join(first.warnings)
    assert "cut to the time in common with CI.CCC..0@" in " ".join(first.warnings)
    assert not any("left out" in warning for warning in second.warnings)
    assert rotate(Pair(first, second), 90.0).start_time == late


@pytest.mark.parametrize("fraction", [0.25, 0.5, 0.9995, -0.3])
def test_a_fraction_of_a_sample_is_bridged_along_the_line_between_the_samples(fraction):
    ramp = 0.01 * np.arange(1000.0)
    late = START + timedelta(seconds=fraction * DT)
    pair = Pair(channel(ramp, 90.0), channel(ramp, 0.0, start_time=late))
    first, second = condition_pair(pair, baseline="none").channels
    late = fraction > 0.0
    assert first.npts == second.npts == 999
    assert np.array_equal(first.acceleration, ramp[1:] if late else ramp[:-1])
    assert first.start_time == second.start_time == START + late * timedelta(seconds=DT)
    assert first.acceleration - second.acceleration == pytest.approx(0.01 * fraction, abs=1e-3 * 0.01)
    assert any("interpolated linearly" in note for note in second.processing) == (abs(fraction) < 0.99)


@pytest.mark.parametrize(
    ("fraction", "begin", "count"), [(0.5, 1, 1998), (-0.3, 0, 1999), (-0.75, 0, 1999), (0.25, 1, 1998)]
)
def test_finer_samples_are_aligned_to_those_of_the_first(fraction, begin, count):
    """Of a longer second channel nothing is kept beyond the first one."""
    late = START + timedelta(seconds=fraction * DT)
    ramp, longer = 0.01 * np.arange(1000.0), 0.01 * np.arange(1100.0)
    pair = Pair(channel(ramp, 90.0), channel(longer, 0.0, start_time=late))
    first, second = condition_pair(pair, baseline="none", resample_s=DT / 2).channels
    assert first.npts == second.npts == count
    assert first.start_time == second.start_time == START + begin * timedelta(seconds=DT / 2)
    assert first.acceleration == pytest.approx(0.005 * (begin + np.arange(count)), abs=1e-9)
    assert second.acceleration == pytest.approx(first.acceleration - 0.01 * fraction, abs=1e-9)


def test_clocks_that_differ_by_less_than_a_thousandth_of_a_sample_agree():
    late = START + timedelta(microseconds=5)
    pair = Pair(channel(noise(0), 90.0), channel(noise(1), 0.0, start_time=late))
    assert np.array_equal(condition_pair(pair).second.acceleration, noise(1))


def test_one_shared_interval_is_no_overlap():
    def shifted(samples):
        late = START + timedelta(seconds=DT * samples)
        return Pair(channel(noise(0), 90.0), channel(noise(1), 0.0, start_time=late))

    for samples, found in ((998.9, 1), (999, 1), (1000, 0), (1200, 0)):
        with pytest.raises(RecordRefused, match=f"at least two samples in their common time, found {found}"):
            condition_pair(shifted(samples))
    assert condition_pair(shifted(998)).first.npts == 2


def test_other_intervals_are_refused_until_one_is_asked_for():
    fine = Record(np.repeat(noise(1), 2)[:-1], DT / 2, id="fine", azimuth=0.0, processed=True, start_time=START)
    pair = Pair(channel(noise(0), 90.0), fine)
    with pytest.raises(RecordRefused, match=r"found 0.01 and 0.005 s; give \[conditioning\] resample_s"):
        condition_pair(pair)
    both = condition_pair(pair, resample_s=0.005)
    assert both.first.dt == both.second.dt == 0.005
    assert both.first.npts == both.second.npts == 1999


def test_a_raw_and_a_corrected_channel_are_no_pair():
    with pytest.raises(RecordRefused, match="one of them is a corrected record"):
        condition_pair(Pair(channel(noise(0), 90.0), channel(noise(1), 0.0, processed=False)))


def test_files_without_times_are_told_to_start_together():
    pair = Pair(*(channel(noise(k), 90.0 * k, source=f"{k}.AT2", start_time=None) for k in (0, 1)))
    assert any("assumed to start together" in warning for warning in rotate(condition_pair(pair), 10.0).warnings)
    one_known = Pair(pair.first, replace(pair.second, start_time=START))
    of_one_file = Pair(*(replace(one, source="both.AT2") for one in pair.channels))
    assert [
        any("assumed to start together" in warning for one in condition_pair(each).channels for warning in one.warnings)
        for each in (one_known, of_one_file)
    ] == [True, False]


OPTIONS = [
    {"baseline": "auto"},
    {"baseline": "mean"},
    {"baseline": "linear"},
    {"baseline": "quadratic"},
    {"baseline": "pre-event", "pre_event_s": 1.2},
    {"baseline": "mean", "highpass_hz": 0.2, "lowpass_hz": 20.0},
    {"baseline": "none", "taper_s": 1.0},
    {"baseline": "none", "resample_s": 0.02},
]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize("processed", [True, False, None])
def test_conditioned_and_rotated_is_rotated_and_conditioned(options, processed):
    """The pre-event windows of the channels differ: 1.9 and 2.9 s; both take the shorter one."""
    channels = (channel(noise(8, quiet=200) + 0.3, 40.0, processed=processed),
                channel(noise(9, quiet=300) - 0.2, 110.0, processed=processed))  # fmt: skip
    pair = Pair(*channels)
    found = rotate(condition_pair(pair, **options), 75.0)
    window = {"pre_event_s": 1.99} if options == {"baseline": "auto"} and processed is False else {}
    expected = condition(rotate(pair, 75.0), **options, **window)
    assert found.acceleration == pytest.approx(expected.acceleration, abs=1e-11)
    if window:
        assert any("0 to 1.99 s" in note for note in found.processing)


@pytest.mark.parametrize(
    ("quiet", "words"), [(101, "window of both channels: 0 to 1 s"), (100, "0.99 s only (needed: 1 s)")]
)
def test_a_common_window_of_one_second_is_long_enough(quiet, words):
    shaking = np.tile([100.0, -100.0], 250)
    pair = Pair(*(channel(np.append(np.zeros(more), shaking), 90.0 * k, processed=False, source=f"{k}")
                  for k, more in enumerate((quiet, quiet + 30))))  # fmt: skip
    for options in ({}, {"baseline": "pre-event"}):
        assert any(words in note for note in condition_pair(pair, **options).first.processing)
    given = condition_pair(pair, pre_event_s=0.5).first.processing
    assert not any("of both channels" in note for note in given)


def test_drift_is_judged_in_the_direction_that_is_assessed():
    drifting = channel(np.sin(2 * np.pi * TIME) + 0.05, 90.0)
    pair = condition_pair(Pair(drifting, channel(np.sin(2 * np.pi * TIME), 0.0)))
    assert any(warning.startswith("baseline drift") for warning in rotate(pair, 90.0).warnings)
    assert not any(warning.startswith("baseline drift") for warning in rotate(pair, 0.0).warnings)


# --- the strongest direction -------------------------------------------------------------------------------------


@pytest.mark.sweep
@pytest.mark.parametrize("azimuth", [0.0, 17.25, 45.0, 90.0, 133.33, 179.9])
def test_a_motion_in_one_direction_is_strongest_there(azimuth):
    line = noise(10)
    angle = np.radians(azimuth)
    pair = facing(line * np.cos(angle), line * np.sin(angle), 61.0, 118.0)
    found, impulse = strongest_azimuth(pair)
    assert abs((found - azimuth + 90.0) % 180.0 - 90.0) <= 0.0051
    own = np.max(np.abs(half_waves(channel(line, 0.0)).impulse))
    assert impulse == pytest.approx(own, rel=1e-8)
    assert impulse == pytest.approx(np.max(np.abs(half_waves(rotate(pair, found)).impulse)), rel=1e-12)


def brute_force(pair, step=0.1, **options):
    return max(
        np.max(np.abs(half_waves(rotate(pair, step * k), **options).impulse)) for k in range(round(180.0 / step))
    )


@pytest.mark.parametrize("options", [{}, {"threshold": 0.1, "min_duration_s": 0.05}], ids=["lobes", "merged"])
@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=pytest.mark.slow if seed else pytest.mark.sweep) for seed in range(3)]
)
def test_the_search_finds_what_a_scan_of_a_tenth_of_a_degree_finds(seed, options):
    pair = facing(noise(20 + seed, 400), noise(40 + seed, 400), 90.0, 0.0)
    assert strongest_azimuth(pair, **options)[1] >= brute_force(pair, **options) * (1.0 - 1e-9)


@pytest.mark.slow
def test_the_search_is_enough_on_a_recorded_motion(ccc):
    pair = condition_pair(Pair(*(one for one in ccc if one.orientation == "horizontal")))
    short = Pair(*(replace(one, acceleration=one.acceleration[3400:4200]) for one in pair.channels))
    assert strongest_azimuth(short)[1] >= brute_force(short) * (1.0 - 1e-9)


def test_a_motion_at_rest_has_no_direction_and_takes_the_first():
    assert strongest_azimuth(Pair(channel(np.zeros(50), 90.0), channel(np.zeros(50), 0.0))) == (0.0, 0.0)
