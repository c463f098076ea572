"""Draws fragility curves of a body over intensity measures, and the confidence band of one of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rockpulse.config.study_settings import OVERTURNING, HazardSettings
from rockpulse.record.measures import PGA
from rockpulse.views.plots import style
from rockpulse.views.plots.selection import one_name, settings_of
from rockpulse.views.plots.style import GREY, Look, Panels
from rockpulse.views.shared.formatting import six_digits
from rockpulse.views.shared.words import counted_words, in_numerals, numerals, say, translated
from rockpulse.views.text.fragility import displayed_measure, statement

#: Probabilities below this value, and above one minus this value, do not determine the range of the axis.
_TAIL = 0.002
#: Largest number of limit states for which single capacities are drawn besides the curves.
_POINTS = 3
#: A band that is wider than this [-] at most levels is not drawn; a note names a curve that exceeds the curve of a
#: milder limit state by more than this [-].
_WIDE, _ABOVE = 0.8, 0.01
#: Number of points of a curve between two levels of the file, and largest number of listed warnings.
_BETWEEN, _WARNINGS = 8, 4


def fragility_panels(
    tree: xr.DataTree,
    block: str | None = None,
    measure: str | None = None,
    limit_states: Sequence[str] | None = None,
    axes: Panels | None = None,
) -> np.ndarray:
    """Draw the probability of each limit state of a body over several intensity measures, in adjacent panels.

    By default the measures are p PGV/(g tan alpha_c), or the first of the file, and the measure of the power law in
    `[hazard]` or, without a power law, PGA. The confidence band is drawn for the first of the given limit states that
    has a band; by default for overturning, or for the last limit state if the file has no overturning. Single
    capacities are marks, for up to three limit states and if every record was scaled.
    """
    curves = tree["fragility"].to_dataset()
    block = one_name(curves, "block", block)
    usual = dict.fromkeys((displayed_measure(curves), settings_of(tree, HazardSettings).measure))
    there = [name for name in usual if name in curves["measure"].values]
    chosen = [one_name(curves, "measure", name) for name in ([measure] if measure else there)]
    panels = style.several_axes(axes, 1, len(chosen), height=4.2, sharey=True).ravel()
    states = [one_name(curves, "limit_state", str(name)) for name in limit_states or curves["limit_state"].values]
    gravest = [*(state for state in states if state == OVERTURNING), *states[::-1]]
    said: list[list[str]] = []
    found: dict[str, Any] = {}
    for ax, measure in zip(panels, chosen, strict=True):
        own = curves.sel(block=block, measure=measure)
        band = own["probability_low"].notnull().any("point")
        with_band = (state for state in (states if limit_states else gravest) if bool(band.sel(limit_state=state)))
        said.append(_panel(ax, tree, own, states, next(with_band, None), len(chosen) == 1))
        ax.set_xlabel(style.wrapped(ax.get_xlabel(), 90 // len(chosen)))
        found = dict(zip(*ax.get_legend_handles_labels()[::-1], strict=True)) | found
    # The small print may leave little height for the label.
    panels[0].set_ylabel(style.wrapped(style.label(curves["probability"]), 30))
    names = sorted(found, key=lambda words: words == say("plot.fragility.lifts"))
    style.legend_above(panels[0], 3, across=True, handles=[found[name] for name in names], labels=names)
    style.title(panels[0], style.plain(block), rows=-(-len(names) // 3))
    words = [one for one in said[0] if all(one in notes for notes in said)]
    for measure, notes in zip(chosen, said, strict=True):
        own_words = " ".join(one for one in notes if one not in words)
        name = _measure_words(curves.sel(measure=measure))
        words += [say("plot.fragility.of_measure", name=name, words=own_words)] if own_words else []
    style.caption(panels[0], " ".join(words))
    return panels


def _measure_words(own: xr.Dataset) -> str:
    words = translated(f"measures.{own['measure'].item()}", str(own["measure_long_name"].item()))
    return style.readable_name(in_numerals(words))


def _panel(
    ax: Axes, tree: xr.DataTree, own: xr.Dataset, states: Sequence[str], banded: str | None, alone: bool
) -> list[str]:
    """Draw the curves over one measure and return the notes; `alone` is true if the picture has only this panel."""
    level, measure = own["level"].values, str(own["measure"].item())
    drawn = _shown(own.sel(limit_state=list(states)))
    marked = len(states) <= _POINTS and tree.attrs.get("data") == "ida"
    warnings: dict[str, list[str]] = {}
    for state, appearance in zip(states, style.looks([_named(state) for state in states]), strict=True):
        one, line = own.sel(limit_state=state), {"color": appearance.color, "ls": appearance.line}
        words = appearance.label
        if said := statement(one):
            warnings.setdefault(said, []).append(words)
        if not bool(one["probability"].notnull().any()):
            ax.plot([], [], label=say("plot.fragility.no_curve", state=words) if alone else words, **line)
            continue
        if alone and int(one["extrapolated"]):
            words = say("plot.fragility.extrapolated", state=words)
        ax.plot(*_curve(one, "probability"), lw=1.4, label=words, **line)
        if state == banded and not _band_too_wide(one, drawn):
            (levels, low), (_, high) = _curve(one, "probability_low"), _curve(one, "probability_high")
            ax.fill_between(levels, low, high, color=appearance.color, alpha=0.16, lw=0)
            for edge in (low, high):
                ax.plot(levels, edge, lw=0.5, alpha=0.7, **line)
        if marked:
            capacities = tree["capacities"].to_dataset().sel(block=own["block"].item())
            _capacities(ax, capacities, state, measure, appearance, float(capacities.attrs["factor_max"]))
    ax.set_xscale("log")
    first, last = (float(end(level[drawn], initial=np.nan)) for end in (np.fmin.reduce, np.fmax.reduce))
    if first < last:
        ax.set_xlim(first, last)
    earthquakes = counted_words(int(own["events"].max()), "earthquake")
    counts = say("records_of", records=counted_words(int(own["records"].max()), "record"), earthquakes=earthquakes)
    data = say(f"plot.fragility.data.{tree.attrs['data']}")
    notes = [say("plot.fragility.from", records=counts, data=data), *_band_notes(tree, own, banded, drawn)]
    lifted = float(own["uplift_acceleration"]) if measure == PGA else np.nan
    if lifted > ax.get_xlim()[0]:
        ax.axvline(lifted, color=GREY, lw=0.9, label=say("plot.fragility.lifts"))
        notes += style.notes(lifts=True)
    ax.set(ylim=(-0.01, 1.01), xlabel=f"{_measure_words(own)} [{style.unit(str(own['measure_units'].item()))}]")
    style.plain_ticks(ax.xaxis)
    crossing = _crossing(own.isel(limit_state=own["limit_state"].isin(states)), drawn)
    return notes + style.notes(fitted_one_by_one=crossing, capacities=marked) + _merged_warnings(warnings, len(states))


def _named(state: str) -> str:
    return say(f"limit_state.{state}") if state.isalpha() else rf"$\theta_{{max}}/\alpha_c \geq$ {numerals(state)}"


def _capacities(ax: Axes, own: xr.Dataset, state: str, measure: str, appearance: Look, end: float) -> None:
    """Draw a mark for the capacity of every record that reached a limit state, at its cumulative share of records."""
    from scipy.stats import CensoredData, ecdf

    factor = own["factor"].sel(limit_state=state).values
    value = own["measure_value"].sel(measure=measure).values
    reached = np.isfinite(factor)
    if not np.any(reached):
        return
    found = ecdf(CensoredData(uncensored=(factor * value)[reached], right=end * value[~reached])).cdf
    risen = np.diff(found.probabilities, prepend=0.0)
    marks: dict[str, Any] = {"ls": "none", "ms": 3.2, "mfc": "white", "mew": 0.6, "zorder": 2.5}
    values, shares = found.quantiles[risen > 0.0], (found.probabilities - 0.5 * risen)[risen > 0.0]
    ax.plot(values, shares, marker=appearance.marker, mec=appearance.color, **marks)


def _shown(own: xr.Dataset) -> np.ndarray:
    """Return a mask of the intensity levels at which any curve is between 0 and 1; of all levels if there are none."""
    probability = own["probability"].transpose("limit_state", "point").values
    rising = np.flatnonzero(np.any((probability > _TAIL) & (probability < 1.0 - _TAIL), axis=0))
    every = np.ones(probability.shape[1], dtype=bool)
    if rising.size > 1:
        every[: rising[0]] = every[rising[-1] + 1 :] = False
    return every


def _crossing(own: xr.Dataset, drawn: np.ndarray) -> bool:
    """Return whether the curve of any limit state lies above the curve of a milder limit state."""
    probability = own["probability"].transpose("limit_state", "point").values[:, drawn]
    probability = probability[~np.isnan(probability).any(axis=1)]  # no curve
    return bool(np.any(probability[1:] > np.minimum.accumulate(probability[:-1]) + _ABOVE))


def _curve(one: xr.Dataset, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return intensity levels and values of a curve, interpolated smoothly between the levels of the file."""
    from scipy.interpolate import PchipInterpolator

    level, values = one["level"].values, one[name].values
    if float(one["beta"]) == 0.0:
        step = float(one["median"])
        return np.array([level[0], step, step, level[-1]]), np.array([0.0, 0.0, 1.0, 1.0])
    places = np.linspace(0.0, level.size - 1.0, _BETWEEN * (level.size - 1) + 1)
    fine = np.interp(places, np.arange(level.size), np.log(level))
    return np.exp(fine), PchipInterpolator(np.log(level), values)(fine)


def _band_too_wide(one: xr.Dataset, drawn: np.ndarray) -> bool:
    return bool(np.median((one["probability_high"] - one["probability_low"]).values[drawn]) > _WIDE)


def _band_notes(tree: xr.DataTree, own: xr.Dataset, banded: str | None, drawn: np.ndarray) -> list[str]:
    if banded is None:
        return []
    one = own.sel(limit_state=banded)
    if _band_too_wide(one, drawn):
        return [say("plot.fragility.no_band", state=_named(banded), count=int(one["events"]))]
    confidence = six_digits(100.0 * float(tree.attrs["confidence"]))
    return [say("plot.fragility.band", state=_named(banded), confidence=confidence)]


def _merged_warnings(warnings: dict[str, list[str]], states: int) -> list[str]:
    """Return each different warning once, after the names of the limit states that it concerns."""
    every = say("plot.fragility.all")
    words = [
        f"{', '.join(names) if len(names) < states else every if states > 1 else names[0]}: {warning}."
        for warning, names in warnings.items()
    ]
    more = len(words) - _WARNINGS
    return words if more <= 0 else [*words[:_WARNINGS], say("plot.more_warnings", count=more)]
