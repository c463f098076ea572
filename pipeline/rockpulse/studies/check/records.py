"""The criterion of Circolare 7/2019 for nonlinear dynamic analyses of a local mechanism, on rotations under records.

.. note:: C8.7.1.2.1.9: no analysis passes d_0, and the mean of the largest displacements does not exceed d_SLV or d_SLC
   of C8.7.1.2.1.6. NTC 2018, 7.3.5, and EN 1998-1, 4.3.3.4.3: the mean of seven records or more, otherwise the most
   unfavourable value, of at least three records (EN 1998-1, 3.2.3.1.2). The rotation |theta|/alpha_c is converted to
   the displacement d = (|theta|/alpha_c) tan(alpha_c) lever, so that a free body reaches d_0 at alpha_c.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import nominal_motion, too_far, weak
from rockpulse.studies.check.codes import Checked, allowed_displacement, worst
from rockpulse.studies.check.mechanism import Mechanism

#: Fewest records for a verdict, and fewest for the mean.
FEWEST, FOR_MEAN = 3, 7


class Rotations(NamedTuple):
    """The largest rotations, over alpha_c, of a body under the records scaled to a demand."""

    records: int  #: number of records, or of pairs with the worst direction of each
    unknown: int  #: number of records without a rotation
    compared: float  #: mean or largest over the records [-]; inf if one overturns the body, NaN if unknown
    largest: float  #: largest over the records [-]


def rotations_of(peaks: np.ndarray) -> Rotations:
    """Return the rotations that are compared with the limits, from n largest rotations over alpha_c.

    Examples
    --------
    >>> rotations_of(np.array([0.1, 0.2, 0.6]))
    Rotations(records=3, unknown=0, compared=0.6, largest=0.6)
    """
    unknown, overturns = int(np.isnan(peaks).sum()), bool(np.isinf(peaks).any())
    largest = math.inf if overturns else float(peaks.max(initial=-math.inf)) if peaks.size else math.nan
    if peaks.size < FEWEST:
        return Rotations(peaks.size, unknown, math.nan, largest)
    mean = peaks.size >= FOR_MEAN and not overturns
    return Rotations(peaks.size, unknown, float(peaks.mean()) if mean else largest, largest)


def rotations_at(answers: Answers, demand: str) -> dict[str, Rotations]:
    """Return the rotations of each body at a demand; of several restitutions, the largest ones."""
    motions, far = answers.motions, too_far(answers, demand)
    kept = motions.kept(far | weak(answers, demand)[:, np.newaxis])
    fallen, rotation = nominal_motion(answers, demand)
    peaks = motions.over(np.where(far, -np.inf, np.where(fallen, np.inf, rotation)), -np.inf).max(axis=1)
    peaks[motions.in_any_direction(fallen & ~far)] = np.inf
    found: dict[str, Rotations] = {}
    for lane, body in enumerate(answers.bodies):
        one = rotations_of(peaks[kept[:, lane], lane])
        before = found.get(body.block)
        if before is None or one.compared > before.compared or math.isnan(one.compared):
            found[body.block] = one
    return found


def check_records(
    senses: Sequence[Mechanism],
    rotations: Rotations,
    limit_state: str,
    rule: str,
    assessed: Sequence[Mechanism] | None = None,
) -> Checked:
    """Check the rotations of a body according to C8.7.1.2.1.9, with the limits of its worse direction of rotation.

    `assessed` are the mechanisms whose rotations are given; by default they are `senses`, the mechanisms of the check.
    """
    statement = ""
    if rotations.records < FEWEST:
        statement = f"{rotations.records} records at the demand, but {rule} requires three or more"
    elif math.isnan(rotations.compared):
        statement = f"{rotations.unknown} of {rotations.records} records have no rotation at the demand"
    every = zip(senses, senses if assessed is None else assessed, strict=True)
    return worst([_checked(one, of, rotations, limit_state) for one, of in every])._replace(
        records=rotations.records, statement=statement, activation_sense=""
    )


def _checked(body: Mechanism, assessed: Mechanism, rotations: Rotations, limit_state: str) -> Checked:
    allowed, unit = allowed_displacement(body, limit_state), assessed.slope * assessed.lever
    demand = rotations.compared * unit
    if math.isnan(demand):
        return Checked(displacement=allowed)
    ratios = (
        math.inf if moved == 0.0 else limit / moved
        for limit, moved in ((allowed, demand), (body.collapse_displacement, rotations.largest * unit))
    )
    return Checked(displacement=allowed, displacement_demand=demand, displacement_ratio=min(ratios))
