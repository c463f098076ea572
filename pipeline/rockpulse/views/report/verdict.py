"""Makes the verdicts in the report: a card for each body, the table of bodies, and explanations."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr
from markupsafe import Markup, escape

from rocking.body.outline import Outline
from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, OVERTURNS, BodyVerdict, Finding, Grade
from rockpulse.config.configuration import config_from_text
from rockpulse.earthquakes import CONFIDENCE
from rockpulse.errors import ResultsError
from rockpulse.model_table import is_upper_bound
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.plots.selection import block_of
from rockpulse.views.report.body_drawings import Support, body_drawing
from rockpulse.views.report.record_tables import record_named
from rockpulse.views.shared.formatting import ABSENT, ratio, share, six_digits, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell
from rockpulse.views.shared.table_columns import (
    columns,
    filled,
    grade_cell,
    headed,
    margin_cells,
    record_cells,
    unexplained,
)
from rockpulse.views.shared.verdict_table import tie_table, verdict_columns, verdict_rows
from rockpulse.views.shared.words import counted_words, in_numerals, own_name, say
from rockpulse.views.text.check import code_words

#: Largest number of rows of a table without a search field, and of bodies with a card on the first page.
FEW, MOST = 8, 6
#: Largest number of rows of the list of priorities.
PRIORITIES = 20


class Drawing(NamedTuple):
    """An `<svg>` element of a body, and the names of its supports and restraints."""

    svg: Markup
    held: str


@dataclass(frozen=True)
class Card:
    """The card of a body on the first page: drawing, verdict and sentence; ``key`` is the id of the body's section."""

    key: str
    name: str
    svg: Markup
    held: str
    verdict: Cell
    sentence: str


def cards(answers: Answers, found: Sequence[BodyVerdict], drawn: Sequence[Drawing]) -> list[Card]:
    """Return the cards of the bodies with the worst verdicts; the worst comes first."""
    worst: dict[int, BodyVerdict] = {}
    for one in sorted(found, key=by_severity):
        worst.setdefault(one.body.place, one)
    return [
        Card(f"body-{place}", one.body.block, *drawn[place], grade_cell(one.deciding), sentence(answers, one))
        for place, one in list(worst.items())[:MOST]
    ]


def by_severity(one: BodyVerdict) -> tuple[float, float, float]:
    """Return the sort key: worst verdict first, then largest probability, then smallest scale factor.

    Bodies that slide first come last, as their rocking is not assessed.
    """
    factor, value = one.deciding.margin.smallest, one.share.value
    likely = 0.0 if math.isnan(value) else value
    grade = 0.0 if one.grade == Grade.SLIDES_FIRST else one.deciding.severity
    return -grade, -likely, math.inf if math.isnan(factor) else factor


def priorities(answers: Answers, found: Sequence[BodyVerdict], checked: xr.Dataset | None = None) -> Table | None:
    """Return the table of the bodies in the order in which they need action; None without a verdict.

    A body and the same body with its pedestal are one object with the worse verdict; `checked` are the code checks.
    """
    whole = answers.summary["pedestal_of"].values.tolist() if "pedestal_of" in answers.summary else answers.blocks
    worst: dict[str, BodyVerdict] = {}
    for one in sorted(found, key=by_severity):
        worst.setdefault(whole[one.body.place] or one.body.block, one)
    if all(one.grade == Grade.NO_VERDICT for one in worst.values()) or answers.motions.kind == "sequence":
        return None
    names = ("priority", "body", "verdict", *(["code"] if checked is not None else []), "action")
    rows = []
    for place, one in enumerate(list(worst.values())[:PRIORITIES], start=1):
        code, failed = _of_codes(checked, one.body.block)
        name = Cell(one.body.block, link=f"body-{one.body.place}")
        of_codes = () if checked is None else (code,)
        action = Cell(_action(answers, one, failed))
        rows.append((number_cell(place, str), name, grade_cell(one.deciding), *of_codes, action))
    more = say("priorities.more", count=len(worst) - PRIORITIES) if len(worst) > PRIORITIES else ""
    heads = {name: say(f"head.{name}") for name in ("priority", "body", "code", "action")}
    headings = tuple(Heading(heads.get(name) or say(f"column.{name}.head")) for name in names)
    return Table("priorities", say("caption.priorities"), headings, tuple(rows), (more,) if more else ())


