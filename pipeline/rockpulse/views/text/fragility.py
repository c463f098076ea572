"""The content of a fragility file as text: medians, dispersions, confidence bands and efficiency of measures."""

import math

import numpy as np
import xarray as xr

from rockpulse.record.measures import REFERENCE
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.variables.fragility import STATED, STRENGTH
from rockpulse.views.shared.files_used import files_used, unused
from rockpulse.views.shared.formatting import ABSENT, paragraph, ratio, several, six_digits
from rockpulse.views.shared.table import Cell, CellMark, Heading, Table, number_cell, table_text
from rockpulse.views.shared.table_columns import count_of, formatted, tabulated, titled
from rockpulse.views.shared.words import body_name, counted_words, numerals, say, translated, warnings_of

#: Mark of a median beyond all levels analysed.
BEYOND = CellMark("beyond", "!")
#: Mark of the smallest dispersion of a limit state.
SMALLEST = CellMark("smallest", "*")
#: Significance level of the tests of sufficiency.
LEVEL = 0.05


def fragility_overview(tree: xr.DataTree) -> str:
    """Return the result of :func:`rockpulse.fragility` as text of one or two screens."""
    curves, efficiency = tree["fragility"].to_dataset(), tree["efficiency"].to_dataset()
    bodies = several(curves.sizes["block"], "body")
    parts = [
        f"{tree.attrs['title']}: {records_words(tree)}, {bodies}, data: {tree.attrs['data']}",
        unused(files_used(tree).line),
        table_text(median_table(tree)),
        _pooled(curves, efficiency),
        *map(table_text, sufficiency_tables(efficiency)),
        _statements(curves),
    ]
    return "\n\n".join(filter(None, parts))


def displayed_measure(curves: xr.Dataset) -> str:
    """Return the intensity measure used in the tables: the reference measure or, if it is missing, the first one."""
    measures = [str(name) for name in curves["measure"].values]
    return REFERENCE if REFERENCE in measures else measures[0]


def records_words(tree: xr.DataTree) -> str:
    """Return the numbers of records and earthquakes from which the curves were fitted, as text."""
    event = tree["capacities"].to_dataset()["event"].values
    records, earthquakes = counted_words(event.size, "record"), counted_words(np.unique(event).size, "earthquake")
    known = say("records_of", records=records, earthquakes=earthquakes)
    return say("fragility.as_one", records=known) if UNKNOWN in event else known


def state_words(name: str) -> str:
    """Return the name of a limit state as text, such as "uplift" or "θ_max/α_c ≥ 0.4"."""
    return say(f"limit_state.{name}") if name.isalpha() else f"θ_max/α_c ≥ {numerals(name)}"


def statement(one: xr.Dataset) -> str:
    """Return the warnings on one fragility curve as text; empty if there are none."""
    return "; ".join(warnings_of(str(one["statement_values"].item())))


def median_table(tree: xr.DataTree) -> Table:
    """Return a table with median and dispersion for every body and limit state, in one intensity measure."""
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=displayed_measure(curves))
    level = f"{six_digits(100.0 * float(tree.attrs['confidence']))} %"

    def beyond(median: float, extrapolated: int) -> Cell:
        return number_cell(median, ratio, (BEYOND,) if extrapolated else ())

    def upper(limit: float) -> Cell:
        return number_cell(limit, lambda high: say("no_limit") if math.isinf(high) else ratio(high))

    selected = (
        titled(say("head.body"), lambda name: Cell(body_name(name)), "block", width=30),
        titled(say("fragility.limit_state"), lambda state: Cell(state_words(state)), "limit_state"),
        titled(say("site.head.median"), beyond, "median", "extrapolated"),
        titled(say("site.head.low"), formatted(ratio), "median_low", note=level),
        titled(say("site.head.high"), upper, "median_high", note=level),
        titled("beta", formatted(ratio), "beta", note=say("fragility.of_capacity")),
        titled(say("fragility.reached"), count_of, "reached", "observations", note=say("fragility.of_observations")),
        titled(say("head.records"), formatted(str), "records"),
        titled(say("fragility.earthquakes"), formatted(str), "events"),
    )
    words, units = (str(own[f"measure_{of}"].item()) for of in ("long_name", "units"))
    words = translated(f"measures.{own['measure'].item()}", words)
    caption = say("fragility.caption", measure=words if units == "1" else f"{words} [{units}]")
    note = say("fragility.limits", absent=ABSENT, confidence=level) + (
        say("fragility.first") if tree.attrs["data"] == "ida" else ""
    )
    rows = own[[name for column in selected for name in column.of]].stack(row=("block", "limit_state"))
    return tabulated("fragility-medians", caption, selected, rows, (note,))


