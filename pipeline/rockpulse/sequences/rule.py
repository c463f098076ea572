"""The rule that predicts overturning under a record from an impulse sequence, derived from the record's half-waves.

The demand D is a fitted coefficient times the demand of a march through the half-waves
(:func:`rockpulse.models.demand_of_half_waves`), but at most PGA/(g tan alpha). The sequence overturns a block if D >=
1; otherwise the largest rotation ratio is 1 - sqrt(1 - D^2). The safety factor is 1/D.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.body.limits import RATES, radius_of_rectangle
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.main_sequence import effective_amplification
from rocking.pictures import short_repr
from rocking.search.factors import ScaleIntervals
from rocking.spectrum.half_waves import HalfWaveDemand, demand_of_half_waves, half_wave_lanes
from rocking.spectrum.slender_lanes import SpectrumLanes
from rockpulse.errors import ConfigError
from rockpulse.files import TOML_LIMIT, parse_toml, read_text
from rockpulse.record.half_wave import HalfWaves

#: For each variant of the rule: the field of :class:`rockpulse.models.HalfWaveDemand` that it uses, and the name of
#: the scale factor that 1/D estimates.
POINTS = {"balanced": ("march", "factor_mean"), "conservative": ("march_10", "factor_10")}
#: Name of the file in this package that contains the rule.
SHIPPED = "rule.toml"
#: The properties of a body by which the range of a rule is defined, with templates for their text.
TRAITS = {
    "p": "p {} to {} 1/s",
    "radius": "R {} to {} m",
    "slenderness": "slenderness {} to {}",
    "restitution_ratio": "C {} to {} times Housner's",
}
#: Tolerance of the range [-], the limits of which are rounded to two digits.
SLACK = 0.01


@dataclass(frozen=True)
class Rule:
    """One variant of the rule, as :func:`rockpulse.load_rule` reads it.

    Attributes
    ----------
    point : str
        Name of the variant, "balanced" or "conservative".
    factor : float
        Coefficient by which the demand of a march through the half-waves is multiplied [-], positive.
    within : dict of str to (float, float)
        Range of p [1/s], radius [m], slenderness [-] and restitution_ratio (C divided by Housner's value [-]) of the
        bodies on which the rule was fitted; a quantity without a range is unlimited.

    Examples
    --------
    >>> rule = rp.load_rule("conservative")
    >>> round(rule.factor, 2), rule.within["radius"]
    (0.96, (1.0, 4.0))
    """

    __repr__ = short_repr

    point: str
    factor: float
    within: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.point not in POINTS:
            raise ConfigError(f"rule: expected one of {', '.join(POINTS)}, got {self.point!r}")
        if not (math.isfinite(self.factor) and self.factor > 0.0):
            raise ConfigError(f"rule: [{self.point}] factor: expected a positive number, got {self.factor!r}")

    def demand(self, waves: HalfWaves, block: Block) -> np.ndarray:
        """Return the demand D (m,) [-] of a record on blocks; the rule predicts overturning for D >= 1.

        Parameters
        ----------
        waves : HalfWaves
            All half-waves of the record; a scale factor on the record multiplies D.
        block : Block
            One block (then m = 1), or m blocks.
        """
        march = getattr(_half_wave_demand(waves, block), POINTS[self.point][0])
        return np.minimum(self.factor * march, _uplift(waves, block))

    def safety_factor(self, waves: HalfWaves, block: Block) -> np.ndarray:
        """Return the safety factor 1/D (m,) [-], at which the rule predicts overturning; inf if D is zero."""
        demand = self.demand(waves, block)
        return np.divide(1.0, demand, out=np.full(demand.shape, np.inf), where=demand > 0.0)

    def intervals(self, waves: HalfWaves, block: Block, factor_max: float) -> ScaleIntervals:
        """Return the scale factors that overturn each block: the interval from the safety factor to `factor_max`."""
        factor = self.safety_factor(waves, block)
        lane = np.flatnonzero(factor <= factor_max)
        return ScaleIntervals(
            safety_factor=np.where(factor <= factor_max, factor, np.inf),
            safe_up_to=np.minimum(factor, factor_max),
            lane=lane,
            lower=factor[lane],
            upper=np.full(lane.size, factor_max),
            open=np.ones(lane.size, dtype=bool),
            step=np.ones(factor.size),
            resolved=np.ones(lane.size, dtype=bool),
        )

    def sequence(self, waves: HalfWaves, block: Block) -> ImpulseSequence:
        """Return for each of (m,) blocks a sequence equivalent to the record; a block that does not lift gets zeros.

        Use it with ``sequence_response(..., paired=True)``; the spacing is "continuous", the limit of infinitely many
        secondary impulses. With sigma = I_s/I, u_1 = I/I_1c (I_1c overturns the block alone) and S_i = (1 - C^i)/(1 -
        C), half-cycle i overturns the block if v_i = u_1 [(1 - sigma) S_i + sigma/2] >= 1. I = D I_1c/[(1 - sigma) S_N
        + sigma/2] gives v_N = D, so N main impulses overturn the block if the demand D is at least 1.
        """
        of_waves = _half_wave_demand(waves, block)
        return sequence_of_demand(self.demand(waves, block), of_waves, block, _uplift(waves, block) > 1.0)

    def spectrum_lanes(
        self, waves: HalfWaves, p: ArrayLike = RATES, threads: int | None = None, *, rotations: bool = True
    ) -> SpectrumLanes:
        """Return the blocks of the overturning spectrum at ascending p (a,) [1/s]; their demands include `factor`.

        No block overturns below x = p/PGA (:class:`rockpulse.models.SpectrumLanes`), at which the PGA lifts it. The
        random critical angles are on average 4 % smaller than the nominal angle, so that the spectrum is at most
        1.04 PGA/p, while :meth:`demand` is based on PGA/p.
        """
        of_waves = waves.start, waves.centroid, waves.end, waves.impulse
        lanes = half_wave_lanes(*of_waves, p, threads=threads, rotations=rotations)
        shift = math.log(self.factor)
        log_x = lanes.log_x - shift
        bottom = np.maximum(lanes.bottom - shift, np.log(lanes.p / np.max(np.abs(waves.peak))))
        weight = np.where(log_x > bottom[:, np.newaxis], lanes.weight, 0.0)
        return replace(lanes, log_x=log_x, weight=weight, bottom=bottom, top=np.maximum(lanes.top - shift, bottom))

    def applicable(self, block: Block) -> np.ndarray:
        """Return a mask (m,) of the bodies inside the range on which the rule was fitted, or at most 1 % outside it.

        Examples
        --------
        >>> load_rule().applicable(Block(half_width=[0.1, 0.3], half_height=[0.3, 1.8])).tolist()
        [False, True]
        """
        values = traits(block)
        inside = np.full(values["p"].shape, True)
        for name, (least, most) in self.within.items():
            inside &= (values[name] >= least * (1.0 - SLACK)) & (values[name] <= most * (1.0 + SLACK))
        return inside

    @property
    def range_text(self) -> str:
        """The range of bodies on which the rule was fitted, as text."""
        return ", ".join(
            "Housner's C"
            if name == "restitution_ratio" and f"{low:.3g}" == f"{high:.3g}" == "1"
            else TRAITS[name].format(f"{low:.3g}", f"{high:.3g}")
            for name, (low, high) in self.within.items()
        )


def load_rule(point: str = "balanced", path: str | Path | None = None) -> Rule:
    """Load a variant of a fitted rule.

    Parameters
    ----------
    point : {"balanced", "conservative"}
        The variant of the rule.
    path : str or Path, optional
        File written by ``make rule`` in the repository; by default the file in the package.

    Raises
    ------
    ConfigError
        For an unknown variant, or a file without a rule.

    Examples
    --------
    >>> load_rule("balanced").point
    'balanced'
    """
    if point not in POINTS:
        raise ConfigError(f"rule: expected one of {', '.join(POINTS)}, got {point!r}")
    source = files("rockpulse.sequences").joinpath(SHIPPED) if path is None else Path(path)
    text = source.read_text(encoding="utf-8") if path is None else read_text(Path(path), TOML_LIMIT, "a TOML file")
    table = parse_toml(text, str(source))
    try:
        factor = float(table[point]["factor"])
        within = {name: (float(least), float(most)) for name, (least, most) in table["range"].items()}
    except (AttributeError, KeyError, TypeError, ValueError):
        within = {}
    if not within or not within.keys() <= TRAITS.keys() or any(not least <= most for least, most in within.values()):
        raise ConfigError(
            f"{source}: expected a number as the key factor of [{point}] and, in [range], two numbers [lowest, "
            f"highest] for one or more of {', '.join(TRAITS)}, as in {SHIPPED} of the package"
        )
    return Rule(point, factor, within)


def traits(block: Block) -> dict[str, np.ndarray]:
    """Return the properties (m,) of blocks that are compared with the range of a rule, by the names in `TRAITS`."""
    alpha = np.atleast_1d(block.alpha_c)
    housner = 1.0 - 1.5 * np.sin(alpha) ** 2
    ratio = np.divide(block.restitution, housner, out=np.full(alpha.shape, np.inf), where=housner > 0.0)
    return {
        "p": np.atleast_1d(block.p),
        # Bodies of equal p move equally for any R, so that the range is given for rectangles.
        "radius": np.atleast_1d(radius_of_rectangle(block.p, block.gravity)),
        "slenderness": np.atleast_1d(block.slenderness),
        "restitution_ratio": ratio,
    }


def sequence_of_demand(
    demand: np.ndarray, of_waves: HalfWaveDemand, block: Block, lifted: np.ndarray
) -> ImpulseSequence:
    """Return for each of (m,) blocks a sequence with the given demand; the impulses are 0 for blocks not `lifted`."""
    restitution, critical = (np.broadcast_to(v, demand.shape) for v in (block.restitution, block.critical_impulse))
    reached = [
        effective_amplification(c, ratio, count)
        for c, ratio, count in zip(restitution, of_waves.ratio, of_waves.main_count, strict=True)
    ]
    main = np.where(lifted, demand * critical / np.array(reached), 0.0)
    return ImpulseSequence(
        main=main,
        secondary=of_waves.ratio * main,
        interval=of_waves.interval,
        duration=np.full(demand.shape, np.inf),
        main_count=of_waves.main_count,
        spacing="continuous",
    )


#: Cached demands of half-waves on blocks, which both variants, the sequence and the safety factor use.
_DEMANDS: WeakKeyDictionary[HalfWaves, dict[Block, HalfWaveDemand]] = WeakKeyDictionary()


def _half_wave_demand(waves: HalfWaves, block: Block) -> HalfWaveDemand:
    known = _DEMANDS.setdefault(waves, {})
    if block not in known:
        known[block] = demand_of_half_waves(block, waves.start, waves.centroid, waves.end, waves.impulse)
    return known[block]


def _uplift(waves: HalfWaves, block: Block) -> np.ndarray:
    """Return the ratio (m,) of the PGA to the acceleration g tan alpha that lifts each block [-]."""
    return np.max(np.abs(waves.peak), initial=0.0) / (block.gravity * np.tan(np.atleast_1d(block.alpha_c)))
