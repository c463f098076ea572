"""Figure 4: the largest rotation under 20 s of the limit accelerogram (Casapulla & Maione 2017, section 4).

.. note:: With impulses in units of I_1c, times in units of 1/p and angles in units of alpha_c, the response depends on
   I/I_1c, I_s/I, C, the number n of secondary impulses in a half-cycle and their positions in it. It depends on the
   block only through p times the duration of the input, and only if an input without end would give a larger rotation.
   For this reason the paper finds that results do not depend on the geometry.
"""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr

from laboratory.paper.blocks import DURATION, GRAVITY, RADII, RESTITUTIONS, half_cycle_counts, no_motion, paper_block
from laboratory.paper.figure4_statements import FIGURE4_STATEMENTS, ROUNDING
from laboratory.paper.finding import examine, statement_table
from rocking.body.block import Block
from rocking.impulses.impulse_sequence import SPACINGS, ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rocking.impulses.sequence_kernel import HALF_CYCLE_LIMIT
from rocking.response import Response

#: I/I_1c. The paper prints the values in the figure only; these span its range.
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
) -> tuple[xr.Dataset, pd.DataFrame]:
    """Largest rotation against I_s/I for several I/I_1c, at equal n, and the verdict on each statement about it.

    C [-], I/I_1c and I_s/I [-] (both rising) and n (even, inf for the continuous limit) span the curves; p [1/s], by
    default those of blocks A and B, only sets where the end of the input ends the motion: main impulses act in
    half-cycles that start before `duration` [s].

    Every main impulse gives theta'/(p alpha_c) the increment u_1 = I/I_1c (Eq. 3), every secondary one u_1 I_s/I
    (Eq. 11). The peak is that of all half-cycles that a main impulse starts, each completed.

    Examples
    --------
    >>> figure, statements = figure4(impulse_ratios=[0.3], secondary_ratios=[0.0], counts=[math.inf])
    >>> figure["overturning_half_cycle"].isel(p=0).sel(restitution=0.9, spacing="end").values.item()
    4
    """
    coords = {
        "restitution": np.array(restitutions, dtype=float),
        "impulse_ratio": np.array(impulse_ratios, dtype=float),
        "secondary_ratio": np.array(secondary_ratios, dtype=float),
        "spacing": np.array([name for name in SPACINGS if name != "continuous"]),
        "intermediate_count": np.array(counts, dtype=float),
        "p": np.array([float(paper_block(name, "housner").p) for name in RADII] if p is None else p, dtype=float),
    }
    by_p = []
    for rate in coords["p"].tolist():
        by_count = []
        for count in coords["intermediate_count"].tolist():
            # One limit for all spacings.
            names = coords["spacing"][:1] if math.isinf(count) else coords["spacing"]
            curves = [_curves(coords, str(name), count, rate, duration) for name in names]
            by_count.append(curves * (coords["spacing"].size // len(curves)))
        by_p.append(by_count)
    variables = {
        name: np.moveaxis(
            np.array([[[one[name] for one in curves] for curves in by_count] for by_count in by_p]),
            [2, 1, 0],
            [3, 4, 5],
        )
        for name in by_p[0][0][0]
    }
    figure = xr.Dataset({name: (_DIMS, array) for name, array in variables.items()}, coords, {"duration": duration})
    return figure, statement_table(examine(figure, FIGURE4_STATEMENTS))


def no_motions(figure: xr.Dataset) -> pd.DataFrame:
    """For each spacing the cases for which the closed form is no physical motion, and their peaks beyond alpha_c."""
    rows = []
    for name in figure["spacing"].values.tolist():
        own = figure.sel(spacing=name)
        peak = own["peak_rotation_ratio"]
        beyond = peak.where((peak > 1.0) & (peak < np.inf))
        rows.append(
            {
                "spacing": name,
                "cases": peak.size,
                "no_motion": int(own["no_motion"].sum()),
                "beyond_alpha_c": int(beyond.count()),
                "largest_of_these": float(beyond.max()),
            }
        )
    return pd.DataFrame(rows)


def _curves(
    coords: dict[str, np.ndarray], spacing: str, count: float, p: float, duration: float
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
        return sequence_response(block, sequence, table_rows=table_rows)

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
