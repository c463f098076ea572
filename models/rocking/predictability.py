"""Whether an answer survives a change in the ninth digit of its input: rocking is chaotic near overturning."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rocking.arguments import ArrayLike, Integers, numbers
from rocking.body.block import Block
from rocking.response import Outcome, Response, squeezed

__all__ = ["NOT_CHECKED", "NOT_PREDICTABLE", "PREDICTABLE", "predictable"]

NOT_CHECKED, NOT_PREDICTABLE, PREDICTABLE = -1, 0, 1


def predictable(
    response: Response,
    respond: Callable[[Block, np.ndarray], Response],
    block: Block,
    scale: ArrayLike = 1.0,
    perturbation: float = 1e-9,
    tolerance: float | None = 1e-4,
) -> Integers:
    """Lanes whose outcome and peak stay when restitution and strength of the record change by a little.

    Parameters
    ----------
    response : Response
        The answer to be checked: what `respond` gives for `block` and `scale`.
    respond : callable
        ``respond(block, scale)`` takes (m,) blocks and (q,) factors and returns the Response of lanes (q, m). It is
        called twice, with (2 m,) blocks and with (2 q,) factors: four more runs of every lane, five with the answer.
    block : Block
        One block or (m,) of them.
    scale : float or (q,) array_like
        Factor on the record [-].
    perturbation : float
        Relative change of C, which stays within [0, 1], and of the factor, each up and down [-].
    tolerance : float or None
        Spread of theta_max/alpha_c over the five runs up to which a peak counts as the same [-]; None: the outcome
        alone is compared, for answers whose peak is no answer.

    Returns
    -------
    int8 or (q, m) ndarray of int8
        1 predictable, 0 not (the outcome flips or the peak spreads beyond the tolerance), -1 where the answer itself is
        UNRESOLVED; a scalar axis dropped.

    Raises
    ------
    ValueError
        For a perturbation outside (0, 0.1] or a tolerance that is neither None nor positive and finite.

    Examples
    --------
    A pulse that brings the block to its critical velocity is decided by the last digits:

    >>> from rockpulse import models
    >>> blocks = models.Block(half_width=0.5, half_height=1.9365, restitution=[0.9, 0.9])
    >>> def respond(block, scale):
    ...     return models.impulsive_response(block, [0.0], [blocks.critical_impulse[0]], scale=scale)
    >>> factors = [0.5, 1.0 - 1e-10]
    >>> models.predictable(respond(blocks, factors), respond, blocks, factors)[:, 0].tolist()
    [1, 0]
    """
    change = float(numbers("perturbation", perturbation, "a relative change in (0, 0.1]", lanes=False))
    if not 0.0 < change <= 0.1:
        raise ValueError(f"perturbation: expected a relative change in (0, 0.1], got {perturbation!r}")
    spread = np.inf
    if tolerance is not None:
        spread = float(numbers("tolerance", tolerance, "a positive spread of theta_max/alpha_c", lanes=False))
    if not spread > 0.0:
        raise ValueError(f"tolerance: expected a positive spread of theta_max/alpha_c, got {tolerance!r}")
    factors = numbers("scale", scale, "a factor >= 0")
    rows = np.atleast_1d(factors)
    lanes = block if block.shape else block.lanes(1)
    count = lanes.shape[0]
    shape = (rows.size, count)
    bounced = respond(_restituted(lanes, change), rows)
    scaled = respond(lanes, np.concatenate([rows * (1.0 - change), rows * (1.0 + change)]))
    peaks, outcomes = (
        np.stack(
            [
                np.reshape(getattr(response, name), shape),
                *np.split(np.reshape(getattr(bounced, name), (rows.size, 2 * count)), 2, axis=1),
                *np.split(np.reshape(getattr(scaled, name), (2 * rows.size, count)), 2, axis=0),
            ]
        )
        for name in ("peak_rotation_ratio", "outcome")
    )
    same = np.all(outcomes == outcomes[0], axis=0)
    # Overturned lanes have no finite peak: with all five overturned there is nothing to compare.
    finite = np.where(np.isfinite(peaks), peaks, 0.0)
    narrow = np.ptp(finite, axis=0) <= spread
    marks = np.where(same & narrow, PREDICTABLE, NOT_PREDICTABLE).astype(np.int8)
    marks[outcomes[0] == Outcome.UNRESOLVED] = NOT_CHECKED
    return squeezed(marks, (factors.ndim == 0, block.shape == ()))


def _restituted(blocks: Block, perturbation: float) -> Block:
    """Every block twice: first with a smaller, then with a larger restitution; all else is the same to the last bit."""
    twice = blocks._with(lambda values: np.tile(values, 2))
    changed = np.concatenate([blocks.restitution * (1.0 - perturbation), blocks.restitution * (1.0 + perturbation)])
    return twice.varied(0.0, np.minimum(changed, 1.0))
