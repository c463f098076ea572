"""The design sequence of a site file."""

from __future__ import annotations

import math
from pathlib import Path

from rocking.sequence import ImpulseSequence
from rockpulse.errors import ResultsError
from rockpulse.storage.save_load import ASSESSMENT, load, named
from rockpulse.storage.site_variables import SITE_KIND

__all__ = ["load_design"]


def load_design(path: str | Path) -> ImpulseSequence:
    """The design sequence that ``rockpulse calibrate`` has stored.

    Parameters
    ----------
    path : str or Path
        A site file.

    Returns
    -------
    ImpulseSequence
        The `design` of the file.

    Raises
    ------
    ResultsError
        For a file that is no results file of rockpulse, or of another kind.
    OSError
        Where the file cannot be opened.
    """
    tree = load(path)
    kind = tree.attrs.get("kind", ASSESSMENT)
    if kind != SITE_KIND:
        raise ResultsError(f"{path}: expected a site file of 'rockpulse calibrate', found {named(kind)}")
    site = tree["site"].to_dataset()
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    return ImpulseSequence(
        main=value["main"],
        secondary=min(value["ratio"] * value["main"], value["main"]),
        interval=value["interval"],
        duration=math.inf if math.isnan(value["duration"]) else value["duration"],
        main_count=None if math.isnan(value["main_count"]) else int(value["main_count"]),
        spacing=str(site.attrs["spacing"]),
    )
