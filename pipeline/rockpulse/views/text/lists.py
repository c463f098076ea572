"""Lists for the terminal: the cases, records or blocks of an assessment that a selection names, in its order."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.hdf5_reader import flag_words, pointwise, slab, worded
from rockpulse.storage.selection import Selection, rows
from rockpulse.views.shared.record_marks import doubt, doubt_notes
from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, ratio, restitution, shortened
from rockpulse.views.shared.verdict_notes import BEYOND_CRITICAL
from rockpulse.views.text.capacity import BEYOND, factor_cell, search_limit, short_factor_cell
from rockpulse.views.text.overview import NAME_WIDTH, VERDICT, fullest_model, verdict_cell

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["answers", "block_list", "case_list", "distinct", "record_list", "worst_first"]

#: Longest record id in a list.
ID_WIDTH = 36

#: Variables of /summary that a list of cases shows in columns of its own.
SHOWN = ("pga", "uplift_ratio", "impulse_ratio", "safety_factor", "capacity_pga", "restitution")

#: What a cell of a safety factor is made of.
FACTOR = ("safety_factor", "interval_count", "factor_resolved", "safe_up_to")


def distinct(summary: xr.Dataset) -> np.ndarray:
    """Which cases of restitution are shown, (block, case): one of a body whose cases have all the same.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    """
    values = summary.variables["restitution"].values
    values = values.reshape(values.shape[0], -1)
    shown = np.repeat((values != values[:, :1]).any(axis=1)[:, np.newaxis], values.shape[1], axis=1)
    shown[:, 0] = True
    return shown


def answers(summary: xr.Dataset, name: str, model: str) -> np.ndarray | None:
    """A variable of one model, (record, block, case); None where the results lack it.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    name : str
        A variable along record, block, model and perhaps case.
    model : str
        Which.
    """
    if name not in summary.variables:
        return None
    variable = summary.variables[name]
    place = [str(label) for label in summary["model"].values].index(model)
    values = slab(variable, {"model": slice(place, place + 1)})
    order = [dim for dim in ("record", "block", "case", "model") if dim in variable.dims]
    values = values.transpose([variable.dims.index(dim) for dim in order])
    return values.reshape(*values.shape[:2], -1)


def worst_first(summary: xr.Dataset, model: str, selection: Selection) -> Selection:
    """A selection in the order of the safety factor, or of the rotation where the model was not searched.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    model : str
        Whose safety factors count.
    selection : Selection
        Without an order.
    """
    factor = answers(summary, "safety_factor", model)
    if factor is not None and not np.all(np.isnan(factor)):
        return replace(selection, sort="safety_factor", descending=False)
    return replace(selection, sort="peak_rotation_ratio", descending=True)


def case_list(summary: xr.Dataset, selection: Selection) -> str:
    """The answers that a selection names, one a line.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    selection : Selection
        Which answers; those of the fullest model where it names none.

    Raises
    ------
    ResultsError
        For a name or variable that is not there.
    """
    if not selection.names.get("model"):
        selection = replace(selection, names={**selection.names, "model": (fullest_model(summary),)})
    dims = [dim for dim in ("record", "block", "case", "model") if dim in summary["outcome"].dims]
    masks = [(("block", "case"), distinct(summary))] if "case" in dims else []
    places, found = rows(summary, dims, selection, masks)
    count = places["record"].size
    heading = _heading(selection, count, found)
    if not count:
        return heading
    several = len(set(places["model"].tolist())) > 1
    extra = [name for name in _of_interest(selection) if name not in (*SHOWN, *VERDICT)]
    names = (*SHOWN, *VERDICT, *FACTOR, "warning_codes")
    get = {name: _values(summary, name, places) for name in names}
    more = {name: _cells(summary, name, places) for name in extra}
    models = [str(label) for label in summary["model"].values]
    records, blocks = (summary[dim].values[places[dim]].tolist() for dim in ("record", "block"))
    title = "verdict" if several else models[places["model"][0]]
    table = [
        ["record", "block", *(["model"] if several else []), "C", "PGA/g", "a/a_up", "I/I_1c", title + " ", "SF  "]
    ]
    table[0] += ["SF PGA/g", *extra]
    for k in range(count):
        model = models[places["model"][k]]
        answer = {name: get[name][k] for name in VERDICT}
        limit, pga = get["safe_up_to"][k], get["pga"][k]
        proven = None if limit is None else limit * pga / STANDARD_GRAVITY
        table.append(
            [
                shortened(records[k], ID_WIDTH) + doubt(pga, get["warning_codes"][k]),
                shortened(blocks[k], NAME_WIDTH),
                *([model] if several else []),
                restitution(get["restitution"][k]),
                _of(pga, STANDARD_GRAVITY),
                *(_of(get[name][k]) for name in ("uplift_ratio", "impulse_ratio")),
                verdict_cell(answer, _rung(summary, places, k) if model == "auto" else ""),
                short_factor_cell(*(get[name][k] for name in FACTOR)),
                factor_cell(_in_g(get["capacity_pga"][k]), limit=proven),
                *(more[name][k] for name in extra),
            ]
        )
    left = 3 if several else 2
    rocking = zip(get["outcome"], get["peak_rotation_ratio"], strict=True)
    beyond = any(outcome == Outcome.ROCKS and peak > 1.0 for outcome, peak in rocking)
    return "\n".join([heading, "", *("  " + line for line in aligned(table, left=left)), "", *_notes(table, beyond)])


def record_list(summary: xr.Dataset, selection: Selection) -> str:
    """The records that a selection names: strength, and what they do to the blocks.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    selection : Selection
        Which records; a condition on an answer has to hold for one of the blocks.

    Raises
    ------
    ResultsError
        For a name or variable that is not there.
    """
    selection, model = _with_model(summary, selection)
    places, found = rows(summary, ["record"], selection)
    at = places["record"]
    names = ("pga", "pgv", "pgv_drift", "arias_intensity", "main_impulse", "warning_codes")
    get = {name: _values(summary, name, places) for name in names}
    extra = [name for name in _of_interest(selection) if name not in names and summary[name].dims == ("record",)]
    more = {name: _cells(summary, name, places) for name in extra}
    fallen, factor, worst, limit = _by(summary, model, axis=1)
    blocks = [str(label) for label in summary["block"].values]
    table = [["record", "PGA/g", "PGV m/s", "Arias m/s", "I m/s", "warnings", *extra, "overturns", "SF", "of"]]
    for k, (name, row) in enumerate(zip(summary["record"].values[at].tolist(), at.tolist(), strict=True)):
        codes = str(get["warning_codes"][k])
        table.append(
            [
                shortened(name, ID_WIDTH) + doubt(get["pga"][k], codes),
                _of(get["pga"][k], STANDARD_GRAVITY),
                ("~" if get["pgv_drift"][k] else "") + _of(get["pgv"][k]),
                *(_of(get[name][k]) for name in ("arias_intensity", "main_impulse")),
                str(len(codes.split()) or ""),
                *(more[name][k] for name in extra),
                f"{fallen[row]} of {len(blocks)}",
                factor_cell(float(factor[row]), limit=limit),
                shortened(blocks[worst[row]], NAME_WIDTH) if np.isfinite(factor[row]) else "",
            ]
        )
    notes = [
        f"overturns: blocks that do, by the {model} model; SF: smallest known safety factor by it, and of which block."
    ]
    if any(row[2].startswith("~") for row in table[1:]):
        notes.append("~: the baseline of the record drifts, PGV may be off by as much.")
    notes += [*_of_beyond(table), *doubt_notes(row[0] for row in table)]
    return "\n".join([_counted("record", len(at), found, selection), "", *_listed(table), "", *_told(notes)])


def block_list(summary: xr.Dataset, selection: Selection) -> str:
    """The blocks that a selection names: size, and what the records do to them.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    selection : Selection
        Which blocks; a condition on an answer has to hold for one of the records.

    Raises
    ------
    ResultsError
        For a name or variable that is not there.
    """
    selection, model = _with_model(summary, selection)
    places, found = rows(summary, ["block"], selection)
    at = places["block"]
    get = {name: _values(summary, name, places) for name in ("width", "height", "alpha_c", "p", "critical_impulse")}
    c = summary.variables["restitution"].values.reshape(summary.sizes["block"], -1)
    fallen, factor, worst, limit = _by(summary, model, axis=0)
    records = [str(label) for label in summary["record"].values]
    units = ["b m", "h m", "alpha_c rad", "p 1/s", "I_1c m/s"]
    table = [["block", *units, "C", "overturned by", "SF", "under"]]
    for k, (name, row) in enumerate(zip(summary["block"].values[at].tolist(), at.tolist(), strict=True)):
        between = dict.fromkeys(restitution(value) for value in (c[row].min(), c[row].max()))
        table.append(
            [
                shortened(name, NAME_WIDTH),
                *(_of(get[name][k]) for name in get),
                " to ".join(between),
                f"{fallen[row]} of {len(records)}",
                factor_cell(float(factor[row]), limit=limit),
                shortened(records[worst[row]], ID_WIDTH) if np.isfinite(factor[row]) else "",
            ]
        )
    notes = [f"overturned by: records that do, by the {model} model; SF: smallest known by it, and under which record."]
    notes += _of_beyond(table)
    return "\n".join([_counted("block", len(at), found, selection), "", *_listed(table), "", *_told(notes)])


def _with_model(summary: xr.Dataset, selection: Selection) -> tuple[Selection, str]:
    """The selection with one model, the fullest of those it names or of all."""
    patterns = selection.names.get("model", ())
    part = summary[["model"]]
    if patterns:
        places, _ = rows(part, ["model"], Selection({"model": patterns}))
        part = part.isel(model=places["model"])
    model = fullest_model(part)
    return replace(selection, names={**selection.names, "model": (model,)}), model


def _by(summary: xr.Dataset, model: str, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Along an axis: how many overturn, the smallest known safety factor, its index, and the end of the search.

    The factor is NaN where none was found and not all are known.
    """
    names = ("outcome", "safety_factor", "safe_up_to")
    outcome, factor, searched = (answers(summary, name, model) for name in names)
    assert outcome is not None
    fallen = (outcome == Outcome.OVERTURNS).any(axis=2).sum(axis=axis)
    if factor is None:
        return fallen, np.full(fallen.shape, np.nan), np.zeros(fallen.shape, dtype=int), np.nan
    known = np.where(np.isnan(factor), np.inf, factor).min(axis=2)
    worst = known.argmin(axis=axis) if known.shape[axis] else np.zeros(fallen.shape, dtype=int)
    smallest = known.min(axis=axis, initial=np.inf)
    unknown = np.isnan(factor).any(axis=(axis, 2))
    smallest = np.where(np.isinf(smallest) & unknown, np.nan, smallest)
    return fallen, smallest, worst, search_limit(factor, searched)


