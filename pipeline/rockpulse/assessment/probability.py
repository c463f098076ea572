"""The probability of overturning of every body under one record; the other bodies have no effect on it."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from rocking.body.limits import RATES
from rocking.search.capacity import uplift_scale
from rocking.spectrum.body_probability import overturning_probability
from rocking.spectrum.overturning import OverturningFactors, OverturningSpectrum, covered
from rocking.spectrum.probability import Uncertainty
from rocking.spectrum.slender_lanes import LEAST_RESTITUTION, REBOUNDS, neighbours, spectrum_lanes
from rockpulse.assessment.scene import senses
from rockpulse.assessment.site_demands import FARTHEST, demand_factors
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.model_row import Scene
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import AT_DEMAND, PROBABILITY, READ, SOURCES

ENDS = ("", "_low", "_high")
#: A body whose probability of uplift at the largest scale factor is below this counts as at rest.
NEVER = 1e-6
#: For bodies on each side of a wall, or free (0): the range of restitutions or rebounds that a spectrum covers.
SERVED = {0: (LEAST_RESTITUTION, 1.0), 1: REBOUNDS, -1: REBOUNDS}


def record_probability(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record] = ()
) -> tuple[dict[str, np.ndarray], OverturningSpectrum | None]:
    """Compute the probability of overturning under a record, unscaled and at each demand, and the record's spectrum.

    The variables of PROBABILITY and AT_DEMAND have a value for each lane; it is NaN if there is no probability, or if
    the demand is beyond FARTHEST or `[search] factor_max`. Without `channels`, the record is scaled to the demand.
    """
    count = len(bodies.names)
    values = {name: np.full(count, np.nan) for name in PROBABILITY}
    values |= {name: np.full((count, len(config.demands)), np.nan) for name in AT_DEMAND}
    if config.demands:
        blocks = bodies.lanes.take(slice(None, None, bodies.cases)).weaker
        values["demand_factor"] = demand_factors(channels or [scene.record], blocks, config, scene.record.id)
    values["probability_source"] = np.full(count, SOURCES.index("none"))
    spectrum = _fill(values, scene, bodies, config) if config.has_probability else None
    return {name: np.repeat(own, bodies.cases, axis=0) for name, own in values.items()}, spectrum


def _fill(values: dict[str, np.ndarray], scene: Scene, bodies: Bodies, config: Config) -> OverturningSpectrum | None:
    """Fill the arrays of `values` for all bodies; return the spectrum if one of the bodies uses it."""
    record, uncertainty, limit = scene.record, config.uncertainty.of_draws(), scene.factor_max
    found = senses(bodies, record, bodies.cases)
    origin = np.concatenate([np.arange(found.count), found.both])
    blocks, (least, most) = found.block.weaker, (ends[origin] for ends in _ranges(bodies, uncertainty))
    rows = {name: own[origin] for name, own in values.items()}
    with np.errstate(divide="ignore"):
        lifting = np.log(uplift_scale(found.block, record.acceleration))
    rows["uplift_probability"] = 1.0 - uncertainty.below(lifting)
    served = {side: covered(blocks, least, most, side=side, between=between) for side, between in SERVED.items()}
    slender = np.any(list(served.values()), axis=0) & (scene.vertical is None)
    asked, at_demand = rows["demand_factor"], rows["demand_probability"]
    near = (asked >= FARTHEST[0]) & (asked <= min(FARTHEST[1], limit))
    rows["probability_source"] = np.where(slender, SOURCES.index("spectrum"), SOURCES.index("own_motions"))

    def put(places: np.ndarray, factors: OverturningFactors) -> None:
        for name, own in READ.items():
            for end in ENDS:
                rows[name + end][places] = getattr(factors, own + end)

    still = slender & (1.0 - uncertainty.below(lifting - np.log(limit)) < NEVER)
    names = [own.name for own in fields(OverturningFactors)]
    nothing = {name: np.array(0.0 if name.startswith("at_one") else np.inf) for name in names}
    put(np.flatnonzero(still), OverturningFactors(**nothing).up_to(limit))
    at_demand[still] = 0.0
    stored = None
    for side, inside in served.items():
        places = np.flatnonzero(inside & slender & ~still)
        if places.size == 0:
            continue
        rates = RATES if config.uncertainty.spectrum == "all" else neighbours(np.asarray(blocks.p)[places])
        lanes = spectrum_lanes(record.acceleration, record.dt, rates, side=side)
        spectrum = OverturningSpectrum(lanes, uncertainty)
        stored = spectrum if side == 0 else stored
        read = blocks.take(places), least[places], most[places]
        put(places, spectrum.factors(*read, limit))
        if config.demands:
            at_demand[places] = spectrum.overturning(read[0], asked[places], *read[1:])
    seed = int(np.random.SeedSequence([config.run.seed, *record.id.encode()]).generate_state(1)[0])
    others = np.flatnonzero(~slender)
    if others.size:
        own = overturning_probability(
            found.block.take(others),
            record.acceleration,
            record.dt,
            uncertainty,
            vertical=scene.vertical,
            factor_max=limit,
            least=least[others],
            most=most[others],
            seed=seed,
        )
        put(others, own)
        at_demand[others] = own.overturning(asked[others])
    at_demand[~near] = np.nan
    worse = found.higher_probability(rows["overturning_probability"], rows["factor_10"])
    values.update({name: own[worse] for name, own in rows.items()})
    return stored


def _ranges(bodies: Bodies, uncertainty: Uncertainty) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest and the largest C of each body: from its list, or from its single value with uncertainty."""
    restitution = bodies.per_case(np.asarray(bodies.lanes.restitution, dtype=float))
    low, high = restitution.min(axis=1), restitution.max(axis=1)
    least, most = uncertainty.restitution
    return np.where(low < high, low, least * low), np.where(low < high, high, most * high)
