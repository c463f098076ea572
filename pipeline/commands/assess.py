"""``rockpulse assess``: records or a design sequence and blocks in, a results file and a table of verdicts out."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from rockpulse.commands.record_input import add_record_arguments, configured, read_records, resolved
from rockpulse.commands.verb import Verb

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_record_arguments(parser)
    parser.add_argument(
        "--sequence",
        metavar="SITE",
        help="assess the design sequence of this site file (rockpulse calibrate), no PATHS",
    )
    parser.add_argument("-o", "--output", required=True, metavar="RESULTS", help="results file to write (HDF5)")


def _run(args: argparse.Namespace) -> int:
    return _of_records(args) if args.sequence is None else _of_sequence(args)


def _of_records(args: argparse.Namespace) -> int:
    from tqdm import tqdm

    from rockpulse.store import check_target

    config, paths = resolved(args)
    check_target(args.output, args.overwrite)

    from rockpulse.assessment import assess
    from rockpulse.bodies import gather_bodies
    from rockpulse.failure_overview import failure_list

    gather_bodies(config.blocks)  # a block that no model takes is better known before the records are read
    records, failures = read_records(paths, config, args.quiet)
    silent = True if args.quiet else None  # None: silent unless standard error is a terminal
    tree = assess(
        records,
        config,
        failures=failures,
        progress=lambda horizontal: tqdm(horizontal, desc="assessing", unit=" records", disable=silent),
    )
    if tree["summary"].sizes["record"] == 0:
        print(
            f"{failure_list(tree)}\nrockpulse: not one record could be assessed, nothing was written", file=sys.stderr
        )
        return 1
    return _written(tree, args)


def _of_sequence(args: argparse.Namespace) -> int:
    from rockpulse.design_file import load_design
    from rockpulse.errors import ConfigError
    from rockpulse.store import check_target, load

    given = [name for name, value in (("PATHS", args.paths), ("--units", args.units), ("--dt", args.dt)) if value]
    if given:
        raise ConfigError(f"--sequence takes the place of the records: drop {' and '.join(given)}, or --sequence")
    config = configured(args)
    check_target(args.output, args.overwrite)
    sequence = load_design(args.sequence)

    from rockpulse.sequence_assessment import assess_sequence

    quantile = float(load(args.sequence)["site"]["quantile"])
    name = f"design sequence {quantile:g}"
    return _written(assess_sequence(sequence, config, name=name, source=str(args.sequence)), args)


def _written(tree: xr.DataTree, args: argparse.Namespace) -> int:
    """Save, print, and the exit code."""
    from rockpulse.failure_overview import failure_list
    from rockpulse.overview import overview
    from rockpulse.store import save

    save(tree, args.output, overwrite=args.overwrite)
    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        print(f"{overview(tree)}\n\nresults: {args.output}")
    elif failed:
        print(failed, file=sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="assess",
    summary="assess blocks under records, or under the design sequence of a site",
    description="Read records, let every model answer for every block, write the results and show the verdicts. With "
    "--sequence the input is the design sequence of a site; the models that take a sequence answer.",
    add_arguments=_add_arguments,
    run=_run,
)
