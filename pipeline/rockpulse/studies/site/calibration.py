"""From the records of a site to its design sequence, with the uncertainty of everything on the way."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rocking.block import Block
from rockpulse.assessment.assessment import Watch, each_motion, unwatched
from rockpulse.assessment.directions import Motion, PlannedMotion, plan_motions, planned_ids
from rockpulse.assessment.events import event_table, events_by_id
from rockpulse.assessment.site_tables import read_weight_table, record_weights
from rockpulse.calibration.response_targets import block_family
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.bodies import gather_bodies
from rockpulse.config.configuration import Config, located
from rockpulse.config.settings import WEIGHTS
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.failures import Failure
from rockpulse.record.record import Record
from rockpulse.studies.site.record import SiteRecord, site_record
from rockpulse.studies.site.tree import build_site_tree

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SiteStudy", "calibrate_planned", "calibrate_site", "prepare_site", "site_family", "site_results"]


@dataclass(frozen=True, eq=False)
class SiteStudy:
    """What is known of the calibration of a site before the first record is calibrated.

    Attributes
    ----------
    names : tuple of str, length m
        Names of the blocks.
    lanes : Block
        (m,) blocks.
    event_of : dict of str to str
        Event of every channel, by its id.
    weights : dict of str to float or None
        The user's weights by record id; None where a rule gives them.
    unread : tuple of Failure
        What the table of events names and was not read.
    """

    names: tuple[str, ...]
    lanes: Block
    event_of: dict[str, str]
    weights: dict[str, float] | None
    unread: tuple[Failure, ...]


def calibrate_site(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Mapping[str, Block] | Sequence[BlockSettings] | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
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
        Wraps the list of channels or pairs on its way into the loop, as ``tqdm.tqdm`` does.

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
    >>> config = rp.Config(calibration=rp.CalibrationSettings(method="statistics"))
    >>> tree = rp.calibrate_site(shake, config, blocks={"pier": rp.models.Block(0.5, 3.0)})
    >>> int(tree["site"]["event_count"])
    2
    """
    config = config or Config()
    every = sorted(records, key=lambda record: record.id)
    rows = list(failures)
    planned, left_out = plan_motions(every, config)
    study = prepare_site(every, planned, config, blocks, rows)
    rows += left_out
    done: list[SiteRecord] = []
    for one in planned if progress is None else progress(planned):
        for outcome in calibrate_planned(one, study.lanes, config):
            if isinstance(outcome, Failure):
                rows.append(outcome)
            else:
                done.append(outcome)
    return site_results(done, study, config, rows)


def prepare_site(
    every: Sequence[Record],
    planned: Iterable[PlannedMotion],
    config: Config,
    blocks: Mapping[str, Block] | Sequence[BlockSettings] | None = None,
    failures: Iterable[Failure] = (),
) -> SiteStudy:
    """Read the tables, group the events and line up the blocks of a site.

    Parameters
    ----------
    every : sequence of Record
        All channels, sorted by id; nothing is asked of their samples.
    planned : iterable of PlannedMotion
        What is to be calibrated of them.
    config, blocks, failures
        As in :func:`calibrate_site`.

    Raises
    ------
    ConfigError
        For two records of one id, or tables of events or weights that do not fit.
    """
    twice = sorted(name for name, times in Counter(record.id for record in every).items() if times > 1)
    if twice:
        raise ConfigError(f"records: expected different ids, found more than one record with id {', '.join(twice)}")
    event_of, unread = events_by_id(every, event_table(config), failures)
    names, lanes = site_family(config.blocks if blocks is None else blocks)
    rule = config.calibration.weights
    table = None if rule in WEIGHTS else read_weight_table(located(rule, config.folder))
    known = [name for one in planned for name in planned_ids(one, config)]
    if table is not None and known:
        record_weights(known, [], rule, table)  # refused before the long part
    return SiteStudy(tuple(names), lanes, event_of, table, tuple(unread))


def calibrate_planned(
    planned: PlannedMotion, lanes: Block, config: Config, watch: Watch = unwatched
) -> Iterator[SiteRecord | Failure]:
    """Calibrate the sequence of a channel, or of a pair of channels in every direction that is asked for.

    Parameters
    ----------
    planned : PlannedMotion
        With the samples of its channels.
    lanes : Block
        (m,) blocks.
    config : Config
        Options.
    watch : callable, optional
        Measures the steps "condition", which is the rotation of a pair, and "solve", which is all the rest.

    Yields
    ------
    SiteRecord or Failure
        One for each motion, or the rows of a pair that cannot be rotated.
    """

    def calibrated(motion: Motion) -> SiteRecord:
        with watch("solve"):
            return site_record(motion, lanes, config)

    return each_motion(planned, config, "calibrate", calibrated, watch)


def site_results(
    done: Iterable[SiteRecord], study: SiteStudy, config: Config, failures: Sequence[Failure]
) -> xr.DataTree:
    """The design sequence of a site, from its calibrated records.

    Parameters
    ----------
    done : iterable of SiteRecord
        In any order.
    study : SiteStudy
        From :func:`prepare_site`.
    config : Config
        Options.
    failures : sequence of Failure
        What was left out.

    Returns
    -------
    xarray.DataTree
        As :func:`calibrate_site`.

    Raises
    ------
    ConfigError, RecordRefused
        As :func:`calibrate_site`.
    """
    done = sorted(done, key=lambda one: one.record.id)
    if not done:
        reasons = "".join(f"\n  {row.reason}" for row in failures if row.kind != "vertical")
        raise RecordRefused(f"not one record could be calibrated, so there is no site to describe{reasons}")
    events = [study.event_of[one.channel] for one in done]
    weights = record_weights([one.record.id for one in done], events, config.calibration.weights, study.weights)
    rows, remarks = [*failures, *study.unread], [row.reason for row in study.unread]
    return build_site_tree(done, events, weights, study.names, study.lanes, config, rows, remarks)


def site_family(blocks: Mapping[str, Block] | Sequence[BlockSettings]) -> tuple[list[str], Block]:
    """Names and lanes of the bodies whose rotations are to be covered; a body with several restitutions is several.

    Parameters
    ----------
    blocks : mapping of str to Block, or sequence of BlockSettings
        The bodies; without any a family of 100.

    Returns
    -------
    names : list of str, length m
    lanes : Block
        (m,) blocks.
    """
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
