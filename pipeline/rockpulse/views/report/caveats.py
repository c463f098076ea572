"""The caveats of a report, to be known before its numbers are used: what the verdict does not say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import MAY_OVERTURN, BodyVerdict, Grade
from rockpulse.ladder import UPPER_BOUND, is_upper_bound
from rockpulse.motions.events import CONFIDENCE, FEWEST_EVENTS, share_interval
from rockpulse.remark import Remark, remarked
from rockpulse.views.report.pairing import listed
from rockpulse.views.report.statements import of_bodies, of_unknown_event
from rockpulse.views.shared.files_used import FilesUsed
from rockpulse.views.shared.record_marks import doubt_notes, record_cells
from rockpulse.views.shared.terminal import figure, ratio, several, share
from rockpulse.views.shared.verdict_notes import body_notes, noun
from rockpulse.views.text.site import coverage

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Caveat", "caveats"]

#: Below this number of events the bound is said to rest on few.
FEW_EVENTS = 10


@dataclass(frozen=True)
class Caveat:
    """Something to be known before the numbers are used: in a few words, and in a sentence or two.

    A loud one takes from the verdict; another one only explains it.
    """

    loud: bool
    head: str
    text: str


def caveats(
    answers: Answers,
    found: Sequence[BodyVerdict],
    files: FilesUsed,
    site: xr.Dataset | None = None,
    components: str = "",
) -> list[Caveat]:
    """Everything that the verdict on the bodies by a model does not say by itself, the gravest first.

    `files` says what failed; `site` is the node /site of a site file; `components` says
    which direction of a pair of channels was assessed ([records] components).
    """
    summary, motions, model = answers.summary, answers.motions, answers.model
    said: list[Caveat | None] = [_doubtful(summary), _confidence(motions, site)]
    if motions.kind == "sequence":
        said += [_not_compared(summary), *([] if site is None else _of_design(site, found))]
    if is_upper_bound(model):
        said.append(
            Caveat(
                True,
                f"Judged by an {UPPER_BOUND}",
                f"The {model} model lets every main impulse act at the worst moment. Its overturning says that a "
                "body may be unsafe, nothing more; it is no prediction.",
            )
        )
    elif motions.kind == "sequence":
        said.append(Caveat(False, f"Judged by the {model} model", "The equation of motion itself needs a record."))
    elif model not in ("nonlinear", "auto"):
        said.append(
            Caveat(
                True,
                f"Judged by the {model} model",
                "The full equation of motion (nonlinear) was not among the models; its verdicts may differ.",
            )
        )
    if files.line:
        head = files.counted or "A pattern or a table names records that were not read"
        said.append(Caveat(True, head, f"No part of this verdict, see below: {files.reasons}."))
    said += [Caveat(True, "Not modelled as it may move", note) for note in body_notes(answers, found)]
    said += [_doubt(answers, found), _at_rest(found, motions), _drift(answers), _several_restitutions(found)]
    if components == "horizontal" and motions.kind == "record":
        said.append(
            Caveat(
                False,
                "Every channel is taken as it was recorded",
                "Its direction need not be that in which a body can rock: for a wall or façade of known direction set "
                '[records] components = "azimuth".',
            )
        )
    return [one for one in said if one is not None]


def _confidence(motions: Motions, site: xr.Dataset | None) -> Caveat:
    events = motions.event_count
    if motions.kind == "sequence":
        return Caveat(
            True,
            "The confidence is that of the site calibration",
            "One design sequence says nothing of how often it is exceeded. "
            + ("The coverage in the site file does (rockpulse report --site)." if site is None else coverage(site)),
        )
    most = ratio(float(share_interval(0.0, events)[1]))
    few = events < FEWEST_EVENTS
    return Caveat(
        events < FEW_EVENTS,
        f"The verdict rests on {several(events, 'earthquake')}",
        f"Records of one earthquake are no independent observations. A body that none of {events} overturns may still "
        f"be overturned by up to {most} of the motions of earthquakes like these (upper end of an interval of "
        f"{CONFIDENCE:.0%}), if they were drawn at random from those to be expected, which chosen records seldom are. "
        + (f"{several(events, 'earthquake')} cannot tell a probability of {MAY_OVERTURN:g}. " if few else "")
        + f"The table has the interval of each body.{of_unknown_event(motions)}",
    )


def _not_compared(summary: xr.Dataset) -> Caveat | None:
    """The caveat that the demand of the site was not asked for: a sequence has no PGA."""
    if not any(remarked(str(codes), "demand_not_compared") for codes in summary["warning_codes"].values):
        return None
    told = str(Remark("demand_not_compared"))
    return Caveat(True, "The demand of the site is not checked", f"{told[0].upper()}{told[1:]}.")


def _of_design(site: xr.Dataset, found: Sequence[BodyVerdict]) -> list[Caveat]:
    """The caveats of a body that stands under the design sequence of its site."""
    said = []
    standing = [one for one in found if one.grade < Grade.MAY_OVERTURN]
    if site.attrs["method"] == "spectrum":
        return _of_spectrum(site, standing)
    low, high = (float(site[f"design_{end}"].sel(parameter="main")) for end in ("lower", "upper"))
    factor = high / float(site["design"].sel(parameter="main"))
    within = [f"{one.body.name} (SF {ratio(one.margin.smallest)})" for one in standing if one.margin.smallest <= factor]
    if within:
        said.append(
            Caveat(
                True,
                f"Within the {float(site['confidence']):.0%} interval of the design's main impulse "
                f"({figure(low)} to {figure(high, 'm/s')}) it overturns {listed(within)}",
                f"Its upper end is {ratio(factor)} times the design.",
            )
        )
    overturned = np.isinf(site["rotation_ratio"].transpose("block", "record").values).sum(axis=1)
    fallen = [
        f"{name} ({count} of {site.sizes['record']})"
        for name, count in zip(map(str, site["block"].values), overturned.tolist(), strict=True)
        if count
    ]
    if fallen:
        said.append(
            Caveat(
                True,
                f"Records of the site, scaled as they were calibrated, overturn {listed(fallen)}",
                "The design covers a share of the recorded rotations, not all; assess the records themselves too.",
            )
        )
    return said


def _of_spectrum(site: xr.Dataset, standing: Sequence[BodyVerdict]) -> list[Caveat]:
    """The caveats of a body that stands under the design spectrum of its site."""
    names = [str(name) for name in site["block"].values]
    of = {name: site.isel(block=place) for place, name in enumerate(names)}
    own = {one.body.name: of[one.body.name] for one in standing if one.body.name in of}
    said = []
    within = [name for name, one in own.items() if float(one["design_factor_lower"]) <= 1.0]
    if within:
        said.append(
            Caveat(
                True,
                f"Within the {float(site['confidence']):.0%} interval of the design it overturns {listed(within)}",
                "The interval is that of the effective impulse, earthquakes resampled.",
            )
        )
    fallen = [
        f"{name} ({share(float(one['overturned_share']))})"
        for name, one in own.items()
        if float(one["overturned_share"]) > 0.0
    ]
    if fallen:
        said.append(
            Caveat(
                True,
                f"Records of the site, scaled as they were calibrated, overturn {listed(fallen)}",
                "The share is that of their weight; the design is a quantile of them, not the largest.",
            )
        )
    return said


def _doubt(answers: Answers, found: Sequence[BodyVerdict]) -> Caveat | None:
    """The caveat that motions are left out of the probability."""
    count, total = sum(one.share.unknown for one in found), len(found) * len(answers.motions.names)
    if not count:
        return None
    return Caveat(
        True,
        f"In {count} of {total} cases ({noun(answers.motions)} and body) the answer is not known",
        "They are left out of the mean; where they decide between two verdicts the body is not known."
        + ("" if answers.probable else " The table of answers says why."),
    )


def _at_rest(found: Sequence[BodyVerdict], motions: Motions) -> Caveat | None:
    idle, total = sum(one.at_rest for one in found), len(motions.names)
    if not idle or motions.kind == "sequence":
        return None
    never = sum(one.grade == Grade.STAYS for one in found)
    head = f"In {idle} of {len(found) * total} cases ({noun(motions)} and body) the body is not lifted"
    text = "Such motions are too weak to test it; they count with probability 0 and say little of stronger ones. "
    if never:
        head = f"{of_bodies(never, len(found))} {'is' if never == 1 else 'are'} lifted by none of these motions"
        text = (
            f"They are too weak to test it, and nothing else is said of such a body. In all, {idle} of "
            f"{len(found) * total} cases ({noun(motions)} and body) count with probability 0 because the body is not "
            "lifted. "
        )
    told = any(not np.isnan(one.margin.smallest) for one in found)
    stronger = "The smallest factor says how much stronger the motions might be." if told else ""
    return Caveat(bool(never), head, f"{text}{stronger}".rstrip())


def _doubtful(summary: xr.Dataset) -> Caveat | None:
    """Records whose peak may be that of a wrong unit, or cut off."""
    named = [cell for cell in record_cells(summary) if cell.marks]
    if not named:
        return None
    told = f"{listed(cell.marked for cell in named)}. {' '.join(doubt_notes(named))}"
    return Caveat(
        True,
        f"The peak of {several(len(named), 'record')} is doubtful",
        f"{told} Check them before this verdict is used.",
    )


def _drift(answers: Answers) -> Caveat | None:
    count = int(answers["pgv_drift"].sum())
    if not count:
        return None
    return Caveat(
        False,
        f"The baseline of {several(count, 'record')} drifts",
        "The velocity does not come back to zero: PGV may be off by as much, and the longest impulses with it.",
    )


def _several_restitutions(found: Sequence[BodyVerdict]) -> Caveat | None:
    blocks = {one.body.block for one in found}
    if len(blocks) == len(found):
        return None
    return Caveat(
        False,
        f"{several(len(blocks), 'block')} {'counts' if len(blocks) == 1 else 'count'} as {len(found)} bodies",
        "A block counts once for each restitution C that was given. Which holds is not known: judge it by the worst.",
    )
