"""The smallest main impulse whose responses are not below the targets for a given share of the blocks."""

from __future__ import annotations

import numpy as np

from rocking.impulses.sequence import ImpulseSequence, sequence_response
from rockpulse.calibration.response_targets import ResponseTargets

__all__ = ["enveloping_main"]

#: Factors of the scan, and of each refinement.
SCANNED, REFINED = 400, 33

#: Relative width of the last bracket.
TOLERANCE = 1e-6


def enveloping_main(
    targets: ResponseTargets, sequence: ImpulseSequence, share: float, threads: int | None = None
) -> tuple[float, bool]:
    """The factor on both impulses of a sequence at which it first covers a share of the targets.

    I_s/I, dT, main count and duration are kept. Silent targets do not count: they are covered by anything. Returned are
    the upper end of the first bracket, and whether a larger factor of the scan covers less than the share.

    Notes
    -----
    The peak of a block is not monotonic in I (its number of secondary impulses jumps), so the range is scanned and the
    first edge refined. It ends where every block overturns at once: (I/I_1c)(1 - sigma/2) of 2, above the root of
    every spacing. A band of cover narrower than a step of the scan may be missed.
    """
    speaks = ~targets.silent
    critical = np.asarray(targets.blocks.critical_impulse)[speaks]
    last = 4.0 * critical.max() / sequence.main
    first = 1e-3 * critical.min() / sequence.main

    def covered(factors: np.ndarray) -> np.ndarray:
        response = sequence_response(targets.blocks, sequence.scaled(factors), table_rows=0, threads=threads)
        return 1.0 - targets.short_of(np.asarray(response.peak_rotation_ratio)) >= share - 1e-12

    factors = np.geomspace(first, last, SCANNED)
    enough = covered(factors)
    edge = int(np.argmax(enough))
    again = not bool(np.all(enough[edge:]))
    low, high = factors[max(edge - 1, 0)], factors[edge]
    while high - low > TOLERANCE * high:
        inner = np.linspace(low, high, REFINED)
        edge = max(int(np.argmax(covered(inner[1:]))) + 1, 1)
        low, high = inner[edge - 1], inner[edge]
    return float(high), again
