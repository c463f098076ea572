"""Test of each statement of section 4 about Figure 5 (Casapulla & Maione 2017).

.. note:: Each statement is tested for every spacing and common interval dT of a scan. It holds if it is true for all
   blocks, restitutions and ratios that it names. The more slender block is B.
"""

from functools import partial

import numpy as np
import xarray as xr

from laboratory.paper.finding import Finding, Statement, stated
from rocking.response import Outcome

FIGURE5_STATEMENTS: list[Statement] = []
_stated = partial(stated, FIGURE5_STATEMENTS)
#: "Very good agreement": impulses and times within this share of each other [-].
_VERY_GOOD = 0.05
#: Constant: the last two half-cycles differ by less than this share [-], which no printed figure would show.
_CONSTANT = 0.01
_SCAN = ("spacing", "interval")


@_stated("the amplitude of this impulse [I_2c] is lower for the more slender block")
def slender_block_needs_a_smaller_impulse(figure: xr.Dataset) -> Finding:
    """I_2c of B is below that of A for every C."""
    a, b = _blocks(figure["main_impulse"])
    return Finding(b < a, "I_2c of A, B in m/s: " + _by_restitution(figure["main_impulse"]))


@_stated("and also depends on the restitution coefficient")
def critical_impulse_depends_on_the_restitution(figure: xr.Dataset) -> Finding:
    """I_2c falls with C, for both blocks."""
    high, low = _restitutions(figure["main_impulse"])
    return Finding(high < low, f"I_2c of the smaller C over that of the larger: {_numbers(low / high)}")


@_stated(
    "for C = 0.9 a very good agreement can be observed between the two formulations [Nabeshima et al.] in terms "
    "both of the amplitudes of the main impulses and of the critical timings t_0"
)
def agrees_with_the_critical_double_impulse(figure: xr.Dataset) -> Finding:
    """I_2c and the time of the second impulse for the larger C, within 5 % of V_c and t_0 with Housner's C."""
    high = figure.sel(restitution=_high(figure))
    impulse = high["main_impulse"] / figure["double_impulse"] - 1.0
    time = high["second_impulse_time"] / figure["double_impulse_time"] - 1.0
    held = (abs(impulse) <= _VERY_GOOD) & (abs(time) <= _VERY_GOOD)
    low = figure["main_impulse"].sel(restitution=_low(figure)) / figure["double_impulse"] - 1.0
    words = "; ".join(
        f"{name}: I_2c {float(impulse.sel(block=name)):+.2%}, t_0 {float(time.sel(block=name)):+.2%}"
        for name in figure["block"].values
    )
    return Finding(
        held, f"{words}; with C = {_low(figure):g} I_2c of A {float(low[0]):+.1%}, of B {float(low[1]):+.1%}"
    )


@_stated(
    "the critical impulse I_2c causing overturning at the second half-cycle if the secondary sequence is not taken "
    "into account"
)
def overturns_in_the_second_half_cycle_without_secondary_impulses(figure: xr.Dataset) -> Finding:
    """I_s = 0: overturning in half-cycle 2, both blocks and restitutions."""
    alone = figure["overturning_half_cycle"].sel(secondary_ratio=0.0)
    return Finding(_everywhere(alone == 2), "")


@_stated("when I_s/I is not 0, both blocks do not overturn at the second half-cycle")
def secondary_impulses_put_overturning_off(figure: xr.Dataset) -> Finding:
    """I_s > 0: no overturning in half-cycle 2, both blocks and restitutions."""
    later = figure["overturning_half_cycle"].where(figure["secondary_ratio"] > 0.0, drop=True)
    return Finding(_everywhere(later != 2), _example(figure, "overturning_half_cycle", _high(figure)))


@_stated("but perform a number of half-cycles increasing with I_s/I")
def half_cycles_become_more_with_the_ratio(figure: xr.Dataset) -> Finding:
    """The number of half-cycles rises from each I_s/I to the next, both blocks and restitutions."""
    rises = figure["half_cycle_count"].diff("secondary_ratio") > 0
    return Finding(_everywhere(rises), _example(figure, "half_cycle_count", _low(figure)))


@_stated(
    "the intermediate impulses imply the reduction of the maximum rotation angle at each half-cycle; increasing "
    "with increasing I_s/I ratios"
)
def each_peak_falls_with_the_ratio(figure: xr.Dataset) -> Finding:
    """Each half-cycle has a smaller peak than with the I_s/I before, both blocks and restitutions."""
    return Finding(_everywhere(_falls(figure["peak"], "secondary_ratio")), _first(figure, "peak"))


@_stated("but also the reduction of the duration of the same half-cycles; increasing with increasing I_s/I ratios")
def each_half_cycle_shortens_with_the_ratio(figure: xr.Dataset) -> Finding:
    """Each half-cycle is shorter than with the I_s/I before, both blocks and restitutions."""
    return Finding(_everywhere(_falls(figure["duration"], "secondary_ratio")), _first(figure, "duration"))


