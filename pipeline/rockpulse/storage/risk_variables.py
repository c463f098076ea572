"""The variables of the annual frequency of a limit state."""

from __future__ import annotations

from rockpulse.storage.variables import Declared, along, real, text, whole

__all__ = ["INVENTORY", "RISK"]

OWN = "unit of the measure in SI"

#: Over the bodies, and the levels that contribute to each.
RISK: Declared = {
    **along(
        ("block",),
        {
            "frequency": real("year-1", "annual frequency of the limit state"),
            "frequency_low": real("year-1", "lower limit of the frequency, by the records of the fragility"),
            "frequency_high": real("year-1", "upper limit of the frequency"),
            "probability": real("1", "probability of the limit state in the years that were asked for"),
            "probability_low": real("1", "lower limit of that probability"),
            "probability_high": real("1", "upper limit of that probability"),
            "survival": real("1", "probability that the body stands for so many years"),
            "below": real("1", "share of the frequency from levels below all that were looked at"),
            "above": real("1", "share of the frequency from levels above all that were looked at"),
            "events": whole("earthquakes of the fragility"),
            "statement": text("what is to be known of the frequency, in words"),
        },
    ),
    **along(
        ("block", "bin"),
        {
            "bin_low": real(OWN, "lower end of a range of levels"),
            "bin_high": real(OWN, "upper end of a range of levels"),
            "share": real("1", "share of the frequency from the range"),
        },
    ),
}

#: Over the bodies of an inventory.
INVENTORY: Declared = along(
    ("body",),
    {
        "frequency": real("year-1", "annual frequency of overturning"),
        "frequency_low": real("year-1", "lower limit of the frequency, over earthquakes"),
        "frequency_high": real("year-1", "upper limit of the frequency"),
        "probability": real("1", "probability of overturning in the years that were asked for"),
        "median": real(OWN, "level at which the body overturns with probability 1/2"),
        "dispersion": real("1", "standard deviation of ln(S/measure), S the overturning spectrum"),
    },
)