def _of_codes(checked: xr.Dataset | None, block: str) -> tuple[Cell, str]:
    """Return a cell (a body passes all, some or none of the code checks), and the names of the codes that it fails."""
    if checked is None or block not in checked["block"].values:
        return Cell(ABSENT), ""
    of_body = checked[["activation_ratio", "displacement_ratio"]].sel(block=block)
    ratios = np.stack([own.values for own in of_body.data_vars.values()])
    known, below = ~np.isnan(ratios), ratios < 1.0
    failed = ", ".join(code_words(str(code)) for code in checked["code"].values[below.any(axis=0)])
    if not known.any():
        return Cell(ABSENT), ""
    in_part = ("in_part", "fair") if below.sum() < known.sum() else ("fails", "bad")
    key, grade = in_part if below.any() else ("passes", "good")
    return Cell(say(f"check.{key}"), float(np.nanmin(ratios)), grade=grade), failed


def _action(answers: Answers, one: BodyVerdict, failed: str) -> str:
    """Return the recommended action for a body, as one short line; `failed` are the names of codes that it fails."""
    found, place = one.deciding, one.body.place
    known = Known(answers.summary, block=one.body.block)
    key = found.status
    if found.grade in (Grade.OVERTURNS, Grade.MAY_OVERTURN) and '"ties"' in known.text("restraints"):
        key += "_tied"
    top = _top(answers, found, place)
    if found.grade <= Grade.ROCKS and key != "no_margin":
        key = "fails_code" if failed else "keep_free" if top >= 1.0 else "none"
    fields = {"capacity": ratio(found.margin.smallest), "top": ratio(top), "count": found.earthquakes, "codes": failed}
    return say(f"action.{key}", needed=FEWEST_AT_DEMAND, **fields)


def _top(answers: Answers, found: Finding, place: int) -> float:
    """Return the largest displacement of the top of a body under records that do not overturn it [cm]."""
    turn = found.others_rotation * float(answers.summary["alpha_c"].values[place])
    return 100.0 * float(answers.summary["height"].values[place]) * math.sin(turn)


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
    """Return a sentence with the results for a body at its worst demand or, without demands, under the records."""
    found, motions = one.deciding, answers.motions
    smallest = unexplained(margin_cells(found.margin)[0]).marked
    if motions.kind == "sequence":
        margin = say("verdict.factor", factor=smallest) if not math.isnan(found.margin.smallest) else ""
        key = "overturns_under_sequence" if found.grade == Grade.OVERTURNS else "under_sequence"
        return say(f"verdict.{key}", margin=margin)
    counted = {"count": found.overturned, "motions": counted_words(found.motions, motions.kind)}
    if not found.demand:
        factor = say("verdict.smallest", factor=say(f"factor.{answers.factor}"), value=smallest)
        return say("verdict.as_recorded", **counted, factor=factor if answers.has_factor else "")
    if found.grade == Grade.SLIDES_FIRST:
        friction = float(answers.summary["friction"].values[one.body.place])
        return say("verdict.slides_first", friction=six_digits(friction))
    if found.grade == Grade.AT_REST:
        return say("verdict.not_lifted", motions=counted_words(found.motions, motions.kind), name=found.demand)
    others = ""
    if found.others_rotation > 0.0:
        top = _top(answers, found, one.body.place)
        others = say("verdict.others", rotation=ratio(found.others_rotation))
        others += "" if math.isnan(top) else say("verdict.top", top=ratio(top))
    value = ratio(found.share.value)
    return say(
        "verdict.at_demand",
        what=say("probability" if answers.probable else "share_of_earthquakes"),
        value=say("less_than", value=value[1:]) if value.startswith("<") else value,
        high=ratio(found.share.high),
        confidence=share(CONFIDENCE),
        name=found.demand,
        events=counted_words(found.earthquakes, "earthquake"),
        **counted,
        others=others,
        few=say("verdict.few", needed=FEWEST_AT_DEMAND) if found.few else "",
    )


