"""A slow march through given impulses, from Eq. (2) in its textbook form: the oracle of the impulsive kernel.

x = s theta/alpha_c and u = s theta'/(p alpha_c) obey x'' = x - 1 in times of 1/p, so that y = x - 1 + u grows as e^tau
and z = x - 1 - u decays. Nothing is tabulated, shared between lanes or skipped but the last hops of a decay.
"""

import math

from rocking.body.block import Block
from rocking.response import Outcome

#: Gain of an impulse at x, divided by p/(g alpha_c).
GAINS = {
    "paper": lambda alpha, x: math.cos(alpha),
    "linear": lambda alpha, x: 1.0,
    "tangent": lambda alpha, x: alpha / math.tan(alpha),
    "exact": lambda alpha, x: math.cos(alpha * (1.0 - x)),
}
#: Hops slower than this are not followed: they rise by less than 1e-14 of alpha_c.
SLOWEST = 1e-7


def march(block: Block, times, impulses, gain: str = "paper", cutoff: float = 1e-3) -> tuple[float, Outcome, int]:
    """Peak over alpha_c, outcome and impacts above the cut-off."""
    factor = block.p / (block.gravity * block.alpha_c)
    largest = factor * (1.0 if gain == "exact" else GAINS[gain](block.alpha_c, 0.0))
    x = u = peak = 0.0
    side, impacts, outcome = 0.0, 0, Outcome.AT_REST
    for number, (time, impulse) in enumerate(zip(times, impulses, strict=True)):
        push = -factor * GAINS[gain](block.alpha_c, x) * impulse
        if push != 0.0:
            outcome = Outcome.ROCKS
            if side == 0.0:
                x, u, side = 0.0, 0.0, math.copysign(1.0, push)
            u += side * push
        wait = block.p * (times[number + 1] - time) if number + 1 < len(times) else math.inf
        waited = 0.0
        while side != 0.0:
            y, z = x - 1.0 + u, x - 1.0 - u
            if y > 0.0 or (wait == math.inf and y >= -1e-13):
                now = time + waited / block.p
                later = zip(times[number + 1 :], impulses[number + 1 :], strict=True)
                if wait == math.inf or y > sum(largest * abs(i) * math.exp(block.p * (now - t)) for t, i in later):
                    return math.inf, Outcome.OVERTURNS, impacts
            left = wait - waited
            speed = math.sqrt(max(x * (2.0 - x) + u * u, 0.0))  # 1 - y z without cancellation
            # y e^tau + z e^-tau = -2 on the ground.
            back = math.log((1.0 + speed) / -y) if y < 0.0 else math.inf
            if u > 0.0 and y < 0.0 and 0.5 * math.log(z / y) <= left:
                peak = max(peak, 1.0 - math.sqrt(y * z))
            if back > left:
                y, z = y * math.exp(left), z * math.exp(-left)
                x, u = 1.0 + 0.5 * (y + z), 0.5 * (y - z)
                peak = max(peak, x)
                break
            impacts += speed > cutoff
            x, u, side, waited = 0.0, block.restitution * speed, -side, waited + back
            if u < SLOWEST:
                side = 0.0
    return peak, outcome, impacts
