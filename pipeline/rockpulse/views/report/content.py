"""Collects the content of the report page as plain data for the HTML templates."""

import base64
import json
import math
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import BodyVerdict, verdicts
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import Config, config_from_text, stored_sections
from rockpulse.config.study_settings import PNG, UncertaintySettings, logo_bytes
from rockpulse.errors import ResultsError
from rockpulse.model_table import MODELS
from rockpulse.record.measures import PGA
from rockpulse.storage.hdf5.results_file import WRITTEN_BY
from rockpulse.studies.check.check import check
from rockpulse.views.report import record_tables as records
from rockpulse.views.report.answer_tables import AnswerCells, answer_table, count_table, record_table, table_notes
from rockpulse.views.report.report_warnings import limits, warnings
from rockpulse.views.report.site_and_fragility import MatchedFile, ReportSection, describe_fragility, describe_site
from rockpulse.views.report.verdict import (
    MOST,
    acceleration_in_words,
    basis,
    body_drawings,
    body_table,
    by_severity,
    cards,
    counted_by,
    priorities,
    ties,
)
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.formatting import ABSENT, restitution, six_digits, three_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell, Fact, Heading, Table
from rockpulse.views.shared.table_columns import columns, grade_cell, headed
from rockpulse.views.shared.verdict_table import verdict_legend
from rockpulse.views.shared.words import in_dates, own_name, say, translated
from rockpulse.views.text.check import check_notes, check_table

REFERENCE = (
    "C. Casapulla, A. Maione (2017), Rocking resonance conditions of large and slender rigid blocks under the "
    "intense phase of an earthquake, COMPDYN 2017, doi:10.7712/120117.5612.17190"
)

#: Properties of restraints in N or N/m, which are shown in kN or kN/m.
_IN_THOUSANDS = ("stiffness", "yield_force", "weight", "force")
_IN_MILLIONS = ("compressive_strength",)
#: Largest number of records listed under a body.
GOVERNING = 10
_ASSUMPTIONS = ("body", "impact", "motion", "uplift", "strength")
_NOT_COVERED = ("sliding", "flexible", "walls", "floors", "space", "soil", "hazard")


def page_content(
    tree: xr.DataTree,
    site: MatchedFile | None = None,
    fragility: MatchedFile | None = None,
    checked: xr.Dataset | str | None = None,
    full: bool = False,
) -> SimpleNamespace:
    """Collect the data of the page from the results and, if given, from a site file, a fragility file and code checks.

    Instead of code checks, `checked` may be the name of the file of their spectrum if this file is missing. `full`
    adds the configuration and the SHA-256 of the input files.
    """
    answers = answers_of(tree)
    summary, motions, model = answers.summary, answers.motions, answers.model
    found = verdicts(answers)
    cells = AnswerCells(answers)
    by_sequence = motions.kind == "sequence"
    assessed = 0 if by_sequence else summary.sizes["record"]
    configuration = str(tree.attrs.get("configuration", ""))
    sections = stored_sections(configuration)
    files, drawn = files_used(tree), body_drawings(tree)
    calibrated = None if site is None else site.tree["site"].to_dataset()
    motions_tree = site.tree if by_sequence and site else tree  # whose files were read
    said = warnings(answers, found, files, calibrated, str(sections.get("records", {}).get("components", "")))
    title = str(tree.attrs.get("title", ""))
    history = (line.partition(WRITTEN_BY) for line in str(tree.attrs.get("history", "")).splitlines())
    if configuration and not sections.get("site", {}).get("name"):
        title = say(f"page.title_by_{'sequence' if by_sequence else 'records'}")
    return SimpleNamespace(
        title=title,
        description=str(tree.attrs.get("site_description", "")),
        history=[
            say("page.written_by", when=in_dates(when.strip()).replace("Z", " UTC"), version=version) if by else when
            for when, by, version in history
        ],
        motions=motions,
        found=found,
        basis=basis(answers, files.counted),
        cards=cards(answers, found, drawn),
        drawings=drawn,
        limits=limits(said, found, answers),
        priorities=priorities(answers, found, checked if isinstance(checked, xr.Dataset) else None),
        verdict=(shown := body_table(answers, found)),
        cases=body_table(answers, found, every=True) if shown.footnotes else None,
        ties=ties(answers, found),
        check=None if checked is None else _code_checks(checked, found),
        legend=verdict_legend(answers, [row for one in found for row in one.findings]),
        used=records.used_table(answers),
        left_out=records.left_out_table(motions_tree),
        counted_by=counted_by(answers),
        warnings=said,
        counts=count_table(cells),
        answers=answer_table(cells),
        earthquakes=records.earthquake_table(answers),
        notes=tuple(table_notes(cells, found, UncertaintySettings(**sections.get("uncertainty", {})))),
        site=None if site is None else describe_site(site, assessed),
        fragility=None if fragility is None else describe_fragility(fragility, assessed, model),
        bodies=body_pages(cells, found, configuration),
        more=max(len(answers.blocks) - MOST, 0),  # number of blocks without a card on the first page
        records=record_pages(cells, full),
        reference=f"{REFERENCE} ({say('method.corrected')})",
        models=tuple(_model(name, name == model) for name in answers.models),
        assumptions=_assumptions(summary, sections.get("conditioning", {})),
        not_covered=tuple(_fact(f"not_covered.{name}") for name in _NOT_COVERED),
        versions=records.versions(tree),
        inputs=records.input_table(summary, full),
        failures=records.left_out_files(motions_tree),
        record_warnings=records.warning_table(summary),
        configuration=configuration if full else "",
    )


