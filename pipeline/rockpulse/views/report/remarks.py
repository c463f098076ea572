"""The remarks of a report, to be known before its numbers are used: what decides, what limits, what only explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.demand import FARTHEST
from rockpulse.assessment.screens import sliding, worse_screens
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, BodyVerdict, Grade
from rockpulse.earthquakes import CONFIDENCE, FEWEST_EVENTS, probability_interval
from rockpulse.model_table import is_full, is_upper_bound
from rockpulse.remark import remarked
from rockpulse.views.report.statements import of_unknown_event
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.files_used import FilesUsed
from rockpulse.views.shared.record_marks import doubt_notes, record_cells
from rockpulse.views.text.site import coverage

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["GRADES", "Limit", "files_words", "limits", "remarks"]

#: From the gravest: what may turn a verdict over, what bounds it, what only explains it.
GRADES = ("decides", "limits", "notes")


@dataclass(frozen=True)
class Limit:
    """Something to be known before the numbers are used: in a few words, and in a sentence or two."""

    grade: Literal["decides", "limits", "notes"]
    head: str
    text: str


def remarks(
    words: Words,
    answers: Answers,
    found: Sequence[BodyVerdict],
    files: FilesUsed,
    site: xr.Dataset | None = None,
    components: str = "",
) -> list[Limit]:
    """Everything that the verdict on the bodies by a model does not say by itself, the gravest first.

    `files` says what failed; `site` is the node /site of a site file; `components` says
    which direction of a pair of channels was assessed ([records] components).
    """
    summary, motions = answers.summary, answers.motions
    said = [_doubtful(words, summary), *_few(words, found), *_of_model(words, answers), _unknown(words, answers, found)]
    if motions.kind == "sequence":
        said += [_not_compared(words, summary), *([] if site is None else _of_design(words, site, found))]
    said += [_confidence(words, motions, site), _at_rest(words, found, motions), _of_files(words, files)]
    said += [*_of_bodies(words, answers, found), _drift(words, answers), _several_restitutions(words, found)]
    if components == "horizontal" and motions.kind == "record":
        said.append(_limit(words, "notes", "as_recorded"))
    return sorted((one for one in said if one is not None), key=lambda one: GRADES.index(one.grade))


def limits(words: Words, said: Sequence[Limit], found: Sequence[BodyVerdict], motions: Motions) -> list[str]:
    """What limits the verdict, in three lines at most: what decides, how few the earthquakes are, what is left out."""
    grave = [one.head for one in said if one.grade == "decides"]
    lines = [words("limits.decides", heads="; ".join(grave[:2]), more=_more(words, grave[2:]))] if grave else []
    if motions.kind == "sequence":
        lines += [one.text for one in said if one.head == words("remark.site_confidence.head")]
    else:
        counts = [one.deciding.earthquakes if one.deciding else motions.event_count for one in found]
        fewest = min(counts, default=motions.event_count)
        most = words.ratio(float(probability_interval(0.0, fewest)[1]))
        lines.append(words("limits.earthquakes", events=words.several(fewest, "earthquake"), most=most))
    return [*lines, words("limits.not_covered")]


def _more(words: Words, rest: Sequence[str]) -> str:
    return words("limits.more", count=len(rest)) if rest else ""


def _limit(words: Words, grade: Literal["decides", "limits", "notes"], key: str, **fields: object) -> Limit:
    return Limit(grade, words(f"remark.{key}.head", **fields), words(f"remark.{key}.text", **fields))


def _of_model(words: Words, answers: Answers) -> list[Limit]:
    """The remark on a model that is not the full equation of motion."""
    if is_upper_bound(answers.model):
        return [_limit(words, "decides", "upper_bound", model=words.shared(answers.model))]
    if answers.motions.kind == "sequence":
        return [_limit(words, "notes", "sequence_model", model=words.shared(answers.model))]
    if not is_full(answers.model):
        return [_limit(words, "decides", "other_model", model=words.shared(answers.model))]
    return []


def _few(words: Words, found: Sequence[BodyVerdict]) -> list[Limit]:
    """The remarks on demands to which too few earthquakes can be brought."""
    most: dict[str, int] = {}
    for demand in (demand for one in found for demand in one.demands if demand.few):
        most[demand.name] = max(demand.earthquakes, most.get(demand.name, 0))
    fields = {"needed": FEWEST_AT_DEMAND, "most": f"{FARTHEST[1]:g}"}
    return [
        _limit(words, "decides", "few", name=name, events=words.several(count, "earthquake"), **fields)
        for name, count in most.items()
    ]


def _of_files(words: Words, files: FilesUsed) -> Limit | None:
    if not files.line:
        return None
    counted = files_words(words, files) or words("remark.files.none")
    return _limit(words, "limits", "files", counted=counted, reasons=files.reasons)


def files_words(words: Words, files: FilesUsed) -> str:
    """How many files were used and how many not, and the channels that failed; empty for none."""
    count, told = len(files.unused), []
    if count and files.used is None:
        told = [words("files.not_used", files=words.several(count, "file"))]
    elif files.used is not None and count:
        told = [words("files.used", used=files.used, files=words.several(files.used + count, "file"), unused=count)]
    return ", ".join([*told, *([words("files.channels", count=files.channels)] if files.channels else [])])


def _confidence(words: Words, motions: Motions, site: xr.Dataset | None) -> Limit:
    if motions.kind == "sequence":
        told = words("remark.site_confidence.ask") if site is None else words.shared(coverage(site))
        return _limit(words, "limits", "site_confidence", coverage=told)
    events = words.several(motions.event_count, "earthquake")
    few = words("remark.confidence.few", events=events, may=words.number(f"{MAY_OVERTURN:g}"))
    return _limit(
        words,
        "limits",
        "confidence",
        events=events,
        most=words.ratio(float(probability_interval(0.0, motions.event_count)[1])),
        confidence=words.share(CONFIDENCE),
        few=few if motions.event_count < FEWEST_EVENTS else "",
        unknown=of_unknown_event(words, motions),
    )


def _not_compared(words: Words, summary: xr.Dataset) -> Limit | None:
    """The remark that the demand of the site was not asked for: a sequence has no PGA."""
    compared = not any(remarked(str(codes), "demand_not_compared") for codes in summary["warning_codes"].values)
    return None if compared else _limit(words, "decides", "not_compared")


def _of_design(words: Words, site: xr.Dataset, found: Sequence[BodyVerdict]) -> list[Limit]:
    """The remarks on bodies that stand under the design of their site."""
    standing = [one for one in found if one.grade < Grade.MAY_OVERTURN]
    confidence = words.share(float(site["confidence"]))
    if site.attrs["method"] == "spectrum":
        within, fallen = _of_spectrum(words, site, standing)
        kind = "spectrum"
    else:
        within, fallen = _of_sequences(words, site, standing)
        kind = "sequences"
    said = []
    if within:
        said.append(_limit(words, "decides", f"within_{kind}", confidence=confidence, bodies=words.listed(within)))
    if fallen:
        said.append(_limit(words, "decides", f"fallen_{kind}", bodies=words.listed(fallen)))
    return said


def _of_sequences(words: Words, site: xr.Dataset, standing: Sequence[BodyVerdict]) -> tuple[list[str], list[str]]:
    """Bodies that overturn within the interval of the main impulse, and those that records of the site overturn."""
    factor = float(site["design_upper"].sel(parameter="main")) / float(site["design"].sel(parameter="main"))
    near = [one for one in standing if one.margin.smallest <= factor]
    within = [f"{one.body.name} ({words.shared('SF')} {words.ratio(one.margin.smallest)})" for one in near]
    overturned = np.isinf(site["rotation_ratio"].transpose("block", "record").values).sum(axis=1)
    named = zip(map(str, site["block"].values), overturned.tolist(), strict=True)
    fallen = [words("of_all", name=name, count=count, total=site.sizes["record"]) for name, count in named if count]
    return within, fallen


def _of_spectrum(words: Words, site: xr.Dataset, standing: Sequence[BodyVerdict]) -> tuple[list[str], list[str]]:
    """The same of a design spectrum, the fallen by their share of the weight."""
    names = [str(name) for name in site["block"].values]
    of = {name: site.isel(block=place) for place, name in enumerate(names)}
    own = {one.body.name: of[one.body.name] for one in standing if one.body.name in of}
    within = [name for name, one in own.items() if float(one["design_factor_lower"]) <= 1.0]
    shares = {name: float(one["overturned_share"]) for name, one in own.items()}
    return within, [f"{name} ({words.share(value)})" for name, value in shares.items() if value > 0.0]


def _of_bodies(words: Words, answers: Answers, found: Sequence[BodyVerdict]) -> list[Limit]:
    """Remarks on bodies that stand on a pedestal, and on those whose friction does not hold them."""
    said = []
    for alone, worst in worse_screens(answers, found):
        value = words.ratio(worst.decides.value)
        said.append(_limit(words, "limits", "pedestal", name=alone, worst=worst.body.name, value=value))
    for one in sliding(answers):
        told = {"total": words.several(one.total, "record"), "most": words.ratio(one.most)}
        own = words.number(f"{one.friction:g}")
        said.append(_limit(words, "decides", "slides", name=one.body.name, count=one.above, friction=own, **told))
    return said


def _unknown(words: Words, answers: Answers, found: Sequence[BodyVerdict]) -> Limit | None:
    """The remark that motions are left out of the probability."""
    count, total = sum(one.share.unknown for one in found), len(found) * len(answers.motions.names)
    if not count:
        return None
    why = "" if answers.probable else words("remark.unknown.why")
    return _limit(words, "decides", "unknown", count=count, total=total, why=why)


def _at_rest(words: Words, found: Sequence[BodyVerdict], motions: Motions) -> Limit | None:
    idle, total = sum(one.at_rest for one in found), len(motions.names) * len(found)
    if not idle or motions.kind == "sequence":
        return None
    never = sum(one.grade == Grade.STAYS for one in found)
    if never:
        bodies = words.several(len(found), "body")
        return _limit(words, "decides", "never_lifted", never=never, bodies=bodies, idle=idle, total=total)
    return _limit(words, "notes", "at_rest", idle=idle, total=total)


def _doubtful(words: Words, summary: xr.Dataset) -> Limit | None:
    """Records whose peak may be that of a wrong unit, or cut off."""
    named = [cell for cell in record_cells(summary) if cell.marks]
    if not named:
        return None
    notes = " ".join(map(words.shared, doubt_notes(named)))
    records = words.listed([cell.marked for cell in named])
    return _limit(words, "decides", "doubtful", count=words.several(len(named), "record"), records=records, notes=notes)


def _drift(words: Words, answers: Answers) -> Limit | None:
    count = int(answers["pgv_drift"].sum())
    return _limit(words, "limits", "drift", count=words.several(count, "record")) if count else None


def _several_restitutions(words: Words, found: Sequence[BodyVerdict]) -> Limit | None:
    blocks = {one.body.block for one in found}
    if len(blocks) == len(found):
        return None
    return _limit(
        words,
        "notes",
        "restitutions",
        blocks=words.several(len(blocks), "block"),
        bodies=words.several(len(found), "body"),
    )
