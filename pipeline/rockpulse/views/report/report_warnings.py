"""The warnings of the report in three grades: warnings that may change a verdict, limit its use, or explain it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import (
    FEWEST_AT_DEMAND,
    MAY_OVERTURN,
    BodyVerdict,
    Grade,
    worse_with_pedestal,
)
from rockpulse.earthquakes import CONFIDENCE, FEWEST_EVENTS, probability_interval
from rockpulse.model_table import is_full, is_upper_bound
from rockpulse.views.shared.files_used import FilesUsed
from rockpulse.views.shared.formatting import ratio, share, six_digits
from rockpulse.views.shared.table_columns import doubt_notes, record_cells
from rockpulse.views.shared.verdict_table import of_unknown_event
from rockpulse.views.shared.words import body_name, counted_words, listed, say
from rockpulse.views.text.site import coverage
from rockpulse.warning_text import has_warning

#: Grades of warnings: may change a verdict, limits its use, or only explains it.
GRADES = ("decides", "limits", "notes")


@dataclass(frozen=True)
class Limit:
    """A warning in the report: its severity (``grade``), a heading, and one or two sentences."""

    grade: Literal["decides", "limits", "notes"]
    head: str
    text: str


def warnings(
    answers: Answers,
    found: Sequence[BodyVerdict],
    files: FilesUsed,
    site: xr.Dataset | None = None,
    components: str = "",
) -> list[Limit]:
    """Return the warnings on the verdicts, the most serious first; `components` is the option in [records]."""
    summary, motions = answers.summary, answers.motions
    said = [_doubtful(summary), *_few(found), *_of_model(answers), _unknown(answers, found)]
    if motions.kind == "sequence":
        if any(has_warning(str(codes), "demand_not_compared") for codes in summary["warning_codes"].values):
            said.append(_limit("decides", "not_compared"))  # a sequence has no PGA
        said += [] if site is None else _of_design(site, found)
    if answers.demands or motions.kind == "sequence":
        said.append(_confidence(found, motions, site))
    else:
        said.append(_limit("limits", "no_demand", unknown=of_unknown_event(motions)))
    said.append(_at_rest(found, motions))
    if files.line:
        counted = files.counted or say("warning.files.none")
        said.append(_limit("limits", "files", counted=counted, reasons=files.reasons))
    said += _of_bodies(answers, found)
    if drifting := int(answers["pgv_drift"].sum()):
        said.append(_limit("limits", "drift", count=counted_words(drifting, "record")))
    if given := sum(has_warning(str(codes), "direction_given") for codes in summary["warning_codes"].values):
        said.append(_limit("limits", "given", count=counted_words(given, "record")))
    blocks = {one.body.block for one in found}
    if len(blocks) < len(found):
        words = {"blocks": counted_words(len(blocks), "block"), "bodies": counted_words(len(found), "body")}
        said.append(_limit("notes", "restitutions", **words))
    if components == "horizontal" and motions.kind == "record":
        said.append(_limit("notes", "as_recorded"))
    return sorted((one for one in said if one is not None), key=lambda one: GRADES.index(one.grade))


def limits(said: Sequence[Limit], found: Sequence[BodyVerdict], answers: Answers) -> list[str]:
    """Return the lines on the limits of the verdicts: serious warnings, missing data, and effects not considered."""
    grave = [one.head for one in said if one.grade == "decides"]
    more = say("limits.more", count=len(grave) - 2) if len(grave) > 2 else ""
    lines = [say("limits.decides", heads="; ".join(grave[:2]), more=more)] if grave else []
    if answers.motions.kind == "sequence":
        lines += [one.text for one in said if one.head == say("warning.site_confidence.head")]
    elif not answers.demands:
        head = say("warning.no_demand.head")
        lines.append(f"{head[:1].upper()}{head[1:]}.")
    else:
        fewest = _fewest(found, answers.motions)
        lines.append(say("limits.earthquakes", events=counted_words(fewest, "earthquake"), most=_most(fewest)))
    return [*lines, say("limits.not_covered", what=listed(_not_covered(answers.summary)))]


def _not_covered(summary: xr.Dataset) -> list[str]:
    """Return the effects that are not considered, with the number of bodies for which their data are missing."""
    count = summary.sizes["block"]

    def without(*names: str) -> int:
        given = [summary[name].values for name in names if name in summary]
        stated = [own > 0 if own.dtype.kind in "if" else own != "" for own in given]
        return count - int(np.count_nonzero(np.any(stated, axis=0))) if stated else count

    lacking = {"sliding": without("friction"), "walls": without("one_sided", "restraints"), "floors": without("floors")}
    found = [say(f"limits.{name}", bodies=counted_words(own, "body")) for name, own in lacking.items() if own]
    return [*found, say("limits.others")]


def _limit(grade: Literal["decides", "limits", "notes"], key: str, **fields: object) -> Limit:
    return Limit(grade, say(f"warning.{key}.head", **fields), say(f"warning.{key}.text", **fields))


def _of_model(answers: Answers) -> list[Limit]:
    """Warn if the verdicts are not computed with the full equation of motion."""
    if is_upper_bound(answers.model):
        return [_limit("decides", "upper_bound", model=say(f"models.{answers.model}"))]
    if answers.motions.kind == "sequence":
        return [_limit("notes", "sequence_model", model=say(f"models.{answers.model}"))]
    if not is_full(answers.model):
        return [_limit("decides", "other_model", model=say(f"models.{answers.model}"))]
    return []


def _few(found: Sequence[BodyVerdict]) -> list[Limit]:
    """Warn if records of too few earthquakes can be scaled to a demand."""
    most: dict[str, int] = {}
    for demand in (demand for one in found for demand in one.demands if demand.few):
        most[demand.demand] = max(demand.earthquakes, most.get(demand.demand, 0))
    fields = {"needed": FEWEST_AT_DEMAND, "most": six_digits(FARTHEST[1])}
    return [
        _limit("decides", "few", name=name, events=counted_words(count, "earthquake"), **fields)
        for name, count in most.items()
    ]


def _most(events: int) -> str:
    """Return, as text, the upper confidence limit of P for a body that none of the earthquakes overturns."""
    return share(float(probability_interval(np.zeros(events))[1]))


def _fewest(found: Sequence[BodyVerdict], motions: Motions) -> int:
    return min((one.deciding.earthquakes for one in found), default=motions.event_count)


def _confidence(found: Sequence[BodyVerdict], motions: Motions, site: xr.Dataset | None) -> Limit:
    if motions.kind == "sequence":
        covered = say("warning.site_confidence.ask") if site is None else coverage(site)
        return _limit("limits", "site_confidence", coverage=covered)
    count = _fewest(found, motions)
    events = counted_words(count, "earthquake")
    few = say("warning.confidence.few", events=events, may=six_digits(MAY_OVERTURN))
    return _limit(
        "limits",
        "confidence",
        events=events,
        most=_most(count),
        confidence=share(CONFIDENCE),
        few=few if count < FEWEST_EVENTS else "",
        unknown=of_unknown_event(motions),
    )


def _of_design(site: xr.Dataset, found: Sequence[BodyVerdict]) -> list[Limit]:
    """Warn of bodies that do not overturn under the design spectrum, but may within its confidence interval."""
    standing = [one for one in found if one.grade < Grade.MAY_OVERTURN]
    confidence = share(float(site["confidence"]))
    names = [str(name) for name in site["block"].values]
    of = {name: site.isel(block=place) for place, name in enumerate(names)}
    own = {one.body.name: of[one.body.name] for one in standing if one.body.name in of}
    within = [name for name, one in own.items() if float(one["design_factor_lower"]) <= 1.0]
    shares = {name: float(one["overturned_share"]) for name, one in own.items()}
    fallen = [f"{body_name(name)} ({share(value)})" for name, value in shares.items() if value > 0.0]
    said = []
    if within:
        bodies = listed([body_name(name) for name in within])
        said.append(_limit("decides", "within_spectrum", confidence=confidence, bodies=bodies))
    if fallen:
        said.append(_limit("decides", "fallen_spectrum", bodies=listed(fallen)))
    return said


def _of_bodies(answers: Answers, found: Sequence[BodyVerdict]) -> list[Limit]:
    """Warn of bodies that may slide, with ties of unlimited elongation, or with a worse verdict on their pedestal."""
    said = []
    for alone, worst in worse_with_pedestal(answers, found):
        value = ratio(worst.share.value)
        said.append(_limit("limits", "pedestal", name=alone, worst=body_name(worst.body.name), value=value))
    slid = [one.body.name for one in found if one.deciding.slides_first or one.deciding.sliding > 0.0]
    if slid:
        said.append(_limit("decides", "slides", names=listed([body_name(name) for name in slid])))
    codes = zip(answers.blocks, answers.summary["block_warning_codes"].values, strict=True)
    if endless := [body_name(name) for name, own in codes if has_warning(str(own), "tie_unlimited")]:
        said.append(_limit("decides", "ties", names=listed(endless)))
    return said


def _unknown(answers: Answers, found: Sequence[BodyVerdict]) -> Limit | None:
    count, total = sum(one.share.unknown for one in found), len(found) * len(answers.motions.names)
    if not count:
        return None
    why = "" if answers.probable else say("warning.unknown.why")
    return _limit("decides", "unknown", count=count, total=total, why=why)


def _at_rest(found: Sequence[BodyVerdict], motions: Motions) -> Limit | None:
    idle, total = (sum(getattr(one.deciding, name) for one in found) for name in ("at_rest", "motions"))
    if not idle or motions.kind == "sequence":
        return None
    every = [one.deciding for one in found]
    never = sum(0 < one.at_rest == one.motions or (bool(one.demand) and one.largest_rotation == 0.0) for one in every)
    if never:
        bodies = counted_words(len(found), "body")
        return _limit("decides", "never_lifted", never=never, bodies=bodies, idle=idle, total=total)
    return _limit("notes", "at_rest", idle=idle, total=total)


def _doubtful(summary: xr.Dataset) -> Limit | None:
    named = [cell for cell in record_cells(summary) if cell.marks]
    if not named:
        return None
    notes = " ".join(doubt_notes(named))
    records = listed([cell.marked for cell in named])
    return _limit("decides", "doubtful", count=counted_words(len(named), "record"), records=records, notes=notes)
