"""Which records are of one earthquake: by file, time and name; the user's table; labels that keep events apart."""

import random
import time
from datetime import UTC, datetime, timedelta
from itertools import combinations

import pytest

from rockpulse.config.configuration import Config, load_config
from rockpulse.errors import ConfigError, Failure
from rockpulse.readers.folders import read_all
from rockpulse.record.record import Record
from rockpulse.selection.events import (
    JOINED_WITHIN_S,
    UNKNOWN,
    _agree,
    _of_one_name,
    _that_may_agree,
    event_table,
    events_by_id,
    group_events,
)

NOON = datetime(2016, 10, 30, 6, 40, tzinfo=UTC)


def moment(seconds):
    """A time that many seconds after the origin of the test; a time of the calendar, and None, stay what they are."""
    return seconds if seconds is None or isinstance(seconds, datetime) else NOON + timedelta(seconds=seconds)


def record(name, event="", start=None, source=None, origin=None, **known):
    """A record with only what tells its earthquake; `start` and `origin` in s after the origin of the test."""
    known |= {"start_time": moment(start), "origin_time": moment(origin), "source": source or f"{name}.txt"}
    return Record([0.0, 1.0], dt=0.01, id=name, event=event, **known)


def partition(records, named=None):
    """The groups as a set of sets of ids."""
    groups = {}
    for one, label in zip(records, group_events(records, named), strict=True):
        groups.setdefault(label, set()).add(one.id)
    return sorted(sorted(group) for group in groups.values())


def by_titles(*titles):
    """Groups of records without times, as lists of places."""
    labels = group_events([record(f"r{place}", title) for place, title in enumerate(titles)])
    return [labels.index(label) for label in labels]


def test_records_of_one_file_are_of_one_earthquake():
    records = [record("a", "Norcia", 0, "x.v1"), record("b", "Kobe", 1e6, "x.v1"), record("c", source="y.v1")]
    assert partition(records) == [["a", "b"], ["c"]]


@pytest.mark.parametrize(("apart", "together"), [(0.0, True), (JOINED_WITHIN_S, True), (JOINED_WITHIN_S + 1.0, False)])
def test_untitled_records_are_joined_by_time(apart, together):
    assert (partition([record("a", start=0), record("b", start=apart)]) == [["a", "b"]]) == together


def test_joining_is_transitive():
    chain = [record("a", start=0), record("b", start=1100), record("c", start=550), record("d", "Visso", 1100)]
    chain += [record("e", "VISSO EARTHQUAKE"), record("f", source="e.txt"), record("g", start=5000)]
    assert partition(chain) == [["a", "b", "c", "d", "e", "f"], ["g"]]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("KOBE 01/16/95 2046", "Kobe"),
        ("Loma Prieta, 10/18/1989", "Loma Prieta, CA"),
        ("NORTHRIDGE EARTHQUAKE JAN 17, 1994 -1230 GMT", "NORTHRIDGE EARTHQUAKE"),
        ("WHITTIER NARROWS, CA, EARTHQUAKE", "Whittier Narrows-01, 10/1/1987"),
        ("El Mayor-Cucapah, 4/4/2010", "EL MAYOR CUCAPAH 2010"),
        ("L'Aquila", "L'AQUILA MAINSHOCK"),
        ("Düzce", "DÜZCE 12/11/1999"),
        ("0911131", "0911131"),
    ],
)
def test_titles_of_one_earthquake(one, other):
    assert by_titles(one, other) == [0, 0]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("Kobe", "Maule"),
        ("Imperial Valley-06, 10/15/1979", "Imperial Valley-02, 5/19/1940"),
        ("Chi-Chi, Taiwan-03, 9/20/1999", "Chi-Chi, Taiwan-06, 9/25/1999"),
        ("IMPERIAL VALLEY 10/15/79 2319", "IMPERIAL VALLEY 05/19/40 0439"),
        ("Central Italy 2009", "Central Italy 2016-10-30"),
        ("2017/07/20 22:31:09 (GMT) M 6.5 Mw", "2019/09/26 10:59:26 (GMT) M 5.8 Mw"),
        ("2004/01/01 23:58:02.7 Mb=5.2/Ms=5.8", "2003/01/22 02:06:34.0 Mb=6.1/Ms=7.6"),
        ("Rcrd of Fri Jul 5, 2019 20:19:37.0 PDT", "Rcrd of Sun Aug 24, 2014 03:20:33.0 PDT"),
        ("M 6.5", "M 6.6"),
    ],
)
def test_titles_of_different_earthquakes(one, other):
    assert by_titles(one, other) == [0, 1]


