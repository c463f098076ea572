"""``rockpulse assess``: records and blocks in, a results file and a table of verdicts out."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.commands.verb import Verb

if TYPE_CHECKING:
    from rockpulse.config import Config

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATHS",
        help="files, folders, zips or globs; they replace the paths of the configuration",
    )
    parser.add_argument("--config", metavar="FILE", help="configuration; rockpulse init-config writes one")
    parser.add_argument(
        "--block",
        action="append",
        default=[],
        metavar="NAME=WIDTHxHEIGHT",
        help="a block by its full width and height in m, beside those of the configuration; may be repeated",
    )
    parser.add_argument("--units", metavar="UNIT", help='unit of files that do not state theirs: "g", "cm/s2", ...')
    parser.add_argument(
        "--dt", type=float, metavar="SECONDS", help="sampling interval of columns without times, in s; such as 0.01"
    )
    parser.add_argument("-o", "--output", required=True, metavar="RESULTS", help="results file to write (HDF5)")
    parser.add_argument("--overwrite", action="store_true", help="replace results that exist; never any other file")
    parser.add_argument("--quiet", action="store_true", help="print nothing but what failed")


def _run(args: argparse.Namespace) -> int:
    from tqdm import tqdm

    from rockpulse.store import check_target, save

    config, paths = _resolve(args)
    check_target(args.output, args.overwrite)

    from rockpulse.assessment import assess
    from rockpulse.bodies import gather_bodies
    from rockpulse.failure_overview import failure_list
    from rockpulse.overview import overview
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
    save(tree, args.output, overwrite=args.overwrite)
    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        print(f"{overview(tree)}\n\nresults: {args.output}")
    elif failed:
        print(failed, file=sys.stderr)
    return 1 if failed else 0


def _resolve(args: argparse.Namespace) -> tuple[Config, list[str]]:
    """The configuration with what the command line adds, and the paths to read, as the user wrote them.

    The configuration itself, which is stored, names them absolutely, so that it repeats the run from any folder.
    """
    from dataclasses import replace

    from rockpulse.body import parse_block_option
    from rockpulse.config import Config, load_config, located
    from rockpulse.errors import ConfigError
    from rockpulse.readers.units import canonical_unit

    config = load_config(args.config) if args.config is not None else Config()
    paths = args.paths or [str(path) for path in config.record_paths()]
    if not paths:
        raise ConfigError("no records: name files, folders or globs, or give paths in the [records] section")
    records = replace(config.records, paths=tuple(str(located(path, Path.cwd())) for path in paths))
    if args.units is not None:
        records = replace(records, units=args.units)
    if args.dt is not None:
        try:
            records = replace(records, dt=args.dt)
        except ConfigError as error:
            raise ConfigError(f"--dt: {error}") from None
    if records.units is not None:
        canonical_unit(records.units, f"{args.config}: [records] units" if args.units is None else "--units")
    blocks = (*config.blocks, *(parse_block_option(option) for option in args.block))
    return replace(config, records=records, blocks=blocks), paths


VERB = Verb(
    name="assess",
    summary="assess blocks under records",
    description="Read records, let every model answer for every block, write the results and show the verdicts.",
    add_arguments=_add_arguments,
    run=_run,
)
