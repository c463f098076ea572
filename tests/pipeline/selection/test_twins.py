"""Volumes of one motion, and components of one instrument, compared before one of them counts."""

import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from shaking import DT, shaking

from rockpulse.config.configuration import Config
from rockpulse.config.settings import RecordSettings
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record, outline_of
from rockpulse.run.analysis import Analysis, run
from rockpulse.selection.twins import clock_candidates, copy_candidates, likeness

START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)
NORTH, EAST = shaking(1), shaking(2)


class Ids(Analysis):
    """Keeps the id and the codes of every motion."""

    name, doing, kind = "measure", "measuring", "ids"

    @property
    def work(self):
        return lambda motion, watch: {"record": [motion.record.id], "warnings": motion.record.warnings}

    @property
    def empty_part(self):
        return {}

    def of_event(self, part, event):
        return part

    def collect(self, parts, planned, failures):
        return [part["record"][0] for part in parts], failures, [text for part in parts for text in part["warnings"]]


def recording(source, processed=False, factor=1.0, late=0.0, north=NORTH, east=EAST, azimuths=(0.0, 90.0)):
    known = {"network": "CI", "station": "CLC", "format": "dyna", "source": source, "processed": processed}
    known |= {"start_time": START + timedelta(seconds=late), "orientation": "horizontal", "dt": DT}
    named = zip("NE", (north, east), azimuths, strict=True)
    return [
        Record(factor * samples, id=f"{source}.{code}", channel=f"HN{code}", azimuth=azimuth, **known)
        for code, samples, azimuth in named
    ]


def seen(*recordings, **settings):
    """Ids that count, reasons of the failed ones, rows of the duplicates, and the warnings of those that count."""
    records = [one for every in recordings for one in every]
    found, rows, warnings = run(Ids(Config(records=RecordSettings(**settings))), records)
    failed = [row.reason for row in rows if row.kind == "failed"]
    return found, failed, [row.reason for row in rows if row.kind == "duplicate"], warnings


def test_two_recordings_of_one_motion_that_agree_count_once():
    filtered = [condition(one, "mean", highpass_hz=0.2, lowpass_hz=25.0).acceleration for one in recording("raw")]
    found, failed, copies, _ = seen(
        recording("raw", late=0.8), recording("cor", True, north=filtered[0], east=filtered[1])
    )
    assert (found, failed, len(copies)) == (["cor.E", "cor.N"], [], 2)


@pytest.mark.parametrize(
    ("twin", "said"),
    [
        ({"factor": 0.01}, "it is 100 times stronger: one of them may be in cm/s2 and read as m/s2"),
        ({"factor": 9.80665}, "it is 9.81 times weaker: one of them may be in g and read as m/s2"),
        ({"factor": 1.6}, "it is 1.6 times weaker"),
        ({"factor": -1.0}, "the sign is opposite"),
        ({"north": EAST, "east": NORTH}, "the labels of the components may be swapped"),
        ({"north": shaking(8), "east": shaking(9)}, "the correlation is "),
    ],
    ids=["cm", "g", "other", "sign", "swapped", "unlike"],
)
def test_a_twin_that_differs_leaves_both_in_doubt_until_one_is_confirmed(twin, said):
    pair = recording("raw"), recording("cor", True, **twin)
    found, failed, _, _ = seen(*pair)
    assert found == []
    assert len(failed) == 2
    for reason, code in zip(failed, "EN", strict=True):
        assert reason.startswith(f"cor.{code}: raw.{code} of raw should be a record of the same ground motion, but")
        assert said in reason
        assert f"give --confirm cor.{code}, or" in reason
    found, failed, _, warnings = seen(*pair, confirm=("cor.*",))
    assert (found, failed) == (["cor.E", "cor.N"], [])
    assert sum(said in text for text in warnings) == 2
    assert seen(*pair, confirm=("raw.*",))[:2] == (["raw.E", "raw.N"], [])
    assert seen(*pair, components="azimuth", azimuth=30.0)[0] == []


def test_azimuths_that_are_opposite_explain_an_opposite_sign():
    turned = recording("cor", True, north=-NORTH, east=-EAST, azimuths=(180.0, 270.0))
    assert seen(recording("raw"), turned)[:2] == (["cor.E", "cor.N"], [])


@pytest.mark.parametrize("late", [3.0, 45.0, 3600.0, -32400.0])
def test_a_twin_whose_clock_is_off_is_still_a_twin(late):
    found, failed, copies, _ = seen(recording("raw", late=late), recording("cor", True))
    assert (found, failed, len(copies)) == (["cor.E", "cor.N"], [], 2)
    found, failed, _, _ = seen(recording("raw", late=late), recording("cor", True, factor=0.01))
    assert (found, len(failed)) == ([], 2)
    assert seen(recording("raw", late=late), recording("cor", True), confirm=("raw.*",))[0] == ["raw.E", "raw.N"]


