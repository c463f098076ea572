"""Files of schema 1.0, which version 0.1.0 wrote: what they do not hold is worked out, or said to be unknown."""

import shutil

import h5py
import numpy as np
import pytest
import xarray as xr
from results_tree import results_tree

import rockpulse as rp
from rockpulse.config.configuration import Config
from rockpulse.config.settings import ModelSettings
from rockpulse.models import Block, ImpulseSequence
from rockpulse.storage.hdf5.results_file import SCHEMA_VERSION, load, open_results, save
from rockpulse.storage.variables import NOT_KNOWN
from rockpulse.views.diff.differences import compare_results


def test_codes_that_a_file_of_before_lacks_are_found_in_its_texts(tmp_path):
    tree = results_tree()
    summary = tree["summary"].to_dataset().drop_vars(["warning_codes", "vertical_channel"])
    drift = "vertical channel: baseline drift: the ground velocity ends at 1.08 m/s, the PGV of 1.08 m/s may be off by "
    drift += "as much; compare with another baseline or a high-pass"
    dead = "all samples are zero: a dead channel"
    summary["warnings"].values = np.array([f"another\n{drift}", "", dead])
    summary["processing"].values = np.array(["baseline: mean\nvertical acceleration: CI.CLC..Up", "baseline: mean", ""])
    tree["summary"] = xr.DataTree(summary)
    save(tree, tmp_path / "before.h5")
    with open_results(tmp_path / "before.h5") as file:
        for found in (file.dataset("summary"), load(tmp_path / "before.h5")["summary"].to_dataset()):
            assert found["warning_codes"].values.tolist() == ["plain of_vertical/baseline_drift", "", "dead_channel"]
            assert found["vertical_channel"].values.tolist() == ["CI.CLC..Up", "", ""]


def _of_schema_1_0(path, spacing, blocks, use=("resonance", "sequence"), **sequence):
    """Results as version 0.1.0 wrote them: without gravity and spacing, the latter not always in the configuration."""
    given = {"main": 0.35, "secondary": 0.12, "interval": 0.15, "duration": 12.0, "main_count": 4}
    tree = rp.assess_sequence(
        ImpulseSequence(**(given | sequence), spacing=spacing), Config(models=ModelSettings(use=use)), blocks
    )
    text = str(tree.attrs["configuration"])
    tree.attrs["configuration"] = text.replace(f'spacing = "{spacing}"', 'spacing = "end"')
    summary = tree["summary"].to_dataset()
    tree["summary"].dataset = summary.drop_vars(["gravity", "spacing"])
    save(tree, path)
    with h5py.File(path, "a") as file:
        file.attrs["schema_version"] = "1.0"
    return summary


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    """One wall's results of schema 1.0."""
    path = tmp_path_factory.mktemp("schema_1_0") / "results.h5"
    _of_schema_1_0(path, "end", {"wall": Block(0.15, 1.5)})
    return path


@pytest.fixture
def path(written, tmp_path):
    """A copy of them to change."""
    return shutil.copy(written, tmp_path / "results.h5")


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("spacing", "restitution"), [("end", [0.85, 0.9]), ("middle", "housner"), ("continuous", [0.85, 0.9])]
)
def test_gravity_and_spacing_of_schema_1_0_are_worked_out(tmp_path, spacing, restitution):
    blocks = {
        "wall": Block(0.15, 1.5, restitution=restitution, gravity=9.81),
        "statue": Block.from_parameters(2.385, 0.2445, restitution=restitution, gravity=9.81),
    }
    expected = _of_schema_1_0(tmp_path / "results.h5", spacing, blocks)
    found = load(tmp_path / "results.h5")["summary"].to_dataset()
    assert found["gravity"].values.tolist() == [9.81, 9.81]
    for name in ("gravity", "spacing"):
        xr.testing.assert_identical(found[name].variable, expected[name].variable)
    words = found["spacing"].attrs["flag_meanings"].split()
    assert words[int(found["spacing"].item()) + 1] == spacing
    save(load(tmp_path / "results.h5"), tmp_path / "again.h5")
    with h5py.File(tmp_path / "again.h5") as file:
        assert file.attrs["schema_version"] == SCHEMA_VERSION


def test_half_cycles_of_schema_1_0_that_fit_no_spacing_leave_it_unknown(path):
    with h5py.File(path, "a") as file:
        file["half_cycles/duration"][...] *= 1.001
    assert load(path)["summary"]["spacing"].values.tolist() == [NOT_KNOWN]


def test_without_the_sequence_model_the_spacing_of_schema_1_0_is_the_configurations(tmp_path):
    path = tmp_path / "results.h5"
    _of_schema_1_0(path, "middle", {"wall": Block(0.15, 1.5)}, use=("resonance",))
    assert load(path)["summary"]["spacing"].values.tolist() == [0]


@pytest.mark.sweep
def test_an_open_file_of_schema_1_0_holds_what_a_loaded_one_does(tmp_path):
    path = tmp_path / "results.h5"
    _of_schema_1_0(path, "middle", {"wall": Block(0.15, 1.5), "statue": Block(0.4, 2.0)})
    loaded = load(path)["summary"].to_dataset()
    with open_results(path) as opened:
        found = opened.dataset("summary")
        assert list(found.data_vars) == list(loaded.data_vars)
        for name in ("gravity", "spacing"):
            xr.testing.assert_identical(found[name].variable, loaded[name].variable)
    save(load(path), tmp_path / "again.h5")
    with open_results(path) as old, open_results(tmp_path / "again.h5") as new:
        assert compare_results(old, new).same


def test_the_half_cycles_of_schema_1_0_are_read_only_where_the_spacing_depends_on_them(tmp_path):
    for use, opened in ((("resonance",), False), (("resonance", "sequence"), True)):
        path = tmp_path / f"{len(use)}.h5"
        _of_schema_1_0(path, "end", {"wall": Block(0.15, 1.5)}, use=use)
        with open_results(path) as file:
            file.dataset("summary")
            assert ("half_cycles" in file._opened) is opened


def _without_half_cycles(file):
    del file["half_cycles"]


def _without_configuration(file):
    del file.attrs["configuration"]


def _with_torn_configuration(file):
    file.attrs["configuration"] = "[sequence\nspacing ="


def _with_another_spacing(file):
    file.attrs["configuration"] = '[sequence]\nspacing = "wide"'


def _without_impulses(file):
    del file["summary/secondary_impulse"]


@pytest.mark.parametrize(
    "harm",
    [
        _without_half_cycles,
        _without_configuration,
        _with_torn_configuration,
        _with_another_spacing,
        _without_impulses,
    ],
)
def test_what_schema_1_0_does_not_tell_leaves_the_spacing_unknown(path, harm):
    with h5py.File(path, "a") as file:
        harm(file)
    with open_results(path) as opened:
        for summary in (load(path)["summary"].to_dataset(), opened.dataset("summary")):
            assert summary["spacing"].values.tolist() == [NOT_KNOWN]
            assert summary["gravity"].values.tolist() == [Block(0.15, 1.5).gravity]


def test_gravity_of_schema_1_0_is_unknown_without_the_radius(path):
    with h5py.File(path, "a") as file:
        del file["summary/radius"]
    found = load(path)["summary"]
    assert np.isnan(found["gravity"].values).tolist() == [True]
    assert found["spacing"].values.tolist() == [NOT_KNOWN]
