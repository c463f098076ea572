"""The moments of ties, loads and thrusts on a rocking body, and their changes during the motion.

.. note:: While no tie begins or ceases to act, the moment of all restraints divided by M g R is A cos(phi) + B sin(phi)
   + C cos(2 phi) + D sin(2 phi): a tie with the force K (x - x_0) gives A = K z (xi - x_0), B = K xi (xi - x_0), C = -K
   z xi, D = K (z^2 - xi^2)/2, a constant force F gives A = F z, B = F xi, and phi'' keeps a Taylor series. A step ends
   if phi leaves the range (FLOOR, CEILING), or if the body turns back under a tie that yields or a load that slides.
"""

import math
from typing import NamedTuple

import numpy as np

from rocking.body.restraint import FRICTION, GAP, HEIGHT, KIND, NEAR, SIDE, STIFFNESS, ULTIMATE, YIELD_FORCE
from rocking.kernel_cache import njit
from rocking.march import corner_event as more
from rocking.march import slots as row

# States of an element: a tie is slack, acts as a spring, yields, or is broken; a load acts as a spring, or slides
# towards theta > 0 or theta < 0.
SLACK, SPRING, YIELDS, BROKEN, SLIDES_UP, SLIDES_DOWN = range(6)
#: Longest step of a body held by springs, as the phase of its oscillation [rad].
LONGEST_PHASE = 0.3
#: Distance from the end of a range within which phi counts as being at that end, divided by the size of the range [-].
TOUCHING = 1e-13


class RestraintState(NamedTuple):
    """The restraints of m bodies, and the state of each restraint in each lane (a body under a scale factor)."""

    elements: np.ndarray  #: (m, e, 9), see :mod:`rocking.body.restraint`; a height of 0 means no element
    constant: np.ndarray  #: (m, 2, 2) moments of weights and thrusts: factors of cos(phi), sin(phi) by corner [N m]
    points: np.ndarray  #: (m, e, 2, 3) horizontal distance and distance of each element from each corner [m],
    # and the angle of the line between them to the vertical [rad]
    weight: np.ndarray  #: (m, 2) M g R by corner [N m]
    angle: np.ndarray  #: (m, 2, 2) sin(alpha) and cos(alpha) by corner
    peak: np.ndarray  #: (lanes, 2) largest phi about each corner [rad], written at the end of a lane
    mode: np.ndarray  #: (lanes, e) of int, state of each element
    set: np.ndarray  #: (lanes, e) displacement at which the force is zero: for a tie minus its gap, for a load
    # towards theta > 0 [m]


@njit(_nrt=False)
def sides(f, j):
    """Return the index of the corner about which body j turns (0 for theta > 0, else 1), and the sign of theta."""
    return (0, 1.0) if f[row.SIDE + j] > 0.0 else (1, -1.0)


@njit(_nrt=False)
def rotation_at(displacement, point):
    """Return phi at which a point (RestraintState.points) is displaced outward by `displacement`; inf if none."""
    if displacement == 0.0:
        return 0.0
    share = (displacement - point[0]) / point[1]
    if share > 1.0:
        return math.inf
    return point[2] + math.asin(max(share, -1.0))


@njit(_nrt=False)
def outward_displacement(phi, height, distance):
    """Return the outward displacement of a point at a height and a distance inwards from the corner [m]."""
    half = math.sin(0.5 * phi)
    return height * math.sin(phi) + distance * 2.0 * half * half


