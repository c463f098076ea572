"""Effect of shorter steps on results and run time of bodies other than free-standing symmetric blocks.

.. note:: The results are compared with those of the same kernel on a record whose samples are divided by straight
   lines. The ground motion is the same, but the steps, the positions of events in them and the polynomials differ. The
   independent solver with which the kernels are tested is too slow for a report; it is in the tests.
"""

import numpy as np
import pandas as pd

from laboratory.accuracy.statistics import active_samples, timed
from rocking.body.block import Block
from rocking.body.restraint import Load, Tie
from rocking.march.recorded import recorded_response
from rocking.response import Response
from synthetic import synthetic_motion

PLAIN = "free, symmetric"
#: Heights of the bodies [m], their slenderness, and factors on the motions.
HEIGHTS = np.linspace(2.0, 6.0, 16)
SLENDERNESS = 6.0
SCALES = (0.7, 1.0, 1.4)
#: Parts into which the judge divides every sample.
DIVISION = 4
DT = 0.01
#: The record with a change of 1e-13: what that moves no solver can tell better.
CHANGE = 1.0 + 1e-13


def kinds(height: np.ndarray = HEIGHTS) -> dict[str, Block]:
    """Bodies of slenderness 6 and (m,) heights [m] by what they have beside their size, the free symmetric ones first.

    Ties stand at 0.8 of the height and oscillate at 20 rad/s; those that yield do so at a third of what brings the body
    back. The load is half as much, with friction of 0.1.
    """
    width = height / SLENDERNESS
    mass = 1800.0 * width * height
    plain = Block(width=width, height=height)
    inertia = 4.0 / 3.0 * mass * (0.5 * np.hypot(width, height)) ** 2
    stiffness = 20.0**2 * inertia / (0.8 * height) ** 2
    force = 0.2 * mass * plain.gravity / SLENDERNESS
    found = {
        PLAIN: plain,
        "unlike corners": Block(width=width, height=height, offset=0.05 * width),
        "before a wall": Block(width=width, height=height, one_sided=True),
    }
    ties, yielding, loads = [], [], []
    for h, w, m, k, f in zip(height, width, mass, stiffness, force, strict=True):
        size = {"width": w, "height": h, "mass": m, "log": False}
        ties.append(Block(ties=[Tie(0.8 * h, k, gap=0.01 * h, side="both")], **size))
        yielding.append(Block(ties=[Tie(0.8 * h, k, yield_force=f, side="both")], **size))
        loads.append(Block(loads=[Load(0.5 * f, h, friction=0.1)], **size))
    return found | {
        "elastic ties": Block.stack(ties),
        "yielding ties": Block.stack(yielding),
        "a load": Block.stack(loads),
    }


def bodies_table(seed: int, motions: int, repeats: int = 5) -> pd.DataFrame:
    """Error and cost by kind of body, one row each.

    `motions` synthetic motions are drawn from `seed` on. Columns: `kind`; `cases`, and `flips` of their verdict by the
    judge; `compared`, that survive by all; `median`, `p99` and `max` of what the judge changes in theta_max/alpha_c
    [-]; `max_perturbed`, the most that 1e-13 of the record changes; `ns_per_active_sample`, the median of `repeats`
    whole calls on one thread after one that is not counted; and `times_plain`, that over the one of free symmetric
    blocks.
    """
    records = [synthetic_motion(number, dt=DT) for number in range(seed, seed + motions)]
    fine = [_divided(record) for record in records]
    rows = []
    for kind, block in kinds().items():
        answers, cost = _timed(block, records, repeats)
        judged = [recorded_response(block, record, DT / DIVISION, scale=SCALES, threads=1) for record in fine]
        moved = [recorded_response(block, CHANGE * record, DT, scale=SCALES, threads=1) for record in records]
        outcome, other = (_all(every, "outcome") for every in (answers, judged))
        peak, *others = (_all(every, "peak_rotation_ratio") for every in (answers, judged, moved))
        both = np.isfinite(peak) & np.all(np.isfinite(others), axis=0)
        error, change = (np.abs(peak[both] - one[both]) for one in others)
        rows.append(
            {
                "kind": kind,
                "cases": outcome.size,
                "flips": int(np.count_nonzero(outcome != other)),
                "compared": error.size,
                "median": np.median(error) if error.size else np.nan,
                "p99": np.percentile(error, 99.0) if error.size else np.nan,
                "max": np.max(error) if error.size else np.nan,
                "max_perturbed": np.max(change) if change.size else np.nan,
                "ns_per_active_sample": cost,
            }
        )
    table = pd.DataFrame(rows)
    return table.assign(times_plain=table["ns_per_active_sample"] / table["ns_per_active_sample"].iloc[0])


def _all(responses: list[Response], name: str) -> np.ndarray:
    return np.concatenate([getattr(one, name).ravel() for one in responses])


def _divided(record: np.ndarray) -> np.ndarray:
    """A record with straight lines between its samples, at shorter intervals."""
    return np.interp(np.arange((record.size - 1) * DIVISION + 1) / DIVISION, np.arange(record.size), record)


def _timed(block: Block, records: list[np.ndarray], repeats: int) -> tuple[list[Response], float]:
    """The answers of one kind under all motions, and the cost of an active sample [ns]."""
    found, seconds = timed(
        lambda: [recorded_response(block, record, DT, scale=SCALES, threads=1) for record in records], repeats
    )
    return found, 1e9 * seconds / max(active_samples(found), 1)
