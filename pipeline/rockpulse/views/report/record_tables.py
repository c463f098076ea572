"""Makes the tables of records, earthquakes, input files, files that were not assessed, and warnings."""

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.assessment import NAME
from rockpulse.errors import alike
from rockpulse.record.measures import PGA
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.selection.events import UNKNOWN, words_of
from rockpulse.views.shared.files_used import apart, by_kind, failure_rows, reasons_of
from rockpulse.views.shared.formatting import ratio, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table, number_cell
from rockpulse.views.shared.words import body_name, counted_words, in_dates, listed, numerals, say
from rockpulse.warning_text import has_warning

#: Largest number of rows in the table of records, directions in a row, reasons for a kind, and of ids of an earthquake.
ROWS, DIRECTIONS, REASONS, IDS = 10, 3, 2, 6
#: Largest number of characters of a reason, whose full text is in the annex.
LONGEST = 90
#: Kinds whose reasons are listed; other kinds have a common reason.
_TOLD = ("failed", "skipped")


def event_name(event: str, known: Known | None) -> str:
    """Return the name of the earthquake of a record or, if it has no name, its date."""
    if event == UNKNOWN:
        return say("unknown_event.name")
    return event if words_of(event) or known is None else earthquake_words(known) or event


def record_label(record: str) -> str:
    """Return the id of a record; a design sequence is named in the current language."""
    start, design, quantile = record.partition(NAME)
    if start or not design:
        return record
    return say("motions.design_of", quantile=numerals(quantile.strip())) if quantile else say("motions.design")


def earthquake_words(known: Known) -> str:
    """Return the name of an earthquake or, if it has no name, its date; empty if both are unknown."""
    return known.title or (say("earthquake_of", date=in_dates(known.date)) if known.date else "")


def record_words(known: Known) -> str:
    """Return earthquake, station code and direction of a record as text; empty if the earthquake is unknown."""
    event, station = earthquake_words(known), known.value("station") or known.place
    return ", ".join(filter(None, (event, station, known.direction))) if event else ""


def record_named(known: Known, name: str) -> str:
    """Describe a record by earthquake, station and direction; its id, `name`, is added if the station is unknown."""
    description = record_words(known)
    return description if description and known.place else ", ".join(filter(None, (description, name)))


def used_table(answers: Answers) -> Table:
    """Return a table of the records by station and earthquake; if there are many, only of the strongest records."""
    pga = answers["pga"]
    groups: dict[tuple[str, str, str], list[int]] = {}
    for row, (record, event) in enumerate(zip(answers.records, answers["event"], strict=True)):
        known = Known(answers.summary, record=record)
        key = earthquake_words(known), known.place, str(event)
        groups.setdefault(key if key[0] and key[1] else (record, "", ""), []).append(row)
    order = sorted(groups.values(), key=lambda rows: -float(np.max(pga[rows])))
    titles = ("earthquake", "magnitude", "station", "direction", "records", PGA, "worst")
    rows = [_used(answers, rows) for rows in order[:ROWS]]
    kept = [place for place, title in enumerate(titles) if title != "magnitude" or any(row[place].text for row in rows)]
    headings = tuple(Heading(say(f"head.{titles[place]}"), "g" if titles[place] == PGA else "") for place in kept)
    rows = [tuple(row[place] for place in kept) for row in rows]
    caption_key = "caption.used" if len(order) <= ROWS else "caption.strongest"
    caption = say(caption_key, shown=len(rows), total=len(order), records=counted_words(len(pga), "record"))
    given = sum(has_warning(str(codes), "direction_given") for codes in answers["warning_codes"])
    said = say("warning.given.head", count=counted_words(given, "record")) if given else ""
    return Table("used", caption, headings, tuple(rows), (f"{said[:1].upper()}{said[1:]}.",) if said else ())


