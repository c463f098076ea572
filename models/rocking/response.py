"""The result of a model: a :class:`Response` for each block and scale factor, and the codes of outcomes."""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple, Self

import numpy as np

from rocking.arguments import Booleans, Floats, Integers
from rocking.lanes import LaneValues, lane_field
from rocking.pictures import BLUE, GREY, INK, RED, Picture, Shown, brief, short_repr, thinned

#: Impacts slower than this, divided by p alpha_c [-], are not counted: they lift the block by at most 5e-7 alpha_c.
IMPACT_CUTOFF = 1e-3
#: Largest number of peaks that are drawn, and largest theta/alpha_c in the picture [-].
DRAWN, TOP = 200, 1.2


class Outcome(IntEnum):
    """Outcome of a computed motion.

    >>> Outcome(rocking.resonance(pier, impulse=0.5, half_cycles=3).outcome).word
    'overturns'
    """

    AT_REST = 0  #: never uplifted
    ROCKS = 1  #: uplifted, then returns to rest or to a bounded motion
    OVERTURNS = 2
    UNRESOLVED = 3  #: the model cannot decide; see the reason

    @property
    def word(self) -> str:
        """The name of the outcome in result files: "at_rest", "rocks", "overturns" or "unresolved"."""
        return self.name.lower()


class Reason(IntEnum):
    """Reason for which an outcome is UNRESOLVED.

    >>> Reason(rocking.resonance(pier, impulse=0.5, half_cycles=3).reason)
    <Reason.NONE: 0>
    """

    NONE = 0
    IMPACT_LIMIT = 1  #: more impacts in a row than the solver computes (restitution of one or close to it)
    FREE_FLIGHT = 2  #: the vertical acceleration cancels gravity: the block leaves the ground
    HALF_CYCLE_LIMIT = 3  #: more half-cycles than the model computes
    NO_SEQUENCE = 4  #: no impulse sequence was found in the record
    SHORT_INTERVAL = 5  #: secondary impulses too close together for the model; use the limit, spacing="continuous"
    NOT_MODELLED = 6  #: the model cannot treat a feature of the body: different corners, a wall, ties, loads or thrusts


#: Names and colours of the outcomes, in their order.
WORDS = np.array([outcome.word for outcome in Outcome])
COLOURS = (GREY, BLUE, RED, INK)


@dataclass(frozen=True, eq=False)
class HalfCycles(LaneValues):
    """Table of the half-cycles of a response, numbered along the first axis; NaN (or -1) after the last one.

    Attributes
    ----------
    start_velocity, peak, impact_speed : (h, ...) ndarray
        u_i = theta'/(p alpha_c) right after the impact and the main impulse [-]; largest theta/alpha_c [-], inf if the
        block overturns; speed u_r right before the next impact [-].
    duration, interval : (h, ...) ndarray
        Time to the next impact (inf without one), and corrected interval dT_i of the intermediate impulses [s].
    impulse_count : (h, ...) ndarray of int
        Number n_i of intermediate impulses (0 without any, -1 if n -> infinity or the row is empty).

    Examples
    --------
    >>> rocking.resonance(pier, impulse=0.5, half_cycles=3).half_cycles.peak.round(3)
    array([0.076, 0.316,   inf])
    """

    __repr__ = short_repr

    start_velocity: np.ndarray = lane_field()
    peak: np.ndarray = lane_field()
    duration: np.ndarray = lane_field()
    impulse_count: np.ndarray = lane_field(-1)
    interval: np.ndarray = lane_field()
    impact_speed: np.ndarray = lane_field()


