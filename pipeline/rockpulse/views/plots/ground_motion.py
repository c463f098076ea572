"""The ground motion of one record as a small dataset, its accelerogram, half-waves and the impulses for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.pictures import thinned
from rockpulse.errors import RecordRefused, ResultsError
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.intensity import IntensePhase, intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import calibrate
from rockpulse.storage.variables import real
from rockpulse.storage.variables.assessment import WAVES
from rockpulse.storage.variables.summary import RECORD
from rockpulse.views.plots import style
from rockpulse.views.plots.selection import ragged
from rockpulse.views.plots.style import BLACK, BLUE, FONT, GREY, INSTANTS, ORANGE, RED, SKY, Panels
from rockpulse.views.shared.facts import Known, record_words

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

#: The remedy where the samples of a record are not in the file.
STORE = 'the file does not hold the accelerograms: assess again with [records] store = "all"'

#: Scalars of a motion, by their names in /summary.
_SCALARS = ("dt", "intense_start", "intense_end", "main_impulse", "secondary_impulse")

#: Stored variables that are fields of a record by another name: by it alone no record is counted to an earthquake.
_FIELDS = {"event_title": "event"}

_ACCELERATION = real("m s-2", "ground acceleration", dims=("sample",))
_TIME = real("s", "time from the first sample", dims=("sample",))


def stored_motion(tree: xr.DataTree, record: str) -> xr.Dataset:
    """Accelerogram, half-waves and calibrated impulses of a record of the results.

    Parameters
    ----------
    tree : xarray.DataTree
        Results of an assessment.
    record : str
        Id.

    Returns
    -------
    xarray.Dataset
        As :func:`motion_of_record` makes it, with the attributes of the results.

    Raises
    ------
    ResultsError
        Where the file does not hold the accelerogram.
    """
    import xarray as xr

    own = tree["summary"].to_dataset().sel(record=record)
    samples = ragged(tree, "row_size", ["acceleration"], record)
    waves = ragged(tree, "half_wave_row_size", [f"half_wave_{name}" for name in WAVES], record)
    if samples is None or waves is None:
        raise ResultsError(f"{record}: {_missing(own)}")
    motion = xr.Dataset(
        {
            **samples,
            **{name.removeprefix("half_wave_"): variable for name, variable in waves.items()},
            **{name: own[name].variable for name in _SCALARS},
        }
    )
    motion["time"] = _TIME.variable(float(own["dt"]) * np.arange(motion.sizes["sample"]))
    motion.attrs["record"] = record
    motion.attrs["words"] = Known(tree["summary"].to_dataset(), record=record).described
    return motion


def motion_of_record(
    record: Record,
    waves: HalfWaves | None = None,
    phase: IntensePhase | None = None,
    sequence: ImpulseSequence | None = None,
) -> xr.Dataset:
    """The same of a record that was read and conditioned.

    Parameters
    ----------
    record : Record
        Conditioned.
    waves : HalfWaves, optional
        By default those of :func:`rockpulse.half_waves`.
    phase : IntensePhase, optional
        By default that of :func:`rockpulse.intense_phase`.
    sequence : ImpulseSequence, optional
        By default that of :func:`rockpulse.calibrate`; none where the phase holds too few half-waves.

    Returns
    -------
    xarray.Dataset
        `acceleration`, `time` (sample), `impulse`, `centroid`, `start`, `end`, `peak` (wave), and the scalars `dt`,
        `intense_start`, `intense_end`, `main_impulse`, `secondary_impulse`, each with `units` and `long_name`.

    Examples
    --------
    >>> from rockpulse.record.record import Record
    >>> motion = motion_of_record(Record([0.0, 3.0, -3.0, 0.0, 1.0, 0.0], dt=0.1, id="three triangles"))
    >>> motion["impulse"].values.round(3).tolist(), motion["impulse"].attrs["units"]
    ([0.225, -0.225, 0.1], 'm s-1')
    """
    import xarray as xr

    waves = half_waves(record) if waves is None else waves
    phase = intense_phase(record) if phase is None else phase
    if sequence is None:
        try:
            sequence = calibrate(waves, phase=phase)
        except RecordRefused:
            sequence = None
    scalars = {
        "dt": record.dt,
        "intense_start": phase.start,
        "intense_end": phase.end,
        "main_impulse": np.nan if sequence is None else sequence.main,
        "secondary_impulse": np.nan if sequence is None else sequence.secondary,
    }
    motion = xr.Dataset(
        {
            "acceleration": _ACCELERATION.variable(record.acceleration),
            "time": _TIME.variable(record.time),
            **{name: variable.variable(getattr(waves, name)) for name, variable in WAVES.items()},
            **{name: RECORD[name].variable(value, ()) for name, value in scalars.items()},
        }
    )
    motion.attrs["record"] = record.id
    motion.attrs["words"] = record_words(lambda name: getattr(record, _FIELDS.get(name, name)))
    return motion


def stored_record(tree: xr.DataTree, record: str) -> Record:
    """The conditioned record stored in the results, for the models; ResultsError if the accelerogram is not stored."""
    samples = ragged(tree, "row_size", ["acceleration"], record)
    own = tree["summary"].to_dataset().sel(record=record)
    if samples is None:
        raise ResultsError(f"{record}: {_missing(own)}")
    dt = float(own["dt"])
    return Record(samples["acceleration"].values, dt=dt, id=record)


def _missing(own: xr.Dataset) -> str:
    """The reason why there are no samples, and a remedy."""
    return STORE if int(own["npts"]) >= 0 else "a sequence of impulses, which has no accelerogram"


def had_vertical(summary: xr.Dataset, record: str) -> bool:
    """Whether a vertical channel, which is not stored, acted on the nonlinear model of a record."""
    return bool(summary["vertical_channel"].sel(record=record).item())


#: Part of the intense phase that is shown before and after it, and at least so many seconds.
_AROUND, _LEAST = 0.1, 1.0

#: A half-wave above this part of the largest one is strong (as `main_count = "half-largest"` counts them).
_STRONG = 0.5

#: Stretches of time that the whole record is drawn by: it is an overview.
_WHOLE = 450

#: Impulses below this part of the largest are thinner than a line.
_VISIBLE = 0.01


def accelerogram(motion: xr.Dataset, axes: Panels | None = None) -> np.ndarray:
    """The whole record, its intense phase with the half-waves, and their impulses at the centroids.

    Parameters
    ----------
    motion : xarray.Dataset
        As :func:`~rockpulse.plots.stored_motion` or :func:`~rockpulse.plots.motion_of_record` returns it.
    axes : array_like of three matplotlib Axes, optional
        Where to draw; by default on a figure of their own.

    Returns
    -------
    (3,) ndarray of Axes
        The record, the intense phase, the impulses.
    """
    if axes is None:
        figure = style.figure_of(height=5.6)
        panels = figure.subplots(3, 1, height_ratios=[0.55, 1.0, 1.0])
        panels[2].sharex(panels[1])
        panels = np.array([style.dressed(ax) for ax in panels])
    else:
        panels = style.several_axes(axes, 3)[:, 0]
    phase = float(motion["intense_start"]), float(motion["intense_end"])
    around = max(_AROUND * (phase[1] - phase[0]), _LEAST)
    end = float(motion["time"][-1])
    window = max(phase[0] - around, 0.0), min(phase[1] + around, end)
    for ax in panels:
        ax.axhline(0.0, color=BLACK, lw=0.5)
        ax.axvspan(*phase, color=SKY, alpha=0.2, lw=0, label="intense phase")
    _whole(motion, panels[0])
    _half_waves(motion, phase, window, panels[1])
    _impulses(motion, phase, window, panels[2])
    names = [motion.attrs["record"], *([motion.attrs["words"]] if axes is None and motion.attrs["words"] else [])]
    style.title(panels[0], "\n".join(map(style.plain, names)))
    panels[0].set_xlim(0.0, end)
    for ax in panels[1:]:
        ax.set_xlim(*window)
    panels[2].set_xlabel(style.label(motion["time"].attrs))
    for ax, words in zip(panels, ("whole record", "intense phase", "impulses"), strict=True):
        ax.set_gid(f"panel-{words.replace(' ', '-')}")
    return panels


def _whole(motion: xr.Dataset, ax: Axes) -> None:
    time, acceleration = motion["time"].values, motion["acceleration"].values
    ax.plot(*thinned(time, acceleration, _WHOLE), color=GREY, lw=0.5)
    strongest = int(np.argmax(np.abs(acceleration)))
    ax.plot(time[strongest], acceleration[strongest], marker="o", ms=3.5, mfc="none", color=RED, ls="none")
    peak = abs(acceleration[strongest])
    ax.annotate(
        f"PGA {peak:.3g} m/s² at {time[strongest]:.2f} s",
        (0.995, 0.95),
        xycoords="axes fraction",
        ha="right",
        va="top",
        fontsize=FONT - 1.0,
        color=RED,
    )
    ax.set_ylabel("[m/s²]")


def _half_waves(motion: xr.Dataset, phase: tuple[float, float], window: tuple[float, float], ax: Axes) -> None:
    """The acceleration, with the strong half-waves of the phase filled."""
    time, acceleration = motion["time"].values, motion["acceleration"].values
    inside = (time >= window[0]) & (time <= window[1])
    ax.plot(*thinned(time[inside], acceleration[inside], INSTANTS), color=GREY, lw=0.6)
    first = True
    for start, end in zip(*_strong_waves(motion, phase), strict=True):
        within = (time > start) & (time < end)
        instants = np.concatenate([[start], time[within], [end]])
        values = np.interp(instants, time, acceleration)
        words = "half-waves above half the largest impulse" if first else None
        ax.fill_between(instants, values, color=ORANGE, alpha=0.85, lw=0.4, ec=ORANGE, label=words, zorder=3)
        first = False
    ax.set_ylabel(style.wrapped(style.label(motion["acceleration"].attrs), 24))
    style.legend_above(ax, 2)


def _strong_waves(motion: xr.Dataset, phase: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    impulse, centroid = np.abs(motion["impulse"].values), motion["centroid"].values
    within = (centroid >= phase[0]) & (centroid <= phase[1])
    strong = within & (impulse >= _STRONG * np.max(impulse[within], initial=0.0)) & (impulse > 0.0)
    return motion["start"].values[strong], motion["end"].values[strong]


def _impulses(motion: xr.Dataset, phase: tuple[float, float], window: tuple[float, float], ax: Axes) -> None:
    impulse, centroid = motion["impulse"].values, motion["centroid"].values
    largest = float(np.max(np.abs(impulse), initial=0.0))
    shown = (centroid >= window[0]) & (centroid <= window[1]) & (np.abs(impulse) > _VISIBLE * largest)
    within = (centroid >= phase[0]) & (centroid <= phase[1])
    ax.plot(*_stems(centroid[shown], impulse[shown]), color=BLUE, lw=0.9, label="impulses")
    strong = within & (np.abs(impulse) >= _STRONG * np.max(np.abs(impulse[within]), initial=0.0)) & shown
    if np.any(strong):
        ax.plot(centroid[strong], impulse[strong], "o", color=BLUE, ms=3.0, label="above half the largest")
    for name, symbol, dashes in (("main_impulse", "I", "-"), ("secondary_impulse", "I_s", (0, (1.2, 1.2)))):
        size = float(motion[name])
        if np.isfinite(size):
            ax.axhline(size, color=RED, ls=dashes, lw=1.0, label=rf"$\pm {symbol}$ = {size:.3g} m/s")
            ax.axhline(-size, color=RED, ls=dashes, lw=1.0)
    limit = max(largest, 1e-12) * 1.15
    ax.set_ylim(-limit, limit)
    ax.set_ylabel(style.wrapped(style.label(motion["impulse"].attrs), 24))
    handles, words = ax.get_legend_handles_labels()
    kept = [place for place, word in enumerate(words) if word != "intense phase"]
    style.legend_above(ax, 4, handles=[handles[place] for place in kept])
    if not np.isfinite(float(motion["main_impulse"])):
        style.caption(ax, "No impulse sequence was calibrated: the intense phase holds too few half-waves.")


def _stems(places: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines from zero to every height, as one broken line."""
    nothing = np.full(places.size, np.nan)
    return (
        np.stack([places, places, nothing], axis=1).ravel(),
        np.stack([np.zeros(places.size), heights, nothing], axis=1).ravel(),
    )
