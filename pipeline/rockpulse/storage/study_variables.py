"""The variables of a study file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rocking.response import Outcome
from rockpulse.storage.variables import Declared, along, flag, real, text, whole

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "AXES",
    "CODE_CASES",
    "CODE_RATES",
    "FIGURE4",
    "FIGURE5",
    "INTERVALS",
    "STATEMENTS",
    "STUDY",
    "STUDY_GROUPS",
    "VERDICTS",
    "described_set",
    "no_motion",
]

#: Root attribute `kind` of a study file.
STUDY = "study"

#: Words of the flag `verdict`.
VERDICTS = ("fails", "holds_in_part", "holds", "not_examined")

#: Coordinates of all groups.
AXES: Declared = {
    "restitution": real("1", "velocity ratio C of an impact"),
    "impulse_ratio": real("1", "I/I_1c, main impulse over the one that overturns the resting block at once"),
    "secondary_ratio": real("1", "I_s/I, secondary over main impulse"),
    "spacing": text("where the secondary impulses stand in the half-cycle"),
    "intermediate_count": real("1", "secondary impulses n in every half-cycle; inf: the continuous limit"),
    "p": real("s-1", "frequency parameter of the block"),
    "block": text("name of the block"),
    "interval": real("s", "trial interval dT of the secondary impulses"),
    "half_cycle": whole("number of the half-cycle, from 1"),
    "time": real("s", "time from the first main impulse"),
    "statement": text("name of the statement"),
}

_ANSWER: Declared = {
    "peak_rotation_ratio": real("1", "largest theta/alpha_c under the limited input; inf where the block overturns"),
    "outcome": flag((outcome.name.lower() for outcome in Outcome), "how the motion ends"),
    "overturning_half_cycle": whole("half-cycle in which the block overturns; -1 where it does not"),
    "half_cycle_count": whole("half-cycles that a main impulse starts, that of overturning included"),
    "ground_contact": flag(
        ("clear", "passes_through"),
        "whether the march passes through the ground inside a half-cycle, so that the closed form stands for no motion",
    ),
    "no_motion": flag(
        ("no", "yes"),
        "whether the closed form stands for no motion of a block: ground_contact, or a finite peak beyond alpha_c",
        explanation="no block comes back from beyond alpha_c: the peaks are no result",
    ),
}

FIGURE4 = along(
    ("restitution", "impulse_ratio", "secondary_ratio", "spacing", "intermediate_count", "p"),
    {
        **_ANSWER,
        "endless_peak_rotation_ratio": real("1", "largest theta/alpha_c under an input without end"),
        "duration_binds": flag(
            ("free", "binds"), "whether an input without end gives another peak, by more than 1e-9 of it"
        ),
    },
)

_LANE: Declared = {
    **_ANSWER,
    "overturning_time": real("s", "start of the half-cycle in which the block overturns; NaN where it does not"),
}

#: The dimensions of an answer, over which the input differs.
_LANES = ("block", "restitution", "secondary_ratio", "spacing")

FIGURE5: Declared = {
    **along(
        ("block",),
        {
            "width": real("m", "full width 2b in the plane of rocking"),
            "height": real("m", "full height 2a"),
            "radius": real("m", "R, half the diagonal"),
            "alpha_c": real("rad", "critical angle"),
            "p": real("s-1", "frequency parameter"),
            "slenderness": real("1", "height over width"),
            "critical_impulse": real("m s-1", "I_1c, the impulse that overturns the resting block at once"),
            "housner_restitution": real("1", "Housner's velocity ratio C of an impact, 1 - 1.5 sin^2(alpha_c)"),
            "double_impulse": real("m s-1", "V_c, critical double impulse of Nabeshima et al. (2016), Housner's C"),
            "double_impulse_time": real("s", "t_0, time between its two impulses"),
        },
    ),
    **along(
        _LANES[:2],
        {
            "main_impulse": real("m s-1", "I = I_2c, the impulse that overturns in the second half-cycle when alone"),
            "impulse_ratio": real("1", "I/I_1c"),
            "second_impulse_time": real("s", "time of the second main impulse without secondary ones"),
        },
    ),
    **along(_LANES, {**_LANE}),
    **along(
        (*_LANES, "half_cycle"),
        {
            "start_velocity": real("1", "u_i = theta'/(p alpha_c) right after the main impulse"),
            "peak": real("1", "largest theta/alpha_c in the half-cycle; inf where the block overturns"),
            "duration": real("s", "time to the next impact; inf where there is none"),
            "impulse_count": whole(
                "secondary impulses n_i; -1 where n -> infinity or there is no half-cycle, 0 without"
            ),
            "corrected_interval": real("s", "corrected interval dT_i of the secondary impulses; NaN without"),
            "impact_speed": real("1", "speed right before the next impact over p alpha_c; NaN where there is none"),
        },
    ),
    **along(
        (*_LANES, "time"),
        {
            "rotation_ratio": real(
                "1",
                "theta/alpha_c, positive about the right-hand corner; NaN once an overturning block has passed alpha_c",
                explanation="the first main impulse pushes the ground to the right and the block to the left, so it "
                "starts negative",
            )
        },
    ),
}

INTERVALS: Declared = {
    **along((*_LANES, "interval"), _LANE),
    "holds": flag(
        ("no", "yes"),
        "whether the statement holds with this common interval",
        dims=("statement", "spacing", "interval"),
    ),
    "all_hold": flag(
        ("no", "yes"),
        "whether all statements hold that hold with some spacing and interval",
        dims=("spacing", "interval"),
    ),
}

STATEMENTS = along(
    ("statement",),
    {
        "words": text("what section 4 of the paper, or a code, says"),
        "verdict": flag(VERDICTS, "whether it holds"),
        "cases": whole("cases looked at"),
        "held": whole("cases in which it holds"),
        "where": text("where it holds"),
        "numbers": text("figures that show it"),
    },
)


_SHARE = "share of 90 % over earthquakes"

#: A row for each channel and body of the checks of codes.
CODE_CASES = along(
    ("row",),
    {
        "record": text("channel"),
        "event": text("its earthquake"),
        "slenderness": real("1", "height over width"),
        "radius": real("m", "R, half the diagonal"),
        "uplift_factor": real("1", "factor on the record above which it lifts the body"),
        "factor_10": real("1", "factor on the record at which the probability of overturning is 10 %"),
        "factor_50": real("1", "factor on the record at which the probability of overturning is 50 %"),
        "linear": real("1", "largest factor that the linear check of Circolare 617/2009 allows"),
        "nonlinear": real("1", "largest factor that its nonlinear check allows"),
        "both": real("1", "the smaller of the two"),
        "displacement": real("1", "largest factor that the displacement check of Circolare 7/2019 allows"),
    },
)

#: A row for each factor and check.
CODE_RATES = along(
    ("rate",),
    {
        "factor": real("1", "factor on the records; NaN for all of them"),
        "check": text("variable of /code_check"),
        "overturned": whole("cases with a probability of overturning of 50 % or more"),
        "standing": whole("all other cases"),
        "missed": whole("cases that overturn and pass"),
        "missed_10": whole("cases that pass with a probability of overturning of 10 % or more"),
        "passed": whole("cases that pass"),
        "passed_lifted": whole("cases that pass and that the record lifts"),
        "false": whole("cases that stand and fail"),
        "missed_share": real("1", "missed over overturned"),
        "missed_low": real("1", f"lower limit of that {_SHARE}"),
        "missed_high": real("1", f"upper limit of that {_SHARE}"),
        "false_share": real("1", "false over standing"),
        "false_low": real("1", f"lower limit of that {_SHARE}"),
        "false_high": real("1", f"upper limit of that {_SHARE}"),
    },
)


def _with(declared: Declared) -> Declared:
    """A group with the coordinates of its variables."""
    axes = {dim for variable in declared.values() for dim in variable.dims}
    return {name: along((name,), AXES)[name] for name in AXES if name in axes} | dict(declared)


#: Every variable of a study file, by its group.
STUDY_GROUPS: dict[str, Declared] = {
    "/figure4": _with(FIGURE4),
    "/figure5": {**_with(FIGURE5), "interval": AXES["interval"]},
    "/intervals": _with(INTERVALS),
    "/code_check": CODE_CASES,
    "/rates": CODE_RATES,
    "/statements": _with(STATEMENTS),
}


def no_motion(ground_contact: Any, *peaks: Any) -> np.ndarray:
    """True where the closed form stands for no motion of a block: see the variable of that name.

    A block whose largest theta/alpha_c is beyond 1 does not come back: with "start" x(T) = 0 has roots for velocities
    of up to 1 + I_s/I on motions that do (docs/decisions/013).

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
    variables: Mapping[str, tuple[tuple[str, ...], Any]], coords: Mapping[str, Any], declared: Declared
) -> xr.Dataset:
    """Declared variables, each with its dimensions and values, and coordinates of :data:`AXES` or scalars of it."""
    import xarray as xr

    axes = {name: AXES[name].variable(values, (name,) if np.ndim(values) else ()) for name, values in coords.items()}
    return xr.Dataset({name: declared[name].variable(values, dims) for name, (dims, values) in variables.items()}, axes)
