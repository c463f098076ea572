"""The variables of an overturning spectrum, in memory and in /spectra of a results file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from rocking.body.limits import RATES
from rockpulse.config.configuration import Config
from rockpulse.storage.variables import Declared, StoredVariable, along, real

__all__ = ["AXIS_SIZES", "LEVELS", "RESTITUTIONS", "ROTATIONS", "SPECTRA", "SPECTRUM", "SPECTRUM_AXES"]

#: Nominal restitutions of a stored spectrum [-].
RESTITUTIONS = np.linspace(0.75, 1.0, 6)

#: Factors over the mean capacity at which the probability is stored [-], from 0.2 to 5.
LEVELS = np.exp(np.linspace(-1.6, 1.6, 65))

#: Limit states of rotation that have spectra of their own, as theta/alpha_c [-].
ROTATIONS = np.array([0.1, 0.4, 0.6, 1.0])

#: Along its axes. They are the same for every record of a file, so that the spectra of all records are one array.
SPECTRUM_AXES: Declared = {
    "p": real("s-1", "frequency parameter of the blocks", lambda bodies, config: RATES, dims=("p",)),
    "restitution": real(
        "1",
        "nominal restitution C of the blocks",
        lambda bodies, config: RESTITUTIONS,
        dims=("restitution",),
        explanation="that of a draw lies between the shares of it that `[uncertainty] restitution` tells",
    ),
    "level": real(
        "1", "factor on the record over the mean capacity of the block", lambda bodies, config: LEVELS, dims=("level",)
    ),
    "rotation": real(
        "1", "limit state of rotation, theta/alpha_c", lambda bodies, config: ROTATIONS, dims=("rotation",)
    ),
}

SPECTRUM: Declared = {
    **along(
        ("p", "restitution"),
        {
            "spectrum": real(
                "m s-1",
                "overturning spectrum S = (g tan(alpha_c)/p)/capacity_mean",
                explanation="the effective impulse that a slender block of this p and C takes from the record; its "
                "mean capacity is (g tan(alpha_c)/p)/S",
            ),
            "spectrum_low": real("m s-1", "lower end of the interval of 90 % of the spectrum"),
            "spectrum_high": real("m s-1", "upper end of the interval of 90 % of the spectrum"),
        },
    ),
    "rotation_spectrum": real(
        "m s-1",
        "the same for reaching a rotation: (g tan(alpha_c)/p) over the mean factor at which it is reached",
        dims=("rotation", "p", "restitution"),
    ),
    "probability": real(
        "1",
        "probability of overturning of a block under the record times level times its mean capacity",
        dims=("p", "restitution", "level"),
    ),
}

#: Lengths of these axes.
AXIS_SIZES = {"p": RATES.size, "restitution": RESTITUTIONS.size, "level": LEVELS.size, "rotation": ROTATIONS.size}


def _has(config: Config) -> bool:
    return config.has_probability


def _of_record(name: str, variable: StoredVariable) -> StoredVariable:
    take: Callable[[Any], np.ndarray] = lambda one: one.spectra[name]  # noqa: E731
    return replace(variable, dims=("record", *variable.dims), take=take, since=3, stored=_has, of_ground=True)


#: The group /spectra of an assessment, without the names of records; NaN at the p that no body of a record is read at.
SPECTRA: Declared = {
    **{name: replace(axis, since=3, stored=_has) for name, axis in SPECTRUM_AXES.items()},
    **{name: _of_record(name, variable) for name, variable in SPECTRUM.items()},
}
