"""The variables of a study file: type, unit and meaning of each (docs/schema.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.storage.variables import Meaning, described

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["AXES", "FIGURE4", "FIGURE5", "INTERVALS", "STATEMENTS", "STUDY", "VERDICTS", "described_set", "no_motion"]

#: Root attribute `kind` of a study file.
STUDY = "study"

#: Coordinates of all groups.
AXES: dict[str, Meaning] = {
    "restitution": (float, "1", "velocity ratio C of an impact"),
    "impulse_ratio": (float, "1", "I/I_1c, main impulse over the one that overturns the resting block at once"),
    "secondary_ratio": (float, "1", "I_s/I, secondary over main impulse"),
    "spacing": (str, "1", "where the secondary impulses stand in the half-cycle"),
    "intermediate_count": (float, "1", "secondary impulses n in every half-cycle; inf: the continuous limit"),
    "p": (float, "s-1", "frequency parameter of the block"),
    "block": (str, "1", "name of the block"),
    "interval": (float, "s", "trial interval dT of the secondary impulses"),
    "half_cycle": (int, "1", "number of the half-cycle, from 1"),
    "time": (float, "s", "time from the first main impulse"),
    "statement": (str, "1", "name of the statement"),
}

_ANSWER: dict[str, Meaning] = {
    "peak_rotation_ratio": (float, "1", "largest theta/alpha_c under the limited input; inf where the block overturns"),
    "outcome": (np.int8, "1", "how the motion ends"),
    "overturning_half_cycle": (int, "1", "half-cycle in which the block overturns; -1 where it does not"),
    "half_cycle_count": (int, "1", "half-cycles that a main impulse starts, that of overturning included"),
    "ground_contact": (
        np.int8,
        "1",
        "whether the march passes through the ground inside a half-cycle, so that the closed form stands for no motion",
    ),
    "no_motion": (
        np.int8,
        "1",
        "whether the closed form stands for no motion of a block: ground_contact, or a finite peak beyond alpha_c",
    ),
}

FIGURE4: dict[str, Meaning] = {
    **_ANSWER,
    "endless_peak_rotation_ratio": (float, "1", "largest theta/alpha_c under an input without end"),
    "duration_binds": (np.int8, "1", "whether an input without end gives another peak, by more than 1e-9 of it"),
}

_LANE: dict[str, Meaning] = {
    **_ANSWER,
    "overturning_time": (float, "s", "start of the half-cycle in which the block overturns; NaN where it does not"),
}

FIGURE5: dict[str, Meaning] = {
    "width": (float, "m", "full width 2b in the plane of rocking"),
    "height": (float, "m", "full height 2a"),
    "radius": (float, "m", "R, half the diagonal"),
    "alpha_c": (float, "rad", "critical angle"),
    "p": (float, "s-1", "frequency parameter"),
    "slenderness": (float, "1", "height over width"),
    "critical_impulse": (float, "m s-1", "I_1c, the impulse that overturns the resting block at once"),
    "housner_restitution": (float, "1", "Housner's velocity ratio C of an impact, 1 - 1.5 sin^2(alpha_c)"),
    "double_impulse": (float, "m s-1", "V_c, critical double impulse of Nabeshima et al. (2016), Housner's C"),
    "double_impulse_time": (float, "s", "t_0, time between its two impulses"),
    "main_impulse": (float, "m s-1", "I = I_2c, the impulse that overturns in the second half-cycle when alone"),
    "impulse_ratio": (float, "1", "I/I_1c"),
    "second_impulse_time": (float, "s", "time of the second main impulse without secondary ones"),
    **_LANE,
    "start_velocity": (float, "1", "u_i = theta'/(p alpha_c) right after the main impulse"),
    "peak": (float, "1", "largest theta/alpha_c in the half-cycle; inf where the block overturns"),
    "duration": (float, "s", "time to the next impact; inf where there is none"),
    "impulse_count": (int, "1", "secondary impulses n_i; -1 where n -> infinity or there is no half-cycle, 0 without"),
    "corrected_interval": (float, "s", "corrected interval dT_i of the secondary impulses; NaN without"),
    "impact_speed": (float, "1", "speed right before the next impact over p alpha_c; NaN where there is none"),
    "rotation_ratio": (
        float,
        "1",
        "theta/alpha_c, positive about the right-hand corner; NaN once an overturning block has passed alpha_c",
    ),
}

INTERVALS: dict[str, Meaning] = {
    **_LANE,
    "holds": (np.int8, "1", "whether the statement holds with this common interval"),
    "all_hold": (np.int8, "1", "whether all statements hold that hold with some spacing and interval"),
}

STATEMENTS: dict[str, Meaning] = {
    "words": (str, "1", "what section 4 says"),
    "verdict": (np.int8, "1", "whether it holds"),
    "cases": (int, "1", "cases looked at"),
    "held": (int, "1", "cases in which it holds"),
    "where": (str, "1", "where it holds"),
    "numbers": (str, "1", "figures that show it"),
}

#: Flags of `verdict`.
VERDICTS = ("fails", "holds_in_part", "holds", "not_examined")

_FLAGS: dict[str, Sequence[str]] = {
    "outcome": [outcome.name.lower() for outcome in Outcome],
    "ground_contact": ["clear", "passes_through"],
    "no_motion": ["no", "yes"],
    "duration_binds": ["free", "binds"],
    "holds": ["no", "yes"],
    "all_hold": ["no", "yes"],
    "verdict": VERDICTS,
}


def no_motion(ground_contact: Any, *peaks: Any) -> np.ndarray:
    """Where the closed form stands for no motion of a block: see the variable of that name.

    Parameters
    ----------
    ground_contact : array_like of bool
        Whether the march passes through the ground inside a half-cycle.
    *peaks : array_like
        Largest theta/alpha_c [-]; inf where the block overturns. A block beyond alpha_c does not come back: with
        "start" x(T) = 0 has roots for velocities of up to 1 + I_s/I on motions that do (docs/decisions/016).

    Examples
    --------
    >>> no_motion([False, False, False, True], [0.9, 1.1, np.inf, 0.5]).tolist()
    [False, True, False, True]
    """
    flags = np.asarray(ground_contact, dtype=bool)
    for peak in peaks:
        flags = flags | (np.isfinite(peak) & (np.asarray(peak) > 1.0))
    return flags


def described_set(
    variables: Mapping[str, tuple[tuple[str, ...], Any]], coords: Mapping[str, Any], meanings: Mapping[str, Meaning]
) -> xr.Dataset:
    """A dataset whose variables and coordinates carry units, long names and flags.

    Parameters
    ----------
    variables : mapping of str to (dimensions, values)
        What it holds.
    coords : mapping of str to array_like
        One-dimensional coordinates of :data:`AXES`, or scalars of it.
    meanings : mapping of str to Meaning
        Meaning of every variable.
    """
    import xarray as xr

    axes = {name: described((name,) if np.ndim(values) else (), values, AXES[name]) for name, values in coords.items()}
    dataset = xr.Dataset(
        {name: described(dims, values, meanings[name]) for name, (dims, values) in variables.items()}, axes
    )
    for name, meanings_of_flags in _FLAGS.items():
        if name in dataset:
            dataset[name].attrs["flag_values"] = np.arange(len(meanings_of_flags), dtype=np.int8)
            dataset[name].attrs["flag_meanings"] = " ".join(meanings_of_flags)
    return dataset
