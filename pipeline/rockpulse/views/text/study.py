"""A study as text: the curves, half-cycles or rates as a table, and the verdict on each statement."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.response import Outcome
from rockpulse.storage.study_variables import VERDICTS
from rockpulse.views.shared.table import Cell, Heading, Mark, Table, number, text
from rockpulse.views.shared.terminal import ABSENT, figure, paragraph, ratio

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["study_overview"]

#: Largest number of lines and columns of numbers in a table.
_LINES, _COLUMNS = 11, 10

#: From this factor on a table says that an input without end gives more.
MORE = 1.01

#: The mark of a peak that an input without end exceeds.
ENDLESS = Mark("*", f"*: an input without end gives more, by over {MORE - 1.0:.0%}")

#: The mark of a case that is no result.
NO_MOTION = Mark("!", "!: no motion of a block (through the ground, or a peak beyond alpha_c)")


def study_overview(tree: xr.DataTree) -> str:
    """A study, as :mod:`rockpulse.study` or the checks of codes give it, as text for the terminal."""
    parts = [tree.attrs["title"]]
    if "figure4" in tree:
        parts += _curves(tree["figure4"].to_dataset())
    if "figure5" in tree:
        parts += _histories(tree["figure5"].to_dataset())
    if "intervals" in tree:
        parts.append(paragraph(tree["intervals"].attrs["comment"]))
    if "rates" in tree:
        parts.append(_rates(tree["rates"].to_dataset()))
    return "\n\n".join([*parts, _statements(tree["statements"].to_dataset())])


def _curves(curves: xr.Dataset) -> list[str]:
    """A table for each restitution: the largest n, the first spacing and the first p."""
    count = float(curves["intermediate_count"].max())
    shown = curves.sel(intermediate_count=count).isel(p=0, spacing=0)
    shown = _thinned(_thinned(shown, "secondary_ratio", _LINES), "impulse_ratio", _COLUMNS)
    place = "n -> infinity" if np.isinf(count) else f"n = {count:g}, {shown['spacing'].item()}"
    parts = [paragraph(curves.attrs["comment"])]
    for c in curves["restitution"].values:
        peaks = shown.sel(restitution=c)
        rows = []
        for share in shown["secondary_ratio"].values:
            line = peaks.sel(secondary_ratio=share)
            cells = (_peak(line.isel(impulse_ratio=k)) for k in range(line.sizes["impulse_ratio"]))
            rows.append((Cell(f"{share:.3g}"), *cells))
        headings = ("I_s/I", *(f"I/I_1c {value:.4g}" for value in shown["impulse_ratio"].values))
        title = f"theta_max/alpha_c, C = {c:g}, {place}, p = {figure(shown['p'].item(), '1/s')}"
        note = "(4): overturns in half-cycle 4."
        parts.append(text(Table("", title, tuple(map(Heading, headings)), tuple(rows), (note,))))
    return parts


def _peak(case: xr.Dataset) -> Cell:
    peak, endless = case["peak_rotation_ratio"].item(), case["endless_peak_rotation_ratio"].item()
    if case["outcome"].item() == Outcome.OVERTURNS:
        return Cell(f"({case['overturning_half_cycle'].item()})", peak)
    mark = (NO_MOTION,) if case["no_motion"].item() else (ENDLESS,) if endless > MORE * peak else ()
    return number(peak, ratio, mark)


def _histories(histories: xr.Dataset) -> list[str]:
    """Impulses of the blocks, then a line for each block, restitution and ratio with all spacings."""
    blocks = []
    for name in histories["block"].values:
        block = histories.sel(block=name)
        impulses = ", ".join(
            f"{figure(block['main_impulse'].sel(restitution=c).item(), 'm/s')} (C = {c:g})"
            for c in histories["restitution"].values
        )
        blocks.append(
            paragraph(
                f"R = {figure(block['radius'].item(), 'm')}, slenderness {figure(block['slenderness'].item())}, "
                f"p = {figure(block['p'].item(), '1/s')}, I_1c = {figure(block['critical_impulse'].item(), 'm/s')}, "
                f"I = I_2c = {impulses}; double impulse V_c = {figure(block['double_impulse'].item(), 'm/s')}, t_0 = "
                f"{figure(block['double_impulse_time'].item(), 's')} with Housner's "
                f"C = {block['housner_restitution'].item():.3f}",
                "         ",
                f"block {name}: ",
            )
        )
    stacked = histories.stack(case=("block", "restitution", "secondary_ratio"))
    rows = []
    for k, (name, c, share) in enumerate(stacked["case"].values.tolist()):
        case = stacked.isel(case=k)
        cells = (_ending(case.isel(spacing=i)) for i in range(case.sizes["spacing"]))
        rows.append((Cell(str(name)), Cell(f"{c:g}"), Cell(f"{share:g}"), *cells))
    headings = tuple(map(Heading, ("block", "C", "I_s/I", *map(str, histories["spacing"].values))))
    notes = (
        "(4) 3.1 s: overturns in half-cycle 4, which starts then. 14: 0.65: 14 half-cycles, largest theta/alpha_c.",
    )
    table = Table("", histories.attrs["comment"], headings, tuple(rows), notes)
    return ["\n".join(blocks), text(table)]


def _ending(case: xr.Dataset) -> Cell:
    mark = (NO_MOTION,) if case["no_motion"].item() else ()
    peak = case["peak_rotation_ratio"].item()
    if case["outcome"].item() == Outcome.OVERTURNS:
        half_cycle, time = case["overturning_half_cycle"].item(), case["overturning_time"].item()
        return Cell(f"({half_cycle}) {time:.2f} s", peak, mark)
    return Cell(f"{case['half_cycle_count'].item()}: {ratio(peak)}", peak, mark)


def _rates(rates: xr.Dataset) -> str:
    """A line for each factor and check."""
    rows = []
    for k in range(rates.sizes["rate"]):
        one = {str(name): rates[name].values[k].item() for name in rates.variables}
        shares = (_share(*(one[f"{share}_{end}"] for end in ("share", "low", "high"))) for share in ("missed", "false"))
        factor = "all" if np.isnan(one["factor"]) else f"{one['factor']:g}"
        overturned = f"{one['overturned']} of {one['overturned'] + one['standing']}"
        rows.append((Cell(one["check"]), Cell(factor), Cell(overturned), *(Cell(words) for words in shares)))
    notes = (
        "missed: of the cases that overturn (P of 0.5 or more) those that pass; false: of those that stand those that "
        "fail; in brackets intervals of 90 % over earthquakes.",
    )
    headings = tuple(map(Heading, ("check", "factor", "overturn", "missed", "false")))
    return text(Table("", "Checks at factors on the records", headings, tuple(rows), notes))


def _share(value: float, low: float, high: float) -> str:
    if np.isnan(value):
        return ABSENT
    return f"{value:.1%}" + ("" if np.isnan(low) else f" ({low:.1%} to {high:.1%})")


def _statements(statements: xr.Dataset) -> str:
    lines = ["Statements:"]
    for k in range(statements.sizes["statement"]):
        row = {str(name): statements[name].values[k].item() for name in statements.variables}
        verdict = VERDICTS[row["verdict"]].replace("_", " ")
        lines.append(f"  {verdict.upper() if verdict == 'fails' else verdict}: {row['statement']}")
        lines.append(paragraph(f'"{row["words"]}"', "      "))
        details = [f"holds where: {row['where']}"] if verdict == "holds in part" and row["where"] else []
        lines += [paragraph(words, "      ") for words in (*details, row["numbers"]) if words]
    return "\n".join(lines)


def _thinned(curves: xr.Dataset, dim: str, most: int) -> xr.Dataset:
    size = curves.sizes[dim]
    places = np.unique(np.round(np.linspace(0, size - 1, min(size, most))).astype(int))
    return curves.isel({dim: places})
