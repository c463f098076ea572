"""The variables of the probability of overturning in /summary, and of overturning spectra in /spectra."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from rocking.body.limits import RATES
from rocking.body.restraint import TieState
from rocking.response import Outcome
from rockpulse.config.configuration import Config
from rockpulse.storage.variables import Declared, StoredVariable, along, flag, real, with_ends

#: Name of the mean over directions of the probability of overturning, for a body whose direction is unknown.
MEAN = "overturning_probability_mean"
#: Words of the flag `probability_source`, in the order of its values.
SOURCES = ("none", "spectrum", "slender_limit", "full_equation", "shared_spectrum")

#: For each variable, the field of :class:`rocking.OverturningFactors` that contains its values.
READ = {
    "overturning_probability": "at_one",
    "factor_10": "factor_10",
    "factor_50": "factor_50",
    "factor_mean": "factor_mean",
}


def _fixed(values: np.ndarray) -> Callable[[Any, Config], np.ndarray]:
    return lambda bodies, config: values


def of_lanes(name: str) -> Callable[[Any], np.ndarray]:
    """Return a function that reads the variable `name` of an assessed record, for each body and restitution."""
    return lambda one: one.per_lane(one.probability[name])


def _comment(config: Config) -> str:
    known = config.uncertainty
    shares = known.of_draws().restitution
    return (
        f"nonlinear model; scale factor lognormal ({100.0 * known.factor:g} %), C between {min(shares):.3g} and "
        f"{max(shares):.3g} times nominal, at most 1, critical angle reduced by |N| times "
        f"{100.0 * known.geometry:g} % (N standard normal); scale factors up to {config.search.factor_max:g}"
    )


def _with_ends(name: str, long_name: str, explanation: str) -> dict[str, StoredVariable]:
    low, high = (f"{end} end of the 90 % interval of {name}" for end in ("lower", "upper"))
    declared = real(long_name, of_ground=True, explanation=explanation, comment=_comment)
    return with_ends(name, declared, low=low, high=high)


PROBABILITY: Declared = {
    **_with_ends(
        "overturning_probability",
        "probability that the body overturns under the unscaled record; NaN if not computed",
        "by the nonlinear model, under the uncertainty of `[uncertainty]`",
    ),
    **_with_ends(
        "factor_10",
        "scale factor on the record at which the probability of overturning is 10 %; NaN if not computed",
        "inf: not reached up to `[search] factor_max`, which is then the value of `factor_10_low`",
    ),
    **_with_ends(
        "factor_50",
        "scale factor on the record at which the probability of overturning is 50 %; NaN if not computed",
        "",
    ),
    **_with_ends(
        "factor_mean",
        "geometric mean of the scale factor at which the body overturns; NaN where not computed",
        "computed from the area above the curve of P over ln f",
    ),
    "uplift_probability": real(
        "probability that the body lifts off under the unscaled record; NaN if not computed",
        of_ground=True,
        explanation="in closed form, from `uplift_ratio`: without the vertical acceleration",
        comment=_comment,
    ),
    "probability_source": flag(
        SOURCES,
        "source of the probability of overturning",
        explanation="slender_limit: random realisations of the body in the limit of slender blocks; full_equation: "
        "random realisations by the nonlinear equation (slenderness below 3.5, ties, loads or "
        "vertical acceleration); spectrum: the overturning "
        'spectrum of the record, with `[uncertainty] spectrum = "all"`; shared_spectrum: an overturning spectrum at '
        "frequency parameters 6 % apart, for 64 slender bodies or more",
    ),
}

#: Variables of a record and a body at each demand of the site (dimension `demand`).
AT_DEMAND: Declared = {
    "demand_factor": real(
        "scale factor that scales the record to the demand",
        explanation="the demand divided by the intensity of the record; for two horizontal channels of a station, by "
        "the geometric mean of their intensities",
    ),
    "demand_probability": real(
        "probability that the body overturns under the record scaled to the demand; NaN where not computed",
        explanation="not computed where `demand_factor` lies outside 0.25 to 4 or above `[search] factor_max`",
        comment=_comment,
    ),
    "demand_rotation_ratio": real(
        "largest rotation over alpha_c under the record scaled to the demand; inf where the body overturns",
        explanation="of the nominal body by the nonlinear model; NaN: unresolved or not computed, as above",
    ),
    "demand_outcome": flag(
        ("not_computed", *Outcome),
        "how the motion of the nominal body ends under the record scaled to the demand",
        first=-1,
    ),
    "demand_sliding_share": real("sliding_share under the record scaled to the demand", explanation="NaN as above"),
}


#: Variables of each tie of a body at each demand of the site (dimensions `demand` and `tie`).
OF_TIES: Declared = {
    "demand_tie_elongation": real(
        "largest elongation of each tie under the record scaled to the demand; inf where the body overturns",
        "m",
        explanation="of the nominal body by the nonlinear model, beyond the gap, in the order of the ties in "
        "`restraints`; after a break the distance of its ends; NaN: fewer ties, or not computed as above",
    ),
    "demand_tie_force": real(
        "largest force of each tie under the record scaled to the demand", "N", explanation="NaN as above"
    ),
    "demand_tie_share": real("largest elongation of each tie divided by its ultimate elongation; NaN without one"),
    "demand_tie_state": flag(
        ("not_computed", *TieState), "state of each tie under the record scaled to the demand", first=-1
    ),
}


#: Nominal restitutions of a stored spectrum [-].
RESTITUTIONS = np.linspace(0.75, 1.0, 6)
#: Scale factors at which the probability is stored, divided by the mean capacity [-], from 0.2 to 5.
LEVELS = np.exp(np.linspace(-1.6, 1.6, 65))
#: Limit states of rotation with separate spectra, as theta/alpha_c [-].
ROTATIONS = np.array([0.1, 0.4, 0.6, 1.0])

#: Variables of the axes of a spectrum, which are the same for all records, so that all spectra form one array.
SPECTRUM_AXES: Declared = {
    "p": real("frequency parameter of the blocks", "s^-1", _fixed(RATES), dims=("p",)),
    "restitution": real(
        "nominal restitution C of the blocks",
        take=_fixed(RESTITUTIONS),
        dims=("restitution",),
        explanation="the random values of C are this value times the range of `[uncertainty] restitution`",
    ),
    "level": real(
        "scale factor on the record divided by the mean capacity of the block", take=_fixed(LEVELS), dims=("level",)
    ),
    "rotation": real("limit state of rotation, theta/alpha_c", take=_fixed(ROTATIONS), dims=("rotation",)),
}

SPECTRUM: Declared = {
    **along(
        ("p", "restitution"),
        spectrum=real(
            "overturning spectrum S = (g tan(alpha_c)/p)/factor_mean",
            "m s^-1",
            explanation="effective impulse of the record for a slender block with these p and C; the mean capacity of "
            "the block is (g tan(alpha_c)/p)/S",
        ),
        spectrum_low=real("lower end of the 90 % interval of the spectrum", "m s^-1"),
        spectrum_high=real("upper end of the 90 % interval of the spectrum", "m s^-1"),
    ),
    "rotation_spectrum": real(
        "spectrum for reaching a rotation: (g tan(alpha_c)/p) divided by the mean scale factor that reaches it",
        "m s^-1",
        dims=("rotation", "p", "restitution"),
    ),
    "probability": real(
        "probability that a block overturns under the record scaled by `level` times the mean capacity of the block",
        dims=("p", "restitution", "level"),
    ),
}

#: Number of values along each axis of a spectrum.
AXIS_SIZES = {"p": RATES.size, "restitution": RESTITUTIONS.size, "level": LEVELS.size, "rotation": ROTATIONS.size}


def _has(config: Config) -> bool:
    return config.has_probability and config.uncertainty.spectrum == "all"


def _of_record(name: str, variable: StoredVariable) -> StoredVariable:
    take: Callable[[Any], np.ndarray] = lambda one: one.spectra[name]  # noqa: E731
    return replace(variable, dims=("record", *variable.dims), take=take, stored=_has, of_ground=True)


#: Variables of /spectra in an assessment, except record names; stored only with `[uncertainty] spectrum = "all"`.
SPECTRA: Declared = {
    **{name: replace(axis, stored=_has) for name, axis in SPECTRUM_AXES.items()},
    **{name: _of_record(name, variable) for name, variable in SPECTRUM.items()},
}
