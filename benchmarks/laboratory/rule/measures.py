"""Intensity measures for comparison with the rule, as demands on a body.

A demand is, except for a coefficient, 1 divided by the scale factor at which the body overturns according to the
measure.

.. note:: With u_c = g tan(alpha)/p the measures are PGV/u_c; Housner's intensity SI (pseudo-velocities with 5 % damping
   from 0.1 to 2.5 s) divided by u_c; the largest change of velocity within 2/p divided by u_c; the largest half-wave
   divided by u_c; PGA/(g tan alpha), which is West's condition (Milne 1885); Ishiyama's measure (1982,
   doi:10.1002/eqe.4290100502), PGV divided by 0.4 sqrt(8 g R (1 - cos alpha)/(3 cos^2 alpha)) with R of the rectangle
   with the p of the body; and 1 divided by the safety factor of one nonlinear analysis.
"""

import numpy as np

from rocking.body.block import Block
from rocking.body.limits import radius_of_rectangle
from rocking.search.capacity import critical_scale
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import largest_change, pgv, spectrum_intensity
from rockpulse.record.record import Record

__all__ = ["MEASURES", "ishiyama_velocity", "other_measures"]

#: Measures, and what they are called.
MEASURES = {
    "march": "rule, mean capacity",
    "march_10": "rule, factor of 10 %",
    "single_ratio": "one nonlinear SF",
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
    single = critical_scale(bodies, record.acceleration, record.dt, factor_max=10.0).safety_factor
    return {
        "single_ratio": np.where(np.isfinite(single), 1.0 / single, 0.0),
        "change_ratio": np.array([largest_change(record, 2.0 / p) for p in np.ravel(bodies.p)]) / speed,
        "intensity_ratio": spectrum_intensity(record) / speed,
        "velocity_ratio": pgv(record) / speed,
        "impulse_ratio": np.max(np.abs(waves.impulse)) / speed,
        "uplift_ratio": record.pga / capacity,
        "ishiyama_ratio": pgv(record) / (ISHIYAMA * ishiyama_velocity(bodies)),
    }
