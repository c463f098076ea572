"""The choice of the model for a lane: the cheapest rung of the fidelity ladder that still gives the answer.

.. note:: What a rung may decide is either derived (:data:`Rung.STATIC`, and overturning of :data:`Rung.SETTLED`) or
   measured against the nonlinear equation on an ensemble (``benchmarks/measure_fidelity.py``; docs/decisions/006). The
   sequence models answer questions about sequences and are no rung here.
"""

from __future__ import annotations

from dataclasses import fields
from enum import IntEnum

import numpy as np

from rocking.arguments import numbers
from rocking.block import Block
from rocking.capacity import uplift_scale
from rocking.demand import Demand, ground_demand
from rocking.impulsive import impulsive_response
from rocking.quantities import ArrayLike, Integers
from rocking.recorded import recorded_response
from rocking.response import Outcome, Response, drop_axes, squeezed

__all__ = ["MEASURED_RANGE", "Rung", "choose_response", "within_measured_range"]


class Rung(IntEnum):
    """The model that answered a lane, from the cheapest to the dearest."""

    STATIC = 0  #: no uplift is possible: exact
    IMPULSIVE = 1  #: the strongest half-waves as impulses, where the demand leaves no doubt about the verdict
    SETTLED = 2  #: the nonlinear equation until the verdict is settled
    NONLINEAR = 3  #: the nonlinear equation over the whole record


#: Lanes outside this are answered by the nonlinear equation: p [1/s], alpha_c [rad], C over Housner's value, p dt.
MEASURED_RANGE = {"p": (0.7, 9.0), "alpha": (0.04, 0.32), "restitution": (0.85, 1.0), "p_dt": (0.0, 0.1)}

#: Half-waves that the impulsive rung takes, the strongest ones.
STRONGEST_WAVES = 32

#: The impulsive rung must not overturn with its input raised by this factor either.
RAISED = 1.4

#: No overturning below this `build_up`, whatever else; or below the second one, with a `largest` below the third and
#: no overturning of the impulsive rung under the raised input.
SAFE_BUILD_UP, SAFE_BUILD_UP_RAISED, SAFE_LARGEST = 0.8, 1.0, 0.4

#: The peak of a lane of low `build_up` is at most this times build_up^2.
PEAK_CEILING = 1.3

#: Relative margin of the static rung, far above the rounding of a product.
ROUNDING = 1e-9


