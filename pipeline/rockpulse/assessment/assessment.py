"""Assessment of bodies under records, or under the design spectrum or design sequence of a site."""

import math
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np
import xarray as xr

from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.assessment.record_assessment import assess_scene
from rockpulse.assessment.results import registered
from rockpulse.assessment.scene import extract, solver_options
from rockpulse.assessment.tree import EVENT, build_tree, empty_rows, empty_tree, record_part
from rockpulse.config.bodies import Bodies, gather_bodies, refuse_floors
from rockpulse.config.configuration import Config, given_config
from rockpulse.errors import ConfigError, Failure
from rockpulse.model_table import ALL_MODELS, MODELS, SEQUENCE_MODELS, Scene
from rockpulse.record.components import Pair
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record
from rockpulse.run.analysis import Analysis, Blocks, Part, Plan, Records, Watch, Work, run, selected
from rockpulse.selection.directions import Motion, PlannedMotion, planned_ids, swept_directions
from rockpulse.selection.tables import demand_selections
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.hdf5.atomic import ASSESSMENT
from rockpulse.storage.variables.assessment import ASSESSMENT_GROUPS
from rockpulse.warning_text import WarningText


def assess(
    records: Records,
    config: Config | str | os.PathLike[str] | None = None,
    bodies: Blocks | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
    *,
    units: str | None = None,
    dt: float | None = None,
    all_models: bool = False,
) -> xr.DataTree:
    """Assess bodies under records with every model of the configuration.

    Parameters
    ----------
    records : path, Record, or iterable of either
        Files, folders, globs and zip archives, read with the options of ``[records]`` as in :func:`rockpulse.read_all`;
        or all channels, as :func:`rockpulse.read` returns them. Vertical channels and, by default, structural ones are
        listed, not assessed; ``[records] components`` sets whether pairs of horizontal channels are rotated.
    config : Config or path, optional
        Options; by default the default settings.
    bodies : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of the bodies of the configuration; full sizes in m.
    failures : iterable of Failure
        Files and channels that were skipped on reading, to be stored with the results.
    progress : callable, optional
        Wraps the list of channels or pairs that are assessed, as ``tqdm.tqdm`` does.
    units, dt : str, float, optional
        Unit and sampling interval [s] of files that do not state them, in place of the values in ``[records]``.
    all_models : bool
        Whether to run every model, in place of ``[models] use``.

    Returns
    -------
    xarray.DataTree
        /summary, /half_cycles, /overturning_intervals, /failures, /directions for a sweep over direction, and /records
        unless switched off; see docs/schema.md. ``tree.rockpulse`` is a :class:`Results`, with the verdicts.

    Raises
    ------
    ConfigError
        If there is no body, two records have the same id, or a table of events does not match the records. A record
        that cannot be assessed is a row of /failures instead.

    Examples
    --------
    >>> rp.assess(record, bodies={"pier": (1.0, 4.0)}).rockpulse
    <Results 1 record, 1 body, model nonlinear>
    """
    asked = given_config(config, units, dt)
    if all_models:
        asked = replace(asked, models=replace(asked.models, use=ALL_MODELS))
    return registered(run(Assessment(asked, bodies), records, failures, progress))


