"""Records to `obspy.Trace` and back: nothing is lost, and nothing is guessed."""

import gzip
import io
import pickle
import subprocess
import sys
from dataclasses import fields, replace
from datetime import UTC, datetime
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
import obspy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obspy.core.inventory.response import InstrumentSensitivity, Response
from record_writers import at2, csmip_equal, pulse

import rockpulse as rp
from rockpulse.errors import ConfigError, RecordFormatError, RecordRefused, UnitError
from rockpulse.readers import FORMATS
from rockpulse.readers.obspy_plugin import PLUGINS
from rockpulse.readers.source import NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.warning_text import WarningText, code_of

TEXT = st.text(max_size=12)
UNKNOWN = st.just(float("nan"))
MOMENTS = st.none() | st.datetimes(datetime(1933, 1, 1), datetime(2100, 1, 1), timezones=st.just(UTC))
_TEXTS = ("id", "network", "station", "location", "channel", "component", "station_name", "source", "source_sha256")
_TEXTS += ("format", "source_unit", "event", "event_id", "magnitude_type", "site_class")
#: Fields of numbers that may be unknown, and their bounds.
_BOUNDS = {"azimuth": (0.0, 360.0), "header_peak": (0.0, 100.0), "magnitude": (-1.0, 10.0), "vs30": (30.0, 5e3)}
_BOUNDS |= {"hypocentre_latitude": (-90.0, 90.0), "hypocentre_longitude": (-180.0, 180.0)}
_BOUNDS |= {"station_latitude": (-90.0, 90.0), "station_longitude": (-180.0, 180.0)}
_BOUNDS |= {"hypocentre_depth": (0.0, 8e5), "epicentral_distance": (0.0, 2e7)}
RECORDS = st.builds(
    Record,
    acceleration=st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=20),
    dt=st.floats(1e-4, 1.0),
    orientation=st.sampled_from(["horizontal", "vertical", "structural", "unknown"]),
    unit_factor=st.floats(1e-9, 1e3),
    processed=st.sampled_from([True, False, None]),
    **dict.fromkeys(("start_time", "origin_time"), MOMENTS),
    **dict.fromkeys(("warnings", "processing"), st.lists(TEXT, max_size=2).map(tuple)),
    **dict.fromkeys(_TEXTS, TEXT),
    **{name: st.floats(*bounds) | UNKNOWN for name, bounds in _BOUNDS.items()},
)


def same(one: Record, other: Record) -> bool:
    """Every field, bit by bit; NaN is NaN."""
    pairs = [(getattr(one, field.name), getattr(other, field.name)) for field in fields(Record)[1:]]
    return np.array_equal(one.acceleration, other.acceleration) and all(
        type(left) is type(right) and (left == right or (left != left and right != right)) for left, right in pairs
    )


@pytest.mark.sweep
@settings(derandomize=True, max_examples=25, deadline=None)
@given(RECORDS)
def test_the_way_there_and_back_keeps_every_field(record):
    trace = rp.to_trace(record)
    assert same(rp.from_trace(trace), record)
    assert same(rp.from_trace(pickle.loads(pickle.dumps(trace))), record)
    assert same(rp.from_trace(trace, units="m/s/s"), record)


def test_warnings_come_back_with_their_codes():
    warning = WarningText("of_vertical", warning=WarningText("clipped", count=7, end="smallest"))
    trace = rp.to_trace(Record([0.1, -0.2], 0.01, "a.90", warnings=("another", warning)))
    for one in (trace.copy(), pickle.loads(pickle.dumps(trace))):
        back = rp.from_trace(one).warnings
        assert back == ("another", warning)
        assert [code_of(text) for text in back] == ["plain", "of_vertical/clipped"]
        assert back[1].values["warning"].values == {"count": 7, "end": "smallest"}


def plain(samples=(0.0, 1.0, -2.0, 0.5), **stats):
    header = {"network": "XX", "station": "ABC", "channel": "HNE", "sampling_rate": 100.0}
    return obspy.Trace(np.array(samples), {**header, "starttime": obspy.UTCDateTime(2020, 1, 2, 3, 4, 5), **stats})


