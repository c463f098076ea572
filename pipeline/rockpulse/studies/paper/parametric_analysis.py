"""Figure 4: the largest rotation under 20 s of the limit accelerogram (Casapulla & Maione 2017, section 4).

.. note:: In units of I_1c for impulses, 1/p for times and alpha_c for angles the response depends on I/I_1c, I_s/I, C,
   the number n of secondary impulses in a half-cycle and their place in it. A block enters through p times the duration
   of the input alone, and only where an input without end would do more: that is the paper's independence of geometry.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.impulses.sequence import SPACINGS, ImpulseSequence, sequence_response
from rocking.impulses.sequence_kernel import HALF_CYCLE_LIMIT
from rocking.response import Response
from rockpulse.storage.study_variables import FIGURE4, STUDY, described_set, no_motion
from rockpulse.studies.paper.analysis_statements import ANALYSIS_STATEMENTS, ROUNDING
from rockpulse.studies.paper.finding import examine, statement_table
from rockpulse.studies.paper.options import DURATION_LIMITS, P_LIMITS, axis, even_counts
from rockpulse.studies.paper.paper_blocks import DURATION, GRAVITY, RADII, RESTITUTIONS, half_cycle_counts, paper_block

__all__ = ["COUNTS", "IMPULSE_RATIOS", "SECONDARY_RATIOS", "figure4"]

#: I/I_1c. The values of the curves stand in the figure only: these span it.
IMPULSE_RATIOS = tuple(round(0.1 * step, 10) for step in range(1, 11))

#: I_s/I, of which the paper draws 0.3 to 0.7.
SECONDARY_RATIOS = tuple(round(0.01 * step, 10) for step in range(101))

#: n in every half-cycle; inf is the limit that all spacings have in common.
COUNTS = (2, 6, 20, math.inf)

#: alpha_c of the bodies that carry p [rad]: it cancels out.
_ALPHA = 0.25

#: A peak within this share of that of an endless input is not limited by the duration.
_FREE = 1e-9

_DIMS = ("restitution", "impulse_ratio", "secondary_ratio", "spacing", "intermediate_count", "p")


def figure4(
    restitutions: Sequence[float] = RESTITUTIONS,
    impulse_ratios: Sequence[float] = IMPULSE_RATIOS,
    secondary_ratios: Sequence[float] = SECONDARY_RATIOS,
    counts: Sequence[float] = COUNTS,
    p: Sequence[float] | None = None,
    duration: float = DURATION,
    threads: int | None = None,
) -> xr.DataTree:
    """Largest rotation against I_s/I for several I/I_1c, at equal n, with the verdict on each statement about it.

    Parameters
    ----------
    restitutions : sequence of float
        C [-].
    impulse_ratios, secondary_ratios : sequence of float
        I/I_1c [-], positive, and I_s/I [-], 0 to 1; increasing.
    counts : sequence of int or inf
        Secondary impulses in every half-cycle, even; inf for the continuous limit.
    p : sequence of float, optional
        Frequency parameters [1/s]; by default those of the paper's blocks A and B. They set where the duration ends the
        motion, nothing else.
    duration : float
        Main impulses act in half-cycles that start before this time [s].
    threads : int, optional
        Threads that share the lanes; None for all available cores.

    Returns
    -------
    xarray.DataTree
        Nodes /figure4 and /statements (docs/schema.md).

    Raises
    ------
    ConfigError
        For a value out of range.

    Notes
    -----
    Every main impulse gives theta'/(p alpha_c) the increment u_1 = I/I_1c (Eq. 3), every secondary one u_1 I_s/I
    (Eq. 11). The peak is that of all half-cycles that a main impulse starts, each completed.

    Examples
    --------
    >>> figure = figure4(impulse_ratios=[0.3], secondary_ratios=[0.0], counts=[math.inf])["figure4"].to_dataset()
    >>> figure["overturning_half_cycle"].isel(p=0).sel(restitution=0.9, spacing="end").values.item()
    4
    """
    given = [float(paper_block(name, "housner").p) for name in RADII] if p is None else p
    coords = {
        "restitution": axis("restitution", restitutions, 0.0, 1.0),
        "impulse_ratio": axis("impulse ratio I/I_1c", impulse_ratios, increasing=True),
        "secondary_ratio": axis("secondary ratio I_s/I", secondary_ratios, 0.0, 1.0, increasing=True),
        "spacing": np.array([name for name in SPACINGS if name != "continuous"]),
        "intermediate_count": even_counts(counts),
        "p": axis("p", given, *P_LIMITS),
    }
    axis("duration", [duration], *DURATION_LIMITS)
    shape = tuple(coords[name].size for name in _DIMS)
    values: dict[str, np.ndarray] = {name: np.empty(shape, dtype=one.kind) for name, one in FIGURE4.items()}
    for k, rate in enumerate(coords["p"]):
        for j, count in enumerate(coords["intermediate_count"]):
            for i, spacing in enumerate(coords["spacing"]):
                if math.isinf(count) and i > 0:
                    for array in values.values():  # one limit for all spacings
                        array[..., i, j, k] = array[..., 0, j, k]
                    continue
                for name, array in _curves(coords, str(spacing), float(count), float(rate), duration, threads).items():
                    values[name][..., i, j, k] = array
    figure = described_set({name: (_DIMS, array) for name, array in values.items()}, coords, FIGURE4)
    figure.attrs["comment"] = (
        f"Input of {duration:g} s, p x duration = {', '.join(f'{duration * rate:.4g}' for rate in coords['p'])}. "
        "The paper states C, the duration and I_s/I of 0.3 to 0.7; the values of I/I_1c, n and the spacing of its "
        "curves are not in its text." + _no_motions(figure)
    )
    findings = examine(figure, ANALYSIS_STATEMENTS)
    tree = xr.DataTree.from_dict({"/figure4": figure, "/statements": statement_table(findings)})
    tree.attrs.update(
        kind=STUDY,
        title="Casapulla & Maione (2017), Figure 4: largest rotation against the secondary impulses",
        duration=float(duration),
        gravity=GRAVITY,
    )
    return tree


def _no_motions(figure: xr.Dataset) -> str:
    """The number of cases without a result, for the spacings that have some."""
    words = []
    for name in figure["spacing"].values.tolist():
        own = figure.sel(spacing=name)
        peak = own["peak_rotation_ratio"]
        beyond = peak.where((peak > 1.0) & (peak < np.inf))
        if bool((own["no_motion"] == 1).any()):
            most = f", {int(beyond.count())} peaks beyond alpha_c, up to {float(beyond.max()):.3g}"
            words.append(
                f"{name} {int((own['no_motion'] == 1).sum())} of {peak.size} cases"
                + (most if bool(beyond.notnull().any()) else "")
            )
    if not words:
        return ""
    return f" The closed form stands for no motion of a block, and no peak is a result (no_motion): {'; '.join(words)}."


def _curves(
    coords: dict[str, np.ndarray], spacing: str, count: float, p: float, duration: float, threads: int | None
) -> dict[str, np.ndarray]:
    """All variables over (restitution, impulse_ratio, secondary_ratio) for one spacing, n and p."""
    ratios, shares = coords["impulse_ratio"], coords["secondary_ratio"]
    # All is in ratios, and p a scale of time: no body whose size or restitution could be doubted.
    block = Block.from_parameters(p=p, alpha=_ALPHA, restitution=coords["restitution"], gravity=GRAVITY, log=False)
    main = np.repeat(ratios, shares.size) * block.lane(0).critical_impulse
    limit = math.isinf(count)

    def response(end: float, table_rows: int) -> Response:
        sequence = ImpulseSequence(
            main=main,
            secondary=main * np.tile(shares, ratios.size),
            interval=np.nan,
            duration=end,
            intermediate_count=None if limit else int(count),
            spacing="continuous" if limit else spacing,
        )
        return sequence_response(block, sequence, table_rows=table_rows, threads=threads)

    limited, endless = response(duration, HALF_CYCLE_LIMIT), response(math.inf, 0)
    peak, last = np.asarray(limited.peak_rotation_ratio), np.asarray(endless.peak_rotation_ratio)
    with np.errstate(invalid="ignore"):
        free = (peak == last) | (np.abs(last - peak) <= _FREE * last + ROUNDING) & np.isfinite(last)
    lanes = {
        "peak_rotation_ratio": peak,
        "outcome": limited.outcome,
        "overturning_half_cycle": limited.overturning_half_cycle,
        "half_cycle_count": half_cycle_counts(limited, duration),
        "ground_contact": limited.ground_contact,
        "no_motion": no_motion(limited.ground_contact, peak, last),
        "endless_peak_rotation_ratio": last,
        "duration_binds": ~free,
    }
    shape = (ratios.size, shares.size, coords["restitution"].size)
    return {name: np.moveaxis(np.asarray(array).reshape(shape), -1, 0) for name, array in lanes.items()}