def _of_interest(selection: Selection) -> list[str]:
    """Variables that a selection is about."""
    names = [item.name for item in selection.conditions] + ([selection.sort] if selection.sort else [])
    return list(dict.fromkeys(names))


def _values(summary: xr.Dataset, name: str, places: dict[str, np.ndarray]) -> list[Any]:
    if name not in summary.variables:
        return [None] * next(iter(places.values())).size
    return list(pointwise(summary.variables[name], places).tolist())


def _cells(summary: xr.Dataset, name: str, places: dict[str, np.ndarray]) -> list[str]:
    variable = summary.variables[name]
    found = pointwise(variable, places)
    if words := flag_words(variable):
        return [str(word) for word in worded(found, words)]
    if found.dtype.kind == "f":
        return [figure(number) for number in found.tolist()]
    return [shortened(str(one), NAME_WIDTH) for one in found.tolist()]


def _rung(summary: xr.Dataset, places: dict[str, np.ndarray], row: int) -> str:
    if "model_used" not in summary.variables:
        return ""
    variable = summary.variables["model_used"]
    code = int(pointwise(variable, {dim: place[row : row + 1] for dim, place in places.items()})[0])
    return flag_words(variable)[code]


def _of(number: float | None, unit: float = 1.0) -> str:
    return ABSENT if number is None else ratio(number / unit)


