"""Capacity divided by demand, and results over the directions of pairs of channels, as text."""

import math
from collections.abc import Collection, Sequence

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Margin, lanes, swept_answers
from rockpulse.assessment.verdict import verdicts
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.shared import table_columns as col
from rockpulse.views.shared.formatting import ABSENT, paragraph, ratio, shortened, three_digits
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number_cell
from rockpulse.views.shared.verdict_table import cautions, factor_heading, factor_name, factor_notes


def smallest_capacities(answers: Answers, blocks: Collection[int] | None = None) -> str:
    """Return smallest and median capacity/demand of the bodies as text; `blocks` selects bodies by their indices."""
    motions = answers.motions
    if not answers.demands or not motions.names:
        return ""
    of_demands = list(zip(*([row.margin for row in one.demands] for one in verdicts(answers)), strict=True))
    listed = [k for k, body in enumerate(answers.bodies) if blocks is None or body.place in blocks]
    every = [margins[k] for k in listed for margins in of_demands]
    rows = [
        (answers.bodies[k].block, answers.bodies[k].restitution, [_both(margins[k]) for margins in of_demands])
        for k in listed
    ]
    each = "the pairs" if motions.kind == "pair" else "the records"
    of = f"{each}, each in its worst direction" if motions.kind == "pair" else each
    marks = col.marks_of(cell for margin in every for cell in col.margin_cells(margin))
    note = "Below 1: the record overturns the body at a scale factor below that of the demand."
    if answers.probable:
        note = "Below 1: scaled to the demand, the record overturns the body with a probability above 10 %."
    if col.NONE_UP_TO in marks:
        note += f" {col.NONE_UP_TO.note}"
    elif any(math.isinf(margin.smallest) or math.isinf(margin.median) for margin in every):
        note += " none: no overturning was found."
    if col.NO_ANSWER in marks:
        note += " !: a lower bound; above it the model gives no result."
    if unknown := max(margin.unknown for margin in every):
        note += f" -: not known, left out of smallest and median ({unknown} of {each})."
    if partial := max(margin.partial for margin in every):
        note += f" {col.AT_MOST.note[:-1]} (up to {partial} of {each})."
    if weak := max(margin.weak for margin in every):
        note += f" Left out: {each} too weak for the search to reach the demand (up to {weak})."
    heading = f"Capacity ({_capacity(answers)}) over demand: smallest and median of {of}"
    return "\n".join([paragraph(heading), "", *_lines(answers, rows, col.NAME_WIDTH), "", paragraph(note, "  ")])


def capacities(answers: Answers, of: str) -> list[str]:
    """Return a line of capacity/demand for every record and body; it begins with the record or body, as `of` states."""
    if not answers.demands:
        return []
    of_demands = [(answers.ratios(name), answers.proven(name)) for name in answers.demands]
    rows = []
    for row, record in enumerate(answers.records):
        for lane, body in enumerate(answers.bodies):
            at, bound = (row, lane), bool(answers.bound[row, lane])
            cells = [col.factor_cell(float(ratio[at]), float(limit[at]), bound) for ratio, limit in of_demands]
            rows.append((record if of == "record" else body.block, body.restitution, cells))
    marks = col.marks_of(cell for *_, cells in rows for cell in cells)
    notes = [paragraph(col.NONE_UP_TO.note, "  ")] if col.NONE_UP_TO in marks else []
    table = _lines(answers, rows, None if of == "record" else col.NAME_WIDTH)
    return [f"Capacity ({_capacity(answers)}) over demand:", *table, *notes, ""]


def _capacity(answers: Answers) -> str:
    return f"{factor_name(answers.factor)} x strength, {answers.model} model"


def _lines(answers: Answers, rows: Sequence[tuple[str, float, list[Cell]]], width: int | None) -> list[str]:
    titles = [
        Heading(f"{name} ({demand.words})".replace(" ", "\N{NO-BREAK SPACE}"))
        for name, demand in answers.demands.items()
    ]
    c = col.COLUMNS["restitution"]
    cells = tuple((Cell(name), c.cell(value), *more) for name, value, more in rows)
    return lines(Table("", "", (Heading("", width=width), c.heading, *titles), cells), "  ")


def _both(margin: Margin) -> Cell:
    if math.isnan(margin.smallest):
        return Cell(ABSENT, math.nan)
    return Cell(", ".join(cell.marked for cell in col.margin_cells(margin)), margin.smallest)


