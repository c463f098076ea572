"""Defects of records: each kind is found, sound records have none, and what makes the verdict is said to decide."""

import zipfile
from dataclasses import replace

import numpy as np
import pytest
from shaking import DT, MADE, at, coarse, held, repeated, shaking, spike, step, twice

from rockpulse.readers.folders import read_all
from rockpulse.record.conditioning import BASELINES, condition
from rockpulse.record.defects import deciding, defects, drifts, slow_velocity, with_defects
from rockpulse.record.record import Record
from rockpulse.warning_text import WarningText, code_of, find

TIME = DT * np.arange(4000)
BURST = np.exp(-(((TIME - 15.0) / 4.0) ** 2))


def record(samples, dt=DT, **options):
    return Record(samples, dt, id="made", **options)


def codes(samples, dt=DT):
    return [one.code for one in defects(record(samples, dt))]


@pytest.mark.parametrize("kind", MADE)
def test_a_defect_is_found_at_the_larger_two_of_three_strengths(kind):
    code, make, strengths = MADE[kind]
    found = [code in codes(*make(shaking(), DT, strength)) for strength in strengths]
    assert found == [False, True, True]


@pytest.mark.sweep
@pytest.mark.parametrize("kind", MADE)
def test_a_defect_of_a_real_record_is_found_at_the_larger_two_of_three_strengths(kind, records_folder, tmp_path):
    with zipfile.ZipFile(records_folder / "fema_p695" / "records.zip") as archive:
        archive.extractall(tmp_path)
    strongest = sorted(read_all([tmp_path], "g")[0], key=lambda one: -one.pga)[:20]
    code, make, strengths = MADE[kind]
    for one in strongest:
        assert codes(one.acceleration, one.dt) == []
        assert [code in codes(*make(one.acceleration, one.dt, strength)) for strength in strengths[1:]] == [True, True]


@pytest.mark.parametrize(
    "samples",
    [
        *(shaking(seed) for seed in range(4)),
        shaking(5) + 0.3,
        np.concatenate([np.zeros(500), shaking(6), np.zeros(500)]),
        np.round(shaking(7), 2),
        np.interp(np.arange(0.0, 5999.0, 0.1), np.arange(6000), shaking(8)),
        2.0 * np.sin(2.0 * np.pi * np.linspace(0.0, 40.0, 4001)),
        3.0 * BURST * np.sin(2.0 * np.pi * 2.0 * (TIME - 15.0)),
        3.0 * np.sin(2.0 * np.pi * 2.0 * TIME) * ((TIME >= 10.0) & (TIME < 13.0)),
        np.where((TIME > 5.0) & (TIME < 6.0), np.sin(2.0 * np.pi * (TIME - 5.0)), 0.0),
    ],
    ids=lambda samples: f"{samples.size}-{np.ptp(samples):.3f}",
)
def test_a_sound_record_has_none(samples):
    found = codes(samples)
    assert found == []


def test_a_flat_channel_is_dead_and_one_of_few_steps_is_noise():
    assert codes(np.full(3000, 0.3)) == ["dead_channel"]
    assert codes(0.3 + 0.001 * np.random.default_rng(0).integers(0, 3, 3000)) == ["noise_only"]
    few = 0.3 + 0.001 * np.round(3.0 * BURST)
    assert codes(few) == codes(np.where(TIME % 0.02 < 0.01, few, np.nextafter(few, 1.0))) == ["noise_only"]


def test_a_weak_motion_in_noise_neither_begins_nor_ends_in_strong_motion():
    weak = shaking() + 0.5 * np.random.default_rng(4).normal(size=shaking().size)
    assert not {"starts_strong", "ends_strong"} & set(codes(weak))


def test_a_short_array_is_judged_by_nothing_else():
    assert codes([1.0, 2.0, 1.0], 0.1) == []
    assert codes(np.ones(5)) == ["dead_channel"]


@pytest.mark.parametrize("make", [lambda one: held(one, DT, 1.0), lambda one: repeated(one, DT, 0.5)])
def test_a_gap_of_the_strong_motion_decides_and_one_of_the_coda_does_not(make):
    assert deciding(condition(record(*make(shaking()))))
    motion = shaking()
    start = at(motion, 0.99)
    motion[start : start + 50] = motion[start]
    one = condition(record(motion))
    assert find(one.warnings, "held_value")
    assert deciding(one) == []


def test_a_spike_decides_where_it_is_the_peak():
    assert deciding(condition(record(*spike(shaking(), DT, 5.0))))
    small = shaking()
    small[300] = 0.5
    one = condition(record(small))
    assert find(one.warnings, "spike")
    assert deciding(one) == []


def test_a_few_equal_spikes_do_not_hide_each_other():
    motion = shaking()
    motion[[1500, 1530, 1560, 2000]] = 20.0
    assert find(defects(record(motion)), "spike").values["count"] == 4


