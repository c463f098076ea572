"""Draws a map of the probability of overturning of every body under every record."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import overturning_probabilities, too_far
from rockpulse.errors import ResultsError
from rockpulse.views.plots import style
from rockpulse.views.plots.factor_rows import NAME, ROW, configured_uncertainty
from rockpulse.views.plots.selection import one_name
from rockpulse.views.plots.style import BLACK, GREY, SMALL
from rockpulse.views.shared.formatting import ratio, shortened, six_digits
from rockpulse.views.shared.words import say

#: Largest number of records and of bodies on a page, of bodies with horizontal names, and of bodies with written
#: values.
ROWS, COLUMNS, UPRIGHT, WRITTEN = 50, 30, 5, 10
#: Limits of the colours, including those of the verdicts "may overturn" and "overturns".
LEVELS = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])


def probability_map(tree: xr.DataTree, demand: str | None = None, axes: Axes | None = None) -> Axes:
    """Draw the probability that each record, unscaled or scaled to a demand, overturns each body; darker is higher.

    Without a computed probability, the map shows whether the record overturns the body in the most complete model of
    the results. It has a row for every record, with the highest probability on top; a sweep has a row for every pair of
    channels, in its worst direction.
    """
    answers = answers_of(tree)
    motions, known = answers.motions, answers.probable
    if demand is not None and not answers.demands:
        raise ResultsError(f'demand: the results have no demand, so there is no "{demand}"; assess with a [[demand]]')
    demand = None if demand is None else one_name(answers.summary, "demand", demand)
    of_records = np.asarray(overturning_probabilities(answers, demand), dtype=float)
    if demand is not None:
        of_records = np.where(too_far(answers, demand), np.nan, of_records)
    values = np.fmax.reduce(motions.over(of_records, np.nan), axis=1)
    if np.isnan(values).all():
        scaled = "as recorded" if demand is None else f"scaled to the demand {demand}"
        raise ResultsError(f"probability: the results do not state whether the records, {scaled}, overturn a body")
    likely = np.nan_to_num(values)
    rows = np.argsort(-likely.mean(axis=1), kind="stable")[:ROWS]
    columns = np.sort(np.argsort(-likely.mean(axis=0), kind="stable")[:COLUMNS])
    probabilities = values[np.ix_(rows, columns)]
    upright = columns.size <= UPRIGHT
    ax = style.one_axes(axes, height=(1.9 if upright else 3.2) + ROW * max(rows.size, 4))
    colours = colormaps["cividis_r"].with_extremes(bad="white")
    norm = BoundaryNorm(LEVELS, colours.N)
    mesh = ax.pcolormesh(np.ma.masked_invalid(probabilities), cmap=colours, norm=norm, ec="white", lw=0.6)
    ax.grid(visible=False)
    ax.spines[:].set_visible(False)
    ax.tick_params(length=0)
    ax.set_ylim(rows.size, 0)
    ax.set_yticks(np.arange(rows.size) + 0.5, [style.plain(shortened(motions.names[row], NAME)) for row in rows])
    names = [style.plain(shortened(answers.bodies[column].name, NAME)) for column in columns]
    names = [style.wrapped(name, 60 // columns.size) for name in names] if upright else names
    # Room for the names; a letter is a little wider than half its height.
    lift = 6.0 + SMALL * (1.4 * max(name.count("\n") + 1 for name in names) if upright else 0.6 * max(map(len, names)))
    ax.set_xticks(np.arange(columns.size) + 0.5, names, rotation=0 if upright else 90)
    ax.xaxis.tick_top()
    handles: list[Any] = []
    if known:
        levels: dict[str, Any] = {"format": FuncFormatter(lambda level, _: six_digits(level)), "spacing": "uniform"}
        style.colour_bar(ax, mesh, LEVELS, say("plot.probability.scale"), **levels)
        if columns.size <= WRITTEN:
            for (row, column), value in np.ndenumerate(probabilities):
                options: dict[str, Any] = {"color": "white" if value > 0.5 else BLACK, "ha": "center", "va": "center"}
                ax.text(column + 0.5, row + 0.5, ratio(value), fontsize=SMALL - 1.0, **options)
    else:
        verdicts = ((0.99, "overturns"), (0.0, "stands"))
        handles += [Patch(fc=colours(norm(one)), label=say(f"plot.bar.{words}")) for one, words in verdicts]
    if np.isnan(probabilities).any():
        handles.append(Patch(fc="white", ec=GREY, lw=0.5, label=say("grade.not_known")))
    style.legend_above(ax, 3, across=True, lift=lift, handles=handles)
    what = say(f"plot.probability.motions.{motions.kind}")
    at = {} if demand is None else {"demand": style.plain(demand)}
    style.title(ax, say(f"plot.probability.{'title_at' if at else 'title'}", motions=what, **at))
    style.caption(ax, " ".join(_notes(tree, answers, what, rows.size, columns.size)))
    return ax


def _notes(tree: xr.DataTree, answers: Answers, what: str, rows: int, columns: int) -> list[str]:
    motions, bodies = len(answers.motions.names), len(answers.bodies)
    words = [say("plot.probability.rows", count=rows, total=motions, motions=what)] if rows < motions else []
    words += [say("plot.probability.columns", count=columns, total=bodies)] if columns < bodies else []
    words += style.notes(worst_direction=answers.motions.kind == "pair")
    if answers.probable:
        return [*words, say("plot.probability.known", uncertainty=configured_uncertainty(tree))]
    return [*words, say("plot.probability.unknown", model=style.look(answers.model).label)]
