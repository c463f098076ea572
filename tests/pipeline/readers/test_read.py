"""What all readers share: recognition, encodings, import weight, behaviour on any damage."""

from __future__ import annotations

import gzip
import hashlib
import pickle
import subprocess
import sys

import numpy as np
import pytest
from record_writers import at2, csmip_equal, csmip_pairs, knet, pulse, smc

from rockpulse.errors import RecordFormatError, RecordRefused, RockpulseError, UnitError
from rockpulse.readers import FORMATS, read
from rockpulse.readers.source import NotAcceleration, Unrecognised
from rockpulse.record import STANDARD_GRAVITY
from rockpulse.sources import read_all


def write(folder, content: bytes, name: str):
    path = folder / name
    path.write_bytes(content)
    return path


def read_or_message(path, **options):
    """The records, or the message of the refusal; any other exception is a fault of the reader."""
    try:
        return read(path, **options), ""
    except RockpulseError as refusal:
        return [], str(refusal)


def test_importing_the_readers_loads_no_heavy_package():
    code = (
        "import sys, rockpulse.readers, rockpulse.sources; "
        "print([name for name in ('obspy', 'numba', 'xarray', 'pandas', 'scipy') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_engineering_files_are_read_without_obspy_and_pandas(samples):
    code = (
        "import sys; from rockpulse.readers import read; "
        f"read({str(samples / 'CICLC.v1')!r}); read({str(samples / '2516b_a.smc')!r}); "
        "print([name for name in ('obspy', 'pandas') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_format_has_a_row_with_a_name_of_its_own():
    assert len({row.name for row in FORMATS}) == len(FORMATS)
    assert all(row.what and row.recognised and row.unit and row.processed for row in FORMATS)
    assert FORMATS[-1].name == "columns"  # the least specific comes last


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"Dear reader,\nthis is no record.\n", "notes.txt"),
        (bytes(range(256)) * 20, "noise.bin"),
        (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "plot.png"),
        (b"PK\x03\x04rest", "archive.zip"),
        (b"<?xml version='1.0'?><a>1</a>\n", "a.xml"),
        (b"In the end the answer was\n42\nand nobody asked\nfor a unit\n", "prose.txt"),
    ],
)
def test_a_file_that_is_no_record_names_the_formats_tried(tmp_path, content, name):
    with pytest.raises(
        Unrecognised, match=rf"{name}: no reader recognises the file \(formats tried: csmip_v1, smc, at2"
    ):
        read(write(tmp_path, content, name))


def test_an_empty_file(tmp_path):
    with pytest.raises(RecordFormatError, match=r"empty.AT2: the file is empty"):
        read(write(tmp_path, b"", "empty.AT2"))


def test_a_missing_file_stays_an_operating_system_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "missing.AT2")


def test_a_link_that_points_nowhere_is_called_one(tmp_path):
    (tmp_path / "link.AT2").symlink_to("gone.AT2")
    with pytest.raises(FileNotFoundError, match=r"link.AT2: the symbolic link points nowhere, gone.AT2 does not exist"):
        read(tmp_path / "link.AT2")


def test_an_unknown_unit_is_an_error_for_any_format(samples):
    with pytest.raises(UnitError, match="option units: unknown unit"):
        read(samples / "CICLC.v1", units="stone")


def test_gzip_is_read_through(tmp_path):
    content = at2(pulse())
    (plain,) = read(write(tmp_path, content, "a.AT2"))
    (packed,) = read(write(tmp_path, gzip.compress(content), "a.AT2.gz"))
    assert np.array_equal(packed.acceleration, plain.acceleration)
    assert packed.id == plain.id
    assert packed.source_sha256 == plain.source_sha256 == hashlib.sha256(content).hexdigest()


def test_a_corrupt_gzip_file_is_named(tmp_path):
    with pytest.raises(RecordFormatError, match="damaged gzip file"):
        read(write(tmp_path, gzip.compress(at2(pulse()))[:-30], "a.AT2.gz"))