class Assessment(Analysis):
    """The assessment: computes the response of every body to every record in every model."""

    name = "assess"
    doing = "assessing"
    kind = ASSESSMENT
    in_order_of_ids = False
    event_name = EVENT

    def __init__(self, config: Config, bodies: Blocks | None = None) -> None:
        super().__init__(config)
        self.bodies: Bodies = gather_bodies(config.bodies if bodies is None else bodies, config.records)

    @property
    def work(self) -> Work:
        """The function that assesses all bodies under one record."""
        return partial(assess_motion, bodies=self.bodies, config=self.config)

    @cached_property
    def empty_part(self) -> Part:
        """Arrays with no rows that have the names, types and other dimensions of the arrays of a part."""
        return empty_rows(self.bodies, self.config)

    def plan(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Plan:
        """Return the plan of all records or, if every demand has a table of records, of the records in these tables."""
        plan, tables = super().plan(records, failures), demand_selections(self.config)
        if not tables or len(tables) < len(self.config.demands):
            return plan
        of_motion = {
            one.name: [*planned_ids(one, self.config), *(channel.id for channel in one.channels)]
            for one in plan.planned
        }
        return selected(plan, {name for table in tables.values() for name in table}, of_motion, "[[demand]] selection")

    def dimension_of(self, name: str) -> str:
        """Return the first dimension of a variable, given by its path `name`."""
        group, _, name = name.rpartition("/")
        return ASSESSMENT_GROUPS[group][name].dims[0]

    @property
    def template(self) -> xr.DataTree:
        """The tree of results without any records."""
        return empty_tree(self.bodies, self.config)

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Return the tree with the results of all records and, if pairs were rotated, the statistics over direction."""
        return build_tree(parts, self.bodies, self.config, failures, swept_directions(planned, self.config))


def assess_motion(motion: Motion, watch: Watch, bodies: Bodies, config: Config) -> Part:
    """Assess all bodies under one record; raise ValueError if it has no intense phase, or if a model rejects it."""
    with watch("condition"):
        scene = extract(motion.record, config, motion.vertical)
    with watch("solve"):
        pair = Pair(*motion.channels) if len(motion.channels) == 2 else None
        assessment = assess_scene(scene, bodies, config, motion.pair, pair)
    with watch("pack"):
        return record_part(assessment)


#: Default name of a design sequence, in place of the id of a record.
NAME = "design sequence"


def assess_sequence(
    sequence: ImpulseSequence | DesignSpectrum,
    config: Config | str | os.PathLike[str] | None = None,
    bodies: Blocks | None = None,
    name: str = NAME,
    source: str = "",
) -> xr.DataTree:
    """Assess bodies under a design sequence or a design spectrum of a site, instead of under records.

    Parameters
    ----------
    sequence : ImpulseSequence or DesignSpectrum
        One sequence for all bodies, or a design spectrum; :func:`rockpulse.load_design` reads either.
    config : Config or path, optional
        The sections site, models, search and [[block]] are used, but not [[demand]], as a sequence has no PGA.
    bodies : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of the bodies of the configuration; full sizes in m.
    name, source : str
        Name of the sequence or spectrum, which replaces the id of a record in the results, and path of its file.

    Returns
    -------
    xarray.DataTree
        A tree as from :func:`rockpulse.assess`, with one row, in which the facts about a record are empty. Models that
        need a record (impulsive, linear, nonlinear) are omitted, with a warning. With a design spectrum every body has
        its own sequence, so that the model resonance and the columns of the sequence are omitted, too.

    Raises
    ------
    ConfigError
        If there is no body, for several sequences or an endless one, for bodies outside the spectrum, or if no model
        in ``[models] use`` can use the sequence.

    Examples
    --------
    >>> sequence = rp.models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    >>> rp.assess_sequence(sequence, bodies={"pier": (1.0, 4.0)}).rockpulse
    <Results 1 record, 1 body, model sequence, rocks 1>
    """
    asked_for = given_config(config)
    gathered = gather_bodies(asked_for.bodies if bodies is None else bodies)
    refuse_floors(gathered, "a design sequence is a ground motion")
    answering: tuple[str, ...] = SEQUENCE_MODELS
    what = "a sequence"
    if isinstance(sequence, DesignSpectrum):
        what, answering = "a design spectrum", tuple(name for name in SEQUENCE_MODELS if MODELS[name].paired)
        inside = np.all(gathered.per_case(sequence.covers(gathered.lanes)), axis=1)
        try:
            sequence = sequence.sequence(gathered.lanes)
        except ValueError as error:
            outside = [body for body, covered in zip(gathered.names, inside, strict=True) if not covered]
            advice = f"[[block]] {', '.join(outside)}: outside the spectrum's range; remove them. " if outside else ""
            raise ConfigError(f"{advice}{error}") from None
    elif sequence.shape:
        raise ConfigError(f"sequence: expected one sequence, found {sequence.shape[0]}")
    asked = asked_for.models.use
    use = tuple(model for model in asked if model in answering)
    if not use:
        raise ConfigError(f"[models] use: {', '.join(asked)} cannot be used with {what}; use {' or '.join(answering)}")
    endless = [model for model in use if MODELS[model].needs_end]
    if endless and sequence.main_count is None and math.isinf(sequence.duration):
        raise ConfigError(
            f"sequence: the {endless[0]} model needs main_count or duration; give one of them, or leave the model "
            "out of [models] use"
        )
    dropped = [model for model in asked if model not in use]
    config = replace(
        asked_for,
        models=replace(asked_for.models, use=use, histories=False),
        records=replace(asked_for.records, components="horizontal", azimuth=None, store="none"),
        sequence=replace(asked_for.sequence, spacing=sequence.spacing),
        uncertainty=replace(asked_for.uncertainty, probability=False, azimuth=False),
        demands=(),
    )
    # The record is zero, as the remaining models use only the sequence.
    rest = Record(np.zeros(2), dt=1.0, id=name, source=source)
    none = np.zeros(0)
    waves = HalfWaves(none, none, none, none, none, none, dt=rest.dt, record_id=name)
    phase = IntensePhase(0.0, float(np.max(sequence.duration)))
    scene = Scene(rest, None, waves, phase, sequence, **solver_options(config))
    done = replace(assess_scene(scene, gathered, config), shaken=False)
    warnings = list(done.record.warnings)
    if dropped:
        warnings.append(f"models left out, because they need a record and the input is {what}: {', '.join(dropped)}")
    if asked_for.demands:
        warnings.append(WarningText("demand_not_compared"))
    done = replace(done, scene=replace(done.scene, record=replace(done.record, warnings=tuple(warnings))))
    tree = build_tree([record_part(done) | {EVENT: np.array([""])}], gathered, config, [])
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to a sequence of impulses"
    return registered(tree)
