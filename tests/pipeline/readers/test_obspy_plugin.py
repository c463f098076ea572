"""``obspy.read`` on the formats of rockpulse, and the entry points that make it possible."""

from __future__ import annotations

import gzip
import io
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
import obspy
import pytest
from make_format_samples import read_options
from record_writers import at2, csmip_equal, pulse

import rockpulse as rp
from rockpulse.errors import RecordFormatError, UnitError
from rockpulse.readers import FORMATS
from rockpulse.readers.obspy_plugin import PLUGINS, _head

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


def test_an_unknown_name_is_no_attribute():
    from rockpulse.readers import obspy_plugin

    with pytest.raises(AttributeError, match="NOSUCH"):
        _ = obspy_plugin.NOSUCH


def test_no_plugin_claims_a_file_of_obspy_s_own_formats():
    folders = sorted(Path(obspy.__file__).parent.glob("io/*/tests/data"))
    if not folders:
        pytest.skip("this obspy comes without its test data")
    paths = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    assert len(paths) > 100
    claimed = [(name, path) for path in paths for name, plugin in PLUGINS.items() if plugin.is_format(str(path))]
    assert claimed == []


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


def test_a_plugin_reads_the_samples_and_knows_an_open_file_by_its_name(path):
    (trace,) = PLUGINS["AT2"].read_format(str(path))
    assert trace.data.size == 300
    content = path.read_bytes()
    with path.open("rb") as stream:
        assert _head(stream) == _head(str(path)) == (content, str(path))
    assert _head(io.BytesIO(content)) == (content, "stream")


def test_metadata_of_several_channels(samples):
    stream = obspy.read(samples / "CICLC.v1")
    assert [trace.id for trace in stream] == ["CI.CLC..90", "CI.CLC..360", "CI.CLC..Up"]
    assert str(stream[0].stats.starttime).startswith("2019-07-06T03:16:08")
    assert stream[0].stats.rockpulse.source_unit == "g"
    assert [rp.from_trace(trace).id for trace in stream] == [record.id for record in rp.read(samples / "CICLC.v1")]


def test_obspy_s_own_options(path):
    (head,) = obspy.read(path, headonly=True)
    assert (head.stats.npts, len(head.data), head.stats.delta) == (300, 0, 0.01)
    start = obspy.UTCDateTime(0)
    (cut,) = obspy.read(path, starttime=start + 0.5, endtime=start + 1.0, dtype="f4", apply_calib=True)
    assert (cut.stats.npts, cut.data.dtype) == (51, np.float32)


def test_columns_are_read_where_they_are_asked_for_only(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("".join(f"{value:.6f}\n" for value in pulse(50)))
    with pytest.raises(TypeError, match="Unknown format"):
        obspy.read(path)
    (trace,) = obspy.read(path, format="COLUMNS", units="g", dt=0.02)
    assert (trace.stats.delta, trace.stats.npts) == (0.02, 50)
    with pytest.raises(UnitError, match="plain columns do not state their unit"):
        obspy.read(path, format="columns")


#: One sample of each layout that is told by its content, or read as columns where that is asked for.
LAYOUTS = {
    "20190706031958_CLC_RawAcc_E.asc": "DYNA",
    "20190706031958_CLC_ap_AAD_Acc_E.asc": "DYNA",
    "clc_H2.cor.acc": "SIGMA",
    "clc_V.cor.acc": "SIGMA",
    "clc_rows.g3": "COLUMNS",
    "clc_end_data.txt": "COLUMNS",
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_sample_of_a_text_format_by_obspy(samples, name):
    path, options = samples.parent / "formats" / name, read_options().get(name, {})
    (record,) = rp.read(path, **options)
    (trace,) = obspy.read(path, **options, **({"format": "COLUMNS"} if LAYOUTS[name] == "COLUMNS" else {}))
    assert np.array_equal(trace.data, record.acceleration)
    assert (trace.stats._format, trace.stats.delta, trace.stats.calib) == (LAYOUTS[name], record.dt, 1.0)
    assert rp.from_trace(trace).processing == record.processing


def test_options_of_other_formats_are_ignored_and_logged(path, caplog):
    (trace,) = obspy.read(path, details=True, byteorder="<")
    assert trace.stats.npts == 300
    assert "obspy.read has options that are not of this format: details, byteorder" in caplog.text


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


def test_reading_through_obspy_loads_neither_numba_nor_xarray(path):
    code = (
        "import sys; from rockpulse.readers.obspy_plugin import AT2; "
        "first = [name for name in ('obspy', 'pandas', 'scipy') if name in sys.modules]; "
        f"assert AT2.is_format({str(path)!r}); AT2.read_format({str(path)!r}); "
        "print(first, [name for name in ('numba', 'xarray', 'h5py', 'pandas') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] []"


def test_real_files_by_obspy(records_folder):
    stream = obspy.read(records_folder / "at2" / "*.AT2")
    assert sorted(trace.stats.npts for trace in stream) == [4096, 7999, 7999]
    assert {trace.stats._format for trace in stream} == {"AT2"}
