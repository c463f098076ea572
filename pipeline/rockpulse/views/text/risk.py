"""Annual frequencies of a limit state as text and as tables, with warnings."""

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pandas as pd
import xarray as xr

from rockpulse.record.measures import PGA
from rockpulse.storage.variables.risk import INVENTORY, RISK, STANDING, RiskStatus
from rockpulse.studies.risk.frequency import OUTSIDE
from rockpulse.studies.risk.integral import LEAST_EVENTS
from rockpulse.views.shared.formatting import ABSENT, paragraph, several, share, three_digits
from rockpulse.views.shared.table import Cell, lines
from rockpulse.views.shared.table_columns import Column, tabulated, titled

#: Number of bodies of an inventory that are shown.
MOST_BODIES = 10
#: Quantiles of a frequency between which the hazard levels are shown.
ENDS = (0.05, 0.95)
#: Kinds of levels or scale factors outside the range of the records.
SIDES = ("below", "above", "far")


def _shown(value: float, form: str) -> str:
    return ABSENT if math.isnan(value) else f"{value:{form}}"


_rate, _chance = partial(_shown, form=".2e"), partial(_shown, form=".2g")


def _survival(value: float) -> str:
    """Format a probability; a value below 1 has enough decimals not to be shown as 1."""
    if math.isnan(value):
        return ABSENT
    missing = 1.0 - value
    places = 2 if missing >= 0.01 or missing == 0.0 else -math.floor(math.log10(missing))
    return f"{value:.{places}f}" if missing else "1"


def _period(frequency: float) -> str:
    return f"{float(f'{1.0 / frequency:.2g}'):,.0f} years" if frequency > 0.0 else ABSENT


def _text(title: str, show: Callable[[float], str], name: str) -> Column:
    return titled(title, lambda value: Cell(show(value)), name)


def _interval(title: str, show: Callable[[float], str], name: str) -> Column:
    def interval_cell(low: float, high: float) -> Cell:
        return Cell(ABSENT if math.isnan(low) else f"{show(low)} to {show(high)}")

    return titled(title, interval_cell, f"{name}_low", f"{name}_high")


def _of_frequency(risk: xr.Dataset, dim: str, doubt: Callable[..., bool], *of: str) -> tuple[Column, ...]:
    """Return the columns common to all tables of frequencies; `doubt` decides which frequencies are marked."""
    years = f"in {float(risk.attrs['years']):g} years"
    return (
        titled("", lambda name: Cell(f"  {name}"), dim),
        titled("per year", lambda value, *why: Cell(f"{_rate(value)}{'!' if doubt(*why) else ''}"), "frequency", *of),
        _interval(f"{share(float(risk.attrs['confidence']))} interval", _rate, "frequency"),
        _text("return period", _period, "frequency"),
        _text(years, _chance, "probability"),
    )


def _curve(risk: xr.Dataset, dispersion: str) -> tuple[Column, Column]:
    """Return two columns: the median of the fragility curve, in the unit of the hazard curve, and its dispersion."""
    median = _text(f"median [{risk.attrs['unit']}]", lambda value: three_digits(value / _unit(risk)), "median")
    return median, _text(dispersion, three_digits, dispersion)


def risk_overview(risk: xr.Dataset) -> str:
    """Return the result of :func:`rockpulse.risk` as text."""
    years, measure = float(risk.attrs["years"]), risk.attrs["measure"]
    selected = (
        *_of_frequency(risk, "block", bool, "warning"),
        _interval("interval", _chance, "probability"),
        _text("survival", _survival, "survival"),
        *_curve(risk, "beta"),
        titled(f"{measure} [{risk.attrs['unit']}]", Cell, "levels"),
    )
    levels = [_levels(risk.isel(block=place)) for place in range(risk.sizes["block"])]
    notes = [
        "per year: annual frequency lambda, the fragility integrated over the hazard curve; intervals: over the "
        f"earthquakes of the fragility, with the hazard as given; survival: probability of surviving {years:g} years; "
        f"median, beta: of the fragility; {measure}: levels that contribute 90 % of lambda.",
        *_assumed(risk),
    ]
    named = zip(risk["block"].values, risk["statement"].values, strict=True)
    notes += [f"{name}: {statement}." for name, statement in named if statement]
    notes += [f"! {words}." for words in risk_warnings(risk)]
    title = f"Frequency of {risk.attrs['limit_state']}, {several(len(levels), 'body')}; hazard: {risk.attrs['hazard']}"
    return _table_text(title, selected, risk.assign(levels=("block", levels)), notes)