@njit(_nrt=False)
def set_restraint(f, j, block, lane, restraints):
    """Write the moment of the restraints of body j (rows SINE to COSINE_2), its range of phi, and the longest step."""
    place, side = sides(f, j)
    one, two = restraints.constant[block, place, 0], restraints.constant[block, place, 1]
    sine_2 = cosine_2 = stiff = 0.0
    fixed = abs(one) + abs(two)
    floor, ceiling, slides = 0.0, f[row.TOP + j], 0.0
    for e in range(restraints.elements.shape[1]):
        part = restraints.elements[block, e]
        height = part[HEIGHT]
        if height == 0.0:
            continue
        mode, rest = restraints.mode[lane, e], restraints.set[lane, e]
        stiffness = part[STIFFNESS]
        point = restraints.points[block, e, place]
        distance = point[0]
        if part[KIND] == FRICTION:
            own = side * rest
            most = part[YIELD_FORCE] / stiffness
            if mode == SPRING:
                floor = max(floor, rotation_at(own - most, point))
                ceiling = min(ceiling, rotation_at(own + most, point))
            else:
                outward = (mode == SLIDES_UP) == (side > 0.0)
                slides = 1.0 if outward else -1.0
                force = part[YIELD_FORCE] if outward else -part[YIELD_FORCE]
                one += force * height
                two += force * distance
                fixed += abs(force) * (height + abs(distance))
                continue
        else:
            if part[SIDE] != side or mode == BROKEN:
                continue
            own = part[GAP] + rest
            if mode == SLACK:
                ceiling = min(ceiling, rotation_at(own, point))
                continue
            last = rotation_at(part[GAP] + part[ULTIMATE], point)
            if mode == YIELDS:
                slides = 1.0
                one += part[YIELD_FORCE] * height
                two += part[YIELD_FORCE] * distance
                fixed += part[YIELD_FORCE] * (height + abs(distance))
                ceiling = min(ceiling, last)
                continue
            floor = max(floor, rotation_at(own, point))
            ceiling = min(ceiling, min(last, rotation_at(own + part[YIELD_FORCE] / stiffness, point)))
        one += stiffness * height * (distance - own)
        two += stiffness * distance * (distance - own)
        cosine_2 -= stiffness * height * distance
        sine_2 += 0.5 * stiffness * (height * height - distance * distance)
        stiff += stiffness * (height * height + distance * distance)
    weight = restraints.weight[block, place]
    one, two = one / weight, two / weight
    f[more.SINE_ALPHA + j] = restraints.angle[block, place, 0]
    f[more.COSINE_ALPHA + j] = restraints.angle[block, place, 1]
    f[more.SINE + j], f[more.COSINE + j] = two, one
    f[more.SINE_2 + j] = sine_2 / weight
    f[more.COSINE_2 + j] = cosine_2 / weight
    # The lever arm of a spring changes too; its elongation is at most pi/2 times its distance from the corner.
    f[more.STIFFEST + j] = ((1.0 + 0.5 * math.pi) * stiff + fixed) / weight
    f[more.FLOOR + j], f[more.CEILING + j], f[more.SLIDES + j] = floor, ceiling, slides
    longest = f[more.FREE_LONGEST + j]
    if stiff > 0.0:
        longest = min(longest, LONGEST_PHASE / math.sqrt(stiff / weight))
    f[row.LONGEST + j] = longest


@njit(_nrt=False)
def keep_peaks(f, j, lane, restraints, falls):
    """Update the largest rotations of body j about both corners; inf about the current one if the body `falls`."""
    place, _ = sides(f, j)
    peaks = restraints.peak[lane]
    peaks[place] = np.inf if falls else max(peaks[place], f[row.PEAK + j])
    peaks[1 - place] = max(peaks[1 - place], f[more.OTHER_PEAK + j])


@njit(_nrt=False)
def begin_restraint(f, j, block, lane, restraints):
    """Set the states of the restraints of body j at its initial rotation and speed."""
    place, side = sides(f, j)
    phi, outward = f[row.PHI + j], f[row.SPEED + j] > 0.0
    for e in range(restraints.elements.shape[1]):
        part = restraints.elements[block, e]
        restraints.mode[lane, e], restraints.set[lane, e] = SLACK, 0.0
        if part[KIND] == FRICTION:
            outside = outward_displacement(phi, part[HEIGHT], restraints.points[block, e, place, 0])
            restraints.mode[lane, e], restraints.set[lane, e] = SPRING, side * outside
        elif part[SIDE] == side and part[HEIGHT] > 0.0:
            over = outward_displacement(phi, part[HEIGHT], part[NEAR]) - part[GAP]
            most = part[YIELD_FORCE] / part[STIFFNESS]
            if over >= part[ULTIMATE]:
                restraints.mode[lane, e] = BROKEN
            elif over >= most:
                restraints.mode[lane, e] = YIELDS if outward else SPRING
                restraints.set[lane, e] = over - most
            elif over > 0.0 or (over == 0.0 and outward):
                restraints.mode[lane, e] = SPRING
    set_restraint(f, j, block, lane, restraints)


