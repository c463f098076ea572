"""The first page: of every body a drawing with its verdict in a sentence, the gravest first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from markupsafe import Markup, escape

from rocking.body.outline import Outline
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.config.configuration import config_from_text
from rockpulse.errors import ResultsError
from rockpulse.views.plots.selection import block_of
from rockpulse.views.report.bodies import grade_cell
from rockpulse.views.report.statements import sentence
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.body_drawing import Support, drawing
from rockpulse.views.shared.table import Cell

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["MOST", "Card", "Drawing", "cards", "drawings"]

#: Bodies that have a card on the first page.
MOST = 6


class Drawing(NamedTuple):
    """An element `<svg>` of a body, and what holds it in words."""

    svg: Markup
    held: str


@dataclass(frozen=True)
class Card:
    """One block by its worst restitution: what holds it, the verdict and its sentence; ``key`` is its part below."""

    key: str
    name: str
    svg: Markup
    held: str
    verdict: Cell
    sentence: str


def cards(words: Words, answers: Answers, found: Sequence[BodyVerdict], drawn: Sequence[Drawing]) -> list[Card]:
    """The cards of the blocks whose verdict is worst, from worst to best."""
    worst: dict[int, BodyVerdict] = {}
    for one in sorted(found, key=_gravest):
        worst.setdefault(one.body.place, one)
    return [
        Card(f"body-{place}", one.body.block, *drawn[place], grade_cell(words, one), sentence(words, answers, one))
        for place, one in list(worst.items())[:MOST]
    ]


def _gravest(one: BodyVerdict) -> tuple[float, float, float]:
    """Sorts the worst verdict first, then the largest probability, then the smallest factor."""
    factor, value = one.margin.smallest, one.decides.value
    likely = 0.0 if math.isnan(value) else value
    return -float(one.overall), -likely, math.inf if math.isnan(factor) else factor


def drawings(words: Words, tree: xr.DataTree) -> list[Drawing]:
    """The drawing of every block of the results, on its pedestals."""
    summary = tree["summary"].to_dataset()
    below = _pedestals(str(tree.attrs.get("configuration", "")))
    names = [str(name) for name in summary["block"].values]
    alone = summary["pedestal_of"].values.tolist()
    found = []
    for place, (name, part) in enumerate(zip(names, alone, strict=True)):
        if part and part not in names:
            raise ResultsError(f"variable /summary/pedestal_of: expected the name of a body, found {part!r}")
        # A body with its first pedestal comes first, then that with the first two.
        joined = alone[: place + 1].count(part) if part else 0
        body = Outline.of(block_of(summary, part or name))
        floor = bool(summary["floors"].sel(block=part or name).item())
        support = Support(floor, below.get(part or name, ()), joined)
        held = _held(words, body, support)
        label = escape(words("drawing.label", name=name, held=f", {held}" if held else ""))
        found.append(Drawing(Markup(drawing(body, support, str(label), lambda value: words.figure(value, "m"))), held))
    return found


def _held(words: Words, body: Outline, support: Support) -> str:
    """What a body stands on and is held by, in words; empty for a free one on the ground."""
    there = {
        "wall": body.side,
        "floor": support.floor,
        "pedestal": support.pedestals,
        "tie": body.ties,
        "load": body.loads,
        "thrust": body.thrusts,
    }
    return ", ".join(words(f"drawing.{kind}") for kind, own in there.items() if own)


def _pedestals(configuration: str) -> dict[str, list[tuple[float, float]]]:
    """Widths and heights of what each body of the configuration stands on, from its foot downwards."""
    if not configuration:
        return {}
    blocks = config_from_text(configuration).blocks
    return {one.name: [(part.width, part.height) for part in one.pedestals] for one in blocks if one.pedestals}
