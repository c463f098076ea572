"""The report of speed against error: solvers against a stored reference, models against the nonlinear response."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from rockpulse.errors import ConfigError, Failure
from rockpulse.motions.votes import one_vote_each
from rockpulse.record.components import select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record
from rockpulse.storage.accuracy_variables import REPORT, TABLES
from rockpulse.studies.accuracy.bodies import bodies_table
from rockpulse.studies.accuracy.convergence import convergence
from rockpulse.studies.accuracy.model_form import (
    classifier_table,
    model_form_lanes,
    model_form_table,
    synthetic_records,
)
from rockpulse.studies.accuracy.reference import SYNTHETIC, load_reference, motion_of, motion_sha256, sample_motion
from rockpulse.studies.accuracy.statistics import grid_statistics
from rockpulse.studies.accuracy.work_precision import (
    DEFAULT_STEP,
    STEPS,
    TOLERANCES,
    Ground,
    evenly_spread,
    shared_cases,
    work_precision,
)

__all__ = ["FULL", "QUICK", "Effort", "accuracy", "table_of"]

logger = logging.getLogger("rockpulse")

Progress = Callable[[Sequence[Any]], Iterable[Any]]


@dataclass(frozen=True)
class Effort:
    """Amount of computing; ConfigError for less than one case or motion."""

    cases: int = 6  # cases of each equation that solve_ivp computes as well, at least 1
    reference_cases: int = 100_000  # most cases of the reference of each equation
    motions: int = 100  # synthetic motions of the ensemble, at least 1
    repeats: int = 5  # whole calls whose median is the cost of a kernel
    steps: tuple[float, ...] = STEPS  # longest steps of the kernels, as p dt [-]
    tolerances: tuple[tuple[str, float], ...] = TOLERANCES  # methods of solve_ivp with relative tolerances [-]

    def __post_init__(self) -> None:
        for name in ("cases", "reference_cases", "motions", "repeats"):
            if getattr(self, name) < 1:
                raise ConfigError(f"{name}: expected at least 1, got {getattr(self, name)}")


#: The default effort of the report: some minutes.
FULL = Effort()

#: Seconds: shows that everything works, measures little.
QUICK = Effort(
    cases=1, reference_cases=12, motions=4, repeats=1, steps=(0.08,), tolerances=(("RK45", 1e-3), ("RK45", 1e-6))
)


def accuracy(
    records: Iterable[Record] = (),
    failures: Iterable[Failure] = (),
    seed: int = 0,
    effort: Effort = FULL,
    progress: Progress | None = None,
) -> xr.DataTree:
    """Measure speed and error of the recorded models, and the model-form error of the cheap ones.

    The horizontal channels of the records, which are as read, are an ensemble of their own, beside the synthetic one
    (of several records of one shaking one is taken);
    those that the reference knows (the shipped samples) are cases of the first table too. `failures` are rows for the
    files and channels left out by reading. `seed` is that of the first synthetic motion of the ensemble, 0 to 2**32 - 1
    less their number; ConfigError otherwise. The cases of the reference are fixed. `progress` wraps a list of jobs on
    its way into the loop, as ``tqdm.tqdm`` does.

    The tree has one node per table of ``TABLES``: /work_precision, /synthetic_grid, /answers, /convergence,
    /bodies, /model_form, /classifiers, /failures.
    """
    if not 0 <= seed <= 2**32 - effort.motions:
        raise ConfigError(f"seed: expected 0 to {2**32 - effort.motions}, got {seed}")
    voting, outvoted = one_vote_each(list(records), advice="")
    horizontal, left_out = select_horizontal(voting, configured=False)
    rows = [*failures, *outvoted, *left_out]
    reference, ground = _reference(horizontal, effort)
    measured = work_precision(
        reference,
        ground,
        shared_cases(reference, effort.cases),
        effort.steps,
        effort.tolerances,
        effort.repeats,
        progress,
    )
    ensembles = [("records", record) for record in horizontal]
    ensembles += [("synthetic", record) for record in synthetic_records(seed, effort.motions)]
    lanes = []
    for ensemble, record in ensembles if progress is None else progress(ensembles):
        try:
            lanes.append(model_form_lanes(ensemble, record))
        except ValueError as error:
            logger.error("%s: %s", record.id, error)
            reason = str(error) if record.id in str(error) else f"{record.id}: {error}"
            rows.append(Failure(file=record.source, stage="accuracy", reason=reason, kind="failed"))
    every = pd.concat(lanes, ignore_index=True)
    tables = {
        "work_precision": measured.rows,
        "synthetic_grid": grid_statistics(measured.answers, reference, DEFAULT_STEP),
        "answers": measured.answers,
        "convergence": convergence(seed, min(20, effort.motions), repeats=effort.repeats),
        "bodies": bodies_table(seed, min(20, effort.motions), repeats=effort.repeats),
        "model_form": model_form_table(every),
        "classifiers": classifier_table(every),
        "failures": pd.DataFrame([asdict(row) for row in rows], columns=list(TABLES["failures"])),
    }
    tree = xr.DataTree.from_dict({f"/{name}": _dataset(name, table) for name, table in tables.items()})
    tree.attrs["kind"] = REPORT
    tree.attrs["title"] = "Speed and error of rocking solvers and models"
    tree.attrs["reference"] = reference.attrs["provenance"]
    tree.attrs["seed"] = seed
    tree.attrs["effort"] = ", ".join(f"{name} = {value}" for name, value in asdict(effort).items())
    tree.attrs["ensembles"] = "\n".join(
        f"{name}: {members['record'].nunique()} records" for name, members in every.groupby("ensemble", sort=False)
    )
    return tree


def table_of(tree: xr.DataTree, name: str) -> pd.DataFrame:
    """One table of the report, by its key in :data:`rockpulse.storage.accuracy_variables.TABLES`."""
    return tree[name].to_dataset().to_dataframe()[list(TABLES[name])]


def _reference(records: Iterable[Record], effort: Effort) -> tuple[pd.DataFrame, Ground]:
    """The cases of the reference whose motions are available, and a function that gives the motion of a case."""
    table = load_reference()
    known, stored = set(table["motion"]), set(table["motion_sha256"])
    named = {}
    for record in records:
        if record.id not in known:
            continue
        # A record of the same name but of other samples is none of the reference's.
        conditioned = condition(record)
        if motion_sha256(sample_motion(conditioned)) in stored:
            named[record.id] = conditioned
    at_hand = table[table["motion"].str.startswith(SYNTHETIC) | table["motion"].isin(list(named))]
    parts = [
        cases.iloc[evenly_spread(len(cases), effort.reference_cases)]
        for _, cases in at_hand.groupby("equation", sort=False)
    ]
    chosen = pd.concat(parts)
    chosen.attrs = table.attrs
    motions: dict[str, tuple[np.ndarray, float]] = {}

    def ground(row: Any) -> tuple[np.ndarray, float]:
        if row.motion_sha256 not in motions:
            motions[row.motion_sha256] = motion_of(row, named)
        return motions[row.motion_sha256]

    return chosen, ground


def _dataset(name: str, table: pd.DataFrame) -> xr.Dataset:
    return xr.Dataset({column: one.variable(table[column]) for column, one in TABLES[name].items()})
