"""Tables of free bodies, and their fragility and annual frequency of overturning from spectra of records.

.. note:: A record with the value m of a measure is scaled by x/m to reach the level x, so its effective impulse on a
   body is S x/m, and the body overturns if that exceeds g tan(alpha)/p. With the mean and standard deviation of ln(S/m)
   over records, with equal weight of earthquakes, P(overturning | x) is the normal distribution of (ln x + mean - ln(g
   tan(alpha)/p))/deviation. The mean of the records' probabilities assumes no distribution: P_r(x) is the probability
   at the scale factor x/m, which the spectrum S(p, C) of a record gives for any slender free body. The annual frequency
   is the mean of the records' frequencies, with equal weight of earthquakes.
"""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
import xarray as xr
from scipy.special import ndtr

from rocking.body.block import Block
from rockpulse.config.body_table import SITE, read_body_columns
from rockpulse.config.configuration import config_from_text
from rockpulse.earthquakes import lognormal_mean_half_width, mean_weights
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.files import column_numbers
from rockpulse.record.measures import PGA, STORED_LEVELS
from rockpulse.sequences.design_spectrum import at_blocks, within
from rockpulse.storage.variables.risk import FREE_FRAGILITY, INVENTORY, RiskStatus
from rockpulse.studies.risk.frequency import hazard_conditions
from rockpulse.studies.risk.hazard import Hazard, SiteHazards
from rockpulse.studies.risk.integral import FEWEST_EVENTS
from rockpulse.warning_text import counted

#: Largest number of record-body pairs that are computed at once.
AT_ONCE = 30_000


