"""Formats that are known at sight but not read, so that the message names them and no other reader mistakes them.

In a folder they fail, while a file that is no record is skipped: an archive of such records is not passed over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NoReturn

from rockpulse.errors import RecordRefused
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import NotAcceleration, SourceFile

__all__ = ["FORMATS"]

#: Bytes from the start of a file that decide.
_OPENING = 4000


@dataclass(frozen=True)
class _Refused:
    """A format that is recognised by its first lines and refused.

    Attributes
    ----------
    name, what, example : str
        As in `Format`.
    opening : str
        Regular expression that matches from the start of the file, case does not matter.
    acceleration : bool
        False for files that hold no accelerogram at all.
    """

    name: str
    what: str
    example: str
    opening: str
    acceleration: bool = True

    def detect(self, head: bytes, name: str) -> bool:
        """Whether the file begins like this format."""
        return bool(re.match(self.opening, head[:_OPENING].decode("latin-1"), re.IGNORECASE))

    def parse(self, file: SourceFile, options: ReadOptions) -> NoReturn:
        """Refuse the file with the reason."""
        if self.acceleration:
            raise RecordRefused(
                f"{file.name}:1: {self.what}: not read by this version; "
                "convert the record to AT2 or to columns of time and acceleration"
            )
        raise NotAcceleration(f"{file.name}:1: expected an accelerogram, found {self.what}; read the V1 or V2 file")


#: Only formats whose first lines leave no doubt.
_REFUSED = (
    _Refused(
        "csmip_v2", "CSMIP or USC volume 2 (corrected)", "CE58667.V2", r"\s?corrected accelerogram\s.*\b(?:chan|comp)\b"
    ),
    _Refused(
        "csmip_v3",
        "response and Fourier spectra (CSMIP volume 3)",
        "CE89146.V3",
        r"\s?response and fourier",
        acceleration=False,
    ),
    _Refused("usc_v1", "USC volume 1", "017m30lw.e0a", r"\s?file\s+\d+ of uncorrected accelerogram data of volume"),
    _Refused("cosmos", "COSMOS V0, V1 or V2", "CE23837.V1C", r"[^\n]*\(Format v0?\d+\.\d+ with \d+ text lines\)"),
    _Refused("dyna", "DYNA (ESM, ITACA)", "HI.ARS1..HNE.D.20190728.160908.C.ACC.ASC", r"event_name:"),
    _Refused(
        "geonet",
        "GeoNet V1A or V2A",
        "20161113_110313_THZ_20.V2A",
        r"(?:un)?corrected accelerogram \d{8}_\d{6}_\w+ GNS",
    ),
    _Refused("bhrc", "BHRC volume 1 (Iran)", "5520-1.V1", r"\s*\*\s*vol1\w*\s+file\s*:"),
    _Refused("nsmn", "NSMN (Turkey, before AFAD)", "20170720223109_0921.txt", r"\s*strong ground motion records of t"),
    # The accents come in one byte, in two, or not at all.
    _Refused(
        "asa",
        "UNAM or CIRES standard acceleration (Mexico)",
        "CUP50401.012",
        r"[^\0]{0,2000}?archivo est.{1,2}ndar de aceleraci",
    ),
    _Refused("cwb", "CWB or CWA free-field (Taiwan)", "2-EGF.dat", r"#[^\0]{0,2000}?\n#\s*amplitude\s*unit\s*:\s*gal"),
    _Refused(
        "csmnc",
        "CSMNC (China)",
        "051WCW080512142801.EW.dat",
        r"[^\n]*\$\s*\n[^\0]{0,2000}?equally spaced intervals of\s*:[^\n]*\$",
    ),
)

FORMATS = tuple(
    Format(
        name=row.name,
        what=row.what,
        recognised=f"first lines like {row.opening}",
        unit="-",
        processed="-",
        example=row.example,
        detect=row.detect,
        parse=row.parse,
    )
    for row in _REFUSED
)
