"""Missed and false cases of the code checks, compared with time histories of recorded strong motion.

``python -m laboratory.histories PATHS -o FOLDER`` (``make check-histories RECORDS=FOLDER``) prints missed and false
cases of each check, and writes them as CSV and as a picture.

.. note:: The strong channels and bodies are those of :mod:`laboratory.ensemble`. The demand of a check is that of the
   channel itself: a_g S is its PGA, and S_e its spectrum with 5 % damping. The ratio of a check decreases as the scale
   factor on the record increases, so one number for each case gives the largest scale factor that the check allows. A
   case overturns if the probability of overturning is 0.5 or more (from `factor_50`). Missed cases overturn and pass;
   false cases survive and fail. Intervals come from resampling earthquakes (BCa). The checks of elements that are free
   to vibrate are those of the same bodies of masonry (E and density below) at their period T_0.
"""

import argparse
import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import bootstrap

from laboratory.ensemble import RADII, StrongMotion, add_record_arguments, blocks, read_strong
from laboratory.record_criterion import demand_cases, record_verdicts, verdict_counts, verdict_overview
from laboratory.tables import plain, write_tables
from rocking.spectrum.overturning import OverturningSpectrum
from rocking.spectrum.slender_lanes import spectrum_lanes
from rockpulse.config.block_settings import CANTILEVER
from rockpulse.config.study_settings import CheckSettings
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.studies.check.code_spectra import damping_factor, displacement_of
from rockpulse.studies.check.codes import circolare_2009, circolare_2019
from rockpulse.studies.check.mechanism import senses_of
from rockpulse.views.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    PALE,
    RED,
    caption,
    panel_title,
    picture_bytes,
    plain_ticks,
    several_axes,
)

#: Factors on each record at which cases are counted [-].
LEVELS = (0.5, 1.0, 2.0)
#: Checks by the columns that hold the largest factor they allow, and what they are called.
ALLOWED = {
    "linear": "the linear check of Circolare 617/2009 and 7/2019",
    "nonlinear": "the nonlinear check of Circolare 617/2009",
    "both": "the linear and the nonlinear check of Circolare 617/2009",
    "displacement": "the displacement check of Circolare 7/2019 (SLV)",
    "free": "the linear check of Circolare 7/2019 of elements free to vibrate",
    "free_displacement": "the displacement check of Circolare 7/2019 (SLV) of elements free to vibrate",
}
#: Half of Young's modulus of a brick masonry (1500 MPa, for cracking) [Pa], and its density [kg/m3].
MODULUS, DENSITY = 0.75e9, 1800.0
#: Periods at which the displacement spectrum of a record is looked at [s].
PERIODS = np.geomspace(0.05, 8.0, 120)
#: Fewest earthquakes of an interval, its confidence, and the draws.
FEWEST, CONFIDENCE, RESAMPLES = 4, 0.9, 1000
#: The checks that are drawn, each on a panel, and what they are called.
PANELS = {
    "linear": "linear,\n617/2009 and 7/2019",
    "nonlinear": "nonlinear,\n617/2009",
    "displacement": "displacement,\n7/2019 (SLV)",
}
#: Ratios outside these are drawn at them [-].
ENDS = (0.4, 20.0)
#: Width over which the points of one body are spread, of the distance of two bodies.
SPREAD = 0.6


class _OwnSpectrum:
    """The spectrum of a record; other dampings by eta."""

    def __init__(self, record: Record) -> None:
        self.record, self.ground, self.words = record, record.pga, record.id
        moved = [displacement_of(one, spectral_acceleration(record, one)) for one in PERIODS.tolist()]
        self.largest = np.maximum.accumulate(moved)

    def __call__(self, period: float, damping: float = 0.05) -> float:
        return spectral_acceleration(self.record, period) * damping_factor(damping) if period > 0.0 else self.ground

    def displacement(self, period: float, damping: float = 0.05) -> float:
        """The largest S_De [m] up to a period [s], which may be one of those in between."""
        before = int(np.searchsorted(PERIODS, period))
        own = displacement_of(period, self(period, damping))
        return max(own, damping_factor(damping) * float(self.largest[before - 1])) if before else own


def spectrum_at_bodies(motion: StrongMotion) -> OverturningSpectrum:
    """The overturning spectrum of a channel at the frequency parameters of the bodies, without interpolation."""
    rates = np.sqrt(0.75 * STANDARD_GRAVITY / np.array(sorted(RADII, reverse=True)))
    return OverturningSpectrum(spectrum_lanes(motion.record.acceleration, motion.record.dt, rates))


