"""Fragility and annual frequency of any number of free bodies from one set of overturning spectra.

.. note:: The overturning spectrum S(p, C) of a record says with which probability any slender free body overturns under
   it at any factor: P_r(x) at the level x of a measure is that at the factor x over the record's own value. The mean
   over records, earthquakes alike, is the fragility of the body, without a fit, and the frequency is the mean of those
   that each record's P gives. The march is that of the records alone: ten thousand bodies are read from it like one.
"""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from rocking.block import Block
from rockpulse.calibration.design_spectrum import at_blocks, within
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.foreign_text import first_line
from rockpulse.input_file import read_text
from rockpulse.storage.risk_variables import INVENTORY
from rockpulse.studies.fragility.curves import jackknife_error
from rockpulse.studies.risk.hazard import Hazard

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MEASURED", "inventory_frequency", "read_inventory"]

#: Measures that every results file holds of its records.
MEASURED = ("pga", "pgv")

#: Bodies that are worked on at once.
AT_ONCE = 1000

#: Fewest earthquakes for a band.
FEWEST_EVENTS = 4


def inventory_frequency(
    results: xr.DataTree, block: Block, hazard: Hazard, years: float = 50.0, confidence: float = 0.9
) -> xr.Dataset:
    """How often each of many free bodies overturns, from the overturning spectra of a results file.

    Parameters
    ----------
    results : xarray.DataTree
        Of :func:`rockpulse.assess`, with the spectra at the p of these bodies (``[uncertainty] spectrum = "all"``).
    block : Block
        (m,) slender free-standing bodies.
    hazard : PowerLawHazard or HazardCurve
        Of "pga" or "pgv", of the kind that the records have: of one component as they were assessed.
    years : float
        Time for which the probability is told [years].
    confidence : float
        Of the band over earthquakes.

    Returns
    -------
    xarray.Dataset
        Over (body): `frequency` [1/year] with `frequency_low` and `frequency_high` (the jackknife over earthquakes in
        the logarithm, NaN below four), `probability` in `years`, `median` [unit of the measure] at which the fragility
        is 1/2, and `dispersion`, the standard deviation of ln(S/measure) over earthquakes and records [-]. NaN for a
        body that the spectra do not stand for.

    Raises
    ------
    ResultsError
        For results without spectra, or with gaps at the p of the bodies.
    ConfigError
        For a hazard of another measure, or years or a confidence that is none.

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> shake = [
    ...     rp.Record(3.0 * np.sin(2.0 * np.pi * f * t), dt=0.01, id=f"sine {f}", processed=True) for f in (0.7, 1.1)
    ... ]
    >>> config = rp.Config(uncertainty=rp.UncertaintySettings(spectrum="all"))
    >>> tree = rp.assess(shake, config, blocks={"pier": rp.models.Block(width=1.0, height=5.0)})
    >>> many = rp.models.Block(width=np.linspace(0.5, 1.0, 100), height=np.full(100, 5.0))
    >>> found = rp.inventory_frequency(tree, many, rp.PowerLawHazard(k0=1e-2, k=2.5))
    >>> bool(found["frequency"][-1] < found["frequency"][0])
    True
    """
    import xarray as xr

    if hazard.measure not in MEASURED:
        raise ConfigError(f"hazard: expected one of {' or '.join(MEASURED)}, which results hold, got {hazard.measure}")
    if not (math.isfinite(years) and years > 0.0) or not 0.0 < confidence < 1.0:
        raise ConfigError(f"years, confidence: expected a positive time and a share, got {years!r}, {confidence!r}")
    if "spectra" not in results.children:
        raise ResultsError("results: expected those of rockpulse assess with overturning spectra, found none")
    lanes = block if block.shape else block.lanes(1)
    spectra = results["spectra"].to_dataset()
    names = spectra["record"].values
    summary = results["summary"].to_dataset().sel(record=names)
    own = np.log(summary[hazard.measure].values.astype(float))
    weights = _weights([str(event) for event in summary["event"].values])
    axes = spectra["p"].values, spectra["restitution"].values
    covered = np.flatnonzero(within(lanes, *axes))
    found = {name: np.full(lanes.shape[0], np.nan) for name in INVENTORY}
    for places in np.array_split(covered, max(1, math.ceil(covered.size / AT_ONCE))):
        if places.size:
            part = _of_bodies(spectra, lanes.chosen(places), axes, own, weights, hazard, confidence)
            for name, values in part.items():
                found[name][places] = values
    found["probability"] = -np.expm1(-found["frequency"] * years)
    risk = xr.Dataset({name: variable.variable(found[name]) for name, variable in INVENTORY.items()})
    risk.attrs.update(hazard=hazard.words, measure=hazard.measure, years=years, confidence=confidence)
    return risk


