"""What is shown of each body and of each record."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.views.report.answers import Answers, record_table
from rockpulse.views.report.standing import Body
from rockpulse.views.report.statements import acceleration
from rockpulse.views.report.verdict import BodyVerdict
from rockpulse.views.report.verdict_rows import grade_cell
from rockpulse.views.shared.table import Cell, Fact, Heading, Table
from rockpulse.views.shared.terminal import ABSENT, figure, restitution
from rockpulse.views.text.overview import peak_velocity, value

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["BodyPage", "RecordPage", "body_pages", "record_pages"]

#: Records that are listed under a body.
GOVERNING = 10


@dataclass(frozen=True)
class BodyPage:
    """One body.

    Attributes
    ----------
    key : str
        Id in the page.
    name : str
        Name of the block.
    verdicts : tuple of Cell
        One a restitution.
    facts : tuple of Fact
        Size, parameters, warnings.
    governing : Table
        The motions that come nearest to overturning it, or beyond.
    """

    key: str
    name: str
    verdicts: tuple[Cell, ...]
    facts: tuple[Fact, ...]
    governing: Table


@dataclass(frozen=True)
class RecordPage:
    """One record.

    Attributes
    ----------
    key : str
        Id in the page.
    name : str
        Its id in the results, marked where its peak is doubtful.
    place : int
        Row of /summary.
    brief : str
        Its strength in a few words.
    worst : Cell
        How the worst body stands under it.
    facts : tuple of Fact
        What is known of it.
    bodies : Table
        Every body under it.
    """

    key: str
    name: str
    place: int
    brief: str
    worst: Cell
    facts: tuple[Fact, ...]
    bodies: Table


def body_pages(answers: Answers, found: list[BodyVerdict]) -> list[BodyPage]:
    """A page for every block, its restitutions together.

    Parameters
    ----------
    answers : Answers
        The cells.
    found : list of BodyVerdict
        Of the same bodies.
    """
    summary = answers.summary
    pages = []
    for place, block in enumerate(str(name) for name in summary["block"].values):
        own = [lane for lane, body in enumerate(answers.bodies) if body.place == place]
        pages.append(
            BodyPage(
                key=f"body-{place}",
                name=block,
                verdicts=tuple(grade_cell(found[lane], answers.model, _case(answers.bodies[lane])) for lane in own),
                facts=_of_block(summary, block, [answers.bodies[lane].restitution for lane in own]),
                governing=_governing(answers, own, place),
            )
        )
    return pages


def record_pages(answers: Answers, events: list[str]) -> list[RecordPage]:
    """A page for every record.

    Parameters
    ----------
    answers : Answers
        The cells.
    events : list of str
        Earthquake of each record.
    """
    summary = answers.summary
    pages = []
    for place, record in enumerate(str(name) for name in summary["record"].values):
        lane = int(np.argmax(answers.standing[place])) if answers.bodies else -1
        worst = answers.verdict(place, lane) if answers.bodies else Cell(ABSENT)
        pages.append(
            RecordPage(
                key=f"record-{place}",
                name=answers.names[place],
                place=place,
                brief=_brief(summary, record),
                worst=Cell(f"worst: {worst.text}", worst.value, grade=worst.grade),
                facts=_of_record(summary, record, events[place]),
                bodies=record_table(answers, place),
            )
        )
    return pages


def _case(body: Body) -> str:
    return f"C = {restitution(body.restitution)}: " if body.several else ""


def _of_block(summary: xr.Dataset, block: str, restitutions: list[float]) -> tuple[Fact, ...]:
    def known(name: str, unit: str) -> str:
        found = value(summary, name, block=block)
        return ABSENT if found is None else figure(float(found), unit)

    by_p = math.isnan(value(summary, "width", block=block))
    warnings = dict.fromkeys(str(text) for text in np.ravel(summary["block_warnings"].sel(block=block).values))
    size = "given by p and α" if by_p else f"{known('width', 'm')} × {known('height', 'm')}"
    facts = [
        Fact("width × height", (size,)),
        Fact("half the diagonal R", (known("radius", "m") + (" (of the rectangle with this p)" if by_p else ""),)),
        Fact("critical angle α_c", (known("alpha_c", "rad"),)),
        Fact("frequency parameter p", (known("p", "1/s"),)),
        Fact("slenderness h/b", (known("slenderness", ""),)),
        Fact("restitution C (velocity ratio)", (", ".join(map(restitution, restitutions)),)),
        Fact("critical impulse I_1c", (known("critical_impulse", "m/s"),)),
    ]
    if lines := _lines("\n".join(warnings)):
        facts.append(Fact("warnings", lines))
    return tuple(facts)


def _governing(answers: Answers, own: list[int], place: int) -> Table:
    """The records that overturn the body at the smallest factors, then those without one that are worst."""
    summary = answers.summary
    pairs = [(record, lane) for record in range(summary.sizes["record"]) for lane in own]

    def order(pair: tuple[int, int]) -> tuple[float, float]:
        factor = answers.factor(*pair).value
        known = math.inf if factor is None or math.isnan(factor) else factor
        return known, -float(answers.standing[pair])

    headings = (
        Heading("record"),
        *((Heading("C", note="restitution"),) if len(own) > 1 else ()),
        Heading("PGA [g]"),
        Heading("a/a_up", note="PGA over uplift"),
        Heading("peak", note=f"θ_max/α_c, {answers.model}"),
        Heading("SF", note="safety factor"),
        Heading("verdict", note=answers.model),
    )
    rows = []
    for record, lane in sorted(pairs, key=order)[:GOVERNING]:
        c = answers.bodies[lane].restitution
        strength = float(summary["pga"].values[record]) / _gravity()
        rows.append(
            (
                Cell(answers.names[record], link=f"record-{record}"),
                *((Cell(restitution(c), c),) if len(own) > 1 else ()),
                Cell(figure(strength), strength),
                answers.demand("uplift_ratio", record, lane),
                answers.answer(answers.model, record, lane),
                answers.factor(record, lane),
                answers.verdict(record, lane),
            )
        )
    caption = "The records of smallest safety factor" if len(pairs) > GOVERNING else "The body under each record"
    return Table(f"body-{place}-records", caption, headings, tuple(rows))


def _of_record(summary: xr.Dataset, record: str, event: str) -> tuple[Fact, ...]:
    def known(name: str, unit: str) -> str:
        found = value(summary, name, record=record)
        return ABSENT if found is None else figure(float(found), unit)

    def words(name: str) -> str:
        return str(value(summary, name, record=record) or ABSENT)

    pga, count = (value(summary, name, record=record) for name in ("pga", "main_count"))
    limited = "as many as fit into the duration" if count == -1 else str(count)
    samples = value(summary, "npts", record=record)
    azimuth = known("azimuth", "°")
    facts = [Fact("source", (words("source"),)), Fact("SHA-256 of the source", (words("source_sha256"),))]
    if samples is None or samples >= 0:
        facts += [
            Fact("earthquake", (event,)),
            Fact("station, component", (f"{words('station')}, {words('component')} (azimuth {azimuth})",)),
            Fact("name of the station", (words("station_name"),)),
            Fact("start (UTC)", (words("start_time"),)),
            Fact("samples", (f"{samples} at {known('dt', 's')}",)),
            Fact("PGA", (acceleration(pga),)),
            Fact("PGV", (peak_velocity(summary, record),)),
            Fact("Arias intensity", (known("arias_intensity", "m/s"),)),
            Fact("intense phase", (f"{known('intense_start', 's')} to {known('intense_end', 's')}",)),
        ]
    sequence = "none could be made"
    if not math.isnan(value(summary, "main_impulse", record=record)):
        sequence = (
            f"I = {known('main_impulse', 'm/s')}, I_s = {known('secondary_impulse', 'm/s')}, ΔT = "
            f"{known('secondary_interval', 's')}, duration {known('sequence_duration', 's')}, main impulses: {limited}"
        )
    facts.append(Fact("impulse sequence", (sequence,)))
    for name in ("processing", "warnings"):
        if lines := _lines(words(name).removeprefix(ABSENT)):
            facts.append(Fact(name, lines))
    return tuple(facts)


def _brief(summary: xr.Dataset, record: str) -> str:
    pga: Any = value(summary, "pga", record=record)
    if math.isnan(pga):
        return f"I {figure(value(summary, 'main_impulse', record=record), 'm/s')}"
    return f"PGA {figure(pga / _gravity(), 'g')}, PGV {peak_velocity(summary, record)}"


def _lines(joined: str) -> tuple[str, ...]:
    return tuple(line for line in joined.split("\n") if line)


def _gravity() -> float:
    from rockpulse.record.record import STANDARD_GRAVITY

    return STANDARD_GRAVITY
