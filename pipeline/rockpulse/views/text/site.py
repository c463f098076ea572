"""The content of a site file as text: parameters, design and coverage of sequences, or the design spectrum."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import xarray as xr

from rockpulse.record.measures import MEASURES
from rockpulse.views.shared.files_used import failure_rows, files_used
from rockpulse.views.shared.formatting import (
    ABSENT,
    between,
    fixed,
    paragraph,
    ratio,
    restitution,
    share,
    six_digits,
    three_digits,
)
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number_cell, table_text
from rockpulse.views.shared.table_columns import Column, formatted, tabulated, titled
from rockpulse.views.shared.words import body_name, counted_words, listed, say, translated, warnings_of
from rockpulse.views.text.left_out import rows_not_used, unused

#: Largest number of listed bodies and earthquakes.
LISTED = 12
#: Restitution for which the table of the spectrum is shown, and step of its rows along p.
TABLE_RESTITUTION, STEP = 0.9, 3
_UNITS = {"m s-1": "m/s", "s": "s", "1": ""}


def site_overview(tree: xr.DataTree) -> str:
    """Return the result of :func:`rockpulse.calibrate` as text for the terminal."""
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        own = [explained(table) for table in site_tables(site) or _spectrum_tables(tree["spectra"].to_dataset(), site)]
    else:
        parameters, blocks = site_tables(site)
        correlation = "\n".join(lines(_correlation(site), "  "))
        own = [explained(parameters), correlation, paragraph(design(site), "  ", ""), _coverage(site, blocks)]
    parts = [
        unused(files_used(tree).line),
        "\n".join(paragraph(line, "  ", "! ") for line in site_warnings(site)),
        "\n".join(paragraph(line, "  ", "") for line in about_records(site)),
        *own,
        _warnings(site),
        rows_not_used(failure_rows(tree)),
    ]
    return "\n\n".join(part for part in parts if part)


def site_warnings(site: xr.Dataset) -> list[str]:
    """Return the warnings on the calibration, the most serious first."""
    return warnings_of(site["site_warning_values"].item())


def site_tables(site: xr.Dataset) -> list[Table]:
    """Return the tables of the design; for a design spectrum without those that are empty."""
    if site.attrs["method"] == "spectrum":
        return [table for table in (_design_table(site), _sequence_table(site)) if table.rows]
    return [_parameter_table(site), _block_table(site)]


def about_records(site: xr.Dataset) -> list[str]:
    """Describe records and earthquakes of the site, and the method of the calibration."""
    method, weights, scaled = (str(site.attrs[name]) for name in ("method", "weights", "scaled_to"))
    each = zip(site["site_event"].values.tolist(), site["event_records"].values.tolist(), strict=True)
    on_records = say(
        f"site.records.{'as_they_are' if scaled == 'none' else 'scaled'}",
        target="" if scaled == "none" else f"{scaled} {MEASURES[scaled.split()[0]].shown_unit}",
        records=counted_words(site.sizes["record"], "record"),
        earthquakes=counted_words(site.sizes["site_event"], "earthquake"),
        names=listed([f"{name} ({count})" for name, count in each], LISTED),
    )
    if method == "spectrum":
        return [on_records, say(f"site.spectra.{site.attrs['spectrum']}", weights=_option(weights))]
    misfit, below = three_digits(_median(site["misfit"])), share(_median(site["unsafe_share"]))
    return [
        on_records,
        say("site.sequences", method=_option(method), weights=_option(weights), misfit=misfit, share=below),
    ]


def _option(word: str) -> str:
    """Return the value of a configuration option in the current language."""
    return translated(f"options.{word}", word)


def _parameter_table(site: xr.Dataset) -> Table:
    """Return a table of the sequence parameters: lognormal fits over the records, and design values."""
    medians = {"median": "median", "median_low": "median_lower", "median_high": "median_upper"}
    spread = {"dispersion": "dispersion", "low": "dispersion_lower", "high": "dispersion_upper"}
    of_logarithm, of_records = say("site.of_logarithm"), say("site.of_records")
    selected = (
        titled(say("site.head.parameter"), _parameter, "parameter", "parameter_name", "parameter_unit"),
        *(titled(say(f"site.head.{name}"), number_cell, key) for name, key in medians.items()),
        *(titled(say(f"site.head.{name}"), number_cell, key, note=of_logarithm) for name, key in spread.items()),
        *(titled(f"{percent} %", number_cell, f"quantile_{percent}", note=of_records) for percent in (16, 50, 84)),
        titled(say("site.head.design"), number_cell, "design"),
    )
    caption = say("site.caption.parameters", confidence=_percent(site, "confidence"))
    return tabulated("site-parameters", caption, selected, site, (say("site.not_known", absent=ABSENT),))


def _parameter(name: str, words: str, unit: str) -> Cell:
    return Cell(Heading(translated(f"parameters.{name}", words.partition(";")[0]), _UNITS[unit]).label)


def design(site: xr.Dataset) -> str:
    """Describe the design sequence in one sentence."""
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    count, duration = value["main_count"], value["duration"]
    interval = _range(site.sel(parameter="main"), "design", lambda limit: three_digits(limit, "m/s"))
    return say(
        "site.design",
        quantile=six_digits(_number(site, "quantile")),
        main=three_digits(value["main"], "m/s"),
        confidence=_percent(site, "confidence"),
        interval=say("site.no_interval") if interval == ABSENT else interval,
        secondary=three_digits(value["ratio"] * value["main"], "m/s"),
        spacing=three_digits(value["interval"], "s"),
        impulses=say("site.no_limit") if math.isnan(count) else counted_words(round(count), "main_impulse"),
        within=say("site.for_ever") if math.isnan(duration) else say("site.within", time=three_digits(duration, "s")),
        kind=_option(site.attrs["spacing"]),
    )


def coverage(site: xr.Dataset) -> str:
    """Describe the share of recorded rotations that the design covers; for a spectrum its quantile."""
    if site.attrs["method"] == "spectrum":
        of = {"records": counted_words(int(site["record_count"]), "record")}
        of |= {"earthquakes": counted_words(int(site["event_count"]), "earthquake")}
        ends = {name: share(_number(site, name)) for name in ("quantile", "confidence")}
        return say("site.quantile", **of, **ends)
    inside, nominal = (share(_number(site, name)) for name in ("coverage_in_sample", "quantile"))
    covered = _number(site, "coverage")
    if math.isnan(covered):
        why = say(f"site.not_covered.{'one_event' if site.sizes['site_event'] == 1 else 'not_judged'}")
        sentences = [say("site.coverage_unknown", why=why, share=inside, nominal=nominal)]
    else:
        interval, level = _range(site, "coverage", share), say("site.one_event")
        if interval != ABSENT:
            level = say("site.with_confidence", confidence=_percent(site, "confidence"), interval=interval)
        sentences = [say("site.coverage", share=share(covered), level=level, nominal=nominal, inside=inside)]
    if not math.isnan(every := _number(site, "coverage_all")):
        sentences.append(say("site.coverage_all", share=share(every)))
    if judged := int(site["judged_pairs"]):
        events = counted_words(int(site["judged_events"]), "event")
        sentences.append(say("site.judged", pairs=counted_words(judged, "answer"), events=events))
    return " ".join(sentences)


def _block_table(site: xr.Dataset) -> Table:
    """Return a table of the rotations of the bodies under the design sequence."""

    def under(peak: float) -> Cell:
        return Cell(say("answer.overturns"), peak, grade="bad") if math.isinf(peak) else number_cell(peak, ratio)

    selected = (
        titled(say("site.head.block"), lambda name: Cell(body_name(name)), "block", width=34),
        _restitution(),
        titled(say("site.head.under"), under, "design_rotation_ratio", note="theta_max/alpha_c"),
        titled(say("site.coverage_head"), formatted(share), "block_coverage", note=say("site.left_out")),
    )
    return tabulated("site-blocks", say("site.caption.blocks"), selected, site)


def _restitution() -> Column:
    return titled("C", formatted(restitution), "restitution", note=say("head.restitution"))


def _interval(title: str, name: str) -> Column:
    return titled(title, lambda low, high: Cell(between(low, high)), f"{name}_lower", f"{name}_upper")


def _design_table(site: xr.Dataset) -> Table:
    """Return a table with effective impulse and scale factor of the design for every body."""
    quantile, confidence = (f"{six_digits(100.0 * float(site[name]))} %" for name in ("quantile", "confidence"))

    def over(factor: float) -> Cell:
        words = say("site.factor_overturns", factor=ratio(factor))
        return Cell(words, factor, grade="bad") if factor <= 1.0 else number_cell(factor, ratio)

    selected = (
        titled(say("head.body"), lambda name: Cell(body_name(name)), "block", width=34),
        _restitution(),
        titled(
            "I_eff", number_cell, "effective_impulse", unit="m/s", note=say("site.note.effective", quantile=quantile)
        ),
        _interval(say("site.head.interval", confidence=confidence), "effective_impulse"),
        titled(say("site.head.overturns_at"), number_cell, "speed", unit="m/s", note="g tan(alpha_c)/p"),
        titled(say("site.factor"), over, "design_factor", note=say("site.note.on_design")),
        titled(say("site.head.overturned_by"), formatted(share), "overturned_share", note=say("site.note.weight")),
    )
    own = site.assign(speed=site["design_factor"] * site["effective_impulse"])
    own = own.isel(block=np.flatnonzero(site["effective_impulse"].notnull()))
    return tabulated("site-design", say("site.caption.design"), selected, own)


def _sequence_table(site: xr.Dataset) -> Table:
    """Return a table of impulse sequences that are equivalent to the design spectrum, one for each body."""
    interval_of = "site.head.interval_of"
    selected = (
        titled(say("head.body"), lambda name: Cell(body_name(name)), "block", width=34),
        titled("I", number_cell, "main", unit="m/s", note=say("site.note.main")),
        _interval(say(interval_of, what="I"), "main"),
        titled("I_s/I", number_cell, "ratio", note=say("site.note.half_waves")),
        _interval(say(interval_of, what="I_s/I"), "ratio"),
        titled(say("site.head.number"), number_cell, "main_count", note=say("site.note.main_impulses")),
        _interval(say("site.head.its_interval"), "main_count"),
    )
    own = site.isel(block=np.flatnonzero(site["main"].notnull()))
    return tabulated("site-sequence", say("site.caption.sequence"), selected, own, (say("site.one_number"),))


def _spectrum_tables(spectra: xr.Dataset, site: xr.Dataset) -> list[Table]:
    """Return a table of spectrum quantiles over p; empty if there are too few earthquakes."""
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
        titled("I_s/I", number_cell, "ratio", note=say("site.note.half_waves")),
        titled(say("site.head.number"), number_cell, "main_count", note=say("site.note.main_impulses")),
    )
    caption = (
        f"Effective impulse I_eff of blocks with C = {float(at['restitution']):g}; a body overturns at g tan(alpha)/p"
    )
    return [tabulated("site-spectrum", caption, selected, at.isel(p=slice(None, None, STEP)))]


def explained(table: Table) -> str:
    """Return the table as text for the terminal, with the small print of the headings as notes below it."""
    titles: dict[str, list[str]] = {}
    for heading in table.headings:
        if heading.note:
            titles.setdefault(heading.note, []).append(heading.title)
    note = " ".join(f"{', '.join(named)}: {words}." for words, named in titles.items())
    return table_text(replace(table, footnotes=(note, *table.footnotes)))


def _number(site: xr.Dataset, name: str) -> float:
    return float(site[name])


def _percent(site: xr.Dataset, name: str) -> str:
    return share(_number(site, name))


def _range(one: xr.Dataset, name: str, show: Callable[[float], str] = three_digits) -> str:
    return between(_number(one, f"{name}_lower"), _number(one, f"{name}_upper"), show)


def _correlation(site: xr.Dataset) -> Table:
    names = site["parameter"].values.tolist()
    rows = [
        (Cell(name), *(number_cell(value, fixed) if k < place else Cell("") for k, value in enumerate(line[:-1])))
        for place, (name, line) in enumerate(zip(names, site["correlation"].values.tolist(), strict=True))
    ]
    headings = (Heading("correlation of logarithms"), *map(Heading, names[:-1]))
    return Table("site-correlation", "", headings, tuple(rows[1:]))


def _coverage(site: xr.Dataset, blocks: Table) -> str:
    """Describe the coverage of all bodies together, then of each body or, if they are many, the extreme values."""
    sentences = [
        coverage(site),
        f"{share(_number(site, 'lifted_share'))} of the pairs of record and block are used (the record lifts the "
        f"block), {share(_number(site, 'standing_share'))} of these for blocks that the design does not overturn.",
    ]
    parts = [paragraph(line, "  ", "") for line in sentences]
    shares = site["block_coverage"]
    if site.sizes["block"] <= LISTED:
        parts.append(explained(blocks))
    elif shares.notnull().any():
        worst = str(shares.idxmin().item())
        fallen = int(np.isinf(site["design_rotation_ratio"].values).sum())
        parts.append(
            f"  By block: from {share(float(shares.min()))} ({worst}) over {share(_median(shares))} (median) to "
            f"{share(float(shares.max()))}. The design overturns {fallen} of {site.sizes['block']} blocks."
        )
    return "\n".join(parts)


def _warnings(site: xr.Dataset) -> str:
    pairs = zip(site["record"].values, site["warnings"].values, strict=True)
    warned = [(name, str(words).splitlines()[0]) for name, words in pairs if words]
    title = f"records with warnings: {len(warned)} (all are stored in /site, variable warnings)"
    said = [paragraph(words, "      ", f"  {name}: ") for name, words in warned[:LISTED]]
    return "\n".join([title, *said]) if warned else ""


def _median(values: xr.DataArray) -> float:
    known = values.values[~np.isnan(values.values)]
    return float(np.median(known)) if known.size else math.nan
