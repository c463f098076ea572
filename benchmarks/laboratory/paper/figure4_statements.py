"""Test of each statement of section 4 about Figure 4 (Casapulla & Maione 2017)."""

from functools import partial

import numpy as np
import xarray as xr

from laboratory.paper.finding import Finding, Statement, stated
from rocking.response import Outcome

FIGURE4_STATEMENTS: list[Statement] = []
_stated = partial(stated, FIGURE4_STATEMENTS)
#: Ratios I_s/I at which the paper says that the range of interest begins and ends.
_RANGE = (0.3, 0.7)
#: With "start" the closed form has roots beyond alpha_c, where no block would come back.
_NOT_START = "every spacing but start"
#: Two peaks are the same within this share: each is within 1e-9 of that of an endless input where that does not bind.
_SAME = 2.01e-9
#: Peaks that are zero but for rounding [-].
ROUNDING = 1e-12


@_stated("for a fixed value of the I/I_1c ratio, the maximum angle of rotation is decreasing with increasing I_s/I")
def peak_falls_with_secondary_impulses(figure: xr.Dataset) -> Finding:
    """Between neighbours along I_s/I at fixed I/I_1c, the larger ratio has the smaller peak or prevents overturning."""
    return _steps(figure, "secondary_ratio", sign=-1.0)


@_stated(
    "if the I_s/I ratio is fixed, the increase in the amplitude of the impulses I implies the increase of "
    "alpha_max/alpha_c"
)
def peak_rises_with_the_main_impulse(figure: xr.Dataset) -> Finding:
    """Between neighbours along I/I_1c at fixed I_s/I, the larger impulse has the larger peak, or overturns."""
    return _steps(figure, "impulse_ratio", sign=1.0)


@_stated("larger values of C, with the other parameters kept constant, imply the increase of the destabilizing effects")
def larger_restitution_destabilises(figure: xr.Dataset) -> Finding:
    """Between neighbours along C, the larger one has a peak that is not smaller.

    The peaks are equal where I_s = I stops the block at each impact.
    """
    return _steps(figure.sortby("restitution"), "restitution", sign=1.0, equal=True)


@_stated("these non-dimensional parameters allow obtaining results independent of the geometric features of the blocks")
def geometry_plays_no_part(figure: xr.Dataset) -> Finding:
    """The peak is the same for every p, at equal n."""
    one, others = figure.isel(p=[0]), figure.isel(p=slice(1, None))
    first, other = one["peak_rotation_ratio"].isel(p=0), others["peak_rotation_ratio"]
    if not other.size:
        return Finding(other == first, "")
    with np.errstate(invalid="ignore"):
        apart = abs(first - other)
    both = (first == np.inf) & (other == np.inf)
    held = both | (apart <= _SAME * first + ROUNDING)
    below = float(apart.where((first <= 1.0) & (other <= 1.0)).max())
    numbers = f"largest difference of two peaks below alpha_c {below:.3g}; "
    numbers += f"{int(((first == np.inf) != (other == np.inf)).sum())} cases overturn one block and not the other"
    free = (one["duration_binds"].isel(p=0) == 0) & (others["duration_binds"] == 0)
    return Finding(held, numbers, conditions={"the duration binds neither block": free})


@_stated("large I_s/I ratios (I_s/I > 0.7) imply less resonance effects")
def large_ratios_mean_less_resonance(figure: xr.Dataset) -> Finding:
    """Less of the grid of I/I_1c and I_s/I overturns above 0.7 than from 0.3 to 0.7, and no more there than below."""
    over, share = figure["outcome"] == Outcome.OVERTURNS, figure["secondary_ratio"]
    low, high = _RANGE
    parts = [share < low, (share >= low) & (share <= high), share > high]
    if not all(bool(part.any()) for part in parts):
        nothing = over.isel(impulse_ratio=0, secondary_ratio=0)
        return Finding(nothing, "", valid=xr.zeros_like(nothing))
    below, inside, above = (over.isel(secondary_ratio=np.flatnonzero(part.values)) for part in parts)
    means = [part.mean(["impulse_ratio", "secondary_ratio"]) for part in (below, inside, above)]
    held = (means[0] >= means[1]) & (means[1] > means[2])
    by_restitution = [mean.mean([dim for dim in mean.dims if dim != "restitution"]) for mean in means]
    numbers = "; ".join(
        f"C = {float(c):g}: " + ", ".join(f"{float(mean.sel(restitution=c)):.1%}" for mean in by_restitution)
        for c in figure["restitution"].values
    )
    numbers = f"share that overturns below {low:g}, up to {high:g}, above: {numbers}"
    return Finding(held, numbers)


def _steps(figure: xr.Dataset, dim: str, sign: float, equal: bool = False) -> Finding:
    """Whether the peak moves the way of `sign` from each value of a dimension to the next."""
    before, after = figure.isel({dim: slice(None, -1)}), figure.isel({dim: slice(1, None)})
    after = after.assign_coords({dim: before[dim]})
    low, high = (part["peak_rotation_ratio"] for part in ((before, after) if sign > 0.0 else (after, before)))
    held = (high >= low * (1.0 - 1e-12)) if equal else high > low
    valid = ~((low == np.inf) & (high == np.inf))
    if not bool(valid.any()):
        return Finding(held, "", valid=valid)
    free = (before["duration_binds"] == 0) & (after["duration_binds"] == 0)
    clear = (before["ground_contact"] == 0) & (after["ground_contact"] == 0)
    against = valid & ~held
    with np.errstate(invalid="ignore"):
        worst = (low - high).where(against & (low <= 1.0) & (high <= 1.0))
    parts = []
    for name in figure["spacing"].values.tolist():
        largest = float(worst.sel(spacing=name).max())
        words = f" (by up to {largest:.2g})" if np.isfinite(largest) else ""
        parts.append(f"{name} {int(against.sel(spacing=name).sum())}{words}")
    return Finding(
        held,
        f"against it: {', '.join(parts)} of {int(valid.sum())} pairs of neighbours that do not both overturn; "
        "differences of peaks below alpha_c",
        valid=valid,
        conditions={
            _NOT_START: before["spacing"] != "start",
            "no march passes through the ground": clear,
            "the duration binds neither of the two": free,
            "the duration binds neither of the two and no march passes through the ground": free & clear,
        },
    )
