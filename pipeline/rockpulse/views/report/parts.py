"""The parts of a report on a site calibration and on fragility curves that are shown beside the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.config.configuration import stored_sections
from rockpulse.ladder import SEQUENCE_MODELS
from rockpulse.views.report.pairing import Paired, listed
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import several, share
from rockpulse.views.text.fragility import median_table, records_words, shown_measure, state_words, sufficiency_tables
from rockpulse.views.text.site import about_records, block_table, coverage, design, parameter_table, remarks
from rockpulse.views.text.site_spectrum import design_table, sequence_table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Part", "describe_fragility", "describe_site"]

_DATA = {
    "ida": "every record scaled until it first reaches the limit state",
    "stripes": "records scaled to given levels",
    "cloud": "records as they are",
}


@dataclass(frozen=True)
class Part:
    """A section of the report: loud remarks, sentences, tables.

    ``blocks`` names the bodies that have curves; ``banded`` says whether any of these has a confidence band.
    """

    remarks: tuple[str, ...]
    statements: tuple[str, ...]
    tables: tuple[Table, ...]
    blocks: tuple[str, ...] = ()
    banded: bool = True


def describe_site(of: Paired, assessed: int) -> Part:
    """The section on the site; no record is assessed where its design sequence stands for them."""
    site = of.tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        said: tuple[str, ...] = (coverage(site),)
        tables = tuple(table for table in (design_table(site), sequence_table(site)) if table.rows)
    else:
        said = (design(site), coverage(site))
        tables = (parameter_table(site), block_table(site), _events(site), _every_record(site))
    return Part(
        (*_files(of), *of.other_motions("The calibration and its design are", assessed), *remarks(site)),
        (*about_records(site), *_common(of, site, assessed), *said),
        tables,
    )


def _files(of: Paired) -> list[str]:
    """A sentence on the files that were not used for the site or the curves; none where all were."""
    return [sentence] if (sentence := files_used(of.tree).line) else []


def _common(of: Paired, site: xr.Dataset, assessed: int) -> list[str]:
    """The records and bodies that the site and the results have in common."""
    if not assessed:
        said = ["The verdict of this report is that of its design sequence."]
    else:
        said = [
            f"{of.same} of its records are among the {assessed} assessed here. The design sequence is no part of the "
            "verdict, which is on the records themselves."
        ]
    if of.foreign:
        said.append(
            f"Judged on {several(site.sizes['block'], 'body')}, of which {len(of.foreign)} "
            f"{'is' if len(of.foreign) == 1 else 'are'} not among those assessed here: {listed(of.foreign)}."
        )
    return said


def _events(site: xr.Dataset) -> Table:
    headings = (
        Heading("earthquake"),
        Heading("records"),
        Heading("coverage", note="by the design made without it"),
    )
    columns = (site[name].values.tolist() for name in ("site_event", "event_records", "event_coverage"))
    rows = tuple(
        (Cell(name), number(count, str), number(covered, share)) for name, count, covered in zip(*columns, strict=True)
    )
    return Table("site-events", "Earthquakes of the calibration", headings, rows)


def _every_record(site: xr.Dataset) -> Table:
    headings = (
        *map(Heading, ("record", "earthquake", "weight", "factor")),
        Heading("PGA", "m/s2"),
        Heading("PGV", "m/s"),
        Heading("I", "m/s"),
        Heading("I_s/I"),
        Heading("dT", "s"),
        Heading("main impulses"),
        Heading("duration", "s"),
        Heading("misfit", note="ln, rms"),
        Heading("below recorded", note="share of blocks"),
    )
    rows = []
    for place, name in enumerate(site["record"].values.tolist()):
        one = site.isel(record=place)
        rows.append(
            (
                Cell(name),
                Cell(one["event"].item()),
                *(number(float(one[key])) for key in ("weight", "scale_factor", "pga", "pgv")),
                *map(number, one["value"].transpose("parameter").values.tolist()),
                number(float(one["misfit"])),
                number(float(one["unsafe_share"]), share),
            )
        )
    caption = "Records of the calibration and the sequence of each"
    return Table("site-records", caption, headings, tuple(rows))


def describe_fragility(of: Paired, assessed: int, model: str) -> Part:
    """The section on fragility beside a verdict by a model; no record is assessed where a sequence stands for them."""
    tree = of.tree
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=shown_measure(curves))
    common = (
        "the verdict is of a design sequence" if not assessed else f"{of.same} of them among the {assessed} assessed"
    )
    statement = f"From {records_words(tree)} ({common}); {_DATA[tree.attrs['data']]}."
    said = _remark_table(own)
    return Part(
        (*_files(of), *_differences(of, assessed, model)),
        (statement,),
        (median_table(tree), *((said,) if said.rows else ()), *sufficiency_tables(tree["efficiency"].to_dataset())),
        tuple(own["block"].values.tolist()),
        bool(own["median_low"].notnull().any()),
    )


def _differences(of: Paired, assessed: int, model: str) -> list[str]:
    """Sentences on the things in which the curves and the verdict differ."""
    said = of.other_motions("The curves are", assessed)
    equation = stored_sections(str(of.tree.attrs.get("configuration", ""))).get("fragility", {}).get("equation", model)
    if equation != model and model not in ("auto", *SEQUENCE_MODELS):
        said.append(f"The curves are by the {equation} equation of motion, the verdict is by the {model} model.")
    if of.missing:
        said.append(f"Without curves, for the fragility file lacks them: {listed(of.missing)}.")
    if of.foreign:
        said.append(f"Left out, for they are not among the bodies assessed here: the curves of {listed(of.foreign)}.")
    return said


def _remark_table(own: xr.Dataset) -> Table:
    """Every remark on the curves of a body, with the limit states that it is on."""
    rows = []
    for block in own["block"].values.tolist():
        found: dict[str, list[str]] = {}
        for state in own["limit_state"].values.tolist():
            if said := str(own["statement"].sel(block=block, limit_state=state).item()):
                found.setdefault(said, []).append(state_words(state))
        rows += [(Cell(block), Cell(", ".join(states)), Cell(said)) for said, states in found.items()]
    headings = (Heading("body"), Heading("limit states"), Heading("remark"))
    return Table("fragility-remarks", "Remarks on the curves", headings, tuple(rows))
