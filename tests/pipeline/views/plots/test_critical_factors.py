"""Maps of overturning show every interval and window; critical scales every record, model and mark of doubt."""

import numpy as np
import pytest
import xarray as xr
from drawn import in_legend, named_rows, small_print
from matplotlib.colors import same_color
from nominal import Config
from report_cases import probable
from results_tree import demanding

import rockpulse as rp
from rockpulse import ModelSettings
from rockpulse.errors import ResultsError
from rockpulse.models import Block
from rockpulse.views.plots.critical_factors import critical_scale, overturning_map
from rockpulse.views.plots.factor_rows import ROWS
from rockpulse.views.plots.selection import table_of_pair
from rockpulse.views.plots.style import RED


def bars(ax, words):
    """(place, from, to) of the bars of one kind."""
    drawn = [bar for container in ax.containers if container.get_label() == words for bar in container]
    ends = [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in drawn]
    return sorted((round(bar.get_y() + 0.5 * bar.get_height()), *own) for bar, own in zip(drawn, ends, strict=True))


def intervals(tree, record, block):
    table = table_of_pair(tree, "overturning_intervals", record, block, "nonlinear")
    return table["lower"], table["upper"]


@pytest.mark.sweep
def test_a_map_shows_the_stored_intervals_and_the_windows_between(assessed, first, changed):
    ax = overturning_map(assessed, record=first)
    for place, block in enumerate(assessed["summary"]["block"].values):
        lower, upper = intervals(assessed, first, block)
        for words, lows, highs in (
            ("overturns", lower, upper),
            ("does not overturn above an interval", upper[:-1], lower[1:]),
        ):
            drawn = [own for at, *own in bars(ax, words) if at == place]
            assert np.ravel(drawn) == pytest.approx(np.stack([lows, highs], axis=1).ravel())
        assert bars(ax, "does not overturn")[place][2] == pytest.approx(lower[0])
    assert (ax.get_xscale(), ax.get_xlabel()) == ("log", "scale factor on the record [-]")
    assert named_rows(ax) == ["wall", r"column of \$one\$ piece"]
    assert 1.0 in [line.get_xdata()[0] for line in ax.lines]
    factor = assessed["summary"]["safety_factor"].sel(record=first, model="nonlinear").values
    assert ax.get_xlim() == pytest.approx((0.7 * min(1.0, factor.min()), 10.0))
    assert ax.get_ylim() == pytest.approx((1.6, -0.6))  # the first on top
    factor = assessed["summary"]["safety_factor"].sel(record=first, model="nonlinear").values
    (dots,) = (
        line for line in overturning_map(assessed, record=first).lines if line.get_label() == "smallest scale factor"
    )
    assert dots.get_xydata().tolist() == [[value, place] for place, value in enumerate(factor)]
    bound = np.zeros(assessed["summary"]["safety_factor"].shape, np.int8)
    ax = overturning_map(changed(factor_resolved=bound), record=first)
    (dots,) = (line for line in ax.lines if line.get_label() == "smallest scale factor")
    assert dots.get_markerfacecolor() == "white"
    assert "Hollow: a lower bound" in small_print(ax)


@pytest.mark.sweep
def test_every_restitution_has_a_row_of_its_own(clc):
    body = Block(0.25, 2.2, restitution=[0.9, 0.98])
    tree = rp.assess(clc, Config(models=ModelSettings(use=("resonance",))), bodies={"wall": body})
    rows = named_rows(overturning_map(tree, block="wall"))
    assert sorted(row.split(", ")[1] for row in rows) == ["C = 0.900"] * 2 + ["C = 0.980"] * 2
    assert "C = 0.980" in critical_scale(tree, case=2).figure.get_suptitle()


