"""Everything that the page shows, gathered from the results as plain data; the templates only lay it out."""

import base64
from dataclasses import dataclass

import xarray as xr

from rockpulse.assessment.answers import Motions, answers_of
from rockpulse.assessment.verdict import BodyVerdict, verdicts
from rockpulse.config.configuration import Config, config_from_text, stored_sections
from rockpulse.config.study_settings import PNG, UncertaintySettings, logo_bytes
from rockpulse.errors import ResultsError
from rockpulse.model_table import MODELS
from rockpulse.storage.hdf5.results_file import WRITTEN_BY
from rockpulse.views.report.answers import AnswerCells, answer_table, count_table, table_notes
from rockpulse.views.report.beside import Paired, Part, describe_fragility, describe_site
from rockpulse.views.report.pages import BodyPage, RecordPage, body_pages, record_pages
from rockpulse.views.report.records import (
    event_table,
    failure_table,
    input_table,
    left_out_table,
    used_table,
    versions,
    warning_table,
)
from rockpulse.views.report.remarks import Limit, limits, remarks
from rockpulse.views.report.verdict import MOST, Card, Drawing, basis, body_table, cards, counted_by, drawings, legend
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Fact, Table
from rockpulse.views.shared.words import named, say

REFERENCE = (
    "C. Casapulla, A. Maione (2017), Rocking resonance conditions of large and slender rigid blocks under the "
    "intense phase of an earthquake, COMPDYN 2017, doi:10.7712/120117.5612.17190"
)

_ASSUMPTIONS = ("body", "impact", "motion", "uplift", "strength")
_NOT_COVERED = ("sliding", "flexible", "walls", "floors", "space", "soil", "hazard")


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


def gather(tree: xr.DataTree, site: Paired | None = None, fragility: Paired | None = None) -> Content:
    """The content of the report on an assessment, with a site calibration and fragility curves where they are given."""
    answers = answers_of(tree)
    summary, motions, model = answers.summary, answers.motions, answers.model
    found = verdicts(answers)
    cells = AnswerCells(answers)
    by_sequence = motions.kind == "sequence"
    assessed = 0 if by_sequence else summary.sizes["record"]
    configuration = str(tree.attrs.get("configuration", ""))
    sections = stored_sections(configuration)
    files, drawn = files_used(tree), drawings(tree)
    calibrated = None if site is None else site.tree["site"].to_dataset()
    said = remarks(answers, found, files, calibrated, str(sections.get("records", {}).get("components", "")))
    title = str(tree.attrs.get("title", ""))
    if configuration and not sections.get("site", {}).get("name"):
        title = say(f"page.title_by_{'sequence' if by_sequence else 'records'}")
    return Content(
        title=title,
        description=str(tree.attrs.get("site_description", "")),
        history=tuple(map(_written, str(tree.attrs.get("history", "")).splitlines())),
        motions=motions,
        found=tuple(found),
        basis=basis(answers, files.counted),
        cards=tuple(cards(answers, found, drawn)),
        drawings=tuple(drawn),
        limits=tuple(limits(said, found, motions)),
        verdict=body_table(answers, found),
        legend=legend(answers),
        used=used_table(answers),
        left_out=left_out_table(site.tree if by_sequence and site else tree),
        counted_by=counted_by(answers),
        remarks=tuple(said),
        counts=count_table(answers),
        answers=answer_table(cells),
        earthquakes=event_table(answers),
        notes=tuple(table_notes(cells, found, UncertaintySettings(**sections.get("uncertainty", {})))),
        site=None if site is None else describe_site(site, assessed),
        fragility=None if fragility is None else describe_fragility(fragility, assessed, model),
        bodies=tuple(body_pages(cells, found)),
        records=tuple(record_pages(cells)),
        reference=f"{REFERENCE} ({say('method.corrected')})",
        models=tuple(_model(name, name == model) for name in answers.models),
        assumptions=_assumptions(summary, sections.get("conditioning", {})),
        not_covered=tuple(_fact(f"not_covered.{name}") for name in _NOT_COVERED),
        versions=versions(tree),
        inputs=input_table(summary),
        failures=failure_table(tree),
        warnings=warning_table(summary),
        configuration=configuration,
    )


def _written(line: str) -> str:
    """A line of the history of a file."""
    when, by, version = line.partition(WRITTEN_BY)
    return say("page.written_by", when=when, version=version) if by else line


def _model(name: str, judging: bool) -> Fact:
    """A model with what it is; the verdict counts the one that is judging."""
    shown = say(f"models.{name}")
    words = named(f"model_words.{name}", MODELS[name].words) if name in MODELS else ""
    return Fact(say("method.judging", model=shown) if judging else shown, (words,))


def _assumptions(summary: xr.Dataset, conditioning: dict[str, object]) -> tuple[Fact, ...]:
    """The assumptions behind the numbers, those on vertical acceleration and filters as the results tell them."""
    facts = [_fact(f"assumption.{name}") for name in _ASSUMPTIONS]
    acted = int((summary["vertical_channel"] != "").sum())
    vertical = say("assumption.vertical.none")
    if acted:
        vertical = say("assumption.vertical.acts", count=acted, total=summary.sizes["record"])
    facts.append(Fact(say("assumption.vertical.head"), (vertical,)))
    filters = [f"{name} = {conditioning[name]}" for name in ("highpass_hz", "lowpass_hz") if name in conditioning]
    if filters:
        told = say("assumption.filters.text", filters=", ".join(filters))
        facts.append(Fact(say("assumption.filters.head"), (told,)))
    return tuple(facts)


def _fact(key: str) -> Fact:
    return Fact(say(f"{key}.head"), (say(f"{key}.text"),))


def parties(tree: xr.DataTree, config: Config | None = None) -> tuple[Fact, ...]:
    """Project, client and author, those that are given: by a configuration, else by the one in the results."""
    chosen = config_from_text(str(tree.attrs.get("configuration", ""))) if config is None else config
    given = {name: str(chosen.report[name]) for name in ("project", "client", "author")}
    return tuple(Fact(say(f"page.{name}"), (told,)) for name, told in given.items() if told)


def logo(tree: xr.DataTree, config: Config | None = None) -> str:
    """The PNG of the logo in base64, of a configuration or of the results; empty where there is none."""
    if config is not None:
        return base64.b64encode(logo_bytes(config.report, config.folder)).decode("ascii")
    stored = str(tree.attrs.get("report_logo", ""))
    try:
        content = base64.b64decode(stored, validate=True)
    except ValueError as error:
        raise ResultsError("report_logo: expected a PNG in base64, found something else in the results") from error
    if stored and not content.startswith(PNG):
        raise ResultsError("report_logo: expected a PNG in base64, found something else in the results")
    return stored
