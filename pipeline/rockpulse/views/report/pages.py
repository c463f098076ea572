"""The pages of a report on each body and on each record."""

import math
from dataclasses import dataclass

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.record.measures import PGA
from rockpulse.views.report.answers import AnswerCells, record_table
from rockpulse.views.report.records import event_name, record_named, record_words
from rockpulse.views.report.verdict import acceleration
from rockpulse.views.shared.columns import columns, grade_cell, headed
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table
from rockpulse.views.shared.terminal import ABSENT, figure, restitution
from rockpulse.views.shared.words import say

#: Records that are listed under a body.
GOVERNING = 10


@dataclass(frozen=True)
class BodyPage:
    """One block: a verdict for each restitution, and the records that come nearest to overturning it, or beyond."""

    key: str
    name: str
    verdicts: tuple[Cell, ...]
    facts: tuple[Fact, ...]
    governing: Table


@dataclass(frozen=True)
class RecordPage:
    """One record, a row of /summary: its facts, the worst answer, and every body under it."""

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
        cases = [f"C = {restitution(answers.bodies[lane].restitution)}: " if len(own) > 1 else "" for lane in own]
        pages.append(
            BodyPage(
                key=f"body-{place}",
                name=block,
                verdicts=tuple(grade_cell(found[lane], case) for lane, case in zip(own, cases, strict=True)),
                facts=_of_block(answers, block, [answers.bodies[lane].restitution for lane in own]),
                governing=_governing(cells, own, place),
            )
        )
    return pages


def record_pages(cells: AnswerCells) -> list[RecordPage]:
    """A page for every record."""
    answers = cells.answers
    pages = []
    for place, (record, event) in enumerate(zip(answers.records, answers["event"], strict=True)):
        worst = cells.verdict(place, cells.worst(place)) if answers.bodies else Cell(ABSENT)
        one = Known(answers.summary, record=record)
        impulse = f"I {figure(one.value('main_impulse'), 'm/s')}"
        brief = impulse if math.isnan(one.value(PGA)) else ", ".join(one.strength)
        pages.append(
            RecordPage(
                key=f"record-{place}",
                name=cells.names[place].marked,
                place=place,
                words=", ".join(filter(None, (record_words(one), one.magnitude))),
                brief=brief,
                worst=worst._replace(text=say("worst", answer=f"{'P ' if answers.probable else ''}{worst.text}")),
                facts=_of_record(one, str(event)),
                bodies=record_table(cells, place),
            )
        )
    return pages


def _of_block(answers: Answers, block: str, restitutions: list[float]) -> tuple[Fact, ...]:
    one = Known(answers.summary, block=block)
    known = one.number
    size = f"{known('width', 'm')} × {known('height', 'm')}"
    facts = {
        "size": say("fact.by_numbers") if math.isnan(one.value("width")) else size,
        "beside": one.support,
        "radius": one.radius,
        "alpha_c": known("alpha_c", "rad"),
        "p": known("p", "1/s"),
        "slenderness": known("slenderness"),
        "rebound" if one.value("one_sided") else "restitution": ", ".join(map(restitution, restitutions)),
        "critical_impulse": known("critical_impulse", "m/s"),
    }
    lists = {name: (value,) for name, value in facts.items() if value} | {"warnings": one.lines("block_warnings")}
    return tuple(Fact(say(f"fact.{name}"), lines) for name, lines in lists.items() if lines)


def _governing(cells: AnswerCells, own: list[int], place: int) -> Table:
    """The records that overturn the body at the smallest factors, then those without one that are worst."""
    answers = cells.answers
    pairs = [(record, lane) for record in range(len(answers.records)) for lane in own]
    factor = np.where(np.isnan(answers[answers.factor]), np.inf, answers[answers.factor])
    order = sorted(pairs, key=lambda at: (factor[at], -cells.standing[at]))[:GOVERNING]
    selected = columns(*(["restitution"] if len(own) > 1 else []), PGA)
    shown = cells.cells(selected, *zip(*order, strict=True)) if order else []
    rows = tuple((_by_name(cells, at[0]), *told, *cells.of(*at)) for at, told in zip(order, shown, strict=True))
    headings = (Heading(say("head.record")), *headed(selected), *cells.short)
    caption = say("caption.governing" if len(pairs) > GOVERNING else "caption.each_record")
    return Table(f"body-{place}-records", caption, headings, rows)


def _by_name(cells: AnswerCells, record: int) -> Cell:
    """A record by its earthquake, station and direction, else by its id."""
    known, cell = Known(cells.answers.summary, record=cells.answers.records[record]), cells.record(record)
    return cell._replace(text=record_named(known, cell.text))


def _of_record(one: Known, event: str) -> tuple[Fact, ...]:
    known, own = one.number, one.words
    names = {name: say(f"fact.{name}") for name in ("source", "sha256")}
    told = {names["source"]: own("source"), names["sha256"]: own("source_sha256")}
    if one.value("npts") >= 0:
        start, end = (known(f"intense_{side}", "s") for side in ("start", "end"))
        facts = {
            "component": f"{own('station')}, {one.component} ({known('azimuth', '°')})",
            "station_name": own("station_name"),
            "start": own("start_time"),
            "samples": say("fact.at_interval", count=one.value("npts"), interval=known("dt", "s")),
            "pga": acceleration(one.value(PGA)),
            "pgv": one.peak_velocity,
            "arias": known("arias_intensity", "m/s"),
            "intense": say("between", low=start, high=end),
        }
        told |= {say("fact.earthquake"): event_name(event), **dict(one.stated)}
        told |= {say(f"fact.{name}"): value for name, value in facts.items()}
    told[say("fact.sequence")] = _sequence(one)
    lists = {name: one.lines(name) for name in ("processing", "warnings")}
    return (
        *(Fact(name, (value,)) for name, value in told.items()),
        *(Fact(say(f"fact.{name}"), every) for name, every in lists.items() if every),
    )


def _sequence(one: Known) -> str:
    """The impulse sequence of a record in a line."""
    if math.isnan(one.value("main_impulse")):
        return say("fact.no_sequence")
    return say(
        "fact.sequence_of",
        main=one.number("main_impulse", "m/s"),
        secondary=one.number("secondary_impulse", "m/s"),
        interval=one.number("secondary_interval", "s"),
        duration=one.number("sequence_duration", "s"),
        count=one.main_count,
    )
