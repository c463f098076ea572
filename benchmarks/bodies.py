"""Cost of bodies that are no free-standing symmetric blocks, as a ratio to the plain kernel in the same run.

``python benchmarks/bodies.py`` prints the time of an active sample (one in which the body moves) of each kind over that
of the plain block of the same size, medians of several interleaved runs on one thread, by the peak of the ground over
the acceleration that lifts the plain block. Just above 1 bodies rest most of the time, and short hops with many impacts
and waiting for the next one cost most of what is counted there.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from rocking import Load, Tie, recorded_response
from rocking.block import Block

#: Peaks of the ground over the acceleration that lifts the plain block.
LEVELS = (1.35, 1.8, 2.75, 4.3)


def motion(samples: int, dt: float) -> np.ndarray:
    """A seeded motion of a few sines under a bell, peak 1."""
    rng = np.random.default_rng(1)
    times = dt * np.arange(samples)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * times + rng.uniform(0.0, 6.0)) for f in (0.6, 1.1, 1.9, 3.3))
    found = waves * np.exp(-(((times - 0.4 * times[-1]) / (0.2 * times[-1])) ** 2))
    return found / np.max(np.abs(found))


def kinds(height: np.ndarray) -> dict[str, Block]:
    """Bodies of the same sizes, plain and otherwise."""
    width = height / 6.0
    mass = 1800.0 * width * height
    held = {"width": width, "height": height, "mass": mass}
    radius = 0.5 * np.hypot(width, height)
    every = {"plain": Block(width=width, height=height), "one-sided": Block(width=width, height=height, one_sided=True)}
    every["one-sided, e = C"] = Block(
        width=width, height=height, one_sided=True, rebound=every["plain"].restitution, log=False
    )
    every["plain, C = e"] = Block(width=width, height=height, restitution=every["one-sided"].restitution, log=False)
    every["two corners"] = Block(width=width, height=height, offset=0.05 * width)

    def of_each(**options) -> Block:
        parts = []
        for place in range(height.size):
            stiffness = 20.0**2 * 4.0 / 3.0 * mass[place] * radius[place] ** 2 / (0.8 * height[place]) ** 2
            force = 0.2 * mass[place] * 9.81 * width[place] / height[place]
            given = {name: make(height[place], stiffness, force) for name, make in options.items()}
            parts.append(Block(**{name: values[place] for name, values in held.items()}, **given, log=False))
        return Block.stack(parts)

    every["elastic ties"] = of_each(ties=lambda h, k, f: [Tie(0.8 * h, k, gap=0.01 * h, side="both")])
    every["yielding ties"] = of_each(ties=lambda h, k, f: [Tie(0.8 * h, k, yield_force=f, side="both")])
    every["a load"] = of_each(loads=lambda h, k, f: [Load(0.5 * f, h, friction=0.1)])
    return every


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    height = np.linspace(2.0, 6.0, 512)
    ground, dt = 9.81 / 6.0 * motion(4000, 0.005), 0.005
    bodies = kinds(height)
    spent: dict[str, list[list[float]]] = {name: [] for name in bodies}
    for _ in range(runs + 1):
        for name, block in bodies.items():
            spent[name].append([])
            for level in LEVELS:
                start = time.perf_counter()
                found = recorded_response(block, level * ground, dt, threads=1)
                spent[name][-1].append((time.perf_counter() - start) / np.sum(found.active_samples))
    cost = {name: np.array(values[1:]) for name, values in spent.items()}
    print("peak over uplift " + "".join(f"{level:10.2f}" for level in LEVELS))
    print("plain, ns a sample" + "".join(f"{1e9 * value:9.0f} " for value in np.median(cost["plain"], axis=0)))
    for name, values in cost.items():
        ratios = np.median(values / cost["plain"], axis=0)
        print(f"{name:<17}" + "".join(f"{ratio:10.2f}" for ratio in ratios))


if __name__ == "__main__":
    main()
