"""Which of the screens of a body on a pedestal counts, and which bodies would slide before they rock."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from rockpulse.assessment.answers import Answers, Body
from rockpulse.assessment.verdict import BodyVerdict


class Sliding(NamedTuple):
    """A body whose friction does not hold it under `above` of `total` records, of which one asks for `most`."""

    body: Body
    above: int
    total: int
    most: float
    friction: float


def worse_screens(answers: Answers, found: Sequence[BodyVerdict]) -> Iterator[tuple[str, BodyVerdict]]:
    """Every body on a pedestal that is assessed alone and as one with it: its name, and the worse verdict of both."""
    whole = answers.summary["pedestal_of"].values.tolist()
    for alone in dict.fromkeys(filter(None, whole)):
        screens = [one for one in found if alone in (one.body.block, whole[one.body.place])]
        if len({one.body.block for one in screens}) > 1:
            yield alone, max(screens, key=lambda one: (one.overall, one.decides.value))


def sliding(answers: Answers) -> Iterator[Sliding]:
    """Every body that some records ask for more friction than it has."""
    friction = answers.summary["friction"].values
    for lane, body in enumerate(answers.bodies):
        required, own = answers["friction_required"][:, lane], float(friction[body.place])
        if above := int(np.count_nonzero(required > own)):
            yield Sliding(body, above, required.size, float(np.nanmax(required)), own)
