"""The overview of an assessment as text: every model's verdict for every record and block, and what was left out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.hdf5_reader import flag_words
from rockpulse.views.shared.record_marks import doubt, doubts
from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, ratio, restitution, shortened
from rockpulse.views.shared.verdict_notes import MARKED, verdict_notes
from rockpulse.views.text.capacity import BEYOND, factor_cell, factor_notes, short_factor_cell, smallest_capacities

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "answered_by",
    "cases",
    "factor_table",
    "fullest_model",
    "headline",
    "overturned",
    "overview",
    "peak_velocity",
    "value",
    "verdict_cell",
    "verdict_table",
]

#: Longest block name in a table.
NAME_WIDTH = 29

_WORDS = {Outcome.AT_REST: "at rest", Outcome.OVERTURNS: "OVERTURNS", Outcome.UNRESOLVED: "unresolved"}

#: The variables that a verdict is told by.
VERDICT = ("outcome", "peak_rotation_ratio", "predictable", "applicable")


def value(summary: xr.Dataset, name: str, **where: Any) -> Any:
    """One number or text of the summary; None where the variable is absent.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    name : str
        A variable.
    **where
        Labels along ``record`` (``pair``), ``block`` and ``model``, position along ``case``; dimensions that the
        variable lacks are passed over.
    """
    if name not in summary:
        return None
    variable = summary.variables[name]
    place: dict[Any, Any] = {
        dim: label if dim == "case" else summary.get_index(dim).get_loc(label) for dim, label in where.items()
    }
    return variable.values[tuple(place[dim] for dim in variable.dims)].item()


def answered_by(summary: xr.Dataset, **where: Any) -> str:
    """Name of the model that gave an answer; empty where the results do not say.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    **where
        As in :func:`value`.
    """
    code = value(summary, "model_used", **where)
    return "" if code is None else flag_words(summary["model_used"])[code]


def cases(summary: xr.Dataset, block: str) -> range:
    """Which restitutions of a block to show: one where all its cases have the same.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    block : str
        Its name.
    """
    if "case" not in summary["restitution"].dims:
        return range(1)
    found = summary["restitution"].sel(block=block).values
    return range(1 if (found == found[0]).all() else found.size)


def peak_velocity(summary: xr.Dataset, record: str) -> str:
    """The PGV of a record in m/s, marked where the baseline of the record drifts.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    record : str
        Its id.
    """
    shown = figure(value(summary, "pgv", record=record), "m/s")
    return f"~{shown} (drift)" if value(summary, "pgv_drift", record=record) else shown


def verdict_cell(answer: Mapping[str, Any], rung: str = "") -> str:
    """One verdict: a word, or the largest rotation over alpha_c, with its marks; the last place is that of the star.

    Parameters
    ----------
    answer : mapping of str to number
        The variables `VERDICT` of one answer; None where the results lack one.
    rung : str
        For the model `auto`, the model that answered: its rotation is marked where that gives the verdict alone.

    Examples
    --------
    >>> answer = {"outcome": 1, "peak_rotation_ratio": 0.4123, "predictable": 0, "applicable": 1}
    >>> verdict_cell(answer), verdict_cell({**answer, "outcome": 2, "applicable": 0})
    ('0.41? ', 'OVERTURNS?*')
    """
    outcome = answer["outcome"]
    if outcome in _WORDS:
        text = _WORDS[outcome]
    elif outcome == Outcome.ROCKS:
        text = MARKED.get(rung, ratio)(answer["peak_rotation_ratio"])
    else:
        return ABSENT + " "
    mark = "?" if answer["predictable"] == 0 else ""
    return text + mark + ("*" if answer["applicable"] == 0 else " ")


def verdict_table(
    summary: xr.Dataset, records: Sequence[str] | None = None, blocks: Sequence[str] | None = None
) -> str:
    """The verdict of every model, one line per block under a heading per record, with footnotes.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    records, blocks : sequence of str, optional
        Which to show; all by default.
    """
    summary = _part(summary, records, blocks)
    of_factors = factor_notes(summary, fullest_model(summary))
    lines = _table(summary, _verdict, with_factor=bool(of_factors))
    notes = verdict_notes(summary, of_factors)
    return "\n".join([*lines, "", *(paragraph(note, "  ") for note in notes)])


def factor_table(summary: xr.Dataset, records: Sequence[str] | None = None, blocks: Sequence[str] | None = None) -> str:
    """The smallest factor on a model's input that overturns the block, laid out as the verdicts.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    records, blocks : sequence of str, optional
        Which to show; all by default.
    """

    def cell(summary: xr.Dataset, where: dict[str, Any]) -> str:
        return factor_cell(*_factor(summary, where)) + " "

    part = _part(summary, records, blocks)
    lines = _table(part, cell)
    notes = [
        "-: not computed for this model. (2): in two intervals of the factor; between them the block stands (group "
        "overturning_intervals)."
    ]
    if any(">" in line for line in lines):
        notes.insert(0, f">: {BEYOND}.")
    elif any(" none" in line for line in lines):
        notes.insert(0, "none: not found up to the end of the search.")
    if "factor_resolved" in part and (part["factor_resolved"] == 0).any():
        notes.append("!: a lower bound, from this factor on the model cannot answer.")
    return "\n".join([*lines, "", *(paragraph(note, "  ") for note in notes)])


def fullest_model(summary: xr.Dataset) -> str:
    """The model nearest to the full equation of motion.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    """
    models = [str(model) for model in summary["model"].values]
    return "nonlinear" if "nonlinear" in models else models[-1]


def overturned(summary: xr.Dataset) -> str:
    """The part of the overview on overturning: the records that overturn each block, by the fullest model in use.

    Below stand the counts of every model, and the pairs in which a block rocks under a record but is overturned by a
    weaker copy of it, which is no safer.
    """
    models = [str(model) for model in summary["model"].values]
    records = [str(record) for record in summary["record"].values]
    fullest = fullest_model(summary)
    lines = [f"What overturns (by the {fullest} model):"]
    rows = [["records that overturn", *models]]
    by_weaker = []
    mark = doubts(summary)
    for block in (str(name) for name in summary["block"].values):
        fallen = {model: [record for record in records if _falls(summary, record, block, model)] for model in models}
        weaker = [
            f"{record}{mark[record]} ({figure(factor)})"
            for record in records
            if record not in fallen[fullest] and (factor := _smallest_factor(summary, record, block, fullest)) < 1.0
        ]
        nothing = "nothing as recorded does, but see below" if weaker else "nothing does"
        named = ", ".join(record + mark[record] for record in fallen[fullest])
        lines.append(paragraph(named or nothing, "      ", f"  {block}: "))
        by_weaker += [paragraph(", ".join(weaker), "      ", f"  {block}: ")] if weaker else []
        rows.append([shortened(block, NAME_WIDTH), *(f"{len(fallen[model])} of {len(records)}" for model in models)])
    counts = ["", *("  " + line for line in aligned(rows))]
    if by_weaker:
        by_weaker = [
            "",
            "What rocks, but a weaker copy of the record overturns it (SF in brackets): not safe",
            *by_weaker,
        ]
    return "\n".join([*lines, *counts, *by_weaker])


def overview(tree: xr.DataTree) -> str:
    """Verdicts, what overturns, what was left out; of a sweep over direction the median and largest instead.

    Of more than `WHOLE` verdicts counts and the worst.

    Parameters
    ----------
    tree : xarray.DataTree
        The results; values that are not yet read are read as far as they are shown.
    """
    from rockpulse.views.text.directions import direction_table
    from rockpulse.views.text.large_overview import hints, is_large, large_overview
    from rockpulse.views.text.left_out import left_out

    summary = tree["summary"].to_dataset()
    head = headline(tree)
    if is_large(summary):
        return "\n\n".join([head, large_overview(tree), left_out(tree, brief=True), hints()])
    summary = summary.load()  # all of it is shown: read at once, not value by value
    if "directions" in tree.children:
        directions = tree["directions"].to_dataset().load()
        capacity = smallest_capacities(summary, fullest_model(summary), directions)
        parts = [head, direction_table(summary, directions), capacity, left_out(tree)]
    else:
        capacity = smallest_capacities(summary, fullest_model(summary))
        parts = [head, verdict_table(summary), overturned(summary), capacity, left_out(tree)]
    return "\n\n".join(part for part in parts if part)


def headline(tree: xr.DataTree) -> str:
    """What the results are of: title, description, how many records, blocks and models.

    Parameters
    ----------
    tree : xarray.DataTree
        The results.
    """
    summary = tree["summary"].to_dataset()
    sizes = {"record": summary.sizes["record"], "block": summary.sizes["block"]}
    if "directions" in tree.children:
        swept = tree["directions"].to_dataset().sizes
        sizes = {"pair": swept["pair"], "direction": swept["direction"], "block": swept["block"]}
    counts = [f"{size} {dim}{'' if size == 1 else 's'}" for dim, size in sizes.items()]
    models = ", ".join(str(model) for model in summary["model"].values)
    lines = [paragraph(f"{tree.attrs.get('title', '')}: {', '.join(counts)}; {models}")]
    if described := str(tree.attrs.get("site_description", "")):
        lines.append(paragraph(described, "  "))
    return "\n".join(lines)


def _part(summary: xr.Dataset, records: Sequence[str] | None, blocks: Sequence[str] | None) -> xr.Dataset:
    """The summary of some records and blocks; all where they are not named."""
    named = {"record": records, "block": blocks}
    return summary.sel({name: list(labels) for name, labels in named.items() if labels is not None})


def _table(
    summary: xr.Dataset, cell: Callable[[xr.Dataset, dict[str, Any]], str], with_factor: bool = False
) -> list[str]:
    records, blocks, models = ([str(label) for label in summary[name].values] for name in ("record", "block", "model"))
    last = ["SF  "] if with_factor else []
    headings, rows = [], [["", "C", "a/a_up", "I/I_1c", *(model + " " for model in models), *last]]
    for record in records:
        headings.append((len(rows), _heading(summary, record)))
        for block in blocks:
            for case in cases(summary, block):
                where: dict[str, Any] = {"record": record, "block": block, "case": case}
                c = restitution(value(summary, "restitution", **where))
                demand = [ratio(value(summary, name, **where)) for name in ("uplift_ratio", "impulse_ratio")]
                cells = [cell(summary, {**where, "model": model}) for model in models]
                if with_factor:
                    cells.append(short_factor_cell(*_factor(summary, {**where, "model": fullest_model(summary)})))
                rows.append(["  " + shortened(block, NAME_WIDTH), c, *demand, *cells])
    lines = aligned(rows)
    for place, heading in reversed(headings):
        lines[place:place] = ["", heading, lines[0]]
    return lines[2:]


def _factor(summary: xr.Dataset, where: dict[str, Any]) -> list[Any]:
    """What a cell of a factor is made of."""
    names = ("safety_factor", "interval_count", "factor_resolved", "safe_up_to")
    return [value(summary, name, **where) for name in names]


def _heading(summary: xr.Dataset, record: str) -> str:
    pga = value(summary, "pga", record=record)
    marked = record + doubt(pga, value(summary, "warning_codes", record=record))
    parts = [marked, f"PGA {figure(pga / STANDARD_GRAVITY, 'g')}", f"PGV {peak_velocity(summary, record)}"]
    impulse = value(summary, "main_impulse", record=record)
    if not math.isnan(impulse):
        parts.append(f"I {figure(impulse, 'm/s')}")
    return "  ".join(parts)


def _verdict(summary: xr.Dataset, where: dict[str, Any]) -> str:
    answer = {name: value(summary, name, **where) for name in VERDICT}
    return verdict_cell(answer, answered_by(summary, **where) if where["model"] == "auto" else "")


def _smallest_factor(summary: xr.Dataset, record: str, block: str, model: str) -> float:
    """Smallest safety factor of a block over its cases; inf where none is known."""
    factors = summary["safety_factor"].sel(record=record, block=block, model=model).values
    return float(np.min(factors, initial=np.inf, where=~np.isnan(factors)))


def _falls(summary: xr.Dataset, record: str, block: str, model: str) -> bool:
    """Whether a block overturns in any of its cases."""
    outcome = summary["outcome"].sel(record=record, block=block, model=model)
    return bool((outcome == Outcome.OVERTURNS).any())
