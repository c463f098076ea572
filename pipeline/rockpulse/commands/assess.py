"""``rockpulse assess``: records or a design sequence and blocks in, a results file and a table of verdicts out."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from rockpulse.commands.batch_input import add_batch_arguments, batch_given, batch_options, recorded
from rockpulse.commands.record_input import add_record_arguments, configured, resolved
from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_record_arguments(parser, "RESULTS")
    parser.add_argument(
        "--sequence",
        metavar="SITE",
        help="assess the design sequence of this site file (rockpulse calibrate), no PATHS",
    )
    add_batch_arguments(parser)


def _run(args: argparse.Namespace) -> int:
    return _of_records(args) if args.sequence is None else _of_sequence(args)


def _of_records(args: argparse.Namespace) -> int:
    config, paths = resolved(args)

    import xarray as xr

    from rockpulse.assessment.tree import failure_table
    from rockpulse.batch.run import assess_files
    from rockpulse.storage.hdf5_reader import open_results
    from rockpulse.views.text.left_out import failure_list

    with recorded(args):
        report = assess_files(paths, config, args.output, batch_options(args))
    if report.path is None:
        rows = xr.DataTree.from_dict({"/failures": failure_table(report.failures)})
        tell(f"{failure_list(rows)}\nrockpulse: not one record could be assessed, nothing was written", sys.stderr)
        return 1
    shown = ("failures",) if args.quiet else ("summary", "directions", "failures")
    with open_results(report.path) as file, file.reading():
        return _told(file.tree(*shown), args)


def _of_sequence(args: argparse.Namespace) -> int:
    from rockpulse.errors import ConfigError
    from rockpulse.storage.design_file import load_design
    from rockpulse.storage.save_load import check_target, load, save

    of_records = (("PATHS", args.paths), ("--units", args.units), ("--dt", args.dt))
    given = [*(name for name, value in of_records if value), *batch_given(args)]
    if given:
        raise ConfigError(f"--sequence takes the place of the records: drop {' and '.join(given)}, or --sequence")
    config = configured(args)
    check_target(args.output, args.overwrite)
    sequence = load_design(args.sequence)

    from rockpulse.assessment.design_sequence import assess_sequence

    quantile = float(load(args.sequence)["site"]["quantile"])
    name = f"design sequence {quantile:g}"
    tree = assess_sequence(sequence, config, name=name, source=str(args.sequence))
    save(tree, args.output, overwrite=args.overwrite)
    return _told(tree, args)


def _told(tree: xr.DataTree, args: argparse.Namespace) -> int:
    """Print the overview, or what failed alone; the exit code."""
    from rockpulse.views.text.left_out import failure_list
    from rockpulse.views.text.overview import overview

    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        tell(f"{overview(tree)}\n\nresults: {args.output}")
    elif failed:
        tell(failed, sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="assess",
    summary="assess blocks under records, or under the design sequence of a site",
    description="Read records, let every model answer for every block, write the results and show the verdicts. With "
    "--sequence the input is the design sequence of a site; the models that take a sequence answer.",
    add_arguments=_add_arguments,
    run=_run,
    examples=(
        "rockpulse assess records/ --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess records/ --config site.toml -o results.h5 --overwrite",
        "rockpulse assess history.csv --units cm/s2 --dt 0.01 --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess --sequence design.h5 --config site.toml -o bodies.h5",
    ),
)
