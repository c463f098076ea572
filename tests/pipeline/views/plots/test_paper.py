"""Figures 4 and 5 of the paper show what its text says of them."""

import numpy as np
import pytest

from rockpulse.errors import ResultsError
from rockpulse.views.plots.paper import figure4, figure5


def curves(ax):
    return [line for line in ax.lines if line.get_label() and not line.get_label().startswith("_")]


def test_figure_4_has_a_panel_for_each_restitution_and_a_curve_for_each_impulse(study4):
    panels = figure4(study4, spacing="end", count=2)
    assert [ax.get_title(loc="left") for ax in panels] == ["(a) $C$ = 0.9", "(b) $C$ = 0.6"]
    own = study4["figure4"].to_dataset().sel(spacing="end", intermediate_count=2).isel(p=0)
    for ax, c in zip(panels, (0.9, 0.6), strict=True):
        assert [line.get_label() for line in curves(ax)] == ["0.1", "0.4", "1"]
        for line, ratio in zip(curves(ax), (0.1, 0.4, 1.0), strict=True):
            peak = own["peak_rotation_ratio"].sel(restitution=c, impulse_ratio=ratio).values
            assert np.array_equal(line.get_ydata(), np.where(np.isfinite(peak), peak, np.nan), equal_nan=True)
            assert line.get_xdata().tolist() == own["secondary_ratio"].values.tolist()
        begins = [line.get_xydata()[0].tolist() for line in ax.lines if line.get_marker() == "o"]
        stands = [line.get_xydata()[np.isfinite(line.get_ydata())] for line in curves(ax)]
        assert begins == [drawn[0].tolist() for drawn in stands if len(drawn) and drawn[0, 0] > 0.0]
        box = ax.patches[0].get_bbox()
        assert (box.x0, box.x1) == (0.3, 0.7)  # the range of the paper
        assert 1.0 in [line.get_ydata()[0] for line in ax.lines if line.get_linestyle() == "--"]
    assert panels[0].get_xlabel() == "$I_s/I$, secondary over main impulse [-]"
    assert panels[0].get_xlim() == (0.0, 1.0)
    assert panels[0].get_ylim() == (0.0, 1.05)
    assert panels[0].get_ylabel() == r"largest $\theta/\alpha_c$ under the limited input [-]"
    assert panels[-1].get_legend().get_title().get_text() == "$I/I_{1c}$"


def test_figure_4_leaves_out_what_is_no_motion_and_says_so(study4):
    panels = figure4(study4, spacing="start", count=2)
    own = study4["figure4"].to_dataset().sel(spacing="start", intermediate_count=2).isel(p=0)
    empty = own["no_motion"].sel(restitution=0.6, impulse_ratio=0.4).values == 1
    assert empty.any()
    assert np.all(np.isnan(curves(panels[1])[1].get_ydata()[empty]))
    assert "Gaps" in panels[0].figure.get_supxlabel()
    assert "Gaps" not in figure4(study4, spacing="end", count=2)[0].figure.get_supxlabel()


def test_figure_4_knows_its_counts(study4):
    with pytest.raises(ResultsError, match="expected one of 2, got inf"):
        figure4(study4)


@pytest.fixture(scope="module")
def histories(study5):
    return figure5(study5, spacing="end")


def test_figure_5_has_the_blocks_beside_and_the_restitutions_below_each_other(histories):
    panels = histories
    assert panels.shape == (2, 2)
    titles = [ax.get_title(loc="left") for ax in panels.flat]
    assert [words[:5] for words in titles] == ["(a) A", "(b) B", "(c) A", "(d) B"]
    assert ["$C$ = 0.9" in words for words in titles] == [True, True, False, False]
    assert all("m/s" in words for words in titles)
    assert "Blocks (width x height): A 1 x 3.87 m, B 1 x 7.94 m." in panels[0, 0].figure.get_supxlabel()
    assert panels[1, 0].get_xlabel() == "time from the first main impulse [s]"
    assert panels[0, 0].get_ylabel() == r"$\theta/\alpha_c$ [-]"


def test_figure_5_draws_the_histories_and_marks_overturning(study5, histories):
    panels = histories
    own = study5["figure5"].to_dataset().sel(spacing="end")
    for i, c in enumerate((0.9, 0.6)):
        for j, block in enumerate("AB"):
            lane = own.sel(restitution=c, block=block)
            lines = curves(panels[i, j])
            assert [line.get_label() for line in lines] == ["0", "0.3", "0.5", "0.7"]
            assert np.nanmax(lines[3].get_ydata()) == np.nanmax(lane["rotation_ratio"].isel(secondary_ratio=3))
            crosses = [line for line in panels[i, j].lines if line.get_marker() == "X"]
            gone = (lane["outcome"].values == 2) & np.isnan(lane["rotation_ratio"].values[:, -1])
            assert len(crosses) == np.count_nonzero(gone)
            for line, rotation in zip(lines, lane["rotation_ratio"].values, strict=True):
                assert np.interp(line.get_xdata(), own["time"], np.arange(own.sizes["time"])) % 1.0 == pytest.approx(
                    0.0
                )
                seen = np.isfinite(line.get_ydata())
                at = np.searchsorted(own["time"].values, line.get_xdata()[seen])
                assert np.array_equal(line.get_ydata()[seen], rotation[at])
            ends = [line.get_xydata()[np.isfinite(line.get_ydata())][-1] for line in lines]
            for cross in crosses:
                assert np.min(np.abs(np.array(ends) - cross.get_xydata()[0]).max(axis=1)) < 0.02
            assert {line.get_ydata()[0] for line in panels[i, j].lines if len(set(line.get_ydata())) == 1} >= {
                -1.0,
                1.0,
            }
    assert panels[0, 0].get_ylim() == (-1.1, 1.1)
    assert panels[0, 0].get_xlim() == (0.0, float(own["time"][-1])) == (0.0, 20.0)


def test_an_unknown_spacing_is_refused_with_the_nearest(study5):
    with pytest.raises(ResultsError, match='did you mean "end"'):
        figure5(study5, spacing="ends")
