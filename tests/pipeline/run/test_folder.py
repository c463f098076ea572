"""A folder as users have them: most files are good, some damaged, some cannot be opened, some are no records."""

from __future__ import annotations

import gzip
import os
import re
import zipfile
from io import BytesIO

import numpy as np
import pytest
import xarray as xr
from record_writers import at2, csmip_equal, csmip_pairs, knet, pulse, smc
from record_writers.columns import columns
from record_writers.cosmos import cosmos
from record_writers.csmip_v2 import csmip_v2
from record_writers.geonet import geonet

import rockpulse as rp
from rockpulse.cli import main

COUNT = 120
TIME = 0.01 * np.arange(COUNT)
CONFIGURATION = """
[records]
store = "none"
keep = ["*"]  # the files of one format have one station and time
[models]
use = ["sequence"]
[search]
models = []
[[block]]
name = "wall"
width = 0.4
height = 3.0
"""


def wave(peak):
    return pulse(COUNT, peak)


def table(peak, headings="time [s],acc N [cm/s2]\n", time=TIME):
    return columns(np.column_stack([time, wave(peak)]), headings, ",", "{:.4f}")


def counts(peak):
    return list(np.rint(wave(peak)).astype(int))


#: Suffix and content from a peak [g].
FORMATS = {
    ".AT2": lambda g: at2(wave(g)),
    ".v1": lambda g: csmip_equal(wave(g)),
    ".pairs.v1": lambda g: csmip_pairs(TIME, 10.0 * wave(g)),
    ".EW": lambda g: knet(counts(4e6 * g), peak_gal=4e6 * g * 2000.0 / 8388608),
    ".smc": lambda g: smc(wave(981.0 * g)),
    ".V1C": lambda g: cosmos(wave(g)),
    ".V2": lambda g: csmip_v2(wave(981.0 * g)),
    ".V1A": lambda g: geonet([wave(9810.0 * g)], ("N10E",)),
    ".csv": lambda g: table(981.0 * g),
    ".AT2.gz": lambda g: gzip.compress(at2(wave(g))),
}
GOOD = {f"good/{n:03d}{suffix}": FORMATS[suffix](0.1 + 0.002 * n) for n, suffix in enumerate([*FORMATS] * 20)}

#: Content, and what its reason has to name.
DAMAGED = {
    "cut.AT2": (at2(wave(0.31))[:900], r":14: expected 120 samples \(header\), found 50"),
    "cut.smc": (smc(wave(301.0))[:-200], r":43: expected 120 numbers \(header\), found 101"),
    "cut.V2A": (geonet([wave(3010.0)], ("N10E",))[:-60], r":39: expected 120 numbers \(header\), found 113"),
    "cut.v1": (csmip_equal(wave(0.31))[:-400], r":\d+: expected 120 numbers \(header\), found \d+"),
    "cut.EW": (knet(counts(1e6))[:900], r":\d+: expected 120 samples .*, found \d+"),
    "cut.V2": (csmip_v2(wave(310.0))[:-3000], r":\d+: expected .*, found"),
    "count.AT2": (at2(wave(0.32)).replace(b"NPTS=    120", b"NPTS=    720"), r":28: expected 720 samples .* found 120"),
    "count.V1C": (cosmos(wave(0.32), count=140), r":62: expected 140 numbers \(header\), found 124"),
    "one.AT2": (at2(wave(0.3)[:1]), r"channel 1: expected at least 2 samples, found 1"),
    "empty.AT2": (b"", r"the file is empty"),
    "text.AT2": (at2(wave(0.33))[:400] + b"the rest was lost\n", r":8: expected a finite number, found '.*the'"),
    "nan.AT2": (at2(np.where(TIME[60] == TIME, np.nan, wave(0.34))), r":17: expected a finite number, found 'NAN'"),
    "stars.v1": (
        csmip_equal(wave(0.35)).replace(b" 0.0", b"*****", 1),
        r":29: expected 8 fields of 9 characters, found a row of 73",
    ),
    "bytes.smc": (smc(wave(302.0))[:2500] + bytes(range(128, 256)) * 2, r":\d+: expected 8 fields of 10 characters"),
    "step.AT2": (at2(wave(0.36), dt=0.0), r":4: expected a positive DT in s, found 'NPTS= .* DT= 0.0000"),
    "gap.csv": (
        table(303.0, time=np.where(TIME > 0.6, TIME + 1.0, TIME)),
        r":63: expected equally spaced times .* found a step of 1.01 s among steps of 0.01 s",
    ),
    "back.csv": (
        table(304.0, time=np.where(TIME > 1.0, TIME - 0.5, TIME)),
        r":103: expected increasing times .* found 0.51 after 1",
    ),
    "unit.csv": (table(305.0, "time [s],acc N\n"), r"plain columns do not state their unit; give it"),
    "unit.V1C": (cosmos(wave(0.37), unit="furlong", code="(99)"), r":45: unknown unit of acceleration 'furlong'"),
    "scale.EW": (knet(counts(1e6 + 1.0), scale="(gal)"), r":14: expected 'Scale Factor' as .* found 'Scale Factor"),
}


