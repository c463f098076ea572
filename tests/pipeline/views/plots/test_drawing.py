"""`rockpulse.plot` draws whatever it is given, with its numbers, and says what it takes of anything else."""

import numpy as np
import pytest
import xarray as xr
from drawn import small_print
from matplotlib.figure import Figure
from results_tree import results_bytes

import rockpulse as rp
from rocking import Block, ImpulseSequence, Response
from rockpulse.errors import ResultsError
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from rockpulse.views.plots.objects import block_outlines, half_wave_impulses, response, two_half_cycles

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
def test_every_public_object_is_drawn_on_given_axes(record):
    response = rp.models.recorded_response(BLOCK, record.acceleration, record.dt, history=True)
    spectrum = rp.overturning_spectrum(record, p=[1.8, 2.2], restitution=[0.9, 0.95])
    for what, panels, more in (
        *((one, 1, {}) for one in (rp.half_waves(record), SEQUENCE, response, BLOCK, spectrum)),
        (rp.models.Block(width=[0.3, 0.4], height=2.0, log=False), 2, {}),
        (SEQUENCE, 2, {"block": BLOCK}),
        (record, 3, {}),
    ):
        figure = Figure()
        axes = figure.subplots(panels, squeeze=False)
        assert rp.plot(what, axes=axes, **more) is figure
        assert all(ax.lines or ax.patches or ax.collections for ax in axes.ravel())


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


def lines(ax):
    """(k, 2) places and heights of all upright lines of the picture."""
    found = [segment for one in ax.collections for segment in one.get_segments()]
    return np.array([(segment[1][0], segment[1][1]) for segment in found])


def of(outcome, peak, **history):
    nothing = np.full(np.shape(outcome), -1)
    return Response(peak, outcome, nothing, nothing * np.nan, nothing, nothing, **history)


def test_half_waves_are_lines_at_their_centroids():
    waves = half_waves(Record([0.0, 3.0, -3.0, 0.0, 1.0, 0.0], dt=0.1, id="three $triangles$"))
    ax = half_wave_impulses(waves)
    drawn = lines(ax)
    drawn = drawn[np.argsort(drawn[:, 0])]
    assert drawn[:, 0] == pytest.approx(waves.centroid)
    assert drawn[:, 1] == pytest.approx(waves.impulse)
    assert [len(one.get_segments()) for one in ax.collections] == [1, 2]  # weak, strong


def test_a_sequence_is_drawn_with_its_sizes():
    drawn = lines(two_half_cycles(ImpulseSequence(0.8, 0.2, 0.1, 20.0, intermediate_count=2)))
    assert drawn.tolist() == [[0.0, 0.8], [2.0, -0.8], [1.0, -0.2], [2.0, 0.2], [3.0, 0.2], [4.0, -0.2]]
    ax = two_half_cycles(ImpulseSequence(0.8, 0.2, np.nan, 20.0, spacing="continuous"))
    assert len(ax.collections) == 2
    assert ax.collections[1].get_paths()[0].get_extents().height == pytest.approx(0.4)
    assert "depends on the block" in small_print(ax)


def test_blocks_are_drawn_side_by_side_and_peaks_are_bars():
    panels = block_outlines(Block(width=np.linspace(0.2, 0.5, 12), height=2.0))
    assert len([ax for ax in panels if ax.get_visible()]) == 8
    assert [text.get_text() for text in panels[0].texts] == ["2 m", "0.2 m"]
    ax = response(of(np.arange(4), np.array([0.0, 0.4, np.inf, np.nan])))
    heights = {bars.get_label(): [bar.get_height() for bar in bars] for bars in ax.containers}
    assert heights == {"at rest": [0.01], "rocks": [0.4], "overturns": [1.2], "unresolved": [0.01]}


def test_of_many_histories_six_are_drawn():
    time, rotation = np.arange(5.0), np.arange(40.0).reshape(2, 4, 5)
    ax = response(of(np.ones((2, 4), dtype=int), np.full((2, 4), 0.3), time=time, rotation=rotation, velocity=rotation))
    assert [line.get_ydata().tolist() for line in ax.lines[1:]] == [row.tolist() for row in rotation.reshape(8, 5)[:6]]
    assert "first 6 of 8 bodies" in small_print(ax)
    time = np.linspace(0.0, 300.0, 3001)
    rotation = np.where((time > 200.0) & (time < 210.0), 0.05 * np.sin(time), 0.0)
    ax = response(of(np.array(1), np.array(0.3), time=time, rotation=rotation, velocity=rotation))
    low, high = ax.get_xlim()
    assert 195.0 < low < 200.2
    assert 209.8 < high < 215.0
    assert np.nanmax(ax.lines[-1].get_ydata()) == rotation.max()
