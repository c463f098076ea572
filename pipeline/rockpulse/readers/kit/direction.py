"""The meaning of the words for a component or a place: vertical, an azimuth, a structure."""

import math
import re
from dataclasses import dataclass

from rockpulse.record.record import Orientation
from rockpulse.warning_text import WarningText

#: The unit in a column heading, ``acc [g]``.
BRACKET = re.compile(r"[\[(]([^\])]*)[\])]")
# "CH 12" is a number, "12 deg" an angle.
_NUMBERED = re.compile(r"(?:^|[\W_])(?:ch|chan|channel|no|nr|sensor|col|column)[\W_]*\d+", re.IGNORECASE)
# Small u and v stand for displacement and velocity.
_LETTERS = frozenset("NEZUVnez")
_ANGLE = re.compile(r"(?<=\d)\s+(?=deg)", re.IGNORECASE)
# Decimals and quantities are no azimuths, unless degrees.
_QUANTITY = re.compile(
    r"(?<![\d.,])(?:\d*+[.,]\d++(?!\s*(?:deg|°))|\d++(?:[.,]\d++)?\s*(?:g|gals?|k?hz|sps|[mu]?s|sec|min|[ckm]?m|%)"
    r"(?![a-z\d]))",
    re.IGNORECASE,
)
_UP = {"UP", "U", "V", "Z", "VERT", "VERTICAL", "VER", "VRT", "UD", "U-D", "UP-DOWN", "UPDOWN"}
_UP |= {"UPWARD", "UPWARDS"}
_DOWN = {"DOWN", "DN", "DWN", "DOWNWARD", "DOWNWARDS"}
_COMPASS = {"N": 0.0, "NS": 0.0, "N-S": 0.0, "NORTH": 0.0, "E": 90.0, "EW": 90.0, "E-W": 90.0, "EAST": 90.0}
_COMPASS |= {"S": 180.0, "SOUTH": 180.0, "W": 270.0, "WEST": 270.0}
_SIDEWAYS = {"H1", "H2", "L", "T", "LONG", "TRAN", "TRANS", "LONGITUDINAL", "TRANSVERSE"}
_DEGREES = re.compile(r"(\d{1,3}(?:\.\d*)?)\s*(?:DEG(?:REES)?|°)?", re.ASCII)
_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d*)?)\s*([EW])", re.ASCII)
# SEED: band (not any letter, or the compass words NNE and WNW would count), instrument, direction.
_SEED = re.compile(r"[FGDCESHBMLV][HLMGN]([ENZ123])")
# Names of streets; a pier without a number may be a place on the ground too.
_NO_STREET = r"(?!\s+(?:st|street|dr|drive|rd|road|ave|avenue|ln|lane|blvd|way|ct|court|pl|place|school|park)\b)"
_ON_STRUCTURE = re.compile(
    r"\b(?:\d+(?:st|nd|rd|th)[\s-]+(?:fl(?:oor|r)?|level|stor(?:e?y|ies))|(?:level|floor)\s+[a-z]?\d+|"
    r"roof|penthouse|(?:sub-?)?basement|bsmt|mezzanine|attic|abut(?:ment)?|deck|pier\s*(?:no\.?\s*|\#\s*)?\d+|"
    r"(?:top|base|foot|cap)\s+of\s+pier|bent|span|column|footing|pile|girder|gallery|ground\s+floor|(?:wall|crest)"
    rf"{_NO_STREET})\b",
    re.IGNORECASE,
)
_FREE_FIELD = re.compile(
    r"free[\s-]*field|^ground(?:\s+(?:level|surface))?(?:$|\s*[,:-]|\s+(?:at|near|outside)\b)|^surface$", re.IGNORECASE
)


@dataclass(frozen=True)
class Direction:
    """The direction that the words for a component mean, and a doubt about it, for the warnings of the record."""

    orientation: Orientation = "unknown"
    azimuth: float = float("nan")  # clockwise from north [degrees]; NaN where unknown or not horizontal
    sign: float = 1.0  # -1 for a channel that is positive downwards, else 1
    note: str = ""


def direction(wording: str) -> Direction:
    """Read ``90 Deg``, ``S05W``, ``UP``, ``N-S``, ``HNE``, ``005``; a bare digit is the number of a channel."""
    word = " ".join(wording.upper().split()).strip(" .")
    seed = _SEED.fullmatch(word)
    if seed:
        word = {"1": "H1", "2": "H2", "3": ""}.get(seed[1], seed[1])
    if word in _UP:
        return Direction("vertical")
    if word in _DOWN:
        return Direction("vertical", sign=-1.0)
    if word[:1] in "+-" and word[1:].strip() in _UP | _DOWN:
        told = f"the component {wording.strip()!r} does not tell whether upwards is positive"
        return Direction("vertical", note=f"{told}; the sign is that of the file")
    if word in _COMPASS:
        return Direction("horizontal", _COMPASS[word])
    if word in _SIDEWAYS:
        return Direction("horizontal")
    degrees = _DEGREES.fullmatch(word)
    if degrees and len(word) > 1 and float(degrees[1]) <= 360.0:
        return Direction("horizontal", float(degrees[1]) % 360.0)
    quadrant = _QUADRANT.fullmatch(word)
    if quadrant and float(quadrant[2]) <= 90.0:
        angle = float(quadrant[2]) if quadrant[3] == "E" else -float(quadrant[2])
        return Direction("horizontal", (angle if quadrant[1] == "N" else 180.0 - angle) % 360.0)
    return Direction()


def means_vertical(code: str) -> bool:
    """Whether a channel code is that of SEED for a vertical channel."""
    seed = _SEED.fullmatch(code.strip().upper())
    return bool(seed and seed[1] == "Z")


def vertical_if_so(facing: Direction, code: str) -> Direction:
    """The direction of a header; vertical, with a warning, where the channel code says so against an azimuth of 0."""
    if facing.orientation != "horizontal" or not means_vertical(code):
        return facing
    told = "a horizontal direction" if math.isnan(facing.azimuth) else f"an azimuth of {facing.azimuth:g} degrees"
    return Direction("vertical", note=WarningText("vertical_by_code", channel=code.strip(), told=told))


def heading_direction(name: str) -> Direction:
    """The one word of a column heading that is a direction; a lone letter counts only if it is one of `_LETTERS`."""
    wording = _ANGLE.sub("", _NUMBERED.sub(" ", _QUANTITY.sub(" ", BRACKET.sub(" ", name))))
    words = re.split(r"[\s_\-:=]+|(?<!\d)\.|\.(?!\d)", wording)
    found = [direction(word) for word in words if len(word) > 1 or word in _LETTERS]
    known = [facing for facing in found if facing.orientation != "unknown"]
    return known[0] if len(known) == 1 else Direction()


def on_structure(place: str, stated: bool = False) -> bool:
    """Whether words for a place mean a structure; in a field that is `stated` for structures, all but free fields."""
    if not place.strip() or _FREE_FIELD.search(place.strip()):
        return False
    return stated or bool(_ON_STRUCTURE.search(place))