@pytest.fixture
def record():
    return Record([0.1, -0.2, 0.3, 0.0], 0.01, "a.90", channel="90", azimuth=90.0, processing=("mean removed",))


def test_the_trace_has_what_obspy_has_a_place_for():
    record = Record([1.0, 2.0], 0.005, "a", "CI", "CLC", "00", "HNE", start_time=datetime(2019, 7, 6, 3, 16, 8, 5, UTC))
    trace = rp.to_trace(record)
    assert trace.id == "CI.CLC.00.HNE"
    assert (trace.stats.calib, trace.stats.delta, trace.stats.npts) == (1.0, 0.005, 2)
    assert trace.stats.starttime == obspy.UTCDateTime("2019-07-06T03:16:08.000005")
    trace.data[0] = 7.0  # a copy: the record stays what it is
    assert record.acceleration[0] == 1.0


def test_a_missing_start_time_is_marked_and_stays_missing(record):
    trace = rp.to_trace(record)
    assert trace.stats.starttime == obspy.UTCDateTime(0)
    assert trace.stats.rockpulse.start_time_known is False
    trace.trim(trace.stats.starttime + 0.01)
    assert rp.from_trace(trace).start_time is None


def test_what_obspy_did_to_the_samples_is_taken_over(record):
    trace = rp.to_trace(record)
    trace.detrend("demean")
    back = rp.from_trace(trace)
    assert back.acceleration.mean() == pytest.approx(0.0, abs=1e-15)
    assert back.processing[0] == "mean removed"
    assert "detrend" in back.processing[1]
    trace.decimate(2, no_filter=True)
    assert rp.from_trace(trace).dt == 0.02


def test_an_interval_that_obspy_keeps_as_a_rate_is_that_of_the_record_and_a_changed_one_is_not(record):
    trace = rp.to_trace(replace(record, dt=0.0049))
    trace.stats.sampling_rate = 1.0 / 0.0049
    assert rp.from_trace(trace).dt == 0.0049
    for off in (1e-9, -1e-9, 5e-12):
        trace.stats.delta = 0.0049 * (1.0 + off)
        assert rp.from_trace(trace).dt == trace.stats.delta


def test_an_integrated_trace_is_no_acceleration_unless_the_unit_is_given(record):
    trace = rp.to_trace(record)
    trace.integrate()
    with pytest.raises(UnitError, match=r"changed the unit of its values: ObsPy .*integrate"):
        rp.from_trace(trace)
    trace.differentiate()
    back = rp.from_trace(trace, units="m/s2")
    assert [step.partition("(")[0].split()[-1] for step in back.processing[1:]] == ["integrate", "differentiate"]
    assert back.azimuth == 90.0


NORTH = Record([0.1, -0.2, 0.3], 0.01, "CI.CLC..HNN", "CI", "CLC", "", "HNN", "360 Deg", "horizontal", 0.0)
EAST = replace(NORTH, id="CI.CLC..HNE", channel="HNE", component="90 Deg", azimuth=90.0)


def test_a_rotated_trace_has_no_direction_until_one_is_given():
    stream = obspy.Stream([rp.to_trace(NORTH), rp.to_trace(EAST)]).rotate("NE->RT", back_azimuth=30.0)
    radial, transverse = map(rp.from_trace, stream)
    assert [trace.stats.channel for trace in stream] == ["HNR", "HNT"]
    for back, before in ((radial, NORTH), (transverse, EAST)):
        assert (back.orientation, np.isnan(back.azimuth), back.component) == ("unknown", True, "")
        assert back.id != before.id
        assert f"the codes were {before.id} when the trace was made" in back.warnings[-1]
        assert "the direction is no longer known" in back.warnings[-1]
    given = rp.from_trace(stream[0], azimuth=-150.0)
    assert (given.orientation, given.azimuth, given.component) == ("horizontal", 210.0, "")
    assert not any("direction" in warning for warning in given.warnings)
    # The radial axis points away from the source: by hand, in the direction of 210 degrees.
    turned = np.deg2rad(210.0)
    by_hand = NORTH.acceleration * np.cos(turned) + EAST.acceleration * np.sin(turned)
    assert given.acceleration == pytest.approx(by_hand, abs=1e-12)