def _levels(one: xr.Dataset) -> str:
    """Return, as text, the range of hazard levels that contributes 90 % of the annual frequency of a body."""
    share = one["share"].values
    if np.isnan(share).any():
        return ABSENT
    edges = np.append(one["bin_low"].values, one["bin_high"].values[-1:]) / _unit(one)
    passed = np.append(0.0, np.cumsum(share)) / np.sum(share)
    low, high = np.exp(np.interp(ENDS, passed, np.log(edges))).tolist()
    return f"{three_digits(low)} to {three_digits(high)}"


def _unit(risk: xr.Dataset) -> float:
    return float(risk.attrs["unit_in_si"])


def risk_warnings(risk: xr.Dataset) -> list[str]:
    """Return the warnings on the frequencies, each with the name of its body."""
    named = zip(risk["block"].values, risk["warning"].values, strict=True)
    return [f"{name}: {words}" for name, words in named if words]


def inventory_overview(risk: xr.Dataset) -> str:
    """Return :func:`rockpulse.inventory_frequency` as text: bodies with the highest annual frequency, and totals."""
    years, measure = float(risk.attrs["years"]), str(risk.attrs["measure"])
    frequency = risk["frequency"].values
    known = np.isfinite(frequency)
    selected = (
        *_of_frequency(risk, "body", lambda *shares: any(one > OUTSIDE for one in shares), *SIDES),
        _text("survival", _survival, "survival"),
        *_curve(risk, "dispersion"),
    )
    order = np.argsort(np.where(known, -frequency, np.inf), kind="stable")[: min(MOST_BODIES, int(known.sum()))]
    notes = [
        f"the {order.size} bodies that overturn most often; expected number of bodies overturned: "
        f"{_rate(float(np.sum(frequency[known])))} per year, {_rate(float(np.nansum(risk['probability'].values)))} "
        f"expected in {years:g} years.",
        f"intervals: over earthquakes, with the hazard as given; median: {measure} at which a body overturns with a "
        "probability of 50 %; dispersion: of ln of the overturning spectrum over that measure.",
        *_assumed(risk),
    ]
    if int(risk.attrs["events"]) < LEAST_EVENTS:
        missing = np.isnan(risk["frequency_low"].values[known]).all()
        notes.append(
            f"{'no interval' if missing else 'the intervals may be too narrow'}: "
            f"{several(int(risk.attrs['events']), 'earthquake')}, but {4 if missing else LEAST_EVENTS} are needed."
        )
    if not known.all():
        lost = risk["body"].values[~known].tolist()
        notes.append(
            f"no frequency for {several(len(lost), 'body')}, which the spectra of the results do not cover: "
            f"{', '.join(map(str, lost[:5]))}{' ...' if len(lost) > 5 else ''}."
        )
    notes += [f"! {words}." for words in inventory_warnings(risk)]
    title = f"Frequency of overturning, {several(frequency.size, 'body')}; hazard: {risk.attrs['hazard']}"
    return _table_text(title, selected, risk.isel(body=order), notes)


def inventory_warnings(risk: xr.Dataset) -> list[str]:
    """Warn if a large part of a frequency comes from levels beyond the hazard curve or beyond the records."""
    where = {}
    for side, end in (("below", "low"), ("above", "high")):
        level = float(risk.attrs[f"covered_{end}"]) / _unit(risk)
        ends = f"{level:.3g} {risk.attrs['unit']}, where the hazard curve ends"
        where[side] = f"levels {side} {ends if math.isfinite(level) else 'the end of the hazard curve of its site'}"
    factors = f"{risk.attrs['factor_low']:g} to {risk.attrs['factor_high']:g}"
    where["far"] = f"records with scale factors outside {factors}, which represent no recorded motion"
    warnings = []
    for name, words in where.items():
        if count := int(np.sum(risk[name].values > OUTSIDE)):
            warnings.append(
                f"{count} of {several(risk.sizes['body'], 'body')}: more than a tenth of the frequency "
                f"(up to {share(float(np.nanmax(risk[name].values)))}) comes from {words}"
            )
    return warnings


