"""The parts of a report on a site calibration and on fragility curves that are shown beside the verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.config.configuration import stored_sections
from rockpulse.model_table import SEQUENCE_MODELS
from rockpulse.views.report.pairing import Paired
from rockpulse.views.report.remarks import files_words
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, number
from rockpulse.views.shared.terminal import share
from rockpulse.views.text.fragility import median_table, records_words, shown_measure, state_words, sufficiency_tables
from rockpulse.views.text.site import about_records, block_table, coverage, design, parameter_table, remarks
from rockpulse.views.text.site_spectrum import design_table, sequence_table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Part", "describe_fragility", "describe_site"]


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


def describe_site(words: Words, of: Paired, assessed: int) -> Part:
    """The section on the site; no record is assessed where its design sequence stands for them."""
    site = of.tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        said: tuple[str, ...] = (coverage(site),)
        tables = tuple(table for table in (design_table(site), sequence_table(site)) if table.rows)
    else:
        said = (design(site), coverage(site))
        tables = (parameter_table(site), block_table(site), _events(words, site), _every_record(words, site))
    return Part(
        (*_files(words, of), *of.other_motions(words, "site", assessed), *remarks(site)),
        (*about_records(site), *_common(words, of, site, assessed), *said),
        tables,
    )


def _files(words: Words, of: Paired) -> list[str]:
    """A sentence on the files that were not used for the site or the curves; none where all were."""
    files = files_used(of.tree)
    counted = files_words(words, files) or words("remark.files.none")
    return [f"{counted}: {files.reasons}."] if files.line else []


def _common(words: Words, of: Paired, site: xr.Dataset, assessed: int) -> list[str]:
    """The records and bodies that the site and the results have in common."""
    said = [words("site.common" if assessed else "site.judged", same=of.same, assessed=assessed)]
    if of.foreign:
        bodies, names = words.several(site.sizes["block"], "body"), words.listed([*of.foreign])
        said.append(words("site.foreign", bodies=bodies, count=len(of.foreign), names=names))
    return said


def _events(words: Words, site: xr.Dataset) -> Table:
    headings = (
        Heading(words("head.earthquake")),
        Heading(words("head.records")),
        Heading(words("site.coverage"), note=words("site.without_it")),
    )
    columns = (site[name].values.tolist() for name in ("site_event", "event_records", "event_coverage"))
    rows = tuple(
        (Cell(name), number(count, str), number(covered, share)) for name, count, covered in zip(*columns, strict=True)
    )
    return Table("site-events", words("site.earthquakes"), headings, rows)


def _every_record(words: Words, site: xr.Dataset) -> Table:
    headings = (
        *(Heading(words(key)) for key in ("head.record", "head.earthquake", "site.weight", "site.factor")),
        Heading("PGA", "m/s2"),
        Heading("PGV", "m/s"),
        Heading("I", "m/s"),
        Heading("I_s/I"),
        Heading("dT", "s"),
        Heading(words("site.main_impulses")),
        Heading(words("site.duration"), "s"),
        Heading(words("site.misfit"), note="ln, rms"),
        Heading(words("site.below"), note=words("site.of_blocks")),
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
    return Table("site-records", words("site.records"), headings, tuple(rows))


def describe_fragility(words: Words, of: Paired, assessed: int, model: str) -> Part:
    """The section on fragility beside a verdict by a model; no record is assessed where a sequence stands for them."""
    tree = of.tree
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=shown_measure(curves))
    statement = words(
        "fragility.from",
        records=words.shared(records_words(tree)),
        common=words("fragility.common" if assessed else "fragility.sequence", same=of.same, assessed=assessed),
        data=words(f"fragility.{tree.attrs['data']}"),
    )
    said = _remark_table(words, own)
    return Part(
        (*_files(words, of), *_differences(words, of, assessed, model)),
        (statement,),
        (median_table(tree), *((said,) if said.rows else ()), *sufficiency_tables(tree["efficiency"].to_dataset())),
        tuple(own["block"].values.tolist()),
        bool(own["median_low"].notnull().any()),
    )


def _differences(words: Words, of: Paired, assessed: int, model: str) -> list[str]:
    """Sentences on the things in which the curves and the verdict differ."""
    said = of.other_motions(words, "fragility", assessed)
    equation = stored_sections(str(of.tree.attrs.get("configuration", ""))).get("fragility", {}).get("equation", model)
    if equation != model and model not in SEQUENCE_MODELS:
        fields = {"equation": words.shared(equation), "model": words.shared(model)}
        said.append(words("fragility.equation", **fields))
    named = {"missing": of.missing, "foreign": of.foreign}
    return [*said, *(words(f"fragility.{key}", names=words.listed([*names])) for key, names in named.items() if names)]


def _remark_table(words: Words, own: xr.Dataset) -> Table:
    """Every remark on the curves of a body, with the limit states that it is on."""
    rows = []
    for block in own["block"].values.tolist():
        found: dict[str, list[str]] = {}
        for state in own["limit_state"].values.tolist():
            if said := str(own["statement"].sel(block=block, limit_state=state).item()):
                found.setdefault(said, []).append(state_words(state))
        rows += [(Cell(block), Cell(", ".join(states)), Cell(said)) for said, states in found.items()]
    headings = tuple(Heading(words(key)) for key in ("head.body", "fragility.limit_states", "fragility.remark"))
    return Table("fragility-remarks", words("fragility.remarks"), headings, tuple(rows))
