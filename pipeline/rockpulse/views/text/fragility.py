"""A fragility file as text: medians, dispersions and bands of every body, and which measure serves best."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.motions.events import UNKNOWN
from rockpulse.record.measures import REFERENCE
from rockpulse.storage.variables.fragility import STATED, STRENGTH
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Mark, Table, number, text
from rockpulse.views.shared.terminal import ABSENT, paragraph, ratio, several
from rockpulse.views.text.left_out import unused
from rockpulse.views.text.site import explained

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fragility_overview", "median_table", "records_words", "shown_measure", "state_words", "sufficiency_tables"]

#: At a median that no record was looked at.
BEYOND = Mark("!", "!: beyond every level looked at, extrapolated.")

#: At the smallest dispersion of a limit state.
SMALLEST = Mark("*", "*: smallest.")

#: Level of the tests of sufficiency.
LEVEL = 0.05


def fragility_overview(tree: xr.DataTree) -> str:
    """The tree of :func:`rockpulse.fragility_curves` as text, on a screen or two."""
    curves, efficiency = tree["fragility"].to_dataset(), tree["efficiency"].to_dataset()
    found = [records_words(tree), several(curves.sizes["block"], "body"), f"data: {tree.attrs['data']}"]
    parts = [
        f"{tree.attrs['title']}: {', '.join(found)}",
        unused(files_used(tree).line),
        explained(median_table(tree)),
        _pooled(curves, efficiency),
        *map(text, sufficiency_tables(efficiency)),
        _statements(curves),
    ]
    return "\n\n".join(part for part in parts if part)


def shown_measure(curves: xr.Dataset) -> str:
    """The intensity measure that is shown, of the node /fragility."""
    measures = [str(name) for name in curves["measure"].values]
    return REFERENCE if REFERENCE in measures else measures[0]


def records_words(tree: xr.DataTree) -> str:
    """The numbers of records and of earthquakes that the curves rest on."""
    event = tree["capacities"].to_dataset()["event"].values
    counts = f"{several(event.size, 'record')} of {several(np.unique(event).size, 'earthquake')}"
    return counts + (" (records of unknown earthquake count as one)" if UNKNOWN in event else "")


def state_words(name: str) -> str:
    """The name of a limit state, or the rotation that it is.

    Examples
    --------
    >>> state_words("uplift"), state_words("0.4")
    ('uplift', 'θ_max/α_c ≥ 0.4')
    """
    return name if name.isalpha() else f"θ_max/α_c ≥ {name}"


def median_table(tree: xr.DataTree) -> Table:
    """Median and dispersion of every body and limit state in the measure that is shown."""
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=shown_measure(curves))
    level = f"{100.0 * float(tree.attrs['confidence']):g} %"
    rows = []
    for block in own["block"].values.tolist():
        for state in own["limit_state"].values.tolist():
            one = own.sel(block=block, limit_state=state)
            median, low, high, beta = (float(one[name]) for name in ("median", "median_low", "median_high", "beta"))
            reached, of, records, events = (int(one[name]) for name in ("reached", "observations", "records", "events"))
            rows.append(
                (
                    Cell(block),
                    Cell(state_words(state)),
                    number(median, ratio, (BEYOND,) if int(one["extrapolated"]) else ()),
                    number(low, ratio),
                    number(high, lambda limit: "no limit" if math.isinf(limit) else ratio(limit)),
                    number(beta, ratio),
                    Cell(f"{reached} of {of}", reached),
                    number(records, str),
                    number(events, str),
                )
            )
    note = f"low, high: limits of the median, over earthquakes ({ABSENT}: not known, see the remarks)."
    if tree.attrs["data"] == "ida":
        note += (
            " Capacity is the first factor that reaches the limit state; above it a block may stand again: a curve is "
            "the probability of reaching the limit state at or below a level, and these medians lie below those of "
            'data = "stripes".'
        )
    words, units = (str(own[name].item()) for name in ("measure_long_name", "measure_units"))
    measure = words if units == "1" else f"{words} [{units}]"
    caption = f"Median and dispersion of {measure} at which a limit state is reached"
    headings = (
        Heading("body", width=30),
        Heading("limit state"),
        Heading("median"),
        *(Heading(end, note=level) for end in ("low", "high")),
        Heading("beta", note="of ln capacity"),
        Heading("reached", note="of the observations"),
        Heading("records"),
        Heading("earthquakes"),
    )
    return Table("fragility-medians", caption, headings, tuple(rows), (note,))


def _pooled(curves: xr.Dataset, efficiency: xr.Dataset) -> str:
    """Dispersion of all bodies together, the smallest of each limit state marked."""
    beta = efficiency["pooled_beta"]
    kept = [str(name) for name in beta["measure"].values if np.any(np.isfinite(beta.sel(measure=name)))]
    if len(kept) < 2:
        return ""
    table = beta.sel(measure=kept).transpose("measure", "limit_state").values
    smallest = np.min(np.where(np.isnan(table), np.inf, table), axis=0)
    states = [str(state) for state in beta["limit_state"].values]
    compared = [efficiency[f"pooled_beta_ratio{end}"].sel(limit_state=states[-1]) for end in ("", "_low", "_high")]
    rows = []
    for name, line in zip(kept, table, strict=True):
        cells = [number(x, ratio, (SMALLEST,) if x == best else ()) for x, best in zip(line, smallest, strict=True)]
        value, low, high = (float(limit.sel(measure=name)) for limit in compared)
        band = ratio(value) if math.isnan(low) else f"{ratio(value)} ({ratio(low)}..{ratio(high)})"
        rows.append((Cell(name), *cells, Cell(band, value)))
    headings = tuple(map(Heading, ("", *states, f"{states[-1]}, ratio")))
    head = f"Efficiency: dispersion beta of capacity, all bodies together, and over that in {REFERENCE}"
    if bool(compared[1].sel(measure=kept).notnull().any()):
        head += " with its band"
    words = [f"{name}: {curves['measure_long_name'].sel(measure=name).values}" for name in kept]
    return text(Table("", head, headings, tuple(rows), tuple(words)))


def sufficiency_tables(efficiency: xr.Dataset) -> list[Table]:
    """The number of cases in which the capacity depends on a quality of the record beside the measure.

    One table, with a column for every quality that was tested; none where nothing was.
    """
    p_value = efficiency["pooled_p_value"].transpose("measure", "quality", "limit_state")
    tested = np.isfinite(p_value.values)
    tests = int(np.count_nonzero(tested))
    if tests == 0:
        return []
    shown = np.flatnonzero(tested.any(axis=(0, 2)) | [name not in STATED for name in p_value["quality"].values])
    rows = []
    for name, own in zip(p_value["measure"].values.tolist(), p_value.values[:, shown], strict=True):
        if np.any(np.isfinite(own)):
            counts = [(int(np.sum(found < LEVEL)), int(np.sum(np.isfinite(found)))) for found in own]
            rows.append((Cell(name), *(Cell(f"{few} of {every}", few) for few, every in counts)))
    headings = tuple(map(Heading, ("", *p_value["quality"].values[shown].tolist())))
    head = (
        "Sufficiency: limit states in which capacity depends on a quality of the record beside the measure "
        f"(p-value below {LEVEL:g}), all bodies together"
    )
    note = (
        f"{tests} tests: about {LEVEL * tests:.0f} of them would say so by chance. strength: the measure of the record "
        "before it was scaled; duration: of the intense phase; period: 2 pi PGV/PGA; strong_half_waves: above half the "
        "largest."
    )
    return [Table("fragility-sufficiency", head, headings, tuple(rows), (note, *_told_by(efficiency, p_value)))]


def _told_by(efficiency: xr.Dataset, p_value: xr.DataArray) -> list[str]:
    """A sentence for every quality that files of some records state: by how many, and whether they are enough."""
    total = int(efficiency["quality_records"].sel(quality=STRENGTH))
    said = []
    for name in (name for name in STATED if name in efficiency["quality"].values):
        records, events = (int(efficiency[f"quality_{of}"].sel(quality=name)) for of in ("records", "events"))
        if records:
            enough = bool(np.isfinite(p_value.sel(quality=name)).any())
            few = "" if enough else ": too few for a test, or all alike"
            said.append(
                f"{name}: stated for {records} of {several(total, 'record')}, of {several(events, 'earthquake')}{few}."
            )
    return said


def _statements(curves: xr.Dataset) -> str:
    """A remark of each kind, by what is known of curve, band and median, and how many others there are like it."""
    found: dict[tuple[int, ...], list[str]] = {}
    for place in np.ndindex(curves["statement"].shape):
        words = str(curves["statement"].values[place])
        if words:
            dims = curves["statement"].dims
            labels = [str(curves[dim].values[index]) for dim, index in zip(dims, place, strict=True)]
            kind = tuple(int(curves[name].values[place]) for name in ("status", "band", "extrapolated"))
            found.setdefault(kind, []).append(f"{', '.join(labels)}: {words}")
    if not found:
        return ""
    said = ["remarks"]
    for entries in found.values():
        more = "" if len(entries) == 1 else f" (and {len(entries) - 1} more like it)"
        said.append(paragraph(entries[0] + more, "      ", "  "))
    return "\n".join(said)