@pytest.mark.sweep
def test_what_the_model_cannot_answer_is_not_drawn_as_overturning(assessed, changed, first):
    table = assessed["overturning_intervals"].to_dataset()
    doubted = table.assign(resolved=table["resolved"].copy(data=np.zeros(table.sizes["interval"], np.int8)))
    ax = overturning_map(changed({"/overturning_intervals": doubted}), record=first)
    assert bars(ax, "overturns") == []
    assert len(bars(ax, "no answer: counted as overturning")) > 1
    doubts = [bar for one in ax.containers if one.get_label().startswith("no answer") for bar in one]
    assert {(bar.get_facecolor(), bar.get_hatch()) for bar in doubts} == {((1.0, 1.0, 1.0, 1.0), "xxxx")}
    factor = assessed["summary"]["safety_factor"].values.copy()
    factor[:, 1] = np.nan
    applicable = np.ones(factor.shape, np.int8)
    applicable[:, 0] = 0
    ax = overturning_map(changed(safety_factor=factor, applicable=applicable), record=first)
    assert [(text.get_text().strip(), text.get_position()[1]) for text in ax.texts] == [("not known", 1)]
    assert "Outside the range of the model: wall." in small_print(ax)


@pytest.mark.sweep
def test_resonance_is_named_an_upper_bound_and_the_narrowest_interval_is_seen(assessed, changed, first):
    ax = overturning_map(assessed, block="wall", models=["resonance"])
    assert "upper-bound input" in ax.figure.get_suptitle()
    assert "not a prediction" in small_print(ax)
    assert ax.get_xlabel() == "scale factor on the impulses of the sequence [-]"
    assert "not a prediction" in small_print(critical_scale(assessed, block="wall", models=["resonance"]))
    table = assessed["overturning_intervals"].to_dataset()
    thin = table.assign(upper=table["upper"].copy(data=table["lower"].values * (1.0 + 1e-7)))
    ax = overturning_map(changed({"/overturning_intervals": thin}), record=first)
    for place, block in enumerate(assessed["summary"]["block"].values):
        lower, _ = intervals(assessed, first, block)
        lines = [c for c in ax.collections if len(c.get_segments()) and round(c.get_segments()[0].mean(0)[1]) == place]
        assert sorted(segment[0, 0] for line in lines for segment in line.get_segments()) == pytest.approx(lower)
        assert {float(width) for line in lines for width in line.get_linewidths()} == {1.0}
        assert all(same_color(line.get_colors()[0], RED) for line in lines)
    assert "at least 1 pt wide" in small_print(ax)


@pytest.mark.sweep
def test_nothing_that_overturns_stands_to_the_end_of_the_search(assessed, changed, first):
    none = assessed["overturning_intervals"].to_dataset().isel(interval=slice(0))
    endless = np.full(assessed["summary"]["safety_factor"].shape, np.inf)
    tree = changed({"/overturning_intervals": none}, safety_factor=endless)
    ax = overturning_map(tree, record=first)
    assert [high for _, _, high in bars(ax, "does not overturn")] == pytest.approx([10.0])
    assert [text.get_text().strip() for text in ax.texts] == ["none up to 10"]
    assert named_rows(ax) == ["all 2 bodies"]
    assert "smallest factor" not in ax.get_legend_handles_labels()[1]
    ax = critical_scale(tree, block="wall")
    beside = [x for line in ax.lines if len(line.get_xdata()) == 2 for x in line.get_xdata() if x != 1.0]
    assert len(beside) == 10  # five models on two records
    assert 10.0 < min(beside) < max(beside) < ax.get_xlim()[1]
    assert [text.get_text() for text in ax.texts] == [">10"]
    assert ">10: no overturning up to this scale factor." in small_print(ax)


@pytest.mark.parametrize("draw", [overturning_map, critical_scale])
def test_what_was_not_searched_is_refused(assessed, changed, draw):
    unknown = np.full(assessed["summary"]["safety_factor"].shape, np.nan)
    with pytest.raises(ResultsError, match=r"no scale factors in these results; .*\[search\] models"):
        draw(changed(safety_factor=unknown), block="wall")


def marks(ax, label):
    """Points of one model: filled, hollow."""
    color = next(line.get_color() for line in ax.lines if line.get_label() == label)
    return [line for line in ax.lines if line.get_color() == color and len(line.get_xdata())]


