"""``rockpulse calibrate``: the records of a site in, its design sequence and what is known of it out."""

from __future__ import annotations

import argparse
import sys

from rockpulse.commands.record_input import add_record_arguments, read_records, resolved
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_record_arguments(parser)
    parser.add_argument("-o", "--output", required=True, metavar="SITE", help="site file to write (HDF5)")


def _run(args: argparse.Namespace) -> int:
    from tqdm import tqdm

    from rockpulse.calibration.site_variables import SITE_KIND
    from rockpulse.store import check_target, save

    config, paths = resolved(args)
    check_target(args.output, args.overwrite, SITE_KIND)

    from rockpulse.bodies import gather_bodies
    from rockpulse.calibration.site_calibration import calibrate_site
    from rockpulse.errors import RecordRefused
    from rockpulse.failure_overview import failure_list
    from rockpulse.site_overview import site_overview

    if config.blocks:
        gather_bodies(config.blocks)  # a block that no model takes is better known before the records are read
    records, failures = read_records(paths, config, args.quiet)
    silent = True if args.quiet else None  # None: silent unless standard error is a terminal
    try:
        tree = calibrate_site(
            records,
            config,
            failures=failures,
            progress=lambda motions: tqdm(motions, desc="calibrating", unit=" records", disable=silent),
        )
    except RecordRefused as error:
        print(f"rockpulse: {error}\nrockpulse: nothing was written", file=sys.stderr)
        return 1
    save(tree, args.output, overwrite=args.overwrite)
    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        print(f"{site_overview(tree)}\n\nsite: {args.output}")
    elif failed:
        print(failed, file=sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="calibrate",
    summary="calibrate the design sequence of a site on its records",
    description="Read the records of a site, calibrate the impulse sequence of each, describe their distribution with "
    "intervals clustered by event, choose the design sequence at a quantile, and judge it on events left out.",
    add_arguments=_add_arguments,
    run=_run,
)
