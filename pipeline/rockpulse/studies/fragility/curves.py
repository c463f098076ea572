"""A fragility curve: its fit to observed capacities, and its confidence band over earthquakes (events).

.. note:: A curve is P(x) = F(a + b ln x): the median is exp(-a/b), the dispersion beta the standard deviation of ln
   capacity. Records of one event are not independent, so a band is computed by leaving out each event in turn
   (docs/decisions/012). If a number cannot be determined from the data, the text `statement` gives the reason.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rocking.arguments import ArrayLike
from rockpulse.earthquakes import FEWEST_EVENTS, jackknife_half_width
from rockpulse.errors import ConfigError
from rockpulse.storage.variables.fragility import Band, Extrapolated, Status
from rockpulse.studies.fragility.likelihood import (
    ABOVE,
    EXACT,
    FAMILIES,
    NOT_ABOVE,
    Family,
    Observations,
    has_maximum,
    maximise,
)
from rockpulse.warning_text import WarningText, as_stored, counted

#: Capacities with a smaller relative difference count as equal, levels are written as one number.
EQUAL, SAME_LEVEL = 1e-9, 1e-3


def missing(rows: Observations) -> tuple[Status, WarningText | None]:
    """Return FITTED if a curve can be fitted to the data, otherwise the status and the text that state why not."""
    level, kind, count = rows.level, rows.kind, rows.records
    reached, records = kind != ABOVE, counted(count, "record")
    if level.size == 0:
        return Status.NO_RECORD, WarningText("no_record")
    low, high = float(level[0]), float(level[-1])
    if count == 1:
        code = "one_record_reached" if np.any(reached) else "one_record_not_reached"
        return Status.ONE_RECORD, WarningText(code, levels=_range(level))
    if not np.any(reached):
        if math.isclose(low, high, rel_tol=SAME_LEVEL):
            return Status.NOTHING_REACHED, WarningText("nothing_reached", records=records, level=low)
        return Status.NOTHING_REACHED, WarningText("nothing_reached_between", records=records, low=low, high=high)
    if np.all(kind == NOT_ABOVE):
        return Status.EVERYTHING_REACHED, WarningText("everything_reached", records=records, level=low)
    if np.unique(rows.record[reached]).size == 1:  # a record may have several rows
        return Status.ONE_REACHED, WarningText("one_reached", levels=_range(level[reached]), records=count)
    known, above, below = (level[kind == one] for one in (EXACT, ABOVE, NOT_ABOVE))
    if known.size and np.ptp(known) <= EQUAL * known[0] and np.all(above <= known[-1]) and np.all(below >= known[0]):
        return Status.STEP, WarningText("step", level=float(known[0]))
    if has_maximum(level, kind, np.ones((1, level.size)))[0]:
        return Status.FITTED, None
    if low == high:
        return Status.SEPARATED, WarningText("one_level", level=low)
    last, first = float(above[-1]), float(below[0])
    if last == first:
        return Status.SEPARATED, WarningText("separated_at", level=first)
    return Status.SEPARATED, (
        WarningText("separated", low=last, high=first) if last < first else WarningText("not_stronger")
    )


def _range(levels: np.ndarray) -> str:
    low, high = float(levels[0]), float(levels[-1])
    close = math.isclose(low, high, rel_tol=SAME_LEVEL)
    return f"{low:.3g}" if close else WarningText("interval", low=low, high=high)


def band_of(rows: Observations, slopes: np.ndarray) -> tuple[Band, list[WarningText]]:
    """Return the status of the band, and why there is none; `slopes` are b of all events, then without each event."""
    events = len(rows.events)
    if events < FEWEST_EVENTS:
        few = WarningText("band_few_events", events=counted(events, "event"), needed=FEWEST_EVENTS)
        return (Band.ONE_EVENT if events == 1 else Band.FEW_EVENTS), [few]
    alone = [str(name) for name, b in zip(rows.events, slopes[1:], strict=True) if not b > 0.0]
    return (Band.RESTS_ON_ONE_EVENT, [WarningText("band_one_event", event=alone[0])]) if alone else (Band.GIVEN, [])


def extrapolated(median: float, rows: Observations) -> tuple[Extrapolated, list[WarningText]]:
    """Return whether the median of a curve is above or below all observed levels, with a warning if it is."""
    low, high = float(rows.level[0]), float(rows.level[-1])
    if low <= median <= high:
        return Extrapolated.NO, []
    side, level = (Extrapolated.ABOVE, high) if median > high else (Extrapolated.BELOW, low)
    reached = counted(np.unique(rows.record[rows.kind != ABOVE]).size, "record")
    values = {"median": float(median), "level": level, "reached": reached, "records": rows.records}
    return side, [WarningText(f"median_{side.name.lower()}", **values)]


@dataclass(frozen=True, eq=False)
class Curve:
    """A fragility curve, or the reason why it cannot be fitted; values that the data do not determine are NaN."""

    status: Status  # whether there is a curve, or why not
    band: Band  # whether there is a band, or why not
    extrapolated: Extrapolated  # whether the median is outside the range of levels
    statement: str  # status, band and extrapolation in words; empty if there is nothing to report
    statement_values: str  # the statement as codes and values, for storage
    records: int
    events: int
    observations: int  # number of observations
    reached: int  # number of observations that reached the limit state
    median: float  # measure at which the limit state is reached with probability 1/2, in the unit of the measure
    beta: float  # standard deviation of ln capacity [-]; 0 for equal capacities
    median_low: float  # confidence limits
    median_high: float
    beta_low: float
    beta_high: float
    confidence: float  # confidence level of the limits [-]
    _family: Family
    _theta: np.ndarray
    _centre: float
    _spread: float

    def probability(self, levels: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the probability and the limits of its confidence band [-] at levels (k,); NaN if unknown."""
        levels = np.asarray(levels, dtype=float)
        if self.status == Status.STEP:
            nothing = np.full(levels.shape, np.nan)
            return np.where(levels >= self.median, 1.0, 0.0), nothing, nothing
        u = (np.log(levels) - self._centre) / self._spread
        eta = self._theta[:, :1] + self._theta[:, 1:2] * u
        half = jackknife_half_width(eta, self.confidence) if self.band == Band.GIVEN else np.nan
        return self._family.cdf(eta[0]), self._family.cdf(eta[0] - half), self._family.cdf(eta[0] + half)

    @cached_property
    def log_beta(self) -> np.ndarray:
        """Logarithms (1 + events,) of beta: first from all observations, then with each event left out in turn."""
        with np.errstate(invalid="ignore"):  # a curve fitted without an event may decrease
            return np.asarray(np.log(self._family.deviation * self._spread / self._theta[:, 1]))


