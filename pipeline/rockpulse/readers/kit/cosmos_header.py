"""Reads the header of one channel of a COSMOS file: text lines, integers, floating-point values and comments."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from rockpulse.readers import kit
from rockpulse.warning_text import WarningText

TITLE = re.compile(r"\s?(.{0,60}?)\s*\(Format v\d{1,2}\.\d{1,3} with (\d{1,3}) text lines\)", re.ASCII | re.IGNORECASE)
_UNKNOWN = re.compile(r"(?ai)values used when .{0,60}:\s*(-?\d{1,8})\s*,\s*(-?\d{1,8}\.?\d{0,8})\s*$")
_LAYOUT = re.compile(r"format\s*=\s*\(\s*(?:\d{1,2}P,?)?(\d{1,3})[IFEGD](\d{1,3})", re.ASCII | re.IGNORECASE)
_SCNL = re.compile(r"\s*\|\s*<SCNL>([^.\s]*)\.([^.\s]*)\.([^.\s]*)\.([^.\s]*)")
_CODE = re.compile(r"\bCode:\s*(\w\w|--|__)-(\w*)", re.ASCII)
_CHANNEL = re.compile(r"\s*Sta Cha\S{0,4}\s*(\d{1,4})\s*:\s*(.*?)\s*\(Rcrdr[^)]*\)\s*(?:Location:\s*(.*?)\s*)?$")
_CLOCK = re.compile(
    r"Rcrd start time:.{0,12}?\d{4}.{0,9}?\s\d{1,2}:\s*\d{1,2}:\s*(\d{0,2}\.?\d{0,9})\s*((?!Rcrd)[A-Z]{3,9})?",
    re.ASCII | re.IGNORECASE,
)
_PEAK = re.compile(r"(?ai)\bmax\s*=\s*(-?\d{0,9}\.?\d{1,9}|-?\d{1,9}\.)\s*([A-Z][A-Z0-9/*^]{0,12})")
_COUNTED = re.compile(r"\(\s*(\d{1,3})\s*chns?\s+of\s+\d{1,3}", re.ASCII | re.IGNORECASE)
_PEAK_TIME = re.compile(r"\bmax\s*=.{0,60}?\bat\s+(\d{0,6}\.\d{0,6})\s*sec", re.ASCII | re.IGNORECASE)
_RAW_LENGTH = re.compile(r"\s*raw record length\s*=\s*(\d{0,6}\.\d{0,6})\s*sec", re.ASCII | re.IGNORECASE)
_ABOUT = re.compile(r".{0,80}?\bapprox\.?\s+(\d{1,6}(?:\.\d{0,6})?)\s*secs?\b", re.ASCII | re.IGNORECASE)
_LENGTH_SHARE = 5e-3  # largest relative error of a stated length
_ORIENTATIONS = {
    400: kit.Direction("vertical"),
    401: kit.Direction("vertical", sign=-1.0),
    402: kit.Direction("vertical", note="integer 54 of the header does not tell whether upwards is positive"),
    **{code: kit.Direction("horizontal") for code in (500, 501, 600, 601, 700, 701)},
}
#: Values of header integer 19 for shelters, free fields, vaults, observatories, and arrays in the ground.
_ON_GROUND = {1, 2, 3, 4, 6, 7, 8, 9, 14, 50, 51}
#: Values of header integer 19 for the base of a building, a building, bridge, dam, wharf or other structure.
_STRUCTURES = {5, 10, 11, 12, 13, 15, 20}


@dataclass(frozen=True)
class CosmosHeader:
    """The header of one channel of a COSMOS file, without the samples."""

    kind: str  # first words of the title, "Uncorrected acceleration"
    text: Sequence[str]  # at least 13 lines
    integers: np.ndarray  # (n,), NaN where unknown
    reals: np.ndarray  # (n,), NaN where unknown
    unknown: float  # the number that means "unknown" among the reals and the samples
    comments: Sequence[str]
    start: int  # index of the title
    end: int  # index of the first line after the comments

    def integer(self, number: int) -> int | None:
        """Return integer header value `number`, counted from 1; None if it is unknown or missing."""
        value = self.integers[number - 1] if number <= self.integers.size else np.nan
        return None if np.isnan(value) else int(value)

    def real(self, number: int) -> float:
        """Return floating-point header value `number`, counted from 1; NaN if it is unknown or missing."""
        return float(self.reals[number - 1]) if number <= self.reals.size else float("nan")

    def codes(self) -> tuple[str, str, str, str]:
        """Return the codes of network, station, location and channel; codes that are not stated are empty."""
        for comment in self.comments:
            scnl = _SCNL.match(comment)
            if scnl:
                station, channel, network, location = scnl.groups()
                return network.strip("-"), station, location.strip("-"), channel
        code, number = _CODE.search(self.text[4]), self.integer(8)
        network, station = (code[1].strip("-_"), code[2]) if code else ("", "")
        return network, station or ("" if number is None else str(number)), "", ""

    def channel(self) -> tuple[str, str, str]:
        """Return channel number, direction and location of the sensor from text line 9; empty if not stated."""
        match = _CHANNEL.match(self.text[8])
        return (match[1], match[2], match[3] or "") if match else ("", "", "")

    def counted(self) -> kit.Counted:
        """Return the channel with the number of channels that the header states for its recorder."""
        counted = _COUNTED.search(self.text[6])
        count = int(counted[1]) if counted else 0
        return kit.Counted(self.start + 1, self.text[6], self.channel()[0], count, self.kind.lower())

    def peak(self) -> tuple[str, str]:
        """Return the stated peak and its unit as texts, from text line 11 or, for a raw record, line 10."""
        raw = not self.kind.lower().startswith("corrected")
        found = _PEAK.search(self.text[10]) or (_PEAK.search(self.text[9]) if raw else None)
        return (found[1], found[2]) if found else ("", "")

    def facing(self) -> kit.Direction:
        """Return the direction from text line 9 and header integer 54; unknown, with a warning, if they differ."""
        words, code = self.channel()[1], self.integer(54)
        said, coded = kit.direction(words), kit.Direction()
        if code is not None:
            azimuth = kit.Direction("horizontal", float(code % 360)) if 0 <= code <= 360 else kit.Direction()
            coded = _ORIENTATIONS.get(code, azimuth)
        if "unknown" in (said.orientation, coded.orientation):
            return said if said.orientation != "unknown" else coded
        seed, both = self.codes()[3], (said, coded)
        if kit.means_vertical(seed) and {one.orientation for one in both} == {"vertical", "horizontal"}:
            upright = next(one for one in both if one.orientation == "vertical")
            stated = f"{words!r} and {code} (integer 54 of the header)"
            return replace(upright, note=WarningText("vertical_by_code", channel=seed, stated=stated))
        if kit.contradictory(said, coded):
            note = f"the text says {words!r}, but integer 54 of the header says {code}: the direction is unknown"
            return kit.Direction(note=kit.doubted_direction(said, coded, note))
        return coded if np.isnan(said.azimuth) else said

    def structural(self) -> bool:
        """Return whether the sensor is on a structure, by header integer 19 and the location in text line 9."""
        site, place = self.integer(19), self.channel()[2]
        return kit.on_structure(place or ("structure" if site in _STRUCTURES else ""), stated=site not in _ON_GROUND)

    def start_time(self) -> tuple[datetime | None, list[str]]:
        """Return the UTC time of the first sample (None if it is unknown), and warnings about this time."""
        year, month, day, hour, minute = (self.integer(number) for number in (40, 42, 43, 44, 45))
        if year is None or month is None or day is None or hour is None or minute is None:
            return None, []
        clock = _CLOCK.search(self.text[7])
        zone = clock[2] if clock and clock[2] else "UTC"
        if zone.upper() not in ("UTC", "GMT"):
            return None, [f"the start time is in {zone}, but the format requires UTC; it was left out"]
        if self.integer(46) == 0:
            return None, ["the start time has quality 0 (clock of the recorder not set); it was left out"]
        seconds = self.real(30)
        if np.isnan(seconds) and clock and clock[1] not in ("", "."):
            seconds = float(clock[1])
        if np.isnan(seconds):
            return None, ["the start time has no seconds; it was left out"]
        moment = kit.instant((year, month, day), (hour, minute, seconds))
        wrong = f"{year}-{month}-{day} {hour}:{minute}:{seconds:g} (integers 40 to 45) is not a valid start time"
        return moment, [wrong] if moment is None else []


def fortran_layout(line: str, where: str) -> tuple[int, int]:
    """Return the number of fields per row and of characters per field from a heading with ``Format=(8F9.6)``."""
    layout = _LAYOUT.search(line[: kit.LONGEST_LINE])
    if not layout or int(layout[1]) < 1 or int(layout[2]) < 1:
        raise kit.unexpected(where, "a format such as Format=(8F9.6)", repr(line.strip()[:90]))
    return int(layout[1]), int(layout[2])


def read_cosmos_header(name: str, lines: Sequence[str], start: int, end: int) -> CosmosHeader:
    """Read the header of the channel in ``lines[start:end]``; the first of these lines is its title."""
    title = TITLE.match(" ".join(lines[start].split()))  # a repeated title may have other spaces
    assert title is not None
    # More lines of text than the 13 of the format are allowed, fewer are not.
    count = max(int(title[2]), 13)
    kit.check_count(f"{name}:{end}", count, end - start, "text lines")
    text = [line[: kit.LONGEST_LINE] for line in lines[start : start + count]]
    stated = _UNKNOWN.match(text[12].strip())
    unknown_integer, unknown = (int(stated[1]), float(stated[2])) if stated else (-999, -999.0)
    integers, at = _numbers(name, lines, start + count, end, "integer")
    reals, at = _numbers(name, lines, at, end, "real")
    comments = _count(name, lines, at, end, "comment")
    first = min(at + 1 + comments, end)
    for index in range(at + 1, first):
        if not lines[index].lstrip().startswith("|"):
            expected = f"comment {index - at} of {comments}, a line that begins with '|'"
            raise kit.unexpected(f"{name}:{index + 1}", expected, repr(lines[index][:40]))
    return CosmosHeader(
        kind=title[1].strip(),
        text=text,
        integers=np.where(integers == unknown_integer, np.nan, integers),
        reals=np.where(reals == unknown, np.nan, reals),
        unknown=unknown,
        comments=[line[: kit.LONGEST_LINE] for line in lines[at + 1 : first]],
        start=start,
        end=first,
    )


def _count(name: str, lines: Sequence[str], at: int, end: int, kind: str) -> int:
    """Return the number at the start of the line with index `at`, such as `` 100 Real-header values follow``."""
    heading = re.match(rf"\s*(\d{{1,9}})\s*{kind}\b", lines[at][:80], re.ASCII | re.IGNORECASE) if at < end else None
    if not heading:
        found = repr(lines[at].strip()[:60]) if at < end else "the end of the channel"
        raise kit.unexpected(f"{name}:{at + 1}", f"the number of {kind} values or lines", found)
    return int(heading[1])


def _numbers(name: str, lines: Sequence[str], at: int, end: int, kind: str) -> tuple[np.ndarray, int]:
    """Return the numbers below the heading with index `at`, and the index of the line after them."""
    count = _count(name, lines, at, end, kind)
    per_row, width = fortran_layout(lines[at], f"{name}:{at + 1}")
    rows = -(-count // per_row)
    block = lines[at + 1 : min(at + 1 + rows, end)]
    if len(block) == rows and any(len(row.rstrip()) != per_row * width for row in block[:-1]):
        # Fields in headers that were edited by hand may have lost their fixed width.
        values = kit.free_numbers(block, at + 2, name)
        if values.size == count:
            return values, at + 1 + rows
    return kit.fixed_width(block, at + 2, width, per_row, count, name), at + 1 + rows


def held_series(header: CosmosHeader, heading: str, step: float, samples: np.ndarray) -> list[str]:
    """Return warnings if the stated length or the stated time of the peak contradicts the samples."""
    raw = not header.kind.lower().startswith("corrected")
    spare = _LENGTH_SHARE * step * samples.size
    lengths = (kit.matched(_ABOUT, heading[: kit.LONGEST_LINE]), kit.matched(_RAW_LENGTH, header.text[9]) * raw)
    notes = [note for text in lengths for note in kit.held_length(text, samples.size, step, spare)]
    lines = header.text[9:11] if raw else header.text[10:11]
    stated = [match[1] for line in lines if (match := _PEAK_TIME.search(line))]
    if not np.isnan(header.real(65)):
        stated.append(f"{header.real(65):.6f}")
    times = step * np.arange(samples.size)
    for text in stated:
        notes += kit.held_peak_time(text, times, samples)
    return list(dict.fromkeys(notes))
