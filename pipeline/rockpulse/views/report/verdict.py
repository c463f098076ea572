"""Makes the verdicts in the report: a card for each body, the table of bodies, and their explanations."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import xarray as xr
from markupsafe import Markup, escape

from rocking.body.outline import Outline
from rockpulse.assessment.answers import Answers, Motions, Share
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, Grade
from rockpulse.config.configuration import config_from_text
from rockpulse.earthquakes import CONFIDENCE
from rockpulse.errors import ResultsError
from rockpulse.model_table import is_upper_bound
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.selection.events import UNKNOWN
from rockpulse.views.plots.selection import block_of
from rockpulse.views.report.body_drawings import Support, body_drawing
from rockpulse.views.report.record_tables import record_named
from rockpulse.views.shared.formatting import ABSENT, ratio, share, six_digits, three_digits
from rockpulse.views.shared.notes import factor_heading
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell
from rockpulse.views.shared.table_columns import COLUMNS, GRADES, grade_cell, margin_cells, record_cells, unexplained
from rockpulse.views.shared.words import counted_words, in_numerals, own_name, say

#: Separator between the ends of an interval, which allows no line break.
TO = "\N{WORD JOINER}–\N{WORD JOINER}"
#: Largest number of rows of a table without a search field, and of bodies with a card on the first page.
FEW, MOST = 8, 6


class Drawing(NamedTuple):
    """An `<svg>` element of a body, and the names of its supports and restraints."""

    svg: Markup
    held: str


@dataclass(frozen=True)
class Card:
    """The card of a body on the first page: drawing, restraints, verdict and sentence; ``key`` is a section id."""

    key: str
    name: str
    svg: Markup
    held: str
    verdict: Cell
    sentence: str


def cards(answers: Answers, found: Sequence[BodyVerdict], drawn: Sequence[Drawing]) -> list[Card]:
    """Return the cards of the bodies with the worst verdicts, the worst first."""
    worst: dict[int, BodyVerdict] = {}
    for one in sorted(found, key=_by_severity):
        worst.setdefault(one.body.place, one)
    return [
        Card(f"body-{place}", one.body.block, *drawn[place], grade_cell(one), sentence(answers, one))
        for place, one in list(worst.items())[:MOST]
    ]


def _by_severity(one: BodyVerdict) -> tuple[float, float, float]:
    """Return a sort key that puts the worst verdict, largest probability and smallest scale factor first."""
    factor, value = one.margin.smallest, one.decides.value
    likely = 0.0 if math.isnan(value) else value
    return -float(one.overall), -likely, math.inf if math.isnan(factor) else factor


def body_drawings(tree: xr.DataTree) -> list[Drawing]:
    """Return a drawing of every body with its supports and restraints."""
    summary, configuration = tree["summary"].to_dataset(), str(tree.attrs.get("configuration", ""))
    blocks = config_from_text(configuration).bodies if configuration else ()
    sizes = {one.name: [(part.width, part.height) for part in one.pedestals] for one in blocks if one.pedestals}
    below = sizes | {own_name(name): own for name, own in sizes.items()}
    names = [str(name) for name in summary["block"].values]
    alone = summary["pedestal_of"].values.tolist() if "pedestal_of" in summary else [""] * len(names)
    found = []
    for place, (name, part) in enumerate(zip(names, alone, strict=True)):
        if part and part not in names:
            raise ResultsError(f"variable /summary/pedestal_of: expected the name of a body, found {part!r}")
        # First the body with its first pedestal, then with the first two.
        joined = alone[: place + 1].count(part) if part else 0
        body = Outline.of(block_of(summary, part or name))
        floor = "floors" in summary and bool(summary["floors"].sel(block=part or name).item())
        support = Support(floor, below.get(part or name, ()), joined)
        holds = {"wall": body.side, "floor": support.floor, "pedestal": support.pedestals, "tie": body.ties}
        holds |= {"load": body.loads, "thrust": body.thrusts}
        held = ", ".join(say(f"drawing.{kind}") for kind, own in holds.items() if own)
        label = str(escape(say("drawing.label", name=name, held=f", {held}" if held else "")))
        found.append(Drawing(Markup(body_drawing(body, support, label, lambda value: three_digits(value, "m"))), held))
    return found


def sentence(answers: Answers, one: BodyVerdict) -> str:
    """Return the verdict on a body as a sentence."""
    if answers.motions.kind == "sequence":
        factor = margin_cells(one.margin)[0].marked
        margin = say("verdict.factor", factor=factor) if not math.isnan(one.margin.smallest) else ""
        key = "overturns_under_sequence" if one.overall == Grade.OVERTURNS else "under_sequence"
        return say(f"verdict.{key}", margin=margin)
    if one.overall == Grade.AT_REST:
        return say("verdict.not_lifted", motions=motions_words(answers.motions))
    what = say("probability" if answers.probable else "share_of_earthquakes")
    demand = one.deciding
    if demand is None:
        under = say("verdict.as_recorded", motions=motions_words(answers.motions))
    else:
        lost = say("verdict.left_out", motions=counted_words(demand.left_out, "motion")) if demand.left_out else ""
        under = (
            say("verdict.at_demand", name=demand.name, events=counted_words(demand.earthquakes, "earthquake")) + lost
        )
        under += say("verdict.few", needed=FEWEST_AT_DEMAND) if demand.few else ""
    value = ratio(one.decides.value)
    value = say("less_than", value=value[1:]) if value.startswith("<") else value
    fields = {"what": what, "value": value, "high": ratio(one.decides.high)}
    return say("verdict.probability", under=under, confidence=share(CONFIDENCE), **fields)


def basis(answers: Answers, unused: str) -> str:
    """Describe what the verdicts are based on: model, records, unused files and demands."""
    fields = {"model": model_words(answers.model), "motions": motions_words(answers.motions)}
    said = [say("basis", files=f"; {unused}" if unused else "", **fields)]
    for name, demand in answers.demands.items():
        strength = in_numerals(demand.words.replace("m/s2", "m/s²"))
        if demand.words.startswith("PGA "):
            strength += f" ({three_digits(demand.value / STANDARD_GRAVITY, 'g')})"
        strength = say("demand_selection") if math.isnan(demand.value) else strength
        said.append(say("demand", name=name, strength=", ".join(filter(None, (strength, demand.limit_state)))))
    return " ".join(said)


def motions_words(motions: Motions) -> str:
    """Return the numbers of records and earthquakes as text."""
    if motions.kind == "sequence":
        return say("motions.sequence")
    key = f"motions.{motions.kind}{'_mean' if motions.kind == 'pair' and motions.any_azimuth else ''}"
    each = {"motions": counted_words(len(motions.names), motions.kind), "directions": motions.index.shape[1]}
    return say(key, events=counted_words(motions.event_count, "earthquake"), **each)


def figures_legend(answers: Answers) -> str:
    """Explain the numbers in the table of bodies on one line."""
    if answers.motions.kind == "sequence":
        return say("legend.sequence")
    what = say("legend.probability" if answers.probable else "legend.share")
    return say("legend.words", what=what, factor=say(f"legend.{answers.factor}"), **_levels())


def counted_by(answers: Answers) -> str:
    """Explain how probability or share are computed, and which values separate the verdicts."""
    model = model_words(answers.model)
    if answers.motions.kind == "sequence":
        return say("counted.sequence", model=model)
    what = say("counted.probability") if answers.probable else say("counted.share", model=model)
    counted = say("counted.words", what=what, **_levels())
    if answers.demands:
        counted += " " + say("counted.demand", low=six_digits(FARTHEST[0]), high=six_digits(FARTHEST[1]))
    return counted


def _levels() -> dict[str, str]:
    """Return the limits of probability at which the verdict changes, as text."""
    return {"overturns": six_digits(OVERTURNS), "may": six_digits(MAY_OVERTURN)}


def of_unknown_event(motions: Motions) -> str:
    """Describe how records of unknown earthquakes are counted; empty if all earthquakes are known."""
    count = motions.events.count(UNKNOWN)
    if not count:
        return ""
    key = "unknown_event.as_one" if count == len(motions.events) else "unknown_event.not_counted"
    return say(key, motions=counted_words(count, "motion"))


def model_words(model: str) -> str:
    """Return the name of a model, with a note if it is an upper bound."""
    return say("model.upper_bound" if is_upper_bound(model) else "model.name", name=say(f"models.{model}"))


def acceleration_in_words(value: float) -> str:
    """Format an acceleration [m/s2] in m/s² and in g."""
    return f"{three_digits(value, 'm/s²')} ({three_digits(value / STANDARD_GRAVITY, 'g')})"


def body_table(answers: Answers, found: Sequence[BodyVerdict]) -> Table:
    """Return the table of verdicts: one row for each body, with probability, scale factors and governing record."""
    motions, factor = answers.motions, factor_heading(answers.factor)
    c = COLUMNS["restitution"]
    of = say("head.probability" if answers.probable else "head.share")
    by_sequence = motions.kind == "sequence"  # there is only one
    of_motions = "" if by_sequence else say("head.of", motions=counted_words(len(motions.names), motions.kind))
    columns: list[tuple[Heading, Callable[[BodyVerdict], Cell]]] = [
        (Heading(say("head.body")), lambda one: Cell(one.body.block, link=f"body-{one.body.place}")),
        (c.heading._replace(note=""), lambda one: c.cell(one.body.restitution)),
        (COLUMNS["verdict"].heading._replace(note=say("model.name", name=say(f"models.{answers.model}"))), grade_cell),
        *(
            (Heading(say("head.at", what=of, name=name), note=say("head.interval")), partial(_at_demand, place))
            for place, name in enumerate(answers.demands)
        ),
        (Heading(say("head.as_recorded", what=of), note=say("head.interval")), lambda one: _share_cell(one.share)),
        (Heading(say("head.smallest", factor=factor)), lambda one: unexplained(margin_cells(one.margin)[0])),
        (Heading(say("head.under")), lambda one: _governing(answers, one)),
        (Heading(say("head.median", factor=factor)), lambda one: unexplained(margin_cells(one.margin)[1])),
        (Heading(say("head.overturned"), note=of_motions), lambda one: number_cell(one.overturned, str)),
        (Heading(say("head.unknown")), lambda one: number_cell(one.share.unknown, str)),
        (Heading(say("head.not_lifted")), lambda one: number_cell(one.at_rest, str)),
    ]
    if by_sequence:
        columns = [*columns[:3], columns[len(answers.demands) + 4]]
    if not any(one.body.several for one in found):
        del columns[1]
    rows = tuple(tuple(cell(one) for _, cell in columns) for one in found)
    caption = say("caption.bodies", motions=motions_words(motions))
    return Table("verdict-bodies", caption, tuple(heading for heading, _ in columns), rows, searched=FEW)


def _at_demand(place: int, one: BodyVerdict) -> Cell:
    demand = one.demands[place]
    return _share_cell(demand.share, GRADES[demand.grade])


def _governing(answers: Answers, one: BodyVerdict) -> Cell:
    """Return a cell with the record that overturns the body at the smallest scale factor."""
    if one.governing < 0 or math.isinf(one.margin.smallest):
        return Cell(ABSENT)
    name = record_cells(answers.summary)[one.governing]
    description = record_named(Known(answers.summary, record=answers.records[one.governing]), name.text)
    return unexplained(name)._replace(text=description, link=f"record-{one.governing}")


def _share_cell(value: Share, grade: str = "") -> Cell:
    low, high = ratio(value.low), ratio(value.high)
    text = f"{ratio(value.value)} ({low if low == high == ABSENT else f'{low}{TO}{high}'})"
    return Cell(text, value.value, grade=grade)
