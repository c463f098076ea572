"""The design of a site by its overturning spectrum as tables: effective impulses, then sequences of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import between, ratio, restitution, share

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ONE_NUMBER", "design_table", "sequence_table", "spectrum_table"]

#: What no calibration on overturnings can tell, in one line.
ONE_NUMBER = (
    "I, I_s/I and the number cannot be told apart: every sequence of one I_eff overturns the same. These are one."
)

#: Restitution of the blocks of the table of the spectrum, and the step of its rows along p.
SHOWN_RESTITUTION, STEP = 0.9, 3


def design_table(site: xr.Dataset) -> Table:
    """What the design asks of every body, in effective impulses and as a factor."""
    quantile, confidence = (f"{100.0 * float(site[name]):g} %" for name in ("quantile", "confidence"))
    headings = (
        Heading("body", width=34),
        Heading("C", note="restitution"),
        Heading("I_eff", "m/s", f"effective impulse of the design, the {quantile} quantile over earthquakes"),
        Heading(f"{confidence} interval"),
        Heading("overturns at", "m/s", "g tan(alpha)/p"),
        Heading("factor", note="on the design, at which the body overturns"),
        Heading("overturned by", note="share of the weight of the records"),
    )
    speed = site["design_factor"] * site["effective_impulse"]
    rows = []
    for place, name in enumerate(site["block"].values.tolist()):
        one = site.isel(block=place)
        factor, effect = float(one["design_factor"]), float(one["effective_impulse"])
        if np.isnan(effect):
            continue
        low, high = (float(one[f"effective_impulse_{end}"]) for end in ("lower", "upper"))
        rows.append(
            (
                Cell(str(name)),
                number(float(one["restitution"]), restitution),
                number(effect),
                Cell(between(low, high)),
                number(float(speed[place])),
                Cell(f"{ratio(factor)} overturns", factor, grade="bad") if factor <= 1.0 else number(factor, ratio),
                number(float(one["overturned_share"]), share),
            )
        )
    return Table("site-design", "The design", headings, tuple(rows))


def sequence_table(site: xr.Dataset) -> Table:
    """The sequence that stands for the design on every body, which is one of many of the same effect."""
    headings = (
        Heading("body", width=34),
        Heading("I", "m/s", "main impulse, I_s/I and number kept"),
        Heading("interval of I"),
        Heading("I_s/I", note="of the half-waves, median over records"),
        Heading("interval of I_s/I"),
        Heading("number", note="of main impulses, likewise"),
        Heading("its interval"),
    )
    rows = []
    for place, name in enumerate(site["block"].values.tolist()):
        one = site.isel(block=place)
        cells = [Cell(str(name))]
        for key in ("main", "ratio", "main_count"):
            low, high = (float(one[f"{key}_{end}"]) for end in ("lower", "upper"))
            cells += [number(float(one[key])), Cell(between(low, high))]
        if not np.isnan(float(one["main"])):
            rows.append(tuple(cells))
    caption = 'A sequence of that effect, spacing "continuous"'
    return Table("site-sequence", caption, headings, tuple(rows), (ONE_NUMBER,))


def spectrum_table(spectra: xr.Dataset, site: xr.Dataset) -> Table:
    """The quantiles of the spectrum over p at one restitution, where there are no bodies to read it for."""
    at = spectra.sel(restitution=SHOWN_RESTITUTION, method="nearest")
    quantile, confidence = (f"{100.0 * float(site[name]):g} %" for name in ("quantile", "confidence"))
    columns = {"spectrum_50": "median", "spectrum_84": "84 %", "spectrum_design": quantile}
    shown = {title: key for key, title in columns.items()}  # of a quantile that is stated anyway the one of the design
    headings = (
        Heading("p", "1/s"),
        *(Heading(title, "m/s", "the design" if key == "spectrum_design" else "") for title, key in shown.items()),
        Heading(f"{confidence} interval"),
        Heading("I_s/I", note="of the half-waves, median over records"),
        Heading("number", note="of main impulses, likewise"),
    )
    rows = []
    for place in range(0, at.sizes["p"], STEP):
        one = at.isel(p=place)
        low, high = (float(one[f"spectrum_design_{end}"]) for end in ("lower", "upper"))
        numbers = [number(float(one[key])) for key in ("p", *shown.values(), "ratio", "main_count")]
        rows.append((*numbers[:-2], Cell(between(low, high)), *numbers[-2:]))
    caption = (
        f"Effective impulse I_eff of blocks with C = {float(at['restitution']):g}; a body overturns at g tan(alpha)/p"
    )
    return Table("site-spectrum", caption, headings, tuple(rows))
