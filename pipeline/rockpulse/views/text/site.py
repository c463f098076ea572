"""A site file as text: its remarks first, then the parameters, the design sequence and the coverage.

By the overturning spectrum: what the design asks of every body, in effective impulses, then sequences of them.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import xarray as xr

from rockpulse.record.measures import MEASURES
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, lines, number, text
from rockpulse.views.shared.terminal import (
    ABSENT,
    between,
    figure,
    fixed,
    general,
    paragraph,
    ratio,
    restitution,
    share,
)
from rockpulse.views.shared.words import counted, listed, named, remarks_of, say
from rockpulse.views.text.left_out import not_used, unused

#: Rows of a table of blocks, and names of events, that are listed one by one.
LISTED = 12

#: Restitution of the blocks of the table of the spectrum, and the step of its rows along p.
SHOWN_RESTITUTION, STEP = 0.9, 3

_UNITS = {"m s-1": "m/s", "s": "s", "1": ""}


def site_overview(tree: xr.DataTree) -> str:
    """The tree of :func:`rockpulse.calibrate_site` as text for the terminal."""
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        own = [explained(table) for table in site_tables(site) or _spectrum_tables(tree["spectra"].to_dataset(), site)]
    else:
        parameters, blocks = site_tables(site)
        correlation = "\n".join("  " + line for line in lines(_correlation(site)))
        own = [explained(parameters), correlation, paragraph(design(site), "  ", ""), _coverage(site, blocks)]
    parts = [
        unused(files_used(tree).line),
        "\n".join(paragraph(line, "  ", "! ") for line in site_remarks(site)),
        "\n".join(paragraph(line, "  ", "") for line in about_records(site)),
        *own,
        _warnings(site),
        not_used(tree),
    ]
    return "\n\n".join(part for part in parts if part)


def site_remarks(site: xr.Dataset) -> list[str]:
    """Sentences on the limits of the calibration, the gravest first."""
    return remarks_of(site["remark_values"].item())


def site_tables(site: xr.Dataset) -> list[Table]:
    """The tables of a design: of its parameters and of the blocks under it; by the spectrum those that have rows."""
    if site.attrs["method"] == "spectrum":
        return [table for table in (_design_table(site), _sequence_table(site)) if table.rows]
    return [_parameter_table(site), _block_table(site)]


def about_records(site: xr.Dataset) -> list[str]:
    """The records and their events, and how a sequence was made of each."""
    events, method = site["site_event"].values.tolist(), site.attrs["method"]
    each = zip(events, site["event_records"].values.tolist(), strict=True)
    names = listed([f"{name} ({count})" for name, count in each], LISTED)
    scaled = str(site.attrs["scaled_to"])
    target = "" if scaled == "none" else f"{scaled} {MEASURES[scaled.split()[0]].shown_unit}"
    records = {
        "records": counted(site.sizes["record"], "record"),
        "earthquakes": counted(len(events), "earthquake"),
        "names": names,
    }
    on_records = say(f"site.records.{'as_they_are' if scaled == 'none' else 'scaled'}", target=target, **records)
    weights = site.attrs["weights"]
    if method == "spectrum":
        return [on_records, say(f"site.spectra.{site.attrs['spectrum']}", weights=weights)]
    misfit, below = figure(_median(site["misfit"])), share(_median(site["unsafe_share"]))
    return [on_records, say("site.sequences", method=method, weights=weights, misfit=misfit, share=below)]


def _parameter_table(site: xr.Dataset) -> Table:
    """The parameters of the sequences of all records: lognormal, with intervals where they are known."""
    headings = (
        *(Heading(say(f"site.head.{name}")) for name in ("parameter", "median", "median_low", "median_high")),
        *(Heading(say(f"site.head.{name}"), note=say("site.of_logarithm")) for name in ("dispersion", "low", "high")),
        *(Heading(f"{percent} %", note=say("site.of_records")) for percent in (16, 50, 84)),
        Heading(say("site.head.design")),
    )
    spread = (f"{name}{end}" for name in ("median", "dispersion") for end in ("", "_lower", "_upper"))
    keys = (*spread, *(f"quantile_{percent}" for percent in (16, 50, 84)), "design")
    rows = []
    for name in site["parameter"].values.tolist():
        one = site.sel(parameter=name)
        words = named(f"parameters.{name}", str(one["parameter_name"].item()).partition(";")[0])
        label = Heading(words, _UNITS[str(one["parameter_unit"].item())]).label
        rows.append((Cell(label), *(number(_number(one, key)) for key in keys)))
    caption = say("site.caption.parameters", confidence=_percent(site, "confidence"))
    return Table("site-parameters", caption, headings, tuple(rows), (say("site.not_known", absent=ABSENT),))


def design(site: xr.Dataset) -> str:
    """The design sequence in a sentence."""
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    count, duration = value["main_count"], value["duration"]
    interval = _range(site.sel(parameter="main"), "design", lambda limit: figure(limit, "m/s"))
    return say(
        "site.design",
        quantile=general(_number(site, "quantile")),
        method=site.attrs["design"],
        main=figure(value["main"], "m/s"),
        confidence=_percent(site, "confidence"),
        interval=say("site.no_interval") if interval == ABSENT else interval,
        secondary=figure(value["ratio"] * value["main"], "m/s"),
        spacing=figure(value["interval"], "s"),
        impulses=say("site.no_limit") if math.isnan(count) else counted(round(count), "main_impulse"),
        within=say("site.for_ever") if math.isnan(duration) else say("site.within", time=figure(duration, "s")),
        kind=site.attrs["spacing"],
    )


def coverage(site: xr.Dataset) -> str:
    """The share of the recorded rotations that the design covers, of events it does not know; or its quantile."""
    if site.attrs["method"] == "spectrum":
        of = {"records": counted(int(site["record_count"]), "record")}
        of |= {"earthquakes": counted(int(site["event_count"]), "earthquake")}
        ends = {name: share(_number(site, name)) for name in ("quantile", "confidence")}
        return say("site.quantile", **of, **ends)
    inside, nominal = (share(_number(site, name)) for name in ("coverage_in_sample", "quantile"))
    covered = _number(site, "coverage")
    if math.isnan(covered):
        why = say(f"site.not_covered.{'one_event' if site.sizes['site_event'] == 1 else 'not_judged'}")
        told = [say("site.coverage_unknown", why=why, share=inside, nominal=nominal)]
    else:
        interval, level = _range(site, "coverage", share), say("site.one_event")
        if interval != ABSENT:
            level = say("site.with_confidence", confidence=_percent(site, "confidence"), interval=interval)
        told = [say("site.coverage", share=share(covered), level=level, nominal=nominal, inside=inside)]
    if not math.isnan(every := _number(site, "coverage_all")):
        told.append(say("site.coverage_all", share=share(every)))
    if judged := int(site["judged_pairs"]):
        events = counted(int(site["judged_events"]), "event")
        told.append(say("site.judged", pairs=counted(judged, "answer"), events=events))
    return " ".join(told)


def _block_table(site: xr.Dataset) -> Table:
    """The blocks under the design sequence."""
    rows = []
    for place, name in enumerate(site["block"].values.tolist()):
        one = site.isel(block=place)
        peak = _number(one, "design_rotation_ratio")
        verdict = number(peak, ratio)
        if math.isinf(peak):
            verdict = Cell(say("answer.overturns"), peak, grade="bad")
        c, covered = _number(one, "restitution"), _number(one, "block_coverage")
        rows.append((Cell(name), number(c, restitution), verdict, number(covered, share)))
    headings = (
        Heading(say("site.head.block"), width=34),
        Heading("C", note=say("head.restitution")),
        Heading(say("site.head.under"), note="theta_max/alpha_c"),
        Heading(say("site.coverage_head"), note=say("site.left_out")),
    )
    return Table("site-blocks", say("site.caption.blocks"), headings, tuple(rows))


def _design_table(site: xr.Dataset) -> Table:
    """What the design asks of every body, in effective impulses and as a factor."""
    quantile, confidence = (f"{general(100.0 * float(site[name]))} %" for name in ("quantile", "confidence"))
    headings = (
        Heading(say("head.body"), width=34),
        Heading("C", note=say("head.restitution")),
        Heading("I_eff", "m/s", say("site.note.effective", quantile=quantile)),
        Heading(say("site.head.interval", confidence=confidence)),
        Heading(say("site.head.overturns_at"), "m/s", "g tan(alpha)/p"),
        Heading(say("site.factor"), note=say("site.note.on_design")),
        Heading(say("site.head.overturned_by"), note=say("site.note.weight")),
    )
    speed = site["design_factor"] * site["effective_impulse"]
    rows = []
    for place, name in enumerate(site["block"].values.tolist()):
        one = site.isel(block=place)
        factor, effect = float(one["design_factor"]), float(one["effective_impulse"])
        if np.isnan(effect):
            continue
        over = say("site.factor_overturns", factor=ratio(factor))
        rows.append(
            (
                Cell(str(name)),
                number(float(one["restitution"]), restitution),
                number(effect),
                Cell(_range(one, "effective_impulse")),
                number(float(speed[place])),
                Cell(over, factor, grade="bad") if factor <= 1.0 else number(factor, ratio),
                number(float(one["overturned_share"]), share),
            )
        )
    return Table("site-design", say("site.caption.design"), headings, tuple(rows))


def _sequence_table(site: xr.Dataset) -> Table:
    """The sequence that stands for the design on every body, which is one of many of the same effect."""
    headings = (
        Heading(say("head.body"), width=34),
        Heading("I", "m/s", say("site.note.main")),
        Heading(say("site.head.interval_of", what="I")),
        Heading("I_s/I", note=say("site.note.half_waves")),
        Heading(say("site.head.interval_of", what="I_s/I")),
        Heading(say("site.head.number"), note=say("site.note.main_impulses")),
        Heading(say("site.head.its_interval")),
    )
    rows = []
    for place, name in enumerate(site["block"].values.tolist()):
        one = site.isel(block=place)
        cells = [Cell(str(name))]
        for key in ("main", "ratio", "main_count"):
            cells += [number(float(one[key])), Cell(_range(one, key))]
        if not np.isnan(float(one["main"])):
            rows.append(tuple(cells))
    return Table("site-sequence", say("site.caption.sequence"), headings, tuple(rows), (say("site.one_number"),))


def _spectrum_tables(spectra: xr.Dataset, site: xr.Dataset) -> list[Table]:
    """The quantiles of the spectrum over p at one restitution; nothing where too few earthquakes make it."""
    if spectra["spectrum_design"].isnull().any():
        return []
    at = spectra.sel(restitution=SHOWN_RESTITUTION, method="nearest")
    quantile, confidence = (f"{100.0 * float(site[name]):g} %" for name in ("quantile", "confidence"))
    columns = {"spectrum_50": "median", "spectrum_84": "84 %", "spectrum_design": quantile}
    shown = {title: key for key, title in columns.items()}  # of a quantile that is stated anyway the one of the design
    headings = (
        Heading("p", "1/s"),
        *(Heading(title, "m/s", "the design" if key == "spectrum_design" else "") for title, key in shown.items()),
        Heading(f"{confidence} interval"),
        Heading("I_s/I", note=say("site.note.half_waves")),
        Heading(say("site.head.number"), note=say("site.note.main_impulses")),
    )
    rows = []
    for place in range(0, at.sizes["p"], STEP):
        one = at.isel(p=place)
        numbers = [number(float(one[key])) for key in ("p", *shown.values(), "ratio", "main_count")]
        rows.append((*numbers[:-2], Cell(_range(one, "spectrum_design")), *numbers[-2:]))
    caption = (
        f"Effective impulse I_eff of blocks with C = {float(at['restitution']):g}; a body overturns at g tan(alpha)/p"
    )
    return [Table("site-spectrum", caption, headings, tuple(rows))]


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


def _percent(site: xr.Dataset, name: str) -> str:
    return f"{_number(site, name):.0%}"


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


def _coverage(site: xr.Dataset, blocks: Table) -> str:
    """Coverage over all blocks, then block by block or, of many, the extremes."""
    told = [
        coverage(site),
        f"{share(_number(site, 'lifted_share'))} of the pairs of record and block count (the record lifts the "
        f"block), {share(_number(site, 'standing_share'))} of these on blocks that the design leaves standing.",
    ]
    parts = [paragraph(line, "  ", "") for line in told]
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
