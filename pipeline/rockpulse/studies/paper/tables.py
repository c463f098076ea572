"""The groups of a study as flat tables, one row a case."""

from __future__ import annotations

import pandas as pd
import xarray as xr

__all__ = ["study_tables"]


def study_tables(tree: xr.DataTree) -> dict[str, pd.DataFrame]:
    """Tables of a study by name, coordinates first.

    Figure 4: "figure4". Figure 5: "histories" (one row an instant), "half_cycles" (one row each), "intervals" (one row
    a case of the scan). Checks of codes: "code_check" (one row a channel and body), "rates". All: "statements".
    """
    tables = {"statements": _flat(tree["statements"].to_dataset())}
    tables |= {name: _flat(tree[name].to_dataset()) for name in ("code_check", "rates") if name in tree}
    if "figure4" in tree:
        tables["figure4"] = _flat(tree["figure4"].to_dataset())
    if "figure5" in tree:
        figure = tree["figure5"].to_dataset()
        tables["histories"] = _flat(_over(figure, "time"))
        half_cycles = _flat(_over(figure, "half_cycle"))
        tables["half_cycles"] = half_cycles[half_cycles["start_velocity"].notna()].reset_index(drop=True)
    if "intervals" in tree:
        scan = tree["intervals"].to_dataset()
        tables["intervals"] = _flat(_over(scan, "block"))
    return tables


def _over(dataset: xr.Dataset, dim: str) -> xr.Dataset:
    return dataset[[name for name, variable in dataset.data_vars.items() if dim in variable.dims]]


def _flat(dataset: xr.Dataset) -> pd.DataFrame:
    return dataset.to_dataframe().reset_index()
