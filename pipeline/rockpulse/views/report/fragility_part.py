"""What the report says of fragility curves."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.views.report.pairing import Paired, listed
from rockpulse.views.shared.table import Cell, Heading, Table
from rockpulse.views.shared.terminal import ABSENT, ratio, several

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FragilityPart", "describe_fragility", "shown_measure"]

#: The measure that the curves are shown in, where it is there: it puts bodies of all sizes on one scale.
SHOWN = "velocity_ratio"

_DATA = {
    "ida": "every record scaled until it first reaches the limit state",
    "stripes": "records scaled to given levels",
    "cloud": "records as they are",
}


@dataclass(frozen=True)
class FragilityPart:
    """The section on fragility.

    Attributes
    ----------
    remarks : tuple of str
        What keeps the curves from standing beside the verdict as they are; shown loudly.
    statements : tuple of str
        What the curves rest on.
    banded : bool
        Whether a confidence band could be given anywhere.
    blocks : tuple of str
        Names of the bodies.
    tables : tuple of Table
        Medians and dispersions; remarks.
    """

    remarks: tuple[str, ...]
    statements: tuple[str, ...]
    banded: bool
    blocks: tuple[str, ...]
    tables: tuple[Table, ...]


def shown_measure(curves: xr.Dataset) -> str:
    """The intensity measure that is shown.

    Parameters
    ----------
    curves : xarray.Dataset
        The node /fragility.
    """
    measures = [str(name) for name in curves["measure"].values]
    return SHOWN if SHOWN in measures else measures[0]


def describe_fragility(of: Paired, assessed: int, model: str) -> FragilityPart:
    """The section on fragility.

    Parameters
    ----------
    of : Paired
        A fragility file, beside the results.
    assessed : int
        Records of the assessment; 0 where a design sequence stands for them.
    model : str
        The model of the verdict.
    """
    tree = of.tree
    curves, capacities = tree["fragility"].to_dataset(), tree["capacities"].to_dataset()
    measure = shown_measure(curves)
    own = curves.sel(measure=measure)
    banded = bool(own["median_low"].notnull().any())
    events = len(set(capacities["event"].values.tolist()))
    words, units = (str(own[name].item()) for name in ("measure_long_name", "measure_units"))
    data = str(tree.attrs["data"])
    unit = "" if units == "1" else f" [{units}]"
    common = (
        "the verdict is of a design sequence" if not assessed else f"{of.same} of them among the {assessed} assessed"
    )
    statements = [
        f"From {several(capacities.sizes['record'], 'record')} of {several(events, 'earthquake')} ({common}); "
        f"{_DATA.get(data, data)}. Intensity measure: {words}{unit}.",
    ]
    if data == "ida":
        statements.append(
            "Capacity is the first factor that reaches the limit state; above it a body may stand again, so the "
            "curve is the probability of reaching the limit state at or below a level."
        )
    table = _remarks(own)
    tables = (_medians(own, float(tree.attrs["confidence"])), *((table,) if table.rows else ()))
    blocks = tuple(str(name) for name in own["block"].values)
    return FragilityPart(tuple(_differences(of, assessed, model)), tuple(statements), banded, blocks, tables)


def _differences(of: Paired, assessed: int, model: str) -> list[str]:
    """What the curves and the verdict do not have in common."""
    said = of.other_motions("The curves are", assessed)
    equation = tomllib.loads(str(of.tree.attrs.get("configuration", ""))).get("fragility", {}).get("equation", model)
    if equation != model and model not in ("auto", "resonance", "sequence"):
        said.append(f"The curves are by the {equation} equation of motion, the verdict is by the {model} model.")
    if of.missing:
        said.append(f"Without curves, for the fragility file lacks them: {listed(of.missing)}.")
    if of.foreign:
        said.append(f"Left out, for they are not among the bodies assessed here: the curves of {listed(of.foreign)}.")
    return said


def _medians(own: xr.Dataset, confidence: float) -> Table:
    headings = (
        Heading("body"),
        Heading("limit state"),
        Heading("median"),
        Heading("low", note=f"{confidence:.0%}"),
        Heading("high", note=f"{confidence:.0%}"),
        Heading("β", note="of ln capacity"),
        Heading("reached", note="of the observations"),
        Heading("records"),
        Heading("earthquakes"),
    )
    rows = []
    for block in own["block"].values:
        for state in own["limit_state"].values:
            one = own.sel(block=block, limit_state=state)
            values = [float(one[name]) for name in ("median", "median_low", "median_high", "beta")]
            beyond = "!" if int(one["extrapolated"]) else ""
            counts = [int(one[name]) for name in ("reached", "observations", "records", "events")]
            rows.append(
                (
                    Cell(str(block)),
                    Cell(_state(str(state))),
                    Cell(ratio(values[0]) + (beyond if not math.isnan(values[0]) else ""), values[0]),
                    *(Cell(ratio(found), found) for found in values[1:]),
                    Cell(f"{counts[0]} of {counts[1]}", float(counts[0])),
                    *(Cell(str(count), float(count)) for count in counts[2:]),
                )
            )
    beyond = " !: extrapolated beyond every level looked at." if any("!" in row[2].text for row in rows) else ""
    caption = f"Median and dispersion; limits over earthquakes ({ABSENT}: not known, see the remarks).{beyond}"
    return Table("fragility-medians", caption, headings, tuple(rows))


def _state(name: str) -> str:
    """A limit state in words: its name, or the rotation that it is."""
    return name if name.isalpha() else f"θ_max/α_c ≥ {name}"


def _remarks(own: xr.Dataset) -> Table:
    rows = []
    for block in own["block"].values:
        found: dict[str, list[str]] = {}
        for state in own["limit_state"].values:
            said = str(own["statement"].sel(block=block, limit_state=state).item())
            if said:
                found.setdefault(said, []).append(_state(str(state)))
        rows += [(Cell(str(block)), Cell(", ".join(states)), Cell(said)) for said, states in found.items()]
    headings = (Heading("body"), Heading("limit states"), Heading("remark"))
    return Table("fragility-remarks", "Remarks on the curves", headings, tuple(rows))
