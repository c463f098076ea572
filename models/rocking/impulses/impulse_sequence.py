"""The limit accelerogram: main impulses at the impacts, secondary impulses between them (Casapulla & Maione 2017)."""

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from rocking.arguments import ArrayLike, Floats, Integers, counts
from rocking.impulses.half_cycle import CONTINUOUS, END, MIDDLE, OPEN, START
from rocking.impulses.main_sequence import effective_amplification
from rocking.pictures import BLUE, GREY, RED, Picture, Shown, brief

#: Default and largest number of intermediate impulses in a half-cycle of a drawing.
SHOWN, MOST = 4, 12
#: Time of the first intermediate impulse after the main one, in intervals.
FIRST = {"end": 1.0, "middle": 0.5, "start": 0.0, "open": 1.0}
#: Times of the intermediate impulses in the half-cycle: t_k = (k - phi) dT with T = n dT for "end" (phi = 0),
#: "middle" (1/2) and "start" (1); "open": t_k = k dT with T = (n + 1) dT; "continuous": the limit of infinitely many.
#: The numbers are the kernels' codes.
SPACINGS = {"end": END, "middle": MIDDLE, "start": START, "open": OPEN, "continuous": CONTINUOUS}


@dataclass(frozen=True, eq=False, repr=False)
class ImpulseSequence(Shown):
    """A main and a secondary sequence of impulses, or q of each; the fields are broadcast to the shape () or (q,).

    Parameters
    ----------
    main, secondary : float or (q,) array_like
        Sizes I of a main impulse, not negative, and I_s of a secondary impulse, 0 <= I_s <= I [m/s].
    interval : float or (q,) array_like
        Trial interval dT of the secondary impulses [s], positive; may be NaN if it is not used (spacing "continuous",
        or `intermediate_count` given).
    duration : float or (q,) array_like
        Main impulses act in half-cycles that start before this time [s], positive; inf for an endless sequence.
    main_count : int or (q,) array_like of int, optional
        Largest number of main impulses [-], at least 1; None for no limit.
    intermediate_count : int, optional
        Number n of secondary impulses in every half-cycle, even and at least 2; None to derive it from `interval`.
    spacing : {"end", "middle", "start", "open", "continuous"}
        See :data:`SPACINGS`.

    References
    ----------
    Casapulla, C., Maione, A. (2017), COMPDYN 2017, section 3.2, doi:10.7712/120117.5612.17190.

    Examples
    --------
    >>> sequence = ImpulseSequence(main=0.7, secondary=0.28, interval=0.1, duration=20.0)
    >>> sequence.scaled(2.0).secondary
    0.56
    """

    main: Floats
    secondary: Floats
    interval: Floats
    duration: Floats
    main_count: Integers | None = None
    intermediate_count: int | None = None
    spacing: str = "end"

    def __post_init__(self) -> None:
        if self.spacing not in SPACINGS:
            raise ValueError(f"spacing: expected one of {', '.join(SPACINGS)}, got {self.spacing!r}")
        names = ("main", "secondary", "interval", "duration")
        given = main, secondary, interval, duration = [_numbers(name, getattr(self, name)) for name in names]
        unused = np.isnan(interval) & (self.spacing == "continuous" or self.intermediate_count is not None)
        needed = (
            (np.isfinite(main) & (main >= 0.0), "a finite impulse [m/s] that is not negative"),
            ((secondary >= 0.0) & (secondary <= main), "an impulse [m/s] between 0 and the main impulse"),
            ((np.isfinite(interval) & (interval > 0.0)) | unused, "a positive, finite time [s]"),
            (duration > 0.0, "a positive time [s], or inf"),
        )
        for name, (valid, expected) in zip(names, needed, strict=True):
            _require(valid, f"{name}: expected {expected}", getattr(self, name))
        limit: Any = None if self.main_count is None else counts("main_count", self.main_count, least=1)
        try:
            *whole, limits = np.broadcast_arrays(*given, np.asarray(limit))
        except ValueError:
            raise ValueError(
                "main, secondary, interval, duration and main_count: expected numbers or arrays of one length, "
                f"got shapes {', '.join(str(array.shape) for array in given)}, {np.shape(limit)}"
            ) from None
        found = {name: np.array(array) for name, array in zip(names, whole, strict=True)}
        found |= {"main_count": np.array(limits)} if isinstance(limit, np.ndarray) else {}
        for array in found.values():
            array.setflags(write=False)
        vars(self).update({name: array.item() if array.ndim == 0 else array for name, array in found.items()})
        if not isinstance(limit, np.ndarray):
            vars(self)["main_count"] = limit
        if self.intermediate_count is not None:
            count = counts("intermediate_count", self.intermediate_count, least=2, lanes=False)
            if count % 2:
                raise ValueError(
                    f"intermediate_count: expected an even number, so that the impulses sum to zero, got {count}"
                )
            vars(self)["intermediate_count"] = count

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the fields: () for one sequence, (q,) for several."""
        return np.shape(self.main)

    def scaled(self, factor: ArrayLike) -> Self:
        """Return the sequence with both impulses times a scale factor, or (q,) sequences for (q,) scale factors."""
        factor = _numbers("factor", factor)
        _require(np.isfinite(factor) & (factor >= 0.0), "factor: expected a finite number that is not negative", factor)
        return replace(self, main=factor * self.main, secondary=factor * self.secondary)

    def effective_impulse(self, restitution: ArrayLike) -> Floats:
        """Return the effective impulse I_eff for blocks with one restitution: a block overturns iff I_eff >= I_1c.

        Parameters
        ----------
        restitution : float or (q,) array_like
            C of the block [-], 0 to 1; one number, or one for each sequence.

        Returns
        -------
        float or (q,) ndarray
            I_eff = I [(1 - sigma) S_N + sigma/2] [m/s], sigma = I_s/I, S_N = (1 - C^N)/(1 - C), N the `main_count`;
            without a `main_count` the supremum over N, at which the block just survives.

        Raises
        ------
        ValueError
            For secondary impulses with another spacing than "continuous", a finite duration, or a C outside 0 to 1.

        Examples
        --------
        >>> sequence = ImpulseSequence(0.5, 0.2, np.nan, np.inf, main_count=2, spacing="continuous")
        >>> round(sequence.effective_impulse(0.9), 12)  # 0.5 [(1 - 0.4) 1.9 + 0.2]
        0.67
        """
        ratio = np.divide(self.secondary, self.main, out=np.zeros(self.shape), where=np.asarray(self.main) > 0.0)
        _require((self.spacing == "continuous") | (ratio == 0.0), 'spacing: expected "continuous"', self.spacing)
        _require(np.isinf(self.duration), "duration: expected inf; set main_count instead", self.duration)
        c = _numbers("restitution", restitution)
        _require((c >= 0.0) & (c <= 1.0), "restitution: expected a velocity ratio from 0 to 1", restitution)
        if self.main_count is None:
            with np.errstate(divide="ignore", invalid="ignore"):
                reached = np.where(ratio < 1.0, (1.0 - ratio) / (1.0 - c), 0.0) + 0.5 * ratio
        else:
            reached = np.vectorize(effective_amplification, otypes=[float])(c, ratio, self.main_count)
        found = self.main * reached
        return found.item() if np.ndim(found) == 0 else found

    def _facts(self) -> dict[str, str]:
        facts = {"of": f"{np.size(self.main)} sequences"} if np.ndim(self.main) else {}
        facts |= {"I": brief(self.main, "m/s"), "I_s": brief(self.secondary, "m/s")}
        if not np.all(np.isnan(self.interval)):
            facts["dT"] = brief(self.interval, "s")
        if self.intermediate_count is not None:
            facts["n"] = str(self.intermediate_count)
        facts["duration"] = brief(self.duration, "s")
        facts |= {} if self.main_count is None else {"main impulses": brief(self.main_count)}
        return facts | {"spacing": self.spacing}

    def two_half_cycles(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the main and the secondary impulses of two half-cycles of the first sequence: (k, 2) times and sizes.

        Times, divided by dT [-], are from the first main impulse; sizes [m/s] opposite to this impulse are negative.
        """
        main, secondary = float(np.ravel(self.main)[0]), float(np.ravel(self.secondary)[0])
        number = np.arange(min(self.intermediate_count or SHOWN, MOST))
        length = float(number.size + (self.spacing == "open"))
        mains = np.array([[0.0, main], [length, -main]])
        if secondary == 0.0 or self.spacing not in FIRST:
            return mains, np.empty((0, 2))
        # The first secondary impulse opposes the main impulse; the next ones alternate.
        own = np.column_stack([FIRST[self.spacing] + number, np.where(number % 2 == 0, -secondary, secondary)])
        return mains, np.concatenate([own, own * [1.0, -1.0] + [length, 0.0]])

    def _picture(self) -> Picture:
        mains, others = self.two_half_cycles()
        main, secondary = float(mains[0, 1]), float(np.ravel(self.secondary)[0])
        end, reach = 2.0 * float(mains[1, 0]), main or 1.0
        picture = Picture((-0.5, end + 0.5), (-1.2 * reach, 1.2 * reach))
        picture.line([-0.5, end + 0.5], [0.0, 0.0], GREY, 0.5)
        if secondary > 0.0 and not others.size:
            picture.polygon([0.0, end, end, 0.0], [-secondary, -secondary, secondary, secondary], BLUE)
        picture.stems(others[:, 0], others[:, 1], BLUE, 2.0)
        picture.stems(mains[:, 0], mains[:, 1], RED, 3.0)
        picture.words(f"I = {main:.3g} m/s", 0.15, 1.05 * reach, "start", RED)
        if secondary > 0.0:
            interval = float(np.ravel(self.interval)[0])
            every = "" if math.isnan(interval) or self.spacing == "continuous" else f" every {interval:.3g} s"
            picture.words(f"I_s = {secondary:.3g} m/s{every}", end, 1.05 * reach, "end", BLUE)
        return picture


def _numbers(name: str, value: ArrayLike) -> np.ndarray:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected a number or a (q,) array, got {value!r}") from None
    if array.ndim > 1:
        raise ValueError(f"{name}: expected a number or a (q,) array, got shape {array.shape}")
    return array


def _require(valid: np.ndarray, expected: str, value: ArrayLike) -> None:
    if not np.all(valid):
        raise ValueError(f"{expected}; got {value!r}")
