"""A site file as text: its remarks first, then the parameters, the design sequence and the coverage."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.record.measures import MEASURES
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number, text
from rockpulse.views.shared.terminal import (
    ABSENT,
    between,
    figure,
    fixed,
    paragraph,
    ratio,
    restitution,
    several,
    share,
)
from rockpulse.views.text.left_out import not_used, unused
from rockpulse.views.text.site_spectrum import design_table, sequence_table, spectrum_table

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

__all__ = [
    "about_records",
    "block_table",
    "coverage",
    "design",
    "explained",
    "parameter_table",
    "remarks",
    "site_overview",
]

#: Rows of a table of blocks, and names of events, that are listed one by one.
LISTED = 12

#: How the spectrum of a record is made, by the word of [calibration] spectrum.
_SPECTRA = {"rule": "by the rule, from its half-waves alone", "nonlinear": "by the nonlinear equation of motion"}

_UNITS = {"m s-1": "m/s", "s": "s", "1": ""}


def site_overview(tree: xr.DataTree) -> str:
    """The tree of :func:`rockpulse.calibrate_site` as text for the terminal."""
    site = tree["site"].to_dataset()
    parts = [
        unused(files_used(tree).line),
        "\n".join(paragraph(line, "  ", "! ") for line in remarks(site)),
        "\n".join(paragraph(line, "  ", "") for line in about_records(site)),
        *(_by_spectrum(tree, site) if site.attrs["method"] == "spectrum" else _by_sequences(site)),
        _warnings(site),
        not_used(tree),
    ]
    return "\n\n".join(part for part in parts if part)


def _by_spectrum(tree: xr.DataTree, site: xr.Dataset) -> list[str]:
    """The design of every body, or the spectrum where there is none; nothing where too few earthquakes make it."""
    spectra = tree["spectra"].to_dataset()
    if spectra["spectrum_design"].isnull().any():
        return []
    tables = (design_table(site), sequence_table(site)) if site.sizes["block"] else (spectrum_table(spectra, site),)
    return [explained(table) for table in tables if table.rows]


def _by_sequences(site: xr.Dataset) -> list[str]:
    return [
        explained(parameter_table(site)),
        "\n".join("  " + line for line in lines(_correlation(site))),
        paragraph(design(site), "  ", ""),
        _coverage(site),
    ]


def remarks(site: xr.Dataset) -> list[str]:
    """Sentences on the limits of the calibration, the gravest first."""
    return [line for line in str(site["remarks"].item()).splitlines() if line]


def about_records(site: xr.Dataset) -> list[str]:
    """The records and their events, and how a sequence was made of each."""
    events = site["site_event"].values.tolist()
    counted = zip(events, site["event_records"].values.tolist(), strict=True)
    listed = [f"{name} ({count})" for name, count in list(counted)[:LISTED]]
    more = f", and {len(events) - LISTED} more" if len(events) > LISTED else ""
    scaled = str(site.attrs["scaled_to"])
    unit = "" if scaled == "none" else MEASURES[scaled.split()[0]].shown_unit
    on_records = (
        f"Calibrated on {several(site.sizes['record'], 'record')} of {several(len(events), 'earthquake')}, "
        f"{'not scaled' if scaled == 'none' else f'scaled to {scaled} {unit}'}: {', '.join(listed)}{more}."
    )
    weights = f'weights: "{site.attrs["weights"]}"'
    if site.attrs["method"] == "spectrum":
        return [on_records, f"The overturning spectrum of each record {_SPECTRA[site.attrs['spectrum']]}; {weights}."]
    return [
        on_records,
        f'The sequence of each record by the method "{site.attrs["method"]}"; {weights}. Its '
        f"misfit (ln, median over records) is {figure(_median(site['misfit']))}; its rotation is below the recorded "
        f"one for {share(_median(site['unsafe_share']))} of the blocks (median).",
    ]


def parameter_table(site: xr.Dataset) -> Table:
    """The parameters of the sequences of all records: lognormal, with intervals where they are known."""
    headings = (
        Heading("parameter"),
        *map(Heading, ("median", "median, low", "median, high")),
        *(Heading(title, note="of the logarithm") for title in ("dispersion", "low", "high")),
        *(Heading(f"{percent} %", note="of the records") for percent in (16, 50, 84)),
        Heading("design"),
    )
    spread = (f"{name}{end}" for name in ("median", "dispersion") for end in ("", "_lower", "_upper"))
    keys = (*spread, *(f"quantile_{percent}" for percent in (16, 50, 84)), "design")
    rows = []
    for name in site["parameter"].values.tolist():
        one = site.sel(parameter=name)
        words = str(one["parameter_name"].item()).partition(";")[0]
        label = Heading(words, _UNITS[str(one["parameter_unit"].item())]).label
        rows.append((Cell(label), *(number(_number(one, key)) for key in keys)))
    caption = (
        f"Parameters of the sequence, lognormal; intervals of {_number(site, 'confidence'):.0%}, clustered by event"
    )
    return Table("site-parameters", caption, headings, tuple(rows), (f"{ABSENT}: not known.",))


def design(site: xr.Dataset) -> str:
    """The design sequence in a sentence."""
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    count = value["main_count"]
    impulses = "main impulses without limit in number" if math.isnan(count) else several(round(count), "main impulse")
    within = "for ever" if math.isnan(value["duration"]) else f"within {figure(value['duration'], 's')}"
    interval = _range(site.sel(parameter="main"), "design", lambda limit: figure(limit, "m/s"))
    return (
        f"Design sequence (quantile {_number(site, 'quantile'):g} of the recorded rotations, method "
        f'"{site.attrs["design"]}"): I = {figure(value["main"], "m/s")} ({_number(site, "confidence"):.0%} confidence: '
        f"{'no interval' if interval == ABSENT else interval}), "
        f"I_s = {figure(value['ratio'] * value['main'], 'm/s')}, dT = {figure(value['interval'], 's')}, "
        f'{impulses} {within}, spacing "{site.attrs["spacing"]}".'
    )


def coverage(site: xr.Dataset) -> str:
    """The share of the recorded rotations that the design covers, of events it does not know; or its quantile."""
    if site.attrs["method"] == "spectrum":
        return (
            f"The design is the {share(_number(site, 'quantile'))} quantile of the overturning spectra of "
            f"{several(int(site['record_count']), 'record')} of {several(int(site['event_count']), 'earthquake')}, its "
            f"intervals of {share(_number(site, 'confidence'))} those of other sets of so many earthquakes."
        )
    in_sample, nominal = (share(_number(site, name)) for name in ("coverage_in_sample", "quantile"))
    if math.isnan(_number(site, "coverage")):
        why = (
            "with one event none can be left out"
            if site.sizes["site_event"] == 1
            else "no event could be judged by a design that was made without it"
        )
        words = (
            f"Coverage of other earthquakes: not known, for {why}. The design covers {in_sample} of the recorded "
            f"rotations that it was made from, of blocks that it leaves standing; nominal {nominal}."
        )
    else:
        interval = _range(site, "coverage", share)
        level = (
            f"{_number(site, 'confidence'):.0%} confidence: {interval}"
            if interval != ABSENT
            else "one event: no interval"
        )
        words = (
            f"Coverage: a design made without the event of a record covers {share(_number(site, 'coverage'))} "
            f"({level}) of the recorded rotations of the blocks that it leaves standing; nominal {nominal}; the design "
            f"of all records {in_sample}."
        )
    if not math.isnan(_number(site, "coverage_all")):
        words += (
            " With the blocks that it overturns, which are covered whatever the records do: "
            f"{share(_number(site, 'coverage_all'))}."
        )
    if judged := int(site["judged_pairs"]):
        words += (
            f" Judged: {several(judged, 'pair')} of record and block of {several(int(site['judged_events']), 'event')}."
        )
    return words


def block_table(site: xr.Dataset) -> Table:
    """The blocks under the design sequence."""
    rows = []
    for name in site["block"].values.tolist():
        one = site.sel(block=name)
        peak = _number(one, "design_rotation_ratio")
        verdict = Cell("overturns", peak, grade="bad") if math.isinf(peak) else number(peak, ratio)
        c, covered = _number(one, "restitution"), _number(one, "block_coverage")
        rows.append((Cell(name), number(c, restitution), verdict, number(covered, share)))
    headings = (
        Heading("block", width=34),
        Heading("C", note="restitution"),
        Heading("under the design", note="theta_max/alpha_c"),
        Heading("coverage", note="its event left out"),
    )
    return Table("site-blocks", "The blocks under the design sequence", headings, tuple(rows))


def explained(table: Table) -> str:
    """The table for the terminal, with a note that says what the report has in small print below the headings."""
    titles: dict[str, list[str]] = {}
    for heading in table.headings:
        if heading.note:
            titles.setdefault(heading.note, []).append(heading.title)
    note = " ".join(f"{', '.join(named)}: {words}." for words, named in titles.items())
    return text(replace(table, remarks=(note, *table.remarks)))


def _number(site: xr.Dataset, name: str) -> float:
    return float(site[name])


def _range(one: xr.Dataset, name: str, show: Callable[[float], str] = figure) -> str:
    return between(_number(one, f"{name}_lower"), _number(one, f"{name}_upper"), show)


def _correlation(site: xr.Dataset) -> Table:
    names = site["parameter"].values.tolist()
    rows = [
        (Cell(name), *(number(value, fixed) if k < place else Cell("") for k, value in enumerate(line[:-1])))
        for place, (name, line) in enumerate(zip(names, site["correlation"].values.tolist(), strict=True))
    ]
    headings = (Heading("correlation of logarithms"), *map(Heading, names[:-1]))
    return Table("site-correlation", "", headings, tuple(rows[1:]))


def _coverage(site: xr.Dataset) -> str:
    """Coverage over all blocks, then block by block or, of many, the extremes."""
    told = [
        coverage(site),
        f"{share(_number(site, 'lifted_share'))} of the pairs of record and block count (the record lifts the "
        f"block), {share(_number(site, 'standing_share'))} of these on blocks that the design leaves standing.",
    ]
    parts = [paragraph(line, "  ", "") for line in told]
    shares = site["block_coverage"]
    if site.sizes["block"] <= LISTED:
        parts.append(explained(block_table(site)))
    elif shares.notnull().any():
        worst = str(shares.idxmin().item())
        fallen = int(np.isinf(site["design_rotation_ratio"].values).sum())
        parts.append(
            f"  By block: from {share(float(shares.min()))} ({worst}) over {share(_median(shares))} (median) to "
            f"{share(float(shares.max()))}. The design overturns {fallen} of {site.sizes['block']} blocks."
        )
    return "\n".join(parts)


def _warnings(site: xr.Dataset) -> str:
    texts = [str(words) for words in site["warnings"].values]
    warned = [(str(name), words) for name, words in zip(site["record"].values, texts, strict=True) if words]
    if not warned:
        return ""
    said = [f"records with warnings: {len(warned)} (variable warnings of /site holds all of them)"]
    said += [paragraph(words.splitlines()[0], "      ", f"  {name}: ") for name, words in warned[:LISTED]]
    return "\n".join(said)


def _median(values: xr.DataArray) -> float:
    known = values.values[~np.isnan(values.values)]
    return float(np.median(known)) if known.size else math.nan