@pytest.mark.parametrize("title", ["", "Unknown", "EARTHQUAKE"])
def test_records_that_state_neither_name_nor_time_count_as_one_earthquake(title):
    """They may all be of one: as many earthquakes as files would be a statement of confidence that nothing supports."""
    records = [record("a", title), record("b", title), record("c", "Kobe"), record("d", title, 0), record("e")]
    assert group_events(records) == [UNKNOWN, UNKNOWN, "Kobe", "2016-10-30 06:40", UNKNOWN]
    assert group_events(records, {"a": "mine", "e": "mine"}) == ["mine", UNKNOWN, "Kobe", "2016-10-30 06:40", "mine"]


def test_a_title_that_tells_less_joins_what_it_may_be():
    """Fewer events are on the safe side; the user's table separates them."""
    titles = ["Imperial Valley-06, 10/15/1979", "Imperial Valley-02, 5/19/1940", "IMPERIAL VALLEY"]
    assert by_titles(*titles) == [0, 0, 0]
    assert by_titles(*titles, "Imperial Valley, 1979") == [0, 0, 0, 0]
    assert by_titles(*titles[:2], "Imperial Valley, 1979") == [0, 1, 0]


@pytest.mark.parametrize(("hours", "together"), [(1, True), (13, True), (25, False), (24 * 365, False)])
def test_a_clock_may_be_off_by_its_time_zone(hours, together):
    records = [record("a", "Muisne", 0), record("b", "MUISNE EARTHQUAKE", 3600.0 * hours)]
    assert (partition(records) == [["a", "b"]]) == together


def test_a_title_without_time_joins_the_clock_of_its_year():
    known = record("a", "Kaikoura", datetime(2016, 11, 13, 11, 2, 20, tzinfo=UTC))
    assert partition([known, record("b", "Kaikoura 14/11/2016")]) == [["a", "b"]]
    assert partition([known, record("b", "Kaikoura 1968")]) == [["a"], ["b"]]


def test_earthquakes_with_one_title_have_labels_of_their_own():
    """A region as the title: the records are kept apart by time, and so must their labels be."""
    records = [
        record("a", "GREECE", 0),
        record("b", "GREECE", 10),
        record("c", "GREECE", 3e6),
        record("d", "ITALY", 9e6),
    ]
    assert group_events(records) == [
        "GREECE (2016-10-30 06:40)",
        "GREECE (2016-10-30 06:40)",
        "GREECE (2016-12-04 00:00)",
        "ITALY",
    ]


def test_the_label_is_the_title_that_most_records_have():
    records = [record("a", "", 0), record("b", "NORCIA", 1), record("c", "Visso", 2), record("d", "Visso", 3)]
    assert set(group_events(records)) == {"Visso"}
    assert set(group_events([record("a", "2016103006", 0), record("b", "Visso", 1)])) == {"Visso"}
    assert group_events([record("a", "", 0)]) == ["2016-10-30 06:40"]


def test_the_order_of_the_records_does_not_matter():
    records = [record("a", "GREECE", 0), record("b", "GREECE", 3e6), record("c", "Unknown"), record("d", "KOBE 1995")]
    records += [record("e", "Kobe"), record("f", "", 30), record("g", "", 600), record("h", source="c.txt")]
    expected = dict(zip([one.id for one in records], group_events(records), strict=True))
    assert len(set(expected.values())) == 4, expected
    for seed in range(20):
        shuffled = random.Random(seed).sample(records, len(records))
        assert dict(zip([one.id for one in shuffled], group_events(shuffled), strict=True)) == expected


def test_the_table_of_the_user_decides():
    records = [record("a", "Norcia", 0), record("b", "Norcia", 1), record("c", "Norcia", 2), record("d", "Kobe")]
    assert group_events(records, {"b": "aftershock"}) == ["Norcia", "aftershock", "Norcia", "Kobe"]
    assert group_events(records, {"a": "x", "d": "x"}) == ["x", "Norcia", "Norcia", "x"]


def test_a_record_in_the_table_joins_nobody_else():
    """Without b nothing connects a and c."""
    records = [record("a", start=0), record("b", start=500), record("c", start=1000)]
    assert partition(records) == [["a", "b", "c"]]
    assert partition(records, {"b": "own"}) == [["a"], ["b"], ["c"]]


