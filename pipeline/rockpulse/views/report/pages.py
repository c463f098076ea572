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
from rockpulse.views.report.statements import acceleration
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, figure, restitution

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
                verdicts=tuple(grade_cell(found[lane], _case(answers.bodies[lane])) for lane in own),
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
        worst = Cell(ABSENT)
        if answers.bodies:
            worst = cells.verdict(place, cells.worst(place))
        one = Known(answers.summary, record=record)
        pages.append(
            RecordPage(
                key=f"record-{place}",
                name=cells.names[place].marked,
                place=place,
                words=one.described,
                brief=_brief(one),
                worst=worst._replace(text=f"worst: {'P ' if answers.probable else ''}{worst.text}"),
                facts=_of_record(one, str(event)),
                bodies=record_table(cells, place),
            )
        )
    return pages


def _case(body: Body) -> str:
    return f"C = {restitution(body.restitution)}: " if body.several else ""


def _of_block(answers: Answers, block: str, restitutions: list[float]) -> tuple[Fact, ...]:
    one = Known(answers.summary, block=block)
    known = one.number
    size = "given by p and α" if math.isnan(one.value("width")) else f"{known('width', 'm')} × {known('height', 'm')}"
    facts = [
        Fact("width × height", (size,)),
        Fact("half the diagonal R", (one.radius,)),
        Fact("critical angle α_c", (known("alpha_c", "rad"),)),
        Fact("frequency parameter p", (known("p", "1/s"),)),
        Fact("slenderness h/b", (known("slenderness"),)),
        Fact(
            "rebound e from the wall" if one.value("one_sided") else "restitution C (velocity ratio)",
            (", ".join(map(restitution, restitutions)),),
        ),
        Fact("critical impulse I_1c", (known("critical_impulse", "m/s"),)),
    ]
    if one.support:
        facts.insert(1, Fact("beside", (one.support,)))
    if warnings := one.lines("block_warnings"):
        facts.append(Fact("warnings", warnings))
    return tuple(facts)


def _governing(cells: AnswerCells, own: list[int], place: int) -> Table:
    """The records that overturn the body at the smallest factors, then those without one that are worst."""
    answers = cells.answers
    pairs = [(record, lane) for record in range(len(answers.records)) for lane in own]
    factor = np.where(np.isnan(answers[answers.factor]), np.inf, answers[answers.factor])
    several = len(own) > 1
    headings = (
        Heading("record"),
        *((Heading("C", note="restitution"),) if several else ()),
        Heading("PGA [g]"),
        Heading("a/a_up", note="PGA over uplift"),
        Heading("peak", note=f"θ_max/α_c, {answers.model}"),
        *cells.headings,
    )
    rows = tuple(
        (
            cells.record(record),
            *((number(answers.bodies[lane].restitution, restitution),) if several else ()),
            number(float(answers["pga"][record]) / STANDARD_GRAVITY),
            cells.demand("uplift_ratio", record, lane),
            cells.answer(record, lane),
            cells.verdict(record, lane),
            cells.factor(record, lane),
        )
        for record, lane in sorted(pairs, key=lambda at: (factor[at], -cells.standing[at]))[:GOVERNING]
    )
    caption = "The records of smallest safety factor" if len(pairs) > GOVERNING else "The body under each record"
    return Table(f"body-{place}-records", caption, headings, rows)


def _of_record(one: Known, event: str) -> tuple[Fact, ...]:
    known, words = one.number, one.words
    facts = [Fact("source", (words("source"),)), Fact("SHA-256 of the source", (words("source_sha256"),))]
    if one.value("npts") >= 0:
        component = f"{words('station')}, {words('component')} (azimuth {known('azimuth', '°')})"
        facts += [
            Fact("earthquake", (event,)),
            *(Fact(name, (told,)) for name, told in one.stated),
            Fact("station, component", (component,)),
            Fact("name of the station", (words("station_name"),)),
            Fact("start (UTC)", (words("start_time"),)),
            Fact("samples", (f"{one.value('npts')} at {known('dt', 's')}",)),
            Fact("PGA", (acceleration(one.value("pga")),)),
            Fact("PGV", (one.peak_velocity,)),
            Fact("Arias intensity", (known("arias_intensity", "m/s"),)),
            Fact("intense phase", (f"{known('intense_start', 's')} to {known('intense_end', 's')}",)),
        ]
    sequence = "none could be made"
    if not math.isnan(one.value("main_impulse")):
        sequence = (
            f"I = {known('main_impulse', 'm/s')}, I_s = {known('secondary_impulse', 'm/s')}, ΔT = "
            f"{known('secondary_interval', 's')}, duration {known('sequence_duration', 's')}, main impulses: "
            f"{one.main_count}"
        )
    facts.append(Fact("impulse sequence", (sequence,)))
    facts += [Fact(name, one.lines(name)) for name in ("processing", "warnings") if one.lines(name)]
    return tuple(facts)


def _brief(one: Known) -> str:
    if math.isnan(one.value("pga")):
        return f"I {figure(one.value('main_impulse'), 'm/s')}"
    return ", ".join(one.strength)