def fit_capacities(
    capacities: ArrayLike,
    clusters: ArrayLike | None = None,
    limits: ArrayLike | None = None,
    records: ArrayLike | None = None,
    model: str = "lognormal",
    confidence: float = 0.9,
) -> Curve:
    """Fit a fragility curve to the capacities from an incremental dynamic analysis, which may be truncated.

    Parameters
    ----------
    capacities : (n,) array_like
        Smallest value of the measure at which the limit state is reached; inf if it was not reached.
    clusters, records : (n,) sequence, optional
        Labels of event and record; by default each row is a different event and record.
    limits : (n,) array_like, optional
        Largest value of the measure that was analysed; required if a capacity is inf.
    model : {"lognormal", "logistic"}
        Distribution of ln capacity: normal or logistic.
    confidence : float
        Confidence level of the bands, between 0 and 1 [-].

    Returns
    -------
    Curve

    Raises
    ------
    ConfigError
        For capacities or limits that are not positive, or invalid options.

    References
    ----------
    Baker, J. W. (2015), Earthq. Spectra 31(1), 579-599, doi:10.1193/021113EQS025M.

    Examples
    --------
    >>> curve = fit_capacities([0.5, 1.0, 2.0])
    >>> round(curve.median, 6), round(curve.beta, 6)          # exp of the mean, standard deviation of the logarithms
    (1.0, 0.565952)
    >>> fit_capacities([np.inf, np.inf], limits=[2.0, 3.0]).statement
    'no curve: none of 2 records reached the limit state, although their highest levels are 2 to 3'
    """
    capacities = np.asarray(capacities, dtype=float)
    open_ended = np.isposinf(capacities)
    if limits is None and np.any(open_ended):
        raise ConfigError("fragility: infinite capacities require limits, the largest values that were analysed")
    levels = np.where(open_ended, capacities if limits is None else np.asarray(limits, dtype=float), capacities)
    rows = Observations.of(levels, np.where(open_ended, ABOVE, EXACT), clusters, records)
    return fit_curve(rows, model, confidence)


