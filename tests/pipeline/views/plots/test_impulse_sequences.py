"""The limit accelerogram shows the impulses of the train at their times, and names resonance for what it is."""

import numpy as np
import pytest
from drawn import in_legend

from rockpulse import models
from rockpulse.views.plots.selection import block_of, sequence_of
from rockpulse.views.plots.site import limit_accelerogram

BLOCK = models.Block(1.0, 3.872984, restitution=0.6, gravity=9.81)


def sequence(**options):
    given = {"main": 0.3, "secondary": 0.15, "interval": 0.1, "duration": 6.0}
    return models.ImpulseSequence(**(given | options))


def marks(ax):
    """Times and sizes of the heads of the arrows."""
    drawn = [line for line in ax.lines if line.get_linestyle() == "None" and line.get_marker() in "^v"]
    return np.concatenate([line.get_xydata() for line in drawn])


@pytest.mark.parametrize("spacing", ["end", "middle", "open", "continuous"])
def test_every_impulse_is_an_arrow(spacing):
    own = sequence(spacing=spacing)
    alone, both = limit_accelerogram(BLOCK, own)
    times, impulses = models.impulse_train(BLOCK, own)
    drawn = marks(both)
    shown = times <= drawn[:, 0].max()
    expected = np.stack([times, impulses], axis=1)[shown]
    for line in both.lines:
        if line.get_marker() in ("^", "v") and line.get_linestyle() == "None" and len(line.get_ydata()):
            assert np.all((line.get_ydata() > 0.0) == (line.get_marker() == "^"))  # heads point away from zero
    assert np.allclose(drawn[np.lexsort(drawn.T)], expected[np.lexsort(expected.T)])
    assert set(np.abs(marks(alone)[:, 1])) == {own.main}


def test_main_impulses_come_with_the_half_cycles_which_are_bars_with_their_peaks():
    alone, _ = limit_accelerogram(BLOCK, sequence())
    assert "upper-bound input" in alone.get_title(loc="left")
    times = np.sort(marks(alone)[:, 0])
    duration = models.sequence_response(BLOCK, sequence(secondary=0.0)).half_cycles.duration
    assert np.allclose(np.diff(times), duration[: times.size - 1])
    assert np.all(np.diff(duration[:3]) > 0.0)  # the critical timing increases
    table = models.sequence_response(BLOCK, sequence(secondary=0.0)).half_cycles
    bars = [line.get_xdata() for line in alone.lines if line.get_marker() == "|"]
    assert np.allclose(bars, np.stack([times, times + table.duration[: times.size]], axis=1))
    peaks = [float(text.get_text()) for text in alone.texts]
    assert len(peaks) >= 3
    places = [np.argmin(np.abs(times + 0.5 * table.duration[: times.size] - text.xy[0])) for text in alone.texts]
    assert peaks == pytest.approx(table.peak[places], abs=0.0051)


def test_equal_impulses_are_told_apart_and_an_overturning_half_cycle_is_marked():
    _, both = limit_accelerogram(BLOCK, sequence(secondary=0.3))
    legend = in_legend(both)
    assert any(words.startswith("main") for words in legend)
    assert any(words.startswith("secondary") for words in legend)
    panels = limit_accelerogram(BLOCK, sequence(main=2.0 * BLOCK.critical_impulse, secondary=0.0))
    assert [line.get_marker() for line in panels[0].lines if line.get_label() == "overturning"] == ["x"]
    assert marks(panels[0])[:, 0].tolist() == [0.0]


def test_the_sequence_and_the_block_of_the_results_are_those_of_the_models(assessed, first):
    assert sequence_of(assessed, first).spacing == "end"
    assert block_of(assessed["summary"].to_dataset(), "wall").gravity == 9.80665