def _code_checks(checked: xr.Dataset | str, found: Sequence[BodyVerdict]) -> ReportSection:
    if isinstance(checked, str):
        return ReportSection((say("check.no_table", file=checked),), (), ())
    names = dict.fromkeys(one.body.block for one in sorted(found, key=by_severity))
    order = [name for name in names if name in checked["block"].values]
    spectrum = say("check.spectrum")
    notes = (*check_notes(checked), f"{spectrum[:1].upper()}{spectrum[1:]}.")
    return ReportSection((), (), (replace(check_table(checked, order), footnotes=notes),))


def code_checks(
    tree: xr.DataTree, config: Config | None = None, code: str | Sequence[str] | None = None
) -> xr.Dataset | str | None:
    """Return the code checks of the bodies, with [check] of `config` if it gives a spectrum, else of the results.

    Returns None if no spectrum or no body is given, or the name of the spectrum file if this file does not exist.
    If a `code` is requested, a missing spectrum or body raises ConfigError.
    """
    chosen = config_from_text(str(tree.attrs.get("configuration", "")))
    if config is not None and config.check.given:
        chosen = replace(chosen, check=config.check, folder=config.folder)
    if code is None and not (chosen.check.given and chosen.bodies):
        return None
    file = chosen.check.file
    if file is not None and not (chosen.folder / file).exists():
        return file
    return check(tree, chosen, code)


def _fact(key: str) -> Fact:
    return Fact(say(f"{key}.head"), (say(f"{key}.text"),))


def _model(name: str, judging: bool) -> Fact:
    """Describe a model as a fact; `judging` is true if the verdicts are based on this model."""
    heading = say(f"models.{name}")
    words = translated(f"model_words.{name}", MODELS[name].words) if name in MODELS else ""
    return Fact(say("method.judging", model=heading) if judging else heading, (words,))


def _assumptions(summary: xr.Dataset, conditioning: dict[str, object]) -> tuple[Fact, ...]:
    facts = [_fact(f"assumption.{name}") for name in _ASSUMPTIONS]
    acted = int((summary["vertical_channel"] != "").sum())
    vertical = say("assumption.vertical.none")
    if acted:
        vertical = say("assumption.vertical.acts", count=acted, total=summary.sizes["record"])
    facts.append(Fact(say("assumption.vertical.head"), (vertical,)))
    filters = [f"{name} = {conditioning[name]}" for name in ("highpass_hz", "lowpass_hz") if name in conditioning]
    if filters:
        words = say("assumption.filters.text", filters=", ".join(filters))
        facts.append(Fact(say("assumption.filters.head"), (words,)))
    return tuple(facts)


def parties(tree: xr.DataTree, config: Config | None = None) -> tuple[Fact, ...]:
    """Return project, client and author as stated in the configuration or in the results."""
    chosen = config_from_text(str(tree.attrs.get("configuration", ""))) if config is None else config
    given = {name: str(chosen.report[name]) for name in ("project", "client", "author")}
    return tuple(Fact(say(f"page.{name}"), (words,)) for name, words in given.items() if words)


