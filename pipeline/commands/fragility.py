"""``rockpulse fragility``: records and blocks in, fragility curves with their bands out."""

from __future__ import annotations

import argparse
import sys

from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATHS",
        help="files, folders, zips or globs; they replace the paths of the configuration",
    )
    parser.add_argument(
        "--config", required=True, metavar="FILE", help="configuration with the blocks and the section [fragility]"
    )
    parser.add_argument("-o", "--output", required=True, metavar="RESULTS", help="file to write (HDF5)")
    parser.add_argument("--overwrite", action="store_true", help="replace a fragility file that exists; never another")
    parser.add_argument("--quiet", action="store_true", help="print nothing but what failed")


def _run(args: argparse.Namespace) -> int:
    from dataclasses import replace
    from pathlib import Path

    from rockpulse.config import load_config, located
    from rockpulse.errors import ConfigError
    from rockpulse.fragility.variables import FRAGILITY
    from rockpulse.store import check_target, save

    config = load_config(args.config)
    paths = args.paths or [str(path) for path in config.record_paths()]
    if not paths:
        raise ConfigError("no records: name files, folders or globs, or give paths in the [records] section")
    where = tuple(str(located(path, Path.cwd())) for path in paths)
    config = replace(config, records=replace(config.records, paths=where))
    check_target(args.output, args.overwrite, FRAGILITY)

    from tqdm import tqdm

    from rockpulse.bodies import gather_bodies
    from rockpulse.failure_overview import failure_list, not_used
    from rockpulse.fragility.assessment import fragility_curves
    from rockpulse.fragility_overview import fragility_overview
    from rockpulse.sources import read_all

    gather_bodies(config.blocks)  # a block that no model takes is better known before the records are read
    silent = True if args.quiet else None  # None: silent unless standard error is a terminal
    with tqdm(desc="reading", unit=" files", disable=silent) as bar:
        records, failures = read_all(
            paths,
            config.records.units,
            on_file=lambda *_: bar.update(),
            dt=config.records.dt,
            response=config.records.response,
        )
    tree = fragility_curves(
        records,
        config,
        failures=failures,
        progress=lambda motions: tqdm(motions, desc="scaling", unit=" records", disable=silent),
    )
    if tree["capacities"].sizes["record"] == 0:
        print(f"{failure_list(tree)}\nrockpulse: not one record could be used, nothing was written", file=sys.stderr)
        return 1
    save(tree, args.output, overwrite=args.overwrite)
    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        print(
            "\n\n".join(part for part in (fragility_overview(tree), not_used(tree), f"results: {args.output}") if part)
        )
    elif failed:
        print(failed, file=sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="fragility",
    summary="fragility curves of blocks under a set of records",
    description="Scale every record until each limit state is reached (or to given levels), fit fragility curves with "
    "confidence bands over earthquakes in every intensity measure, and say which measure serves best.",
    add_arguments=_add_arguments,
    run=_run,
)
