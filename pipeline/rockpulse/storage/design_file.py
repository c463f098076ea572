"""The design of a site file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rocking.sequence import ImpulseSequence
from rockpulse.errors import ResultsError
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.save_load import ASSESSMENT, load, named
from rockpulse.storage.site_variables import SITE_KIND

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["design_of", "load_design"]


def load_design(path: str | Path) -> DesignSpectrum | ImpulseSequence:
    """The design that ``rockpulse calibrate`` has stored.

    Parameters
    ----------
    path : str or Path
        A site file.

    Returns
    -------
    DesignSpectrum or ImpulseSequence
        The design spectrum, which has a sequence for every body; one sequence for all of them where the file was made
        by the method "response" or "statistics".

    Raises
    ------
    ResultsError
        For a file that is no results file of rockpulse, of another kind, or of too few earthquakes for a design.
    OSError
        Where the file cannot be opened.
    """
    tree = load(path)
    kind = tree.attrs.get("kind", ASSESSMENT)
    if kind != SITE_KIND:
        raise ResultsError(f"{path}: expected a site file of 'rockpulse calibrate', found {named(kind)}")
    return design_of(tree, str(path))


def design_of(tree: xr.DataTree, name: str = "site") -> DesignSpectrum | ImpulseSequence:
    """The design of a site in memory (:func:`rockpulse.calibrate_site`), as :func:`load_design` reads it from a file.

    `name` stands for the site in the message where there is no design.
    """
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        spectra = tree["spectra"].to_dataset()
        if np.isnan(spectra["spectrum_design"].values).any():
            raise ResultsError(f"{name}: no design: {str(site['remarks'].item()).splitlines()[0]}")
        return DesignSpectrum(
            spectra["p"].values,
            spectra["restitution"].values,
            spectra["spectrum_design"].values,
            spectra["ratio"].values,
            spectra["main_count"].values.astype(int),
        )
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    return ImpulseSequence(
        main=value["main"],
        secondary=min(value["ratio"] * value["main"], value["main"]),
        interval=value["interval"],
        duration=math.inf if math.isnan(value["duration"]) else value["duration"],
        main_count=None if math.isnan(value["main_count"]) else int(value["main_count"]),
        spacing=str(site.attrs["spacing"]),
    )
