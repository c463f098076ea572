"""The overview of an assessment as text: one screen with the verdict on the bodies, or everything."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rockpulse.assessment.answers import answers_of
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.terminal import paragraph, several
from rockpulse.views.text.capacity import smallest_capacities
from rockpulse.views.text.directions import direction_table
from rockpulse.views.text.large_overview import hints, is_large, large_overview
from rockpulse.views.text.left_out import left_out, left_out_in_short, unused
from rockpulse.views.text.verdicts import body_verdicts, governing, overturned, verdict_table, worst_motions

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["headline", "overview"]


#: Bodies and motions that one screen holds.
BODIES, MOTIONS = 12, 10


def overview(tree: xr.DataTree, whole: bool = False) -> str:
    """One screen: the verdict on every body, the worst motions, how much was left out.

    The `whole` adds every model's verdict for every record and block, what overturns and why the rest was left out; of
    a sweep over direction the median and largest instead. Of more verdicts than can be shown one by one that is counts
    and the worst. Values that are not yet read from a file are read as far as they are shown.
    """
    head, files = headline(tree), files_used(tree).line
    answers = answers_of(tree)
    if not whole and answers.motions.kind != "sequence":
        more = "All of it, every record, body and model: rockpulse inspect RESULTS --all"
        bodies = body_verdicts(answers, BODIES if len(answers.bodies) > BODIES else None)
        parts = [head, unused(files), bodies, worst_motions(answers, MOTIONS), left_out_in_short(tree), more]
        return "\n\n".join(filter(None, parts))
    directions = tree["directions"].to_dataset() if "directions" in tree.children else None
    if is_large(answers):
        parts = [head, unused(files), large_overview(answers, directions), left_out(tree, brief=True), hints()]
        return "\n\n".join(filter(None, parts))
    summary = answers.summary.load()  # all of it is shown: read at once, not value by value
    if directions is None:
        shown = [verdict_table(summary), body_verdicts(answers), overturned(answers, files)]
    else:
        shown = [direction_table(summary, directions.load()), body_verdicts(answers), unused(files)]
    parts = [head, *shown, governing(answers), smallest_capacities(answers), left_out(tree)]
    return "\n\n".join(part for part in parts if part)


def headline(tree: xr.DataTree) -> str:
    """The subject of the results: title, description, how many records, blocks and models."""
    node = tree["directions" if "directions" in tree.children else "summary"]
    dims = ("pair", "direction", "block") if "directions" in tree.children else ("record", "block")
    counts = ", ".join(several(node.sizes[dim], dim) for dim in dims)
    models = ", ".join(map(str, tree["summary"].to_dataset()["model"].values))
    lines = [paragraph(f"{tree.attrs.get('title', '')}: {counts}; {models}")]
    if described := str(tree.attrs.get("site_description", "")):
        lines.append(paragraph(described, "  "))
    return "\n".join(lines)
