"""A reduced set of every kind of answer, short enough for the kernels as plain Python; printed as JSON when run.

``NUMBA_DISABLE_JIT=1 python reduced_set.py`` prints the answers without compilation.
"""

import json
import logging

import numpy as np

from rocking import Block, ImpulseSequence, impulsive_response, recorded_response, sequence_response
from rocking.impulses.sequence import scaled_outcomes
from synthetic import synthetic_motion

DT = 0.02
MOTION = synthetic_motion(3, duration=1.6, dt=DT, pga=6.0)
UP = synthetic_motion(4, duration=1.6, dt=DT, pga=3.0)
PULSE = np.concatenate([4.5 * np.sin(np.pi * np.arange(16) / 15), np.zeros(60)])
SCALES = (0.3, 0.5, 1.0, 3.0)

#: Large and small, lively and dull: one of them never rebounds.
BLOCKS = Block.from_parameters(
    p=np.array([1.2, 2.0, 3.5, 6.0]), alpha=np.array([0.25, 0.2, 0.15, 0.3]), restitution=np.array([0.9, 0.8, 0.5, 0.0])
)
#: Its own p dt is above the longest step, so that samples are divided.
SMALL = Block.from_parameters(p=9.0, alpha=0.2, restitution=0.85)

RECORDED = {
    "plain": (BLOCKS, MOTION, {"scale": SCALES}),
    "history": (BLOCKS, MOTION, {"scale": SCALES, "history": True}),
    "divided": (SMALL, MOTION, {"scale": SCALES}),
    "uncontrolled": (SMALL, MOTION, {"scale": SCALES, "step": 0.3, "last_term": np.inf}),
    "chatter": (BLOCKS, PULSE, {"scale": SCALES}),
    "started": (BLOCKS, PULSE, {"initial_rotation": 0.3 * BLOCKS.alpha_c, "initial_velocity": -0.01}),
}


def recorded(equation):
    """Responses to records by one equation, by name."""
    found = {
        name: recorded_response(block, motion, DT, equation, **options)
        for name, (block, motion, options) in RECORDED.items()
    }
    if equation == "linear":
        found["tangent"] = recorded_response(BLOCKS, MOTION, DT, equation, scale=SCALES, gain="tangent")
    else:
        found["vertical"] = recorded_response(BLOCKS, MOTION, DT, equation, scale=SCALES, vertical=UP, history=True)
        found["halved"] = recorded_response(BLOCKS, MOTION, 5.0 * DT, equation, scale=(20.0,))
        found["free flight"] = recorded_response(BLOCKS, MOTION, DT, equation, vertical=-5.0 * UP)
    return found


def impulse_models():
    """Responses to impulses, by name."""
    times, impulses = np.arange(0.1, 3.0, 0.17), 0.35 * np.cos(np.arange(18) * 2.2)
    sequence = ImpulseSequence(np.array([0.1, 0.3, 0.6]), np.array([0.04, 0.1, 0.3]), 0.1, 5.0)
    return {
        "impulsive": impulsive_response(BLOCKS, times, impulses, 3.0, "tangent", SCALES, 0.25),
        "sequence": sequence_response(BLOCKS, sequence),
    }


def answers():
    """Flat lists of numbers by name: every answer of every response, histories included."""
    responses = {
        f"{equation}: {name}": found
        for equation in ("linear", "nonlinear")
        for name, found in recorded(equation).items()
    }
    responses |= impulse_models()
    numbers = {}
    for name, response in responses.items():
        for field in (
            "peak_rotation_ratio",
            "outcome",
            "reason",
            "overturning_time",
            "overturning_half_cycle",
            "impacts",
            "active_samples",
            "rotation",
            "velocity",
        ):
            values = getattr(response, field)
            if values is not None:
                numbers[f"{name}: {field}"] = np.ravel(values).tolist()
    main = ImpulseSequence(0.2, 0.05, 0.1, 5.0)
    factors = np.geomspace(0.2, 5.0, 6)[:, np.newaxis] * np.ones(2)
    numbers["search of the safety factor"] = scaled_outcomes(BLOCKS, main, np.array([0, 2]), factors).ravel().tolist()
    return numbers


if __name__ == "__main__":
    logging.disable(logging.WARNING)
    # The arithmetic of empty slots, which nobody reads, warns only where it is plain Python.
    with np.errstate(all="ignore"):
        print(json.dumps(answers()))
