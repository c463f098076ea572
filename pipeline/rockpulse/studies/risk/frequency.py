"""How often bodies reach a limit state at a site: the fragility of a file summed over the hazard, with bands.

.. note:: lambda = integral of P(x) (-dH/dx) dx. The bands are those of the fragility's fit: records of one earthquake
   are no independent observations, so as many earthquakes are drawn again and again, and the distribution of (ln lambda
   - its estimate)/standard error, by the jackknife of each draw, is taken from that (bootstrap-t). The hazard is taken
   as known.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import logsumexp

from rockpulse.errors import ConfigError, ResultsError
from rockpulse.storage.fragility_variables import FRAGILITY, Status
from rockpulse.storage.risk_variables import RISK
from rockpulse.studies.fragility.curves import jackknife_error, standardised
from rockpulse.studies.fragility.ensemble import Ensemble, stored_ensemble
from rockpulse.studies.fragility.likelihood import FAMILIES, Family, maximise
from rockpulse.studies.fragility.observations import Observations
from rockpulse.studies.fragility.statements import missing
from rockpulse.studies.risk.hazard import Hazard
from rockpulse.studies.risk.integral import Integral, integrate

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LEAST_EVENTS", "OUTSIDE", "annual_frequency", "band_of", "fitted_lines"]

#: Fewest earthquakes from which a band covers what it says, and from which there is one.
LEAST_EVENTS, FEWEST_EVENTS = 14, 4

#: Share of a frequency that comes from levels that nothing was looked at, from which on that is told.
OUTSIDE = 0.1

#: Levels whose contributions are told, and the share of the frequency that they hold.
BINS, HELD = 16, 0.998

#: Largest share of the draws that may have no curve.
LOST = 0.1

#: Capacities over which the frequencies of the draws are summed, as arguments of the family's distribution.
STEP = 0.1
CAPACITY = np.arange(-60.0, 40.0, STEP)


def annual_frequency(
    fragility: xr.DataTree,
    hazard: Hazard,
    limit_state: str = "overturning",
    years: float = 50.0,
    confidence: float | None = None,
    resamples: int = 500,
    seed: int = 0,
) -> xr.Dataset:
    """How often each body reaches a limit state.

    Parameters
    ----------
    fragility : xarray.DataTree
        Of :func:`rockpulse.fragility_curves`, or a loaded file, with the measure of the hazard among its measures.
    hazard : PowerLawHazard or HazardCurve
        Annual rate of exceedance of that measure at the ground below the bodies.
    limit_state : str
        Of the fragility.
    years : float
        Time for which the probability is told [years].
    confidence : float, optional
        Of the bands; that of the fragility without.
    resamples : int
        Draws of the earthquakes for the bands; 0 for none.
    seed : int
        Of the draws.

    Returns
    -------
    xarray.Dataset
        Over (block): `frequency` [1/year] with `frequency_low` and `frequency_high`, `probability` in `years` with its
        limits, `survival` = exp(-frequency years), `below` and `above`, the shares of the frequency from levels that no
        record was looked at or the hazard was not given for, `events` and `statement`; over (block, bin) `bin_low`,
        `bin_high` [unit of the measure] and `share` of the frequency.

    Raises
    ------
    ResultsError
        For a tree that is no fragility, or without the limit state or the measure.
    ConfigError
        For years, a confidence or a number of draws that is none.

    References
    ----------
    Cornell, C. A. (1968), Bull. Seismol. Soc. Am. 58(5), 1583-1606; Efron, B., Tibshirani, R. (1993), An Introduction
    to the Bootstrap, chapter 12.

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> shake = [
    ...     rp.Record(3.0 * np.sin(2.0 * np.pi * f * t), dt=0.01, id=f"sine {f}", event=str(f), processed=True)
    ...     for f in (0.6, 0.8, 1.0, 1.3, 1.7)
    ... ]
    >>> config = rp.Config(fragility=rp.FragilitySettings(overturning_model="lognormal"))
    >>> pier = {"pier": rp.models.Block(half_width=0.5, half_height=1.9365)}
    >>> tree = rp.fragility_curves(shake, config, pier)
    >>> found = rp.annual_frequency(tree, rp.PowerLawHazard(k0=1e-4, k=2.5), years=100.0)
    >>> bool(0.0 < found["frequency"].item() < 1e-3), bool(found["survival"].item() > 0.9)
    (True, True)
    """
    import xarray as xr

    if fragility.attrs.get("kind") != FRAGILITY:
        raise ResultsError("fragility: expected the tree or file of rockpulse fragility; results of assess have none")
    table = fragility["fragility"].to_dataset()
    states, measures = ([str(name) for name in table[dim].values] for dim in ("limit_state", "measure"))
    if limit_state not in states:
        raise ResultsError(f"limit state: expected one of {', '.join(states)}, got {limit_state!r}")
    if hazard.measure not in measures:
        raise ResultsError(
            f"measure: the hazard is of {hazard.measure}, the fragility has {', '.join(measures)}; add it to "
            "[fragility] measures"
        )
    level = float(fragility.attrs["confidence"]) if confidence is None else confidence
    if not (math.isfinite(years) and years > 0.0) or not 0.0 < level < 1.0 or resamples < 0:
        raise ConfigError(
            "years, confidence, resamples: expected a positive time, a share between 0 and 1 and a number of draws, "
            f"got {years!r}, {level!r}, {resamples!r}"
        )
    ensemble = stored_ensemble(fragility)
    place = states.index(limit_state), measures.index(hazard.measure)
    settings = ensemble.config.fragility
    model = settings.overturning_model if limit_state == "overturning" else settings.model
    found = [
        _of_body(ensemble, place, lane, FAMILIES[model], hazard, years, level, resamples, seed, floor)
        for lane, floor in enumerate(_floors(table, hazard))
    ]
    values = {name: np.array([one[name] for one in found]) for name in found[0]}
    risk = xr.Dataset(
        {name: variable.variable(values[name]) for name, variable in RISK.items()}, {"block": table["block"]}
    )
    risk.attrs.update(
        hazard=hazard.words, measure=hazard.measure, limit_state=limit_state, years=years, confidence=level
    )
    return risk


def _of_body(
    ensemble: Ensemble,
    place: tuple[int, int],
    lane: int,
    family: Family,
    hazard: Hazard,
    years: float,
    confidence: float,
    resamples: int,
    seed: int,
    floor: float,
) -> dict[str, Any]:
    """The variables of one body."""
    nothing = np.full(BINS, np.nan)
    found: dict[str, Any] = dict.fromkeys(RISK, np.nan) | {"bin_low": nothing, "bin_high": nothing, "share": nothing}
    rows = ensemble.observations(*place, [lane])
    found["events"], found["statement"] = len(rows.events), ""
    status = missing(rows)
    if status != Status.FITTED:
        return found | {"statement": f"no fragility curve: {status.name.lower().replace('_', ' ')}"}
    lines = fitted_lines(rows, family)
    if not lines[0, 1] > 0.0:
        return found | {"statement": "no fragility curve: it does not rise"}
    low, high = _looked_at(rows, hazard)
    whole = integrate(family, lines[:1], hazard, (low, high), floor)
    if not np.isfinite(whole.frequency[0]):
        return found | {
            "frequency": np.inf,
            "statement": "no frequency: the fragility falls towards small levels less than the hazard rises; it would "
            "rest on levels that nothing was looked at",
        }
    found |= {"frequency": float(whole.frequency[0]), **_contributions(whole)}
    found["below"], found["above"] = whole.between(-math.inf, low), whole.between(high, math.inf)
    told = []
    for name, share in (("below", found["below"]), ("above", found["above"])):
        if share > OUTSIDE:
            limit = math.exp(low if name == "below" else high)
            told.append(f"{share:.0%} of it comes from levels {name} {limit:.3g}, where nothing was looked at")
    limits = None
    if resamples and len(rows.events) >= FEWEST_EVENTS:
        limits = band_of(rows, family, hazard, lines, math.log(whole.frequency[0]), confidence, resamples, seed, floor)
        told += [] if limits else ["no band: too many draws of the earthquakes make no curve"]
        if limits and len(rows.events) < LEAST_EVENTS:
            told.append(f"the band is too narrow: {several_events(len(rows.events))}, {LEAST_EVENTS} are needed")
    elif resamples:
        told.append(f"no band: {several_events(len(rows.events))}, {FEWEST_EVENTS} are needed")
    if limits:
        found["frequency_low"], found["frequency_high"] = limits
    for end in ("", "_low", "_high"):
        found[f"probability{end}"] = -math.expm1(-found[f"frequency{end}"] * years)
    found["survival"] = math.exp(-found["frequency"] * years)
    return found | {"statement": "; ".join(told)}


def _floors(table: xr.Dataset, hazard: Hazard) -> list[float]:
    """Logarithms of the levels below which no body moves, and so reaches no limit state; -inf where that is not known.

    Only a PGA tells: it lifts a body on the ground, or it does not.
    """
    if hazard.measure != "pga" or "uplift_acceleration" not in table:
        return [-math.inf] * table.sizes["block"]
    lifting = table["uplift_acceleration"].values
    return np.where(np.isnan(lifting), -math.inf, np.log(np.where(np.isnan(lifting), 1.0, lifting))).tolist()


def several_events(count: int) -> str:
    """The number of earthquakes in words."""
    return "1 earthquake" if count == 1 else f"{count} earthquakes"


def fitted_lines(rows: Observations, family: Family) -> np.ndarray:
    """A and B (1 + events, 2) in ln of the level of the fits to all rows, and without each earthquake."""
    events = len(rows.events)
    return _lines(rows, family, np.vstack([np.ones(events), 1.0 - np.eye(events)]))


def _lines(rows: Observations, family: Family, weights: np.ndarray) -> np.ndarray:
    """A and B (q, 2) in ln of the level of the fits to q weightings (q, events) of the earthquakes; NaN without."""
    u, centre, spread = standardised(np.log(rows.level))
    theta = maximise(family, np.stack([np.ones(u.size), u], axis=1), rows.kind, weights[:, rows.cluster] * rows.weight)
    return np.stack([theta[:, 0] - theta[:, 1] * centre / spread, theta[:, 1] / spread], axis=1)


def _looked_at(rows: Observations, hazard: Hazard) -> tuple[float, float]:
    """Logarithms of the levels between which records were looked at and the hazard was given."""
    least, most = hazard.covered
    low = max(float(rows.level[0]), least)
    return math.log(low), math.log(max(low, min(float(rows.level[-1]), most)))


def _frequencies(family: Family, lines: np.ndarray, hazard: Hazard, floor: float) -> np.ndarray:
    """ln of the frequencies of q fits, to about 1e-4; NaN where there is no rising curve.

    As the mean of the hazard over the capacities, none below the floor: lambda = integral of H(exp((z - A)/B)) f(z) dz.
    """
    found = np.full(lines.shape[0], np.nan)
    rising = np.flatnonzero(lines[:, 1] > 0.0)
    density = family.log_density(CAPACITY)[0] + math.log(STEP)
    for part in np.array_split(rising, max(1, rising.size // 500)):
        a, b = lines[part, :1], lines[part, 1:]
        found[part] = logsumexp(hazard.log_rate(np.maximum((CAPACITY - a) / b, floor)) + density, axis=1)
    return found


def band_of(
    rows: Observations,
    family: Family,
    hazard: Hazard,
    lines: np.ndarray,
    estimate: float,
    confidence: float,
    resamples: int,
    seed: int,
    floor: float = -math.inf,
) -> tuple[float, float] | None:
    """Limits of the frequency by the bootstrap-t over earthquakes; None where too few draws have a curve."""
    events = len(rows.events)
    left_out = _frequencies(family, lines, hazard, floor)
    error = jackknife_error(left_out[:, np.newaxis])[0]
    if not np.isfinite(error) or error == 0.0:
        return None
    counts = np.random.default_rng(seed).multinomial(events, np.full(events, 1.0 / events), size=resamples)
    # Each draw of as many earthquakes has a standard error of its own: without one of them after the other.
    fewer = np.maximum(counts[:, np.newaxis] - np.eye(events, dtype=int), 0)
    weights = np.concatenate([counts[:, np.newaxis], fewer], axis=1).reshape(-1, events)
    drawn = _frequencies(family, _lines(rows, family, weights), hazard, floor).reshape(resamples, -1)
    with np.errstate(invalid="ignore", divide="ignore"):
        moved = (drawn[:, 1:] - drawn[:, :1]) ** 2
        known = counts * np.isfinite(moved)
        mean = np.sum(np.where(known > 0, known * moved, 0.0), axis=1) / np.sum(known, axis=1)
        share = (drawn[:, 0] - estimate) / np.sqrt((events - 1) * mean)
    share = share[np.isfinite(share)]
    if share.size < (1.0 - LOST) * resamples:
        return None
    high, low = np.quantile(share, [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
    return math.exp(estimate - low * error), math.exp(estimate - high * error)


def _contributions(whole: Integral) -> dict[str, np.ndarray]:
    """Equal steps in the logarithm of the level with nearly all of a frequency, and the share of each."""
    summed = np.cumsum(whole.contribution) / np.sum(whole.contribution)
    low, high = np.interp([0.5 - 0.5 * HELD, 0.5 + 0.5 * HELD], summed, whole.log_level).tolist()
    edges = np.linspace(low, high, BINS + 1)
    share = np.diff(np.interp(edges, whole.log_level, summed))
    return {"bin_low": np.exp(edges[:-1]), "bin_high": np.exp(edges[1:]), "share": share}
