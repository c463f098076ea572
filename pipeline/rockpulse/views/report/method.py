"""The method, the assumptions and the limits of the numbers; the same in every report but for what was used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rockpulse.config.configuration import stored_sections
from rockpulse.model_table import MODELS
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.table import Fact

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["REFERENCE", "assumptions", "models_in_use", "not_covered"]

REFERENCE = (
    "C. Casapulla, A. Maione (2017), Rocking resonance conditions of large and slender rigid blocks under the "
    "intense phase of an earthquake, COMPDYN 2017, doi:10.7712/120117.5612.17190"
)

_ASSUMPTIONS = ("body", "impact", "motion", "uplift", "strength")
_NOT_COVERED = ("sliding", "flexible", "walls", "floors", "space", "soil", "hazard")


def models_in_use(words: Words, summary: xr.Dataset, judging: str) -> tuple[Fact, ...]:
    """The models of /summary with what each is; `judging` is the one that the verdict counts."""
    facts = []
    for name in map(str, summary["model"].values):
        shown = words.shared(name)
        head = words("method.judging", model=shown) if name == judging else shown
        facts.append(Fact(head, (words.shared(MODELS[name].words) if name in MODELS else "",)))
    return tuple(facts)


def assumptions(words: Words, tree: xr.DataTree) -> tuple[Fact, ...]:
    """The assumptions behind the numbers, those on vertical acceleration and filters as the results tell them."""
    facts = [_fact(words, f"assumption.{name}") for name in _ASSUMPTIONS]
    summary = tree["summary"].to_dataset()
    acted = int((summary["vertical_channel"] != "").sum())
    vertical = words("assumption.vertical.acts", count=acted, total=summary.sizes["record"])
    facts.append(Fact(words("assumption.vertical.head"), (vertical if acted else words("assumption.vertical.none"),)))
    section = stored_sections(str(tree.attrs.get("configuration", ""))).get("conditioning", {})
    filters = [f"{name} = {section[name]}" for name in ("highpass_hz", "lowpass_hz") if name in section]
    if filters:
        told = words("assumption.filters.text", filters=", ".join(filters))
        facts.append(Fact(words("assumption.filters.head"), (told,)))
    return tuple(facts)


def not_covered(words: Words) -> tuple[Fact, ...]:
    """Things of which the verdict says nothing."""
    return tuple(_fact(words, f"not_covered.{name}") for name in _NOT_COVERED)


def _fact(words: Words, key: str) -> Fact:
    return Fact(words(f"{key}.head"), (words(f"{key}.text"),))