@njit(_nrt=False)
def restraint_after_impact(f, j, block, lane, restraints):
    """Set the states of the restraints of body j after an impact, for its new corner."""
    _, side = sides(f, j)
    for e in range(restraints.elements.shape[1]):
        part = restraints.elements[block, e]
        if part[HEIGHT] == 0.0:
            continue
        if part[KIND] == FRICTION:
            outward = SLIDES_UP if side > 0.0 else SLIDES_DOWN
            if restraints.mode[lane, e] != SPRING and restraints.mode[lane, e] != outward:
                make_spring(part, restraints, lane, e, 0.0, side)  # the body rebounded from the wall while it slid
        elif restraints.mode[lane, e] != BROKEN:
            free = part[SIDE] != side or part[GAP] + restraints.set[lane, e] > 0.0
            restraints.mode[lane, e] = SLACK if free else SPRING
    set_restraint(f, j, block, lane, restraints)


@njit(_nrt=False)
def make_spring(part, restraints, lane, e, outward, side):
    """Turn a yielding tie or a sliding load into a spring at the displacement `outward` [m]."""
    most = part[YIELD_FORCE] / part[STIFFNESS]
    if part[KIND] == FRICTION:
        restraints.set[lane, e] = side * outward - (most if restraints.mode[lane, e] == SLIDES_UP else -most)
    else:
        restraints.set[lane, e] = outward - part[GAP] - most
    restraints.mode[lane, e] = SPRING


@njit(_nrt=False)
def change_elements(f, j, block, lane, restraints, direction):
    """Change states of restraints at the upper (`direction` 1) or lower limit (-1) of phi, or at a reversal (0)."""
    place, side = sides(f, j)
    phi, outward, turned = f[row.PHI + j], direction > 0.0, direction == 0.0
    for e in range(restraints.elements.shape[1]):
        part = restraints.elements[block, e]
        if part[HEIGHT] == 0.0:
            continue
        x = outward_displacement(phi, part[HEIGHT], restraints.points[block, e, place, 0])
        near = TOUCHING * (x + part[HEIGHT])
        mode, most = restraints.mode[lane, e], part[YIELD_FORCE] / part[STIFFNESS]
        if part[KIND] == FRICTION:
            own = x - side * restraints.set[lane, e]
            if mode == SPRING and not turned:
                if outward and own >= most - near:
                    restraints.mode[lane, e] = SLIDES_UP if side > 0.0 else SLIDES_DOWN
                elif not outward and own <= near - most:
                    restraints.mode[lane, e] = SLIDES_DOWN if side > 0.0 else SLIDES_UP
            elif mode != SPRING and turned:
                make_spring(part, restraints, lane, e, x, side)
            continue
        if part[SIDE] != side or mode == BROKEN:
            continue
        over = x - part[GAP]
        if mode == YIELDS and turned:
            make_spring(part, restraints, lane, e, x, side)
        elif mode != SLACK and outward and over >= part[ULTIMATE] - near:
            restraints.mode[lane, e] = BROKEN
        elif mode == SLACK and outward and over - restraints.set[lane, e] >= -near:
            restraints.mode[lane, e] = SPRING
        elif mode == SPRING and not turned:
            if outward and over - restraints.set[lane, e] >= most - near:
                restraints.mode[lane, e] = YIELDS
            elif not outward and over - restraints.set[lane, e] <= near:
                restraints.mode[lane, e] = SLACK
    set_restraint(f, j, block, lane, restraints)


@njit(_nrt=False)
def rest_levels(f, j, block, lane, restraints, at_rest):
    """Set the increase EXTRA of both uplift thresholds by restraints; return its largest reduction by sliding loads."""
    place, side = sides(f, j)
    friction = most = 0.0
    for e in range(restraints.elements.shape[1]):
        part = restraints.elements[block, e]
        if part[KIND] == FRICTION:
            if restraints.mode[lane, e] != SPRING:
                if not at_rest:
                    most += part[YIELD_FORCE] * part[HEIGHT]
                    continue
                make_spring(part, restraints, lane, e, 0.0, side)
            friction -= part[STIFFNESS] * restraints.set[lane, e] * part[HEIGHT]  # resists theta > 0
    weight = restraints.weight[block, place] * restraints.angle[block, place, 1]
    other = restraints.weight[block, 1 - place] * restraints.angle[block, 1 - place, 1]
    f[more.EXTRA + j] = (restraints.constant[block, place, 0] + side * friction) / weight
    f[more.OTHER_EXTRA + j] = (restraints.constant[block, 1 - place, 0] - side * friction) / other
    return most / min(weight, other)
