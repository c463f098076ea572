"""Seeded damage to every format sample, on every reader: Records that keep their promises, or a RockpulseError.

``make fuzz`` runs for an hour (MINUTES=60) and prints the count for each sample, the failures, and the seed to go on
from (FIRST=...). ``python tests/fuzz.py --seed 1234`` replays one case and shows what happens.
"""

import argparse
import os
import re
import resource
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import timedelta
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from make_format_samples import format_samples, read_options

from rockpulse.errors import RockpulseError
from rockpulse.readers import FORMATS, read_source
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.source import HEAD, SourceFile
from rockpulse.record.record import Record

#: A case that takes longer [s], or lets the process grow by more [bytes], is a failure.
TIME_LIMIT, MEMORY_LIMIT = 2.0, 256 * 1024**2
#: Samples of a channel in most cases; the shipped files, which are eight times as long, make the rest.
SHORT, WHOLE = 150, 1200

T = TypeVar("T")
Random = np.random.Generator
Mutation = Callable[[bytes, bytes, Random], bytes]

_EXTREMES = b"0 -1 1 2147483647 -2147483648 99999999999999999999 1e999 nan -inf . 1E308 1e-320 - +".split()
_EXTREMES += [b"  ", *b"***** 4294967296 0.0 -0.01 1D5 1_0 -999".split()]
_FOREIGN = ["\N{DEGREE SIGN}".encode("latin-1"), *(word.encode() for word in ("İzmit", "²", "٣", "\u2028")), b"\x85"]
_FOREIGN += [b"\xff", b"\x1a", b"\x00", b"\x1f\x8b\x08", b"\xef\xbb\xbf", b"PK\x03\x04", b"\f", b"\v", b"\t", b"\xa0"]


def _at(data: bytes, random: Random) -> int:
    """A place in the data, most often in the header."""
    end = len(data) if random.random() < 0.4 else min(len(data), 3000)
    return int(random.integers(0, max(end, 1)))


def _any(items: list[T], random: Random) -> T:
    return items[int(random.integers(len(items)))]


def _parts(data: bytes, random: Random, longest: int = 300) -> tuple[bytes, bytes, bytes]:
    """The data before, in and behind a part of them."""
    at = _at(data, random)
    end = at + int(random.integers(1, longest))
    return data[:at], data[at:end], data[end:]


def flip_bits(data: bytes, other: bytes, random: Random) -> bytes:
    changed = bytearray(data)
    for _ in range(int(random.integers(1, 20))):
        if changed:
            changed[_at(data, random) % len(data)] ^= 1 << int(random.integers(8))
    return bytes(changed)


def repeat(data: bytes, other: bytes, random: Random) -> bytes:
    before, part, behind = _parts(data, random)
    return before + part + part + behind


def cut(data: bytes, other: bytes, random: Random) -> bytes:
    before, _, behind = _parts(data, random)
    return before + behind


def insert(data: bytes, other: bytes, random: Random) -> bytes:
    at = _at(data, random)
    word = _any(_FOREIGN, random) if random.random() < 0.5 else random.bytes(int(random.integers(1, 9)))
    return data[:at] + word + data[at:]


def overwrite(data: bytes, other: bytes, random: Random) -> bytes:
    at, word = _at(data, random), _any([*_FOREIGN, *_EXTREMES, bytes(40), b" " * 40], random)
    return data[:at] + word + data[at + len(word) :]


def digits(data: bytes, other: bytes, random: Random) -> bytes:
    """Some digits become others."""
    changed = bytearray(data)
    for _ in range(int(random.integers(1, 30))):
        at = _at(data, random)
        if data[at : at + 1].isdigit():
            changed[at] = 48 + int(random.integers(10))
    return bytes(changed)


def number(data: bytes, other: bytes, random: Random) -> bytes:
    """A number becomes an extreme one, in its columns or not: counts, intervals, widths, codes."""
    found = re.compile(rb"[+-]?\d+\.?\d*").search(data, at := _at(data, random), at + 400)
    if not found:
        return data
    word = _any(_EXTREMES, random)
    if random.random() < 0.7:
        word = word[: len(found[0])].rjust(len(found[0]))
    return data[: found.start()] + word + data[found.end() :]


