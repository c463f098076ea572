"""An assessment as text: verdicts on one screen, all results, or the results of one record or body."""

import math

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, answers_of, lanes
from rockpulse.assessment.verdict import verdicts as found_verdicts
from rockpulse.record.measures import STORED
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.export.row_selection import RowSelection, unknown
from rockpulse.views.shared.files_used import files_used, left_out, skipped_summary, unused
from rockpulse.views.shared.formatting import ABSENT, fixed, paragraph, restitution, several, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell, table_text
from rockpulse.views.shared.table_columns import doubt, doubt_notes, marked_record, record_cells
from rockpulse.views.shared.verdict_table import cautions, tie_table
from rockpulse.views.text import verdicts
from rockpulse.views.text.lists import worst_cases
from rockpulse.views.text.margins import capacities, direction_table, smallest_capacities

#: Largest number of bodies and of records on one screen.
BODIES, MOTIONS = 12, 10
#: Largest number of results of a model up to which all are listed.
WHOLE = 200
#: Number of worst results and bodies shown, and of worst pairs of channels of a sweep.
WORST, PAIRS = 12, 3
#: Number of results shown of a record or body that has too many.
CASES = 20


def overview(tree: xr.DataTree, whole: bool = False) -> str:
    """Return verdicts, worst records and skipped files on one screen; with `whole`, all results."""
    files, answers = files_used(tree).line, answers_of(tree)
    parts = [headline(tree), unused(files)]
    directions = tree["directions"].to_dataset() if "directions" in tree.children else None
    if not whole and answers.motions.kind != "sequence":
        bodies = verdicts.body_verdicts(answers, BODIES if len(answers.bodies) > BODIES else None)
        parts += [bodies, ties(answers), verdicts.worst_motions(answers, MOTIONS), skipped_summary(tree)]
        parts.append("Every record, body and model: rockpulse inspect RESULTS --all")
    elif is_large(answers):
        parts += [_large(answers, directions), left_out(tree, brief=True), HINTS]
    else:
        summary = answers.summary.load()  # all values are shown, so they are read at once
        if directions is None:
            tables = [verdicts.verdict_table(summary), verdicts.body_verdicts(answers), ties(answers)]
            parts[1:] = [*tables, verdicts.overturned(answers, files)]
        else:
            parts[1:] = [direction_table(summary, directions.load()), verdicts.body_verdicts(answers), unused(files)]
        parts += [verdicts.governing(answers), smallest_capacities(answers), left_out(tree)]
    return "\n\n".join(filter(None, parts))


def ties(answers: Answers) -> str:
    """Return the table of the ties at the demands as text; empty if no body has ties."""
    table = tie_table(answers, found_verdicts(answers), marked_record(answers.summary))
    return "" if table is None else table_text(table)


def headline(tree: xr.DataTree) -> str:
    """Return title, description and the numbers of records, bodies and models of the results."""
    node = tree["directions" if "directions" in tree.children else "summary"]
    dims = ("pair", "direction", "block") if "directions" in tree.children else ("record", "block")
    counts = ", ".join(several(node.sizes[dim], "body" if dim == "block" else dim) for dim in dims)
    models = ", ".join(map(str, tree["summary"].to_dataset()["model"].values))
    lines = [paragraph(f"{tree.attrs.get('title', '')}: {counts}; models: {models}")]
    if described := str(tree.attrs.get("site_description", "")):
        lines.append(paragraph(described, "  "))
    return "\n".join(lines)


#: Text on the commands that show more of large results.
HINTS = """More: rockpulse inspect RESULTS
  --records, --blocks                     all records, all bodies; --sort VARIABLE, --limit N
  --record ID, --block NAME               one record or body in detail
  --outcome overturns --model linear      the cases that meet conditions; also --where 'factor_10 < 1'
  and rockpulse export RESULTS -o table.csv with the same options."""


def is_large(answers: Answers) -> bool:
    """Return whether an assessment has too many results to list all of them."""
    return len(answers.records) * len(answers.bodies) > WHOLE


