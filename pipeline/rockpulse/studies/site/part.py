"""What a record adds to a site as text and back, without pickle: what a worker sends and the journal keeps."""

from __future__ import annotations

import json
from dataclasses import fields
from datetime import datetime
from typing import Any

import numpy as np

from rocking.sequence import ImpulseSequence
from rockpulse.record.record import Record
from rockpulse.remark import recognised
from rockpulse.studies.site.record import SiteRecord

__all__ = ["pack_site_record", "unpack_site_record"]

#: What a packed record of a site begins with.
MAGIC = b"RPS1"


def pack_site_record(done: SiteRecord) -> bytes:
    """A record of a site without its samples, as bytes that :func:`unpack_site_record` reads without trusting them.

    Parameters
    ----------
    done : SiteRecord
        With or without samples; its sequence is one sequence.

    Notes
    -----
    ``RPS1`` and JSON (with NaN and Infinity), in which every float comes back to the last bit.
    """
    record = {name: value for name, value in _fields(done.record).items() if name != "acceleration"}
    text = {
        **_fields(done),
        "record": {**record, "npts": done.record.npts},
        "sequence": _fields(done.sequence),
        "peaks": done.peaks.tolist(),
    }
    return MAGIC + json.dumps(text, default=_plain).encode()


def unpack_site_record(packed: bytes) -> SiteRecord:
    """The record that was packed, with zeros that take no memory in place of its samples.

    Parameters
    ----------
    packed : bytes
        As `pack_site_record` made it.

    Raises
    ------
    ValueError
        For bytes that are something else.
    """
    if packed[: len(MAGIC)] != MAGIC:
        raise ValueError("expected a packed record of a site, found other bytes")
    text = json.loads(packed[len(MAGIC) :])
    record = text["record"]
    start = record["start_time"]
    record |= {
        "acceleration": np.broadcast_to(0.0, record.pop("npts")),
        "start_time": None if start is None else datetime.fromisoformat(start),
        "warnings": tuple(map(recognised, record["warnings"])),
        "processing": tuple(map(recognised, record["processing"])),
    }
    text |= {
        "record": Record(**record),
        "sequence": ImpulseSequence(**text["sequence"]),
        "intervals": {name: tuple(ends) for name, ends in text["intervals"].items()},
        "peaks": np.array(text["peaks"], dtype=float),
        "remarks": tuple(text["remarks"]),
    }
    return SiteRecord(**text)


def _fields(one: Any) -> dict[str, Any]:
    return {field.name: getattr(one, field.name) for field in fields(one)}


def _plain(value: Any) -> Any:
    """What JSON does not know as something that it does."""
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"expected numbers, texts and times in a record of a site, found {type(value).__name__}")
