"""The ground motion of one record as a dataset, and the picture of its accelerogram, half-waves and impulses."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rocking.pictures import thinned
from rockpulse.errors import RecordRefused, ResultsError
from rockpulse.record.half_wave import STRONG, VISIBLE, half_waves
from rockpulse.record.intensity import intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import record_sequence
from rockpulse.storage.variables import real
from rockpulse.storage.variables.assessment import WAVES
from rockpulse.storage.variables.summary import RECORD
from rockpulse.views.plots import style
from rockpulse.views.plots.selection import ragged
from rockpulse.views.plots.style import BLACK, BLUE, DOTTED, FONT, GREY, INSTANTS, ORANGE, RED, SKY, Panels
from rockpulse.views.shared.formatting import fixed, three_digits
from rockpulse.views.shared.record_facts import Known, facts_of
from rockpulse.views.shared.words import say

#: Advice if the samples of a record are not in the file.
STORE = 'the file does not contain the accelerograms; assess again with [records] store = "all"'
_ACCELERATION = real("ground acceleration", "m s^-2", dims=("sample",))
_TIME = real("time from the first sample", "s", dims=("sample",))


def stored_motion(tree: xr.DataTree, record: str) -> xr.Dataset:
    """Return accelerogram, half-waves and impulses of a stored record, as :func:`motion_of_record` does.

    Raise ResultsError if the file does not contain the accelerogram.
    """
    summary = tree["summary"].to_dataset()
    own = summary.sel(record=record)
    samples = _samples(tree, own, "row_size", ["acceleration"])
    waves = _samples(tree, own, "half_wave_row_size", [f"half_wave_{name}" for name in WAVES])
    motion = xr.Dataset(samples | {name.removeprefix("half_wave_"): values for name, values in waves.items()})
    for name in ("dt", "intense_start", "intense_end", "main_impulse", "secondary_impulse"):
        motion[name] = own[name].variable
    motion["time"] = _TIME.variable(float(own["dt"]) * np.arange(motion.sizes["sample"]))
    return motion.assign_attrs(record=record, words=Known(summary, record=record).described)


def motion_of_record(record: Record) -> xr.Dataset:
    """Return the ground motion of a conditioned record as the dataset from which pictures are drawn.

    It has the variables `acceleration`, `time` (sample), `impulse`, `centroid`, `start`, `end`, `peak` (wave), and the
    scalars `dt`, `intense_start`, `intense_end`, `main_impulse`, `secondary_impulse`.
    """
    waves, phase = half_waves(record), intense_phase(record)
    scalars: dict[str, Any] = {"dt": record.dt, "intense_start": phase.start, "intense_end": phase.end}
    try:
        sequence = record_sequence(waves, phase=phase)
        scalars |= {"main_impulse": sequence.main, "secondary_impulse": sequence.secondary}
    except RecordRefused:  # the phase contains too few half-waves
        scalars |= {"main_impulse": np.nan, "secondary_impulse": np.nan}
    motion = xr.Dataset(
        {
            "acceleration": _ACCELERATION.variable(record.acceleration),
            "time": _TIME.variable(record.time),
            **{name: variable.variable(getattr(waves, name)) for name, variable in WAVES.items()},
            **{name: RECORD[name].variable(value, ()) for name, value in scalars.items()},
        }
    )
    return motion.assign_attrs(record=record.id, words=facts_of(record).described)


def stored_record(tree: xr.DataTree, record: str) -> Record:
    """Return a conditioned record stored in results; raise ResultsError if its accelerogram is not stored."""
    own = tree["summary"].to_dataset().sel(record=record)
    samples = _samples(tree, own, "row_size", ["acceleration"])
    return Record(samples["acceleration"].values, dt=float(own["dt"]), id=record)


def _samples(tree: xr.DataTree, own: xr.Dataset, sizes: str, names: list[str]) -> dict[str, xr.Variable]:
    """Return variables of /records for one record; the variable `sizes` has the number of samples of each record."""
    record = str(own["record"].item())
    found = ragged(tree, sizes, names, record)
    if found is None:
        sequence = int(own["npts"]) < 0
        raise ResultsError(f"{record}: {'a sequence of impulses, which has no accelerogram' if sequence else STORE}")
    return found


def had_vertical(summary: xr.Dataset, record: str) -> bool:
    """Return whether the nonlinear model used the vertical channel of a record."""
    return bool(summary["vertical_channel"].sel(record=record).item())


#: Margin shown before and after the intense phase, as a share of its duration, and its minimum [s]; number of columns
#: of the overview of the whole record.
_AROUND, _LEAST, _WHOLE = 0.1, 1.0, 450


def accelerogram(motion: xr.Dataset, axes: Panels | None = None) -> np.ndarray:
    """Draw the whole record, its intense phase with the half-waves, and their impulses at the centroids."""
    panels = style.several_axes(axes, 3, height=5.6, height_ratios=[0.55, 1.0, 1.0])[:, 0]
    if axes is None:
        panels[2].sharex(panels[1])
    phase = _phase(motion)
    around = max(_AROUND * (phase[1] - phase[0]), _LEAST)
    end = float(motion["time"][-1])
    window = max(phase[0] - around, 0.0), min(phase[1] + around, end)
    for ax, name in zip(panels, ("whole-record", "intense-phase", "impulses"), strict=True):
        ax.axhline(0.0, color=BLACK, lw=0.5)
        ax.axvspan(*phase, color=SKY, alpha=0.2, lw=0, label=say("plot.ground.phase"))
        ax.set_gid(f"panel-{name}")
    _whole(motion, panels[0])
    _half_waves(motion, window, panels[1])
    _impulses(motion, window, panels[2])
    names = [motion.attrs["record"], *([motion.attrs["words"]] if axes is None and motion.attrs["words"] else [])]
    style.title(panels[0], "\n".join(map(style.plain, names)))
    panels[0].set_xlim(0.0, end)
    for ax in panels[1:]:
        ax.set_xlim(*window)
    panels[2].set_xlabel(style.label(motion["time"]))
    return panels


def _whole(motion: xr.Dataset, ax: Axes) -> None:
    time, acceleration = motion["time"].values, motion["acceleration"].values
    ax.plot(*thinned(time, acceleration, _WHOLE), color=GREY, lw=0.5)
    strongest = int(np.argmax(np.abs(acceleration)))
    ax.plot(time[strongest], acceleration[strongest], marker="o", ms=3.5, mfc="none", color=RED, ls="none")
    words = say("plot.ground.pga", pga=three_digits(abs(acceleration[strongest])), time=fixed(time[strongest]))
    placed: dict[str, Any] = {"xycoords": "axes fraction", "ha": "right", "va": "top"}
    ax.annotate(words, (0.995, 0.95), fontsize=FONT - 1.0, color=RED, **placed)
    ax.set_ylabel("[m/s²]")


def _phase(motion: xr.Dataset) -> tuple[float, float]:
    return float(motion["intense_start"]), float(motion["intense_end"])


def _half_waves(motion: xr.Dataset, window: tuple[float, float], ax: Axes) -> None:
    """Draw the acceleration in a time window, and fill the strong half-waves of the intense phase."""
    time, acceleration = motion["time"].values, motion["acceleration"].values
    inside = (time >= window[0]) & (time <= window[1])
    ax.plot(*thinned(time[inside], acceleration[inside], INSTANTS), color=GREY, lw=0.6)
    words: str | None = say("plot.ground.strong_half_waves")
    strong = _strong(motion)
    for start, end in zip(motion["start"].values[strong], motion["end"].values[strong], strict=True):
        instants = np.concatenate([[start], time[(time > start) & (time < end)], [end]])
        values = np.interp(instants, time, acceleration)
        ax.fill_between(instants, values, color=ORANGE, alpha=0.85, lw=0.4, ec=ORANGE, label=words, zorder=3)
        words = None
    ax.set_ylabel(style.wrapped(style.label(motion["acceleration"]), 24))
    style.legend_above(ax, 2)


def _strong(motion: xr.Dataset) -> np.ndarray:
    """Return the mask of half-waves in the intense phase whose impulse is above half of the largest impulse."""
    impulse, centroid = np.abs(motion["impulse"].values), motion["centroid"].values
    first, last = _phase(motion)
    within = (centroid >= first) & (centroid <= last)
    return np.asarray(within & (impulse >= STRONG * np.max(impulse[within], initial=0.0)) & (impulse > 0.0))


def _impulses(motion: xr.Dataset, window: tuple[float, float], ax: Axes) -> None:
    impulse, centroid = motion["impulse"].values, motion["centroid"].values
    largest = float(np.max(np.abs(impulse), initial=0.0))
    drawn = (centroid >= window[0]) & (centroid <= window[1]) & (np.abs(impulse) > VISIBLE * largest)
    # Lines from zero to every impulse, drawn as one line with gaps.
    stems = np.full((np.count_nonzero(drawn), 3, 2), np.nan)
    stems[:, :2, 0], stems[:, 0, 1], stems[:, 1, 1] = centroid[drawn, np.newaxis], 0.0, impulse[drawn]
    handles = ax.plot(*stems.reshape(-1, 2).T, color=BLUE, lw=0.9, label=say("plot.ground.impulses"))
    strong = _strong(motion) & drawn
    if np.any(strong):
        dots: dict[str, Any] = {"color": BLUE, "ms": 3.0, "label": say("plot.ground.strong_impulses")}
        handles += ax.plot(centroid[strong], impulse[strong], "o", **dots)
    for name, symbol, dashes in (("main_impulse", "I", "-"), ("secondary_impulse", "I_s", DOTTED)):
        size = float(motion[name])
        if np.isfinite(size):
            words = rf"$\pm {symbol}$ = {three_digits(size)} m/s"
            handles.append(ax.axhline(size, color=RED, ls=dashes, lw=1.0, label=words))
            ax.axhline(-size, color=RED, ls=dashes, lw=1.0)
    limit = max(largest, 1e-12) * 1.15
    ax.set(ylim=(-limit, limit), ylabel=style.wrapped(style.label(motion["impulse"]), 24))
    style.legend_above(ax, 4, handles=handles)
    style.caption(ax, " ".join(style.notes(no_sequence=not np.isfinite(float(motion["main_impulse"])))))
