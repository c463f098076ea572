"""Which channels belong together: the vertical one to a horizontal one, and two horizontal ones as a pair."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from rockpulse.record.components import (
    Neighbours,
    align,
    concurrent,
    find_pairs,
    matching_vertical,
    offset,
    place_on_structure,
    select_horizontal,
    sensor_level,
    uncovered,
)
from rockpulse.record.record import Record

VERTICAL = "vertical channel; it was read but not assessed: only horizontal channels are assessed"
START = datetime(2019, 7, 6, 3, 19, 53, tzinfo=UTC)


def record(orientation, start=START, station="CCC", n=100, dt=0.01, source="a.v1", name=""):
    return Record(
        dt * np.arange(n),
        dt,
        id=name or f"{station}.{orientation}",
        network="CI",
        station=station,
        orientation=orientation,
        start_time=start,
        source=source,
    )


def test_later_start_shifts_the_vertical_and_leaves_zeros_before_it():
    up = align(record("vertical", START + timedelta(seconds=0.5)), record("horizontal"))
    assert np.all(up[:50] == 0.0)
    assert up[50:] == pytest.approx(0.01 * np.arange(50))


@pytest.mark.parametrize(("late", "bare"), [(-0.5, 0.5), (0.0, 0.0), (0.4, 0.4), (1.5, 0.99), (-60.0, 0.99)])
def test_a_vertical_channel_leaves_no_more_of_a_record_without_motion_than_there_is(late, bare):
    vertical = record("vertical", START + timedelta(seconds=late))
    assert uncovered(vertical, record("horizontal")) == pytest.approx(bare)


def test_other_sampling_is_interpolated_as_the_piecewise_linear_record_it_is():
    up = align(record("vertical", n=20, dt=0.05), record("horizontal"))
    assert up[:96] == pytest.approx(0.01 * np.arange(96))


def test_same_file_comes_before_a_longer_overlap():
    short = record("vertical", n=30, name="same file")
    long = record("vertical", source="b.v1", name="other file")
    assert matching_vertical(record("horizontal"), [long, short]).id == "same file"


def test_longest_overlap_of_the_station_is_taken_from_other_files():
    ups = [record("vertical", n=n, source=f"{n}.v1", name=str(n)) for n in (30, 90, 60)]
    assert matching_vertical(record("horizontal"), ups).id == "90"


def test_without_times_only_the_same_file_matches():
    one = record("horizontal", start=None)
    assert matching_vertical(one, [record("vertical", start=None, source="b.v1")]) is None
    assert matching_vertical(one, [record("vertical", start=None)]) is not None


def horizontal(azimuth, **options):
    options = {
        "source": "a.v1",
        "station": "CCC",
        "start_time": START,
        "format": "csmip-v1",
        "processed": True,
    } | options
    options = {"channel": f"{azimuth:g}", "id": f"{options['station']}.{azimuth:g}.{options['source']}"} | options
    return Record(np.arange(100.0), 0.01, orientation="horizontal", network="CI", azimuth=azimuth, **options)


def pairs_of(*records):
    pairs, failures = find_pairs(records)
    return [tuple(channel.id for channel in pair.channels) for pair in pairs], failures


def test_two_channels_of_a_file_are_a_pair_and_files_do_not_mix():
    found, failures = pairs_of(*(horizontal(z, source=s) for s in ("a.v1", "b.v1") for z in (90.0, 0.0)))
    assert found == [("CCC.90.a.v1", "CCC.0.a.v1"), ("CCC.90.b.v1", "CCC.0.b.v1")]
    assert not failures


def test_two_files_of_a_station_that_overlap_in_time_are_a_pair():
    later = START + timedelta(seconds=0.3)
    found, _ = pairs_of(horizontal(90.0, source="e.smc"), horizontal(0.0, source="n.smc", start_time=later))
    assert found == [("CCC.90.e.smc", "CCC.0.n.smc")]


@pytest.mark.parametrize(
    "other",
    [
        *({"start_time": start} for start in (START + timedelta(seconds=1.5), None)),
        *({"station": "CLC"}, {"location": "10"}, {"format": "smc"}, {"processed": False}),
    ],
    ids=lambda other: next(iter(other)),
)
def test_what_was_not_recorded_together_is_no_pair(other):
    found, failures = pairs_of(horizontal(90.0, source="e"), horizontal(0.0, source="n", **other))
    assert not found
    assert [failure.stage for failure in failures] == ["pair", "pair"]
    assert all("no second horizontal channel" in failure.reason for failure in failures)
    assert all('components = "horizontal" assesses it as it was recorded' in failure.reason for failure in failures)


def test_sensors_of_one_station_keep_to_themselves():
    codes = {"HNE": 90.0, "HNN": 0.0, "BNE": 90.0, "BNN": 0.0}
    found, _ = pairs_of(*(horizontal(z, source=f"{c}.mseed", channel=c, id=c) for c, z in codes.items()))
    assert found == [("HNE", "HNN"), ("BNE", "BNN")]


def test_three_channels_of_a_building_are_no_pair_whatever_their_order():
    roof = [horizontal(z, id=f"ch{n}", channel=str(n)) for n, z in enumerate((0.0, 90.0, 0.0), 1)]
    for order in (roof, roof[::-1]):
        found, failures = pairs_of(*order)
        assert not found
        assert sorted(failure.reason.split(":")[0] for failure in failures) == ["ch1", "ch2", "ch3"]
        assert all("expected one other horizontal channel" in failure.reason for failure in failures)
        assert all("found 2: " in failure.reason for failure in failures)


def test_a_stray_file_beside_a_pair_does_not_part_it():
    found, failures = pairs_of(horizontal(90.0), horizontal(0.0), horizontal(45.0, source="stray.v1"))
    assert found == [("CCC.90.a.v1", "CCC.0.a.v1")]
    assert "stray.v1: expected one other horizontal channel" in failures[0].reason


def test_one_channel_cannot_serve_two():
    """A long file of one direction, two short ones of the other, one after the other."""
    short = [
        horizontal(0.0, source=name, start_time=START + timedelta(seconds=wait))
        for name, wait in (("n1", -0.3), ("n2", 0.3))
    ]
    found, failures = pairs_of(horizontal(90.0, source="e"), *short)
    assert not found
    assert len(failures) == 3
    assert "recorded together with it, but also with CCC.0.n2: it is not clear which" in failures[1].reason


def test_an_unknown_azimuth_is_told_and_parts_no_pair():
    unknown = horizontal(float("nan"))
    found, failures = pairs_of(horizontal(90.0), unknown, horizontal(0.0))
    assert found == [("CCC.90.a.v1", "CCC.0.a.v1")]
    assert "its azimuth is unknown" in failures[0].reason


def peer(azimuth, source, **options):
    known = {"station": "", "start_time": None, "event": "Loma Prieta, 10/18/1989", "station_name": "Gilroy"}
    return horizontal(azimuth, source=source, format="at2", **{**known, **options})


def test_files_without_times_belong_together_by_folder_event_and_station():
    found, _ = pairs_of(peer(67.0, "x/GIL067.AT2"), peer(337.0, "x/GIL337.AT2"))
    assert found == [(".67.x/GIL067.AT2", ".337.x/GIL337.AT2")]
    up = Record(np.arange(100.0), 0.01, id="up", source="x/GIL-UP.AT2", event="Loma Prieta, 10/18/1989",
                station_name="Gilroy", orientation="vertical")  # fmt: skip
    assert matching_vertical(peer(67.0, "x/GIL067.AT2"), [up]) is up


@pytest.mark.parametrize(("azimuth", "words"), [(np.nan, "its azimuth is unknown"), (0.0, "no second horizontal")])
def test_columns_without_a_partner_are_told_how_to_get_one(azimuth, words):
    _, (row,) = find_pairs([Record([0.0, 1.0], 0.01, id="x.1", azimuth=azimuth, format="columns")])
    assert words in row.reason
    assert "state which two files are a pair ([[records.pair]]), or put both directions into one file" in row.reason
    assert [(one.key, one.choices) for one in row.remedies] == [("pair", ())]


@pytest.mark.parametrize(("azimuth", "kept"), [(90.0, True), (np.nan, False)])
def test_structures_are_assessed_where_asked_for_but_not_what_may_be_vertical(azimuth, kept):
    channel = Record(np.arange(100.0), 0.01, id="roof", orientation="structural", azimuth=azimuth, source="a")
    (listed,) = select_horizontal([channel])[1]
    assert listed.kind == "structural"
    assert "[records] structural = true" in listed.reason
    assert "[records]" not in select_horizontal([channel], configured=False)[1][0].reason
    chosen, failures = select_horizontal([channel], structural=True)
    assert len(chosen) == kept
    assert all("assessed as ground motion" in one.warnings[0] for one in chosen)
    assert all("vertical or in an unknown direction" in failure.reason for failure in failures)


def test_a_channel_on_a_structure_takes_no_vertical_one_and_no_partner_on_the_ground():
    roof = Record(np.arange(100.0), 0.01, id="roof", orientation="structural", azimuth=0.0, source="a.v1",
                  network="CI", station="CCC", start_time=START, format="csmip-v1", processed=True)  # fmt: skip
    assert matching_vertical(roof, [record("vertical")]) is None
    assert not pairs_of(roof, horizontal(90.0))[0]


def test_borehole_and_surface_of_kik_net_are_two_pairs_with_their_own_verticals():
    known = {"format": "knet", "processed": False}
    channels = [
        horizontal(azimuth, channel=f"{word}{depth}", source=f"x.{word}{depth}", **known)
        for word, azimuth in (("EW", 90.0), ("NS", 0.0))
        for depth in "12"
    ]
    pairs, failures = find_pairs(channels)
    assert [[one.channel for one in pair.channels] for pair in pairs] == [["EW1", "NS1"], ["EW2", "NS2"]]
    assert not failures
    ups = [
        replace(one, channel=f"UD{depth}", orientation="vertical")
        for one, depth in zip(channels[:2], "12", strict=True)
    ]
    assert [matching_vertical(one, ups).channel for one in channels] == ["UD1", "UD2", "UD1", "UD2"]


@pytest.mark.parametrize(
    ("others", "taken"),
    [
        ([("BNZ", True, "b"), ("HNZ", True, "c")], "c"),
        ([("HNZ", False, "a.v1"), ("HNZ", True, "b")], "b"),
        ([("BNZ", True, "b")], "b"),
        ([("HHZ", True, "b")], ""),
    ],
)
def test_the_vertical_of_the_same_volume_and_sensor_comes_first(others, taken):
    one = horizontal(90.0, channel="HNE")
    ups = [
        replace(one, channel=channel, processed=processed, source=source, orientation="vertical")
        for channel, processed, source in others
    ]
    found = matching_vertical(one, ups)
    assert ("" if found is None else found.source) == taken


def test_channels_at_two_places_of_a_structure_are_no_pair():
    places = [("90 DEG (ROOF)", 90.0), ("0 DEG (FOOTING)", 0.0), ("0 DEG (roof)", 0.0)]
    channels = [
        replace(horizontal(azimuth), component=component, id=component, orientation="structural")
        for component, azimuth in places
    ]
    assert not pairs_of(*channels[:2])[0]
    assert pairs_of(*channels)[0] == [("90 DEG (ROOF)", "0 DEG (roof)")]


@pytest.mark.parametrize(
    ("depth", "channel", "level"),
    [(0.0, "HNE", 0.0), (3.0, "HNE", 0.0), (3.1, "HNE", 3.1), (100.0, "EW2", 100.0), (2.0, "EW1", 0.0)]
    + [(np.nan, name, level) for name, level in (("EW1", np.inf), ("NS2", 0.0), ("EW11", 0.0), ("", 0.0))],
)
def test_a_sensor_deeper_than_a_cellar_is_in_a_borehole(depth, channel, level):
    assert sensor_level(replace(record("horizontal"), sensor_depth=depth, channel=channel)) == level


def test_sensors_at_other_depths_are_no_pair_and_have_no_vertical_in_common():
    east, north = (
        horizontal(azimuth, source=f"{azimuth}", sensor_depth=depth) for azimuth, depth in ((90.0, 2.0), (0.0, 30.0))
    )
    assert not pairs_of(east, north)[0]
    assert len(pairs_of(east, replace(north, sensor_depth=3.0))[0]) == 1
    assert matching_vertical(east, [replace(record("vertical"), sensor_depth=30.0)]) is None
    assert matching_vertical(north, [replace(record("vertical"), sensor_depth=30.0)]) is not None


@pytest.mark.parametrize(
    ("component", "place"), [("90 Deg (roof )", "ROOF"), ("UP", ""), ("N (2nd floor) x", "2ND FLOOR")]
)
def test_the_place_on_a_structure_stands_behind_the_direction(component, place):
    assert place_on_structure(replace(record("structural"), component=component)) == place


@pytest.mark.parametrize(("wait", "paired"), [(0.49, True), (0.495, True), (0.5, False), (-0.49, True), (-0.5, False)])
def test_half_of_the_shorter_channel_is_enough_in_common(wait, paired):
    """Channels of 0.99 s; the longer one of the pair does not count."""
    late = START + timedelta(seconds=wait)
    one, other = horizontal(90.0, source="e"), horizontal(0.0, source="n", start_time=late)
    assert concurrent(one, other) is concurrent(other, one) is paired
    longer = replace(one, acceleration=np.arange(300.0), start_time=START - timedelta(seconds=2.0))
    assert concurrent(longer, other) is (wait <= 0.495)
    assert len(pairs_of(one, other)[0]) == paired


def test_channels_that_touch_have_nothing_in_common():
    one = record("horizontal", n=101)
    after = [record("vertical", START + timedelta(seconds=wait), name=str(wait)) for wait in (1.0, 0.99)]
    assert matching_vertical(one, after[:1]) is None
    assert matching_vertical(one, after).id == "0.99"
    assert offset(one, after[0]) == 1.0
    assert offset(after[0], one) == -1.0
    assert offset(one, record("vertical", None)) == offset(record("vertical", None), one) == 0.0


def test_files_without_times_need_the_event_and_a_name_and_one_interval():
    for change in ({"dt": 0.02}, {"source": "y/b.AT2"}, {"event": ""}, {"station_name": ""}):
        assert not pairs_of(peer(67.0, "x/a.AT2"), replace(peer(337.0, "x/b.AT2"), **change))[0]
    coded = [replace(peer(azimuth, f"x/{azimuth}.AT2"), station="GIL", station_name="") for azimuth in (67.0, 337.0)]
    assert len(pairs_of(*coded)[0]) == 1
    assert not pairs_of(*(replace(one, station="", station_name="") for one in coded))[0]
    # A time of one of two files keeps them apart, however alike they are.
    assert not pairs_of(peer(67.0, "x/a.AT2"), peer(337.0, "x/b.AT2", start_time=START))[0]


def test_a_channel_in_an_unknown_direction_is_taken_with_a_warning():
    unknown, known, up = (record(one, name=one) for one in ("unknown", "horizontal", "vertical"))
    for structural in (False, True):
        chosen, failures = select_horizontal([unknown, known, up], structural=structural)
        assert [one.id for one in chosen] == ["unknown", "horizontal"]
        assert [one.code for one in chosen[0].warnings] == ["orientation_unknown"]
        assert chosen[1].warnings == ()
        assert [(one.kind, one.reason) for one in failures] == [("vertical", f"vertical: {VERTICAL}")]


def test_among_thousands_of_channels_of_one_station_few_are_looked_at():
    records = [record("horizontal", START + timedelta(minutes=number), source=f"{number}") for number in range(1000)]
    neighbours = Neighbours(records)
    assert max(len(neighbours.of(one)) for one in records) <= 3
