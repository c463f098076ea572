"""`rockpulse.plot` draws whatever it is given, and says what it takes of anything else."""

import numpy as np
import pytest
import xarray as xr
from results_tree import results_bytes

import rockpulse as rp
from rockpulse.errors import ResultsError

SEQUENCE = rp.models.ImpulseSequence(0.7, 0.28, interval=0.1, duration=2.0)
BLOCK = rp.models.Block(width=0.25, height=2.2)


@pytest.fixture(scope="module")
def record():
    return rp.Record(3.0 * np.sin(np.arange(0.0, 20.0, 0.1)), dt=0.1, id="sine", processed=True)


@pytest.mark.sweep
def test_every_public_object_has_a_picture(record):
    response = rp.models.recorded_response(BLOCK, record.acceleration, record.dt)
    panels = [len(rp.plot(what).axes) for what in (record, rp.half_waves(record), SEQUENCE, response, BLOCK)]
    assert panels == [3, 1, 1, 1, 4]


@pytest.mark.sweep
def test_a_block_gives_a_sequence_its_times_and_spectra_are_drawn(record):
    figure = rp.plot(SEQUENCE, block=BLOCK)
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "time from the first main impulse [s]"]
    spectrum = rp.overturning_spectrum(record, restitution=[0.9])
    assert rp.plot(spectrum).axes[0].get_ylabel().startswith("effective impulse")
    with pytest.raises(TypeError, match=r"expected a dataset of rockpulse\.overturning_spectrum .* found one with pga"):
        rp.plot(xr.Dataset({"pga": 1.0}))


@pytest.mark.sweep
def test_results_are_drawn_by_their_kind(assessed, fragility_tree, tmp_path):
    assert rp.plot(assessed).axes[0].get_title() == "wall"  # without a probability its bodies
    assert rp.plot(fragility_tree).axes[0].get_ylabel().startswith("probability")
    path = tmp_path / "results.h5"
    path.write_bytes(results_bytes())
    assert rp.plot(path).axes[0].get_title() == "boundary wall"
    with pytest.raises(ResultsError, match='no kind of picture "map"'):
        rp.plot(str(path), "map")
    with pytest.raises(FileNotFoundError):
        rp.plot(tmp_path / "none.h5")


def test_what_has_no_picture_is_reported(record):
    with pytest.raises(TypeError, match=r"plot: expected a Record, HalfWaves, .* found list"):
        rp.plot([record])
    with pytest.raises(TypeError, match="a Record takes no options, found kind, case"):
        rp.plot(record, "bodies", case=2)
    with pytest.raises(TypeError, match="a Block takes no options, found block"):
        rp.plot(BLOCK, block="wall")
    with pytest.raises(TypeError, match="expected a Block, whose half-cycles give the times, found str"):
        rp.plot(SEQUENCE, block="wall")
    unknown = xr.DataTree()
    unknown.attrs["kind"] = "other"
    with pytest.raises(ResultsError, match="an other file cannot be drawn"):
        rp.plot(unknown)
