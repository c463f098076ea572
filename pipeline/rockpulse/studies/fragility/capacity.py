"""The capacities of the bodies as one motion shows them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rocking.block import Block
from rockpulse.assessment.scene import extract
from rockpulse.config.configuration import Config
from rockpulse.errors import TooWeak
from rockpulse.ladder import Scene
from rockpulse.motions.directions import Motion
from rockpulse.motions.runner import Part, Watch
from rockpulse.storage.fact_variables import FACTS, facts_of
from rockpulse.studies.fragility.limit_states import NOT_KNOWN, reached_at, scale_capacities
from rockpulse.studies.fragility.measures import QUALITIES, record_measures, record_qualities

__all__ = ["motion_capacity", "nothing"]


def motion_capacity(motion: Motion, watch: Watch, block: Block, config: Config) -> Part:
    """The capacities of (m,) lanes under one motion, as arrays.

    "measures" (1, k, m) are those of the motion as it is, in the order of ``[fragility] measures``, "qualities" (1, c)
    those of :data:`rockpulse.studies.fragility.measures.QUALITIES`. An incremental analysis adds "factors" (1, s, m),
    the first that reaches each limit state, inf where none does, and "step" (1, m), the ratio of neighbouring factors
    of the scan; others add "factors" (1, r, m), those that were looked at, and "reached" (1, s, r, m), whether the
    limit state was. Beyond ``[fragility] factors`` a scaled record stands for no recorded one: an incremental analysis
    ends there, and a stripe has no answer.

    With a body before a wall the motion and its reverse are two rows, of one earthquake.

    Raises ValueError where the motion has no intense phase or the model refuses its numbers, TooWeak below the smallest
    PGA.
    """
    with watch("condition"):
        scene = extract(motion.record, config, motion.vertical)
    found = _capacity(scene, watch, block, config)
    if not np.any(np.asarray(block.side)):
        return found
    # A body before a wall falls to one side only, and the earthquake might have come from the other one.
    turned = replace(scene.record, acceleration=-scene.record.acceleration, id=f"{scene.record.id} reversed")
    waves = replace(scene.waves, impulse=-scene.waves.impulse, peak=-scene.waves.peak)
    other = _capacity(replace(scene, record=turned, waves=waves), watch, block, config)
    return {name: np.concatenate([values, other[name]]) for name, values in found.items()}


def _capacity(scene: Scene, watch: Watch, block: Block, config: Config) -> Part:
    """The capacities under one scene."""
    settings, record = config.fragility, scene.record
    if record.pga < settings.pga_min:
        raise TooWeak(
            f"{record.id}: PGA {record.pga:.3g} m/s2 is below [fragility] pga_min = {settings.pga_min:g} m/s2"
        )
    found: dict[str, object]
    with watch("solve"):
        if settings.data == "ida":
            search = config.search
            end = min(search.factor_max, settings.factors[1])
            capacities = scale_capacities(scene, block, settings.limit_states, settings.equation, end, search.points)
            found = {"factors": capacities.factors, "step": capacities.step}
        else:
            factors = np.ones((1, *block.shape))
            if settings.data == "stripes":
                own = record_measures(scene, block, (settings.stripe_measure,))
                factors = np.asarray(settings.stripe_levels)[:, None] / own
            least, most = settings.factors if settings.data == "stripes" else (0.0, np.inf)
            near = (factors >= least) & (factors <= most)
            # What is not looked at is not marched: a record at factor zero moves nothing.
            looked = reached_at(scene, block, settings.limit_states, settings.equation, np.where(near, factors, 0.0))
            reached = np.where(near, looked, NOT_KNOWN)
            found = {"factors": factors, "reached": reached}
        qualities = record_qualities(scene)
        found |= {
            "record": record.id,
            "source": record.source,
            "measures": record_measures(scene, block, settings.measures),
            "qualities": [qualities[name] for name in QUALITIES],
            **facts_of(scene),
        }
    return {name: np.array([values]) for name, values in found.items()}


def nothing(lanes: int, config: Config) -> Part:
    """The capacities without any motion: every array of :func:`motion_capacity`, and "event", without a row."""
    settings = config.fragility
    ida, states = settings.data == "ida", len(settings.limit_states)
    stripes = len(settings.stripe_levels) if settings.data == "stripes" else 1
    part = {
        "measures": np.zeros((0, len(settings.measures), lanes)),
        "qualities": np.zeros((0, len(QUALITIES))),
        "factors": np.zeros((0, states if ida else stripes, lanes)),
        **{name: np.zeros(0, dtype=str) for name in ("record", "source", "event")},
        **{name: fact.values([]) for name, fact in FACTS.items()},
    }
    if ida:
        return {**part, "step": np.zeros((0, lanes))}
    return {**part, "reached": np.zeros((0, states, stripes, lanes), dtype=np.int8)}