@pytest.mark.sweep
def test_critical_scales_are_those_of_the_results(assessed, changed):
    ax = critical_scale(assessed, block="wall")
    summary = assessed["summary"].to_dataset()
    factor = summary["safety_factor"].sel(block="wall", model="nonlinear").values
    (points,) = marks(ax, "nonlinear")
    assert points.get_xdata().tolist() == sorted(factor)
    words = in_legend(ax)
    assert words == ["resonance (upper-bound input)", "sequence", "impulsive", "linear", "nonlinear"]
    assert len({line.get_marker() for line in ax.lines if line.get_label() in words}) == 5
    shape = assessed["summary"]["safety_factor"].shape
    applicable, resolved = np.ones(shape, np.int8), np.ones(shape, np.int8)
    applicable[..., 3] = 0
    resolved[..., 4] = 0
    ax = critical_scale(changed(applicable=applicable, factor_resolved=resolved), block="wall")
    assert [line.get_markerfacecolor() for line in marks(ax, "linear")] == ["white"]
    assert [line.get_marker() for line in marks(ax, "nonlinear")] == ["o", r"$\rightarrow$"]
    assert "lower bound" in small_print(ax)
    assert "Hollow: outside the range" in small_print(ax)


def ticks(ax):
    """Places of the demand "damage", row by row."""
    (line,) = (line for line in ax.lines if line.get_label() == "to the demand: damage")
    assert line.get_marker() == "|"
    assert line.get_ydata().tolist() == list(range(len(line.get_xdata())))
    return line.get_xdata()


@pytest.fixture
def asked_for(assessed, changed):
    """The results with a demand [m/s2]."""
    summary = assessed["summary"].to_dataset()
    return lambda level, **variables: changed({"/summary": demanding(summary, {"damage": level})}, **variables)


@pytest.mark.sweep
def test_a_demand_is_a_tick_on_every_record(assessed, asked_for, first):
    summary, tree = assessed["summary"].to_dataset(), asked_for(2.94)
    by_factor = np.argsort(summary["safety_factor"].sel(block="wall", model="nonlinear").values)
    expected = 2.94 / summary["pga"].values[by_factor]
    for ax in (critical_scale(tree, block="wall"), overturning_map(tree, block="wall")):
        assert ticks(ax) == pytest.approx(expected)
        assert small_print(ax).endswith("if the scale factor of the body lies to its right.")
    own = 2.94 / float(summary["pga"].sel(record=first))
    assert ticks(overturning_map(tree, record=first)) == pytest.approx([own, own])  # of two blocks


@pytest.mark.sweep
@pytest.mark.parametrize("draw", [overturning_map, critical_scale])
def test_a_demand_is_seen_below_every_factor_and_beyond_the_search_said_to_be_there(asked_for, draw):
    weak = draw(asked_for(0.1), block="wall")
    assert weak.get_xlim()[0] < min(ticks(weak)) < 0.1
    strong = draw(asked_for(1e3), block="wall")
    assert np.isnan(ticks(strong)).all()
    assert "No tick: the demand lies beyond the search." in small_print(strong)


@pytest.mark.sweep
def test_a_tick_does_not_stand_in_the_words_of_its_row(assessed, asked_for, first):
    none = assessed["overturning_intervals"].to_dataset().isel(interval=slice(0))
    endless = np.full(assessed["summary"]["safety_factor"].shape, np.inf)
    for demand in (1.05, 8.0):  # near the record as it is, near the end of the search
        tree = asked_for(demand * float(assessed["summary"]["pga"].sel(record=first)), safety_factor=endless)
        tree["overturning_intervals"] = xr.DataTree(none)
        ax = overturning_map(tree, record=first)
        ax.figure.draw_without_rendering()
        (tick,), pixel = ticks(ax), ax.transData
        assert tick == pytest.approx(demand)
        for words in ax.texts:
            assert words.get_text().strip() == "none up to 10"
            box = words.get_window_extent()
            assert not box.x0 < pixel.transform((tick, 0.0))[0] < box.x1


