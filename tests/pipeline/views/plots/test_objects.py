"""Pictures of single objects hold the numbers of the objects."""

import numpy as np
import pytest
from drawn import small_print

from rocking import Block, ImpulseSequence, Response
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import Record
from rockpulse.views.plots.objects import block_outlines, half_wave_impulses, response, two_half_cycles


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
    figure = block_outlines(Block(width=np.linspace(0.2, 0.5, 12), height=2.0))
    assert len([ax for ax in figure.axes if ax.get_visible()]) == 8
    assert [text.get_text() for text in figure.axes[0].texts] == ["2 m", "0.2 m"]
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
