"""A small tree with the layout of :func:`rockpulse.assess`, with chosen results."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from rockpulse.storage.variables.summary import SUMMARY

RECORDS = ["CI.CCC..HNE@20190706T031953", "CI.CCC..HNN@20190706T031953", "weak.1"]
BLOCKS = ["boundary wall", "column", "cabinet"]
MODELS = ["resonance", "sequence", "nonlinear"]
REASONS = "none impact_limit free_flight half_cycle_limit"
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
    record, block, model = np.array(RECORDS), np.array(BLOCKS), np.array(MODELS)
    peak = np.select([OUTCOMES == 0, OUTCOMES == 1, OUTCOMES == 2], [0.0, 0.412, np.inf], np.nan)
    factor = np.where(OUTCOMES == 2, 0.5, np.where(OUTCOMES == 1, 1.7, np.inf))
    factor[..., 2] = np.nan
    applicable = np.ones(OUTCOMES.shape, dtype=np.int8)
    applicable[:, 2, :2] = 0
    shape = ("record", "block", "model")
    pair, cube, restitution = ("record", "block"), shape, ("block",)
    c = np.array([0.985, 0.93, 0.79])
    if cases is not None:
        restitution, cube = ("block", "case"), (*shape, "case")
        c = np.stack([c, *(c - 0.1 * k for k in range(1, cases))], axis=1)
        c[0] = 0.9
        peak, factor, applicable, outcome = (
            np.repeat(array[..., None], cases, axis=-1) for array in (peak, factor, applicable, OUTCOMES)
        )
    else:
        outcome = OUTCOMES.copy()
    reason = np.where(outcome == 3, 2, 0).astype(np.int8)

    def made(dims, values, units, long_name, **attrs):
        return xr.Variable(dims, np.asarray(values), {"units": units, "long_name": long_name, **attrs})

    flags = {"flag_values": np.arange(4, dtype=np.int8), "flag_meanings": "at_rest rocks overturns unresolved"}
    binary = {"flag_values": np.arange(2, dtype=np.int8), "flag_meanings": "no yes"}
    drift = {"flag_values": np.arange(2, dtype=np.int8), "flag_meanings": "reliable drift"}
    summary = xr.Dataset(
        {
            "source": made("record", ["CCC.RAW", "CCC.RAW", "weak.txt"], "1", "file"),
            "source_sha256": made("record", ["0" * 64, "0" * 64, "1" * 64], "1", "SHA-256 of the file"),
            "event": made("record", ["Ridgecrest", "Ridgecrest", "unknown"], "1", "earthquake"),
            "station": made("record", ["CCC", "CCC", ""], "1", "station"),
            "component": made("record", ["90 Deg", "360 Deg", ""], "1", "component"),
            "azimuth": made("record", [90.0, 0.0, np.nan], "degrees", "azimuth"),
            "start_time": made("record", ["2019-07-06T03:19:53", "2019-07-06T03:19:53", ""], "1", "time"),
            "npts": made("record", [35430, 35402, 100], "1", "samples"),
            "dt": made("record", [0.01, 0.01, 0.02], "s", "sampling interval"),
            "pga": made("record", [5.5574, 4.619, 0.01], "m/s2", "peak ground acceleration"),
            "pgv": made("record", [0.71, 0.43, 0.002], "m/s", "peak ground velocity"),
            "pgv_drift": made("record", np.array([0, 1, 0], dtype=np.int8), "1", "PGV is drift", **drift),
            "arias_intensity": made("record", [5.2, 3.1, 0.0], "m/s", "Arias intensity"),
            "intense_start": made("record", [10.0, 11.0, 0.1], "s", "start of the intense phase"),
            "intense_end": made("record", [22.0, 24.0, 1.9], "s", "end of the intense phase"),
            "main_impulse": made("record", [0.62, 0.35, np.nan], "m/s", "main impulse"),
            "secondary_impulse": made("record", [0.11, 0.08, np.nan], "m/s", "secondary impulse"),
            "secondary_interval": made("record", [0.12, 0.11, np.nan], "s", "interval"),
            "sequence_duration": made("record", [12.0, 13.0, np.nan], "s", "duration"),
            "main_count": made("record", [5, -1, 0], "1", "number of main impulses, -1 unlimited"),
            "half_wave_count": made("record", [88, 91, 2], "1", "half-waves of the whole record"),
            "warnings": made("record", ["mean removed\ndirection unknown; check it", "", ""], "1", "warnings"),
            "warning_codes": made("record", ["plain plain", "", ""], "1", "codes of the warnings"),
            "processing": made("record", ["baseline: mean", "", ""], "1", "processing"),
            "vertical_channel": made("record", ["", "", ""], "1", "vertical channel that acts too"),
            "width": made("block", [0.25, 1.0, np.nan], "m", "full width"),
            "height": made("block", [2.2, 7.0, np.nan], "m", "full height"),
            "radius": made("block", [1.107, 3.536, 1.2], "m", "half the diagonal R"),
            "alpha_c": made("block", [0.113, 0.142, 0.38], "rad", "critical angle"),
            "p": made("block", [2.58, 1.44, 2.6], "1/s", "frequency parameter"),
            "gravity": made("block", [9.80665, 9.80665, 10.816], "m/s2", "acceleration of gravity"),
            "slenderness": made("block", [8.8, 7.0, 2.5], "1", "slenderness"),
            "restitution": made(restitution, c, "1", "velocity ratio of an impact"),
            "critical_impulse": made("block", [0.43, 0.98, 1.54], "m/s", "critical impulse"),
            "block_warnings": made("block", ["", "", "slenderness 2.5 is below 3"], "1", "warnings"),
            "uplift_ratio": made(pair, np.full((3, 3), 2.5), "1", "PGA over uplift"),
            "velocity_ratio": made(pair, np.full((3, 3), 1.5), "1", "p PGV/(g tan alpha)"),
            "impulse_ratio": made(pair, [[1.44, 0.63, 0.4]] * 2 + [[np.nan] * 3], "1", "I/I_1c"),
            "peak_rotation_ratio": made(cube, peak, "1", "peak rotation"),
            "outcome": made(cube, outcome, "1", "outcome", **flags),
            "reason": made(cube, reason, "1", "reason", flag_values=flags["flag_values"], flag_meanings=REASONS),
            "safety_factor": made(cube, factor, "1", "safety factor"),
            "applicable": made(cube, applicable, "1", "applicable", **binary),
        },
        coords={
            "record": made("record", record, "1", "record id"),
            "block": made("block", block, "1", "block name"),
            "model": made("model", model, "1", "model"),
        },
    )
    summary = completed(summary)
    failures = xr.Dataset(
        {
            name: made("failure", values, "1", name)
            for name, values in {
                "file": ["CCC.RAW", "notes.txt", "cut.AT2"],
                "stage": ["select", "find", "read"],
                "reason": ["vertical channel 2", "no record", "cut.AT2:4: expected 100 samples, found 3"],
                "kind": ["vertical", "skipped", "failed"],
                "remedy": ["", "", ""],
            }.items()
        }
    )
    empty = xr.Dataset({"row_size": made("record", np.array([], dtype=np.int64), "1", "samples of each record")})
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
def results_bytes(title="Borgo"):
    """The file of the tree, saved once and for all tests."""
    from rockpulse.storage.hdf5.results_file import save

    tree = results_tree()
    tree.attrs["title"] = title
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "results.h5"
        save(tree, path)
        return path.read_bytes()
