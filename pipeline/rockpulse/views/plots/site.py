"""Draws limit accelerograms (Casapulla & Maione 2017, Figures 1 and 2) and the calibration of a site."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import impulse_train, main_impulses_given, sequence_response
from rocking.response import Response
from rockpulse.errors import ResultsError
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.sequences.design_spectrum import critical_main
from rockpulse.views.plots import style
from rockpulse.views.plots.selection import one_name
from rockpulse.views.plots.spectra import curves_below_axes, record_lines, spectrum_axes
from rockpulse.views.plots.style import BLACK, BLUE, DOTTED, GREY, ORANGE, PALE, RED, SMALL, Panels
from rockpulse.views.shared.formatting import six_digits, three_digits
from rockpulse.views.shared.words import numerals, say
from rockpulse.views.text.site import site_warnings

#: Largest number of main impulses in a picture, and shortest half-cycle whose peak is written, as a share of the width.
_MAIN_DRAWN, _NAMED = 12, 0.07
#: Options of the text next to a half-cycle.
_BESIDE: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL - 0.5}


def limit_accelerogram(
    block: Block, sequence: ImpulseSequence, axes: Panels | None = None, name: str = ""
) -> np.ndarray:
    """Draw the impulses of the limit accelerogram of a block, without and with the secondary sequence.

    The half-cycles of the block determine the times of the main impulses. Below them there is
    a bar for each half-cycle, labelled with the largest abs(theta)/alpha_c.
    """
    panels = style.several_axes(axes, 2, height=5.0, sharex=True, sharey=True)[:, 0]
    drawn = [replace(sequence, secondary=0.0), sequence]
    found = [sequence_response(block, own) for own in drawn]
    last, cycles = 0.0, []
    for ax, words, own, response in zip(panels, ("alone", "both"), drawn, found, strict=True):
        times, impulses = impulse_train(block, own)
        main = np.isclose(np.abs(impulses), own.main)
        if own.secondary > 0.0 and math.isclose(own.secondary, own.main):
            main = _main_places(response, own, times)
        starts = times[main][:_MAIN_DRAWN]
        visible = times <= (starts[-1] if starts.size else 0.0)
        size = say("plot.sequence.main", size=three_digits(float(own.main)))
        _draw(ax, times[visible & main], impulses[visible & main], size, color=BLUE, lw=1.6, ms=4.5)
        if own.secondary > 0.0:
            size = say("plot.sequence.secondary", size=three_digits(float(own.secondary)))
            size = say("plot.sequence.continuous") if own.spacing == "continuous" else size
            _draw(ax, times[visible & ~main], impulses[visible & ~main], size, color=ORANGE, lw=1.0, ms=2.8)
        ax.axhline(0.0, color=BLACK, lw=0.6)
        ax.set_ylabel(say("plot.sequence.impulse"))
        style.panel_title(ax, say(f"plot.sequence.{words}"), rows=1)
        table = response.half_cycles
        assert table is not None
        # After the end of the table its last row repeats.
        rows = np.minimum(np.arange(starts.size), max(table.duration.size - 1, 0))
        durations = table.duration[rows]
        cycles.append((starts, durations, table.peak[rows]))
        last = max(last, float(np.max(starts + np.where(np.isfinite(durations), durations, 0.0), initial=0.0)))
    room = max(last, 1.0 / float(block.p))
    panels[0].set_xlim(-0.04 * room, 1.12 * room)
    limit = 1.2 * max(float(sequence.main), 1e-12)
    panels[0].set_ylim(-1.12 * limit, limit)
    for ax, bars in zip(panels, cycles, strict=True):
        _bars(ax, -1.12 * float(sequence.main), room, *bars)
        style.legend_above(ax, 3)
    panels[-1].set_xlabel(say("plot.from_first.impulse"))
    if name:
        style.title(panels[0], name, rows=1)
    style.caption(panels[-1], _warnings(found, sequence))
    return panels


def _main_places(response: Response, sequence: ImpulseSequence, times: np.ndarray) -> np.ndarray:
    """Return a mask of the main impulses among all impulses; secondary impulses may have the same size."""
    table = response.half_cycles
    assert table is not None
    main = np.zeros(times.size, dtype=bool)
    at = 0
    while at < times.size:
        row = min(int(np.count_nonzero(main)), table.impulse_count.size - 1)
        main[at] = True
        at += 1 + (2 if sequence.spacing == "continuous" else max(int(table.impulse_count[row]), 0))
    return main


def _draw(ax: Any, times: np.ndarray, sizes: np.ndarray, words: str, color: str, lw: float, ms: float) -> None:
    ax.vlines(times, 0.0, sizes, color=color, lw=lw)
    for chosen, marker, label in ((sizes > 0.0, "^", words), (sizes <= 0.0, "v", None)):
        ax.plot(times[chosen], sizes[chosen], ls="none", marker=marker, ms=ms, color=color, label=label)


def _bars(ax: Any, low: float, room: float, starts: np.ndarray, durations: np.ndarray, peaks: np.ndarray) -> None:
    for start, duration, peak in zip(starts, durations, peaks, strict=True):
        if not math.isfinite(duration):
            ax.plot(start, low, marker="x", color=RED, ms=5, mew=1.5, ls="none", label=say("limit_state.overturning"))
            words = say("answer.overturns")
            ax.annotate(words, (start, low), (7, 0), ha="left", va="center", color=RED, **_BESIDE)
            continue
        ax.plot([start, start + duration], [low, low], color=GREY, lw=1.0, marker="|", ms=6)
        if duration > _NAMED * room:
            words = numerals(f"{peak:.2f}" if peak >= 0.095 else f"{peak:.1g}")
            middle = (start + 0.5 * duration, low)
            ax.annotate(words, middle, (0, 3), ha="center", va="bottom", color="#333333", **_BESIDE)


def _warnings(found: list[Response], sequence: ImpulseSequence) -> str:
    words = style.notes(below=True)
    count = [int(main_impulses_given(one, sequence)) for one in found]
    if max(count) > _MAIN_DRAWN:
        words.append(say("plot.sequence.shown", most=_MAIN_DRAWN, one=count[0], other=count[1]))
    if sequence.secondary > 0.0:
        interval = three_digits(float(sequence.interval), "s")
        words.append(say("plot.sequence.interval", interval=interval, spacing=sequence.spacing))
    return " ".join(words + style.notes(ground_contact=bool(found[1].ground_contact)))


def calibration(tree: xr.DataTree, axes: Panels | None = None) -> np.ndarray:
    """Draw the overturning spectra of a site and, if there is a design spectrum, sequences of equal effect.

    The second panel shows the main impulses I that overturn the body with the largest I at its design scale factor, as
    functions of I_s/I for several N.
    """
    site = tree["site"].to_dataset()
    known = site.isel(block=np.flatnonzero(np.isfinite(site["main"].values)))
    count = 2 if known.sizes["block"] else 1
    panels = style.several_axes(axes, count, height=4.4 + 2.6 * (count - 1), height_ratios=[1.0, 0.7][:count]).ravel()
    _spectrum(tree, panels[0])
    if count > 1:
        _equal_effect(known.isel(block=int(np.argmax(known["main"].values))), panels[1])
    return panels


def _equal_effect(own: xr.Dataset, ax: Axes) -> None:
    """Draw main impulses and ratios I_s/I of sequences with the same effect on a body of the site (closed form)."""
    block, (low, middle, high) = _block(own), (int(own[f"main_count{end}"]) for end in ("_lower", "", "_upper"))
    ratios, interval = np.linspace(0.0, 1.0, 101), float(own["interval"])
    at, most = float(own["main"]), 0.0
    for count in sorted({low, middle, high}):
        main = critical_main(block, ratios, interval, count) / float(own["design_factor"])
        dashes = "-" if count == middle else DOTTED if count < middle else "--"
        ax.plot(ratios, main, color=BLUE, lw=1.4, ls=dashes, label=say("plot.site.equal_of", count=str(count)))
        most = max(most, float(np.interp(float(own["ratio_upper"]), ratios, main)))
    ends = np.array([[float(own["ratio"] - own["ratio_lower"])], [float(own["ratio_upper"] - own["ratio"])]])
    ax.errorbar([float(own["ratio"])], [at], xerr=np.nan_to_num(ends), fmt="o", ms=4, color=RED, lw=1.2)
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.6 * max(most, at)), xlabel="$I_s/I$ [-]", ylabel="$I$ [m/s]")
    style.panel_title(ax, say("plot.site.equal", name=str(own["block"].item())), rows=1)
    style.legend_above(ax, 3)


def site_accelerogram(tree: xr.DataTree, block: str | None, axes: Panels | None) -> np.ndarray:
    """Draw the limit accelerogram of a body under the design sequence of the site (Figures 1 and 2 of the paper)."""
    site = tree["site"].to_dataset()
    name = one_name(site, "block", block)
    own = site.sel(block=name)
    main, ratio = float(own["main"]), float(own["ratio"])
    if not np.isfinite(main):
        raise ResultsError(f"{name}: the site has no design sequence for this body, so there is no limit accelerogram")
    sequence = ImpulseSequence(
        main, ratio * main, float(own["interval"]), np.inf, int(own["main_count"]), spacing=str(site.attrs["spacing"])
    )
    return limit_accelerogram(_block(own), sequence, axes, f"{style.plain(tree.attrs.get('title', ''))}, {name}")


def _block(own: xr.Dataset) -> Block:
    p, alpha, restitution = (float(own[name]) for name in ("p", "alpha_c", "restitution"))
    return Block.from_parameters(p, alpha, restitution, log=False)


def _spectrum(tree: xr.DataTree, ax: Axes) -> None:
    """Draw the overturning spectra of the records of a site, their quantiles, and the design impulse of every body."""
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    restitution = float(np.median(site["restitution"])) if site.sizes["block"] else 0.9
    grid = spectra["restitution"].values
    nearest = float(np.clip(restitution, grid[0], grid[-1]))
    curves = {
        str(name): np.exp(one.copy(data=np.log(one.values)).interp(restitution=nearest).transpose(..., "p").values)
        for name, one in spectra.items()
        if "restitution" in one.dims
    }
    p = spectra["p"].values
    record_lines(ax, p, curves["spectrum"])
    quantile, confidence = (six_digits(100.0 * float(site[name])) for name in ("quantile", "confidence"))
    if np.all(np.isfinite(curves["spectrum_design"])):
        words = say("plot.site.of_spectrum", confidence=confidence)
        ax.fill_between(p, curves["spectrum_84_lower"], curves["spectrum_84_upper"], color=PALE, lw=0, label=words)
        ax.plot(p, curves["spectrum_50"], color=BLUE, lw=1.8, label=say("plot.site.median"))
        ax.plot(p, curves["spectrum_84"], color=BLUE, lw=1.8, ls="--", label="84 %")
    known = site.isel(block=np.flatnonzero(np.isfinite(site["effective_impulse"].values)))
    if known.sizes["block"]:
        middle, low, high = (known[f"effective_impulse{end}"].values for end in ("", "_lower", "_upper"))
        words, ends = say("plot.site.effective", quantile=quantile), (middle - low, high - middle)
        ax.errorbar(known["p"].values, middle, yerr=ends, fmt="_", ms=9, color=RED, lw=1.2, label=words)
    # g tan(alpha)/p from I_1c = g alpha/(p cos alpha).
    alpha, rates = site["alpha_c"].values, site["p"].values.tolist()
    speeds = (site["critical_impulse"].values * np.sin(alpha) / alpha).tolist()
    points = dict(zip(map(str, site["block"].values), zip(rates, speeds, strict=True), strict=True))
    rows = spectrum_axes(ax, spectra["p"], points, STANDARD_GRAVITY, columns=2)
    style.title(ax, f"{style.plain(tree.attrs.get('title', ''))}, $C$ = {three_digits(restitution)}", rows=rows)
    said = style.notes(under_design=known.sizes["block"] > 0)
    said += [f"{style.plain(line[:1].upper() + line[1:])}." for line in site_warnings(site)[:1]]
    style.caption(ax, " ".join([*said, *curves_below_axes(ax, curves["spectrum"])]))
