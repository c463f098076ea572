"""The result of calibrating a sequence on responses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rocking.impulses.sequence import ImpulseSequence
from rockpulse.calibration.response_targets import ResponseTargets

__all__ = ["ResponseCalibration"]


@dataclass(frozen=True, eq=False)
class ResponseCalibration:
    """A sequence calibrated on responses, and how far it can be believed.

    Attributes
    ----------
    record_id : str
        Whose responses they are.
    form : {"fit", "enveloping"}
        Likeliest sequence, or the one that covers a share of the family.
    sequence : ImpulseSequence
        The sequence.
    parameters : dict of str to float
        Its "main" [m/s], "ratio" I_s/I [-], "interval" dT [s] (NaN with spacing "continuous") and "main_count" [-].
    intervals : dict of str to (float, float)
        Central interval of each parameter in the posterior, at the level `confidence`; of "main_count" the likeliest
        numbers whose probability is nearest to it. Those of the fit, also when the form is "enveloping".
    main_counts : dict of int to float
        Posterior probability of each number of main impulses [-].
    profiles : dict of str to ((k,) ndarray, (k,) ndarray)
        Values and smallest deviance found there [-].
    flat : tuple of str
        Parameters of which the targets tell nothing: every value that was searched is within the threshold.
    correlations : dict of (str, str) to float
        Correlation of two parameters in the posterior, of ln for I and dT [-].
    misfit : float
        Root mean square of ln(target/peak) over the blocks that the motion moves; the distance to the censored range
        where one of the two overturns or is small [-].
    unsafe_share : float
        Share of the blocks that the motion moves whose peak under the sequence is below the target [-].
    spread : float
        Estimated standard deviation of ln(target/peak) of the fit [-].
    targets : ResponseTargets
        The answers that had to be reproduced: blocks, peaks, outcomes.
    peaks : (m,) ndarray
        theta_max/alpha_c of the same blocks under the sequence, inf where overturned [-].
    start : ImpulseSequence or None
        The sequence that the search started from: the statistical estimate unless one was given.
    start_misfit, start_unsafe_share : float
        The same figures of the start; NaN without.
    confidence : float
        Level of the intervals [-].
    effective_samples : float
        Effective number of samples behind the intervals [-].
    candidates : int
        Sequences that were tried.
    independent_share : float
        Share of the peaks taken as independent observations in intervals and profiles [-].
    neighbour_correlation : float
        Correlation of the residuals of neighbouring blocks, from which that share comes [-].
    remarks : tuple of str
        In words: what was censored, what the targets cannot tell, how good the fit is.
    """

    record_id: str
    form: str
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
    remarks: tuple[str, ...]
