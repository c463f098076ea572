"""The variables of the checks of codes."""

from __future__ import annotations

from rockpulse.storage.variables import Declared, along, real, text

__all__ = ["CHECK"]

#: Over the bodies, and over the bodies and codes; a ratio of 1 or more passes.
CHECK: Declared = {
    **along(
        ("block",),
        {
            "multiplier": real("1", "alpha_0, multiplier of the horizontal forces that opens the mechanism"),
            "share": real("1", "e*, share of the mass that takes part"),
            "probability": real("1", "probability of overturning that the verdict of the results rests on"),
            "factor_50": real("1", "median over the records of the factor at which that probability is 50 %"),
            "beside": text("why the probability is not known, in words"),
        },
    ),
    **along(
        ("block", "code"),
        {
            "activation": real("m s-2", "acceleration that opens the mechanism"),
            "activation_demand": real("m s-2", "acceleration that the code asks it to bear"),
            "activation_ratio": real("1", "acceleration that opens the mechanism over what is asked"),
            "displacement": real("m", "spectral displacement that the code allows"),
            "period": real("s", "period at which the displacement is asked for"),
            "displacement_demand": real("m", "spectral displacement that the code asks for"),
            "displacement_ratio": real("1", "displacement that is allowed over what is asked"),
            "statement": text("why something is not known, in words"),
            "activation_sense": text("sense that the acceleration is of, empty where both are alike"),
            "displacement_sense": text("sense that the displacement is of, empty where both are alike"),
        },
    ),
}
