"""Fragility of the bodies of a site under a set of records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from rocking.capacity import uplift_scale
from rockpulse.config.bodies import gather_bodies
from rockpulse.config.configuration import Config, given_config
from rockpulse.failures import Failure, some
from rockpulse.motions.directions import PlannedMotion, planned_ids
from rockpulse.motions.runner import Analysis, Blocks, Part, Prepared, Work, run
from rockpulse.motions.tables import selection_of
from rockpulse.motions.votes import unmatched_patterns
from rockpulse.record.record import Record
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.studies.fragility.capacity import Lanes, motion_capacity, nothing
from rockpulse.studies.fragility.results import build_fragility_tree

if TYPE_CHECKING:
    import xarray as xr


def fragility_curves(
    records: Iterable[Record],
    config: Config | None = None,
    blocks: Blocks | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
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
    blocks : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration; full sizes in m.
    failures : iterable of Failure
        Files and channels that reading has left out, to be stored with the results.
    progress : callable, optional
        Wraps the list of channels or pairs on its way into the loop, as ``tqdm.tqdm`` does.

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
    With ``data = "stripes"`` every record is scaled to each level, within ``[fragility] factors``, and the curve is the
    probability of reaching the limit state at a level. With ``data = "ida"`` capacity is the first factor that reaches
    it, and the curve the probability of reaching it at or below a level. Rotation need not grow with the factor, so the
    latter lies above the former (docs/decisions/012).

    Examples
    --------
    >>> import numpy as np, rockpulse as rp
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> record = rp.Record(3.0 * np.sin(2.0 * np.pi * t), dt=0.01, id="sine", processed=True)
    >>> tree = rp.fragility_curves([record], blocks={"pier": (1.0, 3.873)})
    >>> str(tree["fragility"]["statement"].sel(block="pier", limit_state="overturning", measure="pga").values)
    'no curve: one record only, 1.04 to 5.81 reached; a dispersion needs several'
    """
    return run(FragilityAnalysis(given_config(config), blocks), records, failures, progress)


class FragilityAnalysis(Analysis):
    """The capacity of every body under every motion, and the curves that all of them give."""

    name = "fragility"
    doing = "scaling"
    kind = FRAGILITY

    def __init__(self, config: Config, blocks: Blocks | None = None) -> None:
        super().__init__(config)
        bodies = gather_bodies(config.blocks if blocks is None else blocks, config.records)
        self.block_names, block, owner = bodies.apart()
        self.lanes = Lanes(block, bodies, owner)
        self.selection = selection_of(config)

    @property
    def work(self) -> Work:
        """Find the capacities of all bodies under a motion."""
        return partial(motion_capacity, lanes=self.lanes, config=self.config, selection=self.selection)

    @cached_property
    def nothing(self) -> Part:
        """Every array of a motion's capacities, without a row."""
        return nothing(len(self.block_names), self.config, self.selection)

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Fit the curves."""
        aloft = np.array([bool(self.lanes.bodies.floors[body]) for body in self.lanes.owner])
        known = ~aloft & (not self.config.records.include_vertical)
        lifting = uplift_scale(self.lanes.block, np.array([-1.0, 1.0]), self.config.fragility.equation)
        uplift = np.where(known, lifting, np.nan)
        return build_fragility_tree(
            parts, self.block_names, self.lanes.block, uplift, self.config, failures, self.selection
        )

    def prepare(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Prepared:
        """Plan the motions, of a selection those that it names; raises ConfigError also for one that is not there."""
        prepared = super().prepare(records, failures)
        if self.selection is None:
            return prepared
        of_motion = {one.name: planned_ids(one, self.config) for one in prepared.planned}
        known = [name for names in of_motion.values() for name in names]
        idle = unmatched_patterns("[fragility] selection", [*self.selection.rows], known, prepared.failures)
        kept = [one for one in prepared.planned if not self.selection.rows.keys().isdisjoint(of_motion[one.name])]
        rows = [*prepared.failures, *idle]
        if unchosen := sorted(of_motion.keys() - {one.name for one in kept}):
            told = f"{len(unchosen)} of {len(of_motion)} motions are not in the table: {some(unchosen, 3)}"
            rows.append(Failure("[fragility] selection", "select", told, "skipped"))
        return replace(prepared, planned=kept, failures=rows)
