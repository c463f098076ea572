"""The probability of overturning of every body under one record, and the rotation of every body at each demand."""

from collections.abc import Iterator, Sequence

import numpy as np

from rocking.body.block import Block
from rocking.body.restraint import Restraints
from rocking.march.recorded import recorded_response, sliding_demand
from rocking.search.capacity import uplift_scale
from rocking.spectrum.body_probability import overturning_probability
from rocking.spectrum.overturning import OverturningFactors, OverturningSpectrum, covered
from rocking.spectrum.sharing import SHARED_INTERPOLATION, shared_groups
from rocking.spectrum.slender_lanes import FIRST, LEAST_RESTITUTION, REBOUNDS, SECOND_OF_BODY, spectrum_lanes
from rockpulse.assessment.scene import senses
from rockpulse.assessment.site_demands import FARTHEST, demand_factors
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.model_table import Scene, is_full
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import AT_DEMAND, OF_TIES, PROBABILITY, READ, SOURCES

ENDS = ("", "_low", "_high")
#: Variables that are taken from the direction of fall with the larger rotation; others, from that with the higher P.
NOMINAL = ("demand_rotation_ratio", "demand_outcome", "demand_sliding_share", *OF_TIES)
#: Restitutions (free bodies, 0) and rebounds (bodies on either side of a wall, 1 and -1) that a spectrum covers.
SERVED = {0: (LEAST_RESTITUTION, 1.0), 1: REBOUNDS, -1: REBOUNDS}
#: Number of blocks per unit of C in the second stage of a spectrum that many bodies share, at each frequency parameter.
SHARED_DENSITY = 9000.0


def record_probability(
    scene: Scene, bodies: Bodies, config: Config, channels: Sequence[Record] = ()
) -> tuple[dict[str, np.ndarray], OverturningSpectrum | None]:
    """Compute the probability of overturning under a record, unscaled and at each demand, and the record's spectrum.

    Every variable of PROBABILITY and AT_DEMAND has a value for each block; NaN if no probability is computed, or if the
    scale factor to the demand is too large or small. With this scale factor the geometric mean of the intensities of
    `channels`, or the intensity of the record if there are none, is equal to the demand.
    """
    count = len(bodies.names) * bodies.cases
    values = {name: np.full(count, np.nan) for name in PROBABILITY}
    values |= {name: np.full((count, len(config.demands)), np.nan) for name in AT_DEMAND}
    values["demand_outcome"] = np.full(values["demand_factor"].shape, -1)
    values |= _no_ties((count, len(config.demands), bodies.tie_count))
    if config.demands:
        factors = demand_factors(channels or [scene.record], bodies.lanes.weaker, config, scene.record.id)
        values["demand_factor"] = factors
        if any(map(is_full, config.models.use)):
            values |= _at_demands(scene, bodies, factors, _near(factors, config))
    values["probability_source"] = np.full(count, SOURCES.index("none"))
    return values, _fill(values, scene, bodies, config) if config.has_probability else None


def _no_ties(shape: tuple[int, ...]) -> dict[str, np.ndarray]:
    return {name: np.full(shape, one.absent, dtype=one.kind) for name, one in OF_TIES.items()}


def _near(factors: np.ndarray, config: Config) -> np.ndarray:
    """Return a mask (bodies, demands) of the scale factors that are near enough to 1 for an assessment."""
    return np.asarray((factors >= FARTHEST[0]) & (factors <= min(FARTHEST[1], config.search.factor_max)))


def _at_demands(scene: Scene, bodies: Bodies, factors: np.ndarray, near: np.ndarray) -> dict[str, np.ndarray]:
    """Return results (bodies, demands) of nominal bodies under the scaled record; they are missing unless `near`."""
    sides, record = senses(bodies, scene.record), scene.record
    found = {"demand_rotation_ratio": np.full(near.shape, np.nan), "demand_outcome": np.full(near.shape, -1)}
    found |= _no_ties((*near.shape, bodies.tie_count))
    shares = [sliding_shares(scene, bodies, np.where(near, factors, np.nan)[:, one]) for one in range(near.shape[1])]
    found["demand_sliding_share"] = np.stack(shares, axis=1)
    for place in np.flatnonzero(near.any(axis=0)):
        factor, kept = np.where(near, factors, 0.0)[:, place], near[:, place]
        scale = np.concatenate([factor, factor[sides.both]])
        marched = recorded_response(
            sides.block, record.acceleration, record.dt, vertical=scene.vertical, block_scale=scale
        )
        worse = sides.worse_places(marched)
        response = marched.take(worse)
        found["demand_rotation_ratio"][kept, place] = np.asarray(response.peak_rotation_ratio)[kept]
        found["demand_outcome"][kept, place] = np.asarray(response.outcome)[kept]
        if response.corner_rotation is not None:
            restraints = sides.block.take(worse).acting()
            for lane in np.flatnonzero(kept & np.array([bool(one and one.ties) for one in restraints])):
                for name, values in _of_ties(restraints[lane], response.corner_rotation[:, lane]).items():
                    found[name][lane, place, : values.size] = values
    return found