def width(data: bytes, other: bytes, random: Random) -> bytes:
    """A Fortran format gets other counts and widths."""
    found = list(re.finditer(rb"\b(\d{1,3})([FEIfei])(\d{1,3})", data))
    if not found:
        return data
    match, counts = _any(found, random), [b"0", b"1", b"7", b"8", b"10", b"80", b"999", b"99999999"]
    return data[: match.start()] + _any(counts, random) + match[2] + _any(counts, random) + data[match.end() :]


def _line(lines: list[bytes], random: Random) -> int:
    return int(random.integers(0, len(lines) if random.random() < 0.5 else min(len(lines), 60)))


def delete_lines(lines: list[bytes], random: Random) -> None:
    at = _line(lines, random)
    del lines[at : at + int(random.integers(1, 4))]


def swap_lines(lines: list[bytes], random: Random) -> None:
    first, second = _line(lines, random), _line(lines, random)
    lines[first], lines[second] = lines[second], lines[first]


def double_line(lines: list[bytes], random: Random) -> None:
    at = _line(lines, random)
    lines[at:at] = [_any([b"\n", b"   \r\n", lines[at], lines[_line(lines, random)]], random)]


def of_lines(change: Callable[[list[bytes], Random], None]) -> Mutation:
    """A change of the lines, if there are any."""

    def changed(data: bytes, other: bytes, random: Random) -> bytes:
        if lines := data.splitlines(keepends=True):
            change(lines, random)
        return b"".join(lines)

    return changed


def line_ends(data: bytes, other: bytes, random: Random) -> bytes:
    """Some or all line ends become others."""
    ends, lines = [b"\n", b"\r\n", b"\r", b"\r\r\n", b"\n\n", b"\n\r"], data.splitlines()
    if random.random() < 0.5:
        return _any(ends, random).join(lines)
    return b"".join(line + _any(ends, random) for line in lines)


MUTATIONS: dict[str, Mutation] = {
    "truncate": lambda data, other, random: data[: _at(data, random)],
    "behead": lambda data, other, random: data[_at(data, random) :],
    "flip_bits": flip_bits,
    "splice": lambda data, other, random: data[: _at(data, random)] + other[_at(other, random) :],
    "append": lambda data, other, random: data + other,
    **{change.__name__: change for change in (cut, repeat, insert, overwrite, digits, number, width)},
    **{change.__name__: of_lines(change) for change in (delete_lines, swap_lines, double_line)},
    "line_ends": line_ends,
    "encoding": lambda data, other, random: data.decode("latin-1").encode(
        _any(["utf-8-sig", "utf-16", "utf-16-le", "utf-8"], random)
    ),
}
#: The names from which a change is drawn; that of a number is the most likely.
DRAWN = [name for name in MUTATIONS for _ in range(3 if name == "number" else 1)]


@dataclass(frozen=True)
class Case:
    """A damaged file."""

    seed: int
    sample: str
    mutations: tuple[str, ...]
    content: bytes
    #: (name, bytes) of the StationXML files beside it.
    beside: tuple[tuple[str, bytes], ...]
    options: ReadOptions

    def __str__(self) -> str:
        return f"seed {self.seed}: {self.sample}, {' + '.join(self.mutations)}"


@cache
def corpus(records: str = "") -> tuple[dict[str, bytes], dict[str, bytes]]:
    """Short samples, and the shipped ones with the files of a folder of real records, by name."""
    whole = format_samples(WHOLE)
    if records:
        paths = (path for path in sorted(Path(records).rglob("*")) if path.is_file() and path.suffix != ".zip")
        whole |= {path.name: path.read_bytes() for path in paths if path.stat().st_size < 1_500_000}
    return format_samples(SHORT), whole


def case(seed: int, records: str = "") -> Case:
    """The case of a seed; the same for the same samples."""
    random = np.random.default_rng([seed, 4])
    short, whole = corpus(records)
    files = short if random.random() < 0.9 else whole
    names = list(files)
    sample = names[int(random.integers(len(names)))]
    other = files[names[int(random.integers(len(names)))]]
    content = files[sample]
    chosen = [DRAWN[int(at)] for at in random.integers(0, len(DRAWN), min(random.geometric(0.6), 4))]
    for name in chosen:
        content = MUTATIONS[name](content, other, random)
    beside = {name: content for name, content in files.items() if name.endswith(".xml")}
    if sample.endswith(".xml"):
        beside = {sample: content}
        sample = next((name for name in files if name.endswith(".mseed") and name[:6] == sample[:6]), sample)
        content = files[sample]
    options: dict[str, Any] = {"units": "cm/s2", **read_options().get(sample, {})}
    options["response"] = "remove" if random.random() < 0.1 else "sensitivity"
    return Case(seed, sample, tuple(chosen), content, tuple(beside.items()), ReadOptions(**options))


