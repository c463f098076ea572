"""Annual frequency of a limit state at a site: the fragility integrated over the hazard, with bands.

.. note:: lambda = integral of P(x) (-dH/dx) dx; the shares from levels outside the range of the records or of the
   hazard are reported. In PGA, levels below the uplift PGA of a body on the ground contribute nothing. A body that
   overturns lambda times a year survives T years with the probability exp(-lambda T). If it has survived T years,
   frequencies above -ln(1 - q)/T are excluded at the confidence q; a hazard that gives such a frequency is too high.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from rockpulse.config.configuration import Config
from rockpulse.config.study_settings import OVERTURNING, UPLIFT
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.record.measures import PGA
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.risk import RISK, STANDING, RiskStatus
from rockpulse.studies.fragility.curves import missing
from rockpulse.studies.fragility.ensemble import stored_ensemble
from rockpulse.studies.fragility.likelihood import ABOVE, FAMILIES, NOT_ABOVE, Family, Observations
from rockpulse.studies.risk.hazard import Hazard, HazardCurve, PowerLawHazard
from rockpulse.studies.risk.integral import FEWEST_EVENTS, LEAST_EVENTS, Integral, band_of, fitted_lines, integrate
from rockpulse.warning_text import WarningText, counted

#: Horizontal component to which the hazard must refer, for each value of [records] components.
COMPONENTS = {
    "horizontal": "an arbitrary horizontal component, not the larger of two",
    "azimuth": "a single horizontal component in a given direction, not the larger of two",
    "strongest": "the horizontal component in the direction of the strongest motion, not an arbitrary one",
    "sweep": "an arbitrary horizontal component, not the larger of two",
}

#: Description of the data of a fragility analysis, for each value of [fragility] data.
DATA = {
    "stripes": "records scaled to levels (stripes)",
    "ida": (
        "the first level at which each record reaches the limit state (ida); a body may survive higher levels, so "
        "the frequency is not underestimated"
    ),
    "cloud": "records as they are, not scaled (cloud)",
}

#: Largest share of the frequency from levels outside the data without a warning.
OUTSIDE = 0.1
#: Number of bins of the contributions by level, and the share of the frequency that they cover.
BINS, HELD = 16, 0.998
#: A and B of a fragility F(A + B ln x) that is 1 at every level.
CERTAIN = (40.0, 1e-9)


def hazard_conditions(warnings: Iterable[str], config: Config) -> str:
    """Return, as text, the warnings on the hazard, and the ground and component to which it must refer."""
    wanted = f"must refer to the ground at the site, and to {COMPONENTS[config.records.components]}"
    return "; ".join([*warnings, wanted])


class _RiskOptions(NamedTuple):
    family: Family
    hazard: Hazard
    years: float
    confidence: float
    resamples: int
    seed: int
    uplift: bool


def fragility_frequency(
    fragility: xr.DataTree,
    hazard: Hazard,
    limit_state: str,
    years: float,
    confidence: float | None,
    resamples: int,
    seed: int,
) -> xr.Dataset:
    """Compute the annual frequency at which each body reaches a limit state; see :func:`rockpulse.risk`."""
    if not isinstance(hazard, PowerLawHazard | HazardCurve):
        raise ConfigError(
            f"hazard: expected the hazard of one site, a PowerLawHazard or a HazardCurve, got {hazard!r:.80}"
        )
    if fragility.attrs.get("kind") != FRAGILITY:
        kind = kind_in_words(str(fragility.attrs.get("kind", ASSESSMENT)))
        raise ResultsError(f"fragility: expected {kind_in_words(FRAGILITY)}, found {kind}")
    table = fragility["fragility"].to_dataset()
    states, measures = ([str(name) for name in table[dim].values] for dim in ("limit_state", "measure"))
    if limit_state not in states:
        raise ResultsError(f"limit state: expected one of {', '.join(states)}, got {limit_state!r}")
    if hazard.measure not in measures:
        raise ResultsError(
            f"measure: the hazard is given in {hazard.measure}, but the fragility in {', '.join(measures)}; add it "
            "to [fragility] measures"
        )
    level = float(fragility.attrs["confidence"]) if confidence is None else confidence
    if not (math.isfinite(years) and years > 0.0) or not 0.0 < level < 1.0 or resamples < 0:
        raise ConfigError(
            "years, confidence, resamples: expected a positive time, a confidence between 0 and 1 and a whole number, "
            f"got {years!r}, {level!r}, {resamples!r}"
        )
    ensemble = stored_ensemble(fragility)
    settings = ensemble.config.fragility
    of, alike = DATA[settings.data], "equally weighted"
    if settings.selection is not None:
        of, alike = "records chosen elsewhere", "weighted as given"
    shown = f"{counted(len(ensemble.ids), 'record')} of {counted(len(set(ensemble.clusters)), 'event')}"
    model = settings.overturning_model if limit_state == OVERTURNING else settings.model
    asked = _RiskOptions(FAMILIES[model], hazard, years, level, resamples, seed, limit_state == UPLIFT)
    place = states.index(limit_state), measures.index(hazard.measure)
    # Below its uplift PGA a body remains at rest; in another measure, or without a known uplift PGA, at no level.
    lifting = np.log(table["uplift_acceleration"].values) if hazard.measure == PGA else np.nan
    floors = np.broadcast_to(np.where(np.isnan(lifting), -math.inf, lifting), table.sizes["block"]).tolist()
    found = [_of_body(ensemble.observations(*place, [lane]), floor, asked) for lane, floor in enumerate(floors)]
    curve = table.sel(limit_state=limit_state, measure=hazard.measure)
    for row, median, beta in zip(found, curve["median"].values, curve["beta"].values, strict=True):
        row |= {"median": median, "beta": beta}
    columns = {name: one.variable(np.array([row[name] for row in found])) for name, one in RISK.items()}
    risk = xr.Dataset(columns, {"block": table["block"]})
    risk.attrs.update(
        hazard=hazard.words,
        hazard_conditions=hazard_conditions(hazard.warnings, ensemble.config),
        fragility=f"of {of}; {model}, {settings.equation} equation, {shown}, {alike}",
        measure=hazard.measure,
        unit=hazard.unit,
        unit_in_si=hazard.unit_in_si,
        limit_state=limit_state,
        years=years,
        confidence=level,
    )
    return risk


def _of_body(rows: Observations, floor: float, asked: _RiskOptions) -> dict[str, Any]:
    """Return the result variables of one body, which remains at rest at levels below exp(`floor`)."""
    nothing = np.full(BINS, np.nan)
    found: dict[str, Any] = dict.fromkeys(RISK, np.nan) | {"bin_low": nothing, "bin_high": nothing, "share": nothing}
    found |= {"events": len(rows.events), "status": RiskStatus.NO_CURVE, "statement": "", "warning": ""}
    lifted = math.exp(floor)
    against = (rows.kind == ABOVE) & (rows.level > lifted * (1.0 + 1e-9))
    against |= (rows.kind == NOT_ABOVE) & (rows.level < lifted)
    if asked.uplift and lifted > 0.0 and not np.any(against):
        with np.errstate(divide="ignore"):
            low, high = np.log(asked.hazard.covered).tolist()
        whole = integrate(asked.family, CERTAIN, asked.hazard, (low, high), floor)
        text = "every ground motion above the uplift PGA lifts the body, so that the frequency is exact and has no band"
        return found | _frequency(whole, low, high, asked) | {"statement": text}
    _, reason = missing(rows)
    if reason:
        return found | {"statement": f"{reason} ({asked.hazard.measure} in SI units)"}
    lines = fitted_lines(rows, asked.family)
    if not lines[0, 1] > 0.0:
        return found | {"statement": WarningText("not_increasing")}
    # range of levels common to the records and the hazard
    least = max(float(rows.level[0]), asked.hazard.covered[0])
    low, high = math.log(least), math.log(max(least, min(float(rows.level[-1]), asked.hazard.covered[1])))
    whole = integrate(asked.family, (lines[0, 0], lines[0, 1]), asked.hazard, (low, high), floor)
    if not math.isfinite(whole.frequency):
        return found | {
            "status": RiskStatus.NO_LIMIT,
            "statement": "no frequency: towards small levels the fragility decreases more slowly than the hazard "
            "increases; the frequency would depend on levels that were not analysed",
        }
    found |= _frequency(whole, low, high, asked)
    return found | (_band(rows, lines, whole, floor, asked) if asked.resamples else {})


def _frequency(whole: Integral, low: float, high: float, asked: _RiskOptions) -> dict[str, Any]:
    """Return a frequency and the values derived from it; the data cover the levels from exp(`low`) to exp(`high`)."""
    below, above = whole.between(-math.inf, low), whole.between(high, math.inf)
    return {
        "status": RiskStatus.GIVEN,
        "frequency": whole.frequency,
        "probability": -math.expm1(-whole.frequency * asked.years),
        "survival": math.exp(-whole.frequency * asked.years),
        "below": below,
        "above": above,
        "warning": _warning(below, above, low, high, asked.hazard),
        **_contributions(whole),
    }


def _warning(below: float, above: float, low: float, high: float, hazard: Hazard) -> str:
    """Return a warning if much of the frequency comes from levels outside the data; otherwise an empty text."""
    parts = []
    ends = zip((below, above), (low, high), ("below", "above"), hazard.covered, strict=True)
    for share, limit, side, end in ends:
        if share > OUTSIDE:
            curve = math.isclose(math.exp(limit), end)
            of = "where the hazard curve ends" if curve else "beyond which no record was analysed"
            shown = f"{math.exp(limit) / hazard.unit_in_si:.3g} {hazard.unit}"
            parts.append(f"{share:.0%} of its frequency comes from levels {side} {shown}, {of}")
    return "; ".join(parts)


def _band(rows: Observations, lines: np.ndarray, whole: Integral, floor: float, asked: _RiskOptions) -> dict[str, Any]:
    """Return the confidence limits of the frequency and of the probability, or the reason why they are missing."""
    events = len(rows.events)
    if events < FEWEST_EVENTS:
        return {"statement": f"no band: {counted(events, 'event')}, but {FEWEST_EVENTS} are needed"}
    asked_for = asked.confidence, asked.resamples, asked.seed, floor
    limits = band_of(rows, asked.family, asked.hazard, lines, math.log(whole.frequency), *asked_for)
    lost = f"{limits.lost:.0%} of the resamples give no curve, or no curve without one of their earthquakes"
    if math.isnan(limits.low):
        return {"statement": f"no band: {lost if limits.lost else 'without one of the earthquakes there is no curve'}"}
    reasons = []
    if events < LEAST_EVENTS:
        reasons.append(f"the band is too narrow: {counted(events, 'event')}, but {LEAST_EVENTS} are needed")
    if limits.lost:
        reasons.append(f"{lost}: they are left out of the band")
    found: dict[str, Any] = {"statement": "; ".join(reasons)}
    for end, value in (("low", limits.low), ("high", limits.high)):
        found |= {f"frequency_{end}": value, f"probability_{end}": -math.expm1(-value * asked.years)}
    return found


def _contributions(whole: Integral) -> dict[str, np.ndarray]:
    """Return bins of equal width in ln level that contain nearly all of the frequency, and the share of each."""
    summed = np.cumsum(whole.contribution) / np.sum(whole.contribution)
    low, high = np.interp([0.5 - 0.5 * HELD, 0.5 + 0.5 * HELD], summed, whole.log_level).tolist()
    edges = np.linspace(low, high, BINS + 1)
    share = np.diff(np.interp(edges, whole.log_level, summed))
    return {"bin_low": np.exp(edges[:-1]), "bin_high": np.exp(edges[1:]), "share": share}


def standing_test(risk: xr.Dataset, age: float, confidence: float = 0.95) -> xr.Dataset:
    """Test a hazard against bodies that have survived for a number of years.

    Parameters
    ----------
    risk : xarray.Dataset
        Result of :func:`rockpulse.risk` for overturning, or of :func:`rockpulse.inventory_frequency`.
    age : float
        Time that the bodies have survived [years].
    confidence : float
        Confidence level at which a frequency is excluded [-].

    Returns
    -------
    xarray.Dataset
        Over the bodies: survival probability `chance` = exp(-frequency age) with `chance_low` and `chance_high`,
        `largest`, the frequency with `chance` = 1 - confidence [1/year], the `factor` on the hazard that gives this
        frequency, and `contradicted`.

    Raises
    ------
    ConfigError
        For an invalid age or confidence.

    References
    ----------
    Brune, J. N. (1996), Bull. Seismol. Soc. Am. 86(1A), 43-54.

    Examples
    --------
    >>> import xarray as xr
    >>> risk = xr.Dataset({name: ("body", [1e-3]) for name in ("frequency", "frequency_low", "frequency_high")})
    >>> found = standing_test(risk, age=5000.0)  # exp(-5) = 0.0067; -ln(0.05)/5000 = 5.99e-4
    >>> [round(float(found[name].item()), 6) for name in ("chance", "largest", "factor", "contradicted")]
    [0.006738, 0.000599, 0.599146, 1.0]
    """
    if not (math.isfinite(age) and age > 0.0) or not 0.0 < confidence < 1.0:
        wrong = f"got {age!r}, {confidence!r}"
        raise ConfigError(f"age, confidence: expected a positive time and a confidence between 0 and 1, {wrong}")
    frequency, low, high = (risk[f"frequency{end}"].values for end in ("", "_low", "_high"))
    largest = np.full(frequency.shape, -math.log1p(-confidence) / age)
    values = {
        **{f"chance{end}": np.exp(-one * age) for end, one in (("", frequency), ("_low", high), ("_high", low))},
        "largest": largest,
        "factor": largest / frequency,
        "contradicted": np.where(np.isnan(frequency), -1, frequency > largest),
    }
    dims = tuple(map(str, risk["frequency"].dims))
    found = xr.Dataset({name: one.variable(values[name], dims) for name, one in STANDING.items()}, risk.coords)
    found.attrs.update(age=age, confidence=confidence)
    return found
