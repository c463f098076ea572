"""Results of any size with the layout of :func:`rockpulse.assess`, made of random numbers: only the bodies are real."""

import numpy as np
import xarray as xr
from results_tree import completed

from rockpulse.models import Block
from rockpulse.storage.variables import failure_table
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS, OVERTURNING, WAVES
from rockpulse.storage.variables.bodies import BLOCK, CASE
from rockpulse.storage.variables.summary import ANSWER, DEMAND, RECORD, SUMMARY

MODELS = ["resonance", "sequence", "impulsive", "linear", "nonlinear"]


def _filled(declared, numbers, dims, shape):
    """Variables by their declarations: words numbered, numbers between 0.2 and 3."""
    found = {}
    for name, variable in declared.items():
        if variable.kind is str:
            values = np.array([f"{name} {place}" for place in range(np.prod(shape, dtype=int))]).reshape(shape)
        else:
            values = numbers.uniform(0.2, 3.0, shape)
        found[name] = variable.variable(values, dims)
    return found


def many_results(records, blocks, samples=6000, seed=0):
    """A tree of `records` records of ten earthquakes on `blocks` bodies; `samples` samples each."""
    numbers = np.random.default_rng(seed)
    lanes = ("record", "block", "model")
    shape = (records, blocks, len(MODELS))
    variables = {
        **_filled(RECORD, numbers, ("record",), (records,)),
        **_filled(BLOCK, numbers, ("block",), (blocks,)),
        **_filled(CASE, numbers, ("block",), (blocks,)),
        **_filled(DEMAND, numbers, lanes[:2], shape[:2]),
        **_filled(ANSWER, numbers, lanes, shape),
    }
    summary = xr.Dataset(
        variables,
        {
            "record": SUMMARY["record"].variable([f"XX.S{k:03d}..HNE@20200101T{k:06d}" for k in range(records)]),
            "block": SUMMARY["block"].variable([f"wall {k}" for k in range(blocks)]),
            "model": SUMMARY["model"].variable(MODELS),
        },
    )
    body = Block(half_width=numbers.uniform(0.1, 0.5, blocks), half_height=numbers.uniform(1.6, 3.0, blocks))
    for name in ("radius", "alpha_c", "p", "gravity", "slenderness", "critical_impulse", "restitution"):
        summary[name].values[:] = getattr(body, name)
    summary["width"].values[:], summary["height"].values[:] = 2.0 * body.half_width, 2.0 * body.half_height
    for name, value in {"one_sided": 0, "restraints": "", "floors": "", "pedestal_of": "", "friction": np.nan}.items():
        summary[name].values[:] = value
    summary["alpha_2"].values[:] = body.alpha_2
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
    for name, value in (("applicable", 1), ("factor_resolved", 1), ("reason", 0), ("pgv_drift", 0)):
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
        summary[name] = RECORD[name].variable(values)
    summary["npts"].values[:], summary["dt"].values[:] = samples, 0.01
    summary["intense_start"].values[:], summary["intense_end"].values[:] = 0.2 * samples * 0.01, 0.6 * samples * 0.01
    motion = numbers.normal(size=(records, samples)) * np.hanning(samples)
    ragged = ASSESSMENT_GROUPS["/records"]
    stored = xr.Dataset(
        {
            "row_size": ragged["row_size"].variable(np.full(records, samples)),
            "acceleration": ragged["acceleration"].variable(motion.ravel()),
            "half_wave_row_size": ragged["half_wave_row_size"].variable(np.full(records, 2)),
            **_filled({f"half_wave_{name}": WAVES[name] for name in WAVES}, numbers, ("wave",), (2 * records,)),
        },
        {"record": summary["record"].variable},
    )
    for name, pair in (("start", [0.5, 1.5]), ("centroid", [1.0, 2.0]), ("end", [1.5, 2.5])):
        stored[f"half_wave_{name}"].values[:] = np.tile(pair, records)
    where = np.argwhere(np.isfinite(factor))
    given = {f"{axis}_index": where[:, place] for place, axis in enumerate(("record", "block", "model"))}
    given |= {"lower": factor[np.isfinite(factor)], "upper": np.full(len(where), 10.0)}
    given |= {"case_index": np.zeros(len(where)), "open": np.ones(len(where)), "resolved": np.ones(len(where))}
    intervals = xr.Dataset(
        {
            **_filled(OVERTURNING, numbers, ("interval",), (len(where),)),
            **{name: OVERTURNING[name].variable(values) for name, values in given.items()},
        }
    )
    root = xr.Dataset(attrs={"title": "Many", "configuration": '[site]\nname = "Many"\n', "kind": "assessment"})
    groups = {"/": root, "/summary": completed(summary), "/failures": failure_table([]), "/records": stored}
    return xr.DataTree.from_dict(groups | {"/overturning_intervals": intervals})
