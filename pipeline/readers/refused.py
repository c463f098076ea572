"""Formats that are known at sight but not read, so that the message names them and no other reader mistakes them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NoReturn

from rockpulse.errors import RecordRefused
from rockpulse.readers.source import NotAcceleration, SourceFile

__all__ = ["REFUSED", "Refused"]


@dataclass(frozen=True)
class Refused:
    """A format that is recognised by the first line and refused.

    Attributes
    ----------
    name, what : str
        As `rockpulse formats` shows them.
    first_line : str
        Regular expression, case does not matter.
    acceleration : bool
        False for files that hold no accelerogram at all.
    """

    name: str
    what: str
    first_line: str
    acceleration: bool = True

    def detect(self, head: bytes, name: str) -> bool:
        """Whether the file begins like this format."""
        return bool(re.match(self.first_line, head[:400].decode("latin-1"), re.IGNORECASE))

    def parse(self, file: SourceFile, units: str | None = None, dt: float | None = None) -> NoReturn:
        """Refuse the file with the reason."""
        if self.acceleration:
            raise RecordRefused(
                f"{file.name}:1: {self.what}: this version does not read the format; "
                "convert the record to AT2 or to columns of time and acceleration"
            )
        raise NotAcceleration(f"{file.name}:1: expected an accelerogram, found {self.what}; read the V1 or V2 file")


#: Only formats whose first line leaves no doubt.
REFUSED = (
    Refused("csmip_v2", "CSMIP or USC volume 2 (corrected)", r"\s?corrected accelerogram\s.*\b(?:chan|comp)\b"),
    Refused(
        "csmip_v3", "response and Fourier spectra (CSMIP volume 3)", r"\s?response and fourier", acceleration=False
    ),
    Refused("usc_v1", "USC volume 1", r"\s?file\s+\d+ of uncorrected accelerogram data of volume"),
    Refused("cosmos", "COSMOS V0, V1 or V2", r"[^\n]*\(Format v0?\d+\.\d+ with \d+ text lines\)"),
    Refused("dyna", "DYNA (ESM, ITACA)", r"event_name:"),
    Refused("geonet", "GeoNet V1A or V2A", r"(?:un)?corrected accelerogram \d{8}_\d{6}_\w+ GNS"),
)