class BodyCurves(NamedTuple):
    """Overturning probabilities of m bodies under r records at l levels of a measure; logarithms of SI values."""

    at: np.ndarray  #: (m, r, l) logarithms of the levels; the step is the same for all bodies and records
    probability: np.ndarray  #: (m, r, l) probability of overturning [-]
    log_s: np.ndarray  #: (m, r) logarithms of the overturning spectra
    own: np.ndarray  #: (r,) logarithms of the intensity measure of the unscaled records
    speed: np.ndarray  #: (m,) logarithms of g tan(alpha)/p
    floor: np.ndarray  #: (m,) logarithms of g tan(alpha), the acceleration that lifts a body

    @classmethod
    def read(cls, spectra: xr.Dataset, block: Block, own: np.ndarray) -> Self:
        """Return the curves; `own` are logarithms of the records' measures. ResultsError if C is not covered."""
        axes = spectra["p"].values, spectra["restitution"].values
        log_s = at_blocks(block, *axes, np.log(spectra["spectrum"].transpose("p", "restitution", "record").values))
        if np.any(np.isnan(log_s)):
            raise ResultsError(
                "results: the spectra have no values at the C of these bodies, because [uncertainty] restitution is "
                "not a range, or too narrow a range; assess again with a range such as [0.95, 1.05]"
            )
        stored = spectra["probability"].transpose("p", "restitution", "record", "level").values
        floor = np.log(block.gravity * np.tan(block.alpha_c))
        speed = floor - np.log(block.p)
        at = (speed[:, np.newaxis] - log_s + own)[:, :, np.newaxis] + np.log(spectra["level"].values)
        return cls(at, at_blocks(block, *axes, stored), log_s, own, speed, floor)

    @property
    def spacing(self) -> float:
        """Step between the logarithms of successive stored levels."""
        return float(self.at[0, 0, -1] - self.at[0, 0, 0]) / (self.at.shape[2] - 1)

    def step_of(self, log_level: np.ndarray) -> np.ndarray:
        """Return, for each body and record, the index of the interval between stored levels that contains a level.

        For a level outside all intervals, the index of the nearest interval is returned.
        """
        place = ((log_level - self.at[:, :, 0]) / self.spacing).astype(int)
        return np.clip(place, 0, self.at.shape[2] - 2)

    def read_at(self, values: np.ndarray, log_level: np.ndarray) -> np.ndarray:
        """Interpolate values (bodies, records, levels) at one level for each body and record."""
        step = self.step_of(log_level)
        share = np.clip((log_level - values_at(self.at, step)) / self.spacing, 0.0, 1.0)
        low = values_at(values, step)
        return np.asarray(low + share * (values_at(values, step + 1) - low))

    def scatter(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return, for each body, the mean and standard deviation over records of ln(level that overturns the body)."""
        ratio = self.log_s - self.own
        centre = ratio @ weights
        return self.speed - centre, np.sqrt((ratio - centre[:, np.newaxis]) ** 2 @ weights)

    def medians(self, weights: np.ndarray) -> np.ndarray:
        """Return, for each body, the logarithm of the level at which the weighted mean of the probabilities is 1/2."""
        low, high = self.at[:, :, 0].min(axis=1), self.at[:, :, -1].max(axis=1)
        for _ in range(48):
            middle = 0.5 * (low + high)
            reached = self.read_at(self.probability, middle[:, np.newaxis]) @ weights >= 0.5
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return np.asarray(0.5 * (low + high))


def values_at(values: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Return the elements (bodies, records) of `values` (bodies, records, levels) at the level indices `place`."""
    return np.take_along_axis(values, place[:, :, np.newaxis], axis=2)[:, :, 0]


def spectra_of(results: xr.DataTree, measure: str) -> tuple[xr.Dataset, xr.Dataset]:
    """Return /spectra, and the rows of /summary for its records; raise ConfigError if `measure` is not stored."""
    measured = [one.name for one in STORED_LEVELS]
    if measure not in measured:
        raise ConfigError(f"measure: expected one of {' or '.join(measured)}, found {measure}")
    if "spectra" not in results.children:
        raise ResultsError(
            'these results contain no overturning spectra; assess again with [uncertainty] spectrum = "all"'
        )
    spectra = results["spectra"].to_dataset()
    return spectra, results["summary"].to_dataset().sel(record=spectra["record"].values)


def curves_in_parts(
    spectra: xr.Dataset, summary: xr.Dataset, block: Block, measure: str
) -> Iterator[tuple[np.ndarray, BodyCurves]]:
    """Yield indices and curves of the bodies within the range of the spectra, in parts of limited size."""
    own = np.log(summary[measure].values.astype(float))
    covered = np.flatnonzero(within(block, spectra["p"].values, spectra["restitution"].values))
    for places in np.array_split(covered, max(1, math.ceil(covered.size * own.size / AT_ONCE))):
        if places.size:
            yield places, BodyCurves.read(spectra, block.take(places), own)


def free_body_fragility(results: xr.DataTree, block: Block, levels: Any, measure: str = PGA) -> xr.Dataset:
    """Compute the probability of overturning of free bodies at levels of an intensity measure.

    Parameters
    ----------
    results : xarray.DataTree
        Results of :func:`rockpulse.assess` with spectra at the p of these bodies (``[uncertainty] spectrum = "all"``).
    block : Block
        (m,) slender free-standing bodies.
    levels : (n,) array_like
        Levels of the measure, positive [m/s2 or m/s].
    measure : str
        "pga" or "pgv" of one component.

    Returns
    -------
    xarray.Dataset
        Over (body, level): `probability`, the mean over the records, and `lognormal`, the lognormal distribution with
        `median` and `dispersion`, which are over (body) and follow from S. In PGA `probability` and `lognormal` are 0
        below g tan(alpha). All are NaN for a body that the spectra do not cover.

    Raises
    ------
    ResultsError
        For results without spectra, or if a spectrum is missing at the p of the bodies.
    ConfigError
        For another measure, or levels that are not positive.

    Examples
    --------
    >>> found = rp.free_body_fragility(results, rp.models.Block(width=[1.0], height=[5.0]), [1.0, 3.0, 30.0])
    >>> found["probability"].values.round(2).tolist()
    [[0.0, 0.09, 0.71]]
    """
    at = np.atleast_1d(np.asarray(levels, dtype=float))
    spectra, summary = spectra_of(results, measure)
    if at.ndim != 1 or not np.all(np.isfinite(at) & (at > 0.0)):
        raise ConfigError(f"levels: expected positive numbers, got {levels!r:.80}")
    lanes = block if block.shape else block.lanes(1)
    weights = mean_weights(summary["event"].values.astype(str)).mean(axis=0)
    found = {
        name: np.full((lanes.shape[0], *([at.size] if "level" in one.dims else [])), np.nan)
        for name, one in FREE_FRAGILITY.items()
    }
    for places, curves in curves_in_parts(spectra, summary, lanes, measure):
        middle, deviation = curves.scatter(weights)
        moves = np.log(at) > curves.floor[:, np.newaxis] if measure == PGA else np.ones((places.size, at.size))
        over = (np.log(at) - middle[:, np.newaxis]) / deviation[:, np.newaxis]
        of_records = [curves.read_at(curves.probability, np.full((1, 1), one)) @ weights for one in np.log(at)]
        found["lognormal"][places] = moves * ndtr(over)
        found["probability"][places] = moves * np.stack(of_records, axis=1)
        found["median"][places], found["dispersion"][places] = np.exp(middle), deviation
    return xr.Dataset(
        {name: one.variable(found[name]) for name, one in FREE_FRAGILITY.items()}, {"level": at}, {"measure": measure}
    )


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
        raise ConfigError(f"{path}: expected a unique name for each body, found an empty or repeated one")
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
        records [-], the shares of the frequency `below` and `above` the levels of the hazard, and the share `far` from
        scale factors outside ``[fragility] factors``; `hazard_distance` [m] from the site to the point of its hazard.
        NaN for a body that the spectra do not cover. In PGA, levels below g tan(alpha) contribute nothing.

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
    [0.00117, 0.00017]
    """
    spectra, summary = spectra_of(results, hazard.measure)
    if not (math.isfinite(years) and years > 0.0) or not 0.0 < confidence < 1.0:
        raise ConfigError(
            f"years, confidence: expected a positive time and a confidence between 0 and 1, "
            f"got {years!r}, {confidence!r}"
        )
    lanes = block.lanes()
    count = lanes.shape[0]
    if not isinstance(hazard, SiteHazards):
        hazard = SiteHazards((hazard,), np.zeros(count, int), np.full(count, np.nan))
    if hazard.of_body.size != count:
        raise ConfigError(f"hazard: expected one hazard for each of {count} bodies, got {hazard.of_body.size}")
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
        f"{counted(events.shape[0], 'event')}, earthquakes equally weighted",
        measure=hazard.measure,
        unit=hazard.hazards[0].unit,
        unit_in_si=hazard.hazards[0].unit_in_si,
        **dict(zip(("covered_low", "covered_high"), hazard.covered, strict=True)),
        **dict(zip(("factor_low", "factor_high"), config.fragility.factors, strict=True)),
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
    whole_above = hazards.of_each("integral_above", curves.at)
    slope = np.diff(curves.probability, axis=2) / curves.spacing
    rising = slope * -np.diff(whole_above, axis=2)
    # Increase of P above each stored level, up to 1 beyond the last one.
    last = (1.0 - curves.probability[:, :, -1:]) * np.exp(hazards.of_each("log_rate", curves.at[:, :, -1:]))
    tail = np.cumsum(np.concatenate([last, rising[:, :, ::-1]], axis=2), axis=2)[:, :, ::-1]

    def above(log_level: np.ndarray) -> np.ndarray:
        """Return the part (bodies, records) of the frequency from levels above a level, given by its logarithm."""
        bound = np.maximum(log_level, curves.floor[:, np.newaxis] if hazards.measure == PGA else -np.inf)
        inside = np.clip(bound, curves.at[:, :, 0], curves.at[:, :, -1])
        step, chance = curves.step_of(inside), curves.read_at(curves.probability, inside)
        part = values_at(slope, step) * (hazards.of_each("integral_above", inside) - values_at(whole_above, step + 1))
        found = chance * np.exp(hazards.of_each("log_rate", inside)) + part + values_at(tail, step + 1)
        top = np.exp(hazards.of_each("log_rate", np.maximum(bound, curves.at[:, :, -1])))
        return np.where(bound > curves.at[:, :, -1], top, found)

    weights = events.mean(axis=0)
    whole = above(np.full((1, 1), -np.inf))
    with np.errstate(divide="ignore"):
        ends = np.log([hazards.hazards[number].covered for number in hazards.of_body.tolist()])
    least, most = ends[:, :1], ends[:, 1:]
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
