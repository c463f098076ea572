"""Tables of free bodies, and the annual frequency of overturning of many bodies from one set of overturning spectra.

.. note:: The overturning spectrum S(p, C) of a record gives the probability that any slender free body overturns at any
   scale factor: P_r(x) at the level x of a measure is the probability at the scale factor x divided by the record's
   value. The fragility is the mean over records, with equal weight of earthquakes, without a fit; the frequency is the
   mean of the records' frequencies.
"""

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rockpulse.config.body_table import SITE, read_body_columns
from rockpulse.config.configuration import config_from_text
from rockpulse.earthquakes import lognormal_mean_half_width, mean_weights
from rockpulse.errors import ConfigError
from rockpulse.files import column_numbers
from rockpulse.record.measures import PGA
from rockpulse.storage.variables.risk import INVENTORY, RiskStatus
from rockpulse.studies.risk.free_bodies import BodyCurves, curves_in_parts, spectra_of, values_at
from rockpulse.studies.risk.frequency import hazard_conditions, several_events
from rockpulse.studies.risk.hazard import Hazard, SiteHazards
from rockpulse.studies.risk.integral import FEWEST_EVENTS

#: Required columns of a table, with their unit in the heading.
NEEDED = {"name": "", "width": " [m]", "height": " [m]"}
#: Keys of [[block]] that do not change the motion of a free body, and cells that state no value.
_NO_EFFECT = {"friction", "mass", "density", "length", "azimuth", "elastic_modulus", "kappa", "confirm_size"}
_NOT_GIVEN = ["", "0", "false", "no"]
#: Allowed ranges of coordinates [degrees].
DEGREES = {"longitude": (-180.0, 360.0), "latitude": (-90.0, 90.0)}


class Inventory(NamedTuple):
    """A table of free bodies, with the coordinates of their sites."""

    names: list[str]
    block: Block  #: (m,) bodies
    sites: np.ndarray | None  #: (m, 2) longitude and latitude [degrees]; None without these columns
    soil_factor: np.ndarray | None  #: (m,) factor on the levels of the hazard [-]; None without this column
    passed_over: tuple[str, ...]  #: names of columns that are not used


def read_inventory(path: str | Path) -> Inventory:
    """Read free rectangular bodies from a table; raise ConfigError if a column is missing or a value is invalid."""
    table, unused = read_body_columns(path)
    if missing := [f"{name}{unit}" for name, unit in NEEDED.items() if name not in table]:
        needed = ", ".join(f"{name}{unit}" for name, unit in NEEDED.items())
        raise ConfigError(f"{path}: expected the columns {needed}; missing: {', '.join(missing)}")
    names = table["name"].tolist()
    if not names or "" in names or len(set(names)) < len(names):
        raise ConfigError(f"{path}: expected a unique name for each body")
    others = [str(name) for name in table if name not in (*NEEDED, "restitution", *SITE)]
    for name in others:
        own = ~table[name].str.lower().isin(_NOT_GIVEN)
        if name not in _NO_EFFECT and own.any():
            raise ConfigError(
                f"{path}: {names[int(np.argmax(own))]}: {name}: the spectra cover free rectangular bodies only; use "
                "rockpulse assess and fragility for this body"
            )
    known = {name: column_numbers(str(path), table, name) for name in ("width", "height", *SITE) if name in table}
    for name, values in known.items():
        low, high = DEGREES.get(name, (0.0, np.inf))
        wrong = ~((low <= values) & (values <= high)) if name in DEGREES else values <= low
        if wrong.any():
            row = int(np.argmax(wrong))
            expected = f"degrees from {low:g} to {high:g}" if name in DEGREES else "a positive number"
            raise ConfigError(f"{path}: {names[row]}: {name}: expected {expected}, found {table[name].iloc[row]}")
    given = [name for name in DEGREES if name in known]
    if len(given) == 1:
        raise ConfigError(f"{path}: expected the columns longitude and latitude [degrees] or neither, found {given[0]}")
    sizes = {"width": known["width"], "height": known["height"]}
    block = _block(path, **sizes)
    if "restitution" in table:
        largest = np.asarray(block.restitution).astype(str)
        table["restitution"] = np.where(table["restitution"].isin(["", "housner"]), largest, table["restitution"])
        block = _block(path, **sizes, restitution=column_numbers(str(path), table, "restitution"))
    sites = np.stack([known[name] for name in DEGREES], axis=1) if given else None
    return Inventory(names, block, sites, known.get("soil_factor"), (*unused, *others))


def _block(path: str | Path, **sizes: Any) -> Block:
    try:
        return Block(**sizes, log=False)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None


