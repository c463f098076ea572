"""The kinematic check of Circolare 617/2009 for arrays of blocks on the ground, with a spectrum of any kind."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rocking.block import Block
from rockpulse.config.check_settings import CheckSettings
from rockpulse.studies.check.codes import circolare_2009, worst
from rockpulse.studies.check.mechanism import senses_of


class KinematicCheck(NamedTuple):
    """The kinematic check of (m,) blocks.

    Attributes
    ----------
    activation : (m,) ndarray
        a_0*, spectral acceleration that opens the mechanism [m/s2].
    linear : (m,) ndarray
        a_0* over a_g S/q [-]; at least 1 passes.
    ultimate : (m,) ndarray
        d_u*, the displacement of the centre of mass that is allowed [m].
    secant_period : (m,) ndarray
        T_s [s].
    nonlinear : (m,) ndarray
        d_u* over S_De(T_s) [-]; at least 1 passes.
    """

    activation: np.ndarray
    linear: np.ndarray
    ultimate: np.ndarray
    secant_period: np.ndarray
    nonlinear: np.ndarray


def kinematic_check(
    block: Block,
    spectrum: Callable[[np.ndarray], np.ndarray],
    ground: float,
    behaviour: float = 2.0,
    confidence_factor: float = 1.0,
) -> KinematicCheck:
    """Check blocks on the ground by the linear and the nonlinear kinematic analysis.

    Parameters
    ----------
    block : Block
        (m,) blocks; of their two senses the worse counts, for each number. Ties need a yield force.
    spectrum : callable
        Elastic spectrum S_e of 5 % damping [m/s2] at (k,) periods [s].
    ground : float
        a_g S, the peak of the ground's acceleration on its soil [m/s2].
    behaviour : float
        q; 2 in the circular.
    confidence_factor : float
        FC, by how well the building is known: 1 or more.

    Returns
    -------
    KinematicCheck

    Raises
    ------
    ValueError
        For a tie without a yield force, or numbers out of range.

    Examples
    --------
    A free rectangle of 0.4 x 4 m: a_0* = g b/h, d_0* = b/2 at mid-height.

    >>> found = kinematic_check(Block(width=[0.4], height=[4.0]), lambda periods: 2.5 / periods, ground=2.0)
    >>> [round(float(values[0]), 4) for values in found]
    [0.9807, 0.9807, 0.08, 1.2384, 1.0201]
    """
    if not (math.isfinite(ground) and ground > 0.0 and behaviour >= 1.0 and confidence_factor >= 1.0):
        raise ValueError(
            "ground, behaviour, confidence_factor: expected a_g S above 0, q and FC of at least 1, got "
            f"{ground!r}, {behaviour!r}, {confidence_factor!r}"
        )
    settings = CheckSettings(q=behaviour, confidence_factor=confidence_factor)
    demand = _Given(spectrum, ground)
    lanes = block if block.shape else block.lanes(1)
    found = [
        worst([circolare_2009(sense, demand, (), settings) for sense in senses_of(lanes.lane(place))])
        for place in range(lanes.shape[0])
    ]
    return KinematicCheck(
        *(
            np.array([getattr(one, name) for one in found])
            for name in ("activation", "activation_ratio", "displacement", "period", "displacement_ratio")
        )
    )


@dataclass(frozen=True)
class _Given:
    """A spectrum of 5 % damping that was given."""

    elastic: Callable[[np.ndarray], np.ndarray]
    ground: float

    def __call__(self, period: float, damping: float = 0.05) -> float:
        return float(np.asarray(self.elastic(np.array([period])), dtype=float)[0])
