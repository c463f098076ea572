"""Annual frequencies as tables to be written: a row for each body, and a row for each range of levels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rockpulse.storage.variables.risk import INVENTORY, RISK, STANDING, RiskStatus

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["inventory_table", "levels_table", "risk_table"]


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