def logo(tree: xr.DataTree, config: Config | None = None) -> str:
    """Return the logo as PNG in base64, from the configuration or from the results; empty without a logo."""
    if config is not None:
        return base64.b64encode(logo_bytes(config.report, config.folder)).decode("ascii")
    stored = str(tree.attrs.get("report_logo", ""))
    try:
        content = base64.b64decode(stored, validate=True)
    except ValueError:
        content = b""
    if stored and not content.startswith(PNG):
        raise ResultsError("report_logo: expected a PNG in base64, found something else in the results")
    return stored


def body_pages(cells: AnswerCells, found: list[BodyVerdict], configuration: str) -> list[SimpleNamespace]:
    """Collect the data of the section on each body (verdicts, facts, worst records); the worst verdict comes first."""
    answers = cells.answers
    given = {name: one for one in config_from_text(configuration).bodies for name in (one.name, own_name(one.name))}
    pages = []
    for place in dict.fromkeys(one.body.place for one in sorted(found, key=by_severity)):
        block = answers.blocks[place]
        own = [lane for lane, body in enumerate(answers.bodies) if body.place == place]
        cases = [f"C = {restitution(answers.bodies[lane].restitution)}: " if len(own) > 1 else "" for lane in own]
        pages.append(
            SimpleNamespace(
                key=f"body-{place}",
                place=place,
                name=block,
                verdicts=tuple(grade_cell(found[lane].deciding, case) for lane, case in zip(own, cases, strict=True)),
                facts=_of_block(answers, block, [answers.bodies[lane].restitution for lane in own], given.get(block)),
                governing=_governing(cells, own, place),
            )
        )
    return pages


def record_pages(cells: AnswerCells, full: bool) -> list[SimpleNamespace]:
    """Collect the data of the section on each record: its facts, its worst result, and all bodies."""
    answers = cells.answers
    pages = []
    for place, (record, event) in enumerate(zip(answers.records, answers["event"], strict=True)):
        worst = cells.verdict(place, cells.worst(place)) if answers.bodies else Cell(ABSENT)
        one = Known(answers.summary, record=record)
        impulse = f"I {three_digits(one.value('main_impulse'), 'm/s')}"
        brief = impulse if math.isnan(one.value(PGA)) else one.strength[0]
        pages.append(
            SimpleNamespace(
                key=f"record-{place}",
                name=cells.names[place].marked,
                place=place,
                words=", ".join(filter(None, (records.record_words(one), one.magnitude))),
                brief=brief,
                worst=worst._replace(text=say("worst", answer=f"{'P ' if answers.probable else ''}{worst.text}")),
                facts=_of_record(one, str(event), full),
                bodies=record_table(cells, place),
            )
        )
    return pages


def _of_block(answers: Answers, block: str, restitutions: list[float], given: BlockSettings | None) -> tuple[Fact, ...]:
    one = Known(answers.summary, block=block)
    known = one.number
    size = " × ".join(known(name, "m") for name in ("width", "height") if not math.isnan(one.value(name)))
    facts = {
        "size": say("fact.by_numbers") if math.isnan(one.value("width")) else size,
        "beside": one.support,
        "radius": one.radius,
        "alpha_c": one.critical_angle,
        "p": known("p", "1/s"),
        "slenderness": known("slenderness"),
        "rebound" if one.value("one_sided") else "restitution": ", ".join(map(restitution, restitutions)),
        "critical_impulse": known("critical_impulse", "m/s"),
    }
    lists: dict[str, tuple[str, ...]] = {name: (value,) for name, value in facts.items() if value}
    lists |= _weights(one, given) | {"warnings": one.lines("block_warnings")}
    return tuple(Fact(say(f"fact.{name}"), lines) for name, lines in lists.items() if lines)


