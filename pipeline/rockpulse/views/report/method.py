"""The method, the assumptions and the limits of the numbers; the same in every report but for what was used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rockpulse.config.configuration import stored_sections
from rockpulse.ladder import MODELS
from rockpulse.views.shared.table import Fact

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["REFERENCE", "assumptions", "models_in_use", "not_covered"]

REFERENCE = (
    "C. Casapulla, A. Maione (2017), Rocking resonance conditions of large and slender rigid blocks under the "
    "intense phase of an earthquake, COMPDYN 2017, doi:10.7712/120117.5612.17190 (Eqs. 5 and 9 with their index "
    "corrected)"
)

_ASSUMPTIONS = (
    (
        "The body",
        "one symmetric rigid block that stands free on a rigid level base and rocks in that plane about its two "
        "lower edges. Given by its size, or by p and α_c where it is no rectangle.",
    ),
    (
        "Impact",
        "instantaneous, without bouncing; it leaves the fraction C of the rotation speed. Unless given, C is the most "
        "that angular momentum allows: Housner's 1 − 1.5 sin²α_c, or 1 − 2 (p²R/g) sin²α_c for a body whose R is "
        "given with p and α_c. C of real masonry scatters.",
    ),
    (
        "Ground motion",
        "the accelerogram as conditioned, straight between its samples, at the foot of the body. After its end the "
        "ground is at rest, and the motion is followed until rest or overturning is certain.",
    ),
    (
        "Uplift",
        "where the ground acceleration exceeds g tan α_c. Overturning is the fall to the ground, not the passing of "
        "α_c alone.",
    ),
    (
        "Strength",
        "a factor scales the whole motion; its frequencies and duration stay. Where a body overturns is no single edge "
        "but many narrow bands of factors: hence a probability under the uncertainty of body and motion.",
    ),
)

_NOT_COVERED = (
    (
        "Sliding",
        "friction is taken as sufficient, and compared with a given one only; a body on a smooth or sloping base may "
        "slide before it rocks, or fall off.",
    ),
    (
        "Flexible bodies",
        "and weak ones: bending, cracking, crushing of the edges, separation of leaves. A masonry wall that is not "
        "of one piece does not rock as a rigid block.",
    ),
    (
        "Walls, ties and thrusts that were not given",
        "façades that lean on floors or cross walls rock to one side only, and bounce on what is behind them; ties, "
        "anchors and thrusts of vaults act too. What was given stands at its body, all others are free.",
    ),
    (
        "Floors that were not given",
        "the motion is that of the record, or of the floor that stands at its body: a parapet, a gable or equipment on "
        "a floor is shaken by the floor, more strongly and near the building's own frequencies.",
    ),
    (
        "Three-dimensional rocking",
        "rolling on a corner, twisting, and the two horizontal components acting together; each direction is taken "
        "by itself.",
    ),
    ("Soil and foundation", "compliance of the ground, tilting and uplift of a foundation, damage by earlier shocks."),
    (
        "Seismic hazard",
        "how likely such ground motions are at the site. The records are those that were given; the verdict holds "
        "for them.",
    ),
)


def models_in_use(summary: xr.Dataset, judging: str) -> tuple[Fact, ...]:
    """The models of /summary with what each is; `judging` is the one that the verdict counts."""
    facts = []
    for name in map(str, summary["model"].values):
        head = f"{name} (the verdict is this model's)" if name == judging else name
        facts.append(Fact(head, (MODELS[name].words if name in MODELS else "",)))
    return tuple(facts)


def assumptions(tree: xr.DataTree) -> tuple[Fact, ...]:
    """The assumptions behind the numbers, those on vertical acceleration and filters as the results tell them."""
    facts = [Fact(head, (words,)) for head, words in _ASSUMPTIONS]
    summary = tree["summary"].to_dataset()
    acted = int((summary["vertical_channel"] != "").sum())
    vertical = (
        f"acts on {acted} of {summary.sizes['record']} records (nonlinear model)." if acted else "is not applied."
    )
    facts.append(Fact("Vertical acceleration", (vertical,)))
    section = stored_sections(str(tree.attrs.get("configuration", ""))).get("conditioning", {})
    filters = [f"{name} = {section[name]}" for name in ("highpass_hz", "lowpass_hz") if name in section]
    if filters:
        facts.append(
            Fact("Filters", (f"{', '.join(filters)}: a band-pass takes from the impulses of near-fault motions.",))
        )
    return tuple(facts)


def not_covered() -> tuple[Fact, ...]:
    """Things of which the verdict says nothing."""
    return tuple(Fact(head, (words,)) for head, words in _NOT_COVERED)
