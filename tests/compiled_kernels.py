"""Compile the kernels before the tests of a long run: each worker a share, so that none is compiled twice."""

import time
from collections.abc import Callable

import numpy as np

from rocking import Block, ImpulseSequence, impulsive_response, recorded_response, resonance, sequence_response
from rocking.body.restraint import Tie
from rocking.kernel_cache import folder

#: Longest time that a worker waits for the others [s]; then it compiles what it needs itself.
PATIENCE = 240.0


def calls() -> list[Callable[[], object]]:
    """Calls of every large kernel, in an order that takes two workers equally long."""
    plain = Block(0.4, 2.0, gravity=9.81)
    corners = Block.from_corners(0.2, 0.3, 1.2, 0.7, gravity=9.81)
    tied = Block(width=0.4, height=2.0, mass=1e3, ties=[Tie(1.0, 1e5)])
    motion, times, impulses = np.array([0.0, 4.0, 0.0]), np.array([0.0, 0.5]), np.array([0.1, -0.1])
    sequence = ImpulseSequence(0.1, 0.05, 0.1, 2.0)
    return [
        lambda: recorded_response(tied, motion, 0.01),
        lambda: recorded_response(plain, motion, 0.01),
        lambda: resonance(plain, 0.1, 10),
        lambda: recorded_response(corners, motion, 0.01),
        lambda: impulsive_response(plain, times, impulses, 1.0, history_dt=0.1),
        lambda: (impulsive_response(plain, times, impulses), sequence_response(plain, sequence)),
    ]


def compile_share(worker: int, workers: int) -> None:
    """Compile the share of one worker, and wait until the other workers have compiled theirs."""
    done = [folder() / f"compiled-{number}-of-{workers}" for number in range(workers)]
    if not done[worker].exists():
        for call in calls()[worker::workers]:
            call()
        done[worker].touch()
    end = time.monotonic() + PATIENCE
    while not all(one.exists() for one in done) and time.monotonic() < end:
        time.sleep(0.1)
