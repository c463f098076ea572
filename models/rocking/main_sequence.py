"""The main sequence in closed form (Casapulla & Maione 2017, Eqs. 3-10): resonance with the block's own impacts.

.. note:: ERRATUM. Eqs. (5) and (9) are printed with the index shifted by one. The recurrence u_i = C u_{i-1} + u_1 is
   right and gives u_i = u_1 (1 - C^i)/(1 - C) and I_ic = I_1c (1 - C)/(1 - C^i), hence I_2c = I_1c/(1 + C). u =
   theta'/(p alpha_c), u_1 = I/I_1c.

Resonance is the input that suits the block worst, an upper-bound type input and not a prediction.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from rocking.block import Block
from rocking.half_cycle_table import TABLE_ROWS, combined, tabulated_response
from rocking.main_sequence_kernel import Lanes, overturning_half_cycle, resonance_lanes, safety_lanes
from rocking.quantities import ArrayLike, Floats
from rocking.response import Response, squeezed
from rocking.sequence_kernel import UNLIMITED
from rocking.threads import split_lanes

__all__ = [
    "critical_impulse_at",
    "critical_impulse_ratio",
    "overturning_half_cycle",
    "resonance",
    "resonance_safety",
]


def resonance(
    block: Block,
    impulse: ArrayLike,
    half_cycles: ArrayLike | None,
    duration: ArrayLike | None = None,
    table_rows: int = TABLE_ROWS,
    threads: int | None = None,
) -> Response:
    """Response to equal impulses, each right after an impact.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    impulse : float or (q,) array_like
        I [m/s], finite, not negative.
    half_cycles : int, (q,) array_like of int, or None
        Number of main impulses; None only with a finite `duration`.
    duration : float or (q,) array_like, optional
        Main impulses act only in half-cycles that start before this time [s].
    table_rows : int
        Largest number of half-cycles in the table; 0 for none.
    threads : int, optional
        Threads that share the lanes; None for all available cores. The results do not depend on it.

    Returns
    -------
    Response
        Lanes (q, m), a scalar axis dropped. After the last main impulse the block decays freely to rest; the decay is
        in `impacts`, not in the table. The table ends before its last row where the velocity has reached its limit
        (Eq. 10). `overturning_time` is the start of the half-cycle that overturns: from its main impulse on nothing
        can save the block.

    Raises
    ------
    ValueError
        For an impulse, number or duration out of range.

    Notes
    -----
    Eq. (3) gives u_1 = I/I_1c, the erratum u_i, Eqs. (6) and (7) peak and duration of a half-cycle. u = 1 overturns.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> block = Block(half_width=0.5, half_height=1.936492, restitution=0.9, gravity=9.81)
    >>> response = resonance(block, impulse=0.2 * block.critical_impulse, half_cycles=10)
    >>> response.overturning_half_cycle
    7
    """
    shape, drop, lanes = _lanes(block, _impulse(impulse), _half_cycles(half_cycles, duration), duration)
    return tabulated_response(resonance_lanes, lanes, shape, drop, table_rows, threads)


def critical_impulse_at(block: Block, half_cycle: int) -> Floats:
    """The impulse that overturns the block in a given half-cycle (Eq. 9 with the erratum).

    Parameters
    ----------
    block : Block
        One block, or (m,).
    half_cycle : int
        i, at least 1.

    Returns
    -------
    impulse : float or (m,) ndarray
        I_ic = I_1c (1 - C)/(1 - C^i) [m/s].
    """
    if np.ndim(half_cycle):
        raise ValueError(f"half_cycle: expected one whole number, got {half_cycle!r}")
    half_cycle = _half_cycles(half_cycle, None)
    return critical_impulse_ratio(block.restitution, half_cycle) * block.critical_impulse


def critical_impulse_ratio(restitution: ArrayLike, half_cycle: int) -> Any:
    """I_ic/I_1c = (1 - C)/(1 - C^i) of Eq. 9 for C a float or an (m,) array [-]."""
    ratios = np.array(restitution, dtype=float, ndmin=1)
    ones, factors = np.ones(ratios.size), np.empty(ratios.size)
    lanes = Lanes(ones, np.full(ratios.size, np.inf), np.full(ratios.size, half_cycle), ones, ratios, ones)
    safety_lanes(0, ratios.size, lanes, factors)
    return factors.item() if np.ndim(restitution) == 0 else factors


def resonance_safety(
    block: Block,
    impulse: ArrayLike,
    half_cycles: ArrayLike | None = None,
    duration: ArrayLike | None = None,
    threads: int | None = None,
) -> Floats:
    """Smallest factor on the impulse at which :func:`resonance` overturns the block, in closed form.

    Parameters
    ----------
    block : Block
        One block, or (m,).
    impulse : float or (q,) array_like
        I [m/s], finite, not negative.
    half_cycles : int or (q,) array_like of int, optional
        Number of main impulses; None for no limit.
    duration : float or (q,) array_like, optional
        Main impulses act only in half-cycles that start before this time [s].
    threads : int, optional
        Threads that share the lanes; None for all available cores.

    Returns
    -------
    factor : float or (q, m) ndarray
        I_Nc/I [-]; inf for no impulse. Without `half_cycles` and `duration` it is the infimum (1 - C) I_1c/I, which
        itself is safe.

    Notes
    -----
    Overturning in half-cycle N takes a factor from I_Nc/I to below I_(N-1)c/I, a band in which its start grows with
    the factor, so it is earliest at the lower edge: t_N = sum over j < N of 2 atanh(S_j/S_N)/p with S_j = (1 - C^j)/(1
    - C). t_N grows with N, so the answer is the edge of the largest N that the input reaches, t_N < duration. As
    S_j/S_N >= j/N and sum of 2 atanh(j/N) is about 2 N ln 2, N stays below p duration/1.38 + 2.
    """
    count = UNLIMITED if half_cycles is None else _half_cycles(half_cycles, None)
    shape, drop, lanes = _lanes(block, _impulse(impulse), count, duration)
    flat = np.empty(lanes.impulse.size)

    def kernel_call(first: int, last: int) -> None:
        safety_lanes(first, last, lanes, flat)

    split_lanes(kernel_call, flat.size, threads)
    return squeezed(flat.reshape(shape), drop)


def _lanes(
    block: Block, impulse: np.ndarray, count: Any, duration: ArrayLike | None
) -> tuple[tuple[int, int], tuple[bool, bool], Lanes]:
    """The lanes of a kernel, with their shape and the axes to drop."""
    blocks = (block.p, block.restitution, block.critical_impulse)
    shape, drop, (impulses, ends, most, *rest) = combined((impulse, _duration(duration), count), blocks)
    return shape, drop, Lanes(impulses, ends, most.astype(np.int64), *rest)


def _impulse(value: ArrayLike) -> np.ndarray:
    impulse = np.asarray(value, dtype=float)
    if impulse.ndim > 1 or not np.all(np.isfinite(impulse) & (impulse >= 0.0)):
        raise ValueError(f"impulse: expected a finite number or a (q,) array [m/s], not negative, got {value!r}")
    return impulse


def _duration(value: ArrayLike | None) -> np.ndarray:
    duration = np.asarray(np.inf if value is None else value, dtype=float)
    if duration.ndim > 1 or not np.all(duration > 0.0):
        raise ValueError(f"duration: expected a positive number or a (q,) array [s], got {value!r}")
    return duration


def _half_cycles(value: Any, duration: ArrayLike | None) -> Any:
    if value is None:
        if duration is None or not np.all(np.isfinite(np.asarray(duration, dtype=float))):
            raise ValueError(
                "half_cycles: expected a whole number; None needs a finite duration to end the main sequence"
            )
        return UNLIMITED
    if np.ndim(value) == 1:
        counts = np.asarray(value)
        if not np.issubdtype(counts.dtype, np.integer) or not np.all((counts >= 1) & (counts < UNLIMITED)):
            raise ValueError(f"half_cycles: expected whole numbers of at least 1, got {value!r}")
        return counts
    try:
        count = operator.index(value)
    except TypeError:
        raise ValueError(f"half_cycles: expected a whole number, got {value!r}") from None
    if not 1 <= count < UNLIMITED:
        raise ValueError(f"half_cycles: expected at least 1, got {count}")
    return count
