"""RENADIC volume 1 files of Chile (Universidad de Chile), in the layout of CSMIP pairs.

Recorders with four channels have one without a sensor, which contains only zeros. Long records are split into files
``...parte1.v1``, ``...parte2.v1``. Origin times are from the clocks of the instruments, some of which were never set.
"""

import re
from dataclasses import replace
from functools import partial

from rockpulse.errors import RecordRefused
from rockpulse.readers import kit
from rockpulse.readers.format import Format, ReadOptions
from rockpulse.readers.formats.csmip import UNCORRECTED, is_uncorrected, read_uncorrected
from rockpulse.readers.kit.csmip_layout import HEADER_LINES, channels, read_csmip_header
from rockpulse.readers.parts import PartRule

_FIRST_TIME = re.compile(r"\s*(-?\d{0,6}\.\d{1,9})", re.ASCII)


def read_renadic(file: kit.SourceFile, options: ReadOptions) -> list[kit.Record]:
    """Read every channel except dead ones; raise RecordRefused if all are dead."""
    records = [replace(record, origin_time=None) for record in read_uncorrected(file, options)]
    kept = [record for record in records if record.acceleration.any()]
    if not kept:
        raise RecordRefused(f"{file.name}: all samples of all channels are zero: no sensor was connected")
    notes = [
        f"channel {number} ({record.component}) is dead, all samples are zero; it was left out"
        for number, record in enumerate(records, start=1)
        if not record.acceleration.any()
    ]
    return kit.with_warnings(kept, notes)


def _first_times(file: kit.SourceFile) -> dict[str, float]:
    """Return the time of the first sample of each component [s]; if a component occurs twice, the first one is used."""
    lines, spans, _ = channels(file, UNCORRECTED, "Uncorrected Accelerogram Data")
    times: dict[str, float] = {}
    for start, _ in spans:
        component = read_csmip_header(lines[start : start + HEADER_LINES]).full_component.strip()
        times.setdefault(component, float(kit.matched(_FIRST_TIME, lines[start + HEADER_LINES]) or 0.0))
    return times


RENADIC = Format(
    name="renadic",
    what="RENADIC (Chile) volume 1, parts joined",
    recognised="first line 'Uncorrected Accelerogram Data', RENADIC in the header",
    unit="g/10, from the header",
    example="curico1002271parte1.v1",
    detect=partial(is_uncorrected, renadic=True),
    parse=read_renadic,
    parts=PartRule(re.compile(r"(.*?)[\s_-]*parte?[\s_-]*(\d{1,2})", re.IGNORECASE | re.ASCII), _first_times),
)
