"""docs/schema.md against the files: every variable is named, and the examples run."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from make_schema import KINDS, TABLE, with_tables

import rockpulse as rp
from rockpulse import BlockSettings, DemandSettings, ModelSettings, RecordSettings, SearchSettings, UncertaintySettings
from rockpulse.assessment.tree import EVENT
from rockpulse.warning_text import WARNINGS
from synthetic import synthetic_motion

SCHEMA = (Path(__file__).parents[1] / "docs" / "schema.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", SCHEMA, re.DOTALL)

WALL = BlockSettings(name="wall", width=0.3, height=2.4, restitution=(0.95, 0.9))
CHEST = BlockSettings(name="chest", width=1.0, height=2.2)


def channel(azimuth, station="STA"):
    samples = synthetic_motion(seed=int(azimuth) + 1, duration=2.0, pga=4.0)
    return rp.Record(
        samples, dt=0.01, id=f"XX.{station}..{azimuth:g}", station=station, azimuth=azimuth, processed=True
    )


@cache
def assessed(components="horizontal", blocks=(WALL, CHEST)):
    """Everything that an assessment may hold; to be left as it is."""
    config = rp.Config(
        records=RecordSettings(components=components, azimuth_step=60.0),
        models=ModelSettings(use=("sequence", "nonlinear"), histories=True),
        search=SearchSettings(intervals=True, points=16),
        uncertainty=UncertaintySettings(azimuth=components == "sweep", spectrum="all"),
        bodies=blocks,
        demands=(DemandSettings(name="collapse", value=2.5),),
    )
    return rp.assess([channel(0.0), channel(90.0)], config)


def test_the_tables_of_the_page_are_the_declarations():
    assert with_tables(SCHEMA) == SCHEMA, "docs/schema.md is not what the declarations say: make schema"
    shown = [(kind, group) for _, kind, group, _ in TABLE.findall(SCHEMA)]
    every = [(kind, "") for kind in KINDS if kind != "assessment"]
    assert sorted(shown) == sorted([*every, *(("assessment", group) for group in KINDS["assessment"])])


def test_every_code_of_a_warning_is_named():
    elsewhere = {"vertical_acceleration", "scaled_far", "scaled_to_drift"}  # processing, site files
    named = {code for code in WARNINGS if f"`{code}`" in SCHEMA or f"`{code}/`" in SCHEMA}
    assert named == set(WARNINGS) - elsewhere


@pytest.mark.parametrize("components", ["horizontal", pytest.param("sweep", marks=pytest.mark.sweep)])
def test_an_assessment_holds_what_is_declared_and_nothing_else(components):
    tree = assessed(components)
    groups = {path: declared for path, declared in KINDS["assessment"].items() if path != "/directions"}
    if components == "sweep":
        axes = {name: KINDS["assessment"]["/summary"][name] for name in ("block", "model")}
        groups["/directions"] = {**KINDS["assessment"]["/directions"], **axes}
    assert {node.path for node in tree.subtree} == {"/", *groups}
    for path, declared in groups.items():
        stored = tree[path].to_dataset(inherit=False).variables
        assert set(stored) == {name for name, one in declared.items() if "tie" not in one.dims}, path
        for name, variable in stored.items():
            assert variable.dims == declared[name].dims, (path, name)
            assert variable.attrs["units"] == declared[name].units
            assert variable.attrs["long_name"] == declared[name].long_name
    table = SCHEMA.split("## /summary")[0]
    assert all(f"`{path}`" in table for path in groups)
    # The order that the lines of MATLAB reverse; those of one restitution have no cases.
    assert tree["summary"]["outcome"].dims == ("record", "block", "case", "model")


def test_every_variable_is_taken_from_a_record_or_from_the_bodies():
    for group in ("/summary", "/half_cycles", "/overturning_intervals", "/records"):
        for name, variable in KINDS["assessment"][group].items():
            assert variable.take is not None or f"{group}/{name}" == EVENT, name


#: Units that pint does not define, or that another variable states.
OTHER_UNITS = {"degrees_north", "degrees_east", "see measure_units"}


def test_units_are_written_so_that_cf_units_and_pint_read_them():
    found = {one.units for groups in KINDS.values() for declared in groups.values() for one in declared.values()}
    word = r"[A-Za-z]+(\^-?[1-9])?"
    assert {unit for unit in found if unit != "1" and not re.fullmatch(f"{word}( {word})*", unit)} == OTHER_UNITS


@pytest.mark.sweep
def test_every_attribute_of_the_root_is_named(golden):
    text = SCHEMA.split("## /half_cycles")[0] + SCHEMA.split("## Versions, checksums")[1]
    for name in rp.load(golden.results).attrs:
        assert f"`{name}`" in text or re.fullmatch(r"(numpy|numba|scipy|xarray|h5netcdf|h5py|obspy)_version", name), (
            name
        )


@pytest.mark.sweep
def test_the_examples_run(tmp_path, monkeypatch):
    tree = assessed(blocks=(replace(WALL, restitution=0.95), CHEST))
    rp.save(tree, tmp_path / "results.h5")
    monkeypatch.chdir(tmp_path)
    of_rockpulse, of_xarray, of_h5py = ({}, {}, {})
    for number, names in enumerate((of_rockpulse, of_xarray, of_h5py)):
        exec(compile(EXAMPLES[number], f"example {number}", "exec"), names)
    summary = tree["summary"]
    assert summary["outcome"].dims == ("record", "block", "model")
    overturned = int((summary["outcome"] == 2).sum())
    assert of_rockpulse["peaks"].shape == (2, 2)
    assert len(of_rockpulse["worst"]) == 4
    assert set(of_rockpulse["cycles"]["model"]) == {"sequence"}
    assert len(of_rockpulse["fallen"]) == overturned
    assert of_xarray["overturned"].sum().item() == overturned
    assert of_xarray["units"]["pga"] == "m s^-2"
    assert np.array_equal(of_h5py["factor"], summary["safety_factor"].sel(model="nonlinear"))
    assert of_h5py["words"][2] == "overturns"
    assert np.abs(of_h5py["second"]).max() == pytest.approx(summary["pga"].values[1])
    assert of_h5py["time"].size == of_h5py["second"].size
    assert 0 < of_h5py["peak"].size < of_h5py["cycles"]["peak"].size if of_h5py["cycles"] else of_h5py["peak"].size > 0
