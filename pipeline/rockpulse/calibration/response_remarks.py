"""Remarks on a response calibration: what was censored, what the targets cannot tell, how good the fit is."""

from __future__ import annotations

import numpy as np

from rockpulse.calibration.response_profile import PARAMETERS
from rockpulse.calibration.response_result import ResponseCalibration
from rockpulse.calibration.response_search import INTERVAL, MAIN_COUNT, RATIO, SearchSpace

__all__ = ["remarks"]

#: Correlation from which two parameters are said not to be told apart [-].
INSEPARABLE = 0.9

#: Spread from which the sequence is said to reproduce the ensemble rather than the block [-].
WIDE = 0.3

#: Effective samples below which the intervals are said to be rough.
FEW_SAMPLES = 100.0


def remarks(
    calibration: ResponseCalibration, space: SearchSpace, ends: dict[str, tuple[bool, bool]]
) -> tuple[str, ...]:
    """Remarks on a fit within the limits of a search, one sentence each.

    `ends` says of each parameter whether its likely values reach the lower and the upper limit of the search.
    """
    targets = calibration.targets
    number, small, overturned, silent = (
        int(np.count_nonzero(kind)) for kind in (targets.number, targets.small, targets.overturned, targets.silent)
    )
    said = [
        f"{number} peaks are numbers, {overturned} blocks overturn (at least 1), {small} stay below "
        f"{targets.smallest:g}, {silent} say nothing (at rest or unresolved)"
    ]
    limits = {
        "ratio": (space.low[RATIO], space.high[RATIO]),
        "interval": tuple(np.exp([space.low[INTERVAL], space.high[INTERVAL]])),
        "main_count": (space.low[MAIN_COUNT], space.high[MAIN_COUNT]),
    }
    if space.spacing == "continuous":
        said.append("interval: the limit of infinitely many secondary impulses has none")
        ends = {name: end for name, end in ends.items() if name != "interval"}
    for name, (at_low, at_high) in ends.items():
        unit, words = PARAMETERS[name]
        low, high = (f"{limit:.3g} {unit}".strip() for limit in limits[name])
        if name in calibration.flat:
            said.append(f"{name}: the data do not tell the {words}; all of {low} to {high} fit about as well")
        elif at_low and at_high:
            said.append(f"{name}: both {low} and {high}, the limits of the search, fit about as well as the best")
        elif at_high:
            said.append(f"{name}: no upper limit of the {words} up to {high}, the end of the search")
        elif at_low and name != "main_count":
            said.append(f"{name}: no lower limit of the {words} down to {low}, the end of the search")
    for (one, other), value in calibration.correlations.items():
        if abs(value) >= INSEPARABLE:
            said.append(
                f"{one} and {other} are not told apart (correlation {value:+.2f}): "
                "a combination of them is known better than either"
            )
    if calibration.spread > WIDE:
        said.append(
            f"spread {calibration.spread:.2f}: the sequence gives the peak of one block to a factor of "
            f"{np.exp(calibration.spread):.1f} either way; it stands for the family, not for each block"
        )
    if calibration.independent_share < 1.0:
        said.append(
            f"residuals of similar blocks are alike (correlation {calibration.neighbour_correlation:.2f}): "
            f"the {number} numbers count as {calibration.independent_share * number:.0f} independent ones"
        )
    if calibration.effective_samples < FEW_SAMPLES:
        said.append(f"the intervals rest on {calibration.effective_samples:.0f} effective samples: take them as rough")
    return tuple(said)
