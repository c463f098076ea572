"""Code checks from the geometry of a body and an elastic spectrum, on the ground and on floors.

.. note:: alpha_0, e* and d_0 are defined in :mod:`rockpulse.studies.check.mechanism`; q is the behaviour factor, FC the
   confidence factor, and T_k, xi_k and gamma_k psi_k are period, damping and participation of a mode of the building.
   Circolare 617/2009, C8A.4: a_0* = alpha_0 g/(e* FC) (C8A.4.4); linear check: a_0* >= a_g S/q, and on floors S_e(T_1)
   psi gamma/q; nonlinear check on the ground: d_u* = 0.4 d_0* >= S_De(T_s), T_s = 2 pi sqrt(d_s*/a_s*) at d_s* = 0.4
   d_u*. Circolare 7/2019: linear check: the same, with a_Z(z) on floors (C8.7.1.8, C7.2.8); displacement check: d_SLV =
   0.4 d_0 or d_SLC = 0.6 d_0 >= S_De(T), T = 1.68 pi or 1.56 pi sqrt(d/a(d)) (C8.7.1.10, .11), with a damping of 8 or
   10 %, on floors with the floor spectrum C7.2.5-C7.2.7 as in C8.7.1.12. d_SLV is at most the displacement at which
   ties with more than half of the capacity have broken; both are at most that at which a beam loses its support
   (C8.7.1.2.1.6). For an element that is free to vibrate before it opens, S_eZ(T_0) (C8.7.1.9) replaces a_Z. Elements
   of framed buildings: F_a = S_a W_a/q_a, S_a of C7.2.11. EN 1998-1, 4.3.5.2: F_a = S_a W_a gamma_a/q_a (4.24), S_a =
   alpha S [3 (1 + z/H)/(1 + (1 - T_a/T_1)^2) - 0.5], at least alpha S (4.25). T_a = T_0, or 0 for a rigid block.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.config.study_settings import CheckSettings
from rockpulse.studies.check.code_spectra import DemandSpectrum, TableEnds, damping_factor, displacement_of
from rockpulse.studies.check.mechanism import SENSES, Mechanism

#: Circolare 617/2009: d_u*/d_0* and d_s*/d_u* [-].
ULTIMATE, SECANT = 0.4, 0.4
#: Circolare 7/2019, for each limit state: allowed d/d_0 [-], the factor of pi in T, and the damping ratio [-].
STATES = {"slv": (0.4, 1.68, 0.08), "slc": (0.6, 1.56, 0.1)}
#: a and b of Circolare 7/2019, C7.2.6: the plateau of the floor spectrum is between periods of a T_k and b T_k.
PLATEAU = (0.8, 1.1)
#: a, b and a_p of Circolare 7/2019, Table C7.2.II, for T_1 below 0.5 s, up to 1 s, and above.
FRAMES = ((0.8, 1.4, 5.0), (0.3, 1.2, 4.0), (0.3, 1.0, 2.5))


class Checked(NamedTuple):
    """The result of checking one body according to one code; values that are unnecessary or unknown are NaN."""

    activation: float = math.nan  #: acceleration that activates the mechanism, divided by FC if the code says so [m/s2]
    activation_demand: float = math.nan  #: acceleration demand, divided by the behaviour factor [m/s2]
    displacement: float = math.nan  #: allowed spectral displacement [m]
    period: float = math.nan  #: period at which the displacement demand is read [s]
    displacement_demand: float = math.nan  #: spectral displacement demand [m]
    displacement_ratio: float = math.nan  #: allowed displacement over demand [-]; passes if at least 1
    statement: str = ""  #: reason for missing values
    records: int = 0  #: number of records of a check of rotations
    activation_sense: str = ""  #: direction of this activation, one of SENSES; empty if both are equal
    displacement_sense: str = ""  #: direction of this displacement ratio

    @property
    def activation_ratio(self) -> float:
        """Acceleration that sets the mechanism in motion, divided by the demand [-]; a ratio of 1 or more passes."""
        return self.activation / self.activation_demand


def circolare_2009(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Run the linear and the nonlinear kinematic analysis of Circolare 617/2009, C8A.4."""
    activation = _activation(body, settings)
    asked = spectrum.ground
    if floors:
        first = max(floors, key=lambda one: one.period)
        asked = max(asked, spectrum(first.period) * abs(first.participation))
        return Checked(
            activation,
            asked / settings.q,
            statement="the displacement check of Circolare 617/2009 for bodies on a floor is left out: its formula "
            "could not be established",
        )
    allowed = ULTIMATE * body.collapse_displacement
    slowest = SECANT * allowed
    pull = body.capacity(slowest) * body.gravity / (body.share * settings.confidence_factor)
    period = 2.0 * math.pi * math.sqrt(slowest / pull)
    try:
        demand = displacement_of(period, spectrum(period))
    except TableEnds as error:
        return Checked(activation, asked / settings.q, allowed, period, statement=str(error))
    return Checked(activation, asked / settings.q, allowed, period, demand, allowed / demand)


