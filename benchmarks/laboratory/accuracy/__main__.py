"""Speed and error of the solvers, and the error of the simpler models.

``python -m laboratory.accuracy PATHS -o FOLDER [--quick]`` (``make accuracy``) prints the tables, and writes them as
CSV files with the work-precision diagram. The horizontal channels of the records are a separate ensemble beside the
synthetic one. Those in the reference (the samples) are also cases of the first table.
"""

import argparse
import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from laboratory.accuracy.bodies import bodies_table
from laboratory.accuracy.convergence import convergence
from laboratory.accuracy.diagram import diagram
from laboratory.accuracy.model_form import classifier_table, model_form_lanes, model_form_table, synthetic_records
from laboratory.accuracy.reference import SYNTHETIC, load_reference, motion_of, motion_sha256, sample_motion
from laboratory.accuracy.statistics import grid_statistics
from laboratory.accuracy.work_precision import (
    DEFAULT_STEP,
    STEPS,
    TOLERANCES,
    Ground,
    evenly_spread,
    shared_cases,
    work_precision,
)
from laboratory.tables import plain, write_tables
from rockpulse.readers.folders import read_all
from rockpulse.record.components import select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record
from rockpulse.selection.duplicate_selection import without_duplicates
from rockpulse.views.plots.style import picture_bytes

#: Bias and dispersion of fewer survivors say nothing about an ensemble.
FEWEST_SURVIVORS = 5


@dataclass(frozen=True)
class Effort:
    """Amount of computing."""

    cases: int = 6  # cases of each equation that solve_ivp computes as well
    reference_cases: int = 100_000  # most cases of the reference of each equation
    motions: int = 100  # synthetic motions of the ensemble
    repeats: int = 5  # whole calls whose median is the cost of a kernel
    steps: tuple[float, ...] = STEPS  # longest steps of the kernels, as p dt [-]
    tolerances: tuple[tuple[str, float], ...] = TOLERANCES  # methods of solve_ivp with relative tolerances [-]


#: Seconds: shows that everything works, measures little.
QUICK = Effort(
    cases=1, reference_cases=12, motions=4, repeats=1, steps=(0.08,), tolerances=(("RK45", 1e-3), ("RK45", 1e-6))
)


def accuracy(records: Iterable[Record], effort: Effort, seed: int = 0) -> dict[str, pd.DataFrame]:
    """All tables, for records as read; of several records of one shaking one is taken.

    `seed` is that of the first synthetic motion of the ensemble. The cases of the reference are fixed.
    """
    selected, *_ = without_duplicates(list(records), advice="")
    horizontal, _ = select_horizontal(selected, configured=False)
    reference, ground = _reference(horizontal, effort)
    shared = shared_cases(reference, effort.cases)
    measured = work_precision(reference, ground, shared, effort.steps, effort.tolerances, effort.repeats)
    ensembles = [("records", record) for record in horizontal]
    ensembles += [("synthetic", record) for record in synthetic_records(seed, effort.motions)]
    lanes = pd.concat([model_form_lanes(*one) for one in ensembles], ignore_index=True)
    return {
        "work_precision": measured.rows,
        "synthetic_grid": grid_statistics(measured.answers, reference, DEFAULT_STEP),
        "answers": measured.answers,
        "convergence": convergence(seed, min(20, effort.motions), repeats=effort.repeats),
        "bodies": bodies_table(seed, min(20, effort.motions), repeats=effort.repeats),
        "model_form": model_form_table(lanes),
        "classifiers": classifier_table(lanes),
    }


def _reference(records: Iterable[Record], effort: Effort) -> tuple[pd.DataFrame, Ground]:
    """The cases of the reference whose motions are available, and a function that gives the motion of a case."""
    table = load_reference()
    known, stored = set(table["motion"]), set(table["motion_sha256"])
    named = {}
    for record in records:
        if record.id not in known:
            continue
        # A record of the same name with other samples is not in the reference.
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