def _used(answers: Answers, rows: list[int]) -> tuple[Cell, ...]:
    every = [Known(answers.summary, record=answers.records[row]) for row in rows]
    first, strongest = every[0], max(rows, key=lambda row: float(answers["pga"][row]))
    directions = [*dict.fromkeys(filter(None, (one.direction for one in every)))]
    which = ", ".join(directions) if len(directions) <= DIRECTIONS else say("directions", count=len(directions))
    return (
        Cell(earthquake_words(first) or answers.records[rows[0]], link=f"record-{strongest}"),
        Cell(first.magnitude, first.real("magnitude")),
        Cell(first.place or (answers.records[rows[0]] if earthquake_words(first) else "")),
        Cell(which),
        number_cell(len(rows), str),
        number_cell(float(answers["pga"][strongest]) / STANDARD_GRAVITY, three_digits),
        _worst(answers, rows),
    )


def _worst(answers: Answers, rows: list[int]) -> Cell:
    """Return a cell with the body that is most likely to overturn under the given records."""
    if not answers.bodies:
        return Cell("")
    table = answers["overturning_probability"][rows] if answers.probable else -answers[answers.factor][rows]
    if np.isnan(table).all():
        return Cell("")
    lane = int(np.nanargmax(np.nanmax(np.where(np.isnan(table), -math.inf, table), axis=0)))
    what = say(f"column.{'overturning_probability' if answers.probable else 'safety_factor'}.head")
    value = ratio(abs(float(np.nanmax(table[:, lane]))))
    return Cell(f"{body_name(answers.bodies[lane].name)} ({what}\N{NO-BREAK SPACE}{value})")


def earthquake_table(answers: Answers) -> Table:
    """Return a table of the earthquakes with facts from the files and the numbers of their records."""
    motions = answers.motions
    of_event: dict[str, list[int]] = {}
    for place, event in enumerate(motions.events):
        of_event.setdefault(event, []).append(place)
    rows = []
    for event, places in of_event.items():
        members = np.unique(motions.index[places])
        known = [Known(answers.summary, record=answers.records[row]) for row in members if row >= 0]
        names = listed([motions.names[place] for place in places], IDS)
        rows.append(
            (
                Cell(event_name(event, known[0] if known else None)),
                *_of_earthquake(known),
                number_cell(len(places), str),
                Cell(names),
            )
        )
    titles, always = ("earthquake", "date", "magnitude", "distance", "motions", "which"), (0, 4, 5)
    kept = [place for place in range(len(titles)) if place in always or any(row[place].text for row in rows)]
    kept_rows = tuple(tuple(row[place] for place in kept) for row in rows)
    return Table("earthquakes", say("caption.earthquakes"), _headings(*(titles[place] for place in kept)), kept_rows)


def _of_earthquake(known: Sequence[Known]) -> tuple[Cell, Cell, Cell]:
    """Return three cells for the records of one earthquake: date, magnitude, and range of epicentral distances."""
    dates = sorted({date for one in known if (date := one.date)})
    magnitudes = list(dict.fromkeys(stated for one in known if (stated := one.magnitude)))
    distances = [distance / 1000.0 for one in known if not math.isnan(distance := one.real("epicentral_distance"))]
    largest = max((one.real("magnitude") for one in known if one.magnitude), default=math.nan)
    nearest, farthest = min(distances, default=math.nan), max(distances, default=math.nan)
    low, high = three_digits(nearest), three_digits(farthest)
    reach = "" if not distances else low if low == high else say("between", low=low, high=high)
    return Cell(in_dates(dates[0]) if dates else ""), Cell(", ".join(magnitudes), largest), Cell(reach, nearest)


def left_out_table(tree: xr.DataTree) -> Table:
    """Return a table of files and channels that were not assessed: a row for each kind, with the reasons."""
    found, beside = apart(failure_rows(tree))
    rows = []
    for kind, every in found.items():
        said, rest = reasons_of(every, REASONS, LONGEST) if kind in _TOLD else ([say(f"left_out.why.{kind}")], 0)
        reasons = "; ".join([*said, *([say("left_out.other", count=rest)] if rest else [])])
        grade = "bad" if kind == "failed" else ""
        rows.append((Cell(say(f"left_out.{kind}"), grade=grade), number_cell(len(every), str), Cell(reasons)))
    if beside:
        rows.append((Cell(say("left_out.no_record")), number_cell(len(beside), str), Cell(listed(beside))))
    return Table("left-out", say("caption.left_out"), _headings("kind", "count", "reason"), tuple(rows))