def _large(answers: Answers, directions: xr.Dataset | None) -> str:
    parts = [_record_strength(answers), _verdicts(answers), verdicts.body_verdicts(answers, WORST)]
    if directions is None:
        parts.append(worst_cases(answers, RowSelection(limit=WORST)))
    else:
        parts.append(_pairs(answers, directions))
    parts.append(verdicts.governing(answers))
    if answers.demands:
        smallest = [margin.smallest for margin in answers.margins("block")]
        parts.append(smallest_capacities(answers, np.argsort(smallest, kind="stable")[:WORST].tolist()))
    return "\n\n".join(filter(None, parts))


def _record_strength(answers: Answers) -> str:
    rows = []
    for title, name, (_, unit, scale) in (
        *((row.title, row.name, row.column) for row in STORED),
        ("main impulse I", "main_impulse", ("I", "m/s", 1.0)),
    ):
        values = answers[name] / scale
        known = values[~np.isnan(values)]
        if known.size:
            quantiles = np.quantile(known, (0.0, 0.5, 1.0)).tolist()
            rows.append((Cell(title), *map(number_cell, quantiles), Cell(unit)))
    headings = tuple(map(Heading, ("", "smallest", "median", "largest", "")))
    lines = [table_text(Table("", "The records:", headings, tuple(rows)))]
    if drifting := int(np.count_nonzero(answers["pgv_drift"])):
        lines.append(
            f"  PGV is doubtful in {several(drifting, 'record')}: the baseline drifts (--where 'pgv_drift = drift')."
        )
    found = [cell for cell in record_cells(answers.summary) if cell.marks]
    if found:
        lines.append(paragraph(f"{several(len(found), 'record')} in doubt, marked in all tables.", "  "))
        lines += [paragraph(note, "  ") for note in doubt_notes(found)]
    return "\n".join(lines)


def _verdicts(answers: Answers) -> str:
    """Return a table with the number of results of each kind in every model."""
    total = len(answers.records) * len(answers.bodies)
    rows = []
    for model, one in answers.of_models.items():
        rest, rocks, over, unresolved = one.counts
        weak = int(np.count_nonzero(one["safety_factor"] < 1.0)) if one.searched else None
        counts = [number_cell(count, str) for count in (rest, rocks, over)]
        more = [number_cell(count, lambda value: fixed(value, 0)) for count in (unresolved, weak)]
        rows.append((Cell(model), *counts, Cell(f"{over / total:.1%}", over / total), *more))
    headings = ["", "at rest", "rocks", "OVERTURNS", "", "unresolved", "SF < 1"]
    kept = [place for place in range(len(headings)) if not all(row[place].text == ABSENT for row in rows)]
    headings, rows = [headings[place] for place in kept], [tuple(row[place] for place in kept) for row in rows]
    of_factors = ["SF < 1: the record, or the record scaled down, overturns the body (rocking is not monotonic)."]
    notes = (of_factors if "SF < 1" in headings else []) + cautions(answers.models)
    title = f"Verdicts, {total} by each model:"
    return table_text(Table("", title, tuple(map(Heading, headings)), tuple(rows), tuple(notes)))


def _pairs(answers: Answers, directions: xr.Dataset) -> str:
    """Return a table of the pairs of channels that come closest to overturning a body."""
    key = answers.least_over_direction[0]
    if not answers.has_factor:
        key = -lanes(directions, "largest_rotation_ratio", answers.bodies, answers.model)
    order, blocks = (
        np.sort(np.argsort(np.fmin.reduce(table, axis=axis), kind="stable")[:most])
        for table, axis, most in ((key, 1, PAIRS), (answers.by_block(np.fmin, key), 0, WORST))
    )
    part = directions.isel(pair=order, block=blocks).load()
    few = answers.summary.isel(block=blocks)
    heading = f"The worst {order.size} of {directions.sizes['pair']} pairs of channels"
    if blocks.size < directions.sizes["block"]:
        heading += f", the worst {blocks.size} of {directions.sizes['block']} bodies"
    return f"{heading}:\n\n{direction_table(few, part)}"