def fit_stripes(
    measure: ArrayLike,
    exceeded: ArrayLike,
    clusters: ArrayLike | None = None,
    records: ArrayLike | None = None,
    model: str = "lognormal",
    confidence: float = 0.9,
) -> Curve:
    """Fit a fragility curve to records that did or did not reach a limit state: stripes, or unscaled records.

    Parameters
    ----------
    measure : (n,) array_like
        Value of the measure of each record, positive.
    exceeded : (n,) array_like of bool
        Whether the limit state was reached.
    clusters, records, model, confidence
        As in :func:`fit_capacities`; a record scaled to several levels has several rows.

    Returns
    -------
    Curve
        The curve of maximum binomial likelihood: probit or logit in the logarithm of the measure.

    Raises
    ------
    ConfigError
        As in :func:`fit_capacities`.

    Examples
    --------
    >>> measure, exceeded = np.repeat([0.5, 1.0, 2.0], 4), [0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1]
    >>> round(fit_stripes(measure, exceeded).median, 6)
    1.0
    """
    rows = Observations.of(measure, np.where(np.asarray(exceeded, dtype=bool), NOT_ABOVE, ABOVE), clusters, records)
    return fit_curve(rows, model, confidence)


def fit_curve(rows: Observations, model: str = "lognormal", confidence: float = 0.9) -> Curve:
    """Fit a fragility curve to observations of any kind; options and errors as in :func:`fit_capacities`.

    Bands of eta = a + b ln x, of ln median and of ln beta are the estimate plus or minus t s. t is a quantile of
    Student's t with K - 1 degrees of freedom, and s the jackknife error over K events, s^2 = (K - 1)/K sum (estimate
    without event k - estimate)^2 (MacKinnon, Nielsen & Webb 2023, arXiv:2301.04527).
    """
    if model not in FAMILIES:
        raise ConfigError(f"fragility: model: expected one of {', '.join(FAMILIES)}, got {model!r}")
    if not 0.0 < confidence < 1.0:
        raise ConfigError(f"fragility: confidence: expected a probability between 0 and 1, got {confidence!r}")
    family, events = FAMILIES[model], len(rows.events)
    (status, reason), theta = missing(rows), np.full((1 + events, 2), np.nan)
    centre, spread = 0.0, 1.0
    if status == Status.FITTED:
        u, centre, spread = standardised(np.log(rows.level))
        theta = maximise(family, np.stack([np.ones(u.size), u], axis=1), rows.kind, rows.without_each_event())
        if not np.isfinite(theta[0, 1]):
            status, reason = Status.NO_MAXIMUM, WarningText("no_maximum")
        elif theta[0, 1] <= 0.0:
            status, reason = Status.NOT_INCREASING, WarningText("not_increasing")
    band, side, warnings = Band.NO_CURVE, Extrapolated.NO, [reason] if reason else []
    if warnings:
        theta[:] = np.nan
    else:
        band, warnings = band_of(rows, theta[:, 1])
    a, b = theta.T
    with np.errstate(invalid="ignore"):
        estimates = np.stack([centre - a / b * spread, np.log(family.deviation * spread / b)], axis=1)
    half = jackknife_half_width(estimates, confidence) if band == Band.GIVEN else np.full(2, np.nan)
    with np.errstate(over="ignore"):  # a limit above the largest float is inf
        median, low, high = (np.exp(values) for values in (estimates[0], estimates[0] - half, estimates[0] + half))
    if status == Status.STEP:
        median = np.array([rows.level[rows.kind == EXACT][0], 0.0])
    if status == Status.FITTED:
        side, beyond = extrapolated(median[0], rows)
        warnings += beyond
    return Curve(
        status=status,
        band=band,
        extrapolated=side,
        statement="; ".join(warnings),
        statement_values=as_stored(warnings) if warnings else "",
        records=rows.records,
        events=events,
        observations=rows.level.size,
        reached=int(np.count_nonzero(rows.kind != ABOVE)),
        median=float(median[0]),
        beta=float(median[1]),
        median_low=float(low[0]),
        median_high=float(high[0]),
        beta_low=float(low[1]),
        beta_high=float(high[1]),
        confidence=confidence,
        _family=family,
        _theta=theta,
        _centre=centre,
        _spread=spread,
    )


def standardised(values: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Return values (n,) scaled to mean zero and standard deviation one, with their original mean and deviation."""
    centre, spread = float(np.mean(values)), float(np.std(values))
    return (values - centre) / spread, centre, spread
