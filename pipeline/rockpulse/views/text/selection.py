"""A selection of records as text and as a table."""

import pandas as pd
import xarray as xr

from rockpulse.selection.events import UNKNOWN
from rockpulse.views.shared.formatting import paragraph, several, three_digits
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell, table_text
from rockpulse.views.shared.words import counted_words


def selection_overview(tree: xr.DataTree) -> str:
    """Return the tree of :func:`rockpulse.select` as text: the records, and the deviations of their mean spectrum."""
    found = tree["selection"].to_dataset()
    fit, events = found.attrs, found["event"].values
    below, above = fit["tolerance"]
    pairs = fit["components"] == "pairs"
    records = several(found.sizes["record"] // (2 if pairs else 1), "pair" if pairs else "record")
    headings = (Heading("record"), Heading("scale factor"), Heading("earthquake"))
    rows = zip(found["record"].values, found["factor"].values, events, strict=True)
    table = Table(
        "selection",
        f"{tree.attrs['title']}: {records} of {fit['candidates']}, "
        f"{counted_words(len(set(events.tolist())), 'earthquake')}; target: {fit['target']}",
        headings,
        tuple((Cell(str(name)), number_cell(float(factor)), Cell(str(event))) for name, factor, event in rows),
    )
    periods = found["period"].values
    deviations = (
        f"Mean spectrum from {three_digits(periods[0])} to {three_digits(periods[-1])} s, deviation from the target: "
        f"{_percent(fit['lowest'])} to {_percent(fit['highest'])}, mean {_percent(fit['mean_deviation'])}, mean of "
        f"the absolute values {_percent(fit['mean_absolute_deviation'], '')}; "
        f"{'within' if fit['compatible'] else 'NOT WITHIN'} the tolerance of {_percent(-below)} to {_percent(above)}"
    )
    unknown = "Some records state no earthquake; they are counted as one." if UNKNOWN in events else ""
    return "\n\n".join(filter(None, (table_text(table), paragraph(deviations), unknown)))


def selection_table(tree: xr.DataTree) -> pd.DataFrame:
    """Return the columns record, factor and event, as read by `selection` in [fragility] and [[demand]]."""
    return tree["selection"].to_dataset()[["factor", "event"]].to_dataframe().reset_index()


def _percent(value: float, sign: str = "+") -> str:
    return f"{100.0 * value:{sign}.1f} %"