def overview(tables: Mapping[str, pd.DataFrame]) -> str:
    """The tables as text: error and cost side by side, then the models by demand level."""
    error, cost, two = "{:.1e}".format, "{:.3g}".format, "{:.2f}".format
    of_solvers = dict.fromkeys(("solver", "call", "cases", "flips"), str)
    of_solvers |= dict.fromkeys(("median", "p90", "p99", "max", "p99_well"), error)
    of_solvers |= dict.fromkeys(("ns_per_active_sample", "ns_per_sample", "times_faster"), cost)
    of_grid = dict.fromkeys(("equation", "restitution", "step", "cases", "flips", "reference_flips"), str)
    of_grid |= dict.fromkeys(("median", "p99", "reference_p99"), error)
    of_steps = {"step": cost, "median": error, "p90": error, "ns_per_active_sample": cost, "order": two}
    of_bodies = dict.fromkeys(("kind", "cases", "flips"), str)
    of_bodies |= dict.fromkeys(("median", "p99", "max", "max_perturbed"), error)
    of_bodies |= dict.fromkeys(("ns_per_active_sample", "times_plain"), cost)
    of_demands = dict.fromkeys(("ensemble", "demand", "lanes", "overturn"), str) | {"auc": "{:.3f}".format}
    of_demands |= dict.fromkeys(("false_at_0", "false_at_5", "false_at_10"), "{:.0%}".format)
    rows = tables["work_precision"]
    solvers = rows.assign(solver=[f"{row.method}, {row.option} {row.setting:g}" for row in rows.itertuples()])
    parts = [
        "Error of theta_max/alpha_c against the reference, and cost of an active sample [ns]. flips: verdicts other "
        "than the reference's;\n*_well: cases that move by less than 1e-10 when C or the record changes by 1e-13 "
        "(method reference: what that change does).\nlanes: all blocks and factors of a motion in a call; single: a "
        "call a case, as of solve_ivp. times_faster: than RK45 at rtol 1e-6.",
        *(f"{equation} equation\n{plain(of, of_solvers)}" for equation, of in solvers.groupby("equation", sort=False)),
        "The synthetic grid, beside a change of the reference's input by 1e-13\n"
        + plain(tables["synthetic_grid"], of_grid),
        "Convergence of the nonlinear kernel on records of 10 Hz, without the control of the last term\n"
        + plain(tables["convergence"], of_steps),
        "Kinds of bodies: change of theta_max/alpha_c on samples divided in four, and by 1e-13 of the record\n"
        + plain(tables["bodies"], of_bodies),
        *(_models_text(str(name), of) for name, of in tables["model_form"].groupby("ensemble", sort=False)),
        "missed: overturns by the nonlinear model only; false: by the other one only. bias, dispersion: median and "
        "logarithmic\nstandard deviation of the ratio of peaks of the survivors (nonlinear peak above 0.05) that move.",
        f"Single numbers as classifiers of the verdict\n{plain(tables['classifiers'], of_demands)}",
    ]
    return "\n\n".join(parts)


def _models_text(ensemble: str, rows: pd.DataFrame) -> str:
    """A few lines for each model, a column for each level of demand."""
    heads = [_level(row) for row in rows[rows["model"] == rows["model"].iloc[0]].itertuples()]
    lines = []
    for model, members in rows.groupby("model", sort=False):
        enough = members["survivors"] - members["at_rest"] >= FEWEST_SURVIVORS
        own = members.assign(**{name: members[name].where(enough) for name in ("bias", "dispersion")})
        for name in ("missed", "false", "survivors", "unresolved", "bias", "dispersion"):
            show: Callable[[float], str] = "{:.2f}".format if name in ("bias", "dispersion") else "{:g}".format
            if name in ("missed", "false") or own[name].any():
                values = ["-" if np.isnan(value) else show(value) for value in own[name]]
                lines.append(dict(zip(["p PGV/(g tan a)", *heads], [f"{model}, {name}", *values], strict=True)))
    whole = rows.iloc[0]
    return (
        f"Models against the nonlinear response, {ensemble}: {whole['lanes']} lanes, {whole['overturn']} overturn\n"
        + plain(pd.DataFrame(lines))
    )


def _level(row: Any) -> str:
    if np.isinf(row.demand_high):
        return "all" if row.demand_low == 0.0 else f">= {row.demand_low:g}"
    return f"{row.demand_low:g}-{row.demand_high:g}"


def main() -> None:
    """Measure, write and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", help="files and folders of records: an ensemble of their own")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for tables and diagram")
    parser.add_argument("--units", help="unit of files that do not state theirs")
    parser.add_argument("--seed", type=int, default=0, help="seed of the synthetic ensemble")
    parser.add_argument("--quick", action="store_true", help="few cases and motions: seconds, and little to rely on")
    args = parser.parse_args()
    logging.disable(logging.WARNING)
    records, failures = read_all(args.paths, args.units)
    for row in failures:
        print(f"not used ({row.kind}): {row.reason}")
    tables = accuracy(records, QUICK if args.quick else Effort(), args.seed)
    write_tables(args.output, tables)
    (args.output / "accuracy.png").write_bytes(picture_bytes(diagram(tables["work_precision"]), "png"))
    print(overview(tables))


if __name__ == "__main__":
    main()