def test_a_spike_in_a_motion_of_eight_hertz_is_found_where_it_is():
    motion = 3.0 * BURST * np.sin(2.0 * np.pi * 8.0 * (TIME - 15.0))
    motion[1500] += 0.35 * 3.0
    assert find(defects(record(motion)), "spike").values["time"] == 15.0


def test_a_repeated_block_is_located():
    motion = shaking()
    begin = at(motion, 0.4)
    values = find(defects(record(*twice(motion, DT, 64))), "repeated_block").values
    assert [values[name] for name in ("start", "length", "again")] == pytest.approx(
        [DT * begin, DT * 64, DT * (begin + 64)]
    )


def test_the_moving_mean_of_the_velocity_is_the_same_in_reversed_time():
    velocity = np.concatenate([np.zeros(300), np.linspace(0.0, 1.0, 701), np.zeros(1000)])
    forwards, backwards = (slow_velocity(np.gradient(one, DT), DT) for one in (velocity, velocity[::-1]))
    assert forwards == pytest.approx(backwards, rel=1e-9)


def test_a_weak_motion_is_noise_only_if_no_second_stands_out():
    """The strongest second is 1.6 times as strong as the median second, then 2.6 times."""
    slow = np.convolve(np.random.default_rng(7).normal(size=TIME.size), np.hanning(20), "same")
    weak = ((1.0 + more * BURST) * slow for more in (0.5, 1.5))
    assert ["noise_only" in codes(0.015 * one / np.max(np.abs(one))) for one in weak] == [True, False]


def test_samples_of_zero_amid_strong_motion_are_told():
    motion = shaking()
    motion[at(motion, 0.2) : at(motion, 0.8) : 25] = 0.0
    assert find(defects(record(motion)), "spike").values["count"] > 5
    spread = np.zeros(2 * motion.size)
    spread[::2] = shaking()
    assert [one.code for one in deciding(condition(record(spread, 0.5 * DT)))] == ["spike"]


def test_coarse_samples_decide_where_the_motion_goes_on_beyond_their_frequencies():
    slow = np.interp(np.arange(0.0, 5990.0, 10.0), np.arange(6000), np.convolve(shaking(), np.hanning(120), "same"))
    assert [one.values["decides"] for one in defects(record(slow, 0.1)) if one.code == "coarse_sampling"] == [False]
    (one,) = [one for one in defects(record(*coarse(shaking(), DT, 0.1))) if one.code == "coarse_sampling"]
    assert one.values["decides"]


@pytest.mark.parametrize("baseline", BASELINES)
def test_a_step_drifts_whatever_baseline_is_subtracted(baseline):
    assert drifts(condition(record(*step(shaking(), DT, 25.0)), baseline))
    assert not drifts(condition(record(shaking(), processed=True), "none"))


def test_a_high_pass_takes_the_velocity_of_a_step_away_so_that_it_does_not_decide():
    stepped = record(*step(shaking(), DT, 25.0), source="made.csv")
    assert [one.code for one in deciding(condition(stepped, "mean"))] == ["velocity_drift"]
    assert deciding(condition(stepped, "mean", highpass_hz=0.3)) == []


def test_a_drift_barely_above_the_rest_of_the_velocity_does_not_decide():
    stepped = condition(record(*step(shaking(), DT, 7.0), source="made.csv"), "mean")
    drift = find(stepped.warnings, "baseline_drift").values
    assert 1.25 < drift["slow"] / drift["rest"] < 1.5
    assert deciding(stepped) == []


def test_a_velocity_that_an_array_without_a_file_leaves_does_not_decide():
    pulse = np.where(abs(TIME - 4.0) < 0.5, 3.0 * np.cos(np.pi * (TIME - 4.0)), 0.0)
    for source, codes in (("", []), ("made.csv", ["velocity_drift"])):
        one = condition(record(pulse, source=source), "none")
        assert drifts(one)
        assert [found.code for found in deciding(one)] == codes


def test_a_velocity_that_comes_back_to_zero_by_the_mean_is_still_seen_to_drift():
    (warning,) = [
        one
        for one in condition(record(*step(shaking(), DT, 25.0)), "mean").warnings
        if code_of(one) == "baseline_drift"
    ]
    assert abs(warning.values["velocity"]) < 0.01 * warning.values["slow"]


def test_samples_are_judged_once_as_they_came():
    one = with_defects(record(*held(shaking(), DT, 1.0)))
    assert one.stage == "checked"
    assert with_defects(one) is one
    conditioned = condition(condition(one, highpass_hz=0.5), "linear")
    assert [code_of(text) for text in conditioned.warnings].count("held_value") == 1
    known = replace(record(np.zeros(300)), warnings=(WarningText("dead_channel"),))
    assert [code_of(text) for text in with_defects(known).warnings] == ["dead_channel"]
