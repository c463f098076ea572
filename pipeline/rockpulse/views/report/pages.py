"""The pages of a report on each body and on each record."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rockpulse.assessment.answers import Answers, Body
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.answers import AnswerCells, record_table
from rockpulse.views.report.bodies import grade_cell
from rockpulse.views.report.records_used import record_named, record_words
from rockpulse.views.report.statements import acceleration
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, restitution

__all__ = ["BodyPage", "RecordPage", "body_pages", "record_pages"]

#: Records that are listed under a body.
GOVERNING = 10


@dataclass(frozen=True)
class BodyPage:
    """One block: a verdict for each restitution, and the records that come nearest to overturning it, or beyond.

    ``key`` is the id of the part of the page.
    """

    key: str
    name: str
    verdicts: tuple[Cell, ...]
    facts: tuple[Fact, ...]
    governing: Table


@dataclass(frozen=True)
class RecordPage:
    """One record, a row of /summary: what is known of it in words, how the worst body stands, and every body under it.

    ``key`` is the id of the part of the page.
    """

    key: str
    name: str
    place: int
    words: str
    brief: str
    worst: Cell
    facts: tuple[Fact, ...]
    bodies: Table


def body_pages(cells: AnswerCells, found: list[BodyVerdict]) -> list[BodyPage]:
    """A page for every block, its restitutions together."""
    answers = cells.answers
    pages = []
    for place, block in enumerate(answers.blocks):
        own = [lane for lane, body in enumerate(answers.bodies) if body.place == place]
        pages.append(
            BodyPage(
                key=f"body-{place}",
                name=block,
                verdicts=tuple(
                    grade_cell(cells.words, found[lane], _case(cells.words, answers.bodies[lane])) for lane in own
                ),
                facts=_of_block(cells.words, answers, block, [answers.bodies[lane].restitution for lane in own]),
                governing=_governing(cells, own, place),
            )
        )
    return pages


def record_pages(cells: AnswerCells) -> list[RecordPage]:
    """A page for every record."""
    words, answers = cells.words, cells.answers
    pages = []
    for place, (record, event) in enumerate(zip(answers.records, answers["event"], strict=True)):
        worst = Cell(ABSENT)
        if answers.bodies:
            worst = cells.verdict(place, cells.worst(place))
        one = Known(answers.summary, record=record)
        pages.append(
            RecordPage(
                key=f"record-{place}",
                name=cells.names[place].marked,
                place=place,
                words=", ".join(filter(None, (record_words(words, one), one.magnitude))),
                brief=_brief(words, one),
                worst=worst._replace(text=words("worst", answer=f"{'P ' if answers.probable else ''}{worst.text}")),
                facts=_of_record(words, one, str(event)),
                bodies=record_table(cells, place),
            )
        )
    return pages


def _case(words: Words, body: Body) -> str:
    return words.number(f"C = {restitution(body.restitution)}: ") if body.several else ""


def _of_block(words: Words, answers: Answers, block: str, restitutions: list[float]) -> tuple[Fact, ...]:
    one = Known(answers.summary, block=block)
    known = one.number
    size = f"{known('width', 'm')} × {known('height', 'm')}"
    facts = {
        "size": words("fact.by_numbers") if math.isnan(one.value("width")) else size,
        "beside": words.shared(one.support),
        "radius": words.shared(one.radius),
        "alpha_c": known("alpha_c", "rad"),
        "p": known("p", "1/s"),
        "slenderness": known("slenderness"),
        "rebound" if one.value("one_sided") else "restitution": ", ".join(map(restitution, restitutions)),
        "critical_impulse": known("critical_impulse", "m/s"),
    }
    told = [Fact(words(f"fact.{name}"), (words.number(value),)) for name, value in facts.items() if value]
    warnings = one.lines("block_warnings")
    return (*told, Fact(words("fact.warnings"), warnings)) if warnings else tuple(told)


def _governing(cells: AnswerCells, own: list[int], place: int) -> Table:
    """The records that overturn the body at the smallest factors, then those without one that are worst."""
    words, answers = cells.words, cells.answers
    pairs = [(record, lane) for record in range(len(answers.records)) for lane in own]
    factor = np.where(np.isnan(answers[answers.factor]), np.inf, answers[answers.factor])
    several = len(own) > 1
    headings = (
        Heading(words("head.record")),
        *((Heading("C", note=words("head.restitution")),) if several else ()),
        Heading("PGA [g]"),
        *cells.columns,
    )
    rows = tuple(
        (
            _by_name(cells, record),
            *((number(answers.bodies[lane].restitution, restitution),) if several else ()),
            number(float(answers["pga"][record]) / STANDARD_GRAVITY),
            *cells.of(record, lane),
        )
        for record, lane in sorted(pairs, key=lambda at: (factor[at], -cells.standing[at]))[:GOVERNING]
    )
    caption = words("caption.governing" if len(pairs) > GOVERNING else "caption.each_record")
    return Table(f"body-{place}-records", caption, headings, rows)


def _by_name(cells: AnswerCells, record: int) -> Cell:
    """A record by its earthquake, station and direction, else by its id."""
    known = Known(cells.answers.summary, record=cells.answers.records[record])
    cell = cells.record(record)
    return cell._replace(text=record_named(cells.words, known, cell.text))


def _of_record(words: Words, one: Known, event: str) -> tuple[Fact, ...]:
    known, own = one.number, one.words
    told = {"source": own("source"), "sha256": own("source_sha256")}
    if one.value("npts") >= 0:
        start, end = (known(f"intense_{side}", "s") for side in ("start", "end"))
        told |= {"earthquake": words.shared(event)}
        told |= {name: words.number(words.shared(value)) for name, value in one.stated}
        told |= {
            "component": f"{own('station')}, {words.shared(own('component'))} ({known('azimuth', '°')})",
            "station_name": own("station_name"),
            "start": own("start_time"),
            "samples": words("fact.at_interval", count=one.value("npts"), interval=words.number(known("dt", "s"))),
            "pga": acceleration(words, one.value("pga")),
            "pgv": words.number(words.shared(one.peak_velocity)),
            "arias": words.number(known("arias_intensity", "m/s")),
            "intense": words("between", low=words.number(start), high=words.number(end)),
        }
    told["sequence"] = _sequence(words, one)
    facts = [Fact(words.table.get(f"fact.{name}", words.shared(name)), (value,)) for name, value in told.items()]
    lists = {name: one.lines(name) for name in ("processing", "warnings")}
    return *facts, *(Fact(words(f"fact.{name}"), every) for name, every in lists.items() if every)


def _sequence(words: Words, one: Known) -> str:
    """The impulse sequence of a record in a line."""
    if math.isnan(one.value("main_impulse")):
        return words("fact.no_sequence")
    numbers = {
        "main": one.number("main_impulse", "m/s"),
        "secondary": one.number("secondary_impulse", "m/s"),
        "interval": one.number("secondary_interval", "s"),
        "duration": one.number("sequence_duration", "s"),
    }
    shown = {name: words.number(value) for name, value in numbers.items()}
    return words("fact.sequence_of", **shown, count=words.shared(one.main_count))


def _brief(words: Words, one: Known) -> str:
    if math.isnan(one.value("pga")):
        return f"I {words.figure(one.value('main_impulse'), 'm/s')}"
    return words.number(words.shared(", ".join(one.strength)))