def basis(answers: Answers, unused: str) -> str:
    """Describe what the verdicts are based on: model, records, files that were not used, and demands."""
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


def counted_by(answers: Answers) -> str:
    """Explain how the probability, or the share of records, is computed, and which values separate the verdicts."""
    model = model_words(answers.model)
    if answers.motions.kind == "sequence":
        return say("counted.sequence", model=model)
    what = say("counted.probability") if answers.probable else say("counted.share", model=model)
    levels = {"overturns": six_digits(OVERTURNS), "may": six_digits(MAY_OVERTURN), "needed": FEWEST_AT_DEMAND}
    demand = say("counted.demand", low=six_digits(FARTHEST[0]), high=six_digits(FARTHEST[1]))
    return f"{say('counted.words', what=what, **levels)} {demand}"


def model_words(model: str) -> str:
    """Return the name of a model, with a note if it is an upper bound."""
    return say("model.upper_bound" if is_upper_bound(model) else "model.name", name=say(f"models.{model}"))


def acceleration_in_words(value: float) -> str:
    """Format an acceleration [m/s2] in m/s² and in g."""
    return f"{three_digits(value, 'm/s²')} ({three_digits(value / STANDARD_GRAVITY, 'g')})"


def body_table(answers: Answers, found: Sequence[BodyVerdict], every: bool = False) -> Table:
    """Return the table of the bodies; the worst verdict comes first.

    Each body has one row, for its governing demand and restitution; with `every`, one row per demand and restitution.
    """
    ordered = sorted(found, key=by_severity)
    worst = {one.body.place: one for one in reversed(ordered)}
    rows = [(one, row) for one in ordered for row in one.findings]
    if governing := not every and len(rows) > len(worst):
        rows = [(one, one.deciding) for one in ordered if worst[one.body.place] is one]
    findings = [row for _, row in rows]
    several = any(one.body.several for one in found)
    selected = (*columns(*(["restitution"] if several else [])), *verdict_columns(answers, findings))
    values = verdict_rows(answers, rows, partial(_governing, answers, record_cells(answers.summary)))
    values["restitution"] = [one.body.restitution for one, _ in rows]
    names = [Cell(one.body.block, link=f"body-{one.body.place}") for one, _ in rows]
    cells = tuple((name, *more) for name, more in zip(names, filled(selected, values), strict=True))
    headings = (Heading(say("head.body")), *(heading._replace(note="") for heading in headed(selected)))
    judged = any(row.grade != Grade.NO_VERDICT for row in findings)
    caption = say(f"caption.{'bodies' if judged else 'no_verdict'}", motions=motions_words(answers.motions))
    notes = (say("caption.governing_case"),) if governing else ()
    return Table("verdict-cases" if every else "verdict-bodies", caption, headings, cells, notes, searched=FEW)


def ties(answers: Answers, found: Sequence[BodyVerdict]) -> Table | None:
    """Return the table of the ties; None if no body has ties."""
    return tie_table(answers, found, partial(_governing, answers, record_cells(answers.summary)))


def _governing(answers: Answers, cells: Sequence[Cell], record: int) -> Cell:
    """Return a cell with the name of a record, given by its row in /summary, and a link to its section."""
    name, known = cells[record], Known(answers.summary, record=answers.records[record])
    whole = known.direction.replace("-", "\N{NON-BREAKING HYPHEN}")  # on one line of the table
    label = record_named(known, name.text).replace(known.direction, whole)
    return unexplained(name)._replace(text=label, link=f"record-{record}")