@pytest.mark.sweep
def test_of_many_records_those_of_the_smallest_factors_are_shown(assessed, changed):
    summary = assessed["summary"].to_dataset()
    many = summary.isel(record=np.zeros(70, dtype=int)).assign_coords(record=[f"record {k}" for k in range(70)])
    factor = np.random.default_rng(0).uniform(0.2, 3.0, many["safety_factor"].shape)
    many = many.assign(safety_factor=many["safety_factor"].copy(data=factor))
    tree = changed({"/summary": many})
    lowest = [f"record {k}" for k in np.argsort(factor[:, 0, 4])]
    ax = critical_scale(tree, block="wall", models=["nonlinear"])
    assert named_rows(ax) == lowest[:ROWS]
    assert "The 60 smallest scale factors of 70 records" in small_print(ax)
    assert ax.figure.get_size_inches()[1] < 11.7  # a page of A4
    drawn = overturning_map(tree, block="wall", most=3)
    assert named_rows(drawn) == lowest[:3]
    assert "The 3 smallest scale factors of 70" in small_print(drawn)


def test_rows_that_say_one_thing_are_one_row_with_their_number(assessed, asked_for):
    """Under four of seven records nothing overturns, of two it is not known; the last one is drawn."""
    summary = asked_for(2.94)["summary"].to_dataset()
    summary = summary.isel(record=np.zeros(7, dtype=int)).assign_coords(record=[f"r{k}" for k in range(7)])
    summary["demand_factor"].values[:] = 2.94 / np.arange(1.0, 8.0)[:, None, None]
    factor = np.array([np.inf, np.nan, np.inf, np.inf, 0.8, np.nan, np.inf])
    summary["safety_factor"].values[:] = factor[:, None, None]
    table = assessed["overturning_intervals"].to_dataset()
    tree = xr.DataTree.from_dict({"/summary": summary, "/overturning_intervals": table.isel(interval=slice(0))})
    ax = overturning_map(tree, block="wall")
    assert named_rows(ax) == ["r4", "4 other records", "2 other records"]
    said = {text.get_position()[1]: text.get_text().strip() for text in ax.texts}
    assert (said[1], said[2]) == ("none up to 10", "not known")
    assert small_print(ax).startswith("4 other records: r0, r2, r3 and 1 more. 2 other records: r1, r5. Dashed")
    assert ticks(ax) == pytest.approx([2.94 / 5.0, np.nan, np.nan], nan_ok=True)


@pytest.fixture
def likely():
    """A body under three records, of which only the probability of overturning is known: of the last up to ten."""
    summary = probable([0.7, 0.02, 0.0], factor_10=[0.5, 2.0, np.inf])
    summary["safety_factor"].attrs.update(long_name="smallest factor", units="1")
    return xr.DataTree.from_dict({"/summary": summary})


def test_a_map_of_probability_has_bars_up_to_ten_and_fifty_percent_and_beyond(likely):
    ax = overturning_map(likely, block="b")
    low = 0.7 * 0.5
    for words, expected in (
        ("P below 10 %", [(0, low, 0.5), (1, low, 2.0), (2, low, 10.0)]),
        ("10 to 50 %", [(0, 0.5, 0.65), (1, 2.0, 2.6)]),
        ("above 50 %", [(0, 0.65, 10.0), (1, 2.6, 10.0)]),
    ):
        assert np.array(bars(ax, words)) == pytest.approx(np.array(expected))
    assert ax.get_yticklabels()[0].get_text() == "r0"  # the most likely on top
    (dots,) = (line for line in ax.lines if line.get_label() == "scale factor at P = 10 %")
    assert dots.get_xdata() == pytest.approx([0.5, 2.0])
    assert "  none up to 10  " in [text.get_text() for text in ax.texts]
    assert not bars(ax, "overturns")
    ax = critical_scale(likely)
    (dots,) = (line for line in ax.lines if len(line.get_xdata()) == 2 and line.get_marker() == "o")
    assert dots.get_xdata() == pytest.approx([0.5, 2.0])
    assert "Nonlinear: scale factor at P = 10 %." in small_print(ax)
