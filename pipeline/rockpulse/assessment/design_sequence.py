"""Bodies under a sequence of impulses in place of a record: the design sequence of a site."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.assessment.assessment import assess_scene
from rockpulse.assessment.results import registered
from rockpulse.assessment.scene import solver_options
from rockpulse.assessment.tree import EVENT, build_tree, record_part
from rockpulse.config.bodies import gather_bodies, refuse_aloft
from rockpulse.config.configuration import Config, given_config
from rockpulse.errors import ConfigError
from rockpulse.model_row import Scene
from rockpulse.model_table import MODELS, SEQUENCE_MODELS
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.intensity import IntensePhase
from rockpulse.record.record import Record
from rockpulse.remark import Remark
from rockpulse.run.analysis import Blocks
from rockpulse.sequences.design_spectrum import DesignSpectrum

if TYPE_CHECKING:
    import xarray as xr

#: The name of a design sequence in place of the id of a record, unless it is given another.
NAME = "design sequence"


def assess_sequence(
    sequence: ImpulseSequence | DesignSpectrum,
    config: Config | None = None,
    blocks: Blocks | None = None,
    name: str = NAME,
    source: str = "",
) -> xr.DataTree:
    """Assess bodies under the design of a site: one sequence of impulses for all of them, or one for each.

    Parameters
    ----------
    sequence : ImpulseSequence or DesignSpectrum
        One sequence, or a design spectrum, as :func:`rockpulse.load_design` reads them.
    config : Config, optional
        Sections site, models, search and the bodies are used; a [[demand]] is one on the PGA, which a sequence has not.
    blocks : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of those of the configuration; full sizes in m.
    name : str
        Id of the row that stands where a record would.
    source : str
        File that the sequence comes from.

    Returns
    -------
    xarray.DataTree
        As :func:`rockpulse.assess` returns it, with one row whose columns of a record are empty. The models that need a
        record (impulsive, linear, nonlinear) are left out, and a warning of the row says so; under a design
        spectrum resonance too, and the columns of the sequence are empty: every body has its own.

    Raises
    ------
    ConfigError
        Without a body, for several sequences or one that ends by no limit, for bodies outside the design spectrum, or
        where ``[models] use`` names no model that the design can be given to.

    Examples
    --------
    >>> import rockpulse as rp
    >>> sequence = rp.models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    >>> tree = rp.assess_sequence(sequence, blocks={"pier": (1.0, 3.873)})
    >>> tree["summary"]["model"].values.tolist()
    ['sequence']
    """
    asked_for = given_config(config)
    bodies = gather_bodies(asked_for.blocks if blocks is None else blocks)
    refuse_aloft(bodies, "a design sequence is one of the ground")
    answering: tuple[str, ...] = SEQUENCE_MODELS
    what = "a sequence"
    if isinstance(sequence, DesignSpectrum):
        what, answering = "a design spectrum", tuple(name for name in SEQUENCE_MODELS if MODELS[name].paired)
        inside = np.all(bodies.per_case(sequence.covers(bodies.lanes)), axis=1)
        outside = [body for body, covered in zip(bodies.names, inside.tolist(), strict=True) if not covered]
        try:
            sequence = sequence.sequence(bodies.lanes)
        except ValueError as error:
            told = f"[[block]] {', '.join(outside)}: leave out of the assessment under this design. " if outside else ""
            raise ConfigError(f"{told}{error}") from None
    elif sequence.shape:
        raise ConfigError(f"sequence: expected one sequence, found {sequence.shape[0]}")
    asked = asked_for.models.use
    use = tuple(model for model in asked if model in answering)
    if not use:
        raise ConfigError(
            f"[models] use: {', '.join(asked)} cannot answer {what}; it is answered by {' and '.join(answering)}"
        )
    endless = [model for model in use if MODELS[model].needs_end]
    if endless and sequence.main_count is None and math.isinf(sequence.duration):
        raise ConfigError(
            f"sequence: without main_count and duration the {endless[0]} model has no end; give one of them, or leave "
            "the model out of [models] use"
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
    # The ground is at rest: the models in use take the sequence and nothing else.
    rest = Record(np.zeros(2), dt=1.0, id=name, source=source)
    nothing = np.zeros(0)
    scene = Scene(
        record=rest,
        vertical=None,
        waves=HalfWaves(nothing, nothing, nothing, nothing, nothing, nothing, dt=rest.dt, record_id=name),
        phase=IntensePhase(0.0, float(np.max(sequence.duration))),
        sequence=sequence,
        **solver_options(config),
    )
    done = replace(assess_scene(scene, bodies, config), shaken=False)
    warnings = []
    if dropped:
        verb = "is" if len(dropped) == 1 else "are"
        warnings.append(f"{what}, not a record: {', '.join(dropped)} cannot answer it and {verb} left out")
    if asked_for.demands:
        warnings.append(Remark("demand_not_compared"))
    record = replace(done.record, warnings=(*done.record.warnings, *warnings))
    done = replace(done, scene=replace(done.scene, record=record))
    tree = build_tree([record_part(done) | {EVENT: np.array([""])}], bodies, config, [])
    tree.attrs["title"] = config.site.name or "Rocking response of rigid blocks to a sequence of impulses"
    return registered(tree)