def motion_cases(
    motion: StrongMotion, settings: CheckSettings, overturning: OverturningSpectrum | None = None
) -> pd.DataFrame:
    """A row for each body under a strong motion.

    `uplift_factor`, above which the record lifts the body, `factor_10` and `factor_50`, at which it overturns with a
    probability of 0.1 and 0.5, and by the names of :data:`ALLOWED` the largest factor that each check allows [-].
    """
    bodies, spectrum = blocks(), _OwnSpectrum(motion.record)
    factors = (overturning or spectrum_at_bodies(motion)).factors(bodies)
    heights = 2.0 * bodies.half_height
    periods = CANTILEVER * bodies.slenderness * heights * np.sqrt(DENSITY / MODULUS)
    rows = []
    for lane in range(bodies.shape[0]):
        (mechanism,) = senses_of(bodies.lane(lane))  # free blocks, whose senses are alike
        older, newer = (check(mechanism, spectrum, (), settings) for check in (circolare_2009, circolare_2019))
        free = circolare_2019(replace(mechanism, initial_period=float(periods[lane])), spectrum, (), settings)
        rows.append(
            {
                "linear": older.activation_ratio,
                "nonlinear": older.displacement_ratio,
                "both": min(older.activation_ratio, older.displacement_ratio),
                "displacement": newer.displacement_ratio,
                "free": free.activation_ratio,
                "free_displacement": free.displacement_ratio,
            }
        )
    return pd.DataFrame(
        {
            "record": motion.record.id,
            "event": motion.event,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            "uplift_factor": STANDARD_GRAVITY * np.tan(bodies.alpha_c) / motion.record.pga,
            "factor_10": factors.factor_10,
            "factor_50": factors.factor_50,
        }
    ).join(pd.DataFrame(rows))


def check_rates(cases: pd.DataFrame, seed: int = 0) -> pd.DataFrame:
    """What each check misses and fails wrongly at each factor of :data:`LEVELS`, and over all of them (factor NaN).

    `missed_10` pass with a probability of 0.1 or more, `passed_lifted` pass and lift off; the limits of the shares are
    those of 90 % over earthquakes, NaN for fewer than four of them.
    """
    levels, codes = np.array(LEVELS), pd.factorize(cases["event"])[0]
    falls, may_fall = (levels >= cases[name].to_numpy()[:, np.newaxis] for name in ("factor_50", "factor_10"))
    lifts = levels > cases["uplift_factor"].to_numpy()[:, np.newaxis]
    rows = []
    for name in ALLOWED:
        passes = cases[name].to_numpy()[:, np.newaxis] >= levels
        counts = np.stack([falls & passes, falls, ~falls & ~passes, ~falls])  # (4, cases, levels)
        of_passing = {"missed_10": may_fall & passes, "passed": passes, "passed_lifted": lifts & passes}
        for place, factor in enumerate((*LEVELS, np.nan)):
            part = slice(None) if place == levels.size else slice(place, place + 1)
            of_cases = counts[:, :, part].sum(axis=2)
            of_events = np.stack([np.bincount(codes, one) for one in of_cases])
            missed, overturned, false, standing = (int(one) for one in of_events.sum(axis=1))
            shares: dict[str, float] = {}
            for share, (top, bottom) in {"missed": (0, 1), "false": (2, 3)}.items():
                low, high = _interval(of_events[top], of_events[bottom], seed)
                total = of_events[bottom].sum()
                value = of_events[top].sum() / total if total else np.nan
                shares |= {f"{share}_share": value, f"{share}_low": low, f"{share}_high": high}
            rows.append(
                {
                    "factor": factor,
                    "check": name,
                    "overturned": overturned,
                    "standing": standing,
                    "missed": missed,
                    **{name: int(one[:, part].sum()) for name, one in of_passing.items()},
                    "false": false,
                    **shares,
                }
            )
    return pd.DataFrame(rows)


def _interval(top: np.ndarray, bottom: np.ndarray, seed: int) -> tuple[float, float]:
    """Limits of sum(top)/sum(bottom) over earthquakes; NaN for few, or a share of 0 or 1."""
    if top.size < FEWEST or not 0.0 < top.sum() < bottom.sum():
        return np.nan, np.nan

    def share(above: np.ndarray, below: np.ndarray) -> float:
        total = float(np.sum(below))
        return float(np.sum(above)) / total if total else 0.0

    found = bootstrap(
        (top, bottom),
        share,
        paired=True,
        vectorized=False,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="BCa",
        rng=np.random.default_rng(seed),
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)


def title_of(cases: pd.DataFrame, settings: CheckSettings) -> str:
    """What the cases are, in a line."""
    return (
        f"Checks of codes against time histories: {cases['record'].nunique()} channels of {cases['event'].nunique()} "
        f"earthquakes, {blocks().shape[0]} bodies, factors {', '.join(f'{one:g}' for one in LEVELS)}; "
        f"q {settings.q:g}, FC {settings.confidence_factor:g}"
    )


