"""Files (volumes 1 and 2) of the University of Southern California, and earlier of Caltech, in the layout of CSMIP.

Volume 1 contains pairs of time [s] and acceleration [g/10] of a digitised trace, with unequal steps; volume 2 contains
corrected acceleration [cm/s2], then velocity and displacement. The time in the header is the minute of the
earthquake.
"""

import re
from collections.abc import Sequence
from functools import partial

import numpy as np

from rockpulse.readers import kit
from rockpulse.readers.format import Format, begins_with
from rockpulse.readers.formats.csmip import read_corrected, read_uncorrected
from rockpulse.readers.kit import csmip_layout
from rockpulse.readers.kit.csmip_layout import HEADER_LINES, TEXT_LINES, direction_code

_TITLE = re.compile(r"\s?file\s+\d+\s+of uncorrected accelerogram data\b", re.IGNORECASE)
_CORRECTED = re.compile(r"(?:\s?corrected accelerogram\b[^\r\n]*[\r\n]+)+" + _TITLE.pattern, re.IGNORECASE)
_WORDS = 72  # number of characters of the text; the number of a punched card follows
_STATION = re.compile(r"\s*station\s+(?:usc#|no\.?)\s*(\w+)", re.IGNORECASE)
#: Pattern of the minute of the earthquake in Greenwich time: OCT 01, 1987 -1442 GMT.
_MINUTE = re.compile(r"(?ai)\s*([A-Z]{3})[A-Z]*\.?\s+(\d{1,2}),\s*(\d{4})\s*-\s*(\d\d)(\d\d)\s+GMT")
_MONTHS = ["JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"]
_MAGNITUDE = re.compile(r"\s*magnitude\s*=\s*(\d{1,2}\.\d{0,3})\s", re.ASCII | re.IGNORECASE)
_DISTANCE = re.compile(r".{0,60}epicentral distance\s*=\s*(\d{1,5}\.\d{0,4})\s*km", re.ASCII | re.IGNORECASE)
#: First line of floating-point values of volume 1 (8F10); 11, 12 and 14 are distance [km], magnitude, depth [km].
_REALS = TEXT_LINES + 7
_COMPONENT = re.compile(r"\s*comp(?:onent)?\s+(.*)", re.IGNORECASE)
_DURATION = re.compile(r".{0,40}?\bduration\s*=\s*(\d{0,6}\.\d{1,6})\s*sec", re.ASCII | re.IGNORECASE)
_MEAN_SQUARE = re.compile(
    r"\s*rms acc\w{0,3}\.? of complete record\s*=\s*(\d{0,4}\.\d{1,6})\s*(g(?:/10)?)(?=\s|$)", re.ASCII | re.IGNORECASE
)
#: Tolerance between the root mean square in the header (of the trace before resampling) and that of the samples: this
#: factor, and half a unit of the last digit.
_MEAN_SQUARE_FACTOR = 1.2


def _held(head: Sequence[str], block: kit.ChannelSamples) -> list[str]:
    """Return warnings if the stated duration or root mean square contradicts the samples."""
    texts = kit.matched(_DURATION, head[10][:_WORDS]), csmip_layout.real_header_value(head[TEXT_LINES:], 3)
    notes = [note for text in texts for note in kit.held_length(text, round(block.duration / block.dt), block.dt)]
    square = _MEAN_SQUARE.match(head[12][:_WORDS])
    if not square:
        return notes
    stated, half = (value * kit.UNITS[square[2].lower()] for value in kit.printed_number(square[1]))
    peak = float(np.max(np.abs(block.samples))) or 1.0  # the square of a damaged sample may overflow
    found = peak * float(np.sqrt(np.mean((block.samples / peak) ** 2))) * kit.UNITS[block.unit]
    if stated > _MEAN_SQUARE_FACTOR * found + half or found > _MEAN_SQUARE_FACTOR * (stated + half):
        said, has = (f"{value / kit.UNITS['g']:.3g} g" for value in (stated, found))
        notes.append(f"the header states {said} as the root mean square, but the samples have {has}; check the unit")
    return notes


def _header(lines: Sequence[str]) -> csmip_layout.CsmipHeader:
    text, behind = [line[:_WORDS].strip() for line in lines[:TEXT_LINES]], lines[TEXT_LINES:]
    # In volume 2, the lines of the magnitude and the distance; volume 1 has them among the floating-point values.
    row = lines[_REALS + 1] if len(lines) >= HEADER_LINES else ""
    distance = kit.first_match(_DISTANCE, behind) or row[20:30]
    magnitude = kit.first_match(_MAGNITUDE, behind) or row[30:40]
    minute, origin = _MINUTE.match(text[2]), None
    if minute and minute[1].upper() in _MONTHS:
        day = (int(minute[3]), _MONTHS.index(minute[1].upper()) + 1, int(minute[2]))
        origin = kit.instant(day, (int(minute[4]), int(minute[5]), 0.0))
    about = {
        "structural": kit.on_structure(text[5]),
        "station": kit.matched(_STATION, text[4]),
        "station_name": text[5],
        "event": " ".join((text[7] or text[1]).split()),
        "origin_time": origin,
        "magnitude": (magnitude, ""),
        "hypocentre": kit.coordinates(text[8]),
        "depth_km": row[50:60],
        "distance_km": distance,
        "station_place": kit.coordinates(text[4]),
    }
    component = _COMPONENT.match(text[6])
    return csmip_layout.CsmipHeader(component[1] if component else text[6], about=about, code=direction_code(behind))


USC_V1 = Format(
    name="usc_v1",
    what="USC volume 1 (pairs of time and acceleration of a digitised trace)",
    recognised="first line 'FILE N OF UNCORRECTED ACCELEROGRAM DATA'",
    unit="g/10, from the header",
    example="017m30lw.e0a",
    detect=begins_with(_TITLE),
    parse=partial(
        read_uncorrected,
        title=_TITLE,
        wording="FILE N OF UNCORRECTED ACCELEROGRAM DATA",
        read_header=_header,
        held=_held,
    ),
)
USC_V2 = Format(
    name="usc_v2",
    what="USC volume 2, the acceleration",
    recognised="second line 'FILE N OF UNCORRECTED ACCELEROGRAM DATA'",
    unit="cm/s2, from the peak in the header",
    processed="yes",
    example="274o42pv.s0a",
    detect=begins_with(_CORRECTED, 1000),
    parse=partial(read_corrected, read_header=_header),
)