def _pooled(curves: xr.Dataset, efficiency: xr.Dataset) -> str:
    """Return a table with the dispersion for every measure, as text; the smallest for each limit state is marked."""
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
        cells = [
            number_cell(x, ratio, (SMALLEST,) if x == best else ()) for x, best in zip(line, smallest, strict=True)
        ]
        value, low, high = (float(limit.sel(measure=name)) for limit in compared)
        band = ratio(value) if math.isnan(low) else f"{ratio(value)} ({ratio(low)}..{ratio(high)})"
        rows.append((Cell(name), *cells, Cell(band, value)))
    headings = tuple(map(Heading, ("", *states, f"{states[-1]}, ratio")))
    head = f"Efficiency: dispersion beta of capacity, all bodies together; ratio: beta divided by beta for {REFERENCE}"
    if bool(compared[1].sel(measure=kept).notnull().any()):
        head += " with its band"
    words = "; ".join(f"{name}: {curves['measure_long_name'].sel(measure=name).values}" for name in kept)
    return table_text(Table("", head, headings, tuple(rows), (f"{words}.",)))


def sufficiency_tables(efficiency: xr.Dataset) -> list[Table]:
    """Return a table with the number of tests in which the capacity depends on another property of the record."""
    p_value = efficiency["pooled_p_value"].transpose("measure", "quality", "limit_state")
    tested = np.isfinite(p_value.values)
    tests = int(np.count_nonzero(tested))
    if tests == 0:
        return []
    kept = np.flatnonzero(tested.any(axis=(0, 2)) | [name not in STATED for name in p_value["quality"].values])
    rows = []
    for name, own in zip(p_value["measure"].values.tolist(), p_value.values[:, kept], strict=True):
        if np.any(np.isfinite(own)):
            counts = [(int(np.sum(found < LEVEL)), int(np.sum(np.isfinite(found)))) for found in own]
            rows.append((Cell(translated(f"measures.{name}", name)), *(count_of(*pair) for pair in counts)))
    qualities = p_value["quality"].values[kept].tolist()
    headings = (Heading(""), *(Heading(say(f"quality.{name}")) for name in qualities))
    note = say("fragility.tests", tests=tests, few=f"{LEVEL * tests:.0f}")
    caption = say("fragility.sufficiency", level=six_digits(LEVEL))
    return [Table("fragility-sufficiency", caption, headings, tuple(rows), (note, *_told_by(efficiency, p_value)))]


def _told_by(efficiency: xr.Dataset, p_value: xr.DataArray) -> list[str]:
    """State, for each property that only some files contain, the number of records for which it is known."""
    total = counted_words(int(efficiency["quality_records"].sel(quality=STRENGTH)), "record")
    said = []
    for name in (name for name in STATED if name in efficiency["quality"].values):
        count, events = (int(efficiency[f"quality_{of}"].sel(quality=name)) for of in ("records", "events"))
        if count:
            key = "stated" if np.isfinite(p_value.sel(quality=name)).any() else "too_few"
            fields = {"quality": say(f"quality.{name}"), "events": counted_words(events, "earthquake")}
            said.append(say(f"fragility.{key}", count=count, records=total, **fields))
    return said


def _statements(curves: xr.Dataset) -> str:
    """Return the warnings on all curves as text; similar warnings appear once, with their number."""
    statements = curves["statement"]
    found: dict[tuple[int, ...], list[str]] = {}
    for place in zip(*np.nonzero(statements.values), strict=True):
        labels = [str(curves[dim].values[index]) for dim, index in zip(statements.dims, place, strict=True)]
        kind = tuple(int(curves[name].values[place]) for name in ("status", "band", "extrapolated"))
        found.setdefault(kind, []).append(f"{', '.join(labels)}: {statements.values[place]}")
    like = {first: f" (and {len(others)} more like it)" if others else "" for first, *others in found.values()}
    said = [paragraph(first + more, "      ", "  ") for first, more in like.items()]
    return "\n".join(["warnings", *said]) if said else ""
