"""Draws rotation histories of several models under one record, with impacts and overturning."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from rocking.pictures import thinned
from rockpulse.model_table import SEQUENCE_MODELS, is_full
from rockpulse.views.plots import style
from rockpulse.views.plots.model_histories import ModelHistory
from rockpulse.views.plots.style import BLACK, DASHED, FONT, INSTANTS, SMALL, Panels
from rockpulse.views.shared.formatting import fixed, six_digits, three_digits
from rockpulse.views.shared.words import say, translated

#: The time axis covers rotations above this share of the largest, and is extended by this share of its length on both
#: sides.
_MOVES, _AROUND = 0.02, 0.06
#: Largest rotation that is shown, divided by alpha_c, beyond which the body has fallen.
_TOP = 1.5


def rotation_history(histories: Sequence[ModelHistory], axes: Panels | None = None, title: str = "") -> np.ndarray:
    """Draw the rotation divided by alpha_c over time, and below it the impacts of each model."""
    rows = 0.35 + 0.17 * len(histories)
    ratios = [2.9, rows]
    moving, below = panels = style.several_axes(axes, 2, height=3.4 + rows, sharex=True, height_ratios=ratios).ravel()
    moving.axhline(0.0, color=BLACK, lw=0.5)
    for level in (1.0,) if _away(histories) else (-1.0, 1.0):
        moving.axhline(level, color=BLACK, lw=0.8, ls=DASHED)
    first, last = moving_stretch([(history.time, history.rotation) for history in histories])
    names = []
    for place, history in enumerate(histories):
        appearance = style.look(history.model)
        color, words = appearance.color, f"{appearance.label}: {_answer(history)}"
        in_window = (history.time >= first) & (history.time <= last)
        curve = thinned(history.time[in_window], history.rotation[in_window], INSTANTS)
        # The reference model is the thickest line and on top.
        width, above = (1.7, 3.0) if is_full(history.model) else (1.0, 2.0)
        moving.plot(*curve, color=color, ls=appearance.line, lw=width, zorder=above, label=words)
        # The last sample before the rotation leaves the picture.
        inside = np.flatnonzero(np.abs(history.rotation) <= _TOP)[-1:]
        if np.isfinite(history.overturning) and inside.size:
            cross: dict[str, Any] = {"ls": "none", "marker": "X", "ms": 8, "mec": "white", "mew": 0.8, "zorder": 5}
            moving.plot(history.time[inside], history.rotation[inside], color=color, **cross)
        row = np.full(history.impacts.size, place)
        below.plot(history.impacts, row, ls="none", marker="|", ms=7, mew=0.7, color=color)
        names.append(_model(history) + (f" ({history.impact_count})" if history.impact_count >= 0 else ""))
    if {history.peak for history in histories} == {0.0}:
        moving.text(0.5, 0.55, say("answer.at_rest"), transform=moving.transAxes, fontsize=FONT, ha="center")
    below.set_yticks(range(len(histories)), names, fontsize=SMALL)
    below.set(ylim=(len(histories) - 0.4, -0.6), ylabel=say("plot.motion.impacts"))
    alone = all(history.model in SEQUENCE_MODELS for history in histories)
    below.set_xlabel(say(f"plot.from_first.{'impulse' if alone else 'sample'}"))
    moving.set(ylabel=say("plot.motion.rotation"), xlim=(first, last), ylim=_limits(histories))
    moving.yaxis.set_major_formatter(lambda value, _: six_digits(value))  # without a common power of ten
    style.legend_above(moving, 2, across=True, lift=4.0)
    style.title(moving, title, rows=(len(histories) + 1) // 2)
    style.caption(below, " ".join(_warnings(histories)))
    return panels


def _model(history: ModelHistory) -> str:
    return translated(f"models.{history.model}", history.model)


def _answer(history: ModelHistory) -> str:
    if np.isnan(history.peak):
        return say("answer.unresolved")
    if np.isfinite(history.peak):
        return say("plot.motion.peak", peak=three_digits(history.peak)) if history.peak else say("answer.at_rest")
    known = np.isfinite(history.overturning)
    return say("plot.motion.overturns", time=fixed(history.overturning, 1)) if known else say("answer.overturns")


def _away(histories: Sequence[ModelHistory]) -> bool:
    known = [history.one_sided for history in histories if history.time.size]
    return bool(known) and all(known)


def _limits(histories: Sequence[ModelHistory]) -> tuple[float, float]:
    """Return limits of the rotation axis, symmetric for a body without a wall; narrow for small rotations."""
    finite = [np.nanmax(np.abs(history.rotation)) for history in histories if np.any(np.isfinite(history.rotation))]
    largest = max(finite, default=0.0)
    if largest >= 0.3 or any(np.isinf(history.peak) for history in histories):
        reach = min(max(1.15, 1.08 * largest), 1.08 * _TOP)
    else:
        reach = 1.3 * largest or 0.01
    return (-0.06 if _away(histories) else -1.0) * reach, reach


def moving_stretch(motions: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[float, float]:
    """Return the time window [s] in which any body moves, from a pair of times and rotations for each motion."""
    largest = [min(np.nanmax(np.abs(rotation), initial=0.0), 1.0) for _, rotation in motions]
    found = [time[np.abs(one) > _MOVES * most] for (time, one), most in zip(motions, largest, strict=True)]
    moving = np.concatenate([np.zeros(0), *found])
    if moving.size == 0:
        ends = [float(time[-1]) for time, _ in motions if time.size]
        return 0.0, max(ends, default=1.0)
    first, last = float(np.min(moving)), float(np.max(moving))
    around = max(_AROUND * (last - first), 0.5)
    return max(first - around, 0.0), last + around


def _warnings(histories: Sequence[ModelHistory]) -> list[str]:
    words = style.notes(
        dashed_alpha=_limits(histories)[1] > 1.0 and not _away(histories),
        dashed_away=_limits(histories)[1] > 1.0 and _away(histories),
        impacts=True,
        cross=any(np.isfinite(history.overturning) for history in histories),
        own_time=0 < sum(history.model in SEQUENCE_MODELS for history in histories) < len(histories),
    )
    return words + [f"{_model(history)}: {history.warning}." for history in histories if history.warning]