def test_a_new_station_code_makes_a_new_id_and_keeps_the_direction():
    trace = rp.to_trace(replace(EAST, start_time=datetime(2020, 1, 2, 3, 4, 5, tzinfo=UTC)))
    trace.stats.station = "ABC"
    back = rp.from_trace(trace)
    assert (back.id, back.azimuth, back.component) == ("CI.ABC..HNE@20200102T030405", 90.0, "90 Deg")
    assert "the codes were CI.CLC..HNE" in back.warnings[-1]


def test_a_trace_that_lost_its_codes_has_an_id_of_its_name(record):
    trace = rp.to_trace(replace(record, station_name="Town Hall"))
    trace.stats.channel = ""
    assert rp.from_trace(trace).id == "Town_Hall.1"
    trace = rp.to_trace(replace(record, station_name="Town Hall", source="a.zip!b/c.AT2"))
    trace.stats.channel = ""
    assert rp.from_trace(trace).id == "c.1"
    del trace.stats.rockpulse["codes"]
    back = rp.from_trace(trace, azimuth=370.0)
    assert back.warnings[-1] == "the codes were unknown when the trace was made; a new id was made"
    assert (back.azimuth, back.orientation, back.component) == (10.0, "horizontal", "")


def test_a_trace_that_does_not_say_whether_its_start_time_is_known_has_it():
    start = datetime(2020, 1, 2, 3, 4, 5, tzinfo=UTC)
    trace = rp.to_trace(replace(EAST, start_time=start))
    del trace.stats.rockpulse["start_time_known"]
    assert rp.from_trace(trace).start_time == start


def test_a_channel_on_a_structure_stays_on_it():
    trace = rp.to_trace(replace(EAST, orientation="structural"))
    trace.stats.channel = "HNT"
    assert rp.from_trace(trace).orientation == "structural"
    given = rp.from_trace(trace, azimuth=300.0)
    assert (given.orientation, given.azimuth) == ("structural", 300.0)


def test_an_azimuth_of_the_caller_is_that_of_the_record():
    for azimuth in (90.0, 450.0):
        assert rp.from_trace(rp.to_trace(EAST), azimuth=azimuth).component == "90 Deg"
    assert rp.from_trace(rp.to_trace(EAST), azimuth=93.0).azimuth == 93.0
    record = rp.from_trace(plain(), units="g", azimuth=450.0)
    assert (record.orientation, record.azimuth) == ("horizontal", 90.0)
    with pytest.raises(ConfigError, match="expected an azimuth in degrees, found nan"):
        rp.from_trace(plain(), units="g", azimuth=float("nan"))


def test_a_unit_that_contradicts_the_trace_and_stats_that_were_tampered_with_are_refused(record):
    with pytest.raises(UnitError, match=r"stats.rockpulse says m/s2"):
        rp.from_trace(rp.to_trace(record), units="g")
    with pytest.raises(UnitError, match=r"stats.rockpulse says m/s2"):
        rp.from_trace(rp.to_trace(record), units="counts", factor=2.0)
    trace = rp.to_trace(record)
    trace.stats.rockpulse = {"azimuth": 3.0}
    with pytest.raises(RecordFormatError, match=r"expected dt, id in stats.rockpulse, found azimuth"):
        rp.from_trace(trace)


def test_a_trace_of_others_needs_a_unit():
    with pytest.raises(UnitError, match="does not state the unit"):
        rp.from_trace(plain())
    with pytest.raises(UnitError, match="unknown unit"):
        rp.from_trace(plain(), units="stone")
    record = rp.from_trace(plain(), units="g")
    assert record.pga == 2.0 * STANDARD_GRAVITY
    assert (record.id, record.azimuth, record.dt) == ("XX.ABC..HNE@20200102T030405", 90.0, 0.01)
    assert (record.source, record.source_sha256, record.format, record.processed) == ("", "", "obspy", None)
    undated = rp.from_trace(plain(starttime=obspy.UTCDateTime(0)), units="g")
    assert (undated.start_time, undated.warnings) == (None, ())
    assert rp.from_trace(obspy.Trace(np.array([0.0, 1.0])), units="g").id.endswith(".1")