@dataclass(frozen=True, eq=False, repr=False)
class Response(LaneValues, Shown):
    """Peak, outcome and events of rocking motions: arrays with a value for each block and scale factor, or scalars.

    Attributes
    ----------
    peak_rotation_ratio : float or ndarray
        Largest abs(theta)/alpha_c [-], also between samples; inf if overturned, 0 at rest, NaN only if UNRESOLVED.
    outcome, reason : int or ndarray
        :class:`Outcome`, and its :class:`Reason` if it is UNRESOLVED, else NONE.
    overturning_time : float or ndarray
        Time at which overturning is certain [s]; NaN without overturning.
    overturning_half_cycle : int or ndarray
        Number of impacts before overturning, plus 1; -1 without overturning. The sequence and impulsive models count
        every half-cycle, the response to a record only those that end with a counted impact.
    impacts : int or ndarray
        Number of impacts faster than :data:`IMPACT_CUTOFF` p alpha_c, also after the end of the input; -1 if they never
        end (C = 1) or the outcome is UNRESOLVED.
    time, rotation, velocity : ndarray or None
        History [s], [rad], [rad/s], if requested.
    half_cycles : HalfCycles or None
        The table of the sequence models.
    ground_contact : bool or ndarray or None
        Sequence model only: True if a half-cycle with the corrected interval passes through the ground before its end
        (spacing "start" above I_s/I = 2/3, "middle" above 6/7). The closed form, which uses only the end, is then not a
        possible motion, and the impulse train gives another result.
    active_samples : int or ndarray or None
        Response to a record only: number of samples in which the block moved.
    corner_rotation : (2, ...) ndarray or None
        Bodies with ties, loads or thrusts only: largest rotation about the right-hand and the left-hand corner [rad],
        inf if the body overturns about it; NaN for other bodies and if UNRESOLVED.

    Examples
    --------
    >>> rocking.recorded_response(pier, record.acceleration, record.dt)
    <Response rocks, peak 0.581 alpha_c, impacts 77>
    """

    peak_rotation_ratio: Floats = lane_field()
    outcome: Integers = lane_field(int(Outcome.UNRESOLVED))
    reason: Integers = lane_field(int(Reason.NONE))
    overturning_time: Floats = lane_field()
    overturning_half_cycle: Integers = lane_field(-1)
    impacts: Integers = lane_field(-1)
    time: np.ndarray | None = None
    rotation: np.ndarray | None = lane_field(axis=-2, default=None)
    velocity: np.ndarray | None = lane_field(axis=-2, default=None)
    half_cycles: HalfCycles | None = lane_field(default=None)
    ground_contact: Booleans | None = lane_field(False, default=None)
    active_samples: Integers | None = lane_field(0, default=None)
    corner_rotation: np.ndarray | None = lane_field(default=None)

    @classmethod
    def unresolved(cls, lanes: tuple[int, ...], reason: Reason) -> Self:
        """Return a response of the shape `lanes` in which every outcome is UNRESOLVED for the same reason."""
        codes = np.full(lanes, int(Outcome.UNRESOLVED), dtype=np.int8), np.full(lanes, int(reason), dtype=np.int8)
        return cls(np.full(lanes, np.nan), *codes, np.full(lanes, np.nan), np.full(lanes, -1), np.full(lanes, -1))

    def among(self, known: np.ndarray, reason: Reason) -> Self:
        """Return the response of all (m,) blocks from that of the `known` blocks; the others are UNRESOLVED."""
        return self.join([self], [np.flatnonzero(known)], known.size, reason=int(reason))

    @property
    def overturned(self) -> Booleans:
        """True if the block overturned; False if the outcome is UNRESOLVED."""
        found = np.asarray(self.outcome) == Outcome.OVERTURNS
        return bool(found) if found.ndim == 0 else found

    @property
    def outcome_name(self) -> str | np.ndarray:
        """The outcome, "at_rest", "rocks", "overturns" or "unresolved"; an array of strings for several motions.

        Examples
        --------
        >>> from rocking import Block, resonance
        >>> resonance(Block(width=0.5, height=2.0), [0.1, 1.0], half_cycles=2).outcome_name.tolist()
        ['rocks', 'overturns']
        """
        found = WORDS[np.asarray(self.outcome)]
        return str(found) if found.ndim == 0 else found

    def _facts(self) -> dict[str, str]:
        if np.ndim(self.outcome) == 0:
            by = "" if np.isnan(self.overturning_time) else f" by {float(self.overturning_time):.4g} s"
            facts = {"": f"{self.outcome_name}{by}"}
            peak = float(self.peak_rotation_ratio)
            facts |= {"peak": f"{peak:.4g} alpha_c"} if math.isfinite(peak) and peak > 0.0 else {}
            facts |= {} if int(self.impacts) < 0 else {"impacts": str(int(self.impacts))}
        else:
            codes = np.asarray(self.outcome)
            facts = {"of": f"{' x '.join(map(str, codes.shape))} lanes"}
            for outcome in Outcome:
                count = int(np.count_nonzero(codes == outcome))
                facts |= {outcome.word: str(count)} if count else {}
            moving = np.asarray(self.peak_rotation_ratio)[codes == Outcome.ROCKS]
            facts |= {"peak of those that rock": f"{brief(moving)} alpha_c"} if moving.size else {}
        return facts | ({} if self.time is None else {"history": f"of {self.time.size} samples"})

    def _picture(self) -> Picture:
        if self.time is None or self.rotation is None:
            return self._peaks()
        return self._history(self.time, self.rotation.reshape(-1, self.time.size)[0])

    def _history(self, time: np.ndarray, rotation: np.ndarray) -> Picture:
        """Draw the rotation over time; of several motions, only the first one is drawn."""
        known = np.isfinite(rotation)
        x, y = thinned(time[known], rotation[known])
        reach = max(float(np.max(np.abs(y), initial=0.0)), 1e-12)
        picture = Picture((float(time[0]), float(time[-1])), (-reach, reach))
        picture.line([time[0], time[-1]], [0.0, 0.0], GREY, 0.5)
        picture.line(x, y, RED if bool(np.ravel(self.overturned)[0]) else BLUE)
        picture.words(f"{reach:.3g} rad", float(time[0]), reach, "start")
        picture.words(f"{time[-1]:.4g} s", float(time[-1]), -reach, "end")
        return picture

    def _peaks(self) -> Picture:
        """Draw the peak of each motion as a bar in the colour of its outcome, of full height if it overturns."""
        peaks, codes = np.ravel(self.peak_rotation_ratio)[:DRAWN], np.ravel(self.outcome)[:DRAWN]
        # A motion without a value gets a short bar, so that it is visible.
        heights = np.nan_to_num(np.minimum(peaks, TOP), nan=0.05)
        picture = Picture((-0.5, peaks.size - 0.5), (0.0, TOP), height=90.0)
        picture.line([-0.5, peaks.size - 0.5], [0.0, 0.0], GREY, 0.5)
        picture.line([-0.5, peaks.size - 0.5], [1.0, 1.0], GREY, 0.5, "4 3")
        picture.words("alpha_c", peaks.size - 0.5, 1.05, "end", GREY)
        for outcome, colour in zip(Outcome, COLOURS, strict=True):
            own = np.flatnonzero(codes == outcome)
            if own.size:
                picture.stems(own, np.maximum(heights[own], 0.01), colour, max(1.0, min(40.0, 250.0 / peaks.size)))
        return picture


