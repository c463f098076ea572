"""A site file as text (design spectrum and sequence, bodies under this sequence), and a selection of its records."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr

from rocking.body.block import Block
from rockpulse.record.measures import MEASURES
from rockpulse.selection.events import UNKNOWN
from rockpulse.sequences.rule import load_rule
from rockpulse.views.shared.files_used import failure_rows, files_used, rows_not_used, unused
from rockpulse.views.shared.formatting import (
    ABSENT,
    between,
    paragraph,
    ratio,
    restitution,
    several,
    share,
    six_digits,
    three_digits,
)
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell, table_text
from rockpulse.views.shared.table_columns import OUTSIDE, Column, formatted, tabulated, titled
from rockpulse.views.shared.words import body_name, counted_words, listed, say, translated, warnings_of

#: Largest number of listed bodies and earthquakes.
LISTED = 12
#: Restitution for which the table of the spectrum is shown, and step of its rows along p.
TABLE_RESTITUTION, STEP = 0.9, 3


def site_overview(tree: xr.DataTree) -> str:
    """Return the result of :func:`rockpulse.calibrate` as text for the terminal."""
    site = tree["site"].to_dataset()
    tables = site_tables(site) or _spectrum_tables(tree["spectra"].to_dataset(), site)
    parts = [
        unused(files_used(tree).line),
        "\n".join(paragraph(line, "  ", "! ") for line in site_warnings(site)),
        "\n".join(paragraph(line, "  ", "") for line in about_records(site)),
        *(explained(table) for table in tables[:1]),
        paragraph(sequence_words(site), "  ", "") if tables else "",
        *(explained(table) for table in tables[1:]),
        _warnings(site),
        rows_not_used(failure_rows(tree)),
    ]
    return "\n\n".join(part for part in parts if part)


def site_warnings(site: xr.Dataset) -> list[str]:
    """Return the warnings on the calibration, the most serious first."""
    return warnings_of(site["site_warning_values"].item())


def site_tables(site: xr.Dataset) -> list[Table]:
    """Return the tables of the design spectrum and of the design sequence; empty tables are left out."""
    return [table for table in (_design_table(site), _sequence_table(site)) if table.rows]


def about_records(site: xr.Dataset) -> list[str]:
    """Describe records and earthquakes of the site, and the method of the calibration."""
    weights, scaled = (str(site.attrs[name]) for name in ("weights", "scaled_to"))
    each = zip(site["site_event"].values.tolist(), site["event_records"].values.tolist(), strict=True)
    on_records = say(
        f"site.records.{'as_they_are' if scaled == 'none' else 'scaled'}",
        target="" if scaled == "none" else f"{scaled} {MEASURES[scaled.split()[0]].shown_unit}",
        records=counted_words(site.sizes["record"], "record"),
        earthquakes=counted_words(site.sizes["site_event"], "earthquake"),
        names=listed([f"{name} ({count})" for name, count in each], LISTED),
    )
    return [on_records, say(f"site.spectra.{site.attrs['spectrum']}", weights=_option(weights))]


def _option(word: str) -> str:
    return translated(f"options.{word}", word)


def sequence_words(site: xr.Dataset) -> str:
    """Describe the design sequence: number of main impulses, I_s/I, dT and the largest main impulse."""
    if math.isnan(_number(site, "ratio")):
        return ""
    words = say(
        "site.sequence",
        confidence=share(_number(site, "confidence")),
        count=six_digits(_number(site, "main_count")),
        counts=_range(site, "main_count"),
        ratio=three_digits(_number(site, "ratio")),
        ratios=_range(site, "ratio"),
        interval=three_digits(_number(site, "interval"), "s"),
        intervals=_range(site, "interval", lambda limit: three_digits(limit, "s")),
        spacing=_option(site.attrs["spacing"]),
    )
    own = site.isel(block=np.flatnonzero(site["main"].notnull()))
    if not own.sizes["block"]:
        return words
    largest = own.isel(block=int(np.argmax(own["main"].values)))
    main = float(largest["main"])
    of_site = say(
        "site.largest",
        main=three_digits(main, "m/s"),
        interval=_range(largest, "main", lambda limit: three_digits(limit, "m/s")),
        secondary=three_digits(main * _number(site, "ratio"), "m/s"),
        name=body_name(str(largest["block"].item())),
    )
    return f"{words} {of_site}"


def coverage(site: xr.Dataset) -> str:
    """Describe the quantile of the design spectrum, and the records from which it is derived."""
    of = {"records": counted_words(int(site["record_count"]), "record")}
    of |= {"earthquakes": counted_words(int(site["event_count"]), "earthquake")}
    ends = {name: share(_number(site, name)) for name in ("quantile", "confidence")}
    return say("site.quantile", **of, **ends)


def _restitution() -> Column:
    return titled("C", formatted(restitution), "restitution", note=say("head.restitution"))


def _interval(title: str, name: str) -> Column:
    return titled(title, lambda low, high: Cell(between(low, high)), f"{name}_lower", f"{name}_upper")


def _name(name: str, within: bool) -> Cell:
    return Cell(body_name(name), marks=() if within else (OUTSIDE,))


def _marked(site: xr.Dataset) -> xr.Dataset:
    """Return the site with a mask `within` of the bodies in the range of the rule, if the rule gives the spectra."""
    within = np.full(site.sizes["block"], True)
    if site.attrs["spectrum"] == "rule":
        p, alpha, c = (site[name].values for name in ("p", "alpha_c", "restitution"))
        for place in np.flatnonzero(site["effective_impulse"].notnull()):
            block = Block.from_parameters(p=p[place], alpha=alpha[place], restitution=c[place], log=False)
            within[place] = load_rule().applicable(block)[0]
    return site.assign(within=("block", within))


def _design_table(site: xr.Dataset) -> Table:
    quantile, confidence = (f"{six_digits(100.0 * float(site[name]))} %" for name in ("quantile", "confidence"))

    def over(factor: float) -> Cell:
        words = say("site.factor_overturns", factor=ratio(factor))
        return Cell(words, factor, grade="bad") if factor <= 1.0 else number_cell(factor, ratio)

    selected = (
        titled(say("head.body"), _name, "block", "within", width=34),
        _restitution(),
        titled(
            "I_eff", number_cell, "effective_impulse", unit="m/s", note=say("site.note.effective", quantile=quantile)
        ),
        _interval(say("site.head.interval", confidence=confidence), "effective_impulse"),
        titled(say("site.head.overturns_at"), number_cell, "speed", unit="m/s", note="g tan(alpha_c)/p"),
        titled(say("site.factor"), over, "design_factor", note=say("site.note.on_design")),
        titled(say("site.head.overturned_by"), formatted(share), "overturned_share", note=say("site.note.weight")),
    )
    own = _marked(site).assign(speed=site["design_factor"] * site["effective_impulse"])
    own = own.isel(block=np.flatnonzero(site["effective_impulse"].notnull()))
    return tabulated("site-design", say("site.caption.design"), selected, own)


def _sequence_table(site: xr.Dataset) -> Table:
    def rotation(peak: float) -> Cell:
        return Cell(say("answer.overturns"), peak, grade="bad") if math.isinf(peak) else number_cell(peak, ratio)

    def without_end(half_cycle: int, peak: float) -> Cell:
        if half_cycle:
            return Cell(say("site.in_half_cycle", number=int(half_cycle)))
        return Cell(say("site.stabilises", rotation=ratio(peak)))

    def numbers(least: int, most: int) -> Cell:
        return Cell(ABSENT if not most else str(int(most)) if least == most else f"{int(least)}-{int(most)}")

    selected = (
        titled(say("head.body"), _name, "block", "within", width=34),
        titled("I", number_cell, "main", unit="m/s", note=say("site.note.main")),
        _interval(say("site.head.interval_of", what="I"), "main"),
        titled("I_s", number_cell, "secondary", unit="m/s"),
        titled("n", numbers, "least_count", "most_count", note=say("site.note.count")),
        titled("I_1c", number_cell, "critical_impulse", unit="m/s", note=say("site.note.critical")),
        titled("I_2c", number_cell, "critical_impulse_2", unit="m/s", note=say("site.note.critical")),
        titled(say("site.head.rotation"), rotation, "rotation_ratio", note="theta_max/alpha_c"),
        titled(
            say("site.head.endless"), without_end, "half_cycle", "stabilised_rotation", note=say("site.note.endless")
        ),
    )
    own = (
        _marked(site).assign(secondary=site["main"] * site["ratio"]).isel(block=np.flatnonzero(site["main"].notnull()))
    )
    return tabulated("site-sequence", say("site.caption.sequence"), selected, own, (say("site.one_number"),))


def _spectrum_tables(spectra: xr.Dataset, site: xr.Dataset) -> list[Table]:
    if spectra["spectrum_design"].isnull().any():
        return []
    at = spectra.sel(restitution=TABLE_RESTITUTION, method="nearest")
    quantile, confidence = (f"{100.0 * float(site[name]):g} %" for name in ("quantile", "confidence"))
    columns = {"spectrum_50": "median", "spectrum_84": "84 %", "spectrum_design": quantile}
    titles = {title: key for key, title in columns.items()}  # the design replaces the same quantile
    notes = {"spectrum_design": "the design"}
    selected = (
        titled("p", number_cell, "p", unit="1/s"),
        *(titled(title, number_cell, key, unit="m/s", note=notes.get(key, "")) for title, key in titles.items()),
        _interval(f"{confidence} interval", "spectrum_design"),
    )
    caption = (
        f"Effective impulse I_eff of blocks with C = {float(at['restitution']):g}; a body overturns at g tan(alpha)/p"
    )
    return [tabulated("site-spectrum", caption, selected, at.isel(p=slice(None, None, STEP)))]


def explained(table: Table) -> str:
    """Return the table as text for the terminal; the small print of its headings follows as notes."""
    titles: dict[str, list[str]] = {}
    for heading in table.headings:
        if heading.note:
            titles.setdefault(heading.note, []).append(heading.title)
    note = " ".join(f"{', '.join(named)}: {words}." for words, named in titles.items())
    return table_text(replace(table, footnotes=(note, *table.footnotes)))


def _number(site: xr.Dataset, name: str) -> float:
    return float(site[name])


def _range(one: xr.Dataset, name: str, show: Callable[[float], str] = three_digits) -> str:
    return between(_number(one, f"{name}_lower"), _number(one, f"{name}_upper"), show)


def _warnings(site: xr.Dataset) -> str:
    groups: dict[str, list[str]] = {}
    for name, words in zip(site["record"].values.tolist(), site["warnings"].values.tolist(), strict=True):
        for line in words.splitlines():
            groups.setdefault(line, []).append(name)
    count = np.count_nonzero(site["warnings"].values != "")
    title = f"records with warnings: {count} (all are stored in /site, variable warnings)"
    said = [paragraph(f"{words}: {listed(names, 3)}", "      ", "  ") for words, names in groups.items()]
    return "\n".join([title, *said[:LISTED]]) if groups else ""


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