def _of_ties(restraints: Restraints | None, rotation: np.ndarray) -> dict[str, np.ndarray]:
    """Return the variables of a body's ties, from the largest rotation of the body about each corner."""
    assert restraints is not None
    demand, ultimate = restraints.tie_demand(rotation), np.array([tie.ultimate for tie in restraints.ties])
    share = np.where(np.isfinite(ultimate), demand.elongation / np.where(np.isfinite(ultimate), ultimate, 1.0), np.nan)
    return dict(zip(OF_TIES, (demand.elongation, demand.force, share, demand.state), strict=True))


def sliding_shares(scene: Scene, bodies: Bodies, factors: np.ndarray) -> np.ndarray:
    """Return the share of each block's motion that requires more friction than the block has, at the `factors`.

    NaN if the friction or scale factor is unknown, and for blocks beside a wall or with ties, loads or thrusts.
    """
    friction, record = np.repeat(bodies.friction, bodies.cases), scene.record
    found = np.full(friction.shape, np.nan)
    for factor in np.unique(factors[~np.isnan(friction + factors)]).tolist():
        asked = np.flatnonzero((factors == factor) & ~np.isnan(friction))
        own, given = bodies.lanes.take(asked), friction[asked]
        found[asked] = sliding_demand(own, record.acceleration, record.dt, given, scene.vertical, factor).share
    return found


def _fill(values: dict[str, np.ndarray], scene: Scene, bodies: Bodies, config: Config) -> OverturningSpectrum | None:
    """Fill the arrays of `values` for all bodies; return the spectrum if the configuration requests one."""
    record, uncertainty, limit = scene.record, config.uncertainty.of_draws(), scene.factor_max
    found = senses(bodies, record)
    rows = {name: own[np.concatenate([np.arange(found.count), found.both])] for name, own in values.items()}
    with np.errstate(divide="ignore"):
        lifting = np.log(uplift_scale(found.block, record.acceleration))
    rows["uplift_probability"] = 1.0 - uncertainty.below(lifting)
    asked = rows["demand_factor"]
    rest, stored = np.ones(lifting.shape, dtype=bool), None

    def put(places: np.ndarray, factors: OverturningFactors, at_demand: np.ndarray, source: np.ndarray) -> None:
        for name, own in READ.items():
            for end in ENDS:
                rows[name + end][places] = getattr(factors, own + end)
        rows["demand_probability"][places], rows["probability_source"][places] = at_demand, source

    # A spectrum does not apply with a vertical acceleration, and a record of zeros has no spectrum.
    has_spectrum = scene.vertical is None and bool(np.any(record.acceleration))
    lifted = np.flatnonzero(np.isfinite(lifting))  # the record may only push blocks against their wall
    for among, spectrum in _spectra(record, found.block.take(lifted), config) if has_spectrum else ():
        inside = lifted[among]
        every = config.uncertainty.spectrum == "all"
        stored = spectrum if every and spectrum.lanes.side == 0 else stored
        if inside.size:
            read = spectrum.read(found.block.take(inside))
            source = np.full(inside.shape, SOURCES.index("spectrum" if every else "shared_spectrum"))
            put(inside, read.factors(limit), read.overturning(asked[inside]), source)
            rest[inside] = False
    others = np.flatnonzero(rest)
    if others.size:
        own = overturning_probability(
            found.block.take(others),
            record.acceleration,
            record.dt,
            uncertainty,
            vertical=scene.vertical,
            factor_max=limit,
            seed=int(np.random.SeedSequence([config.run.seed, *record.id.encode()]).generate_state(1)[0]),
        )
        source = np.where(own.slender, SOURCES.index("slender_limit"), SOURCES.index("full_equation"))
        put(others, own, own.overturning(asked[others]), source)
    rows["demand_probability"][~_near(asked, config)] = np.nan
    worse = found.higher_probability(rows["overturning_probability"], rows["factor_10"])
    values.update({name: own[worse] for name, own in rows.items() if name not in NOMINAL})
    return stored


def _spectra(record: Record, block: Block, config: Config) -> Iterator[tuple[np.ndarray, OverturningSpectrum]]:
    """Yield, for each group of slender bodies, the indices of the bodies and the spectrum that gives their P."""
    motion, uncertainty = (record.acceleration, record.dt), config.uncertainty.of_draws()
    if config.uncertainty.spectrum == "all":
        for side, between in SERVED.items():
            inside = np.flatnonzero(covered(block, uncertainty, side=side, between=between))
            if side == 0 or inside.size:
                yield inside, OverturningSpectrum(spectrum_lanes(*motion, side=side), uncertainty)
    elif config.uncertainty.spectrum == "auto":
        for inside, arguments in shared_groups(block, uncertainty, FIRST + SECOND_OF_BODY, SHARED_DENSITY):
            lanes = spectrum_lanes(*motion, **arguments, rotations=False)
            yield inside, OverturningSpectrum(lanes, uncertainty, SHARED_INTERPOLATION)
