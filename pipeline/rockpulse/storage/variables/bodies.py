"""The variables of the bodies in /summary, each with the function that returns its values."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rocking.body.block import Block
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.restraint_settings import floors_as_text
from rockpulse.storage.variables import NO_YES, along, flag, real, text


def _lifting(lanes: Block) -> np.ndarray:
    """Return the smallest horizontal acceleration that lifts each body [m/s2]."""
    from rocking.search.capacity import uplift_scale  # imports the solvers, which viewing results does not need

    return uplift_scale(lanes, np.array([-1.0, 1.0]))


def _of_body(name: str) -> Callable[[Bodies, Config], Any]:
    return lambda bodies, config: getattr(bodies.lanes, name)[:: bodies.cases]


BLOCK = along(
    ("block",),
    _of_body,
    width=real("full width; NaN where only p and alpha are known", "m", lambda bodies, config: bodies.width),
    height=real("full height; NaN where only p and alpha are known", "m", lambda bodies, config: bodies.height),
    radius=real(
        "R, distance from the corner to the centre of mass: half the diagonal; for a body given by p and alpha the "
        "given radius, or that of the rectangle with the same p",
        "m",
    ),
    alpha_c=real("critical angle", "rad", explanation="about the right-hand corner"),
    p=real("frequency parameter", "s^-1", explanation="about the right-hand corner"),
    alpha_2=real("critical angle about the left-hand corner", "rad"),
    p_2=real("frequency parameter about the left-hand corner", "s^-1"),
    radius_2=real("distance from the left-hand corner to the centre of mass", "m"),
    one_sided=flag(NO_YES, "whether the body is in contact with a wall and falls to one side only", _of_body("side")),
    facing=real("azimuth towards which a one-sided body falls; NaN if not known", "degree", lambda b, config: b.facing),
    body_azimuth=real(
        "direction of the body to which pairs of channels are rotated; NaN: the direction of the records",
        "degree",
        lambda b, config: b.azimuth,
    ),
    friction=real("coefficient of friction at the base; NaN if not given", take=lambda b, config: b.friction),
    hinge_depth=real(
        "distance of the corners of rotation from the faces of the body; 0 without compressive_strength",
        "m",
        _of_body("hinge"),
        explanation="half the depth of the compressed edge; `alpha_c`, `p` and `radius` are about these corners",
    ),
    mass=real("mass of the body and of the loads that move with it; NaN if not known", "kg"),
    restraints=text(
        "ties, loads and thrusts of the body",
        lambda bodies, config: [
            "" if held is None else held.as_text()
            for held in np.broadcast_to(np.array(bodies.lanes.restraints, dtype=object), bodies.lanes.shape)[
                :: bodies.cases
            ]
        ],
        explanation="as JSON, in SI units; empty for none",
    ),
    floors=text(
        "modes of the building below the body",
        lambda bodies, config: [floors_as_text(floors) for floors in bodies.floors],
        explanation="as JSON: period [s], damping and participation [-] of each; empty on the ground",
    ),
    pedestal_of=text(
        "name of the body that, with its pedestal, forms this body",
        lambda bodies, config: bodies.pedestal_of,
        explanation="empty for all other bodies",
    ),
    uplift_acceleration=real(
        "smallest horizontal acceleration that lifts the body",
        "m s^-2",
        lambda bodies, config: _lifting(bodies.lanes)[:: bodies.cases],
    ),
    gravity=real(
        "acceleration of gravity at the block",
        "m s^-2",
        lambda bodies, config: np.full(len(bodies.names), bodies.lanes.gravity),
    ),
    slenderness=real("height divided by width"),
    critical_impulse=real("critical impulse I_1c, which overturns the block at rest", "m s^-1"),
    block_warnings=text("warnings on the block", lambda bodies, config: bodies.warnings, explanation="one per line"),
    block_warning_codes=text(
        "codes of the warnings on the block",
        lambda bodies, config: bodies.warning_codes,
        explanation="in their order, separated by blanks; `plain` for one without a code",
    ),
)

CASE = {
    "restitution": real(
        "velocity ratio C of an impact",
        take=lambda bodies, config: bodies.per_case(np.asarray(bodies.lanes.restitution)),
        dims=("block", "case"),
        explanation="of the impact that ends the rotation about the right-hand corner; the rebound of a one-sided body",
    ),
    "restitution_2": real(
        "velocity ratio C of an impact that ends the rotation about the left-hand corner",
        take=lambda bodies, config: bodies.per_case(np.asarray(bodies.lanes.restitution_2)),
        dims=("block", "case"),
    ),
}
