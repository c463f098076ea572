"""Finds the direction of a sensor in words and codes, and whether its location is on a structure."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from rockpulse.readers.kit.motion_kinds import beside_kinds
from rockpulse.readers.source import SourceFile
from rockpulse.record.record import Orientation
from rockpulse.warning_text import WarningText

#: Pattern of the unit in a column heading, ``acc [g]``.
BRACKET = re.compile(r"[\[(]([^\])]*)[\])]")
# "CH 12" is a number, "12 deg" an angle.
_NUMBERED = re.compile(r"(?:^|[\W_])(?:ch|chan|channel|no|nr|sensor|col|column)[\W_]*\d+", re.IGNORECASE)
# Lower-case u and v mean displacement and velocity, a lower-case s means seconds.
_LETTERS = frozenset("NEZUVSWnez")
_ANGLE = re.compile(r"(?<=\d)\s+(?=deg)", re.IGNORECASE)
# Decimal numbers and numbers with a unit are not azimuths, unless the unit is degrees.
_QUANTITY = re.compile(
    r"(?<![\d.,])(?:\d*+[.,]\d++(?!\s*(?:deg|°))|\d++(?:[.,]\d++)?\s*(?:g|gals?|k?hz|sps|[mu]?s|sec|min|[ckm]?m|%)"
    r"(?![a-z\d]))",
    re.IGNORECASE,
)
_UPWARDS = (
    "UP U V Z VERT VERTICAL VER VRT UD U-D UP-DOWN UPDOWN UPWARD UPWARDS UP-DN UPDN U/D VERTICALE VERTIKAL VERTIKALE "
    "VERTICAAL DUSEY DÜŞEY UP/DOWN VERTICALA D-U"
)
_UP, _DOWN = frozenset(_UPWARDS.split()), frozenset(("DOWN", "DN", "DWN", "DOWNWARD", "DOWNWARDS"))
#: Names of the directions in English, French, German, Italian, Portuguese, Spanish and Turkish, by azimuth.
_NAMES = {
    0.0: "N NS N-S NORTH N/S S-N NORD NORTE KUZEY K-G NORTH-SOUTH NORD-SUD NORTE-SUR",
    90.0: "E EW E-W EAST E/W W-E WE EST ESTE OST LESTE DOGU DOĞU D-B E-O EAST-WEST O-E O-W EST-OUEST EST-OVEST "
    "ESTE-OESTE OST-WEST",
    180.0: "S SOUTH SUD SUR SÜD SUL GUNEY GÜNEY",
    270.0: "W WEST OUEST OESTE OVEST BATI",
}
_COMPASS = {name: azimuth for azimuth, names in _NAMES.items() for name in names.split()}
_SIDEWAYS = {"H1", "H2", "L", "T", "LONG", "TRAN", "TRANS", "LONGITUDINAL", "TRANSVERSE"}
_SIDEWAYS |= {"FN", "FP", "H", "HORIZONTAL", "RADIAL", "TRANSVERSAL", "FAULT-NORMAL", "FAULT-PARALLEL"}
_DEGREES = re.compile(r"(\d{1,3}(?:\.\d*)?)\s*(?:DEG(?:REES)?|°)?", re.ASCII)
_QUADRANT = re.compile(r"([NS])\s*(\d{1,2}(?:\.\d*)?)\s*([EW])", re.ASCII)
#: Pattern of the two ends of an axis in one word.
_AXIS = re.compile(
    r"(?<![A-Za-z])(?:N[-/]S|S-N|E[-/]W|W-E|U[-/]D|D-U|UP-?DN|UP[-/]DOWN|E-O|O-E|O-W|K-G|D-B|NORTH-SOUTH|EAST-WEST|"
    r"NORD-SUD|NORTE-SUR|EST-OUEST|EST-OVEST|ESTE-OESTE|OST-WEST|FAULT-(?:NORMAL|PARALLEL))(?![A-Za-z])",
    re.IGNORECASE,
)
#: Pattern of a word for acceleration that is followed by its direction.
_WITH_AXIS = re.compile(
    r"(?:(?<![a-z])(?:acc|accel|acceleration|acel)|(?<![a-z])(?:a|gf)(?=z))(ns|ew|ud|up|z|e|v|(?-i:N))(?![a-z])",
    re.IGNORECASE,
)
#: Suffixes of files, in lower case, that are not a direction; others may be one (.NS, .00U, .e).
_OF_TEXTS = "txt csv dat asc ascii tsv prn out g3 th acc vel dis at2 th1 tcl inp"
_TEXT_SUFFIXES = frozenset(_OF_TEXTS.split())
_LONGEST_SUFFIX = 5
_SUFFIX = re.compile(r"(\d{1,3})([A-Za-z])", re.ASCII)
#: Letters that mean a direction at either end of a file name, and words that may follow the direction.
_NAME_LETTERS = frozenset("NEZUVWneuz")
_FILLER = re.compile(
    r"(?i)raw|corr?|corrected|uncorrected|filt(?:ered)?|proc(?:essed)?|bc|bl|txt|csv|[cm]?ms?2|gal|g|\d+"
)
#: Pattern of a direction at the end of a name without a separator: PIC090, PICDWN.
_GLUED = re.compile(r"(?<=[A-Za-z_-])(\d{3}|DWN|VERT|DOWN)(?=$|[-_. ](?i:acc\w*|raw|corr?)$)", re.ASCII)
_FULL_TURN, _RIGHT_ANGLE = 360, 90
# SEED code: band, instrument, direction. Only some band letters are accepted, as NNE and WNW are compass words.
_SEED = re.compile(r"[FGDCESHBMLV][HLMGN]([ENZ123])")
# After "wall" or "crest", these words mean a street.
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
    """The direction of a component; `note` is a warning about this direction."""

    orientation: Orientation = "unknown"
    azimuth: float = float("nan")  # clockwise from north [degrees]; NaN where unknown or not horizontal
    sign: float = 1.0  # -1 for a channel that is positive downwards, else 1
    note: str = ""

    @property
    def label(self) -> str:
        """Return a short name of the direction, such as "UP" or "090"; empty if it is unknown."""
        if self.orientation == "vertical":
            return "UP" if self.sign > 0.0 else "DOWN"
        return "" if math.isnan(self.azimuth) else f"{self.azimuth:03.0f}"

    @property
    def opposite(self) -> "Direction":
        """Return the direction of a channel with the opposite sign."""
        if self.orientation == "vertical":
            return replace(self, sign=-self.sign)
        return replace(self, azimuth=(self.azimuth + 180.0) % 360.0)


def direction(wording: str) -> Direction:
    """Return the direction for words such as ``90 Deg``, ``S05W``, ``UP``, ``N-S``, ``HNE``; unknown for other text."""
    word = " ".join(wording.upper().split()).strip(" .")
    seed = _SEED.fullmatch(word)
    if seed:
        word = {"1": "H1", "2": "H2", "3": ""}.get(seed[1], seed[1])
    if word in _UP:
        return Direction("vertical")
    if word in _DOWN:
        return Direction("vertical", sign=-1.0)
    if word[:1] in "+-" and word[1:].strip() in _UP | _DOWN:
        reason = f"the component {wording.strip()!r} does not tell whether upwards is positive"
        return Direction("vertical", note=f"{reason}; the sign is that of the file")
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
    """Return whether a channel code is the SEED code of a vertical channel."""
    seed = _SEED.fullmatch(code.strip().upper())
    return bool(seed and seed[1] == "Z")


def vertical_if_so(facing: Direction, code: str) -> Direction:
    """Return `facing`; if it is horizontal but the channel code means vertical, a vertical direction with a warning."""
    if facing.orientation != "horizontal" or not means_vertical(code):
        return facing
    stated = "a horizontal direction" if math.isnan(facing.azimuth) else f"an azimuth of {facing.azimuth:g} degrees"
    return Direction("vertical", note=WarningText("vertical_by_code", channel=code.strip(), stated=stated))


def heading_direction(name: str) -> Direction:
    """Return the direction in the words of a column heading; unknown if they state none or several."""
    wording = _ANGLE.sub("", _NUMBERED.sub(" ", _QUANTITY.sub(" ", BRACKET.sub(" ", name))))
    found = []
    for piece in re.split(r"[\s_:=,]+", wording):
        whole = direction(piece) if _AXIS.fullmatch(piece) else Direction()
        words = re.split(r"[-/]+|(?<!\d)\.|\.(?!\d)", piece) if whole.orientation == "unknown" else []
        found += [whole, *(direction(word) for word in words if len(word) > 1 or word in _LETTERS)]
    if not any(facing.orientation != "unknown" for facing in found):  # acc (N), az, accEW
        found += [direction(text.strip()) for text in BRACKET.findall(name) if is_direction(text.strip())]
        found += [direction(match[1]) for match in _WITH_AXIS.finditer(wording)]
    return _one_of(found)


def is_direction(text: str) -> bool:
    """Return whether text in brackets is a direction rather than a unit."""
    return (len(text) > 1 or text in _LETTERS) and direction(text).orientation != "unknown"


def _one_of(found: Sequence[Direction]) -> Direction:
    """Return the most precise of several directions; unknown if they contradict each other."""
    known = [facing for facing in found if facing.orientation != "unknown"]
    precise = [facing for facing in known if not math.isnan(facing.azimuth)] or known
    alike = {(facing.orientation, facing.sign) for facing in known} | {(one.azimuth,) for one in precise}
    return precise[0] if len(alike) == 2 or len(precise) == len(known) == 1 else Direction()


def name_direction(file: SourceFile) -> Direction:
    """Return the direction in a file name, such as rec_E, rec-UP, rec.NS, rec.00U, EW.txt, PIC090.

    Three digits after letters (PIC090) are an azimuth if they are a multiple of 90, or if the folder also contains
    a file of the same name with a perpendicular azimuth or a vertical component; otherwise they may be a station
    number. A single letter is a direction if it is at either end of the name.
    """
    path = file.path
    suffix, stem = path.suffix[1:], path.stem
    if suffix.lower() in _TEXT_SUFFIXES or len(suffix) > _LONGEST_SUFFIX:
        suffix = ""
    numbered = _SUFFIX.fullmatch(suffix)
    facing = direction(suffix.rstrip("0123456789") if suffix.isalnum() else "")
    if facing.orientation != "unknown":
        return facing
    if numbered:
        facing = direction(numbered[2])
        return facing if numbered[1] in ("00", "0") or facing.orientation == "vertical" else Direction("horizontal")
    axis = _AXIS.search(stem)
    pieces = [piece for text in re.split(r"[\W_]+", stem) if text for piece in beside_kinds(text)]
    ends = [piece for piece in pieces if not _FILLER.fullmatch(piece)]
    words = [word for word in ends if len(word) > 1 and not word.isdecimal()]
    words += [word for word in {*ends[:1], *ends[-1:]} if word in _NAME_LETTERS]
    words += [axis[0]] if axis else []
    found = [direction(re.sub(r"(?<=[A-Za-z])\d$", "", word) if len(word) > 2 else word) for word in words]
    if not found or _one_of(found).orientation == "unknown":  # longitudinal, transverse
        found += [direction(word) for word in ends[-1:] if word in ("L", "T")]
    facing = _one_of(found)
    glued = _GLUED.search(stem)
    if facing.orientation != "unknown" or not glued:
        return facing
    if not glued[1].isdecimal():
        return direction(glued[1])
    return direction(glued[1]) if _has_partner(file, glued) else Direction()


def name_suffix(file: SourceFile) -> str:
    """Return the suffix of a file name, such as L of rec.L; empty for usual suffixes of text files."""
    suffix = file.path.suffix[1:]
    return suffix if suffix.isalpha() and suffix.lower() not in _TEXT_SUFFIXES else ""


def _has_partner(file: SourceFile, glued: re.Match[str]) -> bool:
    """Return whether three digits at the end of a file name are an azimuth, by the rules of `name_direction`."""
    azimuth, before, behind = int(glued[1]), glued.string[: glued.start()], file.path.suffix
    if azimuth > _FULL_TURN:
        return False
    if azimuth % _RIGHT_ANGLE == 0:
        return True
    angles = [(azimuth + turn) % _FULL_TURN for turn in (_RIGHT_ANGLE, -_RIGHT_ANGLE)]
    others = [*(f"{angle:03d}" for angle in angles), "-UP", "UP", "DWN", "-DWN", "-V", "-DN"]
    return any(file.beside(f"{before}{other}{behind}") is not None for other in others)


def on_structure(place: str, stated: bool = False) -> bool:
    """Return whether a sensor location is on a structure; if `stated`, all but blank and free-field locations are."""
    if not place.strip() or _FREE_FIELD.search(place.strip()):
        return False
    return stated or bool(_ON_STRUCTURE.search(place))
