"""The variables of an overturning spectrum, in memory and in /spectra of a results file."""

from __future__ import annotations

import numpy as np

from rocking.spectrum_lanes import RATES
from rockpulse.storage.variables import Declared, along, real

__all__ = ["LEVELS", "RESTITUTIONS", "ROTATIONS", "SPECTRUM", "SPECTRUM_AXES"]

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