def test_bytes_of_any_encoding_in_a_header_do_not_stop_the_reading(tmp_path):
    title = "İzmit, 17/8/1999, Düzce, 090".encode("iso8859-9")
    content = at2(pulse()).replace(b"Somewhere, 1/2/2003, Station One, 090", title)
    assert read(write(tmp_path, content, "a.AT2"))[0].azimuth == 90.0


@pytest.mark.parametrize(
    ("first_line", "error", "name"),
    [
        (b"Corrected accelerogram   58667-L2866-14236.52       Chan  1:  H1         from", RecordRefused, "volume 2"),
        (b"Response and Fourier amplitude spectra (78 periods)", NotAcceleration, "spectra"),
        (b"Raw acceleration counts   (Format v01.20 with 13 text lines)", RecordRefused, "COSMOS"),
        (b"EVENT_NAME: GREECE", RecordRefused, "DYNA"),
        (b"Uncorrected accelerogram 20161113_110256_HSES_20 GNS Science", RecordRefused, "GeoNet"),
        (b"* VOL1DS FILE:  5520/01\r\nInst Type = SSA-2\r", RecordRefused, "BHRC"),
        (b"STRONG GROUND MOTION RECORDS OF TURKIYE\r", RecordRefused, "NSMN"),
        (b"*****\r\n  INSTITUTO\r\n****\r\nARCHIVO ESTANDAR DE ACELERACION:\r", RecordRefused, "UNAM"),
        ("*****\n  CIRES\n****\nARCHIVO ESTÁNDAR DE ACELERACIÓN:".encode(), RecordRefused, "UNAM or CIRES"),
        (b"#Earthquake Information\r\n\r\n#StationCode: EGF\r\n#AmplitudeUnit:  gal. DC\r", RecordRefused, "CWB"),
        (b"#StationCode: EGF\n#SampleRate(Hz): 50\n#AmplitudeUnit: gal\n#Data: 4F10.3", RecordRefused, "CWA"),
        (b"200805121428 $\r\n$\r\nEQUALLY SPACED INTERVALS OF:  0.005  SEC$\r", RecordRefused, "CSMNC"),
    ],
)
def test_formats_known_but_not_read_are_named(tmp_path, first_line, error, name):
    path = write(tmp_path, first_line + b"\n" + b"1 2 3\n" * 20, "file.dat")
    with pytest.raises(error, match=rf"file.dat:1: .*{name}"):
        read(path, units="gal", dt=0.01)
    _, (failure,) = read_all(tmp_path)
    assert failure.kind == ("skipped" if error is NotAcceleration else "failed")
    assert ("not read by this version" in failure.reason) is (error is RecordRefused)


@pytest.mark.parametrize(
    ("folder", "name"),
    [("bhrc", "BHRC"), ("afad_nsmn", "NSMN"), ("unam_asa", "UNAM"), ("cwb", "CWB"), ("dyna_asc", "DYNA")],
)
def test_a_folder_of_a_format_not_read_fails_and_is_not_skipped(records_folder, folder, name):
    records, failures = read_all(records_folder / folder)
    assert records == []
    assert failures
    assert all(row.kind == "failed" and name in row.reason for row in failures)
    assert all("not read by this version" in row.reason for row in failures)


def test_the_table_says_what_a_format_is_and_not_what_becomes_of_it():
    assert not [row.name for row in FORMATS if "refused" in row.what]


def test_every_real_file_is_read_or_refused_with_its_name(records_folder):
    for path in sorted(path for path in records_folder.rglob("*") if path.is_file()):
        records, message = read_or_message(path, units="cm/s2", dt=0.01)
        assert records or path.name in message
        assert all(record.npts > 500 and np.isfinite(record.pga) for record in records), path