def test_an_aftershock_is_no_twin():
    after = recording("after", late=3600.0, north=0.4 * shaking(11), east=0.4 * shaking(12))
    assert seen(recording("main"), after)[0] == ["after.E", "after.N", "main.E", "main.N"]


@pytest.mark.parametrize("factor", [9.80665, 15.0, 0.01])
def test_components_of_one_instrument_far_apart_are_in_doubt(factor):
    found, failed, _, _ = seen(recording("a", north=factor * NORTH))
    assert (found, len(failed)) == ([], 2)
    assert all("the other component of its instrument" in reason for reason in failed)
    assert seen(recording("a", north=factor * NORTH), confirm=("a.*",))[0] == ["a.E", "a.N"]
    assert seen(recording("a", north=4.0 * NORTH, late=1.0))[1] == []


@pytest.mark.parametrize("timed", [True, False])
def test_components_of_one_instrument_with_two_intervals_are_in_doubt(timed):
    """In files without times the event and the station show that they belong together."""
    pair = [replace(one, source=f"folder/{one.id}.AT2") for one in recording("a")]
    if not timed:
        pair = [replace(one, start_time=None, event="Ridgecrest", station_name="China Lake") for one in pair]
    uneven = [pair[0], replace(pair[1], dt=DT / 2.0)]
    found, failed, _, _ = seen(uneven)
    assert (found, len(failed)) == ([], 2)
    assert all("the other component of its instrument, " in reason for reason in failed)
    assert seen(uneven, confirm=("a.*",))[0] == ["a.E", "a.N"]
    assert seen(pair)[:2] == (["a.E", "a.N"], [])
    elsewhere = [uneven[0], replace(uneven[1], event="Landers", start_time=None, station="CCC")]
    assert seen(elsewhere)[:2] == (["a.E", "a.N"], [])


@pytest.mark.parametrize(("scale", "turned"), [(1.4, ""), (-1.01, " with the opposite sign")])
def test_a_scaled_copy_in_another_file_is_told(scale, turned):
    """Neither the station nor the direction shows that the two are one motion."""
    one, other = recording("a")[0], recording("b", north=np.round(scale * NORTH, 4))[0]
    other = replace(other, station="AQU", azimuth=45.0, start_time=START + timedelta(days=900.0))
    found, failed, _, warnings = seen([one], [other])
    assert (found, failed) == (["a.N", "b.N"], [])
    for copied in "ab":
        assert f"the samples are those of {copied}.N{turned}: one of them is a copy" in warnings
    late = replace(other, acceleration=np.roll(other.acceleration, 30))
    assert not any("a copy" in text for text in seen([one], [late])[3])


def test_beside_a_channel_of_noise_the_sound_one_counts():
    noise = np.round(2e-3 * np.random.default_rng(3).normal(size=NORTH.size), 6)
    found, (reason,), _, _ = seen(recording("a", north=noise))
    assert found == ["a.E"]
    assert "a.N: no earthquake" in reason


def test_the_outline_of_a_record_stays_with_it_without_its_samples():
    (one, _) = recording("a")
    assert outline_of(one.without_samples()) == outline_of(one)
    assert outline_of(one.without_samples().without_samples()) == outline_of(one)
    assert outline_of(replace(one, acceleration=np.full(500, 0.3))) == ()


def test_likeness_finds_the_shift_the_sign_and_the_ratio_at_another_rate():
    coarse = np.interp(np.arange(0.0, 40.0, 0.02), DT * np.arange(NORTH.size), NORTH)
    like = likeness(Record(NORTH, DT, id="a"), Record(-0.5 * coarse[300:], 0.02, id="b"))
    assert like.correlation < -0.98
    assert like.ratio == pytest.approx(0.5, rel=0.05)
    assert likeness(Record(NORTH, DT, id="a"), Record(np.zeros(900), DT, id="b")).correlation == 0.0


@pytest.mark.sweep
def test_candidates_among_ten_thousand_headers_are_found_quickly():
    rng = np.random.default_rng(0)
    (one, _) = recording("a")
    records = []
    for number in range(10_000):
        times = np.cumsum(rng.uniform(0.5, 3.0, 5)).tolist()
        moved = {"id": f"r{number}", "source": f"f{number}", "start_time": START + timedelta(seconds=80.0 * number)}
        records.append(replace(one.without_samples(), **moved, outline=np.array((one.npts, 1.0, *times)).tobytes()))
    records.append(replace(records[400], id="twin", source="twin", start_time=START))
    began = time.perf_counter()
    assert id(records[-1]) in clock_candidates(records)
    assert time.perf_counter() - began < 20.0


def test_a_scaled_copy_in_another_file_is_found_whatever_the_order_of_the_ids():
    samples = [shaking(seed) for seed in range(3, 9)]
    samples.append(-0.5 * samples[2])
    names = ("f", "b", "d", "a", "e", "c", "copy")
    records = [Record(one, DT, name, source=name) for name, one in zip(names, samples, strict=True)]
    found = copy_candidates(records)
    assert {one.id: found[id(one)].id for one in records if id(one) in found} == {"d": "copy", "copy": "d"}