def standing_overview(standing: xr.Dataset) -> str:
    """Return the result of :func:`rockpulse.standing_test` as text, with the bodies least likely to have survived."""
    (dim,) = standing["chance"].dims
    age, confidence = float(standing.attrs["age"]), float(standing.attrs["confidence"])
    chance = standing["chance"].values
    selected = (
        titled("", lambda name: Cell(f"  {name}"), str(dim)),
        _text("survival", three_digits, "chance"),
        _interval("interval", three_digits, "chance"),
        _text("factor on the hazard", three_digits, "factor"),
        titled(" ", lambda code: Cell("contradicts this hazard" if code == 1 else "consistent"), "contradicted"),
    )
    order = np.argsort(chance, kind="stable")[: min(MOST_BODIES, int(np.isfinite(chance).sum()))]
    largest = _rate(float(np.max(standing["largest"].values, initial=0.0)))
    note = (
        f"survival: its probability, exp(-lambda {age:g}); factor on the hazard: multiplier of the annual rates at "
        f"which survival would be {share(1.0 - confidence)} and lambda {largest} per year; a body with a factor "
        f"below 1 contradicts the hazard at a confidence of {share(confidence)}."
    )
    return _table_text(f"Bodies that have survived {age:g} years", selected, standing.isel({dim: order}), [note])


def _assumed(risk: xr.Dataset) -> list[str]:
    notes = [f"fragility: {risk.attrs['fragility']}.", f"hazard: {risk.attrs['hazard_conditions']}."]
    if risk.attrs["measure"] == PGA:
        return [*notes, "cut at uplift: a PGA below the uplift PGA of a body on the ground contributes nothing."]
    return [*notes, "not cut at uplift: only a hazard of PGA states which motions lift no body."]


def _table_text(title: str, selected: Sequence[Column], rows: xr.Dataset, notes: Sequence[str]) -> str:
    table = lines(tabulated("", "", selected, rows))
    return "\n".join([paragraph(title), *table, *(paragraph(line, "  ") for line in notes)])


def risk_table(risk: xr.Dataset, standing: xr.Dataset | None = None) -> pd.DataFrame:
    """Return a table with one row for each body, without the contributions of single hazard levels."""
    names = [name for name, variable in RISK.items() if variable.dims == ("block",)]
    return _table(risk[names], "block", names, standing)


def levels_table(risk: xr.Dataset) -> pd.DataFrame:
    """Return a table with the contribution of every range of hazard levels to the frequency of each body."""
    table = risk[["bin_low", "bin_high", "share"]].to_dataframe().reset_index()
    table[["bin_low", "bin_high"]] /= _unit(risk)
    table = table.assign(measure=risk.attrs["measure"], unit=risk.attrs["unit"])
    return table[["block", "measure", "unit", "bin_low", "bin_high", "share"]]


def inventory_table(risk: xr.Dataset, standing: xr.Dataset | None = None) -> pd.DataFrame:
    """Return a table with one row for each body of an inventory."""
    return _table(risk[[*INVENTORY]], "body", [*INVENTORY], standing)


def _table(risk: xr.Dataset, dim: str, names: list[str], standing: xr.Dataset | None) -> pd.DataFrame:
    if standing is not None:
        risk, names = risk.merge(standing[[*STANDING]]), [*names, *STANDING]
    table = risk.to_dataframe().reset_index()[[dim, *names]]
    status = [RiskStatus(code).name.lower() for code in table["status"]]
    return table.assign(status=status, median=table["median"] / _unit(risk), unit=risk.attrs["unit"])
