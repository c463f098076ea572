"""Important changes between two assessments: changed verdicts, ratios that crossed 1, and changed safety margins."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, fullest_model
from rockpulse.views.diff.row_matching import Matched
from rockpulse.views.shared.formatting import ratio
from rockpulse.views.shared.table_columns import margin_cells
from rockpulse.views.shared.verdict_table import factor_heading

#: Variables that describe the margin of a body.
MARGIN = (
    *("outcome", "safety_factor", "factor_resolved", "safe_up_to", "capacity_ratio"),
    *("overturning_probability", "factor_10", "factor_10_low"),
)


class Flip(NamedTuple):
    """A changed verdict, or a ratio that crossed 1; ``place`` contains the names of record, body, model and demand."""

    place: tuple[str, ...]
    before: str
    after: str


@dataclass
class Changes:
    """The changes of one variable: their number in all models and in the most complete model, and the first changes."""

    listed: int = 0
    compared: int = 0
    count: int = 0
    compared_by_model: int = 0
    count_by_model: int = 0
    _first: list[Flip] = field(default_factory=list)
    _others: list[Flip] = field(default_factory=list)

    @property
    def named(self) -> list[Flip]:
        """Return the first `listed` changes; changes in the most complete model come first."""
        return [*self._first, *self._others][: self.listed]

    def add(self, places: np.ndarray, leading: np.ndarray, named: Callable[[int], Flip]) -> None:
        """Add changes at indices `places`; `leading` is True for changes in the most complete model."""
        self.count += places.size
        self.count_by_model += int(leading.sum())
        for kept, some in ((self._first, places[leading]), (self._others, places[~leading])):
            kept.extend(named(int(at)) for at in some[: self.listed - len(kept)])


def leading_model(one: xr.Dataset, other: xr.Dataset) -> str:
    """Return the most complete model that both assessments contain; empty if they have no model in common."""
    if "model" not in one.coords or "model" not in other.coords:
        return ""
    common = one.sel(model=np.isin(one["model"].values, other["model"].values))
    return fullest_model(common) if common.sizes["model"] else ""


def body_changes(
    one: xr.Dataset, other: xr.Dataset, named: Mapping[str, Matched], model: str, ignore: Sequence[str] = ()
) -> list[str]:
    """Return a line for each body whose safety margin changed, computed from the records that both files contain."""
    records, blocks = named["record"], named["block"]
    size = records.first.size
    if not size or not blocks.first.size:
        return []
    names = [name for name in MARGIN if name in one and name in other and not {name, f"/summary/{name}"} & set(ignore)]
    ignored = [name for name in MARGIN if name not in ("outcome", "capacity_ratio", *names)]
    sides = []
    for dataset, side in ((one, "first"), (other, "second")):
        needed = {"outcome", "event", "npts", "restitution", *names, *ignored}
        if "capacity_ratio" in names:
            needed |= {str(name) for name in dataset.variables if dataset[name].dims == ("demand",)}
            needed |= {"demand_factor", "demand_probability"}
        part = dataset[sorted(needed)].isel(model=[dataset["model"].values.tolist().index(model)]).load()
        part = part.assign({name: xr.full_like(part[name], np.nan, dtype=float) for name in ignored})
        sides.append(_described_margins(part.isel(record=getattr(records, side), block=getattr(blocks, side)), names))
    before, after = sides
    every = size == one.sizes["record"] == other.sizes["record"]
    of = f" of {size} records" if every else f" of the {size} records in both"
    lines = []
    for place in range(blocks.first.size):
        pairs = {what: (cells[place], after[what][place]) for what, cells in before.items() if what in after}
        if any(old != new for old, new in pairs.values()):
            changes = [f"{what} {old}" + (f" -> {new}" if new != old else "") for what, (old, new) in pairs.items()]
            lines.append(f"{blocks.names(place)[0]}: {', '.join(changes)}{of}")
    return lines


def _described_margins(summary: xr.Dataset, names: list[str]) -> dict[str, list[str]]:
    """Return P, smallest scale factor and smallest capacity/demand of each body as texts, by quantity."""
    answers = Answers(summary)

    def probability(values: np.ndarray, *left_out: np.ndarray) -> list[str]:
        shares = [share.value for share in answers.motions.shares(values, *left_out)]
        return [ratio(value) for value in answers.by_block(np.fmax, np.array([shares]))[0]]

    def smallest(demand: str | None = None) -> list[str]:
        return [margin_cells(margin)[0].marked for margin in answers.margins("block", demand)]

    margins = {}
    if answers.probable:
        margins["P"] = probability(answers["overturning_probability"])
    if answers.factor in names:
        margins[f"smallest {factor_heading(answers.factor)}"] = smallest()
    for demand in answers.demands:
        if answers.probable:
            at_demand = answers.of_demand("demand_probability", demand)
            margins[f"P at {demand}"] = probability(at_demand, np.isnan(at_demand))
        margins[f"smallest capacity/demand {demand}"] = smallest(demand)
    if "outcome" in names:
        margins["overturned"] = [str(count) for count in answers.overturnings("block")]
    return margins
