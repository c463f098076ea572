"""The result of calibrating a sequence on responses, and the warnings on it."""

from dataclasses import dataclass

import numpy as np

from laboratory.site.response_posterior import PARAMETERS
from laboratory.site.response_search import INTERVAL, MAIN_COUNT, RATIO, SearchSpace
from laboratory.site.response_targets import ResponseTargets
from rocking.impulses.impulse_sequence import ImpulseSequence


@dataclass(frozen=True, eq=False)
class ResponseCalibration:
    """A sequence calibrated on responses, and how far it can be believed.

    Attributes
    ----------
    record_id : str
        Whose responses they are.
    sequence : ImpulseSequence
        The sequence.
    parameters : dict of str to float
        Its "main" [m/s], "ratio" I_s/I [-], "interval" dT [s] (NaN with spacing "continuous") and "main_count" [-].
    intervals : dict of str to (float, float)
        Central posterior interval of each parameter of the fit, at the level `confidence`; of "main_count" the
        likeliest numbers whose probability is nearest to it.
    main_counts : dict of int to float
        Posterior probability of each number of main impulses [-].
    profiles : dict of str to ((k,) ndarray, (k,) ndarray)
        Values and smallest deviance found there [-].
    flat : tuple of str
        Parameters that the targets do not tell: every value that was searched is within the threshold.
    correlations : dict of (str, str) to float
        Correlation of two parameters in the posterior, of ln for I and dT [-].
    misfit, unsafe_share, spread : float
        Over the blocks that the motion moves: root mean square of ln(target/peak), of its distance to the censored
        range where one of the two is censored [-]; share whose peak under the sequence is below the target [-];
        estimated standard deviation of ln(target/peak) of the fit [-].
    targets : ResponseTargets
        The answers that had to be reproduced: blocks, peaks, outcomes.
    peaks : (m,) ndarray
        theta_max/alpha_c of the same blocks under the sequence, inf where overturned [-].
    start, start_misfit, start_unsafe_share : ImpulseSequence, float, float
        The sequence that the search started from, and the same figures of it; None and NaN without.
    confidence, effective_samples, candidates : float, float, int
        Level of the intervals [-], effective number of samples behind them, sequences that were tried.
    independent_share, neighbour_correlation : float
        Share of the peaks taken as independent observations [-], from the correlation of the residuals of neighbouring
        blocks [-].
    warnings : tuple of str
        In words: what was censored, what the targets cannot tell, how good the fit is.
    """

    record_id: str
    sequence: ImpulseSequence
    parameters: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    main_counts: dict[int, float]
    profiles: dict[str, tuple[np.ndarray, np.ndarray]]
    flat: tuple[str, ...]
    correlations: dict[tuple[str, str], float]
    misfit: float
    unsafe_share: float
    spread: float
    targets: ResponseTargets
    peaks: np.ndarray
    start: ImpulseSequence | None
    start_misfit: float
    start_unsafe_share: float
    confidence: float
    effective_samples: float
    candidates: int
    independent_share: float
    neighbour_correlation: float
    warnings: tuple[str, ...]


#: Correlation from which two parameters are said not to be told apart, spread from which the sequence is said to stand
#: for the ensemble rather than for the block [-], and effective samples below which the intervals are said to be rough.
INSEPARABLE, WIDE, FEW_SAMPLES = 0.9, 0.3, 100.0


def warnings(
    calibration: ResponseCalibration, space: SearchSpace, ends: dict[str, tuple[bool, bool]]
) -> tuple[str, ...]:
    """Warnings on a fit; `ends` says which limits of the search the likely values of each parameter reach."""
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