def sensitivity(value=200.0, unit="M/S**2"):
    return Response(instrument_sensitivity=InstrumentSensitivity(value, 1.0, input_units=unit, output_units="COUNTS"))


def test_counts_need_a_gain():
    with pytest.raises(RecordRefused, match="counts without a gain"):
        rp.from_trace(plain(), units="counts")
    assert rp.from_trace(plain(), units="counts", factor=0.5).pga == 1.0
    assert rp.from_trace(plain(response=sensitivity()), units="counts").pga == 0.01
    with pytest.raises(NotAcceleration, match="records M/S"):
        rp.from_trace(plain(response=sensitivity(unit="M/S")), units="counts")
    with pytest.raises(RecordRefused, match="no stages"):
        rp.from_trace(plain(response=sensitivity()), units="counts", response="remove")
    with pytest.raises(UnitError, match=r"other than 0, found 0\.0"):
        rp.from_trace(plain(), units="counts", factor=0.0)
    with pytest.raises(UnitError, match="a factor belongs to units='counts'"):
        rp.from_trace(plain(), units="g", factor=2.0)


def test_calib_is_never_applied():
    with pytest.raises(RecordRefused, match=r"stats.calib is 2"):
        rp.from_trace(plain(calib=2.0), units="g")
    assert rp.from_trace(plain(calib=2.0), units="counts", factor=1.0).pga == 2.0


def test_gaps_and_bad_samples_are_refused():
    masked = plain()
    masked.data = np.ma.masked_greater(masked.data, 0.9)
    with pytest.raises(RecordRefused, match="1 samples are masked"):
        rp.from_trace(masked, units="g")
    with pytest.raises(RecordFormatError, match="NaN or infinite"):
        rp.from_trace(plain([0.0, np.nan, 1.0]), units="g")
    with pytest.raises(RecordFormatError, match="at least 2 samples, found 0"):
        rp.from_trace(plain([]), units="counts", factor=1.0)


GROUP = "obspy.plugin.waveform"
INSTALLED = {name: distribution("rockpulse").entry_points.select(group=f"{GROUP}.{name}") for name in PLUGINS}
#: Formats that obspy reads itself.
OBSPY_S_OWN = {"KNET", "MINISEED", "SAC"}


def test_every_format_that_is_read_is_a_plugin_and_nothing_else_is():
    wanted = {row.name.upper() for row in FORMATS if row.unit != "-"} - OBSPY_S_OWN
    assert set(PLUGINS) == wanted
    installed = distribution("rockpulse").entry_points.select(group=GROUP)
    assert {point.name for point in installed} == wanted, "the installation is older than the formats: make install"
    assert {point.value for point in installed} == {"rockpulse.readers.obspy_plugin"}


@pytest.mark.parametrize("name", PLUGINS)
def test_the_entry_points_name_what_is_there(name):
    points = {point.name: point for point in INSTALLED[name]}
    assert set(points) == {"isFormat", "readFormat"}
    assert points["isFormat"].load() == PLUGINS[name].is_format
    assert points["readFormat"].load() == PLUGINS[name].read_format


@pytest.mark.sweep
def test_no_plugin_claims_a_file_of_obspy_s_own_formats():
    folders = sorted(Path(obspy.__file__).parent.glob("io/*/tests/data"))
    if not folders:
        pytest.skip("this obspy comes without its test data")
    paths = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    assert len(paths) > 100
    claimed = [(name, path) for path in paths for name, plugin in PLUGINS.items() if plugin.is_format(str(path))]
    assert claimed == []


