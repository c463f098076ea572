"""The verdict in sentences: what is safe, by which model, under what; and what it does not say, loudly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rockpulse.capacity_overview import THIN_MARGIN
from rockpulse.record_marks import doubt_notes, doubts
from rockpulse.report.answers import UPPER_BOUND
from rockpulse.report.events import CONFIDENCE, FEWEST_EVENTS, largest_share
from rockpulse.report.motions import Motions, several
from rockpulse.report.pairing import listed
from rockpulse.report.standing import Standing
from rockpulse.report.tables import share
from rockpulse.report.verdict import BodyVerdict, DemandVerdict, Grade
from rockpulse.terminal import figure, ratio

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Remark", "counted_by", "headline", "remarks"]

#: Bodies that are named one by one in a sentence.
NAMED = 6

#: Below this number of events the bound is said to rest on few.
FEW_EVENTS = 10

_HEADS = {
    Grade.SAFE: ("is safe under {these}", "are safe under {these}"),
    Grade.THIN: ("stands under {these}, but with hardly a margin", "stand under {these}, but with hardly a margin"),
    Grade.NO_MARGIN: ("stands, by an unknown margin", "stand, by an unknown margin"),
    Grade.NOT_KNOWN: (
        "cannot be called safe, for an answer is missing",
        "cannot be called safe, for answers are missing",
    ),
    Grade.NOT_SAFE: ("is not safe", "are not safe"),
}

_UNKNOWN_DEMAND = (
    "a record has no answer, or is so weak that the search for the safety factor ended below the demand ([search] "
    "factor_max)"
)

#: What is said in place of NOT_SAFE where an upper-bound type input overturns a body.
_NOT_SHOWN = ("is not shown to be safe", "are not shown to be safe")


@dataclass(frozen=True)
class Remark:
    """Something to be known before the numbers are used.

    Attributes
    ----------
    loud : bool
        Whether it takes from the verdict, or only explains it.
    head : str
        In a few words.
    text : str
        In a sentence or two.
    """

    loud: bool
    head: str
    text: str


def headline(summary: xr.Dataset, found: Sequence[BodyVerdict], motions: Motions, model: str) -> list[str]:
    """One sentence for every grade that occurs, from worst to best; then one for every demand.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    found : sequence of BodyVerdict
        Of all bodies.
    motions : Motions
        Under what.
    model : str
        By which model.
    """
    searched = any(not math.isnan(one.smallest) for one in found)
    how = "" if motions.kind == "sequence" else ", as recorded and weaker" if searched else ", as recorded"
    under = f"under {motions.counted()}{how}"
    sentences = []
    for grade in sorted(_HEADS, reverse=True):
        own = [one for one in found if one.overall == grade]
        if own:
            heads = _NOT_SHOWN if model == "resonance" and grade == Grade.NOT_SAFE else _HEADS[grade]
            head = heads[len(own) != 1].format(these="it" if motions.kind == "sequence" else "these")
            sentences.append(f"{_of(len(own), len(found))} {head}: {_named(own)}.")
    if not sentences:
        return ["There is no body to judge."]
    sentences[0] = f"By the {_model(model)}, {under}: {sentences[0][0].lower()}{sentences[0][1:]}"
    of_demands = zip(*(one.demands for one in found), strict=True)
    return [*sentences, *(_demand(summary, found, every, motions) for every in of_demands)]


def _demand(
    summary: xr.Dataset, found: Sequence[BodyVerdict], every: tuple[DemandVerdict, ...], motions: Motions
) -> str:
    """How the bodies stand under motions as strong as one demand."""
    name, total = every[0].name, len(every)
    asked = summary.sel(demand=name)
    strength = acceleration(float(asked["demand_acceleration"]))
    state = str(asked["limit_state"].item()) if "limit_state" in summary else ""
    met = sum(one.grade in (Grade.SAFE, Grade.THIN) for one in every)
    failing = [
        f"{one.body.name} ({ratio(against.smallest)})"
        for one, against in zip(found, every, strict=True)
        if against.grade == Grade.NOT_SAFE
    ]
    below = len(failing)
    unknown = total - met - below
    named = f": {listed(failing)}" if failing else ""
    return (
        f"Demand “{name}”, {strength}{f', {state}' if state else ''}: {met} of {several(total, 'body')} "
        f"{'stands' if met == 1 else 'stand'} under every {_noun(motions)} scaled to this PGA or below, "
        f"{below} {'does' if below == 1 else 'do'} not{named}"
        + (f"; of {unknown} it is not known: {_UNKNOWN_DEMAND}." if unknown else ".")
    )


def counted_by(model: str, motions: Motions, demanded: bool = False) -> str:
    """What is counted as safe, in so many words.

    Parameters
    ----------
    model : str
        By which model.
    motions : Motions
        Under what.
    demanded : bool
        Whether capacities are compared with a demand.
    """
    if motions.kind == "sequence":
        return (
            f"Counted as safe: a body that by the {_model(model)} neither the design sequence nor a weaker one (main "
            "impulse smaller, I_s/I kept) overturns. The safety factor is the smallest factor on the main impulse at "
            "which the body overturns."
        )
    each = "record" if motions.kind == "record" else "pair of channels, in any of its directions,"
    words = (
        f"Counted as safe: a body that by the {_model(model)} is overturned neither by any {each} as it is nor by a "
        "weaker copy of it: the safety factor (SF) is the smallest factor on the record at which the body overturns, "
        "and 1 or more is asked for. A body that rocks under a record but has SF below 1 is not counted as safe: "
        "rocking is not monotonic, a weaker record overturns it. Unresolved and unpredictable answers, and those "
        f"outside the range of the model, are not counted as safe either. Below {THIN_MARGIN:g} there is hardly a "
        "margin: a finer search may find a smaller factor."
    )
    if demanded:
        words += (
            " Capacity over demand asks whether the body stands under each record brought to the PGA of the demand, "
            "or below; a body that does not is not counted as safe either. It may meet a demand that is weaker than "
            "the records, and not be safe under them."
        )
    return words


def remarks(
    summary: xr.Dataset, found: Sequence[BodyVerdict], motions: Motions, model: str, failed: int, coverage: str = ""
) -> list[Remark]:
    """What the verdict does not say by itself, the gravest first.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    found : sequence of BodyVerdict
        Of all bodies.
    motions : Motions
        Under what.
    model : str
        By which model.
    failed : int
        Files and channels that failed.
    coverage : str
        What the site file says of its design, where there is one.
    """
    said: list[Remark | None] = [_doubtful(summary), _confidence(motions, found, coverage)]
    if model == "resonance":
        said.append(
            Remark(
                True,
                f"Judged by an {UPPER_BOUND}",
                "The resonance model lets every main impulse act at the worst moment. Its overturning says that a "
                "body may be unsafe, nothing more; it is no prediction.",
            )
        )
    elif model not in ("nonlinear", "auto"):
        said.append(
            Remark(
                True,
                f"Judged by the {model} model",
                "The full equation of motion (nonlinear) was not among the models; its verdicts may differ.",
            )
        )
    if failed:
        said.append(
            Remark(
                True,
                f"{failed} {'files or channels' if failed > 1 else 'file or channel'} failed",
                "They are no part of this verdict; see below.",
            )
        )
    said += [_doubt(kind, found, motions) for kind in (Standing.WEAKER_OVERTURNS, Standing.UNKNOWN, Standing.NO_MARGIN)]
    said += [_at_rest(found, motions), _drift(summary), _several_restitutions(found)]
    return [one for one in said if one is not None]


def _confidence(motions: Motions, found: Sequence[BodyVerdict], coverage: str) -> Remark:
    events = motions.event_count
    if motions.kind == "sequence":
        return Remark(
            True,
            "The confidence is that of the site calibration",
            "One design sequence says nothing of how often it is exceeded. "
            + (coverage or "The coverage in the site file does (rockpulse report --site)."),
        )
    if events < FEWEST_EVENTS:
        return Remark(
            True,
            "No confidence statement can be made",
            f"The motions come from {several(events, 'earthquake')}; records of one earthquake are no independent "
            f"observations, and fewer than {FEWEST_EVENTS} earthquakes say nothing of others. The verdict describes "
            f"these records, not the site.{motions.of_unknown_event()}",
        )
    best = share(largest_share(0, events))
    spared = sum(one.events_hit == 0 for one in found)
    least = (
        f" That holds for {several(spared, 'body')}; the table has the bound of each."
        if spared
        else " Every body is overturned, or may be, by at least one of them: the table has the bound of each."
    )
    few = events < FEW_EVENTS
    return Remark(
        few,
        f"With {CONFIDENCE:.0%} confidence" + (f", from {events} earthquakes only" if few else ""),
        f"A body that none of {events} earthquakes overturns may still be overturned by up to {best} of earthquakes "
        f"like these (upper bound, Clopper and Pearson), if they were drawn at random from those to be expected, which "
        f"chosen records seldom are.{least}{motions.of_unknown_event()}",
    )


def _doubt(kind: Standing, found: Sequence[BodyVerdict], motions: Motions) -> Remark | None:
    count, total = sum(one.counts[kind] for one in found), len(found) * len(motions.names)
    if not count:
        return None
    of = f"{count} of {total} cases ({_noun(motions)} and body)"
    if kind == Standing.WEAKER_OVERTURNS:
        return Remark(
            True,
            f"In {of} the body survives the motion as it is, but a weaker copy overturns it",
            "They are not counted as safe: the next record need not be as strong.",
        )
    if kind == Standing.UNKNOWN:
        return Remark(
            True,
            f"In {of} the answer is not known",
            "The model is unresolved or not predictable there, outside its range, or a weaker record may overturn the "
            "body; not counted as safe. The table of answers says which.",
        )
    return Remark(
        True,
        f"In {of} the margin was not computed",
        "No safety factor of the model was searched ([search] models): a weaker record may overturn the body.",
    )


def _at_rest(found: Sequence[BodyVerdict], motions: Motions) -> Remark | None:
    idle, total = sum(one.at_rest for one in found), len(motions.names)
    if not idle or motions.kind == "sequence":
        return None
    never = sum(one.never_lifted for one in found)
    head = f"In {idle} of {len(found) * total} cases ({_noun(motions)} and body) the body is not lifted"
    text = "Such motions are too weak to test it; they count as standing and say little of stronger ones. "
    if never:
        head = f"{_of(never, len(found))} {'is' if never == 1 else 'are'} lifted by none of these motions"
        text = (
            f"They are too weak to test it, and nothing else is said of such a body. In all, {idle} of "
            f"{len(found) * total} cases ({_noun(motions)} and body) count as standing because the body is not "
            "lifted. "
        )
    return Remark(bool(never), head, f"{text}The safety factor says how much stronger the motions might be.")


def _doubtful(summary: xr.Dataset) -> Remark | None:
    """Records whose peak may be that of a wrong unit, or cut off."""
    named = [name + mark for name, mark in doubts(summary).items() if mark]
    if not named:
        return None
    return Remark(
        True,
        f"The peak of {several(len(named), 'record')} is doubtful",
        f"{listed(named)}. {' '.join(doubt_notes(named))} Check them before this verdict is used.",
    )


def _drift(summary: xr.Dataset) -> Remark | None:
    count = int(summary["pgv_drift"].sum()) if "pgv_drift" in summary else 0
    if not count:
        return None
    return Remark(
        False,
        f"The baseline of {several(count, 'record')} drifts",
        "The velocity does not come back to zero: PGV may be off by as much, and the longest impulses with it.",
    )


def _several_restitutions(found: Sequence[BodyVerdict]) -> Remark | None:
    blocks = {one.body.block for one in found}
    if len(blocks) == len(found):
        return None
    return Remark(
        False,
        f"{several(len(blocks), 'block')} {'counts' if len(blocks) == 1 else 'count'} as {len(found)} bodies",
        "A block counts once for each restitution C that was given. Which holds is not known: judge it by the worst.",
    )


def _named(own: Sequence[BodyVerdict]) -> str:
    ordered = sorted(own, key=lambda one: math.inf if math.isnan(one.smallest) else one.smallest)
    words = [f"{one.body.name} ({_margin(one)})" for one in ordered[:NAMED]]
    more = [f"{len(own) - NAMED} more"] if len(own) > NAMED else []
    return ", ".join(words) + "".join(f" and {rest}" for rest in more)


def _margin(one: BodyVerdict) -> str:
    if math.isnan(one.smallest):
        return "no safety factor"
    decisive = [demand for demand in one.demands if demand.grade == one.overall > one.grade]
    if not decisive:
        return _own_margin(one)
    if one.overall == Grade.NOT_KNOWN:
        return f"{_own_margin(one)}, but it is not known at the demand “{decisive[0].name}”"
    worst = min(decisive, key=lambda demand: demand.smallest)
    return f"{_own_margin(one)}, but capacity over demand {ratio(worst.smallest)}"


def _own_margin(one: BodyVerdict) -> str:
    if math.isinf(one.smallest):
        found = "no overturning found" + ("" if math.isnan(one.limit) else f" up to a factor of {figure(one.limit)}")
        return f"never lifted, {found}" if one.never_lifted else found
    least = "at least " if one.smallest_bound else ""
    return f"{'never lifted, ' if one.never_lifted else ''}smallest SF {least}{ratio(one.smallest)}"


def _model(model: str) -> str:
    return f"{model} model ({UPPER_BOUND}, no prediction)" if model == "resonance" else f"{model} model"


def _of(count: int, total: int) -> str:
    return f"{count} of {several(total, 'body')}"


def _noun(motions: Motions) -> str:
    return {"record": "record", "pair": "pair of channels", "sequence": "sequence"}[motions.kind]


def acceleration(value: float) -> str:
    """An acceleration in m/s2 and g.

    Parameters
    ----------
    value : float
        [m/s2].
    """
    from rockpulse.record import STANDARD_GRAVITY

    return f"{figure(value, 'm/s²')} ({figure(value / STANDARD_GRAVITY, 'g')})"