def broken_promise(records: list[Record]) -> str:
    """What is wrong with what a reader returned, or nothing."""
    if not records:
        return "no record and no error"
    for record in records:
        promises = {
            "at least two finite samples": record.npts >= 2 and bool(np.all(np.isfinite(record.acceleration))),
            "a positive interval": bool(np.isfinite(record.dt)) and record.dt > 0.0,
            "an id and a format": bool(record.id and record.format and record.source),
            "UTC": record.start_time is None or record.start_time.utcoffset() == timedelta(0),
            "a known orientation": record.orientation in ("horizontal", "vertical", "structural", "unknown"),
            "an azimuth below 360": bool(np.isnan(record.azimuth)) or 0.0 <= record.azimuth < 360.0,
            "warnings in words": all(isinstance(note, str) and note for note in record.warnings),
            "processed or not": record.processed in (True, False, None),
        }
        broken = [promise for promise, kept in promises.items() if not kept]
        if broken:
            return f"{record.id}: expected {', '.join(broken)}"
    return ""


def _stop(*_: object) -> None:
    raise TimeoutError(f"more than {TIME_LIMIT:g} s")


def call_fault(name: str, call: Callable[[], list[Record]]) -> str:
    """How a call breaks the rules: an exception that is no RockpulseError with the file's name, time, memory; or ""."""
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, 2.0 * TIME_LIMIT)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            fault = broken_promise(call())
    except RockpulseError as refusal:
        fault = "" if name in str(refusal) else f"an error that does not name the file: {refusal!r}"
    except Exception:  # any other one is what is looked for, and is printed
        fault = traceback.format_exc(limit=-4)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    taken = time.process_time() - began
    grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - grown)
    too_long, too_much = taken > TIME_LIMIT, grown > MEMORY_LIMIT
    return fault or (f"{taken:.1f} s" if too_long else f"{grown / 1e6:.0f} MB more" if too_much else "")


def faults(tried: Case) -> Iterator[str]:
    """What the readers do wrong with a case: the one that claims it, and all whose detect says yes."""
    name = f"/records/{tried.sample}"

    def source() -> SourceFile:
        return SourceFile(name, tried.content[:HEAD], lambda: tried.content, lambda: list(tried.beside))

    if not tried.content:
        return
    fault = call_fault(name, lambda: read_source(source(), tried.options))
    if fault:
        yield f"{tried}\n  read: {fault}"
    claiming = []
    for row in FORMATS:
        try:
            if row.detect(source().head, name):
                claiming.append(row)
        except Exception:  # a detector may raise none: printed
            yield f"{tried}\n  detect of {row.name}: {traceback.format_exc(limit=-4)}"
    # A reader may be named, which leaves its detect out.
    named = FORMATS[tried.seed % len(FORMATS)]
    for row in [*claiming[1:], named]:
        fault = call_fault(name, lambda row=row: row.read(source(), tried.options))  # type: ignore[misc]
        if fault:
            yield f"{tried}\n  read by {row.name}: {fault}"


def main() -> int:
    """Run for some minutes, or replay a seed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--first", type=int, default=100_000, help="seed to begin with")
    parser.add_argument("--seed", type=int, help="replay this one")
    parser.add_argument("--records", default=os.environ.get("ROCKPULSE_RECORDS", ""), help="folder of real records")
    arguments = parser.parse_args()
    if arguments.seed is not None:
        tried = case(arguments.seed, arguments.records)
        found = list(faults(tried))
        print(tried, *found, sep="\n")
        return len(found)
    resource.setrlimit(resource.RLIMIT_AS, (8 * 1024**3, -1))
    warnings.filterwarnings("ignore", module="obspy")
    end = time.monotonic() + 60.0 * arguments.minutes
    counts, failures, seed = Counter[str](), 0, arguments.first
    while time.monotonic() < end:
        tried = case(seed, arguments.records)
        counts[tried.sample] += 1
        for fault in faults(tried):
            failures += 1
            print(fault, flush=True)
        seed += 1
    for sample, count in sorted(counts.items()):
        print(f"{count:8d}  {sample}")
    print(f"{counts.total():8d}  cases in {arguments.minutes:g} minutes, {failures} failures; go on with FIRST={seed}")
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())
