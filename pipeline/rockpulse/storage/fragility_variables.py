"""The variables of a fragility file: type, unit and meaning of each (docs/schema.md)."""

from __future__ import annotations

import numpy as np

from rockpulse.storage.variables import BLOCK, CASE, Meaning
from rockpulse.storage.variables import RECORD as OF_RECORD

__all__ = [
    "BODY",
    "CAPACITY",
    "CURVE",
    "EFFICIENCY",
    "FRAGILITY",
    "GRID",
    "LEVEL",
    "MEASURE",
    "POOLED",
    "QUALITY",
    "RECORD",
    "SEARCH_STEP",
    "STRENGTH",
    "STRIPES",
    "VALUE",
]

#: Root attribute `kind` of a fragility file, and its first group.
FRAGILITY = "fragility"

#: Unit of what is in that of the measure.
OWN = "see measure_units"

#: The quality that every measure has of its own: how far a record had to be scaled to a level of the measure.
STRENGTH = "strength"

MEASURE: dict[str, Meaning] = {
    "measure_units": (str, "1", "unit of each measure"),
    "measure_long_name": (str, "1", "meaning of each measure"),
}

CURVE: dict[str, Meaning] = {
    "median": (float, OWN, "measure at which the limit state is reached with probability 1/2"),
    "median_low": (float, OWN, "lower confidence limit of the median"),
    "median_high": (float, OWN, "upper confidence limit of the median"),
    "beta": (float, "1", "dispersion: standard deviation of ln capacity"),
    "beta_low": (float, "1", "lower confidence limit of the dispersion"),
    "beta_high": (float, "1", "upper confidence limit of the dispersion"),
    "status": (np.int8, "1", "whether there is a curve, and why not"),
    "band": (np.int8, "1", "whether there are confidence limits, and why not"),
    "extrapolated": (np.int8, "1", "whether the median lies beyond every level looked at"),
    "statement": (str, "1", "status, band and extrapolation in words where there is something to say"),
    "records": (int, "1", "number of records"),
    "events": (int, "1", "number of earthquakes, over which the confidence limits are taken"),
    "observations": (int, "1", "number of capacities, or of scaled motions"),
    "reached": (int, "1", "observations that reached the limit state; the others are censored"),
}

GRID: dict[str, Meaning] = {
    "probability": (float, "1", "probability of reaching the limit state"),
    "probability_low": (float, "1", "lower confidence limit of the probability"),
    "probability_high": (float, "1", "upper confidence limit of the probability"),
}

LEVEL: Meaning = (float, OWN, "values of the measure that the curves are given at")

BODY: dict[str, Meaning] = {"alpha_c": BLOCK["alpha_c"], "p": BLOCK["p"], "restitution": CASE["restitution"]}

RECORD: dict[str, Meaning] = {
    "event": (str, "1", "earthquake that the record is counted to"),
    "source": OF_RECORD["source"],
    "duration": (float, "s", "length of the intense phase"),
    "period": (float, "s", "2 pi PGV/PGA"),
    "strong_half_waves": (float, "1", "half-waves of the intense phase above half the largest"),
}

VALUE: Meaning = (float, OWN, "measure of the record at factor 1")

SEARCH_STEP: Meaning = (
    float,
    "1",
    "ratio of neighbouring factors of the search for rotations and overturning; 1: nothing to miss",
)

CAPACITY: dict[str, Meaning] = {
    "factor": (float, "1", "first factor on the record that reaches the limit state; inf where none does"),
    "reached": (np.int8, "1", "whether the limit state was reached up to the end of the search"),
}

STRIPES: dict[str, Meaning] = {
    "factor": (float, "1", "factor on the record"),
    "reached": (np.int8, "1", "whether the limit state was reached; -1 where the model cannot say"),
}

EFFICIENCY: dict[str, Meaning] = {
    "beta_ratio": (float, "1", "dispersion over that in p PGV/(g tan alpha_c)"),
    "beta_ratio_low": (float, "1", "lower confidence limit of the ratio of dispersions"),
    "beta_ratio_high": (float, "1", "upper confidence limit of the ratio of dispersions"),
}

POOLED: dict[str, Meaning] = {
    **{name: CURVE[name] for name in ("median", "median_low", "median_high", "beta", "beta_low", "beta_high")},
    **{name: CURVE[name] for name in ("extrapolated", "statement")},
}

QUALITY: dict[str, Meaning] = {
    "slope": (float, "1", "d ln median over d ln of a quality of the record"),
    "p_value": (float, "1", "p-value of a slope of zero, by the jackknife over events; not corrected for many tests"),
}
