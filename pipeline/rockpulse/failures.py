"""Rows for files and channels that did not become an assessed record, with the reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["NO_RECORD", "Failure", "FailureKind"]

#: Why a text, a table or a picture that lies beside records was passed over.
NO_RECORD = "no record"

FailureKind = Literal["failed", "skipped", "duplicate", "depth", "vertical", "structural"]


@dataclass(frozen=True)
class Failure:
    """One row of the failures table.

    `file` is ``archive.zip!member`` for a member of an archive. `stage` is the step that left it out: "find", "read",
    "events", "select", "pair", "rotate", "assess", "calibrate" or "fragility". `kind` is "failed", which needs
    attention; "skipped" for no acceleration record, met in a folder, glob or zip, or one too weak for the purpose;
    "duplicate" where the same content was read already, or another record of the same shaking is assessed in its place;
    "depth" where that one was recorded nearer to the surface; "vertical" or "structural" where it was read, but not
    assessed as horizontal ground motion.
    """

    file: str
    stage: str
    reason: str
    kind: FailureKind
