"""Formats without an accelerogram that are recognised, so that messages name them and no reader takes them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NoReturn

from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.source import NotAcceleration, SourceFile

__all__ = ["FORMATS"]

#: Bytes from the start of a file that decide.
_OPENING = 4000

#: Number of the station, and in the line below its name.
_STATION = re.compile(r"^\s?station no\.?\s+(\w+)\b[^\r\n]*[\r\n]+(\S[^\r\n]*?)(?:\s\s|[\r\n])", re.I | re.M)


@dataclass(frozen=True)
class _Refused:
    """A format that is recognised by its first lines and refused."""

    name: str
    what: str
    example: str
    opening: str  # regular expression that matches from the start of the file; case does not matter

    def detect(self, head: bytes, name: str) -> bool:
        """Whether the file begins like this format."""
        return bool(re.match(self.opening, head[:_OPENING].decode("latin-1"), re.IGNORECASE))

    def parse(self, file: SourceFile, options: ReadOptions) -> NoReturn:
        """Refuse the file with the reason."""
        station = _STATION.search(file.head[:_OPENING].decode("latin-1"))
        of = f" of station {station[1]}, {' '.join(station[2].split())}" if station else ""
        raise NotAcceleration(
            f"{file.name}:1: expected an accelerogram{of}, found {self.what}; read the volume 1 or 2 (.V1, .V2) of "
            "the same record"
        )


#: Only formats whose first lines leave no doubt.
_REFUSED = (
    _Refused(
        "csmip_v3",
        "response and Fourier spectra (volume 3 of CSMIP or USC)",
        "CE89146.V3",
        r"\s?response and fourier|\s?(?:response|fourier)\b[^\r\n]*\bspectr[^\r\n]*[\r\n]+\s?corrected accelerogram",
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
