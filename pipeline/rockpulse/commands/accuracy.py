"""``rockpulse accuracy``: the speed and the error of the solvers, and the model-form error of the cheap models."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rockpulse.commands.arguments import add_reading_arguments, reading_options
from rockpulse.commands.batch_input import nothing_written
from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import QUIET, progress_bars, tell

__all__ = ["VERB"]

#: Tables that --csv writes.
CSV_TABLES = ("work_precision", "synthetic_grid", "convergence", "model_form", "classifiers")


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATHS",
        help="files, folders, zips or globs of records: an ensemble of their own beside the synthetic one; the shipped "
        "samples are cases of the reference too",
    )
    parser.add_argument("-o", "--output", required=True, metavar="REPORT", help="file to write (HDF5)")
    add_reading_arguments(parser)
    parser.add_argument("--csv", metavar="FOLDER", help=f"also write {', '.join(CSV_TABLES)} as CSV into this folder")
    parser.add_argument("--plot", metavar="FILE", help="also draw the work-precision diagram: .svg, .png or .pdf")
    parser.add_argument(
        "--cases",
        type=int,
        metavar="N",
        help="cases of each equation that solve_ivp computes, seconds each; default: 6",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the synthetic ensemble; default: 0")
    parser.add_argument("--quick", action="store_true", help="few cases and motions: seconds, and little to rely on")
    parser.add_argument("--overwrite", action="store_true", help="replace a report, tables or a diagram that exist")
    parser.add_argument("--quiet", action="store_true", help=QUIET)


def _run(args: argparse.Namespace) -> int:
    from dataclasses import replace

    from rockpulse.storage.accuracy_variables import REPORT
    from rockpulse.storage.save_load import check_target, save
    from rockpulse.views.shared.output_files import PICTURES, check_file, csv_bytes, csv_files, write_files

    check_target(args.output, args.overwrite, REPORT)
    picture = None if args.plot is None else check_file(args.plot, args.overwrite, PICTURES)
    tables = {} if args.csv is None else csv_files(args.csv, CSV_TABLES, args.overwrite)
    options = reading_options(args)

    from rockpulse.readers.folders import read_all
    from rockpulse.studies.accuracy.measurement import FULL, QUICK, accuracy, table_of
    from rockpulse.views.shared.files_used import count_files, failure_rows
    from rockpulse.views.text.accuracy import accuracy_overview
    from rockpulse.views.text.left_out import rows_not_used

    effort = QUICK if args.quick else FULL
    if args.cases is not None:
        effort = replace(effort, cases=args.cases)
    bars = progress_bars(args.quiet)
    records, failures = read_all(args.paths, options.units, dt=options.dt)
    if args.paths and not records:
        return nothing_written(failures, "read", args.quiet)
    tree = accuracy(
        records,
        failures,
        seed=args.seed,
        effort=effort,
        progress=lambda jobs: bars(jobs, desc="measuring"),
    )
    # The small files first: the report is there only if everything is.
    contents = {path: csv_bytes(table_of(tree, name)) for name, path in tables.items()}
    if picture is not None:
        from rockpulse.views.plots.picture import picture_bytes
        from rockpulse.views.plots.work_precision_diagram import work_precision

        figure = work_precision(table_of(tree, "work_precision"))[0].figure
        contents[picture] = picture_bytes(figure, picture.suffix[1:].lower())
    write_files(contents)
    save(tree, args.output, overwrite=args.overwrite)
    rows = failure_rows(tree)
    failed = count_files((record.source for record in records), rows).line
    if failed:
        listed = "" if args.quiet else rows_not_used([row for row in rows if row.kind == "failed"])
        tell("\n".join(filter(None, (listed, f"rockpulse: {failed}"))), sys.stderr)
    if not args.quiet:
        written = [args.output, *(map(str, tables.values())), *([] if picture is None else [str(picture)])]
        tell(f"{accuracy_overview(tree)}\n\nwritten: {', '.join(map(str, map(Path, written)))}")
    return 1 if failed else 0


VERB = Verb(
    name="accuracy",
    summary="measure speed and error of the models",
    description="Measure what the recorded models and scipy's solve_ivp cost and how far they are from a stored "
    "high-precision reference, and how far the cheap models are from the nonlinear one.",
    add_arguments=_add_arguments,
    run=_run,
    examples=("rockpulse accuracy -o accuracy.h5 --quick",),
)
