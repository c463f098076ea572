"""One body under a few records, with answers that are given, and the verdict of the report on it."""

import numpy as np
import xarray as xr

from rocking.response import Outcome
from rockpulse.views.report.motions import Motions
from rockpulse.views.report.standing import bodies_of
from rockpulse.views.report.verdict import verdicts

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
    rows = [np.array([k]) for k in range(count)] if rows is None else [np.array(row) for row in rows]
    missing = np.zeros(len(rows), dtype=bool) if missing is None else np.array(missing)
    events = [f"e{k}" for k in range(len(rows))] if events is None else events
    return Motions([f"m{k}" for k in range(len(rows))], rows, missing, events, kind, 1)


def verdict(summary, of=None):
    of = motions(summary.sizes["record"]) if of is None else of
    (found,) = verdicts(summary, bodies_of(summary), "nonlinear", of)
    return found
