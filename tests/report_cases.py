"""One body under a few records, with answers that are given, and the verdict of the report on it."""

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import verdicts

OF = ("record", "block", "model")


def summary_of(factors, outcomes=None, demand=None, resolved=None, pga=1.0, up_to=10.0, step=1.01):
    """One body under as many records as there are factors."""
    factors = np.asarray(factors, dtype=float)
    outcomes = np.where(factors <= 1.0, Outcome.OVERTURNS, Outcome.ROCKS) if outcomes is None else np.asarray(outcomes)
    resolved = np.ones(factors.size) if resolved is None else np.asarray(resolved)

    def table(values):
        return OF, np.asarray(values)[:, None, None]

    variables = {
        "outcome": table(outcomes),
        "safety_factor": table(factors),
        "factor_resolved": table(resolved),
        "safe_up_to": table(np.minimum(factors, up_to)),
        "search_step": table(np.full(factors.size, step)),
        "peak_rotation_ratio": table(np.where(outcomes == Outcome.ROCKS, 0.4, np.inf)),
        "pga": (("record",), np.full(factors.size, pga)),
        "warning_codes": (("record",), [""] * factors.size),
        "restitution": (("block",), np.array([0.9])),
    }
    coords = {"record": [f"r{k}" for k in range(factors.size)], "block": ["b"], "model": ["nonlinear"]}
    if demand is not None:
        coords["demand"] = ["ULS"]
        variables["demand_acceleration"] = (("demand",), np.array([demand]))
        variables["capacity_ratio"] = ((*OF, "demand"), (factors * pga / demand)[:, None, None, None])
    return xr.Dataset(variables, coords)


def motions(count, events=None, rows=None, missing=None, kind="record"):
    rows = [[k] for k in range(count)] if rows is None else rows
    lost = [False] * len(rows) if missing is None else missing
    # Where one lacks a direction the others have one twice: all have as many.
    rows = [[*row, -1] if gone else row + [row[0]] * any(lost) for row, gone in zip(rows, lost, strict=True)]
    events = [f"e{k}" for k in range(len(rows))] if events is None else events
    index = np.array(rows or np.zeros((0, 1)), dtype=int)
    return Motions([f"m{k}" for k in range(len(rows))], index, events, kind)


def answers(summary, of=None, model="nonlinear"):
    return Answers(summary, motions(summary.sizes["record"]) if of is None else of, model)


def verdict(summary, of=None):
    (found,) = verdicts(answers(summary, of))
    return found
