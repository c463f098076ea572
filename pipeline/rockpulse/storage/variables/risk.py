"""The variables of the annual frequency of a limit state, and of code checks."""

from enum import IntEnum

from rockpulse.storage.variables import NOT_KNOWN, Declared, along, flag, real, text, whole

#: Status of a frequency. NO_LIMIT: the integral diverges at low levels. NOT_COVERED: the spectra do not cover the body.
RiskStatus = IntEnum("RiskStatus", "GIVEN NO_CURVE NO_LIMIT NOT_COVERED", start=0)


OWN = "unit of the measure in SI"

#: Variables of each body, and of the ranges of levels that contribute to its frequency.
RISK: Declared = {
    **along(
        ("block",),
        frequency=real("annual frequency of the limit state", "year^-1"),
        frequency_low=real("lower limit of the frequency, by the records of the fragility", "year^-1"),
        frequency_high=real("upper limit of the frequency", "year^-1"),
        probability=real("probability of the limit state in the given number of years"),
        probability_low=real("lower limit of that probability"),
        probability_high=real("upper limit of that probability"),
        survival=real("probability that the body survives the given number of years"),
        median=real("level at which the probability of the limit state is 50 %, of the fragility", OWN),
        beta=real("standard deviation of the logarithm of that level"),
        below=real("share of the frequency from levels below all that were analysed"),
        above=real("share of the frequency from levels above all that were analysed"),
        events=whole("earthquakes of the fragility"),
        status=flag(RiskStatus, "whether a frequency was computed, or why not"),
        statement=text("why there is no frequency or no band, and what limits the band"),
        warning=text("share of the frequency from levels that were not analysed, in words; empty up to a tenth"),
    ),
    **along(
        ("block", "bin"),
        bin_low=real("lower end of a range of levels", OWN),
        bin_high=real("upper end of a range of levels", OWN),
        share=real("share of the frequency from the range"),
    ),
}

#: Variables of each body of an inventory.
INVENTORY: Declared = along(
    ("body",),
    frequency=real("annual frequency of overturning", "year^-1"),
    frequency_low=real("lower limit of the frequency, over earthquakes", "year^-1"),
    frequency_high=real("upper limit of the frequency", "year^-1"),
    probability=real("probability of overturning in the given number of years"),
    survival=real("probability that the body survives the given number of years"),
    median=real("level at which the body overturns with probability 1/2", OWN),
    dispersion=real("standard deviation of ln(S/measure), S the overturning spectrum"),
    below=real("share of the frequency from levels below those of the hazard curve"),
    above=real("share of the frequency from levels above those of the hazard curve"),
    far=real("share of the frequency from records at factors beyond those of [fragility] factors"),
    hazard_distance=real("distance of the body's site from the place of its hazard curve", "m"),
    status=flag(RiskStatus, "whether a frequency was computed, or why not"),
)

#: Variables of each free body, and of each level of the intensity measure.
FREE_FRAGILITY: Declared = {
    **along(
        ("body", "level"),
        probability=real("probability of overturning, mean over the records"),
        lognormal=real("probability of overturning with S lognormal over earthquakes and records"),
    ),
    **along(
        ("body",),
        median=real("level at which the mean of ln S is that of the body, ln(g tan(alpha)/p)", OWN),
        dispersion=INVENTORY["dispersion"],
    ),
}

#: Variables of each body in a test of the hazard by the age of standing bodies.
STANDING: Declared = {
    "chance": real("probability that the body survives for its age, exp(-frequency age)"),
    "chance_low": real("the same at the upper limit of the frequency"),
    "chance_high": real("the same at the lower limit of the frequency"),
    "largest": real("largest annual frequency that is compatible with the age, at the given confidence", "year^-1"),
    "factor": real("multiplier of the rates of the hazard at which the frequency would equal `largest`"),
    "contradicted": flag(("not_known", "no", "yes"), "whether the frequency is above `largest`", first=NOT_KNOWN),
}


#: Variables of code checks for each body, and for each body and code; a check with a ratio of 1 or more is passed.
CHECK: Declared = {
    **along(
        ("block",),
        multiplier=real("alpha_0, multiplier of the horizontal forces that opens the mechanism"),
        share=real("e*, share of the mass that takes part"),
        initial_period=real("T_0 of an element that is free to vibrate; 0 if the body is rigid until it opens", "s"),
        probability=real("probability of overturning in the verdict of the results"),
        factor_50=real("median over the records of the factor at which that probability is 50 %"),
        beside=text("reason why the probability is not known"),
    ),
    **along(
        ("block", "code"),
        activation=real("acceleration that opens the mechanism", "m s^-2"),
        activation_demand=real("acceleration demand of the code", "m s^-2"),
        activation_ratio=real("acceleration that opens the mechanism, divided by the demand"),
        displacement=real("spectral displacement that the code allows", "m"),
        period=real("period at which the displacement demand is taken", "s"),
        displacement_demand=real("spectral displacement demand of the code", "m"),
        displacement_ratio=real("allowed displacement divided by the demand"),
        records=whole("records whose rotations are checked; 0 for a check by a spectrum"),
        statement=text("reason why a value is not known"),
        activation_sense=text("sense of rocking of the acceleration; empty if both senses are equal"),
        displacement_sense=text("sense of rocking of the displacement; empty if both senses are equal"),
    ),
}