@pytest.mark.sweep
def test_a_file_is_claimed_by_one_plugin_at_most(samples):
    for path in sorted([*samples.iterdir(), *(samples.parent / "formats").iterdir()]):
        claims = [name for name, plugin in PLUGINS.items() if plugin.is_format(str(path))]
        assert len(claims) <= 1, path
        stream = io.BytesIO(path.read_bytes())
        stream.read(3)
        stream.seek(0)
        assert [name for name, plugin in PLUGINS.items() if plugin.is_format(stream)] == claims
        assert stream.tell() == 0


def test_what_cannot_be_opened_is_not_claimed(tmp_path):
    (tmp_path / "empty.AT2").touch()
    for path in (tmp_path, tmp_path / "missing.AT2", tmp_path / "empty.AT2"):
        assert not any(plugin.is_format(str(path)) for plugin in PLUGINS.values())
    assert not any(plugin.is_format(io.StringIO("NPTS= 3, DT= 0.1 SEC")) for plugin in PLUGINS.values())


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse(300)))
    return path


@pytest.mark.sweep
def test_paths_open_files_and_bytes_give_the_same(path):
    (record,) = rp.read(path)
    with path.open("rb") as stream:
        ways = [str(path), path, stream, io.BytesIO(path.read_bytes())]
        traces = [obspy.read(way)[0] for way in ways]
    packed = path.with_suffix(".AT2.gz")
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for trace in [*traces, obspy.read(packed)[0]]:
        assert np.array_equal(trace.data, record.acceleration)
        assert (trace.stats.calib, trace.stats._format, trace.stats.delta) == (1.0, "AT2", 0.01)
        assert trace.stats.rockpulse.azimuth == 90.0
        assert trace.stats.rockpulse.event == "Somewhere, 1/2/2003"
        assert rp.from_trace(trace).source_sha256 == record.source_sha256


def test_obspy_s_own_options(path):
    (head,) = obspy.read(path, headonly=True)
    assert (head.stats.npts, len(head.data), head.stats.delta) == (300, 0, 0.01)
    start = obspy.UTCDateTime(0)
    (cut,) = obspy.read(path, starttime=start + 0.5, endtime=start + 1.0, dtype="f4", apply_calib=True)
    assert (cut.stats.npts, cut.data.dtype) == (51, np.float32)


@pytest.mark.sweep
def test_columns_are_read_where_they_are_asked_for_only(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("".join(f"{value:.6f}\n" for value in pulse(50)))
    with pytest.raises(TypeError, match="Unknown format"):
        obspy.read(path)
    (trace,) = obspy.read(path, format="COLUMNS", units="g", dt=0.02)
    assert (trace.stats.delta, trace.stats.npts) == (0.02, 50)
    with pytest.raises(UnitError, match="plain columns do not state their unit"):
        obspy.read(path, format="columns")


def test_options_of_other_formats_are_ignored_and_logged(path, caplog):
    (trace,) = obspy.read(path, details=True, byteorder="<")
    assert trace.stats.npts == 300
    assert "obspy.read was given options that this format does not have: details, byteorder" in caplog.text


def test_the_wrong_format_and_what_cannot_be_read_are_errors(path, tmp_path):
    with pytest.raises(RecordFormatError, match=r"a.AT2: expected USGS SMC .*recognised by"):
        obspy.read(path, format="SMC")
    velocity = tmp_path / "a.VT2"
    velocity.write_bytes(path.read_bytes().replace(b"ACCELERATION", b"VELOCITY"))
    with pytest.raises(rp.RecordRefused, match="expected an acceleration series"):
        obspy.read(velocity)
    damaged = tmp_path / "b.v1"
    damaged.write_bytes(csmip_equal(np.round(pulse(160), 6))[:-400])
    with pytest.raises(RecordFormatError, match=r"b.v1:\d+: "):
        obspy.read(damaged)


@pytest.mark.sweep
def test_reading_through_obspy_loads_neither_numba_nor_xarray(path):
    code = (
        "import sys; from rockpulse.readers.obspy_plugin import AT2; "
        "first = [name for name in ('obspy', 'pandas', 'scipy') if name in sys.modules]; "
        f"assert AT2.is_format({str(path)!r}); AT2.read_format({str(path)!r}); "
        "print(first, [name for name in ('numba', 'xarray', 'h5py', 'pandas') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] []"
