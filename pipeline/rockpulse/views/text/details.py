"""One record or one block of an assessment as text."""

import math

import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.export.selection import Selection, unknown
from rockpulse.views.shared.columns import doubt
from rockpulse.views.shared.facts import Known
from rockpulse.views.shared.table import Cell
from rockpulse.views.shared.terminal import ABSENT, figure, paragraph, restitution
from rockpulse.views.text.lists import case_list, worst_first
from rockpulse.views.text.margins import capacities
from rockpulse.views.text.overview import is_large
from rockpulse.views.text.verdicts import factor_table, probability_table, verdict_table

#: Cases of a record or block that are shown where there are too many for all.
WORST = 20


def record_details(summary: xr.Dataset, record: str) -> str:
    """All that is known of one record; a ResultsError for an id that is not in the results."""
    answers = _only(summary, "record", record)
    one = Known(answers.summary, record=record)
    number, words, pga = one.number, one.words, one.value("pga")
    marks = doubt(pga, one.value("warning_codes"))
    strength = Cell(f"{figure(pga, 'm/s2')} ({figure(pga / STANDARD_GRAVITY, 'g')})", marks=marks).marked
    rows = [
        *(("in words", told) for told in (one.described,) if told),
        ("source", words("source")),
        ("sha256 of the source", words("source_sha256")),
        ("station, component", f"{words('station')}, {words('component')} (azimuth {number('azimuth', 'degrees')})"),
        ("name of the station", words("station_name")),
        ("earthquake", words("event")),
        *one.stated,
        ("start", words("start_time")),
        ("samples", f"{one.value('npts')} at {number('dt', 's')}"),
        ("PGA", strength),
        ("PGV", one.peak_velocity),
        ("Arias intensity", number("arias_intensity", "m/s")),
        ("intense phase", f"{number('intense_start', 's')} to {number('intense_end', 's')}"),
        ("half-waves in all", str(one.value("half_wave_count"))),
        ("main impulse I", number("main_impulse", "m/s")),
        ("secondary impulse I_s", number("secondary_impulse", "m/s")),
        ("interval dT", number("secondary_interval", "s")),
        ("duration of the sequence", number("sequence_duration", "s")),
        ("main impulses", ABSENT if math.isnan(one.value("main_impulse")) else one.main_count),
        *(("processing", step) for step in one.lines("processing")),
        *(("warning", warning) for warning in one.lines("warnings")),
    ]
    return _page(record, rows, answers, "block")


def block_details(summary: xr.Dataset, block: str) -> str:
    """All that is known of one block; a ResultsError for a name that is not in the results."""
    answers = _only(summary, "block", block)
    one = Known(answers.summary, block=block)
    number, restitutions = one.number, [body.restitution for body in answers.bodies]
    asked = [one.impact_friction(c) for c in restitutions]
    friction = f"{', '.join(map(figure, asked))} in its instant, for information"
    rows = [
        ("width, height", f"{number('width', 'm')}, {number('height', 'm')}"),
        ("half the diagonal R", one.radius),
        ("critical angle alpha_c", number("alpha_c", "rad")),
        ("frequency parameter p", number("p", "1/s")),
        ("slenderness", number("slenderness")),
        *((("beside", one.support),) if one.support else ()),
        *([("friction of an impact", friction)] if asked[0] else []),
        ("rebound e" if one.value("one_sided") else "restitution C", ", ".join(map(restitution, restitutions))),
        ("critical impulse I_1c", number("critical_impulse", "m/s")),
        *(("warning", warning) for warning in one.lines("block_warnings")),
    ]
    return _page(block, rows, answers, "record")


def _page(title: str, rows: list[tuple[str, str]], answers: Answers, of: str) -> str:
    """The facts, then the answers: their lines are named by record or by block as `of` says."""
    width = max(len(name) for name, _ in rows)
    head = [title, *(paragraph(text, " " * (width + 4), f"  {name.ljust(width)}  ") for name, text in rows), ""]
    if is_large(answers):
        words = (outcome.name.lower().replace("_", " ") for outcome in Outcome)
        told = ", ".join(f"{count} {word}" for count, word in zip(answers.counts, words, strict=True))
        verdicts = f"{sum(answers.counts)} verdicts by the {answers.model} model: {told}."
        worst = case_list(answers.summary, worst_first(answers, Selection(limit=WORST)))
        return "\n".join([*head, verdicts, "", worst])
    factors = probability_table(answers) + factor_table(answers)
    return "\n".join([*head, verdict_table(answers.summary), "", *capacities(answers, of), factors])


def _only(summary: xr.Dataset, dimension: str, label: str) -> Answers:
    """The answers of one record or block, read."""
    known = [str(item) for item in summary[dimension].values]
    if label not in known:
        raise unknown(label, known, dimension)
    return Answers(summary.isel({dimension: [known.index(label)]}).load())