def inventory_frequency(
    results: xr.DataTree, block: Block, hazard: Hazard | SiteHazards, years: float = 50.0, confidence: float = 0.9
) -> xr.Dataset:
    """Compute the annual frequency of overturning of many free bodies, from the overturning spectra of results.

    Parameters
    ----------
    results : xarray.DataTree
        Results of :func:`rockpulse.assess` with spectra at the p of these bodies (``[uncertainty] spectrum = "all"``).
    block : Block
        (m,) slender free-standing bodies.
    hazard : PowerLawHazard, HazardCurve or SiteHazards
        One hazard for all bodies, or one for each (:func:`rockpulse.load_site_hazards`), in "pga" or "pgv" of one
        component.
    years : float
        Exposure time for `probability` and `survival` [years].
    confidence : float
        Confidence level of the band over earthquakes.

    Returns
    -------
    xarray.Dataset
        Over (body): `frequency` [1/year] with `frequency_low` and `frequency_high` (if the frequencies of earthquakes
        are lognormal; NaN for fewer than four), `probability` and `survival` in `years`, `median` [unit of the measure
        in SI] at which the fragility is 1/2, `dispersion`, the standard deviation of ln(S/measure) over earthquakes and
        records [-], the shares of the frequency `below` and `above` the levels of the hazard, and `far`, from scale
        factors beyond ``[fragility] factors``; `hazard_distance` [m] from the site to the point of its hazard. NaN for
        a body that the spectra do not cover. In PGA, levels below g tan(alpha) contribute nothing.

    Raises
    ------
    ResultsError
        For results without spectra, or if a spectrum is missing at the p of the bodies.
    ConfigError
        For a hazard of another measure or number of bodies, or invalid years or confidence.

    Examples
    --------
    >>> many = rp.models.Block(width=np.linspace(0.5, 1.0, 100), height=np.full(100, 5.0))
    >>> found = rp.inventory_frequency(results, many, rp.PowerLawHazard(k0=1e-2, k=2.5))
    >>> [round(float(found["frequency"][body]), 5) for body in (0, -1)]  # 1/year; the wider body is safer
    [0.00113, 0.00017]
    """
    spectra, summary = spectra_of(results, hazard.measure)
    if not (math.isfinite(years) and years > 0.0) or not 0.0 < confidence < 1.0:
        raise ConfigError(
            f"years, confidence: expected a positive time and a share below 1, got {years!r}, {confidence!r}"
        )
    lanes = block.lanes()
    count = lanes.shape[0]
    if not isinstance(hazard, SiteHazards):
        hazard = SiteHazards((hazard,), np.zeros(count, int), np.full(count, np.nan))
    if hazard.of_body.size != count:
        raise ConfigError(f"hazard: expected one for each of {count} bodies, got {hazard.of_body.size}")
    config = config_from_text(str(results.attrs["configuration"]))
    events = mean_weights(summary["event"].values.astype(str))
    found = {name: np.full(count, np.nan) for name in INVENTORY}
    found |= {"status": np.full(count, RiskStatus.NOT_COVERED), "hazard_distance": hazard.distance}
    for places, curves in curves_in_parts(spectra, summary, lanes, hazard.measure):
        values = _of_bodies(curves, events, hazard.chosen(places), config.fragility.factors, confidence)
        for name, part in values.items():
            found[name][places] = part
    found["probability"] = -np.expm1(-found["frequency"] * years)
    found["survival"] = np.exp(-found["frequency"] * years)
    risk = xr.Dataset({name: variable.variable(found[name]) for name, variable in INVENTORY.items()})
    risk.attrs.update(
        hazard=hazard.words,
        hazard_conditions=hazard_conditions(hazard.warnings, config),
        fragility=f"the mean of each record's own P of overturning, without a fit: {events.shape[1]} records of "
        f"{several_events(events.shape[0])}, earthquakes equally weighted",
        measure=hazard.measure,
        unit=hazard.unit,
        unit_in_si=hazard.unit_in_si,
        covered_low=hazard.covered[0],
        covered_high=hazard.covered[1],
        factor_low=config.fragility.factors[0],
        factor_high=config.fragility.factors[1],
        events=events.shape[0],
        years=years,
        confidence=confidence,
    )
    return risk


def _of_bodies(
    curves: BodyCurves, events: np.ndarray, hazards: SiteHazards, factors: tuple[float, float], confidence: float
) -> dict[str, np.ndarray]:
    """Return the result variables of m bodies; `events` (k, r) are the weights of r records in k earthquakes."""
    # P is linear in ln x between two levels, so that its increase is multiplied by the mean of H between them.
    whole_above = hazards.integral_above(curves.at)
    slope = np.diff(curves.probability, axis=2) / curves.spacing
    rising = slope * -np.diff(whole_above, axis=2)
    # Increase of P above each stored level, up to 1 beyond the last one.
    last = (1.0 - curves.probability[:, :, -1:]) * np.exp(hazards.log_rate(curves.at[:, :, -1:]))
    tail = np.cumsum(np.concatenate([last, rising[:, :, ::-1]], axis=2), axis=2)[:, :, ::-1]

    def above(log_level: np.ndarray) -> np.ndarray:
        """Return the part (bodies, records) of the frequency from levels above `log_level`, given as ln."""
        bound = np.maximum(log_level, curves.floor[:, np.newaxis] if hazards.measure == PGA else -np.inf)
        inside = np.clip(bound, curves.at[:, :, 0], curves.at[:, :, -1])
        step, chance = curves.step_of(inside), curves.read_at(curves.probability, inside)
        part = values_at(slope, step) * (hazards.integral_above(inside) - values_at(whole_above, step + 1))
        found = chance * np.exp(hazards.log_rate(inside)) + part + values_at(tail, step + 1)
        top = np.exp(hazards.log_rate(np.maximum(bound, curves.at[:, :, -1])))
        return np.where(bound > curves.at[:, :, -1], top, found)

    weights = events.mean(axis=0)
    whole = above(np.full((1, 1), -np.inf))
    least, most = hazards.log_ends()
    near, far = (curves.own[np.newaxis] + math.log(factor) for factor in factors)
    of_events = whole @ events.T
    frequency = np.mean(of_events, axis=1)
    found = {
        "frequency": frequency,
        "below": 1.0 - above(least) @ weights / frequency,
        "above": above(most) @ weights / frequency,
        "far": 1.0 - (above(near) - above(far)) @ weights / frequency,
        "dispersion": curves.scatter(weights)[1],
        "median": np.exp(curves.medians(weights)),
        "status": np.full(frequency.size, RiskStatus.GIVEN),
    }
    if events.shape[0] >= FEWEST_EVENTS:
        half = lognormal_mean_half_width(of_events, confidence)
        found["frequency_low"], found["frequency_high"] = frequency * np.exp(-half), frequency * np.exp(half)
    return found
