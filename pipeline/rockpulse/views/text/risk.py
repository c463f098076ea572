"""The annual frequency of a limit state as text and as tables to be written, and the warnings that belong to it."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from rockpulse.storage.variables.risk import INVENTORY, RISK, STANDING, RiskStatus
from rockpulse.studies.risk.frequency import OUTSIDE
from rockpulse.studies.risk.integral import LEAST_EVENTS
from rockpulse.views.shared.table import Cell, Heading, Table, lines
from rockpulse.views.shared.terminal import ABSENT, figure, paragraph, several

#: Bodies of an inventory that are shown.
SHOWN = 10

#: Shares of a frequency between which levels are told.
ENDS = (0.05, 0.95)

#: Where the levels or factors lie that nothing was looked at.
SIDES = ("below", "above", "far")

#: How a column shows a body.
Shown = Callable[["xr.Dataset"], str]


def risk_overview(risk: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.annual_frequency` as text."""
    years, confidence, measure = float(risk.attrs["years"]), float(risk.attrs["confidence"]), risk.attrs["measure"]
    columns: dict[str, Shown] = {
        "": lambda one: f"  {one['block'].item()}",
        "a year": _frequency,
        f"{confidence:.0%} interval": lambda one: _between(one, "frequency", _shown),
        "once in": _period,
        f"in {years:g} years": lambda one: _chance(float(one["probability"])),
        "interval": lambda one: _between(one, "probability", _chance),
        "stands": _survival,
        f"{measure} [{risk.attrs['unit']}]": lambda one: _levels(one, float(risk.attrs["unit_in_si"])),
    }
    rows = [risk.isel(block=place) for place in range(risk.sizes["block"])]
    title = f"Frequency of {risk.attrs['limit_state']}, {several(len(rows), 'body')}; hazard: {risk.attrs['hazard']}"
    told = [
        "a year: lambda, the sum of the fragility over the hazard; intervals: over the earthquakes of the fragility, "
        f"the hazard as given; stands: survives {years:g} years; {measure}: levels between which 90 % of lambda come "
        "about.",
        *_assumed(risk),
    ]
    told += [f"{one['block'].item()}: {one['statement'].item()}." for one in rows if one["statement"].item()]
    told += [f"! {words}." for words in risk_warnings(risk)]
    return _text(title, columns, rows, told)


def risk_warnings(risk: xr.Dataset) -> list[str]:
    """A sentence for each body whose frequency comes for more than a tenth from levels that nothing was looked at."""
    return [
        f"{name}: {words}" for name, words in zip(risk["block"].values, risk["warning"].values, strict=True) if words
    ]


