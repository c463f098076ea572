"""The limit states of bodies, the scale factors that reach them, and the capacities under one record."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rocking.search.capacity import critical_scale, uplift_scale
from rockpulse.assessment.scene import extract, floor_scene, places_of, turned
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.config.study_settings import OVERTURNING, UPLIFT
from rockpulse.errors import TooWeak
from rockpulse.model_table import MODELS, Equation, Scene
from rockpulse.record.components import Pair
from rockpulse.record.intensity import pgv
from rockpulse.record.measures import MEASURES, RecordOnBodies
from rockpulse.run.analysis import Part, Watch
from rockpulse.selection.directions import Motion
from rockpulse.selection.tables import SelectedRecords
from rockpulse.storage.variables.fragility import QUALITIES
from rockpulse.storage.variables.summary import FACTS, facts_of

#: Value for a result that the model cannot resolve.
NOT_KNOWN = -1
#: A half-wave is strong if its impulse is above this share of the largest impulse.
STRONG_SHARE = 0.5


def scale_capacities(
    scene: Scene, block: Block, states: Sequence[str | float], equation: str, factor_max: float, points: int
) -> tuple[np.ndarray, np.ndarray]:
    """Run the incremental dynamic analysis of one record: find the first scale factor that reaches each limit state.

    The `states` are "uplift" (in closed form), values of theta_max/alpha_c, and "overturning". Each of m blocks is
    computed at `points` scale factors up to `factor_max`. If the model gives no result at a scale factor (free flight),
    the limit state counts as reached.

    Returns the scale factors (s, m), inf if no scale factor reaches the state; at larger scale factors the state may
    not be reached again. The step (m,) is the ratio of successive scale factors [-]: an interval narrower than the step
    may be missed, so that the first scale factor is too large. The step is 1 if uplift is the only state.
    """
    record = scene.record
    solved, vertical = _acting(scene, equation)
    capacities, step = np.empty((len(states), *block.shape)), np.ones(block.shape)
    for row, state in enumerate(states):
        if state == UPLIFT:
            factor = uplift_scale(block, record.acceleration, solved, vertical)
        else:
            found = critical_scale(
                block,
                record.acceleration,
                record.dt,
                equation=solved,
                vertical=vertical,
                level=None if state == OVERTURNING else float(state),
                factor_max=factor_max,
                points=points,
            )
            factor, step = found.safety_factor, found.step
        capacities[row] = np.where(factor <= factor_max, factor, np.inf)
    return capacities, step


def reached_at(
    scene: Scene, block: Block, states: Sequence[str | float], equation: str, factors: np.ndarray
) -> np.ndarray:
    """Return an array (states, factors, blocks): 1 if the state is reached, 0 if not, NOT_KNOWN if unresolved."""
    record = scene.record
    solved, vertical = _acting(scene, equation)
    lifted = uplift_scale(block, record.acceleration, solved, vertical)
    reached = np.empty((len(states), *factors.shape), dtype=np.int8)
    for column, own in enumerate(factors):
        response = recorded_response(
            block, record.acceleration, record.dt, equation=solved, vertical=vertical, block_scale=own
        )
        overturned = np.equal(response.outcome, Outcome.OVERTURNS)
        known = np.not_equal(response.outcome, Outcome.UNRESOLVED)
        for row, state in enumerate(states):
            if state == UPLIFT:
                reached[row, column] = own > lifted
            else:
                over = overturned if state == OVERTURNING else np.asarray(response.peak_rotation_ratio) >= float(state)
                reached[row, column] = np.where(known, over, NOT_KNOWN)
    return reached


def _acting(scene: Scene, model: str) -> tuple[Equation, np.ndarray | None]:
    """Return the equation of motion of a model, and the vertical acceleration that it uses (None if it uses none)."""
    equation = MODELS[model].equation
    assert equation is not None
    return equation, MODELS[model].vertical_of(scene)


class FragilityBodies(NamedTuple):
    """The blocks of all bodies; a body with several restitutions has a block for each."""

    block: Block
    bodies: Bodies
    owner: np.ndarray  #: (m,) index of the body of each block


def motion_capacity(
    motion: Motion, watch: Watch, lanes: FragilityBodies, config: Config, selection: SelectedRecords | None = None
) -> Part:
    """Compute the capacities of (m,) blocks under one record, as arrays by name.

    "measures" (1, k, m) are the intensity measures of the unscaled ground motion in the direction of each body, in the
    order of ``[fragility] measures``, and "qualities" (1, c) the properties in QUALITIES. An incremental analysis adds
    "factors" (1, s, m), the first scale factor that reaches each limit state (inf: not reached), and "step" (1, m).
    Other analyses add "factors" (1, r, m), "reached" (1, s, r, m) and "weight" (1, r) of r scale factors: one for each
    stripe, or for each row of the record in a `selection`. An incremental analysis ends at the limits of ``[fragility]
    factors``; stripes beyond these limits are unknown.

    If a body is beside a wall, the arrays have two rows, one for the record and one for its reverse; both are of one
    earthquake. Raises ValueError if the record has no intense phase or the model rejects the record, and TooWeak if the
    PGA of the record is too small or the record is not in the selection.
    """
    with watch("condition"):
        scene = extract(motion.record, config, motion.vertical)
    settings, record = config.fragility, scene.record
    if selection is not None and record.id not in selection.rows:
        raise TooWeak(f"{record.id}: not in the table of [fragility] selection")
    if selection is None and record.pga < settings.pga_min:
        raise TooWeak(
            f"{record.id}: PGA {record.pga:.3g} m/s2 is below [fragility] pga_min = {settings.pga_min:g} m/s2"
        )
    pair = Pair(*motion.channels) if len(motion.channels) == 2 else None
    qualities = record_qualities(scene)
    facts = {"qualities": [qualities[name] for name in QUALITIES], **facts_of(scene)}
    if settings.data != "ida":
        facts["weight"] = _amounts(record.id, config, selection)[1]
    rows: list[dict[str, Any]] = []
    for reverse in (False, True) if np.any(np.asarray(lanes.block.side)) else (False,):
        found: dict[str, np.ndarray] = {}
        for place, numbers in places_of(lanes.bodies, record, pair, config):
            with watch("condition"):
                ground = turned(scene, place, pair, config)
                # A body beside a wall falls to one side only, so that the direction of the record matters.
                ground = _reversed(ground) if reverse else ground
                there = floor_scene(ground, place, config)
            own = np.flatnonzero(np.isin(lanes.owner, numbers))
            with watch("solve"):
                values = _capacity(ground, there, lanes.block.take(own), config, selection)
            for name, array in values.items():
                whole = np.empty((*array.shape[:-1], lanes.owner.size), dtype=array.dtype)
                found.setdefault(name, whole)[..., own] = array
        named = {"record": f"{record.id} reversed" if reverse else record.id, "source": record.source}
        rows.append({**found, **named, **facts})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def record_measures(scene: Scene, block: Block, names: tuple[str, ...]) -> np.ndarray:
    """Return the intensity measures (names, blocks) of an unscaled record, each in its own unit."""
    on = RecordOnBodies.slender(scene.record, lambda: scene.waves, block.weaker)
    return np.stack([np.broadcast_to(MEASURES[name].value(on), block.shape) for name in names])


def record_qualities(scene: Scene) -> dict[str, float]:
    """Return the properties of a record listed in QUALITIES, by name."""
    sizes = np.abs(scene.waves.between(scene.phase.start, scene.phase.end).impulse)
    return {
        "duration": scene.phase.duration,
        "period": 2.0 * math.pi * pgv(scene.record) / scene.record.pga,
        "strong_half_waves": float(np.count_nonzero(sizes > STRONG_SHARE * np.max(sizes, initial=0.0))),
    }


def _reversed(scene: Scene) -> Scene:
    waves = replace(scene.waves, impulse=-scene.waves.impulse, peak=-scene.waves.peak)
    return replace(scene, record=replace(scene.record, acceleration=-scene.record.acceleration), waves=waves)


def _amounts(record: str, config: Config, selection: SelectedRecords | None) -> np.ndarray:
    """Return (2, r): the scale factors, or levels of the stripe measure, that apply to a record, and their weights."""
    if selection is not None:
        own = selection.rows.get(record, ())
        return np.array([*own, *[(np.nan, 0.0)] * (selection.most - len(own))]).T
    levels = config.fragility.stripe_levels if config.fragility.data == "stripes" else (1.0,)
    return np.array([levels, np.ones(len(levels))])


def _capacity(
    ground: Scene, there: Scene, block: Block, config: Config, selection: SelectedRecords | None
) -> dict[str, np.ndarray]:
    """Return the intensity measures of `ground`, and the capacities of blocks whose base moves as in `there`."""
    settings, search = config.fragility, config.search
    measures = record_measures(ground, block, settings.measures)
    if settings.data == "ida":
        end = min(search.factor_max, settings.factors[1])
        first, step = scale_capacities(there, block, settings.limit_states, settings.equation, end, search.points)
        return {"measures": measures, "factors": first, "step": step}
    amounts, by_factor = _amounts(ground.record.id, config, selection)[0], settings.data == "cloud"
    if selection is not None:
        by_factor = selection.by_factor
    own = np.ones(1) if by_factor else record_measures(ground, block, (settings.stripe_measure,))
    factors = np.broadcast_to(amounts[:, np.newaxis] / own, (amounts.size, *block.shape))
    least, most = settings.factors if settings.data == "stripes" and selection is None else (0.0, np.inf)
    near = (factors >= least) & (factors <= most)
    # Scale factors that need no computation are replaced by zero, which takes no time.
    looked = reached_at(there, block, settings.limit_states, settings.equation, np.where(near, factors, 0.0))
    return {"measures": measures, "factors": factors, "reached": np.where(near, looked, NOT_KNOWN)}


def empty_capacity(lanes: int, config: Config, selection: SelectedRecords | None = None) -> Part:
    """Return the arrays of :func:`motion_capacity`, and "event", with no rows."""
    settings = config.fragility
    ida, states = settings.data == "ida", len(settings.limit_states)
    stripes = _amounts("", config, selection).shape[1]
    part = {
        "measures": np.zeros((0, len(settings.measures), lanes)),
        "qualities": np.zeros((0, len(QUALITIES))),
        "factors": np.zeros((0, states if ida else stripes, lanes)),
        **{name: np.zeros(0, dtype=str) for name in ("record", "source", "event")},
        **{name: fact.values([]) for name, fact in FACTS.items()},
    }
    if ida:
        return {**part, "step": np.zeros((0, lanes))}
    reached = np.zeros((0, states, stripes, lanes), dtype=np.int8)
    return {**part, "reached": reached, "weight": np.zeros((0, stripes))}