def record_details(summary: xr.Dataset, record: str) -> str:
    """Return all facts and results of one record as text; raise ResultsError for an unknown id."""
    answers = _only(summary, "record", record)
    one = Known(answers.summary, record=record)
    number, words, pga = one.number, one.words, one.value("pga")
    marks = doubt(pga, one.value("warning_codes"))
    strength = Cell(f"{three_digits(pga, 'm/s2')} ({three_digits(pga / STANDARD_GRAVITY, 'g')})", marks=marks).marked
    rows = [
        *(("description", description) for description in (one.described,) if description),
        ("source", words("source")),
        ("sha256 of the source", words("source_sha256")),
        ("station, component", f"{words('station')}, {words('component')} (azimuth {number('azimuth', 'degrees')})"),
        ("name of the station", words("station_name")),
        ("earthquake", words("event")),
        *one.stated,
        ("start", words("start_time")),
        ("samples", f"{one.value('npts')} at {number('dt', 's')}"),
        ("PGA", strength),
        ("PGV", one.peak_velocity),
        ("Arias intensity", number("arias_intensity", "m/s")),
        ("intense phase", f"{number('intense_start', 's')} to {number('intense_end', 's')}"),
        ("number of half-waves", str(one.value("half_wave_count"))),
        ("main impulse I", number("main_impulse", "m/s")),
        ("secondary impulse I_s", number("secondary_impulse", "m/s")),
        ("interval dT", number("secondary_interval", "s")),
        ("duration of the sequence", number("sequence_duration", "s")),
        ("main impulses", ABSENT if math.isnan(one.value("main_impulse")) else one.main_count),
        *(("processing", step) for step in one.lines("processing")),
        *(("warning", warning) for warning in one.lines("warnings")),
    ]
    return _page(record, rows, answers, "block")


def block_details(summary: xr.Dataset, block: str) -> str:
    """Return all facts and results of one body as text; raise ResultsError for an unknown name."""
    answers = _only(summary, "block", block)
    one = Known(answers.summary, block=block)
    number, restitutions = one.number, [body.restitution for body in answers.bodies]
    asked = [one.impact_friction(c) for c in restitutions]
    friction = f"{', '.join(map(three_digits, asked))}, for information"
    rows = [
        ("width, height", f"{number('width', 'm')}, {number('height', 'm')}"),
        ("half the diagonal R", one.radius),
        ("critical angle alpha_c", one.critical_angle),
        ("frequency parameter p", number("p", "1/s")),
        ("slenderness", number("slenderness")),
        *((("beside", one.support),) if one.support else ()),
        *([("friction required by an impact", friction)] if asked[0] else []),
        ("rebound e" if one.value("one_sided") else "restitution C", ", ".join(map(restitution, restitutions))),
        ("critical impulse I_1c", number("critical_impulse", "m/s")),
        *(("warning", warning) for warning in one.lines("block_warnings")),
    ]
    return _page(block, rows, answers, "record")


def _page(title: str, rows: list[tuple[str, str]], answers: Answers, of: str) -> str:
    """Return title and facts, then the results; each line begins with the record or the body, as `of` states."""
    width = max(len(name) for name, _ in rows)
    head = [title, *(paragraph(text, " " * (width + 4), f"  {name.ljust(width)}  ") for name, text in rows), ""]
    if is_large(answers):
        words = (outcome.name.lower().replace("_", " ") for outcome in Outcome)
        counted = ", ".join(f"{count} {word}" for count, word in zip(answers.counts, words, strict=True))
        heading = f"{sum(answers.counts)} verdicts by the {answers.model} model: {counted}."
        worst = worst_cases(answers, RowSelection(limit=CASES))
        return "\n".join([*head, heading, "", worst])
    factors = verdicts.probability_table(answers) + verdicts.factor_table(answers)
    return "\n".join([*head, verdicts.verdict_table(answers.summary), "", *capacities(answers, of), factors])


def _only(summary: xr.Dataset, dimension: str, label: str) -> Answers:
    known = [str(item) for item in summary[dimension].values]
    if label not in known:
        raise unknown(label, known, dimension)
    return Answers(summary.isel({dimension: [known.index(label)]}).load())