def test_a_record_of_a_file_that_was_not_read_is_a_row_else_an_error():
    records, named = [record("a", "Kobe"), record("b")], {"a": "mine", "x": "other"}
    assert events_by_id(records, {"a": "mine"}) == ({"a": "mine", "b": UNKNOWN}, [])
    unread = Failure("x.v1", "read", "damaged", "failed")
    events, (row,) = events_by_id(records, named, [unread])
    assert events == {"a": "mine", "b": UNKNOWN}
    assert (row.stage, row.kind) == ("events", "failed")
    said = "[records] events names records that were not read: x; examples of the records that were read: a, b: "
    assert row.reason.startswith(said)
    _, (row,) = events_by_id(records, {f"x{number}": "e" for number in range(7)}, [unread])
    assert "not read: x0, x1, x2, x3, x4 and 2 more; examples of" in row.reason
    unlike = Failure("y.txt", "pair", "y.1: expected equal intervals", "failed")
    assert events_by_id(records, {"a": "mine", "y.1": "e"}, [unlike]) == ({"a": "mine", "b": UNKNOWN}, [])
    for kind in ("skipped", "duplicate"):
        with pytest.raises(ConfigError, match=r"no record has the id x; .* such as a, b"):
            events_by_id(records, named, [Failure("x.v1", "read", "no record", kind)])


def test_the_table_of_a_configuration(tmp_path):
    (tmp_path / "events.csv").write_text("record,event\na,Kobe\n")
    (tmp_path / "site.toml").write_text('[records]\nevents = "events.csv"\n')
    assert event_table(load_config(tmp_path / "site.toml")) == {"a": "Kobe"}
    assert event_table(Config()) == {}


@pytest.mark.parametrize(("named", "words"), [({"x": "e"}, "no record has the id x"), ({"a": " "}, "earthquake for a")])
def test_a_table_that_is_wrong_is_named(named, words):
    with pytest.raises(ConfigError, match=words):
        group_events([record("a")], named)


@pytest.mark.sweep
def test_real_records(records_folder):
    """Every file of the folder, by what its name says of the earthquake."""
    records, _ = read_all([str(records_folder)])
    labels = group_events(records)
    event_of = {one.source.rsplit("/", 1)[-1]: label for one, label in zip(records, labels, strict=True)}
    assert len(set(labels)) > 20
    same = [
        {"RSN763_LOMAP_GIL067.AT2", "RSN763_LOMAP_GIL337.AT2", "891018_1.cra-1.0210j.smc"},
        {"017m30lw.e0a", "LA116TH.RAW"},
        {"274o42pv.s0a", "0165b_a.smc"},
        {"20161113_110300_HSES_20.V1A", "20161113_110313_THZ_20.V2A"},
    ]
    for files in same:
        assert len({event_of[name] for name in files}) == 1, files
    different = [next(iter(sorted(files))) for files in same] + ["NIS090.AT2", "CE58667.V2", "2516b_a.smc"]
    assert len({event_of[name] for name in different}) == len(different)


@pytest.mark.parametrize(
    ("known", "together"),
    [
        ({"format": "dyna"}, True),
        ({"format": "cosmos"}, False),
        ({"format": "dyna", "origin": 500.0}, True),
        ({"format": "dyna", "origin": 86400.0}, False),
    ],
)
def test_records_of_one_event_id_of_one_format_are_of_one_earthquake(known, together):
    one = record("a", "Elbistan", format="dyna", event_id="13194", origin=0.0)
    other = record("b", "Gaziantep", event_id="13194", start=None, **known)
    assert (partition([one, other]) == [["a", "b"]]) == together


@pytest.mark.parametrize(
    ("apart", "sizes", "together"),
    [
        (0.0, (7.7, 7.8), True),
        (60.0, (7.7, float("nan")), True),
        (61.0, (7.7, 7.7), False),
        (20.0, (7.7, 6.6), False),
        (20.0, (4.9, 5.8), True),
    ],
)
def test_untitled_records_of_one_origin_time_and_like_magnitudes_are_of_one_earthquake(apart, sizes, together):
    one, other = (
        # Clocks of the records that were never set do not matter.
        record(name, start=start, origin=origin, magnitude=size)
        for name, start, origin, size in zip("ab", (0.0, 5e6), (0.0, apart), sizes, strict=True)
    )
    assert (partition([one, other]) == [["a", "b"]]) == together


