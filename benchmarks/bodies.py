"""Run time of bodies other than free-standing symmetric blocks, relative to the plain kernel in the same run.

``python benchmarks/bodies.py`` prints the time of an active sample (one in which the body moves) for each kind of body,
divided by that of the plain block of the same size. The times are medians of several interleaved runs on one thread.
The columns are the peak ground acceleration divided by the acceleration that lifts the plain block. Just above 1 the
bodies rest most of the time, and the time is mainly that of short motions with many impacts.
"""

import argparse
import time

import numpy as np

from laboratory.accuracy.bodies import PLAIN, SLENDERNESS, kinds
from rocking import recorded_response
from rocking.body.block import Block

#: Peaks of the ground over the acceleration that lifts the plain block.
LEVELS = (1.35, 1.8, 2.75, 4.3)


def motion(samples: int, dt: float) -> np.ndarray:
    """A seeded motion of a few sines under a bell, peak 1."""
    rng = np.random.default_rng(1)
    times = dt * np.arange(samples)
    waves = sum(rng.normal() * np.sin(2.0 * np.pi * f * times + rng.uniform(0.0, 6.0)) for f in (0.6, 1.1, 1.9, 3.3))
    found = waves * np.exp(-(((times - 0.4 * times[-1]) / (0.2 * times[-1])) ** 2))
    return found / np.max(np.abs(found))


def of_height(height: np.ndarray) -> dict[str, Block]:
    """The kinds of the accuracy report, with those that tell why a body before a wall costs what it does."""
    every = kinds(height)
    c = every[PLAIN].restitution
    wall = every["before a wall"]
    sizes = {"width": height / SLENDERNESS, "height": height, "log": False}
    return every | {
        "a wall, e = C": Block(one_sided=True, rebound=c, **sizes),
        "free, C = e": Block(restitution=wall.restitution, **sizes),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    height = np.linspace(2.0, 6.0, 512)
    ground, dt = 9.81 / SLENDERNESS * motion(4000, 0.005), 0.005
    bodies = of_height(height)
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
    print("plain, ns a sample" + "".join(f"{1e9 * value:9.0f} " for value in np.median(cost[PLAIN], axis=0)))
    for name, values in cost.items():
        ratios = np.median(values / cost[PLAIN], axis=0)
        print(f"{name:<17}" + "".join(f"{ratio:10.2f}" for ratio in ratios))


if __name__ == "__main__":
    main()