def direction_table(summary: xr.Dataset, directions: xr.Dataset) -> str:
    """Return a table of pairs of channels: rotations, scale factor and number of overturnings over all directions."""
    answers = swept_answers(summary, directions)
    count, pairs = directions.sizes["direction"], range(directions.sizes["pair"])
    of_factors = factor_notes(answers, swept=True)

    def swept(name: str, model: str = answers.model) -> np.ndarray:
        return lanes(directions, name, answers.bodies, model)

    def peak(value: float) -> str:
        return Outcome.OVERTURNS.name if math.isinf(value) else ratio(value)

    median, largest = swept("median_rotation_ratio"), swept("largest_rotation_ratio")
    # A block at rest in all directions has no azimuth of the largest rotation.
    largest_at = np.where(largest == 0.0, np.nan, swept("largest_azimuth"))
    fallen = [(swept("overturning_share", model), swept("unanswered_count", model)) for model in answers.models]
    titles = [factor_heading(answers.factor), "at"] if of_factors else []
    names = [_name(answers, directions.isel(pair=pair)) for pair in pairs]
    rows = [
        (
            Cell("  " + shortened(body.block, col.NAME_WIDTH)),
            col.COLUMNS["restitution"].cell(body.restitution),
            *(number_cell(float(peaks[pair, lane]), peak) for peaks in (median, largest)),
            number_cell(largest_at[pair, lane], _degrees),
            *(_smallest(answers, directions, pair, lane) if titles else ()),
            *(_fallen(share[pair, lane] * count, silent[pair, lane]) for share, silent in fallen),
        )
        for pair in pairs
        for lane, body in enumerate(answers.bodies)
    ]
    headings = map(Heading, ("", "C", "median", "largest", "at", *titles, *answers.models))
    every = lines(Table("", "", tuple(headings), tuple(rows)))
    head, laid = every[: -len(rows)], every[-len(rows) :]
    over = f"directions of {count} that overturn".rjust(max(map(len, head)))  # above the columns of the models
    text_lines, size = [], len(answers.bodies)
    for pair, name in enumerate(names):
        title = "  ".join([name.marked, *_pair_strength(directions.isel(pair=pair))])
        text_lines += ["", title, over, *head, *laid[pair * size : (pair + 1) * size]]
    smallest_of = f" Then the smallest {factor_name(answers.factor)} and its azimuth." if of_factors else ""
    notes = [
        f"Median and largest over {count} directions of theta_max/alpha_c by the {answers.model} model, and the "
        "azimuth of the largest (the first to overturn if there are several)."
        f"{smallest_of} Then, by model, the number of directions that overturn; +1?: one more has no answer; -: not "
        "known.",
        *of_factors,
        *col.doubt_notes(names),
        "Each direction is a record: rockpulse inspect RESULTS --record ID shows one, --block NAME all of them.",
        *cautions(answers.models),
    ]
    return "\n".join([*text_lines[1:], "", *(paragraph(note, "  ") for note in notes)])


def _smallest(answers: Answers, directions: xr.Dataset, pair: int, lane: int) -> tuple[Cell, Cell]:
    """Return two cells: the smallest scale factor over the directions of a pair, and the azimuth of that direction."""
    factor, row_of_factor = (table[pair, lane] for table in answers.least_over_direction)
    index, row = directions["record_index"].values[pair], int(row_of_factor)
    azimuth = float(directions["direction_azimuth"].values[index == row][0]) if row >= 0 else math.nan
    limit = float(np.min(answers.proven()[index[index >= 0], lane], initial=math.inf))
    bound = row >= 0 and bool(answers.bound[row, lane])
    return col.factor_cell(float(factor), limit, bound), number_cell(azimuth, _degrees)


def _name(answers: Answers, pair: xr.Dataset) -> Cell:
    """Return a cell with the name of a pair, and marks if its records are doubtful."""
    index = pair["record_index"].values
    codes = " ".join(map(str, answers["warning_codes"][index[index >= 0]]))
    return Cell(str(pair["pair"].item()), marks=col.doubt(pair["pga_largest"].item(), codes))


def _pair_strength(pair: xr.Dataset) -> list[str]:
    parts = []
    for title, name, unit, scale in (("PGA", "pga", "g", STANDARD_GRAVITY), ("I", "main_impulse", "m/s", 1.0)):
        median, largest, azimuth = (pair[f"{name}_{what}"].item() for what in ("median", "largest", "azimuth"))
        if not math.isnan(largest):
            most = f"{three_digits(largest / scale, unit)} (at {_degrees(azimuth)})"
            parts.append(f"{title} {three_digits(median / scale)} (median), {most}")
    return parts


def _fallen(overturn: float, unanswered: int) -> Cell:
    return Cell(f"{overturn:.0f}" + (f" +{unanswered}?" if unanswered else ""), overturn)


def _degrees(azimuth: float) -> str:
    return ABSENT if math.isnan(azimuth) else f"{azimuth:g}°"
