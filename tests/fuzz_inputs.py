"""Inputs of the coverage-guided fuzzer: the bytes of a file, its name and the options of the caller.

The first byte of an input chooses one of `CIRCUMSTANCES`, the rest is the content. Every input keeps the promises that
`fuzz` holds damaged files against; a kept corpus of inputs that reach different lines lies in tests/fuzz_corpus.tar.xz.
"""

import io
import tarfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path, PurePath
from typing import Any

import fuzz
import numpy as np
from make_format_samples import format_samples, read_options

from rockpulse.readers import read_source
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.source import HEAD, SourceFile

CORPUS = Path(__file__).parent / "fuzz_corpus.tar.xz"
#: Samples of a channel in the seeds, which are read the faster the shorter they are.
COUNT = 40
#: No input is longer [bytes].
LONGEST = 20_000
STATION_XML, MINISEED = "CI.CLC.xml", "CI.CLC.mseed"


@dataclass(frozen=True)
class Circumstance:
    """What belongs to a file beside its content."""

    name: str
    given: dict[str, Any] = field(default_factory=dict)
    station: bool = False  # whether the input is the StationXML beside the miniSEED sample


CIRCUMSTANCES = (
    Circumstance("record.dat"),
    Circumstance("record.txt", {"units": "g"}),
    Circumstance("record.txt", {"units": "cm/s2", "dt": 0.01}),
    Circumstance("CLC0011907061219.EW2", {"units": "m/s2"}),
    Circumstance("CI.CLC..HNE.D.20190706.031958.X.ACC.ASC"),
    Circumstance("20190706031958_CLC_ap_AAD_Acc_E.asc"),
    Circumstance("clc_csmnc.UD.dat"),
    Circumstance("record parte2.v1"),
    Circumstance(MINISEED, {"response": "remove"}),
    Circumstance(STATION_XML, {}, station=True),
    Circumstance(STATION_XML, {"response": "remove"}, station=True),
)


@cache
def short_samples() -> dict[str, bytes]:
    """The format samples, cut to `COUNT` samples a channel."""
    return format_samples(COUNT)


def fault(data: bytes) -> str:
    """How the readers break a promise with an input; empty where they keep them all."""
    if len(data) < 2:
        return ""
    file, options = opened(data)
    return fuzz.call_fault(file.name, lambda: read_source(file, options))


def opened(data: bytes) -> tuple[SourceFile, ReadOptions]:
    """The file of an input, and the options with which it is read."""
    case = CIRCUMSTANCES[data[0] % len(CIRCUMSTANCES)]
    samples, content = short_samples(), data[1:]
    name, beside = f"/records/{case.name}", [(f"/records/{STATION_XML}", samples[STATION_XML])]
    if case.station:
        name, beside, content = f"/records/{MINISEED}", [(f"/records/{STATION_XML}", content)], samples[MINISEED]
    return SourceFile(name, content[:HEAD], lambda: content, lambda: beside), ReadOptions(**case.given)


def seeds() -> list[bytes]:
    """Each sample with what has to be given, and under names that say something of its kind of file."""
    found = []
    for name, content in short_samples().items():
        given = len(read_options().get(name, {}))  # nothing, the unit, or the interval too
        for number, case in enumerate(CIRCUMSTANCES):
            named = PurePath(case.name).suffix.lower() == PurePath(name).suffix.lower() != ".txt"
            if case.station if name == STATION_XML else not case.station and (named or number == given):
                found.append(bytes([number]) + content)
    return found


def mutated(data: bytes, seed: int) -> bytes:
    """An input with one of the changes of `fuzz`; the circumstance stays."""
    random = np.random.default_rng([seed, 7])
    samples: Sequence[bytes] = list(short_samples().values())
    other = samples[int(random.integers(len(samples)))]
    change = fuzz.MUTATIONS[fuzz.DRAWN[int(random.integers(len(fuzz.DRAWN)))]]
    return data[:1] + change(data[1:], other, random)


def kept_corpus() -> list[bytes]:
    """The committed inputs."""
    with tarfile.open(CORPUS, "r:xz") as archive:
        files = (archive.extractfile(member) for member in archive.getmembers())
        return [file.read() for file in files if file is not None]


def keep_corpus(inputs: Sequence[bytes]) -> int:
    """Write the committed inputs, and return the size of the file [bytes].

    Packed as one stream the many inputs that differ little take little room.
    """
    with tarfile.open(CORPUS, "w:xz") as archive:
        for number, data in enumerate(sorted(inputs)):
            entry = tarfile.TarInfo(f"{number:05d}")
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
    return CORPUS.stat().st_size
