"""Fragility of the bodies of a site under a set of records."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rocking.block import Block
from rockpulse.assessment.directions import Motion, ground_motions
from rockpulse.assessment.events import event_table, events_by_id
from rockpulse.assessment.scene import extract, prepare
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.bodies import Bodies, gather_bodies
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError
from rockpulse.failures import Failure
from rockpulse.ladder import Scene
from rockpulse.record.record import Record
from rockpulse.studies.fragility.capacity import RecordCapacity, record_capacity
from rockpulse.studies.fragility.results import build_fragility_tree

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["fragility_curves", "lane_names"]

logger = logging.getLogger("rockpulse")


def fragility_curves(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Mapping[str, Block] | Sequence[BlockSettings] | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[Motion]], Iterable[Motion]] | None = None,
) -> xr.DataTree:
    """Fragility curves of bodies, with confidence bands over events, and which intensity measure serves best.

    Parameters
    ----------
    records : iterable of Record
        All channels, as :func:`rockpulse.read` returns them; chosen, rotated and conditioned as by
        :func:`rockpulse.assess`. The result does not depend on their order.
    config : Config, optional
        Sections records, conditioning, half_waves, intense_phase, search, fragility and the bodies; the defaults
        without.
    blocks : mapping of str to Block, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration.
    failures : iterable of Failure
        What reading has left out, to be stored with the results.
    progress : callable, optional
        Wraps the list of motions on its way into the loop, as ``tqdm.tqdm`` does.

    Returns
    -------
    xarray.DataTree
        /fragility, /capacities, /efficiency and /failures, see docs/schema.md. Where the records do not say what a
        curve needs its numbers are NaN and `statement` says why.

    Raises
    ------
    ConfigError
        Without a body, for two records of one id or a table of events that does not fit. A record that cannot be used
        is a row of /failures.

    Notes
    -----
    With ``data = "ida"`` capacity is the first factor that reaches the limit state, and the curve the probability of
    reaching it at or below a level. Rotation need not grow with the factor, so it lies above the probability at the
    level, which ``data = "stripes"`` gives (docs/decisions/015).

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> record = rp.Record(3.0 * np.sin(2.0 * np.pi * t), dt=0.01, id="sine", processed=True)
    >>> tree = rp.fragility_curves([record], blocks={"pier": rp.models.Block(half_width=0.5, half_height=1.9365)})
    >>> str(tree["fragility"]["statement"].sel(block="pier", limit_state="overturning", measure="pga").values)
    'no curve: one record only, 4.21 reached; a dispersion needs several'
    """
    config = config or Config()
    bodies = gather_bodies(config.blocks if blocks is None else blocks)
    every = sorted(records, key=lambda record: record.id)
    twice = sorted(name for name, times in Counter(record.id for record in every).items() if times > 1)
    if twice:
        raise ConfigError(f"records: expected different ids, found more than one record with id {', '.join(twice)}")
    failures = list(failures)
    event_of, unread = events_by_id(every, event_table(config), failures)
    failures += unread
    motions, left_out = ground_motions(every, config)
    motions.sort(key=lambda motion: motion.record.id)
    rows = [*failures, *left_out]
    done: list[RecordCapacity] = []
    clusters: list[str] = []
    for motion in motions if progress is None else progress(motions):
        record = motion.record
        try:
            scene = (extract if motion.pair else prepare)(record, config, motion.vertical)
            if scene.record.pga < config.fragility.pga_min:
                rows.append(_too_weak(scene, config.fragility.pga_min))
                continue
            done.append(record_capacity(scene, bodies.lanes, config))
            clusters.append(event_of[motion.channels[0].id])
        except ValueError as error:  # RockpulseError, and what a model says of numbers it cannot take
            logger.error("%s: %s", record.id, error)
            reason = str(error) if record.id in str(error) else f"{record.id}: {error}"
            rows.append(Failure(file=record.source, stage="fragility", reason=reason, kind="failed"))
    return build_fragility_tree(done, clusters, lane_names(bodies), bodies.lanes, config, rows)


def _too_weak(scene: Scene, smallest: float) -> Failure:
    record = scene.record
    reason = f"{record.id}: PGA {record.pga:.3g} m/s2 is below [fragility] pga_min = {smallest:g} m/s2"
    return Failure(file=record.source, stage="fragility", reason=reason, kind="skipped")


def lane_names(bodies: Bodies) -> list[str]:
    """Names of the lanes: those of the bodies, with the restitution where there are several.

    Parameters
    ----------
    bodies : Bodies
        The bodies.
    """
    if bodies.cases == 1:
        return list(bodies.names)
    ratios = bodies.per_case(np.asarray(bodies.lanes.restitution))
    return [f"{name} C {ratio:g}" for name, own in zip(bodies.names, ratios, strict=True) for ratio in own]
