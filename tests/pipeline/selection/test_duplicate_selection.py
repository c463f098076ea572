"""Which of several records of one shaking is assessed, and what is said of the others."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from itertools import permutations

import numpy as np
import pytest

from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure
from rockpulse.record.record import Record
from rockpulse.selection.duplicate_selection import unmatched_patterns, without_duplicates
from rockpulse.warning_text import WarningText

START = datetime(2016, 11, 13, 11, 2, 20, tzinfo=UTC)
NAN = float("nan")
PAIRS = RecordSettings(components="sweep")


def channel(azimuth=0.0, source="a.v1", seconds=60.0, dt=0.01, late=0.0, **options):
    """A channel without samples, vertical where its azimuth is NaN."""
    lies = "vertical" if np.isnan(azimuth) else "horizontal"
    code = "Up" if np.isnan(azimuth) else f"{azimuth:g}"
    known = {"network": "NZ", "station": "HSES", "channel": code, "orientation": lies, "processed": False}
    known |= {"start_time": START + timedelta(seconds=late), "id": f"{source}.{code}", "format": "geonet"}
    return Record(np.broadcast_to(0.0, round(seconds / dt) + 1), dt, azimuth=azimuth, source=source, **known | options)


def recording(source, *azimuths, **options):
    return [channel(azimuth, source, **options) for azimuth in azimuths or (0.0, 90.0, NAN)]


def chosen(*records, settings=None):
    """Ids of those that are assessed, and the kind of each that is not, by id."""
    selected, rows, _ = without_duplicates(records, settings)
    assert [one for one in records if one in selected] == selected
    assert all(row.stage == "select" for row in rows)
    return [one.id for one in selected], {row.reason.split(": ")[0]: row.kind for row in rows}


def reason(*records, settings=None):
    """The only row of some records."""
    (row,) = without_duplicates(records, settings)[1]
    return row.reason


def ids(source, *channels):
    return [f"{source}.{code}" for code in channels or ("0", "90", "Up")]


def test_the_surface_comes_before_the_depth_whatever_its_processing():
    deep = recording("a", processed=True, sensor_depth=100.0)
    shallow = recording("b", sensor_depth=0.5)
    assert chosen(*deep, *shallow) == (ids("b"), dict.fromkeys(ids("a"), "depth"))
    assert "this one was recorded 100 m below the ground, the other at the surface" in reason(deep[0], shallow[0])
    deeper = channel(0.0, "c", sensor_depth=200.0)
    assert "200 m below the ground, the other nearer to the surface" in reason(deep[0], deeper)


@pytest.mark.parametrize(
    ("better", "worse", "words"),
    [
        ({"processed": True}, {"processed": None, "dt": 0.005}, "a processed record is preferred to one that may be"),
        ({"processed": None}, {"dt": 0.005}, "one that may be processed is preferred to a raw one"),
        ({"dt": 0.005}, {"seconds": 90.0}, "it has a sample every 0.005 s, this one every 0.01 s"),
        ({"seconds": 90.0}, {"source": "a"}, "it lasts 90 s, this one 60 s"),
        ({"source": "a"}, {}, "both are alike in processing, rate and length; the first by path is used"),
    ],
)
def test_the_order_of_the_rules(better, worse, words):
    records = [channel(**{"source": "z"} | better), channel(**{"source": "c"} | worse)]
    for order in permutations(records):
        assert without_duplicates(order)[0] == [records[0]]
        assert words in reason(*order)


@pytest.mark.parametrize(("azimuth", "same"), [(5.0, True), (180.0, True), (356.0, True), (174.0, False), (6.0, False)])
def test_directions_within_5_degrees_are_one_and_so_are_opposite_ones(azimuth, same):
    assert len(chosen(channel(), channel(azimuth, "b"))[1]) == same


@pytest.mark.parametrize(("late", "same"), [(30.0, True), (30.1, False), (-30.0, True), (-30.1, False), (500.0, False)])
def test_spans_of_time_overlap_by_half_the_shorter(late, same):
    assert len(chosen(channel(), channel(0.0, "b", late=late, seconds=60.0))[1]) == same
    assert len(chosen(channel(seconds=600.0, late=-500.0), channel(0.0, "b", late=min(late, 70.0)))[1]) == 1


@pytest.mark.parametrize(
    "other",
    [
        {"network": "NX"},
        {"station": "HSEX"},
        {"start_time": None},
        {"azimuth": NAN, "orientation": "horizontal"},
        {"orientation": "unknown"},
        {"orientation": "structural"},
    ],
    ids=lambda other: next(iter(other)),
)
def test_a_record_not_known_to_be_of_the_same_motion_is_no_duplicate(other):
    assert chosen(channel(), channel(**{"source": "b"} | other))[1] == {}


def test_two_sensors_of_one_station_are_one_motion():
    one = [channel(z, "a", location="00", id=f"00.{z:g}", channel=f"HN{z:g}", dt=0.01) for z in (0.0, 90.0)]
    other = [channel(z, "a", location="10", id=f"10.{z:g}", channel=f"BN{z:g}", dt=0.02) for z in (2.0, 92.0)]
    assert chosen(*other, *one) == (["00.0", "00.90"], {"10.2": "duplicate", "10.92": "duplicate"})


def test_all_channels_come_from_one_recording_though_single_ones_are_longer():
    first, second = recording("a", seconds=60.0), recording("b", seconds=60.0)
    second[1] = replace(second[1], acceleration=np.broadcast_to(0.0, 9000))
    assert chosen(*first, *second)[0] == ids("b")


def test_files_of_single_channels_in_one_folder_are_a_recording():
    def files(folder, **options):
        return [
            channel(azimuth, f"{folder}/{name}.acc", id=f"{folder}.{name}", **options)
            for name, azimuth in (("E", 90.0), ("N", 0.0), ("Z", NAN))
        ]

    a, b = files("a"), files("b", late=0.004)
    b[0] = replace(b[0], acceleration=np.broadcast_to(0.0, 9000))
    assert chosen(*a, *b)[0] == ["b.E", "b.N", "b.Z"]
    # A second file of one direction in the same folder is of another recording.
    again = channel(90.0, "a/E2.acc", id="a.E2")
    assert chosen(*a, again) == (["a.E", "a.N", "a.Z"], {"a.E2": "duplicate"})


def test_a_direction_that_only_the_other_recording_has_is_used_with_its_own_vertical_channel():
    processed = recording("b", 0.0, NAN, processed=True)
    assert chosen(*recording("a"), *processed) == (["a.90", "a.Up", "b.0", "b.Up"], {"a.0": "duplicate"})


def test_where_pairs_are_asked_for_a_recording_with_a_pair_goes_first():
    raw, processed = recording("a"), recording("b", 0.0, NAN, processed=True)
    selected, rows = chosen(*raw, *processed, settings=PAIRS)
    assert (selected, rows) == (ids("a"), {"b.0": "duplicate", "b.Up": "duplicate"})
    assert "its recording has two horizontal channels" in reason(*raw[:2], processed[0], settings=PAIRS)
    # A pair at depth does not go before what there is at the surface.
    deep = recording("c", 0.0, 90.0, sensor_depth=50.0)
    assert chosen(*deep, processed[0], settings=PAIRS)[1] == {"c.0": "depth"}


def test_a_pair_holds_the_motion_in_every_direction():
    turned = recording("b", 30.0, 120.0)
    assert chosen(*recording("a", 0.0, 90.0), *turned)[1] == {}
    assert chosen(*recording("a", 0.0, 90.0), *turned, settings=PAIRS)[1] == {"b.30": "duplicate", "b.120": "duplicate"}
    assert "b.30: duplicate of the pair with a.0 in a" in reason(*recording("a", 0.0, 90.0), turned[0], settings=PAIRS)
    # A record that the pair does not cover in time is no duplicate.
    early = recording("b", 30.0, 120.0, late=-40.0)
    assert chosen(*recording("a", 0.0, 90.0), *early, settings=PAIRS)[1] == {}


def test_where_the_vertical_channel_acts_a_recording_with_one_goes_first():
    raw, processed = recording("a"), recording("b", 0.0, 90.0, processed=True)
    assert chosen(*raw, *processed)[0] == ["a.Up", "b.0", "b.90"]
    upwards = RecordSettings(include_vertical=True)
    assert chosen(*raw, *processed, settings=upwards) == (ids("a"), {"b.0": "duplicate", "b.90": "duplicate"})
    assert "its recording has a vertical channel" in reason(*raw, processed[0], settings=upwards)


def test_a_dead_channel_yields_to_a_live_one_of_any_recording():
    dead = channel(0.0, "b", processed=True, warnings=(WarningText("dead_channel"),))
    assert chosen(dead, channel()) == (["a.v1.0"], {"b.0": "duplicate"})
    assert "this channel is dead" in reason(dead, channel())
    assert chosen(dead) == (["b.0"], {})


def test_a_peak_that_nobody_has_confirmed_yields_to_another_record_of_its_motion():
    odd = WarningText("odd_peak", peak=53.0, unit="m/s2", readings="0.53 g if it were cm/s2")
    wrong = recording("b.V2A", processed=True, warnings=(odd,))
    raw = recording("a.V1A")
    for settings in (None, PAIRS):
        assert chosen(*raw, *wrong, settings=settings) == (ids("a.V1A"), dict.fromkeys(ids("b.V2A"), "duplicate"))
    assert "this one has a peak of 53 g, which has not been confirmed" in reason(raw[0], wrong[0])
    assert chosen(*wrong) == (ids("b.V2A"), {})
    confirmed = RecordSettings(confirm=("b.V2A.*",))
    assert chosen(*raw, *wrong, settings=confirmed)[0] == ids("b.V2A")


@pytest.mark.parametrize("settings", [None, PAIRS, RecordSettings(include_vertical=True)])
@pytest.mark.parametrize(
    "fault", [WarningText("dead_channel"), WarningText("odd_peak", peak=9.0, unit="g", readings="-")]
)
def test_of_a_recording_with_one_channel_that_cannot_be_used_nothing_is_mixed_with_another(fault, settings):
    raw, processed = recording("a.V1A"), recording("b.V2A", processed=True)
    processed[0] = replace(processed[0], warnings=(fault,))
    assert chosen(*raw, *processed, settings=settings) == (ids("a.V1A"), dict.fromkeys(ids("b.V2A"), "duplicate"))


def test_members_at_the_root_of_two_archives_are_of_two_recordings():
    def members(archive, **options):
        named = (("E", 90.0), ("N", 0.0))
        return [channel(az, f"/d/{archive}.zip!{name}", id=f"{archive}.{name}", **options) for name, az in named]

    one, two = members("one"), members("two")
    one[1] = replace(one[1], start_time=START + timedelta(seconds=0.002))
    two[0] = replace(two[0], start_time=START + timedelta(seconds=0.001))
    two[1] = replace(two[1], acceleration=np.broadcast_to(0.0, 9000))
    assert chosen(*one, *two)[0] == ["two.E", "two.N"]


def test_places_on_a_structure_are_motions_of_their_own():
    def roof(place, source, **options):
        return channel(0.0, source, component=f"0 Deg ({place})", orientation="structural", **options)

    records = [roof("Roof", "a"), roof("roof", "b", processed=True), roof("Base", "c"), channel(0.0, "d")]
    assert chosen(*records)[1] == {}  # they are left out as structural ones anyway
    taken = RecordSettings(structural=True)
    assert chosen(*records, settings=taken) == (["b.0", "c.0", "d.0"], {"a.0": "duplicate"})
    nowhere = [replace(one, component="0 Deg") for one in records[:2]]
    assert chosen(*nowhere, settings=taken)[1] == {}


def test_a_pattern_that_fits_no_record_is_an_error_where_every_file_was_read():
    settings = RecordSettings(keep=("a.*", "x.*"))
    with pytest.raises(ConfigError, match=r"\[records\] keep: no record id matches x\.\*; the ids are a\.0"):
        without_duplicates(recording("a"), settings, [Failure("n.txt", "read", "no record", "skipped")])
    (row,) = without_duplicates(recording("a"), settings, [Failure("x", "read", "x: damaged", "failed")])[1]
    assert (row.file, row.stage, row.kind) == ("[records] keep", "select", "failed")
    assert "x.*" in row.reason
    with pytest.raises(ConfigError, match="the ids are none; correct"):
        unmatched_patterns("[records] keep", ["*"], [])


def test_a_long_record_that_is_left_out_for_a_short_one_is_told_as_such():
    told = reason(channel(seconds=3600.0), channel(0.0, "b", processed=True, late=1000.0))
    assert "3540 s of the 3600 s of this record are not in that one" in told
    assert "are not in that" not in reason(channel(), channel(0.0, "b", processed=True))


@pytest.mark.sweep
def test_thousands_of_records_of_many_stations_and_times_are_settled_at_once():
    records = [
        channel(azimuth, f"{source}{n}", station=f"S{n % 50}", late=1000.0 * (n // 50), id=f"{source}{n}.{azimuth}")
        for n in range(400)
        for source in "ab"
        for azimuth in (0.0, 90.0)
    ]
    selected, rows, _ = without_duplicates(records)
    assert {one.source[0] for one in selected} == {"a"}
    assert (len(selected), len(rows)) == (800, 800)
