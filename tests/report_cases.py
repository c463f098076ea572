"""One body under a few records with given results, and the verdict of the report on it."""

import numpy as np
import xarray as xr
from results_tree import completed

from rocking.response import Outcome
from rockpulse.assessment.answers import Answers, Motions
from rockpulse.assessment.verdict import verdicts

OF = ("record", "block", "model")


def summary_of(factors, outcomes=None, demand=None, resolved=None, pga=1.0, up_to=10.0, step=1.01, to_demand=None):
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
        told = {"demand_value": demand, "demand_measure": "pga", "demand_units": "m s^-2"}
        variables |= {name: (("demand",), [value]) for name, value in told.items()}
        variables["capacity_ratio"] = ((*OF, "demand"), (factors * pga / demand)[:, None, None, None])
        scale = np.broadcast_to(np.asarray(demand) / pga if to_demand is None else to_demand, factors.shape)
        variables["demand_factor"] = ((*OF[:2], "demand"), np.array(scale, dtype=float)[:, None, None])
    return completed(xr.Dataset(variables, coords))


def probable(probability, factor_10=None, uplift=1.0, low=10.0, at_demand=None, **options):
    """The same with the probability of overturning in place of safety factors; `low` is how far was searched.

    `at_demand` is that under each record brought to a demand.
    """
    probability = np.asarray(probability, dtype=float)
    factor = np.where(probability >= 0.1, 0.9, 1.5) if factor_10 is None else np.asarray(factor_10, dtype=float)
    outcomes = options.pop("outcomes", np.where(probability >= 0.5, Outcome.OVERTURNS, Outcome.ROCKS))
    summary = summary_of(np.full(probability.size, np.nan), outcomes=outcomes, **options)
    values = {
        "overturning_probability": probability,
        "factor_10": factor,
        "factor_10_low": np.where(np.isinf(factor), low, 0.9 * factor),
        "factor_10_high": 1.1 * factor,
        "factor_50": 1.3 * factor,
        "factor_50_low": np.where(np.isinf(factor), low, 1.2 * factor),
        "factor_mean": 1.3 * factor,
        "factor_mean_low": np.where(np.isinf(factor), low, 1.2 * factor),
        "uplift_probability": np.broadcast_to(uplift, probability.shape),
    }
    variables = {name: (OF[:2], np.asarray(own)[:, None]) for name, own in values.items()}
    if at_demand is not None:
        variables["demand_probability"] = ((*OF[:2], "demand"), np.asarray(at_demand, dtype=float)[:, None, None])
    variables["probability_source"] = (OF[:2], np.ones((probability.size, 1), dtype=np.int8))
    return summary.assign(variables)


def turned(rotations, **options):
    """A summary at a demand whose records turn the nominal body so far, over alpha_c; inf: they overturn it."""
    rotations = np.array(rotations, dtype=float)
    outcome = np.select([np.isinf(rotations), np.isnan(rotations)], [Outcome.OVERTURNS, Outcome.UNRESOLVED], 1)
    own = {"demand_rotation_ratio": rotations, "demand_outcome": outcome}
    summary = probable([0.0] * rotations.size, at_demand=[0.0] * rotations.size, demand=1.0, **options)
    return summary.assign({name: ((*OF[:2], "demand"), values[:, None, None]) for name, values in own.items()})


def motions(count, events=None, rows=None, missing=None, kind="record", any_azimuth=False):
    rows = [[k] for k in range(count)] if rows is None else rows
    lost = [False] * len(rows) if missing is None else missing
    # Where one lacks a direction the others have one twice: all have as many.
    rows = [[*row, -1] if gone else row + [row[0]] * any(lost) for row, gone in zip(rows, lost, strict=True)]
    events = [f"e{k}" for k in range(len(rows))] if events is None else events
    index = np.array(rows or np.zeros((0, 1)), dtype=int)
    return Motions([f"m{k}" for k in range(len(rows))], index, events, kind, any_azimuth)


def answers(summary, of=None, model="nonlinear"):
    return Answers(summary, motions(summary.sizes["record"]) if of is None else of, model)


def verdict(summary, of=None, model="nonlinear"):
    (found,) = verdicts(answers(summary, of, model))
    return found
