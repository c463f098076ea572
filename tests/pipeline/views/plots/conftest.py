"""Results of the shipped samples, small enough to be made once for all pictures."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from nominal import Config, ida

import rockpulse as rp
from rockpulse import ModelSettings, SearchSettings

BLOCKS = {
    "wall": rp.models.Block(half_width=0.125, half_height=1.1),
    "column of $one$ piece": rp.models.Block(half_width=0.55, half_height=4.0),
}


@pytest.fixture(scope="session")
def clc(ridgecrest):
    """The two horizontal channels of China Lake, 50 s of them."""
    channels = [channel for channel in ridgecrest if channel.station == "CLC" and "Up" not in channel.id]
    return [replace(channel, acceleration=channel.acceleration[22_000:27_000]) for channel in channels]


@pytest.fixture(scope="session")
def config():
    """A search of a few factors."""
    return Config(search=SearchSettings(points=16, step=1.1))


@pytest.fixture(scope="session")
def assessed(clc, config):
    """Both channels on a wall that overturns and a column that rocks."""
    return rp.assess(clc, config, blocks=BLOCKS)


@pytest.fixture(scope="session")
def with_histories(clc, config):
    """One channel with its histories."""
    stored = ModelSettings(use=("nonlinear", "linear"), histories=True)
    return rp.assess(clc[:1], replace(config, models=stored, search=SearchSettings(models=())), blocks=BLOCKS)


@pytest.fixture(scope="session")
def changed(assessed):
    """A copy of the results with other groups or variables of /summary."""

    def change(groups=(), **variables):
        parts = {node.path: node.to_dataset() for node in assessed.subtree} | dict(groups)
        summary = parts["/summary"].copy(deep=True)
        parts["/summary"] = summary.assign({name: summary[name].copy(data=data) for name, data in variables.items()})
        tree = xr.DataTree.from_dict(parts)
        tree.attrs = dict(assessed.attrs)
        return tree

    return change


@pytest.fixture(scope="session")
def study4():
    return rp.study.figure4(impulse_ratios=[0.1, 0.4, 1.0], secondary_ratios=np.linspace(0.0, 1.0, 11), counts=[2])


@pytest.fixture(scope="session")
def study5():
    return rp.study.figure5(intervals=[0.5])


@pytest.fixture(scope="session")
def fragility_tree(clc):
    settings = Config(
        search=SearchSettings(points=16),
        fragility=ida(limit_states=("uplift", 0.4, "overturning"), measures=("pga", "velocity_ratio")),
    )
    return rp.fragility_curves(clc, settings, blocks={"wall": BLOCKS["wall"]})


@pytest.fixture(scope="session")
def work_precision_rows():
    """Errors below the floor, and two tolerances of about the same error and cost."""
    rows = pd.DataFrame(
        {
            "equation": "nonlinear",
            "method": ["reference", "rockpulse", "RK45", "RK45", "RK45"],
            "option": ["perturbation", "step", "rtol", "rtol", "rtol"],
            "setting": [1e-13, 0.08, 1e-3, 1e-6, 1e-9],
            "call": ["lanes", "lanes", "single", "single", "single"],
            "cases": 6,
            "median": [1e-12, 4e-18, 4e-4, 2e-4, 2e-7],
            "p90": [1e-10, 3e-13, 2e-3, 1e-3, 1e-6],
            "ns_per_active_sample": [np.nan, 60.0, 7.5e4, 1.5e5, 5.5e5],
        }
    )
    return pd.concat([rows, rows.assign(equation="linear")])