def small_files() -> dict[str, bytes]:
    times = np.cumsum(np.tile([0.005, 0.006, 0.004], 40))
    return {
        "a.AT2": at2(pulse(120)),
        "b.RAW": csmip_pairs(times, np.round(pulse(120), 3)) + csmip_pairs(times, np.round(pulse(120), 3), number=2),
        "c.v1": csmip_equal(np.round(pulse(160), 6), place="ROOF"),
        "d.smc": smc(pulse(120, 50.0)),
        "e.smc": smc(np.column_stack([times, pulse(120)]).ravel(), kind="1 UNCORRECTED ACCELEROGRAM", rate=None),
        "f.EW": knet(np.round(pulse(120, 5000.0)).astype(int)),
        "g.csv": ("time,acc (g)\n" + "".join(f"{0.01 * i:.2f},{a:.5f}\n" for i, a in enumerate(pulse(120)))).encode(),
        "h.txt": ("120 0.01\n" + "".join(f"{a:.5f}\n" for a in pulse(120))).encode(),
    }


def mutate(content: bytes, random: np.random.Generator) -> bytes:
    """One to four of: bytes changed, a piece cut out, a piece repeated, the end cut off, a number made extreme."""
    data = bytearray(content)
    for _ in range(random.integers(1, 5)):
        at = int(random.integers(0, max(len(data), 1)))
        length = int(random.integers(1, 30))
        kind = random.integers(0, 6)
        if kind == 0:
            data[at : at + length] = random.integers(0, 256, length, dtype=np.uint8).tobytes()
        elif kind == 1:
            del data[at : at + length]
        elif kind == 2:
            data[at:at] = data[at : at + 5 * length]
        elif kind == 3:
            del data[max(at, 1) :]
        else:
            extreme = [b"9" * 12, b"-9999", b"1e999", b"0", b"nan", b"\n", b"1E308", b"-", b"   "]
            word = extreme[int(random.integers(0, len(extreme)))]
            data[at : at + len(word)] = word
    return bytes(data)


@pytest.mark.parametrize("name", small_files())
def test_any_damage_gives_records_or_a_named_refusal(tmp_path, name):
    content = small_files()[name]
    assert read(write(tmp_path, content, name), units="g")
    random = np.random.default_rng([7, *name.encode()])
    for _ in range(60):
        path = write(tmp_path, mutate(content, random), name)
        records, message = read_or_message(path, units="g")
        assert records or name in message
        assert all(np.isfinite(record.pga) and record.npts >= 2 and record.dt > 0.0 for record in records)


@pytest.mark.parametrize(("format", "name"), [("MSEED", "m.mseed"), ("SAC", "s.sac")])
def test_any_damage_to_binary_files_gives_records_or_a_named_refusal(tmp_path, format, name):
    import obspy

    path = tmp_path / name
    counts = np.round(pulse(300, 5000.0)).astype(np.int32 if format == "MSEED" else np.float32)
    obspy.Trace(counts, {"station": "ABC", "channel": "HNE", "sampling_rate": 100.0}).write(str(path), format=format)
    content = path.read_bytes()
    random = np.random.default_rng(11)
    for _ in range(40):
        # Steim frames are told by their headers; damage there and in the data.
        data = bytearray(content)
        for at in random.integers(0, min(len(data), 700), 3):
            data[at] = random.integers(0, 256)
        path.write_bytes(bytes(data[: random.integers(1, len(data) + 1)]) if random.random() < 0.3 else bytes(data))
        records, message = read_or_message(path, units="cm/s2")
        assert records or name in message
        assert all(np.isfinite(record.pga) for record in records)


def test_the_largest_sample_is_parsed_in_a_fraction_of_a_second(samples):
    import time

    began = time.process_time()
    records = read(samples / "CITOW2.RAW")
    assert sum(record.npts for record in records) == 106812
    # 0.02 s when measured; a float() per sample takes several times this bound's share.
    assert time.process_time() - began < 0.5


def test_g_is_standard_gravity(tmp_path):
    (record,) = read(write(tmp_path, at2([0.0, 1.0, 0.5]), "a.AT2"))
    assert record.pga == STANDARD_GRAVITY == 9.80665


@pytest.mark.parametrize("error", [Unrecognised, NotAcceleration])
def test_the_readers_own_errors_survive_pickling(error):
    copy = pickle.loads(pickle.dumps(error("file.AT2:3: reason")))
    assert type(copy) is error
    assert str(copy) == "file.AT2:3: reason"
