"""Estimators of the parameters of an impulse sequence from the half-waves of a record."""

import math
from collections.abc import Callable

import numpy as np

from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase

#: Smallest number of half-waves for a sequence: they give main and secondary impulse and two intervals.
FEWEST_WAVES = 3
#: Half-waves above this share of the largest half-wave count as main impulses.
MAIN_SHARE = 0.5


def _mean_of_largest(sizes: np.ndarray, m: int, quantile: float) -> tuple[float, int]:
    if m >= sizes.size:
        raise RecordRefused(
            f"{sizes.size} half-waves: the mean of the {m} largest leaves no half-wave for the secondary impulse; "
            "choose a smaller m or a longer intense phase"
        )
    return float(np.mean(sizes[:m])), m


def _quantile(sizes: np.ndarray, m: int, quantile: float) -> tuple[float, int]:
    main = float(np.quantile(sizes, quantile))
    return main, max(1, int(np.count_nonzero(sizes > main)))


#: Estimators of the main impulse from absolute impulses in descending order. They return the main impulse [m/s], and
#: the number of largest impulses that are not used to estimate the secondary impulse.
MAIN: dict[str, Callable[[np.ndarray, int, float], tuple[float, int]]] = {
    "largest": lambda sizes, m, quantile: (float(sizes[0]), 1),
    "mean-largest": _mean_of_largest,
    "quantile": _quantile,
}
#: Estimators of the secondary impulse from the absolute impulses of the other half-waves [m/s].
SECONDARY: dict[str, Callable[[np.ndarray], float]] = {
    "median": lambda others: float(np.median(others)),
    "mean": lambda others: float(np.mean(others)),
    "rms": lambda others: float(np.sqrt(np.mean(others**2))),
}
#: Estimators of the interval of the secondary impulses from the spacings of successive centroids [s].
INTERVAL = {name: SECONDARY[name] for name in ("median", "mean")}
#: Estimators of the number of main impulses from absolute impulses in descending order; None means no limit.
MAIN_COUNT: dict[str, Callable[[np.ndarray], int | None]] = {
    "half-largest": lambda sizes: int(np.count_nonzero(sizes > MAIN_SHARE * sizes[0])),
    "none": lambda sizes: None,
}


def record_sequence(
    waves: HalfWaves,
    main: str = "largest",
    secondary: str = "rms",
    interval: str = "median",
    main_count: str | int = "half-largest",
    spacing: str = "end",
    duration_s: float | None = None,
    phase: IntensePhase | None = None,
    m: int = 3,
    quantile: float = 0.95,
) -> ImpulseSequence:
    """Estimate the impulse sequence of one record.

    Parameters
    ----------
    waves : HalfWaves
        Half-waves of the record, (k,).
    main : {"largest", "mean-largest", "quantile"}
        Main impulse I: the largest half-wave; the mean of the `m` largest; or the `quantile` of all.
    secondary : {"rms", "mean", "median"}
        Secondary impulse I_s, from the half-waves that are neither used for nor larger than the main impulse.
    interval : {"median", "mean"}
        Interval dT of the secondary impulses, from the spacings of successive centroids.
    main_count : {"half-largest", "none"} or int
        Number of main impulses: the number of half-waves above half the largest half-wave; no limit; or an integer.
    spacing : {"end", "middle", "start", "open", "continuous"}
        Position of the secondary impulses in a half-cycle, see :class:`rocking.ImpulseSequence`.
    duration_s : float, optional
        Duration of the sequence [s]; by default the duration of the phase.
    phase : IntensePhase, optional
        Only half-waves with their centroid in this phase are used; by default all are used.
    m : int
        Number of half-waves of "mean-largest", at least 1.
    quantile : float
        Probability of "quantile" [-], 0 to 1; the quantile is interpolated linearly between half-waves.

    Returns
    -------
    ImpulseSequence
        Sequence with main and secondary impulse [m/s], interval [s], duration [s] and main count.

    Raises
    ------
    ConfigError
        For an unknown estimator or an option out of range.
    RecordRefused
        For fewer than 3 half-waves in the phase.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, sections 2 and 5, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> waves = rp.half_waves(rp.Record([0.0, 2.0, -6.0, 3.0, 0.0], dt=0.1, id="three"))
    >>> sequence = record_sequence(waves, secondary="mean")
    >>> round(sequence.main, 6), round(sequence.secondary, 6), sequence.main_count
    (0.425, 0.1625, 1)
    """
    whole, known_count = "a whole number of at least 1", main_count in MAIN_COUNT or _is_count(main_count)
    checks: tuple[tuple[str, object, bool, str], ...] = (
        ("main", main, main in MAIN, f"one of {', '.join(MAIN)}"),
        ("secondary", secondary, secondary in SECONDARY, f"one of {', '.join(SECONDARY)}"),
        ("interval", interval, interval in INTERVAL, f"one of {', '.join(INTERVAL)}"),
        ("spacing", spacing, spacing in SPACINGS, f"one of {', '.join(SPACINGS)}"),
        ("main_count", main_count, known_count, f"one of {', '.join(MAIN_COUNT)} or {whole}"),
        ("duration_s", duration_s, duration_s is None or 0.0 < duration_s < math.inf, "a positive duration in s"),
        ("m", m, _is_count(m), whole),
        ("quantile", quantile, 0.0 <= quantile <= 1.0, "a probability from 0 to 1"),
    )
    for name, value, valid, expected in checks:
        if not valid:
            raise ConfigError(f"record_sequence: {name}: expected {expected}, got {value!r}")
    inside = waves if phase is None else waves.between(phase.start, phase.end)
    where = waves.record_id or "half-waves"
    if len(inside) < FEWEST_WAVES:
        place = "in all" if phase is None else f"centred in the intense phase {phase.start:g} to {phase.end:g} s"
        raise RecordRefused(
            f"{where}: {len(inside)} half-waves {place}, but a sequence needs at least {FEWEST_WAVES}; "
            "choose a longer intense phase, a lower half-wave threshold, or leave the record out"
        )
    sizes = np.sort(np.abs(inside.impulse))[::-1]
    try:
        main_impulse, used = MAIN[main](sizes, m, quantile)
    except RecordRefused as error:
        raise RecordRefused(f"{where}: {error}") from None
    secondary_impulse = SECONDARY[secondary](sizes[used:])
    if duration_s is None:
        duration_s = phase.duration if phase is not None else float(waves.end[-1] - waves.start[0])
    return ImpulseSequence(
        main=main_impulse,
        secondary=min(secondary_impulse, main_impulse),  # rounding may make the mean of equal impulses larger
        interval=INTERVAL[interval](np.diff(inside.centroid)),
        duration=duration_s,
        main_count=MAIN_COUNT[main_count](sizes) if isinstance(main_count, str) else int(main_count),
        spacing=spacing,
    )


def _is_count(value: object) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and bool(value >= 1)
