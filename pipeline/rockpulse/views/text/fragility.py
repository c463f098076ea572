"""A fragility file as text: medians, dispersions and bands of every body, and which measure serves best."""

import math

import numpy as np
import xarray as xr

from rockpulse.record.measures import REFERENCE
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.variables.fragility import STATED, STRENGTH
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Mark, Table, number, text
from rockpulse.views.shared.terminal import ABSENT, general, paragraph, ratio, several
from rockpulse.views.shared.words import counted, named, numerals, remarks_of, say
from rockpulse.views.text.left_out import unused
from rockpulse.views.text.site import explained

#: At a median that no record was looked at.
BEYOND = Mark("beyond", "!")

#: At the smallest dispersion of a limit state.
SMALLEST = Mark("smallest", "*")

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
    records, earthquakes = counted(event.size, "record"), counted(np.unique(event).size, "earthquake")
    known = say("records_of", records=records, earthquakes=earthquakes)
    return say("fragility.as_one", records=known) if UNKNOWN in event else known


def state_words(name: str) -> str:
    """The name of a limit state, or the rotation that it is.

    Examples
    --------
    >>> state_words("uplift"), state_words("0.4")
    ('uplift', 'θ_max/α_c ≥ 0.4')
    """
    return say(f"limit_state.{name}") if name.isalpha() else f"θ_max/α_c ≥ {numerals(name)}"


def statement(one: xr.Dataset) -> str:
    """What there is to say of a curve, of a body and limit state in one measure; empty for nothing."""
    return "; ".join(remarks_of(str(one["statement_values"].item())))


def median_table(tree: xr.DataTree) -> Table:
    """Median and dispersion of every body and limit state in the measure that is shown."""
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=shown_measure(curves))
    level = f"{general(100.0 * float(tree.attrs['confidence']))} %"
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
                    number(high, lambda limit: say("no_limit") if math.isinf(limit) else ratio(limit)),
                    number(beta, ratio),
                    Cell(say("count_of", count=reached, total=of), reached),
                    number(records, str),
                    number(events, str),
                )
            )
    note = say("fragility.limits", absent=ABSENT) + (say("fragility.first") if tree.attrs["data"] == "ida" else "")
    words, units = (str(own[f"measure_{of}"].item()) for of in ("long_name", "units"))
    words = named(f"measures.{own['measure'].item()}", words)
    caption = say("fragility.caption", measure=words if units == "1" else f"{words} [{units}]")
    headings = (
        Heading(say("head.body"), width=30),
        Heading(say("fragility.limit_state")),
        Heading(say("site.head.median")),
        *(Heading(say(f"site.head.{end}"), note=level) for end in ("low", "high")),
        Heading("beta", note=say("fragility.of_capacity")),
        Heading(say("fragility.reached"), note=say("fragility.of_observations")),
        Heading(say("head.records")),
        Heading(say("fragility.earthquakes")),
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
            rows.append((Cell(name), *(Cell(say("count_of", count=few, total=every), few) for few, every in counts)))
    qualities = p_value["quality"].values[shown].tolist()
    headings = (Heading(""), *(Heading(say(f"quality.{name}")) for name in qualities))
    note = say("fragility.tests", tests=tests, few=f"{LEVEL * tests:.0f}")
    caption = say("fragility.sufficiency", level=general(LEVEL))
    return [Table("fragility-sufficiency", caption, headings, tuple(rows), (note, *_told_by(efficiency, p_value)))]


def _told_by(efficiency: xr.Dataset, p_value: xr.DataArray) -> list[str]:
    """A sentence for every quality that files of some records state: by how many, and whether they are enough."""
    total = int(efficiency["quality_records"].sel(quality=STRENGTH))
    said = []
    for name in (name for name in STATED if name in efficiency["quality"].values):
        records, events = (int(efficiency[f"quality_{of}"].sel(quality=name)) for of in ("records", "events"))
        if records:
            enough = bool(np.isfinite(p_value.sel(quality=name)).any())
            fields = {"count": records, "records": counted(total, "record"), "events": counted(events, "earthquake")}
            key = f"fragility.{'stated' if enough else 'too_few'}"
            said.append(say(key, quality=say(f"quality.{name}"), **fields))
    return said


def _statements(curves: xr.Dataset) -> str:
    """A remark of each kind, by what is known of curve, band and median, and how many others there are like it."""
    found: dict[tuple[int, ...], list[str]] = {}
    for place in np.ndindex(curves["statement"].shape):
        if words := str(curves["statement"].values[place]):
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