@_stated("although performing the same number of half-cycles (Figs. 5(a) and 5(b))")
def both_blocks_overturn_in_the_same_half_cycle(figure: xr.Dataset) -> Finding:
    """The larger C, I_s/I above zero but for the largest: both overturn, in the same half-cycle."""
    high = figure.sel(restitution=_high(figure))["overturning_half_cycle"]
    a, b = _blocks(high.isel(secondary_ratio=slice(1, -1)))
    return Finding(_everywhere((a == b) & (a > 0)), "")


@_stated("the more slender block (R = 4 m) achieves the overturning in a longer time than the other (R = 2 m)")
def slender_block_overturns_later(figure: xr.Dataset) -> Finding:
    """The larger C, all I_s/I: B overturns at a later time than A."""
    a, b = _blocks(figure.sel(restitution=_high(figure))["overturning_time"])
    ratio = (b / a).isel(spacing=0)
    spans = _spans(ratio.min("interval").values, ratio.max("interval").values)
    return Finding(_everywhere(b > a), f"time of B over that of A, {figure['spacing'].values[0]}, each I_s/I: {spans}")


@_stated("I_s/I = 0.7 implies a slight increment also of the number of half-cycles for the more slender block")
def slender_block_takes_more_half_cycles_at_the_largest_ratio(figure: xr.Dataset) -> Finding:
    """The larger C, the largest I_s/I: both overturn, B after more half-cycles than A."""
    high = figure.sel(restitution=_high(figure))["overturning_half_cycle"].isel(secondary_ratio=-1)
    a, b = _blocks(high)
    held = _everywhere((b > a) & (a > 0))
    more = np.unique((b - a).where(held.broadcast_like(a), 0).values)
    return Finding(held, f"half-cycles more where it holds: {', '.join(f'{int(n)}' for n in more if n) or 'none'}")


@_stated(
    "the influence of the different slenderness is mainly expressed in the reduction of the duration of the half-cycles"
)
def slender_block_has_shorter_half_cycles(figure: xr.Dataset) -> Finding:
    """The larger C: each half-cycle of B is shorter than that of A."""
    a, b = _blocks(figure.sel(restitution=_high(figure))["duration"])
    first = (b / a).isel(half_cycle=0).values
    return Finding(
        _everywhere(_smaller(b, a)),
        f"first half-cycle of B over that of A: {np.nanmin(first):.4g} to {np.nanmax(first):.4g}; "
        f"p of A over p of B: {float(figure['p'][0] / figure['p'][1]):.4g}",
    )


@_stated(
    "the higher stability of the more slender block is justified in this case by the lower amplitude of the main "
    "impulse"
)
def smaller_impulse_saves_the_slender_block(figure: xr.Dataset) -> Finding:
    """The main impulse of B is smaller than that of A in units of the impulse that overturns the block at once."""
    a, b = _blocks(figure["impulse_ratio"])
    numbers = "I/I_1c of A, B: " + _by_restitution(figure["impulse_ratio"])
    return Finding(b < a * (1.0 - 1e-12), numbers + ", so not the amplitude but n decides, by p dT")


@_stated("the lower value of the restitution coefficient: reduction of the maximum angle of rotation")
def smaller_restitution_lowers_each_peak(figure: xr.Dataset) -> Finding:
    """I_s > 0: each half-cycle has a smaller peak with the smaller C, both blocks."""
    return _with_restitution(figure, "peak")


@_stated("the lower value of the restitution coefficient: reduction of the maximum angle of rotation")
def smaller_restitution_lowers_the_largest_angle(figure: xr.Dataset) -> Finding:
    """I_s > 0: the largest angle over the motion is smaller with the smaller C, both blocks."""
    largest = figure["peak"].where(figure["secondary_ratio"] > 0.0, drop=True).max("half_cycle")
    high, low = _restitutions(largest)
    both = (low == np.inf) & (high == np.inf)
    free = int(low.isel(spacing=0).where(~both.isel(spacing=0)).notnull().sum())
    numbers = f"{free} of {low.isel(spacing=0).size} cases tell, the others overturn with both C; largest angle "
    told = figure.assign(largest=figure["peak"].max("half_cycle"))
    return Finding(_everywhere((low < high) | both), numbers + _example(told, "largest", _low(figure)))


@_stated("and of the duration of the half-cycles")
def smaller_restitution_shortens_each_half_cycle(figure: xr.Dataset) -> Finding:
    """I_s > 0: each half-cycle is shorter with the smaller C, both blocks."""
    return _with_restitution(figure, "duration")


@_stated("while their number increases in the limit duration of 20 s of the input")
def smaller_restitution_brings_more_half_cycles(figure: xr.Dataset) -> Finding:
    """I_s > 0: more half-cycles within the input with the smaller C, both blocks."""
    count = figure["half_cycle_count"].where(figure["secondary_ratio"] > 0.0, drop=True)
    high, low = _restitutions(count)
    return Finding(_everywhere(low > high), _example(figure, "half_cycle_count", _low(figure)))


