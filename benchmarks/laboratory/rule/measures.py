"""Intensity measures for comparison with the rule, as demands on a body.

A demand is, except for a coefficient, 1 divided by the scale factor at which the body overturns according to the
measure.

.. note:: With u_c = g tan(alpha)/p the measures are PGV/u_c; Housner's intensity SI (pseudo-velocities with 5 % damping
   from 0.1 to 2.5 s) divided by u_c; the largest change of velocity within 2/p divided by u_c; the largest half-wave
   divided by u_c; PGA/(g tan alpha), which is West's condition (Milne 1885); Ishiyama's measure (1982,
   doi:10.1002/eqe.4290100502), PGV divided by 0.4 sqrt(8 g R (1 - cos alpha)/(3 cos^2 alpha)) with R of the rectangle
   with the p of the body. Three kinds come from the nonlinear equation. 1 divided by the safety factor of the nominal
   body, the lowest of 256 factors up to 10 that overturn it. 1 divided by the scale factor 10 exp(-length of ln f in
   which the nominal body overturns) of the same 256 marches, their safe length. The same of n marches with random C,
   alpha and scale factor. Last, 1 divided by the mean of `overturning_probability` in the limit of slender blocks.
"""

import numpy as np

from laboratory.rule.truth import FACTOR_MAX, exact_marches
from rocking.body.block import Block
from rocking.body.limits import radius_of_rectangle
from rocking.search.capacity import critical_scale
from rocking.spectrum.body_probability import overturning_probability
from rocking.spectrum.probability import Uncertainty
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import largest_change, pgv, spectrum_intensity
from rockpulse.record.record import Record

#: Numbers of exact marches of a body with which the rule is compared, and the seed of their random numbers.
COUNTS, SEED = (16, 32, 64, 128, 256), 38
#: Measures, and what they are called.
MEASURES = {
    "march": "rule, mean capacity",
    "march_10": "rule, factor of 10 %",
    "single_ratio": "nominal body, SF",
    "length_ratio": "nominal body, safe length",
    **{f"marches_{count}": f"{count} exact marches" for count in COUNTS},
    "spectrum": "slender limit, mean",
    "spectrum_10": "slender limit, 10 %",
    "change_ratio": "change of velocity",
    "intensity_ratio": "Housner's SI",
    "velocity_ratio": "p PGV/(g tan a)",
    "impulse_ratio": "largest half-wave",
    "uplift_ratio": "PGA, West",
    "ishiyama_ratio": "Ishiyama 0.4",
}
#: Share of the velocity that overturns a body from rest, at which Ishiyama's body overturns.
ISHIYAMA = 0.4


def ishiyama_velocity(bodies: Block) -> np.ndarray:
    """sqrt(8 g R (1 - cos alpha)/(3 cos^2 alpha)) of bodies (m,) [m/s]: the nonlinear critical impulse of a rectangle.

    Examples
    --------
    >>> body = Block(half_width=[0.2], half_height=[0.8])
    >>> p, alpha = body.p[0], body.alpha_c[0]
    >>> critical = 2.0 * body.gravity * np.sin(0.5 * alpha) / (p * np.cos(alpha))
    >>> bool(abs(ishiyama_velocity(body)[0] / critical - 1.0) < 1e-12)
    True
    """
    radius, alpha = radius_of_rectangle(bodies.p, bodies.gravity), bodies.alpha_c
    return np.asarray(np.sqrt(8.0 * bodies.gravity * radius * (1.0 - np.cos(alpha)) / (3.0 * np.cos(alpha) ** 2)))


def other_measures(bodies: Block, record: Record, waves: HalfWaves) -> dict[str, np.ndarray]:
    """The measures of :data:`MEASURES` but the rule's, (m,) [-]."""
    capacity = bodies.gravity * np.tan(bodies.alpha_c)
    speed = capacity / bodies.p
    ground, dt, uncertainty = record.acceleration, record.dt, Uncertainty()
    search = critical_scale(bodies, ground, dt, factor_max=FACTOR_MAX)
    overturning = np.bincount(search.lane, np.log(search.upper / search.lower), minlength=speed.size)
    limit = overturning_probability(bodies, ground, dt, uncertainty, factor_max=FACTOR_MAX)
    return {
        "single_ratio": np.where(np.isfinite(search.safety_factor), 1.0 / search.safety_factor, 0.0),
        "length_ratio": np.exp(overturning) / FACTOR_MAX,
        **{
            f"marches_{count}": np.array(
                [
                    1.0 / exact_marches(bodies.lane(one), ground, dt, uncertainty, count, SEED + one).safe_length
                    for one in range(speed.size)
                ]
            )
            for count in COUNTS
        },
        "spectrum": 1.0 / limit.factor_mean,
        "spectrum_10": 1.0 / limit.factor_10,
        "change_ratio": np.array([largest_change(record, 2.0 / p) for p in np.ravel(bodies.p)]) / speed,
        "intensity_ratio": spectrum_intensity(record) / speed,
        "velocity_ratio": pgv(record) / speed,
        "impulse_ratio": np.max(np.abs(waves.impulse)) / speed,
        "uplift_ratio": record.pga / capacity,
        "ishiyama_ratio": pgv(record) / (ISHIYAMA * ishiyama_velocity(bodies)),
    }