def _in_g(acceleration: float | None) -> float | None:
    return None if acceleration is None else acceleration / STANDARD_GRAVITY


def _of_beyond(table: list[list[str]]) -> list[str]:
    """What a cell behind ">" means, where there is one."""
    return [f">: {BEYOND}."] if any(cell.startswith(">") for row in table[1:] for cell in row) else []


def _heading(selection: Selection, count: int, found: int) -> str:
    told = replace(selection, sort=None, limit=None).words
    shown = "" if count == found else f"; {count} shown (--limit shows more)"
    return paragraph(f"{found} case{'' if found == 1 else 's'} with {'; '.join(told)}{_order(selection)}{shown}")


def _counted(noun: str, count: int, found: int, selection: Selection) -> str:
    shown = f"{count} of {found}" if count < found else str(found)
    return f"{shown} {noun}{'' if found == 1 else 's'}{_order(selection)}"


def _order(selection: Selection) -> str:
    return f", {'largest' if selection.descending else 'smallest'} {selection.sort} first" if selection.sort else ""


def _listed(table: list[list[str]]) -> list[str]:
    return ["  " + line for line in aligned(table)]


def _told(notes: list[str]) -> list[str]:
    return [paragraph(note, "  ") for note in notes]


def _notes(table: list[list[str]], beyond: bool) -> list[str]:
    """What the columns and the marks that are shown mean."""
    cells = [cell for row in table[1:] for cell in row]
    notes = [
        "Figures: theta_max/alpha_c. a/a_up: PGA over the acceleration of uplift. I/I_1c: main impulse over the one "
        "that overturns alone. SF: smallest factor on the model's input that overturns; SF PGA: the capacity.",
        *([BEYOND_CRITICAL] if beyond else []),
        *_of_beyond([row[:1] + row[-2:] for row in table]),
        *doubt_notes(row[0] for row in table),
    ]
    marks = {
        "*": "*: outside the range of this model.",
        "?": "?: not predictable: another answer when C or the record changes in the ninth digit.",
        "!": "!: a lower bound, from this factor on the model cannot answer.",
        "+": "+: not monotonic, beyond SF the block stands again before it overturns again.",
    }
    notes += [
        note
        for mark, note in marks.items()
        if any(cell.rstrip().endswith((mark, mark + "*", mark + "+")) for cell in cells)
    ]
    return _told(notes)