def read_inventory(path: str | Path) -> tuple[list[str], Block]:
    """Free rectangular bodies from a CSV table with the columns name, width [m], height [m], perhaps restitution.

    Raises
    ------
    ConfigError
        For a file that is no such table, a name that is empty or twice, or numbers that are not positive.
    """
    where = Path(path)
    if not where.exists() or where.is_dir():
        raise ConfigError(f"{path}: expected a table of bodies, found no file")
    text = read_text(where, what="a table of bodies")
    try:
        table = pd.read_csv(io.StringIO(text), comment="#", skipinitialspace=True, dtype={"name": str})
    except ValueError as error:
        raise ConfigError(f"{path}: cannot be read as a table of bodies: {first_line(error)}") from None
    needed = ["name", "width [m]", "height [m]"]
    if missing := [name for name in needed if name not in table.columns]:
        raise ConfigError(f"{path}: expected the columns {', '.join(needed)}; no column {' and '.join(missing)}")
    names = table["name"].fillna("").tolist()
    if not names or "" in names or len(set(names)) < len(names):
        raise ConfigError(f"{path}: expected a name for each body, no two alike")
    columns = [*needed[1:], *(["restitution"] if "restitution" in table.columns else [])]
    values = table[columns].apply(pd.to_numeric, errors="coerce").to_numpy(dtype=float)
    wrong = ~(np.isfinite(values) & (values > 0.0)).all(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ConfigError(f"{path}: {names[row]}: expected positive numbers, found {table[columns].iloc[row].tolist()}")
    restitution = values[:, 2] if len(columns) > 2 else "housner"
    try:
        return names, Block(width=values[:, 0], height=values[:, 1], restitution=restitution, log=False)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None


def _of_bodies(
    spectra: xr.Dataset,
    block: Block,
    axes: tuple[np.ndarray, np.ndarray],
    own: np.ndarray,
    weights: np.ndarray,
    hazard: Hazard,
    confidence: float,
) -> dict[str, np.ndarray]:
    """The variables of (m,) bodies that the spectra stand for.

    `own` (r,) are logarithms of the records' measures, `weights` (k + 1, r) those of the records in the mean, and in
    the mean without each of k earthquakes.
    """
    level = np.log(spectra["level"].values)
    speed = np.log(block.gravity * np.tan(block.alpha_c) / block.p)
    log_s = at_blocks(block, *axes, np.log(spectra["spectrum"].transpose("p", "restitution", "record").values))
    if np.any(np.isnan(log_s)):
        raise ResultsError(
            'results: the spectra have gaps at the p of these bodies; assess again with [uncertainty] spectrum = "all"'
        )
    probability = at_blocks(
        block, *axes, spectra["probability"].transpose("p", "restitution", "record", "level").values
    )
    # ln of the measure at every stored level: (m, r, l).
    at = (speed[:, np.newaxis] - log_s + own)[:, :, np.newaxis] + level
    rate = hazard.log_rate(at)
    step = np.diff(rate, axis=2)
    # P is straight between two levels in the logarithm and so is ln H: its mean over them is the logarithmic mean.
    flat = np.abs(step) < 1e-12
    mean = np.exp(rate[:, :, :-1]) * np.where(flat, 1.0, np.expm1(step) / np.where(flat, 1.0, step))
    of_records = np.sum(np.diff(probability, axis=2) * mean, axis=2)
    of_records += probability[:, :, 0] * np.exp(rate[:, :, 0]) + (1.0 - probability[:, :, -1]) * np.exp(rate[:, :, -1])
    every = of_records @ weights.T
    found = {"frequency": every[:, 0]}
    ratio = log_s - own
    centre = ratio @ weights[0]
    found["dispersion"] = np.sqrt((ratio - centre[:, np.newaxis]) ** 2 @ weights[0])
    found["median"] = np.exp(_medians(at, probability, weights[0]))
    events = weights.shape[0] - 1
    if events >= FEWEST_EVENTS:
        error = jackknife_error(np.log(every).T)
        half = stdtrit(events - 1, 0.5 + 0.5 * confidence) * error
        found["frequency_low"], found["frequency_high"] = every[:, 0] * np.exp(-half), every[:, 0] * np.exp(half)
    return found


def _weights(events: list[str]) -> np.ndarray:
    """Weights (k + 1, r) of records in a mean in which earthquakes weigh alike, then without each of the k ones."""
    names, place, counts = np.unique(events, return_inverse=True, return_counts=True)
    kept = np.vstack([np.ones(names.size), 1.0 - np.eye(names.size)]) if names.size > 1 else np.ones((1, 1))
    return np.asarray((kept / kept.sum(axis=1, keepdims=True) / counts)[:, place])


def _medians(at: np.ndarray, probability: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """ln of the levels at which the mean over records of (m, r, l) probabilities at their levels is 1/2."""
    low, high = at[:, :, 0].min(axis=1), at[:, :, -1].max(axis=1)
    first, spacing = at[:, :, :1], (at[0, 0, -1] - at[0, 0, 0]) / (at.shape[2] - 1)
    for _ in range(60):
        middle = 0.5 * (low + high)
        place = np.clip((middle[:, np.newaxis, np.newaxis] - first) / spacing, 0.0, at.shape[2] - 1.0)
        below = np.minimum(place.astype(int), at.shape[2] - 2)
        ends = [np.take_along_axis(probability, below + more, axis=2)[:, :, 0] for more in (0, 1)]
        share = (place - below)[:, :, 0]
        reached = (ends[0] + share * (ends[1] - ends[0])) @ weights >= 0.5
        low, high = np.where(reached, low, middle), np.where(reached, middle, high)
    return 0.5 * (low + high)
