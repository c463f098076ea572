"""The annual frequency of a limit state as text and as a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.storage.risk_variables import INVENTORY, RISK
from rockpulse.views.shared.table import Cell, Heading, Table, lines
from rockpulse.views.shared.terminal import ABSENT, figure, paragraph, ratio, several

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["inventory_overview", "inventory_table", "risk_overview", "risk_table"]

#: Bodies of an inventory that are shown.
SHOWN = 10

#: Shares of a frequency between which levels are told.
ENDS = (0.05, 0.95)


def risk_overview(risk: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.annual_frequency` as text."""
    years, confidence = float(risk.attrs["years"]), float(risk.attrs["confidence"])
    heads = (
        "",
        "a year",
        f"{confidence:.0%} interval",
        "once in",
        f"in {years:g} years",
        "interval",
        "stands",
        "levels",
    )
    rows = []
    for place, name in enumerate(risk["block"].values):
        one = risk.isel(block=place)
        rows.append(
            (
                Cell(f"  {name}"),
                Cell(_shown(float(one["frequency"]))),
                Cell(_between(one, "frequency", _shown)),
                Cell(_period(float(one["frequency"]))),
                Cell(_chance(float(one["probability"]))),
                Cell(_between(one, "probability", _chance)),
                Cell(_chance(float(one["survival"]))),
                Cell(_levels(one)),
            )
        )
    what, measure = str(risk.attrs["limit_state"]), str(risk.attrs["measure"])
    title = f"Frequency of {what}, {several(len(rows), 'body')}; hazard: {risk.attrs['hazard']}"
    told = [
        "a year: lambda, the sum of the fragility over the hazard; intervals: over the earthquakes of the fragility, "
        f"the hazard as given; stands: survives {years:g} years; levels: of {measure} in SI units, between which 90 % "
        "of lambda come about."
    ]
    told += [
        f"{name}: {words}." for name, words in zip(risk["block"].values, risk["statement"].values, strict=True) if words
    ]
    table = lines(Table("", "", tuple(map(Heading, heads)), tuple(rows)))
    return "\n".join([paragraph(title), *table, *(paragraph(line, "  ") for line in told)])


def risk_table(risk: xr.Dataset) -> pd.DataFrame:
    """A row for each body, without the contributions of levels."""
    names = [name for name, variable in RISK.items() if variable.dims == ("block",)]
    return risk[names].to_dataframe().reset_index()[["block", *names]]


def inventory_overview(risk: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.inventory_frequency` as text: the bodies that overturn most often, and all."""
    years = float(risk.attrs["years"])
    frequency = risk["frequency"].values
    known = np.isfinite(frequency)
    heads = ("", "a year", "interval", "once in", f"in {years:g} years", "median", "dispersion")
    rows = []
    for place in np.argsort(np.where(known, -frequency, np.inf), kind="stable")[: min(SHOWN, int(known.sum()))]:
        one = risk.isel(body=place)
        rows.append(
            (
                Cell(f"  {one['body'].item()}"),
                Cell(_shown(float(one["frequency"]))),
                Cell(_between(one, "frequency", _shown)),
                Cell(_period(float(one["frequency"]))),
                Cell(_chance(float(one["probability"]))),
                Cell(figure(float(one["median"]))),
                Cell(figure(float(one["dispersion"]))),
            )
        )
    title = f"Frequency of overturning, {several(frequency.size, 'body')}; hazard: {risk.attrs['hazard']}"
    told = [
        f"the {len(rows)} that overturn most often; all together {_shown(float(np.sum(frequency[known])))} a year, "
        f"{_shown(float(np.nansum(risk['probability'].values)))} expected in {years:g} years.",
        f"median: {risk.attrs['measure']} at which a body overturns with a probability of 50 %, in SI units; "
        "dispersion: of ln of the overturning spectrum over that measure.",
    ]
    if not known.all():
        lost = np.flatnonzero(~known)
        told.append(
            f"no number for {several(lost.size, 'body')}, which the spectra of the results do not stand for: "
            f"{', '.join(str(risk['body'].values[one]) for one in lost[:5])}{' ...' if lost.size > 5 else ''}."
        )
    table = lines(Table("", "", tuple(map(Heading, heads)), tuple(rows)))
    return "\n".join([paragraph(title), *table, *(paragraph(line, "  ") for line in told)])


def inventory_table(risk: xr.Dataset) -> pd.DataFrame:
    """A row for each body of an inventory."""
    return risk[[*INVENTORY]].to_dataframe().reset_index()


def _shown(value: float) -> str:
    return ABSENT if math.isnan(value) else f"{value:.2e}" if np.isfinite(value) else "inf"


def _chance(value: float) -> str:
    return ABSENT if math.isnan(value) else ratio(value)


def _period(frequency: float) -> str:
    return ABSENT if not 0.0 < frequency < math.inf else f"{float(f'{1.0 / frequency:.2g}'):,.0f} years"


def _between(one: xr.Dataset, name: str, shown: object) -> str:
    low, high = (float(one[f"{name}_{end}"]) for end in ("low", "high"))
    assert callable(shown)
    return ABSENT if math.isnan(low) else f"{shown(low)} to {shown(high)}"


def _levels(one: xr.Dataset) -> str:
    share = one["share"].values
    if np.isnan(share).any():
        return ABSENT
    edges = np.log(np.concatenate([one["bin_low"].values, one["bin_high"].values[-1:]]))
    low, high = np.exp(np.interp(ENDS, np.concatenate([[0.0], np.cumsum(share)]) / np.sum(share), edges)).tolist()
    return f"{figure(low)} to {figure(high)}"
