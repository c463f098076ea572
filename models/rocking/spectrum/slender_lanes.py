"""Lanes of an overturning spectrum: responses of slender blocks over ranges of x, p and restitution.

.. note:: The motion of a slender block under a record times f depends only on x = f p/(g tan alpha) [s/m], p and C:
   with phi = theta/alpha and tau = p t the nonlinear equation tends, as alpha -> 0, to

   phi'' = phi - s - (x/p) a_g(tau/p),  lifted at abs(a_g) > p/x,  phi' -> C phi' at an impact

   (Dimitrakopoulos & DeJong 2012, doi:10.1098/rspa.2012.0026; Zhang & Makris 2001), linear between impacts, with a
   closed form for a straight piece of the ground (:mod:`rocking.spectrum.slender`). At each p the lanes cover (ln x, C)
   with a golden-ratio lattice: a first stage from uplift to overturning of every lane, and a second stage in the range
   in which the outcomes of the first stage differ.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from rocking.arguments import ArrayLike, counts, positive, record_samples
from rocking.body.block import STANDARD_GRAVITY, Block
from rocking.body.limits import RATES
from rocking.kernel_cache import njit
from rocking.lanes import split_lanes, spread
from rocking.pictures import short_repr
from rocking.spectrum.body_lanes import BodyLanes
from rocking.spectrum.probability import MOST_RESTITUTION, Uncertainty
from rocking.spectrum.slender import ROWS, WIDTH, march_lanes
from rocking.spectrum.slender_ground import SlenderGround, Tables, largest_impulse

#: Largest acceleration divided by gravity that is accepted in a ground motion [-].
STRONGEST = 1e6
#: Pieces shorter than this [s] are omitted, such as one side of a triangle whose top is at one of its ends.
SHORTEST = 1e-12
#: Least restitution of the lanes of a spectrum: 0.95 times the least nominal C.
LEAST_RESTITUTION = 0.7125
#: Lanes up to this restitution represent 1, for bodies whose uncertain C exceeds it; their motion has MOST_RESTITUTION
#: (docs/decisions/018).
BEYOND = 1.025
#: Range of rebounds e of the lanes of blocks beside a wall.
REBOUNDS = (0.25, 0.55)
#: Number of lanes of each p in the first stage, and in the second one of a spectrum and of a single body
#: (docs/decisions/018).
FIRST, SECOND, SECOND_OF_BODY = 144, 700, 1600
#: Upper end of the first stage before extensions, as a multiple of the weighted impulse that overturns a resting block.
HIGHEST = 1.0 / 0.06
#: Smallest length of the first stage above uplift, in ln x [-].
LEAST_SPAN = 0.7
#: The first stage is extended if a lane survives in this upper share of its range; largest number of extensions.
LAST_SHARE, WIDENINGS = 0.1, 6
#: Capacities decrease with C: lanes of equal expected outcome have equal ln x + SLOPE (C - MIDDLE), with any MIDDLE.
SLOPE, MIDDLE = 1.3, 0.85
#: Width in ln x over which the outcomes of the first stage are averaged; density that is added everywhere, as a share
#: of sqrt(P (1 - P)) at P = 0.5.
NEIGHBOURS, FLOOR = 0.12, 0.08
#: Number of points at which the density of the second stage is computed, and decimal digits of P there.
POINTS, SHARE_DIGITS = 161, 12
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@dataclass(frozen=True, eq=False)
class SpectrumLanes:
    """Responses of slender blocks (lanes) under one record: n for each of (a,) frequency parameters, by ascending C.

    Attributes
    ----------
    p : (a,) ndarray
        Frequency parameters, ascending [1/s].
    log_x, restitution, weight : (a, n) ndarray
        ln of x = f p/(g tan alpha) [s/m]; restitution C, of which values above 1 represent 1; the width in ln x times
        the share of restitutions that a lane represents [-].
    peak : (a, n) ndarray
        Largest abs(theta)/alpha [-]; inf if the lane overturns or is UNRESOLVED; NaN for other lanes if only verdicts
        were computed.
    bottom, top : (a,) ndarray
        ln x below which no block lifts, and above which every block counts as overturned.
    between : (float, float)
        Range of restitutions that the lanes represent [-].
    side : int
        1 or -1 for blocks beside a wall, which turn only towards theta > 0 or theta < 0 and whose restitution is the
        rebound e; 0 for free blocks.

    Examples
    --------
    >>> lanes = rocking.spectrum_lanes(record.acceleration, record.dt, [2.0])
    >>> lanes.peak.shape, lanes.between
    ((1, 844), (0.7125, 1.0))
    """

    __repr__ = short_repr

    p: np.ndarray
    log_x: np.ndarray
    restitution: np.ndarray
    weight: np.ndarray
    peak: np.ndarray
    bottom: np.ndarray
    top: np.ndarray
    between: tuple[float, float]
    side: int = 0


def spectrum_lanes(
    acceleration: ArrayLike,
    dt: float,
    p: ArrayLike = RATES,
    threads: int | None = None,
    *,
    side: int = 0,
    rotations: bool = True,
    second: int = SECOND,
    between: tuple[float, float] | None = None,
    needed: tuple[float, float] | None = None,
) -> SpectrumLanes:
    """Compute the responses of slender blocks (lanes) that give the overturning spectrum of a record.

    Parameters
    ----------
    acceleration, dt : (n,) array_like, float
        Horizontal ground acceleration a_g [m/s2], not all zero, linear between the samples and zero after them; its
        sampling interval [s].
    p : (a,) array_like
        Frequency parameters [1/s], ascending.
    threads : int, optional
        Number of threads; None for all available cores. The results do not depend on it.
    side : int
        1 or -1 for blocks beside a wall, which turn only towards theta > 0 or theta < 0; 0 for free blocks.
    rotations : bool
        False to compute only which lanes overturn, in about half the time.
    second : int
        Number of lanes in the second stage at each p; the first stage has 144.
    between : (float, float), optional
        Range of restitutions that the lanes represent; by default 0.7125 to 1, beside a wall 0.25 to 0.55 (rebounds).
    needed : (float, float), optional
        Part of this range to which the lanes of the second stage are limited; those in it do not depend on it.

    Raises
    ------
    ValueError
        For p that are not ascending, an interval or a number of lanes that is not positive, and a record that is not
        finite, is zero throughout or exceeds a million times gravity.

    Examples
    --------
    >>> lanes = rocking.spectrum_lanes(record.acceleration, record.dt, [1.5, 2.0])
    >>> np.isinf(lanes.peak).mean(axis=1).round(2).tolist()  # share of the lanes that overturn
    [0.45, 0.7]
    """
    ground = record_samples("acceleration", acceleration)
    interval = float(positive("dt", dt, "s", lanes=False))
    between = between or (REBOUNDS if side else (LEAST_RESTITUTION, 1.0))
    if not 0.0 < between[0] < between[1] <= 1.0:
        raise ValueError(f"between: expected two ascending restitutions above 0, at most 1, got {between!r}")
    if needed and not between[0] <= needed[0] < needed[1] <= between[1]:
        raise ValueError(
            f"needed: expected two ascending restitutions from {between[0]:g} to {between[1]:g}, got {needed!r}"
        )
    number = counts("second", second, 1, lanes=False)
    times, stages = interval * np.arange(ground.size), {"second": number, "needed": needed}
    return piece_lanes(times, ground, p, between, threads, side=side, rotations=rotations, **stages)


def piece_lanes(
    times: np.ndarray,
    ground: np.ndarray,
    p: ArrayLike = RATES,
    between: tuple[float, float] = (LEAST_RESTITUTION, 1.0),
    threads: int | None = None,
    *,
    side: int = 0,
    rotations: bool = True,
    second: int = SECOND,
    needed: tuple[float, float] | None = None,
) -> SpectrumLanes:
    """Compute responses of slender blocks (lanes) at ascending p under a ground acceleration linear between `times`."""
    rates = np.atleast_1d(positive("p", p, "1/s"))
    if np.any(np.diff(rates) <= 0.0):
        raise ValueError(f"p: expected ascending frequency parameters in 1/s, got {p!r:.80}")
    least, most = between[0], upper_end(between)

    def restitutions(rank: np.ndarray) -> np.ndarray:
        return least + (most - least) * rank

    own = needed or between
    ends = own[0], upper_end(own)
    of_rates = [restitutions] * rates.size
    marched = _march_lanes(
        times, ground, rates, of_rates, threads, side, rotations=rotations, second=second, needed=ends
    )
    rows = list(marched)
    found = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    if not rotations:
        found["peak"][np.isfinite(found["peak"])] = np.nan
    return SpectrumLanes(rates, **found, between=own, side=side)


def body_piece_lanes(
    times: np.ndarray,
    ground: np.ndarray,
    block: Block,
    uncertainty: Uncertainty,
    threads: int | None = None,
    *,
    side: int = 0,
    second: int = SECOND_OF_BODY,
) -> list[BodyLanes]:
    """Compute samples of (m,) slender blocks, with the p and random C of each block, under the same ground motion."""
    rates, nominal = np.asarray(block.p, dtype=float), np.asarray(block.restitution, dtype=float)

    restitutions = [partial(uncertainty.restitutions, own) for own in nominal]
    speeds = np.log(block.gravity * np.tan(block.alpha_c) / rates)
    rows = _march_lanes(times, ground, rates, restitutions, threads, side, rotations=False, second=second)
    lanes = []
    for row, speed in zip(rows, speeds, strict=True):
        inside = row["weight"] > 0.0
        log_factor, weight, over = row["log_x"][inside] + speed, row["weight"][inside], np.isinf(row["peak"][inside])
        ends = row["bottom"] + speed, row["top"] + speed
        lanes.append(BodyLanes(log_factor, weight, over, np.zeros(over.size, dtype=bool), *ends, open=False))
    return lanes


def upper_end(between: tuple[float, float]) -> float:
    """Return the largest restitution of the lanes that cover a range of C: BEYOND if the range ends at 1."""
    return BEYOND if between[1] == 1.0 else between[1]


def _march_lanes(
    times: np.ndarray,
    ground: np.ndarray,
    rates: np.ndarray,
    restitutions: Sequence[Callable[[np.ndarray], np.ndarray]],
    threads: int | None,
    side: int,
    *,
    rotations: bool,
    second: int,
    needed: tuple[float, float] = (0.0, np.inf),
) -> Iterator[dict[str, Any]]:
    """Compute lanes at each frequency parameter in `rates`, with C from the function for this rate in `restitutions`.

    Without `rotations` the peaks are valid only if they are inf.
    """
    check_strength(ground)
    if not np.any(ground):
        raise ValueError("acceleration: expected a ground motion, got only zeros")
    if side < 0:
        ground = -ground  # mirror image
    seconds = np.diff(times)
    long = seconds > SHORTEST
    whole = slice(int(np.argmax(long)), long.size - int(np.argmax(long[::-1])))
    every = whole if np.all(long[whole]) else long  # views where possible, as records may last days
    pieces = seconds[every], ground[:-1][every], ground[1:][every]
    del seconds, long
    least, most = (float(find([find(one) for one in pieces[1:]])) for find in (np.min, np.max))
    highest = -least if side else max(-least, most)
    if not highest > 0.0:
        raise ValueError("acceleration: expected samples that lift the block away from its wall, found none")

    def at_rate(place: int, threads: int) -> dict[str, Any]:
        rate = float(rates[place])
        bottom = math.log(rate / highest)
        top = max(math.log(HIGHEST / largest_impulse(times, ground, rate)), bottom + LEAST_SPAN)
        motion = SlenderGround(pieces, rate, side != 0)
        march = partial(march_one_rate, motion, rotations=rotations, threads=threads)
        return both_stages(bottom, top, march, restitutions[place], second, needed)

    return spread(at_rate, range(rates.size), threads)


def march_one_rate(
    motion: SlenderGround, log_x: np.ndarray, restitution: np.ndarray, *, rotations: bool, threads: int | None
) -> np.ndarray:
    """Return the largest abs(theta)/alpha of n blocks of one p; without `rotations` only inf (overturns) is valid."""
    strength, state = np.exp(log_x) / motion.rate, np.zeros((log_x.size, 4))
    for tables, final in motion:

        def some(first: int, last: int, tables: Tables = tables, final: bool = final) -> None:
            work = np.zeros(ROWS * WIDTH), np.zeros((2, WIDTH), dtype=np.int64)
            march_lanes(first, last, *work, state, strength, restitution, *tables, motion.wall, final, rotations)

        split_lanes(some, log_x.size, threads)
        del tables, some  # before the next ones are made
    return state[:, 0]


def _largest(values: np.ndarray) -> float:
    """Return the largest absolute value, without a copy."""
    return float(max(np.max(values, initial=0.0), -np.min(values, initial=0.0)))


def check_strength(ground: np.ndarray) -> None:
    """Raise ValueError for accelerations (k,) [m/s2] above a million times gravity, which no ground motion has."""
    strongest = _largest(ground) / STANDARD_GRAVITY
    if strongest > STRONGEST:
        raise ValueError(
            f"acceleration: expected at most {STRONGEST:g} times gravity, got {strongest:g} times; is it in m/s2?"
        )


def both_stages(
    bottom: float,
    top: float,
    march: Callable[[np.ndarray, np.ndarray], np.ndarray],
    restitutions: Callable[[np.ndarray], np.ndarray],
    second: int,
    needed: tuple[float, float] = (0.0, np.inf),
) -> dict[str, Any]:
    """Return the samples of both stages, from uplift at ln x = `bottom` to `top`; `march` computes the rotations.

    Those of the second stage are limited to the `needed` restitutions.
    """
    given = restitutions(_ranks(FIRST, 0.5))
    restitution = np.minimum(given, MOST_RESTITUTION)
    for extension in range(WIDENINGS + 1):
        top += LEAST_SPAN if extension > 0 else 0.0
        log_x = bottom + (top - bottom) * ((np.arange(FIRST) + 0.5) / FIRST)
        peak = march(log_x, restitution)
        if np.all(np.isinf(peak[log_x > bottom + (1.0 - LAST_SHARE) * (top - bottom)])):
            break
    least, most = np.minimum(restitutions(np.array([0.0, 1.0])), MOST_RESTITUTION)
    ends = _level(bottom, least), _level(top, most)
    places, grid, density = _second_stage_levels(_level(log_x, restitution), np.isinf(peak), *ends, second)
    given_next = restitutions(_ranks(second, 0.25))
    own = (given_next >= needed[0]) & (given_next <= needed[1])
    given_next, places = given_next[own], places[own]
    more = np.minimum(given_next, MOST_RESTITUTION)
    log_x_next = places - SLOPE * (more - MIDDLE)
    log_x, restitution = np.append(log_x, log_x_next), np.append(restitution, more)
    peak = np.append(peak, march(log_x_next, more))
    inside = (log_x > bottom) & (log_x <= top)
    # At a given C, a unit of the level is a unit of ln x.
    of_both = FIRST / (top - bottom) + np.interp(_level(log_x, restitution), grid, density)
    weight = np.where(inside, 1.0 / of_both, 0.0)
    given = np.append(given, given_next)
    order = np.argsort(given, kind="stable")
    found = {"log_x": log_x, "restitution": given, "weight": weight, "peak": peak}
    return {**{name: values[order] for name, values in found.items()}, "bottom": bottom, "top": top}


def _ranks(count: int, start: float) -> np.ndarray:
    """Return `count` evenly distributed numbers in [0, 1): the golden-ratio sequence that begins at `start`."""
    return (np.arange(count) * _GOLDEN + start) % 1.0


def _level(log_x: Any, restitution: Any) -> Any:
    """Return ln x corrected for C: blocks with equal corrected values overturn with about equal probability."""
    return log_x + SLOPE * (restitution - MIDDLE)


def _second_stage_levels(
    level: np.ndarray, over: np.ndarray, lowest: float, highest: float, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the levels of `count` samples of the second stage, and the density of samples on a grid of levels."""
    grid = np.linspace(lowest, highest, POINTS)
    # Rounded, because the square root of a rounding error would move all lanes by 1e-8.
    share = np.round(_share_near(level, over, grid), SHARE_DIGITS)
    # The standard deviation of the outcome, for the least variance, and a floor.
    wanted = np.sqrt(share * (1.0 - share)) + FLOOR * 0.5
    step = grid[1] - grid[0]
    filled = np.append(0.0, np.cumsum(0.5 * (wanted[1:] + wanted[:-1]))) * step
    places = np.interp((np.arange(count) + 0.5) / count * filled[-1], filled, grid)
    return places, grid, count * wanted / filled[-1]


@njit()
def _share_near(level, over, grid):
    """Return the share of samples `over` at each of `grid`, averaged over the levels near it."""
    share = np.empty(grid.size)
    for place in range(grid.size):
        hit = whole = 0.0
        for lane in range(level.size):
            weight = math.exp(-0.5 * ((level[lane] - grid[place]) / NEIGHBOURS) ** 2)
            whole += weight
            hit += weight if over[lane] else 0.0
        share[place] = hit / whole
    return share