def circolare_2019(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Run the linear kinematic analysis with q and the displacement check of Circolare 7/2019, C8.7.1.2.1."""
    activation, asked = _activation(body, settings), spectrum(body.initial_period)
    if floors:
        asked = max(asked, floor_spectrum(spectrum, floors, body.initial_period, 0.05))
    _, factor, damping = STATES[settings.limit_state]
    allowed = allowed_displacement(body, settings.limit_state)
    pull = body.capacity(allowed) * body.gravity / (body.share * settings.confidence_factor)
    if pull <= 0.0:  # a tie breaks before the displacement that the weights alone allow
        why = "no resistance is left at the allowed displacement"
        return Checked(activation, asked / settings.q, allowed, statement=why)
    period = factor * math.pi * math.sqrt(allowed / pull)
    linear = settings.limit_state == "slv"
    found = Checked(activation, asked / settings.q if linear else math.nan, allowed, period)
    try:
        demand = _displacement(spectrum, floors, period, damping)
    except TableEnds as error:
        return found._replace(statement=str(error))
    return found._replace(
        displacement_demand=demand,
        # A mechanism that is not activated passes (C8.7.1.2.1.8).
        displacement_ratio=max(allowed / demand, activation / asked),
        statement="" if linear else "the linear analysis with q is for SLV only",
    )


def allowed_displacement(body: Mechanism, limit_state: str) -> float:
    """Return the allowed displacement d_SLV or d_SLC [m] of Circolare 7/2019, C8.7.1.2.1.6."""
    limits = [STATES[limit_state][0] * body.collapse_displacement, body.unsupported * body.lever]
    return min(limits + [body.rupture_displacement] * (limit_state == "slv"))


def en_1998(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Check a non-structural element (EN 1998-1, 4.3.5.2): the seismic force against the force that starts rocking."""
    opens, height = body.multiplier * body.gravity, _relative_height(floors)
    if floors and height is None:
        return Checked(opens, statement="level (height of the floor/height of the building) is not given")
    apart = 1.0 - body.initial_period / max(one.period for one in floors) if floors else 1.0
    seismic = spectrum.ground * max(1.0, 3.0 * (1.0 + (height or 0.0)) / (1.0 + apart**2) - 0.5)
    return Checked(opens, seismic * settings.gamma_a / settings.q_a)


def circolare_2019_frame(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Check a non-structural element of a framed building as in :func:`en_1998` (Circolare 7/2019, formula C7.2.11)."""
    opens, height = body.multiplier * body.gravity, _relative_height(floors)
    if height is None:
        why = "formula C7.2.11 is for a framed building: give [[block.floor]] with its level"
        return Checked(opens, statement=why)
    first = max(one.period for one in floors)
    start, end, most = FRAMES[int(first >= 0.5) + int(first > 1.0)]
    apart = max(0.0, 1.0 - body.initial_period / (start * first), body.initial_period / (end * first) - 1.0)
    seismic = spectrum.ground * max(1.0, (1.0 + height) * most / (1.0 + (most - 1.0) * apart**2))
    return Checked(opens, seismic / settings.q_a)


def _relative_height(floors: Sequence[FloorSettings]) -> float | None:
    return max((one.level for one in floors if one.level is not None), default=None)


def _activation(body: Mechanism, settings: CheckSettings) -> float:
    return body.multiplier * body.gravity / (body.share * settings.confidence_factor)


def floor_spectrum(spectrum: DemandSpectrum, floors: Sequence[FloorSettings], period: float, damping: float) -> float:
    """Return the floor spectrum S_eZ(T, xi, z) [m/s2] of Circolare 7/2019, (C7.2.5) to (C7.2.8)."""
    parts = []
    for floor in floors:
        # xi_k is a ratio: with percent, as printed in the circular, the floor's period would be a minimum.
        high = 1.1 * floor.damping**-0.5 * damping_factor(damping)
        rising, falling = (share * floor.period for share in PLATEAU)
        below, above = max(0.0, 1.0 - period / rising), max(0.0, period / falling - 1.0)
        apart = below**1.6 + above**1.2
        shake = spectrum(floor.period, floor.damping) * abs(floor.participation)
        peak = shake * math.sqrt(1.0 + 0.0004 * (100.0 * floor.damping) ** 2)  # of the mode: (C7.2.7)
        parts.append(high * peak / (1.0 + (high - 1.0) * apart))
    found = math.hypot(*parts)
    longest = max(floor.period for floor in floors)
    return max(found, spectrum(period, damping)) if period > longest else found


def _displacement(spectrum: DemandSpectrum, floors: Sequence[FloorSettings], period: float, damping: float) -> float:
    """Return the spectral displacement demand [m] at a period [s]: C8.7.1.2.1.8; formula C8.7.1.12 on floors."""
    if not floors:
        return spectrum.displacement(period, damping)
    own = max(one.period for one in floors)
    found = displacement_of(period, floor_spectrum(spectrum, floors, period, damping))
    least = displacement_of(PLATEAU[1] * own, floor_spectrum(spectrum, floors, own, damping))
    return max(found, least) if period > PLATEAU[1] * own else found


#: The check function of each code that uses a spectrum, by its name.
CHECKS: dict[str, Callable[[Mechanism, DemandSpectrum, Sequence[FloorSettings], CheckSettings], Checked]] = {
    one.__name__: one for one in (circolare_2009, circolare_2019, en_1998, circolare_2019_frame)
}


def worst(senses: Sequence[Checked]) -> Checked:
    """Combine the checks of both directions of rotation: take the worse acceleration and the worse displacement."""
    named = SENSES if len(senses) > 1 else ("",)

    opens = min(range(len(senses)), key=lambda at: senses[at].activation)
    allowed, ratio = np.array([(one.displacement, one.displacement_ratio) for one in senses]).T
    # A mechanism without resistance has the worst ratio.
    moves = int(np.argmin(np.where(np.isnan(ratio), np.where(np.isnan(allowed), np.inf, -np.inf), ratio)))
    statements = dict.fromkeys(senses[at].statement for at in (opens, moves) if senses[at].statement)
    return senses[moves]._replace(
        activation=senses[opens].activation,
        activation_demand=senses[opens].activation_demand,
        statement="; ".join(statements),
        activation_sense=named[opens],
        displacement_sense="" if math.isnan(senses[moves].displacement) else named[moves],
    )