@_stated(
    "when C = 0.6, with increasing values of I_s/I, both the blocks tend to reach a stabilized phase with constant "
    "values of the maximum rotational angle and of the duration of the half-cycles"
)
def motion_stabilises_with_the_smaller_restitution(figure: xr.Dataset) -> Finding:
    """The smaller C, the largest I_s/I: both blocks rock on, and peak and duration become constant."""
    low = figure.sel(restitution=_low(figure)).isel(secondary_ratio=-1)
    held = low["outcome"] == Outcome.ROCKS
    words = []
    for name in ("peak", "duration"):
        listed = (low[name] < np.inf).sum("half_cycle")
        last = low[name].isel(half_cycle=(listed - 1).clip(0))
        before = low[name].isel(half_cycle=(listed - 2).clip(0))
        with np.errstate(invalid="ignore"):
            held &= (listed > 2) & (abs(last / before - 1.0) < _CONSTANT)
        if "continuous" in figure["spacing"].values:
            limit = last.sel(spacing="continuous").isel(interval=0)
            words.append(f"{name} {_numbers(limit)}")
    return Finding(_everywhere(held), f"A, B with n -> infinity: {'; '.join(words)}" if words else "")


def _high(figure: xr.Dataset) -> float:
    return float(figure["restitution"].max())


def _low(figure: xr.Dataset) -> float:
    return float(figure["restitution"].min())


def _blocks(values: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    return values.sel(block="A", drop=True), values.sel(block="B", drop=True)


def _restitutions(values: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    ordered = values.sortby("restitution")
    return ordered.isel(restitution=-1, drop=True), ordered.isel(restitution=0, drop=True)


def _everywhere(held: xr.DataArray) -> xr.DataArray:
    """Whether a statement holds for each spacing and interval, over all other dimensions."""
    return held.all([dim for dim in held.dims if dim not in _SCAN])


def _smaller(low: xr.DataArray, high: xr.DataArray) -> xr.DataArray:
    """Whether `low` is below `high` half-cycle by half-cycle; also True where one is missing or both overturn."""
    missing = low.isnull() | high.isnull()
    return missing | (low < high) | ((low == np.inf) & (high == np.inf))


def _falls(values: xr.DataArray, dim: str) -> xr.DataArray:
    before = values.isel({dim: slice(None, -1)})
    return _smaller(values.isel({dim: slice(1, None)}).assign_coords({dim: before[dim]}), before)


def _with_restitution(figure: xr.Dataset, name: str) -> Finding:
    values = figure[name].where(figure["secondary_ratio"] > 0.0, drop=True)
    high, low = _restitutions(values)
    smaller = _smaller(low, high)
    start = figure["impulse_ratio"].isel(block=0)
    ratio = float(start.sel(restitution=_low(figure)) / start.sel(restitution=_high(figure)))
    numbers = f"I_2c itself is {ratio:.4g} times as large with the smaller C; it holds from half-cycle {_from(smaller)}"
    if "continuous" in smaller["spacing"].values:
        numbers += f" on, with n -> infinity from {_from(smaller.sel(spacing='continuous'))} on"
    return Finding(_everywhere(smaller), numbers)


def _from(held: xr.DataArray) -> int:
    """The first half-cycle from which on a statement holds, over all other dimensions."""
    return int(held["half_cycle"].where(~held, 0).max()) + 1


def _first(figure: xr.Dataset, name: str) -> str:
    """The first half-cycle of block A with each ratio, the larger C and the first spacing, over the intervals."""
    first = figure[name].sel(block="A", restitution=_high(figure)).isel(spacing=0, half_cycle=0)
    low, high = first.min("interval").values, first.max("interval").values
    return f"first half-cycle of A, {figure['spacing'].values[0]}: " + _spans(low, high)


def _example(figure: xr.Dataset, name: str, c: float) -> str:
    """Numbers of both blocks with each ratio, for the first spacing, over the intervals."""
    words = []
    for block in figure["block"].values:
        values = figure[name].sel(block=block, restitution=c).isel(spacing=0)
        words.append(f"{block} " + _spans(values.min("interval").values, values.max("interval").values))
    ratios = ", ".join(f"{ratio:g}" for ratio in figure["secondary_ratio"].values)
    return f"C = {c:g}, {figure['spacing'].values[0]}, I_s/I {ratios}: {'; '.join(words)}"


def _spans(low: np.ndarray, high: np.ndarray) -> str:
    return ", ".join(f"{a:.4g}" if a == b else f"{a:.4g} to {b:.4g}" for a, b in zip(low, high, strict=True))


def _numbers(values: xr.DataArray) -> str:
    return ", ".join(f"{value:.4g}" for value in values.values.ravel())


def _by_restitution(values: xr.DataArray) -> str:
    return "; ".join(f"C = {float(c):g}: {_numbers(values.sel(restitution=c))}" for c in values["restitution"].values)
