"""Bodies of every kind, and motions for them, drawn by number."""

import numpy as np
from recorded_cases import shaking

from rocking.body.block import Block
from rocking.body.restraint import Load, Thrust, Tie

GRAVITY = 9.80665

#: Kinds of bodies; the equations know those of BOTH, and one of them the others.
BOTH = ("corners", "wall", "plain")
ALONE = ("elastic", "yielding", "brittle", "tied wall", "friction", "thrust", "all")
KINDS = ("corners", "wall", *ALONE, "plain")


def drawn(kind, number, seconds=4.0):
    """Body, ground acceleration [m/s2], interval [s] and equation of a case."""
    rng = np.random.default_rng([KINDS.index(kind), number])
    dt = float(rng.choice([0.01, 0.02, 0.04]))
    height = rng.uniform(0.5, 4.0)
    width = height / rng.uniform(3.5, 10.0)
    mass, radius = 1800.0 * width * height, 0.5 * np.hypot(width, height)
    at = rng.uniform(0.4, 1.0) * height
    stiffness = rng.uniform(3.0, 40.0) ** 2 * (4.0 / 3.0 * mass * radius**2) / at**2
    force = mass * GRAVITY * width / height * rng.uniform(0.05, 0.6)
    gap, xi = rng.choice([0.0, 0.02 * width]), rng.choice([0.0, width])
    given = {"width": width, "height": height, "mass": mass, "log": False}
    if kind == "plain":
        block = Block(width=width, height=height, restitution=rng.choice([0.0, 0.6, 0.9, 0.95]), log=False)
    elif kind == "corners":
        gyration = np.hypot(width, height) / np.sqrt(12.0) * rng.uniform(0.8, 1.1)
        corners = width * rng.uniform(0.3, 0.7), 0.5 * width
        block = Block.from_corners(*corners, 0.5 * height * rng.uniform(0.7, 1.1), gyration, log=False)
    elif kind == "wall":
        block = Block(**given, one_sided=True, rebound=rng.uniform(0.2, 0.9))
    elif kind == "elastic":
        side = str(rng.choice(["positive", "both", "negative"]))
        block = Block(**given, ties=[Tie(at, stiffness, side=side, gap=gap, distance=xi)])
    elif kind == "yielding":
        block = Block(**given, ties=[Tie(at, stiffness, side="both", gap=gap, distance=xi, yield_force=force)])
    elif kind == "brittle":
        first = Tie(at, stiffness, side="both", gap=gap, ultimate=rng.uniform(0.01, 0.3) * width)
        second = Tie(0.6 * at, 0.3 * stiffness, yield_force=0.5 * force, ultimate=rng.uniform(0.1, 0.5) * width)
        block = Block(**given, ties=[first, second])
    elif kind == "tied wall":
        tie = Tie(at, stiffness, gap=gap, yield_force=rng.choice([force, np.inf]))
        block = Block(**given, one_sided=True, ties=[tie])
    elif kind == "friction":
        load = Load(mass * GRAVITY * rng.uniform(0.1, 0.4), height, friction=rng.uniform(0.01, 0.08))
        block = Block(**given, loads=[load])
    elif kind == "thrust":
        thrust = Thrust(mass * GRAVITY * width / height * rng.uniform(-0.2, 0.2), 0.8 * height)
        block = Block(**given, one_sided=bool(rng.integers(2)), thrusts=[thrust])
    else:
        block = Block(
            **given,
            offset=0.1 * width,
            ties=[Tie(at, stiffness, yield_force=force, side="both"), Tie(0.5 * at, 0.3 * stiffness, gap=0.05 * width)],
            loads=[Load(0.2 * mass * GRAVITY, height, friction=0.02)],
            thrusts=[Thrust(0.1 * mass * GRAVITY * width / height, 0.8 * height)],
        )
    if number % 3 == 0:
        block = block.mirrored()
    motion = shaking(number, int(seconds / dt), dt, 0.3, 4.0)
    ground = motion * GRAVITY * np.tan(block.weaker.alpha_c) * rng.choice([1.3, 2.0, 3.0, 5.0])
    return block, ground, dt, "linear" if kind in BOTH and number % 2 else "nonlinear"
