"""Formats that are known at sight but not read, so that the message names them and no other reader mistakes them.

In a folder they fail, while a file that is no record is skipped: an archive of such records is not passed over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NoReturn

from rockpulse.errors import RecordRefused
from rockpulse.readers.source import NotAcceleration, SourceFile

__all__ = ["REFUSED", "Refused"]

#: Bytes from the start of a file that decide.
_OPENING = 4000


@dataclass(frozen=True)
class Refused:
    """A format that is recognised by its first lines and refused.

    Attributes
    ----------
    name, what : str
        As `rockpulse formats` shows them.
    opening : str
        Regular expression that matches from the start of the file, case does not matter.
    acceleration : bool
        False for files that hold no accelerogram at all.
    """

    name: str
    what: str
    opening: str
    acceleration: bool = True

    def detect(self, head: bytes, name: str) -> bool:
        """Whether the file begins like this format."""
        return bool(re.match(self.opening, head[:_OPENING].decode("latin-1"), re.IGNORECASE))

    def parse(self, file: SourceFile, units: str | None = None, dt: float | None = None) -> NoReturn:
        """Refuse the file with the reason."""
        if self.acceleration:
            raise RecordRefused(
                f"{file.name}:1: {self.what}: not read by this version; "
                "convert the record to AT2 or to columns of time and acceleration"
            )
        raise NotAcceleration(f"{file.name}:1: expected an accelerogram, found {self.what}; read the V1 or V2 file")


#: Only formats whose first lines leave no doubt.
REFUSED = (
    Refused("csmip_v2", "CSMIP or USC volume 2 (corrected)", r"\s?corrected accelerogram\s.*\b(?:chan|comp)\b"),
    Refused(
        "csmip_v3", "response and Fourier spectra (CSMIP volume 3)", r"\s?response and fourier", acceleration=False
    ),
    Refused("usc_v1", "USC volume 1", r"\s?file\s+\d+ of uncorrected accelerogram data of volume"),
    Refused("cosmos", "COSMOS V0, V1 or V2", r"[^\n]*\(Format v0?\d+\.\d+ with \d+ text lines\)"),
    Refused("dyna", "DYNA (ESM, ITACA)", r"event_name:"),
    Refused("geonet", "GeoNet V1A or V2A", r"(?:un)?corrected accelerogram \d{8}_\d{6}_\w+ GNS"),
    Refused("bhrc", "BHRC volume 1 (Iran)", r"\s*\*\s*vol1\w*\s+file\s*:"),
    Refused("nsmn", "NSMN (Turkey, before AFAD)", r"\s*strong ground motion records of t"),
    # The accents come in one byte, in two, or not at all.
    Refused("asa", "UNAM or CIRES standard acceleration (Mexico)", r"[^\0]{0,2000}?archivo est.{1,2}ndar de aceleraci"),
    Refused("cwb", "CWB or CWA free-field (Taiwan)", r"#[^\0]{0,2000}?\n#\s*amplitude\s*unit\s*:\s*gal"),
    Refused("csmnc", "CSMNC (China)", r"[^\n]*\$\s*\n[^\0]{0,2000}?equally spaced intervals of\s*:[^\n]*\$"),
)