def input_table(summary: xr.Dataset, full: bool = False) -> Table:
    """Return a table of the input files of the records, with their SHA-256 if `full`."""
    names = ("source", "source_sha256", "format") if full else ("source", "format")
    columns = [summary[name].values.tolist() if name in summary else [""] * summary.sizes["record"] for name in names]
    of_file: dict[str, dict[str, None]] = {}
    for record, source in zip(summary["record"].values, columns[0], strict=True):
        known = Known(summary, record=str(record))
        if occasion := ", ".join(filter(None, (earthquake_words(known), known.place))):
            of_file.setdefault(source, {})[occasion] = None
    rows = tuple(
        (*map(Cell, row), number_cell(count, str), *([Cell("; ".join(of_file.get(row[0], ())))] if of_file else []))
        for row, count in Counter(zip(*columns, strict=True)).items()
    )
    headings = _headings("file", *(["sha256"] if full else []), "format", "records", *(["occasion"] if of_file else []))
    return Table("inputs", say("caption.inputs"), headings, rows)


def left_out_files(tree: xr.DataTree) -> Table:
    """Return a table of files and channels that were not assessed: a row for each reason; failures come first."""
    rows = tuple(
        (
            Cell(say(f"left_out.{kind}"), grade="bad" if kind == "failed" else ""),
            Cell(say(f"stage.{group[0].stage}")),
            Cell(", ".join(dict.fromkeys(row.place for row in group))),
            Cell(group[0].bare),
        )
        for kind, entries in by_kind(failure_rows(tree)).items()
        for group in alike(entries)
    )
    return Table("failures", say("caption.left_out"), _headings("kind", "step", "file", "reason"), rows)


def warning_table(summary: xr.Dataset) -> Table:
    """Return a table of the warnings on bodies and records, with a row for each code or, without a code, each text."""
    groups: dict[tuple[str, str], dict[str, list[int]]] = {}
    for kind, name in (("block", "block_warning"), ("record", "warning")):
        texts = summary[f"{name}s"].values.tolist() if f"{name}s" in summary else []
        codes = summary[f"{name}_codes"].values.tolist() if f"{name}_codes" in summary else [""] * len(texts)
        for place, (text, code) in enumerate(zip(texts, codes, strict=True)):
            lines, of_lines = [line for line in text.splitlines() if line], code.split(" ")
            for line, one in zip(lines, of_lines if len(of_lines) == len(lines) else lines, strict=True):
                groups.setdefault((kind, one or line), {}).setdefault(line, []).append(place)
    rows = tuple(_warned(summary, kind, texts) for (kind, _), texts in groups.items())
    return Table("record-warnings", say("page.warnings"), _headings("of_what", "warning"), rows)


def _warned(summary: xr.Dataset, kind: str, texts: dict[str, list[int]]) -> tuple[Cell, Cell]:
    """Return two cells: the body or record with a warning, or their number, and the text of the warning."""
    places = sorted({place for every in texts.values() for place in every})
    noun = "body" if kind == "block" else "record"
    label = Cell(record_label(str(summary[kind].values[places[0]])), link=f"{noun}-{places[0]}")
    if len(places) > 1:
        label = Cell(counted_words(len(places), noun))
    first, rest = next(iter(texts)), len(texts) - 1
    return label, Cell(say("and_similar", text=first, count=rest) if rest else first)


def versions(tree: xr.DataTree) -> tuple[Fact, ...]:
    """Return the versions of the software packages with which the results were computed."""
    found = {str(name): str(value) for name, value in tree.attrs.items() if name != "schema_version"}
    end = "_version"
    return tuple(Fact(name.removesuffix(end), (version,)) for name, version in found.items() if name.endswith(end))


def _headings(*names: str) -> tuple[Heading, ...]:
    return tuple(Heading(say(f"head.{name}")) for name in names)
