"""Results of any size with the layout of :func:`rockpulse.assess`, made of random numbers: only the bodies are real."""

import numpy as np
import xarray as xr

from rockpulse.models import Block
from rockpulse.storage.variables import ANSWER, BLOCK, CASE, DEMAND, FAILURE, OVERTURNING, RECORD, WAVES, described

MODELS = ["resonance", "sequence", "impulsive", "linear", "nonlinear"]
FLAGS = {
    "pgv_drift": (0, ["reliable", "drift"]),
    "outcome": (0, ["at_rest", "rocks", "overturns", "unresolved"]),
    "reason": (0, ["none", "impact_limit", "free_flight"]),
    "model_used": (0, MODELS),
    "factor_resolved": (-1, ["not_computed", "no", "yes"]),
    "applicable": (0, ["outside_range", "applicable"]),
    "predictable": (-1, ["not_checked", "no", "yes"]),
}


def _filled(names, dims, shape, numbers):
    """Variables by their meanings: words numbered, numbers between 0.2 and 3."""
    found = {}
    for name, meaning in names.items():
        kind = meaning[0]
        if kind is str:
            values = np.array([f"{name} {place}" for place in range(np.prod(shape, dtype=int))]).reshape(shape)
        else:
            values = numbers.uniform(0.2, 3.0, shape)
        found[name] = described(dims, values, meaning)
        if name in FLAGS:
            first, meanings = FLAGS[name]
            found[name].attrs |= {
                "flag_values": np.arange(first, first + len(meanings), dtype=np.int8),
                "flag_meanings": " ".join(meanings),
            }
    return found


def many_results(records, blocks, samples=6000, seed=0):
    """A tree of `records` records of ten earthquakes on `blocks` bodies; `samples` samples each."""
    numbers = np.random.default_rng(seed)
    lanes = ("record", "block", "model")
    shape = (records, blocks, len(MODELS))
    variables = {
        **_filled(RECORD, ("record",), (records,), numbers),
        **_filled(BLOCK, ("block",), (blocks,), numbers),
        **_filled(CASE, ("block",), (blocks,), numbers),
        **_filled(DEMAND, lanes[:2], shape[:2], numbers),
        **_filled(ANSWER, lanes, shape, numbers),
    }
    summary = xr.Dataset(
        variables,
        {
            "record": described(("record",), [f"XX.S{k:03d}..HNE@20200101T{k:06d}" for k in range(records)], ID),
            "block": described(("block",), [f"wall {k}" for k in range(blocks)], ID),
            "model": described(("model",), MODELS, ID),
        },
    )
    body = Block(numbers.uniform(0.1, 0.5, blocks), numbers.uniform(1.6, 3.0, blocks))
    for name in ("radius", "alpha_c", "p", "slenderness", "critical_impulse", "restitution"):
        summary[name].values[:] = getattr(body, name)
    summary["width"].values[:], summary["height"].values[:] = 2.0 * body.half_width, 2.0 * body.half_height
    outcome = numbers.choice(np.array([0, 1, 1, 2], dtype=np.int8), shape)
    factor = np.where(outcome == 2, numbers.uniform(0.2, 1.0, shape), numbers.uniform(0.8, 9.0, shape))
    factor[outcome == 0] = np.inf
    summary["outcome"].values[...] = outcome
    summary["peak_rotation_ratio"].values[...] = np.select(
        [outcome == 0, outcome == 2], [0.0, np.inf], numbers.uniform(0.01, 0.9, shape)
    )
    summary["safety_factor"].values[...] = factor
    summary["safe_up_to"].values[...] = np.minimum(factor, 10.0)
    summary["interval_count"].values[...] = np.isfinite(factor)
    for name, value in (("predictable", 1), ("applicable", 1), ("factor_resolved", 1), ("reason", 0), ("pgv_drift", 0)):
        summary[name].values[...] = value
    words = {
        "event": [f"Earthquake {'ABCDEFGHIJ'[k % 10] * 3}" for k in range(records)],
        "start_time": [f"20{k % 10 + 10}-01-01T00:00:00+00:00" for k in range(records)],
        "source": [f"folder/file_{k:04d}.AT2" for k in range(records)],
        "warnings": ["baseline drift" if k % 9 == 0 else "" for k in range(records)],
        "warning_codes": ["baseline_drift" if k % 9 == 0 else "" for k in range(records)],
        "vertical_channel": [""] * records,
        "processing": ["baseline: mean removed"] * records,
    }
    for name, values in words.items():
        summary[name] = described(("record",), values, RECORD[name])
    summary["npts"].values[:], summary["dt"].values[:] = samples, 0.01
    summary["intense_start"].values[:], summary["intense_end"].values[:] = 0.2 * samples * 0.01, 0.6 * samples * 0.01
    motion = numbers.normal(size=(records, samples)) * np.hanning(samples)
    stored = xr.Dataset(
        {
            "row_size": described(("record",), np.full(records, samples), (int, "1", "samples")),
            "acceleration": described(("sample",), motion.ravel(), (float, "m s-2", "acceleration")),
            "half_wave_row_size": described(("record",), np.full(records, 2), (int, "1", "half-waves")),
            **_filled({f"half_wave_{name}": WAVES[name] for name in WAVES}, ("wave",), (2 * records,), numbers),
        },
        {"record": summary["record"].variable},
    )
    for name, pair in (("start", [0.5, 1.5]), ("centroid", [1.0, 2.0]), ("end", [1.5, 2.5])):
        stored[f"half_wave_{name}"].values[:] = np.tile(pair, records)
    where = np.argwhere(np.isfinite(factor))
    intervals = xr.Dataset(
        {
            **_filled(OVERTURNING, ("interval",), (len(where),), numbers),
            "record_index": described(("interval",), where[:, 0], OVERTURNING["record_index"]),
            "block_index": described(("interval",), where[:, 1], OVERTURNING["block_index"]),
            "case_index": described(("interval",), np.zeros(len(where)), OVERTURNING["case_index"]),
            "model_index": described(("interval",), where[:, 2], OVERTURNING["model_index"]),
            "lower": described(("interval",), factor[np.isfinite(factor)], OVERTURNING["lower"]),
            "upper": described(("interval",), np.full(len(where), 10.0), OVERTURNING["upper"]),
        }
    )
    for name in ("open", "resolved"):
        intervals[name].values[:] = 1
    failures = xr.Dataset({name: described(("failure",), [], meaning) for name, meaning in FAILURE.items()})
    root = xr.Dataset(attrs={"title": "Many", "configuration": '[site]\nname = "Many"\n', "kind": "assessment"})
    return xr.DataTree.from_dict(
        {
            "/": root,
            "/summary": summary,
            "/failures": failures,
            "/records": stored,
            "/overturning_intervals": intervals,
        }
    )


ID = (str, "1", "name")