class LaneResults(NamedTuple):
    """Arrays (lanes,) for the results of a kernel, one value per body and scale factor; see :class:`Response`."""

    peak_rotation_ratio: np.ndarray
    outcome: np.ndarray
    reason: np.ndarray
    overturning_time: np.ndarray
    overturning_half_cycle: np.ndarray
    impacts: np.ndarray


def empty_results(lanes: int, codes: Any = np.int64) -> LaneResults:
    """Return arrays without values, which a kernel will fill; `codes` is the dtype of outcome and reason."""
    types = (np.float64, codes, codes, np.float64, np.int64, np.int64)
    return LaneResults(*(np.empty(lanes, dtype=kind) for kind in types))


def response_of(
    results: LaneResults,
    shape: tuple[int, int],
    motion: np.ndarray | None = None,
    time: np.ndarray | None = None,
    half_cycles: HalfCycles | None = None,
    **others: np.ndarray,
) -> Response:
    """Return the (q, m) response from the results of a kernel; `motion` (q m, n, 2) is theta and theta' over time."""
    lanes = {name: values.reshape(shape) for name, values in (results._asdict() | others).items()}
    if motion is not None:
        lanes |= {name: motion[..., k].reshape(*shape, -1) for k, name in enumerate(("rotation", "velocity"))}
    return Response(**lanes, time=time, half_cycles=half_cycles)
