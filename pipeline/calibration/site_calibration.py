"""From the records of a site to its design sequence, with the uncertainty of everything on the way."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.bodies import gather_bodies
from rockpulse.body import BlockSettings
from rockpulse.calibration.response_targets import block_family
from rockpulse.calibration.site_record import SiteRecord, site_record
from rockpulse.calibration.site_tables import read_event_table, read_weight_table, record_weights
from rockpulse.calibration.site_tree import build_site_tree
from rockpulse.components import select_horizontal
from rockpulse.config import Config, located
from rockpulse.directions import Motion, acting_vertical, ground_motions
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.events import group_events
from rockpulse.failures import Failure
from rockpulse.models.block import Block
from rockpulse.record import Record
from rockpulse.settings import WEIGHTS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["calibrate_site"]

logger = logging.getLogger("rockpulse")


def calibrate_site(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Mapping[str, Block] | Sequence[BlockSettings] | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[Motion]], Iterable[Motion]] | None = None,
) -> xr.DataTree:
    """Calibrate the design sequence of a site on a set of records.

    Parameters
    ----------
    records : iterable of Record
        All channels, as :func:`rockpulse.read` returns them; chosen, rotated and conditioned as
        :func:`rockpulse.assess` does. The result does not depend on their order.
    config : Config, optional
        Sections records, conditioning, half_waves, intense_phase, sequence, calibration, run and the bodies; the
        defaults without.
    blocks : mapping of str to Block, or sequence of BlockSettings, optional
        The bodies whose rotations the design is to cover, in place of those of the configuration; where neither names
        one, a family of 100 (:func:`rockpulse.calibration.response_targets.block_family`).
    failures : iterable of Failure
        What reading has left out, to be stored with the results.
    progress : callable, optional
        Wraps the list of motions on its way into the loop, as ``tqdm.tqdm`` does.

    Returns
    -------
    xarray.DataTree
        /site and /failures, see docs/schema.md. What few records or events leave open is NaN, inf or a wide interval,
        and said in `remarks`.

    Raises
    ------
    ConfigError
        For two records of one id, or tables of events or weights that do not fit.
    RecordRefused
        Where not one record could be calibrated (one that cannot, among others, is a row of /failures), or the records
        make no design sequence: nothing rocks, or one record has no quantile.

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> shake = [
    ...     rp.Record(size * np.sin(2.0 * np.pi * t), dt=0.01, id=f"sine{size}", event=name, processed=True)
    ...     for size, name in ((2.5, "Kobe"), (3.0, "Maule"))
    ... ]
    >>> config = rp.Config(calibration=rp.config.CalibrationSettings(method="statistics"))
    >>> tree = rp.calibrate_site(shake, config, blocks={"pier": rp.models.Block(0.5, 3.0)})
    >>> int(tree["site"]["event_count"])
    2
    """
    config = config or Config()
    every = sorted(records, key=lambda record: record.id)
    twice = sorted(name for name, times in Counter(record.id for record in every).items() if times > 1)
    if twice:
        raise ConfigError(f"records: expected different ids, found more than one record with id {', '.join(twice)}")
    rows = list(failures)
    event_of, remarks = _events(every, config, any(row.kind == "failed" for row in rows))
    horizontal, left_out = select_horizontal(every, config.records.structural)
    motions, not_rotated = ground_motions(horizontal, config)
    motions.sort(key=lambda motion: motion.record.id)
    rows += [*left_out, *not_rotated]
    names, lanes = _family(config.blocks if blocks is None else blocks)
    rule = config.calibration.weights
    table = None if rule in WEIGHTS else read_weight_table(located(rule, config.folder))
    if table is not None:
        record_weights([motion.record.id for motion in motions], [], rule, table)  # refused before the long part
    verticals = [record for record in every if record.orientation == "vertical"]
    done: list[SiteRecord] = []
    events: list[str] = []
    for motion in motions if progress is None else progress(motions):
        record, vertical = acting_vertical(motion, verticals, config)
        try:
            done.append(site_record(record, motion.pair, vertical, lanes, config))
            events.append(event_of[motion.channels[0].id])
        except ValueError as error:  # RockpulseError, and what a model says of numbers it cannot take
            logger.error("%s: %s", record.id, error)
            reason = str(error) if record.id in str(error) else f"{record.id}: {error}"
            rows.append(Failure(file=record.source, stage="calibrate", reason=reason, kind="failed"))
    if not done:
        reasons = "".join(f"\n  {row.reason}" for row in rows if row.kind != "vertical")
        raise RecordRefused(f"not one record could be calibrated, so there is no site to describe{reasons}")
    weights = record_weights([one.record.id for one in done], events, rule, table)
    return build_site_tree(done, events, weights, names, lanes, config, rows, remarks)


def _events(every: Sequence[Record], config: Config, some_failed: bool) -> tuple[dict[str, str], list[str]]:
    """Event of every channel by its id, and what is to be said of the user's table."""
    named = {} if config.records.events is None else read_event_table(located(config.records.events, config.folder))
    ids = {record.id for record in every}
    remarks = []
    unknown = sorted(set(named) - ids)
    if unknown and some_failed:  # they may be those of the files that could not be read
        remarks.append(f"[records] events names records that were not read: {', '.join(unknown)}")
        named = {name: event for name, event in named.items() if name in ids}
    return dict(zip([record.id for record in every], group_events(every, named), strict=True)), remarks


def _family(blocks: Mapping[str, Block] | Sequence[BlockSettings]) -> tuple[list[str], Block]:
    """Names and lanes of the bodies whose rotations are to be covered; a body with several restitutions is several."""
    if not blocks:
        lanes = block_family()
        named = zip(lanes.p, lanes.alpha_c, lanes.restitution, strict=True)
        return [f"p {p:.3g} alpha {alpha:.3g} C {c:.3g}" for p, alpha, c in named], lanes
    bodies = gather_bodies(blocks)
    if bodies.cases == 1:
        return list(bodies.names), bodies.lanes
    cases = bodies.per_case(np.asarray(bodies.lanes.restitution))
    names = [f"{name} C {c:.4g}" for name, row in zip(bodies.names, cases, strict=True) for c in row]
    return names, bodies.lanes