def test_shocks_of_one_name_are_told_apart_by_their_origin_times():
    """Kahramanmaras, 6 February 2023: M 7.7 at 01:17:32, M 7.6 at 10:24:47 UTC, within the same day."""
    first, second = datetime(2023, 2, 6, 1, 17, 32, tzinfo=UTC), datetime(2023, 2, 6, 10, 24, 47, tzinfo=UTC)
    records = [
        record("a", "Kahramanmaras", first + timedelta(seconds=9), origin=first),
        record("b", "KAHRAMANMARAS EARTHQUAKE", second + timedelta(seconds=9), origin=second),
        record("c", "Kahramanmaras", origin=second + timedelta(seconds=3)),
    ]
    assert partition(records) == [["a"], ["b", "c"]]
    unstated = [record(one.id, one.event, one.start_time) for one in records]
    assert partition(unstated) == [["a", "b", "c"]]


def test_shocks_within_minutes_are_told_apart_by_their_origin_times():
    """Records that begin within ten minutes are one earthquake, unless both files say that they are two."""
    shocks = [record("a", start=5, origin=0), record("b", start=600, origin=-1), record("c", start=604, origin=601)]
    assert partition(shocks) == [["a", "b"], ["c"]]
    assert partition([*shocks, record("d", start=300)]) == [["a", "b", "c", "d"]]


def test_an_origin_time_stands_for_a_start_that_is_not_known():
    records = [record("film", "NORCIA", origin=0), record("digital", start=45), record("later", start=700)]
    assert partition(records) == [["digital", "film"], ["later"]]
    assert group_events([record("a", origin=0)]) == ["2016-10-30 06:40"]
    assert partition([record("a", "Kobe 1995", origin=0), record("b", "Kobe")]) == [["a", "b"]]
    assert partition([record("a", "Kobe", origin=0), record("b", "Kobe 1995")]) == [["a"], ["b"]]


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("apart", "known"),
    [(86400.0, {"event_id": "38457511", "format": "sac"}), (1.0, {"event": "Kobe"}), (900.0, {"event": "Kobe"})],
)
def test_thousands_of_records_of_one_earthquake_by_its_id_or_name_are_grouped_at_once(apart, known):
    origins = (None, 0.0, 30.0)
    records = [record(f"r{k}", start=apart * k, origin=origins[k % 3], **known) for k in range(4000)]
    began = time.perf_counter()
    assert len(set(group_events(records))) == 1
    assert time.perf_counter() - began < 2.0


@pytest.mark.sweep
def test_records_of_one_name_are_joined_as_if_each_was_held_against_each():
    draw = random.Random(7)
    titles = ("Kobe", "KOBE 01/16/95", "Kobe-02", "Kobe-03", "Kobe-02 1995", "Kobe-04 2016", "Kobe 2016", "kobe 2017")
    for _ in range(100):
        times = [draw.choice((None, draw.randrange(0, 86400 * 400, 43000))) for _ in range(12)]
        records = [
            record(f"r{k}", draw.choice(titles), start, origin=draw.choice((None, None, 0.0, 7200.0)))
            for k, start in enumerate(times)
        ]
        free = range(len(records))
        by_all = connected(free, [pair for pair in combinations(free, 2) if _agree(*(records[k] for k in pair))])
        assert connected(free, _of_one_name(records, free)) == by_all


@pytest.mark.sweep
def test_few_pairs_of_thousands_of_shocks_of_one_name_are_held_against_each_other():
    """A national inventory: the name of the country, the date, no time; or the time and no date."""
    dated = [record(f"r{k}", f"Iran-{k % 100:02d}, 1/{k % 28 + 1}/{1920 + k // 28}") for k in range(1000)]
    timed = [record(f"t{k}", "Iran", start=200_000.0 * k) for k in range(1000)]
    for records in (dated, timed):
        assert len(list(_that_may_agree(records, range(len(records))))) <= 30 * len(records)
    assert len(set(group_events(timed))) == 1000


def connected(free, pairs):
    """The sets that pairs connect."""
    groups = {k: {k} for k in free}
    for one, other in pairs:
        joined = groups[one] | groups[other]
        groups.update(dict.fromkeys(joined, joined))
    return sorted(map(sorted, {frozenset(group) for group in groups.values()}))


def test_shocks_apart_are_joined_by_a_record_of_their_name_without_origin_time():
    shocks = [record("a", "Pazarcik", origin=0.0), record("b", "Pazarcik", origin=9 * 3600.0)]
    assert partition(shocks) == [["a"], ["b"]]
    assert partition([*shocks, record("c", "Pazarcik")]) == [["a", "b", "c"]]
