"""A fragility file as text: medians, dispersions and bands of every body, and which measure serves best."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.events import UNKNOWN
from rockpulse.views.shared.terminal import ABSENT, aligned, paragraph, ratio, shortened

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fragility_overview"]

#: Longest name of a body in a table.
NAME_WIDTH = 30

#: The measure that the curves are shown in, where it is there: it puts bodies of all sizes on one scale.
SHOWN = "velocity_ratio"

#: Marks a median that no record was looked at.
BEYOND = "!"

#: Level of the tests of sufficiency.
LEVEL = 0.05


def fragility_overview(tree: xr.DataTree) -> str:
    """What a fragility file says, on a screen or two.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.fragility_curves` returns it.
    """
    curves = tree["fragility"].to_dataset()
    efficiency = tree["efficiency"].to_dataset()
    capacities = tree["capacities"].to_dataset()
    events = np.unique(capacities["event"].values).size
    measures = [str(name) for name in curves["measure"].values]
    shown = SHOWN if SHOWN in measures else measures[0]
    found = [
        _several(capacities.sizes["record"], "record", "records")
        + " of "
        + _several(events, "earthquake", "earthquakes")
        + (" (records of unknown earthquake count as one)" if UNKNOWN in capacities["event"].values else ""),
        _several(curves.sizes["block"], "body", "bodies"),
        f"data: {tree.attrs['data']}",
    ]
    parts = [
        f"{tree.attrs['title']}: {', '.join(found)}",
        _medians(curves, shown, float(tree.attrs["confidence"]), str(tree.attrs["data"])),
        _pooled(curves, efficiency),
        _sufficiency(efficiency),
        _statements(curves),
    ]
    return "\n\n".join(part for part in parts if part)


def _medians(curves: xr.Dataset, measure: str, confidence: float, data: str) -> str:
    states = [str(state) for state in curves["limit_state"].values]
    own = curves.sel(measure=measure)
    rows = [["", *states]]
    for block in own["block"].values:
        cells, bands = [], []
        for state in states:
            one = own.sel(block=block, limit_state=state)
            median, beta = float(one["median"]), float(one["beta"])
            mark = BEYOND if one["extrapolated"].item() else ""
            cells.append(ABSENT if math.isnan(median) else f"{ratio(median)}{mark}, {ratio(beta)}")
            low, high = float(one["median_low"]), float(one["median_high"])
            bands.append("" if math.isnan(low) else f"{ratio(low)}..{ratio(high)}")
        rows.append([shortened(str(block), NAME_WIDTH), *cells])
        if any(bands):
            rows.append(["", *bands])
    words, units = (str(own[name].values) for name in ("measure_long_name", "measure_units"))
    unit = "" if units == "1" else f" [{units}]"
    note = (
        f"Median and dispersion beta of {words}{unit} at which a limit state is reached (uplift, theta_max/alpha_c, "
        "overturning)"
    )
    if bool(own["median_low"].notnull().any()):
        note += f"; below them the {100.0 * confidence:g} % band of the median, over earthquakes"
    note += f". {ABSENT}: see the remarks."
    if bool(own["extrapolated"].any()):
        note += f" {BEYOND}: beyond every level looked at, extrapolated."
    if data == "ida":
        note += (
            " Capacity is the first factor that reaches the limit state; above it a block may stand again, so these "
            'medians lie below those of data = "stripes".'
        )
    return "\n".join([*aligned(rows, gap="   "), "", paragraph(note, "  ")])


def _pooled(curves: xr.Dataset, efficiency: xr.Dataset) -> str:
    """Dispersion of all bodies together, the smallest of each limit state marked."""
    beta = efficiency["pooled_beta"]
    kept = [str(name) for name in beta["measure"].values if np.any(np.isfinite(beta.sel(measure=name)))]
    if len(kept) < 2:
        return ""
    table = beta.sel(measure=kept).transpose("measure", "limit_state").values
    smallest = np.min(np.where(np.isnan(table), np.inf, table), axis=0)
    last = str(beta["limit_state"].values[-1])
    compared = [efficiency[f"pooled_beta_ratio{end}"].sel(limit_state=last) for end in ("", "_low", "_high")]
    rows = [["", *(f"{state} " for state in beta["limit_state"].values), f"{last}, ratio"]]
    for name, line in zip(kept, table, strict=True):
        marks = (f"{ratio(value)}{'*' if value == best else ' '}" for value, best in zip(line, smallest, strict=True))
        value, low, high = (float(limit.sel(measure=name)) for limit in compared)
        band = ratio(value) if math.isnan(low) else f"{ratio(value)} ({ratio(low)}..{ratio(high)})"
        rows.append([name, *marks, band])
    words = [f"{name}: {curves['measure_long_name'].sel(measure=name).values}" for name in kept]
    head = f"Efficiency: dispersion beta of capacity, all bodies together (*: smallest), and over that in {SHOWN}"
    if bool(compared[1].sel(measure=kept).notnull().any()):
        head += " with its band"
    return "\n".join([head, *aligned(rows), "", *(paragraph(line, "      ", "  ") for line in words)])


def _sufficiency(efficiency: xr.Dataset) -> str:
    p_value = efficiency["pooled_p_value"].transpose("measure", "quality", "limit_state")
    tests = int(np.count_nonzero(np.isfinite(p_value)))
    if tests == 0:
        return ""
    rows = [["", *(str(quality) for quality in p_value["quality"].values)]]
    for name, own in zip(p_value["measure"].values, p_value.values, strict=True):
        if np.any(np.isfinite(own)):
            counts = (f"{np.count_nonzero(found < LEVEL)} of {np.count_nonzero(np.isfinite(found))}" for found in own)
            rows.append([str(name), *counts])
    head = (
        "Sufficiency: limit states in which capacity depends on a quality of the record beside the measure "
        f"(p-value below {LEVEL:g}), all bodies together"
    )
    note = (
        f"{tests} tests: about {LEVEL * tests:.0f} of them would say so by chance. strength: the measure of the record "
        "before it was scaled; duration: of the intense phase; period: 2 pi PGV/PGA; strong_half_waves: above half the "
        "largest."
    )
    return "\n".join([head, *aligned(rows), "", paragraph(note, "  ")])


def _statements(curves: xr.Dataset) -> str:
    """Every different remark once, with how often it is made."""
    found: dict[str, list[str]] = {}
    for place in np.ndindex(curves["statement"].shape):
        text = str(curves["statement"].values[place])
        if text:
            dims = curves["statement"].dims
            labels = [str(curves[dim].values[index]) for dim, index in zip(dims, place, strict=True)]
            found.setdefault(_kind(text), []).append(f"{', '.join(labels)}: {text}")
    if not found:
        return ""
    lines = ["remarks"]
    for entries in found.values():
        more = "" if len(entries) == 1 else f" (and {len(entries) - 1} more like it)"
        lines.append(paragraph(entries[0] + more, "      ", "  "))
    return "\n".join(lines)


def _kind(text: str) -> str:
    """The remark without its numbers."""
    return re.sub(r"\d\S*", "#", text)


def _several(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"
