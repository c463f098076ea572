"""Everything that the page shows, gathered from the results as plain data; the templates only lay it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.assessment.answers import Motions, answers_of
from rockpulse.assessment.verdict import BodyVerdict, verdicts
from rockpulse.config.configuration import stored_sections
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.views.report.answers import AnswerCells, answer_table, count_table
from rockpulse.views.report.bodies import body_table, event_table
from rockpulse.views.report.front import MOST, Card, Drawing, cards, drawings
from rockpulse.views.report.method import REFERENCE, assumptions, models_in_use, not_covered
from rockpulse.views.report.notes import table_notes
from rockpulse.views.report.pages import BodyPage, RecordPage, body_pages, record_pages
from rockpulse.views.report.pairing import Paired
from rockpulse.views.report.parts import Part, describe_fragility, describe_site
from rockpulse.views.report.provenance import failure_table, input_table, versions, warning_table
from rockpulse.views.report.records_used import left_out_table, used_table
from rockpulse.views.report.remarks import Limit, files_words, limits, remarks
from rockpulse.views.report.statements import basis, counted_by, legend
from rockpulse.views.report.wording import Words
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
    basis: str
    cards: tuple[Card, ...]
    drawings: tuple[Drawing, ...]
    limits: tuple[str, ...]
    verdict: Table
    legend: str
    used: Table
    left_out: Table
    counted_by: str
    remarks: tuple[Limit, ...]
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

    @property
    def more(self) -> int:
        """The number of blocks that have no card on the first page."""
        return max(len(self.bodies) - MOST, 0)


def gather(words: Words, tree: xr.DataTree, site: Paired | None = None, fragility: Paired | None = None) -> Content:
    """The content of the report on an assessment, with a site calibration and fragility curves where they are given."""
    answers = answers_of(tree)
    summary, motions, model = answers.summary, answers.motions, answers.model
    found = verdicts(answers)
    cells = AnswerCells(words, answers)
    assessed = 0 if motions.kind == "sequence" else summary.sizes["record"]
    sections = stored_sections(str(tree.attrs.get("configuration", "")))
    files, drawn = files_used(tree), drawings(words, tree)
    calibrated = None if site is None else site.tree["site"].to_dataset()
    components = str(sections.get("records", {}).get("components", ""))
    said = remarks(words, answers, found, files, calibrated, components)
    return Content(
        title=words.shared(str(tree.attrs.get("title", ""))),
        description=str(tree.attrs.get("site_description", "")),
        history=tuple(map(words.shared, str(tree.attrs.get("history", "")).splitlines())),
        motions=motions,
        found=tuple(found),
        basis=basis(words, answers, files_words(words, files)),
        cards=tuple(cards(words, answers, found, drawn)),
        drawings=tuple(drawn),
        limits=tuple(limits(words, said, found, motions)),
        verdict=body_table(words, answers, found),
        legend=legend(words, answers),
        used=used_table(words, answers),
        left_out=left_out_table(words, site.tree if motions.kind == "sequence" and site else tree),
        counted_by=counted_by(words, answers),
        remarks=tuple(said),
        counts=count_table(words, answers),
        answers=answer_table(cells),
        earthquakes=event_table(words, answers),
        notes=tuple(table_notes(cells, found, UncertaintySettings(**sections.get("uncertainty", {})))),
        site=None if site is None else describe_site(words, site, assessed),
        fragility=None if fragility is None else describe_fragility(words, fragility, assessed, model),
        bodies=tuple(body_pages(cells, found)),
        records=tuple(record_pages(cells)),
        reference=f"{REFERENCE} ({words('method.corrected')})",
        models=models_in_use(words, summary, model),
        assumptions=assumptions(words, tree),
        not_covered=not_covered(words),
        versions=versions(tree),
        inputs=input_table(words, summary),
        failures=failure_table(words, tree),
        warnings=warning_table(words, summary),
        configuration=str(tree.attrs.get("configuration", "")),
    )
