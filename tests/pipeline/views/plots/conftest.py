"""Results of the shipped samples, small enough to be made once for all pictures."""

from dataclasses import replace

import pytest
import xarray as xr
from nominal import Config, ida

import rockpulse as rp
from rockpulse import ModelSettings, SearchSettings

BLOCKS = {"wall": rp.models.Block(0.25, 2.2), "column of $one$ piece": rp.models.Block(1.1, 8.0)}


@pytest.fixture(scope="session")
def clc(ridgecrest):
    """The two horizontal channels of China Lake, 8 s of them."""
    channels = [channel for channel in ridgecrest if channel.station == "CLC" and "Up" not in channel.id]
    return [replace(channel, acceleration=channel.acceleration[22_600:23_400]) for channel in channels]


@pytest.fixture(scope="session")
def config():
    """A search of a few factors."""
    return Config(search=SearchSettings(points=16, step=1.1))


@pytest.fixture(scope="session")
def assessed(clc, config):
    """Both channels on a wall that overturns and a column that rocks."""
    return rp.assess(clc, config, bodies=BLOCKS)


@pytest.fixture(scope="session")
def with_histories(clc, config):
    """One channel with its histories."""
    stored = ModelSettings(use=("nonlinear", "linear"), histories=True)
    return rp.assess(clc[:1], replace(config, models=stored, search=SearchSettings(models=())), bodies=BLOCKS)


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
def fragility_tree(clc):
    settings = Config(
        search=SearchSettings(points=16),
        fragility=ida(limit_states=("uplift", 0.4, "overturning"), measures=("pga", "velocity_ratio")),
    )
    return rp.fragility(clc, settings, bodies={"wall": BLOCKS["wall"]})


@pytest.fixture(scope="session")
def first(assessed):
    return str(assessed["summary"]["record"].values[0])