def overview(cases: pd.DataFrame, rates: pd.DataFrame, settings: CheckSettings) -> str:
    """The rates as a table, and how far what passes stands and what fails overturns."""
    shown = rates.assign(
        factor=["all" if np.isnan(one) else f"{one:g}" for one in rates["factor"]],
        cases=rates["overturned"] + rates["standing"],
    )
    counts = dict.fromkeys(("factor", "check", "cases", "overturned", "missed", "missed_10"), str)
    shares = [f"{name}_{end}" for name in ("missed", "false") for end in ("share", "low", "high")]
    counts |= dict.fromkeys(("passed", "passed_lifted", "false"), str)
    lines = [title_of(cases, settings), plain(shown, counts | dict.fromkeys(shares, "{:.1%}".format)), ""]
    for one in rates[rates["factor"].isna()].to_dict("records"):
        failed = one["overturned"] - one["missed"] + one["false"]
        lines.append(
            f"{ALLOWED[one['check']]}: {one['passed'] - one['missed']} of {one['passed']} cases that pass stand "
            f"({one['passed_lifted']} lift off, {one['missed_10']} overturn with a probability of 10 % or more); "
            f"{failed - one['false']} of {failed} that fail overturn"
        )
    return "\n".join(lines)


def draw(cases: pd.DataFrame, settings: CheckSettings) -> Figure:
    """Factor at which the probability of overturning is 50 % over the factor that a check allows, by body.

    A point for each channel, a bar at the median of each body; below 1 the check is unsafe, above it dear.
    """
    panels = several_axes(None, 1, len(PANELS), height=3.9, sharex=True, sharey=True)[0]
    sizes = cases[["slenderness", "radius"]].round(6).drop_duplicates().sort_values(["slenderness", "radius"])
    bodies = list(sizes.itertuples(index=False, name=None))
    for ax, (name, words) in zip(panels, PANELS.items(), strict=True):
        _panel(ax, cases.assign(ratio=cases["factor_50"] / cases[name]), bodies)
        panel_title(ax, words, width=40)
    panels[0].set_ylabel("median scale factor over the allowed one [-]")
    slender = sorted({one[0] for one in bodies})
    firsts = [next(place for place, one in enumerate(bodies) if one[0] == value) for value in slender]
    lasts = [max(place for place, one in enumerate(bodies) if one[0] == value) for value in slender]
    for ax in panels:
        ax.set_xticks([0.5 * (first + last) for first, last in zip(firsts, lasts, strict=True)])
        ax.set_xticklabels([f"{value:g}" for value in slender])
        ax.grid(visible=False, axis="x")
        for first in firsts[1:]:
            ax.axvline(first - 0.5, color=PALE, lw=0.6)
    panels[1].set_xlabel("slenderness, from left to right larger bodies")
    radii = ", ".join(f"{value:g}" for value in sorted({one[1] for one in bodies}))
    caption(
        panels[1],
        f"{title_of(cases, settings)}. For each slenderness R {radii} m. Point: one channel; bar: median. Below 1 the "
        "body overturns before it fails the check (unsafe); far above 1 the check is conservative.",
    )
    return panels[0].get_figure()


def _panel(ax: Axes, cases: pd.DataFrame, bodies: list[tuple[float, float]]) -> None:
    ax.axhspan(ENDS[0], 1.0, color=RED, alpha=0.08, lw=0)
    ax.axhline(1.0, color=BLACK, lw=0.8)
    for place, (slenderness, radius) in enumerate(bodies):
        own = cases[np.isclose(cases["slenderness"], slenderness) & np.isclose(cases["radius"], radius)]
        ratio = np.sort(own["ratio"].to_numpy())
        shift = SPREAD * (np.arange(ratio.size) / max(1, ratio.size - 1) - 0.5)
        shown = np.clip(ratio, *ENDS)
        ax.scatter(place + shift, shown, s=4.0, lw=0, color=np.where(ratio < 1.0, RED, BLUE), alpha=0.7)
        middle = float(np.clip(np.median(ratio), *ENDS))
        ax.plot([place - 0.4, place + 0.4], [middle, middle], color=GREEN, lw=2.0, solid_capstyle="butt")
    ax.set(yscale="log", ylim=ENDS)
    plain_ticks(ax.yaxis)


def main() -> None:
    """Compute, write and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_record_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for tables and picture")
    parser.add_argument("--q", type=float, default=2.0, help="behaviour factor")
    parser.add_argument("--confidence-factor", type=float, default=1.0, help="FC")
    parser.add_argument("--seed", type=int, default=0, help="seed of the bootstrap")
    args = parser.parse_args()
    logging.disable(logging.WARNING)
    settings = CheckSettings(q=args.q, confidence_factor=args.confidence_factor)
    motions = read_strong(args)
    if not motions:
        parser.exit(1, "no strong channel among the records\n")
    spectra = [(motion, spectrum_at_bodies(motion)) for motion in motions]
    cases = pd.concat([motion_cases(one, settings, own) for one, own in spectra], ignore_index=True)
    verdicts = record_verdicts(pd.concat([demand_cases(*one) for one in spectra], ignore_index=True), args.seed)
    rates, counts = check_rates(cases, args.seed), verdict_counts(verdicts)
    write_tables(args.output, {"code_check": cases, "rates": rates, "record_verdicts": verdicts, "verdicts": counts})
    (args.output / "code-check.png").write_bytes(picture_bytes(draw(cases, settings), "png"))
    print(overview(cases, rates, settings), verdict_overview(counts), sep="\n\n")


if __name__ == "__main__":
    main()
