"""Everything that the page shows, gathered from the results as plain data; the templates only lay it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.assessment.answers import Motions, answers_of
from rockpulse.assessment.verdict import BodyVerdict, verdicts
from rockpulse.config.configuration import stored_sections
from rockpulse.views.report.answers import AnswerCells, answer_table, count_table
from rockpulse.views.report.bodies import body_table, event_table
from rockpulse.views.report.caveats import Caveat, caveats
from rockpulse.views.report.method import REFERENCE, assumptions, models_in_use, not_covered
from rockpulse.views.report.notes import table_notes
from rockpulse.views.report.pages import BodyPage, RecordPage, body_pages, record_pages
from rockpulse.views.report.pairing import Paired
from rockpulse.views.report.parts import Part, describe_fragility, describe_site
from rockpulse.views.report.provenance import failure_table, input_table, versions, warning_table
from rockpulse.views.report.statements import counted_by, headline
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Fact, Table

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Content", "gather"]


@dataclass(frozen=True)
class Content:
    """The page in data; ``found`` are the verdicts on all bodies, ``counted_by`` explains its words."""

    title: str
    description: str
    history: tuple[str, ...]
    motions: Motions
    found: tuple[BodyVerdict, ...]
    headline: tuple[str, ...]
    counted_by: str
    caveats: tuple[Caveat, ...]
    verdict: Table
    counts: Table
    answers: Table
    earthquakes: Table
    notes: tuple[str, ...]
    site: Part | None
    fragility: Part | None
    bodies: tuple[BodyPage, ...]
    records: tuple[RecordPage, ...]
    reference: str
    models: tuple[Fact, ...]
    assumptions: tuple[Fact, ...]
    not_covered: tuple[Fact, ...]
    versions: tuple[Fact, ...]
    inputs: Table
    failures: Table
    warnings: Table
    configuration: str


def gather(tree: xr.DataTree, site: Paired | None = None, fragility: Paired | None = None) -> Content:
    """The content of the report on an assessment, with a site calibration and fragility curves where they are given."""
    answers = answers_of(tree)
    summary, motions, model = answers.summary, answers.motions, answers.model
    found = verdicts(answers)
    cells = AnswerCells(answers)
    assessed = 0 if motions.kind == "sequence" else summary.sizes["record"]
    sections = stored_sections(str(tree.attrs.get("configuration", "")))
    files = files_used(tree)
    return Content(
        title=str(tree.attrs.get("title", "")),
        description=str(tree.attrs.get("site_description", "")),
        history=tuple(str(tree.attrs.get("history", "")).splitlines()),
        motions=motions,
        found=tuple(found),
        headline=tuple(headline(answers, found, files.counted)),
        counted_by=counted_by(answers),
        caveats=tuple(
            caveats(
                answers,
                found,
                files,
                None if site is None else site.tree["site"].to_dataset(),
                str(sections.get("records", {}).get("components", "")),
            )
        ),
        verdict=body_table(answers, found),
        counts=count_table(answers),
        answers=answer_table(cells),
        earthquakes=event_table(answers),
        notes=tuple(table_notes(cells, found)),
        site=None if site is None else describe_site(site, assessed),
        fragility=None if fragility is None else describe_fragility(fragility, assessed, model),
        bodies=tuple(body_pages(cells, found)),
        records=tuple(record_pages(cells)),
        reference=REFERENCE,
        models=models_in_use(summary, model),
        assumptions=assumptions(tree),
        not_covered=not_covered(),
        versions=versions(tree),
        inputs=input_table(summary),
        failures=failure_table(tree),
        warnings=warning_table(summary),
        configuration=str(tree.attrs.get("configuration", "")),
    )
