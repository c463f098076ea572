"""What the report says of a site calibration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.views.report.pairing import Paired, listed
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import ABSENT, figure, ratio, restitution, several, share

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SitePart", "coverage_of", "describe_site"]

_UNITS = {"m s-1": "m/s", "s": "s", "1": "-"}


@dataclass(frozen=True)
class SitePart:
    """The section on the site.

    Attributes
    ----------
    remarks : tuple of str
        What the calibration cannot tell, the gravest first.
    statements : tuple of str
        Records, design sequence and coverage in sentences.
    tables : tuple of Table
        Parameters, blocks, events, records.
    """

    remarks: tuple[str, ...]
    statements: tuple[str, ...]
    tables: tuple[Table, ...]


def describe_site(of: Paired, assessed: int) -> SitePart:
    """The section on the site.

    Parameters
    ----------
    of : Paired
        A site file, beside the results.
    assessed : int
        Records of the assessment; 0 where the design of this site stands for them.
    """
    site = of.tree["site"].to_dataset()
    remarks = tuple(line for line in str(site["remarks"].item()).splitlines() if line)
    return SitePart(
        (*of.other_motions("The calibration and its design are", assessed), *remarks),
        (*_records(site), *_common(of, site, assessed), _design(site), coverage_of(site)),
        (_parameters(site), _blocks(site), _events(site), _every_record(site)),
    )


def _common(of: Paired, site: xr.Dataset, assessed: int) -> list[str]:
    if not assessed:
        said = ["The verdict of this report is that of its design sequence."]
    else:
        said = [
            f"{of.same} of its records are among the {assessed} assessed here. The design sequence is no part of the "
            "verdict, which is on the records themselves."
        ]
    if of.foreign:
        total = site.sizes["block"]
        said.append(
            f"Judged on {several(total, 'body')}, of which {len(of.foreign)} "
            f"{'is' if len(of.foreign) == 1 else 'are'} not among those assessed here: {listed(of.foreign)}."
        )
    return said


def _records(site: xr.Dataset) -> tuple[str, ...]:
    attributes = site.attrs
    scaled = "not scaled" if attributes["scaled_to"] == "none" else f"scaled to {attributes['scaled_to']}"
    return (
        f"Calibrated on {several(site.sizes['record'], 'record')} of "
        f"{several(site.sizes['site_event'], 'earthquake')}, {scaled}; the sequence of each record by the method "
        f"“{attributes['method']}”; weights: “{attributes['weights']}”.",
    )


def _design(site: xr.Dataset) -> str:
    design = {str(name): float(site["design"].sel(parameter=name)) for name in site["parameter"].values}
    count = "without limit" if math.isnan(design["main_count"]) else f"{design['main_count']:.0f}"
    within = "for ever" if math.isnan(design["duration"]) else f"within {figure(design['duration'], 's')}"
    low, high = (float(site[f"design_{end}"].sel(parameter="main")) for end in ("lower", "upper"))
    band = "no interval" if math.isnan(low) and math.isnan(high) else f"{_number(low)} to {_number(high)}"
    return (
        f"Design sequence (quantile {float(site['quantile']):g} of the recorded rotations, method "
        f"“{site.attrs['design']}”): I = {figure(design['main'], 'm/s')} ({float(site['confidence']):.0%} confidence: "
        f"{band}), I_s = {figure(design['ratio'] * design['main'], 'm/s')}, ΔT = {figure(design['interval'], 's')}, "
        f"main impulses: {count} {within}, spacing “{site.attrs['spacing']}”."
    )


def coverage_of(site: xr.Dataset) -> str:
    """Which share of recorded rotations the design covers, of earthquakes that it does not know.

    Parameters
    ----------
    site : xarray.Dataset
        The node /site.
    """
    known = {name: float(site[name]) for name in ("coverage", "coverage_lower", "coverage_upper", "quantile")}
    pairs, events = (int(site[f"judged_{name}"]) for name in ("pairs", "events"))
    judged = f"{several(pairs, 'pair')} of record and block of {several(events, 'event')}"
    if math.isnan(known["coverage"]):
        return "Whether the design covers other earthquakes is not known: nothing could be left out to try it on."
    return (
        f"A design made without the event of a record covers {share(known['coverage'])} "
        f"({float(site['confidence']):.0%} confidence: {share(known['coverage_lower'])} to "
        f"{share(known['coverage_upper'])}) of the recorded rotations of the blocks that it leaves standing; it was to "
        f"cover {share(known['quantile'])}. Judged on {judged}."
    )


def _parameters(site: xr.Dataset) -> Table:
    headings = (
        Heading("parameter"),
        Heading("unit"),
        *(Heading(title) for title in ("median", "median, low", "median, high")),
        *(Heading(title, note="of the logarithm") for title in ("dispersion", "low", "high")),
        *(Heading(f"{percent} %", note="of the records") for percent in (16, 50, 84)),
        Heading("design"),
    )
    names = ("median", "median_lower", "median_upper", "dispersion", "dispersion_lower", "dispersion_upper")
    rows = []
    for label in site["parameter"].values:
        one = site.sel(parameter=label)
        values = [float(one[name]) for name in (*names, "quantile_16", "quantile_50", "quantile_84", "design")]
        unit = _UNITS.get(str(one["parameter_unit"].item()), str(one["parameter_unit"].item()))
        rows.append((Cell(str(one["parameter_name"].item()).split(";")[0]), Cell(unit), *map(number, values)))
    caption = f"Parameters of the sequence, lognormal; intervals of {float(site['confidence']):.0%}, clustered by event"
    return Table("site-parameters", caption, headings, tuple(rows))


def _blocks(site: xr.Dataset) -> Table:
    headings = (
        Heading("block"),
        Heading("C", note="restitution"),
        Heading("under the design", note="θ_max/α_c"),
        Heading("coverage", note="its event left out"),
    )
    rows = []
    for name in site["block"].values:
        one = site.sel(block=name)
        peak, covered = float(one["design_rotation_ratio"]), float(one["block_coverage"])
        fallen = math.isinf(peak)
        rows.append(
            (
                Cell(str(name)),
                Cell(restitution(float(one["restitution"])), float(one["restitution"])),
                Cell("overturns" if fallen else ratio(peak), peak, grade="bad" if fallen else ""),
                Cell(share(covered), covered),
            )
        )
    return Table("site-blocks", "The blocks under the design sequence", headings, tuple(rows))


def _events(site: xr.Dataset) -> Table:
    headings = (
        Heading("earthquake"),
        Heading("records"),
        Heading("coverage", note="by the design made without it"),
    )
    rows = [
        (Cell(str(name)), Cell(str(count), float(count)), Cell(share(float(covered)), float(covered)))
        for name, count, covered in zip(
            site["site_event"].values, site["event_records"].values, site["event_coverage"].values, strict=True
        )
    ]
    return Table("site-events", "Earthquakes of the calibration", headings, tuple(rows))


def _every_record(site: xr.Dataset) -> Table:
    headings = (
        Heading("record"),
        Heading("earthquake"),
        *(Heading(title) for title in ("weight", "factor", "PGA [m/s²]", "PGV [m/s]")),
        *(Heading(title) for title in ("I [m/s]", "I_s/I", "ΔT [s]", "main impulses", "duration [s]")),
        Heading("misfit", note="ln, rms"),
        Heading("below recorded", note="share of blocks"),
    )
    rows = []
    for place, name in enumerate(site["record"].values):
        one = site.isel(record=place)
        below = float(one["unsafe_share"])
        rows.append(
            (
                Cell(str(name)),
                Cell(str(one["event"].item())),
                *(number(float(one[key])) for key in ("weight", "scale_factor", "pga", "pgv")),
                *(number(float(found)) for found in one["value"].transpose("parameter").values),
                number(float(one["misfit"])),
                Cell(share(below), below),
            )
        )
    caption = "Records of the calibration and the sequence of each"
    return Table("site-records", caption, headings, tuple(rows))


def _number(value: float) -> str:
    return "no limit" if math.isinf(value) else ABSENT if math.isnan(value) else figure(value, "m/s")