def archive():
    content = BytesIO()
    with zipfile.ZipFile(content, "w") as file:
        file.writestr("inside.AT2", at2(wave(0.4)))
    return content.getvalue()


def other_checksum(content):
    return content[:-8] + bytes(4) + content[-4:]


#: What gives no content at all; the dangling link and the pipe come on top.
UNREADABLE = {
    "cut.AT2.gz": (gzip.compress(at2(wave(0.41)))[:-40], r"damaged gzip file \(Compressed file ended before"),
    "sum.AT2.gz": (other_checksum(gzip.compress(at2(wave(0.42)))), r"damaged gzip file \(CRC check failed"),
    "cut.zip": (archive()[:-30], r"damaged zip archive"),
    "link.AT2": (None, r"the symbolic link points nowhere, gone.AT2 does not exist"),
    "pipe.AT2": (None, r"expected a file, found a pipe; write what it gives to a file"),
}

BESIDE = r": no record$"
NO_RECORDS = {
    "notes.txt": (b"Visit of the station on 3 May.\nBattery changed, no events.\n", BESIDE),
    "plan.dat": (b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n1 0 obj\n<< /Type /Catalog >>\nendobj\n", BESIDE),
    "costs.csv": (b"item,pieces,price\nanchor,4,120.5\nbolt,16,2.25\n", BESIDE),
    "events.tsv": (b"event\tdate\tmagnitude\nA\t2003-01-02\t5.8\nB\t2004-02-03\t6.1\n", BESIDE),
    "picture.bin": (b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 4, BESIDE),
    "stations.json": (b'{"stations": [{"name": "A", "lat": 40.8}]}\n', BESIDE),
    "run.log": (b"2020-01-01 00:00:00 INFO started\n2020-01-01 00:00:01 INFO done\n", BESIDE),
    "velocity.VT2": (
        at2(wave(12.0), series="VELOCITY TIME SERIES IN UNITS OF CM/S"),
        r":3: expected an acceleration series.*, found 'VELOCITY TIME SERIES",
    ),
    "velocity.smc": (smc(wave(13.0), kind="3 VELOCITY"), r":1: expected an accelerogram .* found type 3, velocity"),
    "spectrum.csv": (table(0.8, "period [s],SA [g]\n", TIME + 0.01), r"found columns over 'period \[s\]', a spectrum"),
}

#: Known by their names for what they are: left out without a row.
QUIET = {"README.md": b"# Records of the site\n", ".hidden.AT2": b"", "station.xml": b"<FDSNStationXML/>"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "good").mkdir()
    listed = {**DAMAGED, **UNREADABLE, **NO_RECORDS}
    for name, content in {**GOOD, **QUIET, **{name: content for name, (content, _) in listed.items()}}.items():
        if content is not None:
            (folder / name).write_bytes(content)
    (folder / "link.AT2").symlink_to("gone.AT2")
    os.mkfifo(folder / "pipe.AT2")
    return folder


@pytest.fixture(scope="module")
def configuration(tmp_path_factory):
    path = tmp_path_factory.mktemp("configuration") / "site.toml"
    path.write_text(CONFIGURATION)
    return path


@pytest.fixture(scope="module")
def results(folder, configuration, tmp_path_factory):
    target = tmp_path_factory.mktemp("one") / "results.h5"
    given = [str(folder), "--config", str(configuration), "-o", str(target)]
    assert main(["assess", *given, "--quiet", "--workers", "1"]) == 1
    return rp.load(target)


def test_every_good_file_gives_a_result(folder, results):
    assert len(GOOD) == 200
    summary = results["summary"].to_dataset()
    assert sorted(summary["source"].values.tolist()) == sorted(str(folder / name) for name in GOOD)
    assert len(set(summary["record"].values.tolist())) == 200
    expected = {str(folder / name): 9.80665 * (0.1 + 0.002 * n) for n, name in enumerate(GOOD)}
    found = dict(zip(summary["source"].values.tolist(), summary["pga"].values.tolist(), strict=True))
    for source, pga in expected.items():  # the mean is taken off what is not processed, a tenth of the peak
        assert found[source] == pytest.approx(pga, rel=0.12), source
    assert (summary["outcome"].values >= 0).all()


@pytest.mark.parametrize(
    ("listed", "number", "kind"),
    [(DAMAGED, 20, "failed"), (UNREADABLE, 5, "failed"), (NO_RECORDS, 10, "skipped")],
    ids=["damaged", "unreadable", "no records"],
)
def test_every_other_file_has_a_row_with_its_reason(folder, results, listed, number, kind):
    assert len(listed) == number
    rows = rows_by_file(results)
    for name, (_, reason) in listed.items():
        (row,) = rows[str(folder / name)]
        assert row[:2] == ("read", kind), name
        assert str(folder / name) in row[2]
        assert re.search(reason, row[2]), f"{name}: {row[2]}"


def rows_by_file(results):
    failures = results["failures"].to_dataset()
    found = {}
    for file, *row in zip(*(failures[name].values for name in ("file", "stage", "kind", "reason")), strict=True):
        found.setdefault(str(file), []).append(tuple(map(str, row)))
    return found


def test_nothing_else_has_a_row(folder, results):
    names = [*DAMAGED, *UNREADABLE, *NO_RECORDS]
    assert sorted(rows_by_file(results)) == sorted(str(folder / name) for name in names)
    kinds = results["failures"]["kind"].values.tolist()
    assert {kind: kinds.count(kind) for kind in set(kinds)} == {"failed": 25, "skipped": 10}


# Two processes that read damaged files and work: test_killed.py.
@pytest.mark.parametrize("workers", ["1", pytest.param("2", marks=pytest.mark.slow)])
def test_patterns_find_the_same_and_name_each_failure_once(folder, configuration, results, tmp_path, capsys, workers):
    target = tmp_path / "results.h5"
    given = [str(folder / "*.*"), str(folder / "good" / "00*"), "--config", str(configuration), "-o", str(target)]
    assert main(["assess", *given, "--quiet", "--workers", workers]) == 1
    said = capsys.readouterr().err
    assert re.fullmatch(r"rockpulse: 10 of 35 files used, 25 not: [^\n]+ 21 more for other reasons\.\n", said)
    found = rp.load(target)
    xr.testing.assert_identical(found["failures"].to_dataset(), results["failures"].to_dataset())
    xr.testing.assert_identical(found["summary"].to_dataset(), results["summary"].to_dataset().isel(record=slice(10)))