def choose_response(
    block: Block,
    acceleration: ArrayLike,
    dt: float,
    times: ArrayLike | None = None,
    impulses: ArrayLike | None = None,
    scale: ArrayLike = 1.0,
    vertical: ArrayLike | None = None,
    output: str = "outcome",
    tolerance: float = 1e-4,
    threads: int | None = None,
) -> tuple[Response, Integers]:
    """Rocking response by the cheapest model that answers, chosen for every lane.

    Parameters
    ----------
    block : Block
        One block or (m,) of them.
    acceleration : (n,) array_like
        Horizontal ground acceleration a_g [m/s2].
    dt : float
        Sampling interval [s].
    times, impulses : (k,) array_like, optional
        Half-waves of the same record: centroids [s] and signed impulses [m/s]. Without them the impulsive rung is not
        used.
    scale : float or (q,) array_like
        Factor on the record, not negative [-].
    vertical : (n,) array_like, optional
        Vertical ground acceleration [m/s2], positive up. With it only the static and the nonlinear rung are used: the
        others were measured without.
    output : {"outcome", "peak"}
        The part of the answer that has to be right: the outcome, or the peak to within `tolerance` as well.
    tolerance : float
        Error of theta_max/alpha_c that may be made with `output="peak"` [-].
    threads : int, optional
        As in :func:`recorded_response`.

    Returns
    -------
    response : Response
        Arrays (q, m), a scalar axis dropped. Outcomes are those of the nonlinear equation, by measurement and not by
        proof: weak pulses locked to the block's own impacts are known to break it (docs/decisions/006). With
        `output="outcome"` the other numbers are those of the rung that answered: a peak of the impulsive rung is the
        motion under the strongest half-waves (spread against the nonlinear one: docs/decisions/006), one of the
        settled rung leaves out what comes after it was settled, and its overturning time is that of the angle of no
        return. `active_samples` is -1 for the impulsive rung, `impacts` for the settled one where the block rocks.
    model_used : int or (q, m) ndarray
        :class:`Rung` of every lane.

    Raises
    ------
    ValueError
        For an unknown output, a tolerance that is not positive and finite, times without impulses, and what
        :func:`recorded_response` and :func:`impulsive_response` refuse.

    Notes
    -----
    Static: a_g and a_v at most such that (g + a_v) tan alpha is not exceeded, taken with their largest values at any
    time; nothing is assumed. Settled: a block beyond the angle alpha + atan(max abs(a_g)/g) that moves outward does not
    come back; that one which rocks will not overturn is measured, as everything else is. Lanes outside
    :data:`MEASURED_RANGE` are answered by the nonlinear equation.

    With `output="peak"` the impulsive rung answers lanes whose peaks cannot exceed `tolerance` by either model, and the
    settled rung is not used.

    Examples
    --------
    >>> import numpy as np
    >>> from rockpulse import models
    >>> blocks = models.Block(half_width=np.array([0.2, 1.0]), half_height=2.0)
    >>> sine = 2.0 * np.sin(2.0 * np.pi * np.arange(0.0, 3.005, 0.01))
    >>> response, used = models.choose_response(blocks, sine, 0.01)
    >>> [models.Rung(rung).name for rung in used]
    ['NONLINEAR', 'STATIC']
    """
    if output not in ("outcome", "peak"):
        raise ValueError(f"output: expected 'outcome' or 'peak', got {output!r}")
    error = float(numbers("tolerance", tolerance, "a positive error of theta_max/alpha_c", lanes=False))
    if not error > 0.0:
        raise ValueError(f"tolerance: expected a positive error of theta_max/alpha_c, got {tolerance!r}")
    if (times is None) != (impulses is None):
        raise ValueError("times, impulses: expected both or none; they are the half-waves of the record")
    factors = numbers("scale", scale, "a factor >= 0")
    if np.any(factors < 0.0):
        raise ValueError(f"scale: expected a factor >= 0 or a (q,) array of them, got {scale!r}")
    # A record at factor zero lifts nothing: this has the other arguments checked where no lane needs the equation.
    recorded_response(block, acceleration, dt, scale=0.0, vertical=vertical, threads=threads)
    ground = np.ascontiguousarray(acceleration, dtype=float)
    up = None if vertical is None else np.ascontiguousarray(vertical, dtype=float)
    blocks = block if block.shape else block.lanes(1)
    lanes = _Lanes(blocks, ground, float(dt), np.atleast_1d(factors), up, threads)
    lanes.rest()
    if up is None and ground.any():
        demand = ground_demand(blocks, ground, dt)
        if times is not None:
            waves = _strongest(np.asarray(times, dtype=float), np.asarray(impulses, dtype=float))
            lanes.impulsive(demand, *waves, tolerance=None if output == "outcome" else error)
        if output == "outcome":
            lanes.settled(demand)
    lanes.nonlinear()
    drop = (factors.ndim == 0, block.shape == ())
    return drop_axes(lanes.response, drop), squeezed(lanes.model_used, drop)


def within_measured_range(block: Block, dt: float) -> np.ndarray:
    """True, (m,), for the free blocks that lie within :data:`MEASURED_RANGE` on a record sampled at dt [s]."""
    housner = 1.0 - 1.5 * np.sin(block.alpha_c) ** 2
    measured = {
        "p": block.p,
        "alpha": block.alpha_c,
        "restitution": block.restitution / housner,
        "p_dt": block.p * dt,
    }
    # Housner's own value may come back as 1 + 1e-16 times itself.
    return np.asarray(block.free) & np.all(
        [
            np.asarray((values >= low * (1.0 - ROUNDING)) & (values <= high * (1.0 + ROUNDING)))
            for values, (low, high) in ((measured[name], MEASURED_RANGE[name]) for name in measured)
        ],
        axis=0,
    )