def inventory_overview(risk: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.inventory_frequency` as text: the bodies that overturn most often, and all."""
    years, unit, measure = float(risk.attrs["years"]), str(risk.attrs["unit"]), str(risk.attrs["measure"])
    frequency = risk["frequency"].values
    known = np.isfinite(frequency)
    columns: dict[str, Shown] = {
        "": lambda one: f"  {one['body'].item()}",
        "a year": _frequency,
        f"{float(risk.attrs['confidence']):.0%} interval": lambda one: _between(one, "frequency", _shown),
        "once in": _period,
        f"in {years:g} years": lambda one: _chance(float(one["probability"])),
        "stands": _survival,
        f"median [{unit}]": lambda one: figure(float(one["median"]) / float(risk.attrs["unit_in_si"])),
        "dispersion": lambda one: figure(float(one["dispersion"])),
    }
    order = np.argsort(np.where(known, -frequency, np.inf), kind="stable")[: min(SHOWN, int(known.sum()))]
    rows = [risk.isel(body=place) for place in order]
    title = f"Frequency of overturning, {several(frequency.size, 'body')}; hazard: {risk.attrs['hazard']}"
    told = [
        f"the {len(rows)} that overturn most often; all together {_shown(float(np.sum(frequency[known])))} a year, "
        f"{_shown(float(np.nansum(risk['probability'].values)))} expected in {years:g} years.",
        f"intervals: over earthquakes, the hazard as given; median: {measure} at which a body overturns with a "
        "probability of 50 %; dispersion: of ln of the overturning spectrum over that measure.",
        *_assumed(risk),
    ]
    if int(risk.attrs["events"]) < LEAST_EVENTS:
        missing = np.isnan(risk["frequency_low"].values[known]).all()
        told.append(
            f"{'no interval' if missing else 'the intervals may be too narrow'}: "
            f"{several(int(risk.attrs['events']), 'earthquake')}, {4 if missing else LEAST_EVENTS} are needed."
        )
    if not known.all():
        lost = np.flatnonzero(~known)
        told.append(
            f"no number for {several(lost.size, 'body')}, which the spectra of the results do not stand for: "
            f"{', '.join(str(risk['body'].values[one]) for one in lost[:5])}{' ...' if lost.size > 5 else ''}."
        )
    told += [f"! {words}." for words in inventory_warnings(risk)]
    return _text(title, columns, rows, told)


def inventory_warnings(risk: xr.Dataset) -> list[str]:
    """A sentence for each way in which frequencies come for more than a tenth from levels that nothing tells of."""
    unit, one = str(risk.attrs["unit"]), float(risk.attrs["unit_in_si"])
    ends = {"below": float(risk.attrs["covered_low"]) / one, "above": float(risk.attrs["covered_high"]) / one}
    where = {
        side: f"levels {side} {end:.3g} {unit}, where the hazard curve ends"
        if math.isfinite(end)
        else f"levels {side} the end of the hazard curve of its site"
        for side, end in ends.items()
    } | {
        "far": f"records at factors outside {risk.attrs['factor_low']:g} to {risk.attrs['factor_high']:g}, at which "
        "they stand for no recorded ones",
    }
    told = []
    for name, words in where.items():
        count = int(np.sum(risk[name].values > OUTSIDE))
        if count:
            largest = f"{float(np.nanmax(risk[name].values)):.0%}"
            told.append(
                f"of {count} of {several(risk.sizes['body'], 'body')} more than a tenth of the frequency, up to "
                f"{largest}, comes from {words}"
            )
    return told


def standing_overview(standing: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.standing_test` as text: of an inventory the bodies that are least likely."""
    (dim,) = standing["chance"].dims
    age, confidence = float(standing.attrs["age"]), float(standing.attrs["confidence"])
    chance = standing["chance"].values
    columns: dict[str, Shown] = {
        "": lambda one: f"  {one[dim].item()}",
        "has stood": lambda one: figure(float(one["chance"])),
        "interval": lambda one: _between(one, "chance", figure),
        "factor on the hazard": lambda one: figure(float(one["factor"])),
        " ": lambda one: "contradicts this hazard" if int(one["contradicted"]) == 1 else "consistent",
    }
    order = np.argsort(chance, kind="stable")[: min(SHOWN, int(np.isfinite(chance).sum()))]
    rows = [standing.isel({dim: place}) for place in order]
    largest = _shown(float(np.max(standing["largest"].values, initial=0.0)))
    notes = [
        f"has stood: exp(-lambda {age:g}), the chance of it; factor: on the rates of the hazard, at which the chance "
        f"would be {1.0 - confidence:.0%} and lambda {largest} a year; a body whose factor is below 1 contradicts the "
        f"hazard at {confidence:.0%}."
    ]
    return _text(f"Bodies that have stood for {age:g} years", columns, rows, notes)


def _assumed(risk: xr.Dataset) -> list[str]:
    return [f"fragility: {risk.attrs['fragility']}.", f"hazard: {risk.attrs['hazard_assumed']}."]


def _text(title: str, columns: dict[str, Shown], rows: Sequence[xr.Dataset], told: list[str]) -> str:
    cells = tuple(tuple(Cell(show(one)) for show in columns.values()) for one in rows)
    table = lines(Table("", "", tuple(map(Heading, columns)), cells))
    return "\n".join([paragraph(title), *table, *(paragraph(line, "  ") for line in told)])


def _frequency(one: xr.Dataset) -> str:
    """The frequency, marked where more than a tenth of it comes from levels that nothing was looked at."""
    doubtful = bool(one["warning"].item()) if "warning" in one else any(float(one[side]) > OUTSIDE for side in SIDES)
    return f"{_shown(float(one['frequency']))}{'!' if doubtful else ''}"


def _shown(value: float) -> str:
    return ABSENT if math.isnan(value) else f"{value:.2e}"


def _chance(value: float) -> str:
    return ABSENT if math.isnan(value) else f"{value:.2g}"


def _survival(one: xr.Dataset) -> str:
    """A probability near one with as many decimals as show what is missing to one."""
    value = float(one["survival"])
    if math.isnan(value):
        return ABSENT
    missing = 1.0 - value
    places = 2 if missing >= 0.01 or missing == 0.0 else -math.floor(math.log10(missing))
    return f"{value:.{places}f}" if missing else "1"


def _period(one: xr.Dataset) -> str:
    frequency = float(one["frequency"])
    return f"{float(f'{1.0 / frequency:.2g}'):,.0f} years" if frequency > 0.0 else ABSENT


def _between(one: xr.Dataset, name: str, shown: Callable[[float], str]) -> str:
    low, high = (float(one[f"{name}_{end}"]) for end in ("low", "high"))
    return ABSENT if math.isnan(low) else f"{shown(low)} to {shown(high)}"


def _levels(one: xr.Dataset, unit: float) -> str:
    share = one["share"].values
    if np.isnan(share).any():
        return ABSENT
    edges = np.log(np.concatenate([one["bin_low"].values, one["bin_high"].values[-1:]]) / unit)
    low, high = np.exp(np.interp(ENDS, np.concatenate([[0.0], np.cumsum(share)]) / np.sum(share), edges)).tolist()
    return f"{figure(low)} to {figure(high)}"


def risk_table(risk: xr.Dataset, standing: xr.Dataset | None = None) -> pd.DataFrame:
    """A row for each body, without the contributions of levels."""
    names = [name for name, variable in RISK.items() if variable.dims == ("block",)]
    return _table(risk[names], "block", names, standing)


def levels_table(risk: xr.Dataset) -> pd.DataFrame:
    """A row for each body and range of levels, in the unit of the hazard, with its share of the frequency."""
    table = risk[["bin_low", "bin_high", "share"]].to_dataframe().reset_index()
    table[["bin_low", "bin_high"]] /= float(risk.attrs["unit_in_si"])
    return table.assign(measure=risk.attrs["measure"], unit=risk.attrs["unit"])[
        ["block", "measure", "unit", "bin_low", "bin_high", "share"]
    ]


def inventory_table(risk: xr.Dataset, standing: xr.Dataset | None = None) -> pd.DataFrame:
    """A row for each body of an inventory, the median in the unit of the hazard."""
    table = _table(risk[[*INVENTORY]], "body", [*INVENTORY], standing)
    return table.assign(median=table["median"] / float(risk.attrs["unit_in_si"]), unit=risk.attrs["unit"])


def _table(risk: xr.Dataset, dim: str, names: list[str], standing: xr.Dataset | None) -> pd.DataFrame:
    if standing is not None:
        risk, names = risk.merge(standing[[*STANDING]]), [*names, *STANDING]
    table = risk.to_dataframe().reset_index()[[dim, *names]]
    return table.assign(status=[RiskStatus(code).name.lower() for code in table["status"]])