def _weights(one: Known, given: BlockSettings | None) -> dict[str, tuple[str, ...]]:
    """Return mass, density, ties, loads, thrusts, floor modes and pedestals of a body, each as lines of text."""
    mass = one.real("mass")
    found: dict[str, tuple[str, ...]] = {
        "mass": () if math.isnan(mass) else (f"{six_digits(float(f'{mass:.3g}'))} kg",)
    }
    parts = {name: every for name, every in json.loads(one.text("restraints") or "{}").items() if name != "hinge"}
    parts |= {"floors": json.loads(one.text("floors") or "[]")}
    if given is not None:
        parts |= {"density": [{name: given[name] for name in ("density", "length", "compressive_strength")}]}
        parts |= {"pedestals": [{**pedestal} for pedestal in given.pedestals]}
    for name, every in parts.items():
        found[name] = tuple(filter(None, (", ".join(_numbers(part)) for part in every)))
    return found


def _numbers(part: dict[str, float | str | None]) -> list[str]:
    """Describe a restraint or support by its properties, without those that are not given or have no effect."""
    words = []
    for name, value in part.items():
        if isinstance(value, str):
            words.append(say(f"held.{value}"))
        elif value is not None and math.isfinite(value) and (value or name not in ("gap", "distance")):
            scale = 1e6 if name in _IN_MILLIONS else 1000.0 if name in _IN_THOUSANDS else 1.0
            words.append(say(f"held.{name}", value=six_digits(value / scale)))
    return words


def _governing(cells: AnswerCells, own: list[int], place: int) -> Table:
    """Return a table of the records with the smallest scale factors for the body with index `place`."""
    answers = cells.answers
    pairs = [(record, lane) for record in range(len(answers.records)) for lane in own]
    factor = np.where(np.isnan(answers[answers.factor]), np.inf, answers[answers.factor])
    order = sorted(pairs, key=lambda at: (factor[at], -cells.standing[at]))[:GOVERNING]
    selected = columns(*(["restitution"] if len(own) > 1 else []), PGA)
    further = cells.cells(selected, *zip(*order, strict=True)) if order else []

    def by_name(record: int) -> Cell:
        """Return a cell with earthquake, station and direction of a record or, if these are unknown, its id."""
        known, cell = Known(answers.summary, record=answers.records[record]), cells.record(record)
        return cell._replace(text=records.record_named(known, cell.text))

    rows = tuple((by_name(at[0]), *values, *cells.of(*at)) for at, values in zip(order, further, strict=True))
    headings = (Heading(say("head.record")), *headed(selected), *cells.short)
    caption = say("caption.governing" if len(pairs) > GOVERNING else "caption.each_record")
    return Table(f"body-{place}-records", caption, headings, rows)


def _of_record(one: Known, event: str, full: bool) -> tuple[Fact, ...]:
    known, own = one.number, one.words
    entries = {say("fact.source"): own("source")}
    entries |= {say("fact.sha256"): own("source_sha256")} if full else {}
    if one.value("npts") >= 0:
        angle = one.value("azimuth")
        azimuth = "" if math.isnan(angle) else f" ({say('direction.azimuth', angle=six_digits(angle))})"
        start, end = (known(f"intense_{side}", "s") for side in ("start", "end"))
        facts = {
            "component": f"{own('station')}, {one.component}{azimuth}",
            "station_name": own("station_name"),
            "start": in_dates(own("start_time")),
            "samples": say("fact.at_interval", count=one.value("npts"), interval=known("dt", "s")),
            "pga": acceleration_in_words(one.value(PGA)),
            "pgv": one.peak_velocity,
            "arias": known("arias_intensity", "m/s"),
            "intense": say("between", low=start, high=end),
        }
        entries |= {say("fact.earthquake"): records.event_name(event, one), **dict(one.stated)}
        entries |= {say(f"fact.{name}"): value for name, value in facts.items()}
    entries[say("fact.sequence")] = _sequence(one)
    lists = {name: one.lines(name) for name in ("processing", "warnings")}
    return (
        *(Fact(name, (value,)) for name, value in entries.items()),
        *(Fact(say(f"fact.{name}"), every) for name, every in lists.items() if every),
    )


def _sequence(one: Known) -> str:
    if math.isnan(one.value("main_impulse")):
        return say("fact.no_sequence")
    return say(
        "fact.sequence_of",
        main=one.number("main_impulse", "m/s"),
        secondary=one.number("secondary_impulse", "m/s"),
        interval=one.number("secondary_interval", "s"),
        duration=one.number("sequence_duration", "s"),
        count=one.main_count,
    )