def _strongest(times: np.ndarray, impulses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The strongest half-waves, in their order; the impulsive model refuses what is no list of them."""
    if times.shape != impulses.shape or times.ndim != 1 or times.size <= STRONGEST_WAVES:
        return times, impulses
    kept = np.sort(np.argpartition(np.abs(impulses), -STRONGEST_WAVES)[-STRONGEST_WAVES:])
    return times[kept], impulses[kept]


class _Lanes:
    """Lanes (q, m) that the rungs answer one after the other; a rung looks only at what is open."""

    def __init__(
        self,
        blocks: Block,
        ground: np.ndarray,
        dt: float,
        factors: np.ndarray,
        up: np.ndarray | None,
        threads: int | None,
    ) -> None:
        shape = (factors.size, blocks.shape[0])
        self.blocks, self.ground, self.dt, self.factors, self.up, self.threads = (
            blocks,
            ground,
            dt,
            factors,
            up,
            threads,
        )
        self.response = Response(
            peak_rotation_ratio=np.zeros(shape),
            outcome=np.full(shape, int(Outcome.AT_REST), dtype=np.int8),
            reason=np.zeros(shape, dtype=np.int8),
            overturning_time=np.full(shape, np.nan),
            overturning_half_cycle=np.full(shape, -1),
            impacts=np.zeros(shape, dtype=np.int64),
            active_samples=np.zeros(shape, dtype=np.int64),
        )
        self.model_used = np.full(shape, int(Rung.STATIC), dtype=np.int8)
        self.open = np.ones(shape, dtype=bool)
        self.inside = within_measured_range(blocks, dt)

    def rest(self) -> None:
        """Static: not even the largest horizontal and vertical acceleration together lift the block."""
        tangent = np.tan(self.blocks.alpha_c)
        largest = np.max(np.abs(self.ground))
        if self.up is not None:
            largest = largest + tangent * max(-float(np.min(self.up)), 0.0)
        self.open = self.factors[:, None] * largest > self.blocks.gravity * tangent * (1.0 - ROUNDING)
        others = ~np.asarray(self.blocks.free)
        if np.any(others):
            lifting = uplift_scale(self.blocks.chosen(others), self.ground, vertical=self.up) * (1.0 - ROUNDING)
            self.open[:, others] = self.factors[:, None] > lifting

    def impulsive(self, demand: Demand, times: np.ndarray, impulses: np.ndarray, tolerance: float | None) -> None:
        """The strongest half-waves as impulses, where the demand is low and they do not overturn the block."""
        for row, factor in enumerate(self.factors):
            build_up, largest = factor * demand.build_up, factor * demand.largest
            lowest = build_up <= SAFE_BUILD_UP
            low = lowest | ((build_up <= SAFE_BUILD_UP_RAISED) & (largest <= SAFE_LARGEST))
            if tolerance is not None:
                low = lowest & (PEAK_CEILING * build_up**2 <= tolerance)
            chosen = np.flatnonzero(self.open[row] & self.inside & low)
            if chosen.size == 0:
                continue
            answer = impulsive_response(
                _part(self.blocks, chosen),
                times,
                impulses,
                scale=factor * np.array([1.0, RAISED]),
                gain="exact",
                threads=self.threads,
            )
            rocks = np.asarray(answer.outcome) == Outcome.ROCKS
            taken = rocks[0] & (lowest[chosen] | rocks[1])
            if tolerance is not None:
                taken &= np.asarray(answer.peak_rotation_ratio)[0] <= tolerance
            first = {name: values[0] for name, values in _answers(answer).items()}
            self._take(np.full(chosen.size, row), chosen, taken, first, Rung.IMPULSIVE)

    def settled(self, demand: Demand) -> None:
        """The nonlinear equation until the verdict is settled, by what is left of the record."""
        rows, columns = np.nonzero(self.open & self.inside)
        if rows.size == 0:
            return
        part = self._equation(rows, columns, demand.of(columns))
        stopped = (part["outcome"] == Outcome.ROCKS) & (part["impacts"] == -1)
        stopped |= part["outcome"] == Outcome.OVERTURNS
        self._take(rows, columns, stopped, part, Rung.SETTLED)
        self._take(rows, columns, ~stopped, part, Rung.NONLINEAR)

    def nonlinear(self) -> None:
        """The nonlinear equation for what is left."""
        rows, columns = np.nonzero(self.open)
        if rows.size:
            whole = self._equation(rows, columns)
            self._take(rows, columns, np.ones(rows.size, dtype=bool), whole, Rung.NONLINEAR)

    def _equation(self, rows: np.ndarray, columns: np.ndarray, verdict: Demand | None = None) -> dict[str, np.ndarray]:
        """Nonlinear response of some lanes."""
        whole = recorded_response(
            _part(self.blocks, columns),
            self.ground,
            self.dt,
            block_scale=self.factors[rows],
            vertical=self.up,
            verdict=verdict,
            threads=self.threads,
        )
        return _answers(whole)

    def _take(
        self, rows: np.ndarray, columns: np.ndarray, taken: np.ndarray, answers: dict[str, np.ndarray], rung: Rung
    ) -> None:
        """Copy the answers of a rung into the lanes that it decides."""
        lanes = rows[taken], columns[taken]
        for name in _answers(self.response):
            getattr(self.response, name)[lanes] = answers[name][taken] if name in answers else -1
        self.model_used[lanes] = int(rung)
        self.open[lanes] = False


def _answers(response: Response) -> dict[str, np.ndarray]:
    """The fields of a response that hold a value for every lane."""
    values = {item.name: getattr(response, item.name) for item in fields(Response)}
    return {name: array for name, array in values.items() if array is not None}


def _part(blocks: Block, chosen: np.ndarray) -> Block:
    return blocks.chosen(chosen)
