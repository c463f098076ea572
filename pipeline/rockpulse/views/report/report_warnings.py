"""The warnings of the report in three grades: warnings that may change a verdict, limit its use, or explain it."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.assessment.verdict import FEWEST_AT_DEMAND, MAY_OVERTURN, BodyVerdict, Grade, worse_with_pedestal
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
#: Grade of each warning; the others may change a verdict.
_GRADE = defaultdict(
    lambda: "decides",
    dict.fromkeys(("no_demand", "site_confidence", "confidence", "files", "drift", "given", "pedestal"), "limits")
    | dict.fromkeys(("sequence_model", "at_rest", "restitutions", "as_recorded"), "notes"),
)


@dataclass(frozen=True)
class Limit:
    """A warning in the report: its severity (``grade``), a heading, and one or two sentences."""

    grade: str
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
    named = _of_answers(answers, found, files, site, components)
    said = (
        Limit(_GRADE[key], *(say(f"warning.{key}.{part}", **fields) for part in ("head", "text")))
        for key, fields in named
    )
    return sorted(said, key=lambda one: GRADES.index(one.grade))


def _of_answers(
    answers: Answers, found: Sequence[BodyVerdict], files: FilesUsed, site: xr.Dataset | None, components: str
) -> Iterator[tuple[str, dict[str, object]]]:
    """Yield the key of each warning, and the fields of its text."""
    summary, motions, model = answers.summary, answers.motions, say(f"models.{answers.model}")
    sequence, deciding = motions.kind == "sequence", [one.deciding for one in found]
    codes = [str(one) for one in summary["warning_codes"].values]
    if doubted := [cell for cell in record_cells(summary) if cell.marks]:
        fields = {"count": counted_words(len(doubted), "record"), "notes": " ".join(doubt_notes(doubted))}
        yield "doubtful", {**fields, "records": listed([cell.marked for cell in doubted])}
    most: dict[str, int] = {}
    for demand in (demand for one in found for demand in one.demands if demand.few):
        most[demand.demand] = max(demand.earthquakes, most.get(demand.demand, 0))
    for name, count in most.items():
        fields = {"events": counted_words(count, "earthquake"), "most": six_digits(FARTHEST[1])}
        yield "few", {"name": name, "needed": FEWEST_AT_DEMAND, **fields}
    # The verdicts may not be computed with the full equation of motion.
    if is_upper_bound(answers.model):
        yield "upper_bound", {"model": model}
    elif sequence:
        yield "sequence_model", {"model": model}
    elif not is_full(answers.model):
        yield "other_model", {"model": model}
    if count := sum(one.share.unknown for one in found):
        why = "" if answers.probable else say("warning.unknown.why")
        yield "unknown", {"count": count, "total": len(found) * len(motions.names), "why": why}
    if sequence:
        if any(has_warning(own, "demand_not_compared") for own in codes):
            yield "not_compared", {}  # a sequence has no PGA
        yield from () if site is None else _of_design(site, found)
        covered = say("warning.site_confidence.ask") if site is None else coverage(site)
        yield "site_confidence", {"coverage": covered}
    elif answers.demands:
        count = _fewest(found, motions)
        events = counted_words(count, "earthquake")
        few = say("warning.confidence.few", events=events, may=six_digits(MAY_OVERTURN))
        few, unknown = few if count < FEWEST_EVENTS else "", of_unknown_event(motions)
        fields = {"most": _most(count), "confidence": share(CONFIDENCE)}
        yield "confidence", {"events": events, "few": few, "unknown": unknown, **fields}
    else:
        yield "no_demand", {"unknown": of_unknown_event(motions)}
    idle, total = (sum(getattr(one, name) for one in deciding) for name in ("at_rest", "motions"))
    if idle and not sequence:
        rests = (
            0 < one.at_rest == one.motions or (bool(one.demand) and one.largest_rotation == 0.0) for one in deciding
        )
        never, bodies = sum(rests), counted_words(len(found), "body")
        yield "never_lifted" if never else "at_rest", {"never": never, "bodies": bodies, "idle": idle, "total": total}
    if files.line:
        yield "files", {"counted": files.counted or say("warning.files.none"), "reasons": files.reasons}
    for alone, worst in worse_with_pedestal(answers, found):
        yield "pedestal", {"name": alone, "worst": body_name(worst.body.name), "value": ratio(worst.share.value)}
    if slid := [body_name(one.body.name) for one in found if one.deciding.slides_first or one.deciding.sliding > 0.0]:
        yield "slides", {"names": listed(slid)}
    of_blocks = zip(answers.blocks, summary["block_warning_codes"].values, strict=True)
    if endless := [body_name(name) for name, own in of_blocks if has_warning(str(own), "tie_unlimited")]:
        yield "ties", {"names": listed(endless)}
    if drifting := int(answers["pgv_drift"].sum()):
        yield "drift", {"count": counted_words(drifting, "record")}
    if given := sum(has_warning(own, "direction_given") for own in codes):
        yield "given", {"count": counted_words(given, "record")}
    blocks = {one.body.block for one in found}
    if len(blocks) < len(found):
        yield (
            "restitutions",
            {"blocks": counted_words(len(blocks), "block"), "bodies": counted_words(len(found), "body")},
        )
    if components == "horizontal" and motions.kind == "record":
        yield "as_recorded", {}


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


def _most(events: int) -> str:
    """Return, as text, the upper confidence limit of P for a body that none of the earthquakes overturns."""
    return share(float(probability_interval(np.zeros(events))[1]))


def _fewest(found: Sequence[BodyVerdict], motions: Motions) -> int:
    return min((one.deciding.earthquakes for one in found), default=motions.event_count)


def _of_design(site: xr.Dataset, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, dict[str, object]]]:
    """Warn of bodies that do not overturn under the design spectrum, but may within its confidence interval."""
    of = {str(name): site.isel(block=place) for place, name in enumerate(site["block"].values)}
    standing = (one.body.name for one in found if one.grade < Grade.MAY_OVERTURN)
    own = {body_name(name): of[name] for name in standing if name in of}
    if within := [name for name, one in own.items() if float(one["design_factor_lower"]) <= 1.0]:
        yield "within_spectrum", {"confidence": share(float(site["confidence"])), "bodies": listed(within)}
    shares = {name: float(one["overturned_share"]) for name, one in own.items()}
    if fallen := [f"{name} ({share(value)})" for name, value in shares.items() if value > 0.0]:
        yield "fallen_spectrum", {"bodies": listed(fallen)}
