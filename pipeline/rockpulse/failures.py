"""Rows for files and channels that did not become an assessed record, with the reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["NO_RECORD", "Failure", "FailureKind"]

#: Why a text, a table or a picture that lies beside records was passed over.
NO_RECORD = "no record"

FailureKind = Literal["failed", "skipped", "duplicate", "vertical", "structural"]


@dataclass(frozen=True)
class Failure:
    """One row of the failures table.

    Attributes
    ----------
    file : str
        Path of the file; ``archive.zip!member`` for a member of an archive.
    stage : str
        Step that left it out: "find", "read", "events", "select", "pair", "rotate", "assess", "calibrate", "fragility".
    reason : str
        The message for the user.
    kind : {"failed", "skipped", "duplicate", "vertical", "structural"}
        "failed" needs attention. "skipped": no acceleration record, met in a folder, glob or zip, or one that is too
        weak for the purpose. "duplicate": the same content was read already. "vertical", "structural": read,
        but not assessed as horizontal ground motion.
    """

    file: str
    stage: str
    reason: str
    kind: FailureKind
