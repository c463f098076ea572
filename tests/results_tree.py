"""A small tree with the layout of :func:`rockpulse.assess`, with chosen results."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from rockpulse.errors import Failure
from rockpulse.storage.variables import failure_table
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS
from rockpulse.storage.variables.summary import SUMMARY

RECORDS = ["CI.CCC..HNE@20190706T031953", "CI.CCC..HNN@20190706T031953", "weak.1"]
BLOCKS = ["boundary wall", "column", "cabinet"]
MODELS = ["resonance", "sequence", "nonlinear"]
CONFIGURATION = '[site]\nname = "Borgo"\n'

OUTCOMES = np.array(
    [[[2, 2, 2], [2, 1, 1], [2, 1, 3]], [[2, 2, 1], [1, 1, 1], [1, 1, 1]], [[0, 0, 0], [0, 0, 0], [0, 0, 0]]],
    dtype=np.int8,
)


def completed(summary):
    """A node /summary by hand with every variable that it lacks: not computed, not known, of a plain body."""
    known = {
        "applicable": 1,
        "reason": 0,
        "probability_source": 0,
        "pgv_drift": 0,
        "one_sided": 0,
        "event": "unknown",
        "npts": 0,
        "hinge_depth": 0.0,
    }
    for name in ("alpha", "p", "radius", "restitution"):
        one = "alpha_c" if name == "alpha" else name
        if one in summary:
            known[f"{name}_2"] = summary[one].values
    if {"alpha_c", "gravity"} <= set(summary):
        known["uplift_acceleration"] = np.tan(summary["alpha_c"].values) * summary["gravity"].values
    added = {}
    for name, one in SUMMARY.items():
        if name not in summary.variables and {"demand", "tie"} & {*one.dims} <= {*summary.dims}:
            order = [dim for dim in summary.get("outcome", summary["restitution"]).dims if dim in one.dims]
            dims = (*order, *(dim for dim in one.dims if dim in summary.dims and dim not in order and dim != "case"))
            values = np.broadcast_to(known.get(name, one.absent), [summary.sizes[dim] for dim in dims])
            added[name] = one.variable(values.copy(), dims)
    return summary.assign(added)


def demanding(summary, demands, **variables):
    """A node /summary with demands in the PGA [m/s2], by name, and other variables."""
    value = np.array([*demands.values()], dtype=float)
    name = SUMMARY["demand"].variable([*demands])
    own = {"demand_acceleration": value, "demand_value": value, "demand_measure": ["pga"] * value.size}
    own |= {"demand_units": ["m s^-2"] * value.size}
    own = {name: SUMMARY[name].variable(values) for name, values in own.items()}
    summary = summary.assign_coords(demand=name).assign(own | variables)
    lanes = [dim for dim in summary["outcome"].dims if dim != "model"]
    factor = (xr.DataArray(value, dims="demand") / summary["pga"]).expand_dims(
        {dim: summary.sizes[dim] for dim in lanes[1:]}
    )
    dims = (*lanes, "demand")
    summary["demand_factor"] = SUMMARY["demand_factor"].variable(factor.transpose(*dims).values, dims)
    return completed(summary)


def results_tree(cases=None):
    """The tree; with `cases` restitution values per block where a number is given."""
    peak = np.select([OUTCOMES == 0, OUTCOMES == 1, OUTCOMES == 2], [0.0, 0.412, np.inf], np.nan)
    factor = np.where(OUTCOMES == 2, 0.5, np.where(OUTCOMES == 1, 1.7, np.inf))
    factor[..., 2] = np.nan
    applicable = np.ones(OUTCOMES.shape, dtype=np.int8)
    applicable[:, 2, :2] = 0
    cube, restitution = ("record", "block", "model"), ("block",)
    c = np.array([0.985, 0.93, 0.79])
    if cases is not None:
        restitution, cube = ("block", "case"), (*cube, "case")
        c = np.stack([c, *(c - 0.1 * k for k in range(1, cases))], axis=1)
        c[0] = 0.9
        peak, factor, applicable, outcome = (
            np.repeat(array[..., None], cases, axis=-1) for array in (peak, factor, applicable, OUTCOMES)
        )
    else:
        outcome = OUTCOMES.copy()
    of_records = {
        "source": ["CCC.RAW", "CCC.RAW", "weak.txt"],
        "source_sha256": ["0" * 64, "0" * 64, "1" * 64],
        "event": ["Ridgecrest", "Ridgecrest", "unknown"],
        "station": ["CCC", "CCC", ""],
        "component": ["90 Deg", "360 Deg", ""],
        "azimuth": [90.0, 0.0, np.nan],
        "start_time": ["2019-07-06T03:19:53", "2019-07-06T03:19:53", ""],
        "npts": [35430, 35402, 100],
        "dt": [0.01, 0.01, 0.02],
        "pga": [5.5574, 4.619, 0.01],
        "pgv": [0.71, 0.43, 0.002],
        "pgv_drift": [0, 1, 0],
        "arias_intensity": [5.2, 3.1, 0.0],
        "intense_start": [10.0, 11.0, 0.1],
        "intense_end": [22.0, 24.0, 1.9],
        "main_impulse": [0.62, 0.35, np.nan],
        "secondary_impulse": [0.11, 0.08, np.nan],
        "secondary_interval": [0.12, 0.11, np.nan],
        "sequence_duration": [12.0, 13.0, np.nan],
        "main_count": [5, -1, 0],
        "half_wave_count": [88, 91, 2],
        "warnings": ["mean removed\ndirection unknown; check it", "", ""],
        "warning_codes": ["plain plain", "", ""],
        "processing": ["baseline: mean", "", ""],
    }
    of_blocks = {
        "width": [0.25, 1.0, np.nan],
        "height": [2.2, 7.0, np.nan],
        "radius": [1.107, 3.536, 1.2],
        "alpha_c": [0.113, 0.142, 0.38],
        "p": [2.58, 1.44, 2.6],
        "gravity": [9.80665, 9.80665, 10.816],
        "slenderness": [8.8, 7.0, 2.5],
        "critical_impulse": [0.43, 0.98, 1.54],
        "block_warnings": ["", "", "slenderness 2.5 is below 3"],
    }
    pairs = {
        "uplift_ratio": np.full((3, 3), 2.5),
        "velocity_ratio": np.full((3, 3), 1.5),
        "impulse_ratio": [[1.44, 0.63, 0.4]] * 2 + [[np.nan] * 3],
    }
    answers = {
        "peak_rotation_ratio": peak,
        "outcome": outcome,
        "reason": np.where(outcome == 3, 2, 0),
        "safety_factor": factor,
        "applicable": applicable,
    }
    along = {("record",): of_records, ("block",): of_blocks, ("record", "block"): pairs, cube: answers}
    along[restitution] = along.get(restitution, {}) | {"restitution": c}
    variables = {
        name: SUMMARY[name].variable(values, dims) for dims, own in along.items() for name, values in own.items()
    }
    axes = {"record": RECORDS, "block": BLOCKS, "model": MODELS}
    summary = xr.Dataset(variables, {name: SUMMARY[name].variable(values) for name, values in axes.items()})
    summary = completed(summary)
    failures = failure_table(
        [
            Failure("CCC.RAW", "select", "vertical channel 2", "vertical"),
            Failure("notes.txt", "find", "no record", "skipped"),
            Failure("cut.AT2", "read", "cut.AT2:4: expected 100 samples, found 3", "failed"),
        ]
    )
    empty = xr.Dataset({"row_size": ASSESSMENT_GROUPS["/records"]["row_size"].variable([])})
    root = xr.Dataset(attrs={"title": "Borgo", "configuration": CONFIGURATION})
    return xr.DataTree.from_dict({"/": root, "/summary": summary, "/failures": failures, "/records": empty})


def small_tree(title="Borgo"):
    """A tree of another kind with two variables, which takes a tenth of the time to save."""
    described = {"units": "1", "long_name": "x"}
    site = xr.Dataset({"x": ("y", [1.0, 2.0], described), "word": ("y", np.array(["a", "b"], dtype="U9"), described)})
    tree = xr.DataTree.from_dict({"/site": site})
    tree.attrs |= {"kind": "site calibration", "title": title}
    return tree


@cache
def results_bytes():
    """The file of the tree, saved once and for all tests."""
    from rockpulse.storage.hdf5.results_file import save

    tree = results_tree()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.h5"
        save(tree, path)
        return path.read_bytes()
