"""A body as the kinematic mechanism of the codes: weights and forces on a body that turns about a corner.

.. note:: A weight W_i is at the distance x_i behind the corner and z_i above it. At a rotation theta (small, as in
   codes) one more unit of rotation moves W_i sideways by z_i and lifts it by x_i - z_i theta. The multiplier of the
   horizontal forces is alpha = [sum W_i (x_i - z_i theta) + sum F_j z_j]/sum W_i z_i. The sum in the denominator is
   over the weights whose mass moves with the body (Circolare 7/2019, C8.7.1.1). Ties are rigid-plastic: beyond their
   gap they resist with their yield force until they break. The displacement d_0 is computed without ties.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rocking.body.block import Block
from rocking.body.block_lanes import STANDARD_GRAVITY
from rocking.body.restraint import Load, Restraints
from rockpulse.config.block_settings import BlockSettings

#: Relative distance from a jump of the multiplier at which its value before or after the jump is computed.
ROUNDING = 1e-9
#: Names of the directions of rotation in :func:`senses_of`.
SENSES = ("positive", "negative")


class Weight(NamedTuple):
    """A weight of a mechanism, with its position relative to the corner about which the body turns."""

    weight: float  #: [N]; of any value if the body has no restraints
    arm: float  #: x, distance behind the corner [m]
    height: float  #: z, height above the corner [m]
    moving: bool  #: whether the mass moves with the body


class Force(NamedTuple):
    """A horizontal force on a body, which acts while the displacement of its point is within a range."""

    force: float  #: [N]; positive if it resists the rotation
    height: float  #: height above the corner [m]
    begins: float = 0.0  #: displacement from which the force acts [m]
    ends: float = math.inf  #: displacement up to which the force acts [m]
    tie: bool = False


@dataclass(frozen=True)
class Mechanism:
    """The mechanism of a body that overturns about one corner."""

    weights: tuple[Weight, ...]  # the weight of the body first
    forces: tuple[Force, ...] = ()  # ties, friction and thrusts
    gravity: float = STANDARD_GRAVITY  # [m/s2]
    initial_period: float = 0.0  # T_0 of an element that is free to vibrate [s]; 0 if rigid until it opens
    unsupported: float = math.inf  # rotation at which a beam on the body loses its support [rad]

    @property
    def _driving(self) -> float:
        return sum(one.weight * one.height for one in self.weights if one.moving)

    @property
    def multiplier(self) -> float:
        """Multiplier alpha_0 that sets the mechanism in motion [-]: Circolare 7/2019, (C8.7.1.1)."""
        return self.at(0.0)

    @property
    def share(self) -> float:
        """Participating mass ratio e* [-]: Circolare 617/2009 (C8A.4.3), Circolare 7/2019 (C8.7.1.5)."""
        moving = [one for one in self.weights if one.moving]
        squares = sum(one.weight * one.height**2 for one in moving)
        return self._driving**2 / (sum(one.weight for one in moving) * squares)

    @property
    def lever(self) -> float:
        """Ratio of spectral displacement to rotation [m]: Circolare 7/2019, (C8.7.1.4)."""
        return sum(one.weight * one.height**2 for one in self.weights if one.moving) / self._driving

    @property
    def unlimited(self) -> bool:
        """Whether a tie has no ultimate elongation."""
        return any(one.tie and math.isinf(one.ends) for one in self.forces)

    def at(self, rotation: float, untied: bool = False) -> float:
        """Return the multiplier alpha at a rotation [rad]; with `untied`, as if there were no ties."""
        held = sum(one.weight * (one.arm - one.height * rotation) for one in self.weights)
        for force in self.forces:
            acts = force.begins <= force.height * rotation <= force.ends
            if acts and not (untied and force.tie):
                held += force.force * force.height
        return held / self._driving

    @property
    def collapse_displacement(self) -> float:
        """Spectral displacement d_0 at which the resistance of the body without its ties becomes zero [m]."""
        weights = sum(one.weight * one.height for one in self.weights)
        return max(0.0, self.at(0.0, untied=True) * self._driving / weights) * self.lever

    @property
    def slope(self) -> float:
        """Tangent of the critical angle of the body with the loads that move with it [-]."""
        moving = [one for one in self.weights if one.moving]
        return sum(one.weight * one.arm for one in moving) / self._driving

    @property
    def rupture_displacement(self) -> float:
        """Spectral displacement [m] at which ties that give over half of the largest multiplier have broken, or inf."""
        ties = sorted((one for one in self.forces if math.isfinite(one.ends)), key=lambda one: one.ends / one.height)
        begins = (one.begins / one.height * (1.0 + ROUNDING) for one in self.forces)
        most, lost = max(self.at(rotation) for rotation in (0.0, *begins)), 0.0
        for one in ties:
            lost += one.force * one.height / self._driving
            if lost > 0.5 * most:
                return one.ends / one.height * self.lever * (1.0 - ROUNDING)  # just before the tie breaks
        return math.inf

    def capacity(self, displacement: float) -> float:
        """Return the multiplier alpha [-], not below 0, at a spectral displacement [m]."""
        return max(0.0, self.at(displacement / self.lever))


def _forces(restraints: Restraints, base: float) -> tuple[list[Weight], list[Force]]:
    """Return the loads whose mass stays with the building, and the forces of all restraints, for theta > 0."""
    weights, forces = [], []
    for load in restraints.loads:
        assert load.friction is not None  # loads without friction move with the body
        weights.append(Weight(load.weight, restraints.bearing(load, base) - restraints.hinge, load.height, False))
        forces.append(Force(load.friction * load.weight, load.height))
    for tie in restraints.ties:
        if tie.side == "negative":
            continue
        if math.isinf(tie.yield_force):
            raise ValueError("a tie without yield_force, but the check assumes rigid-plastic ties: give yield_force")
        forces.append(Force(tie.yield_force, tie.height, tie.gap, tie.gap + tie.ultimate, tie=True))
    forces += [Force(-one.force, one.height) for one in restraints.thrusts]
    return weights, forces


def senses_of(block: Block, alone: Block | None = None, carried: Sequence[Load] = ()) -> tuple[Mechanism, ...]:
    """Return the mechanisms towards theta > 0 and theta < 0; only one if both are equal or a wall prevents one.

    `block` may have several restitutions, which have no effect. If loads move with the block, `alone` is the body
    without them and `carried` lists them as separate weights. Raises ValueError for a tie without a yield force.
    """
    whole, body = (one.lane(0) if one.shape else one for one in (block, block if alone is None else alone))
    found = [_mechanism(whole, body, carried)]
    if whole.side == 0:
        base = float(body.radius * np.sin(body.alpha_c) + body.radius_2 * np.sin(body.alpha_2))
        seen = Restraints(loads=tuple(carried), hinge=float(body.hinge)).mirrored(base).loads
        found.append(_mechanism(whole.mirrored(), body.mirrored(), seen))
    return tuple(dict.fromkeys(found))


def _mechanism(block: Block, body: Block, carried: Sequence[Load]) -> Mechanism:
    mass, radius, alpha = float(body.mass), float(body.radius), float(body.alpha_c)
    weight = body.gravity * mass if math.isfinite(mass) else 1.0
    # The edge is crushed by the weight of the body and of the carried loads.
    inside = Restraints(hinge=float(block.hinge))
    arm, height = radius * math.sin(alpha) + float(body.hinge) - inside.hinge, radius * math.cos(alpha)
    base = arm + float(body.radius_2) * math.sin(body.alpha_2) + float(body.hinge) - inside.hinge
    weights = [Weight(weight, arm, height, True)]
    weights += [Weight(one.weight, inside.bearing(one, base) - inside.hinge, one.height, True) for one in carried]
    held = block.restraints
    others, forces = _forces(held, base) if isinstance(held, Restraints) else ([], [])
    return Mechanism(tuple(weights + others), tuple(forces), body.gravity)


def mechanisms(body: BlockSettings, confidence_factor: float = 1.0) -> dict[str, tuple[Mechanism, ...]]:
    """Return the mechanisms of a body by name, alone and with each of its pedestals (see :func:`senses_of`).

    The compressive strength of the body is divided by `confidence_factor`.
    """
    if body.compressive_strength is not None:
        body = replace(body, compressive_strength=body.compressive_strength / confidence_factor)
    carried = tuple(one.made() for one in body.loads if one.friction is None)
    rest = tuple(one for one in body.loads if one.friction is not None)
    alone = replace(body, loads=rest).block() if carried else None
    senses = senses_of(body.block(), alone, carried)
    period, lost = body.initial_period, body.unsupported
    found = {body.name: tuple(replace(one, initial_period=period, unsupported=lost) for one in senses)}
    return found | {name: senses_of(block) for name, block in body.with_pedestals().items()}
