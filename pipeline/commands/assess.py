"""``rockpulse assess``: records and blocks in, a results file and a table of verdicts out."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rockpulse.config import Config

__all__ = ["add_parser", "run"]


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb.

    Parameters
    ----------
    subparsers : argparse subparsers
        What ``add_subparsers`` returned.
    """
    parser = subparsers.add_parser(
        "assess",
        help="assess blocks under records",
        description="Read records, let every model answer for every block, write the results and show the verdicts.",
    )
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
    parser.add_argument("-o", "--output", required=True, metavar="RESULTS", help="results file to write (HDF5)")
    parser.add_argument("--overwrite", action="store_true", help="replace a results file that exists")
    parser.add_argument("--quiet", action="store_true", help="print nothing but what failed")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, assess, save, print.

    Parameters
    ----------
    args : argparse.Namespace
        Arguments of the verb.

    Returns
    -------
    int
        0, or 1 where a file or record failed.

    Raises
    ------
    ConfigError
        For a wrong configuration, no records or no blocks named.
    ResultsError
        Where the results cannot be written.
    """
    from tqdm import tqdm

    from rockpulse.store import check_target, save

    config, paths = _resolve(args)
    check_target(args.output, args.overwrite)

    from rockpulse.assessment import assess
    from rockpulse.bodies import gather_bodies
    from rockpulse.overview import failure_list, overview
    from rockpulse.sources import read_all

    gather_bodies(config.blocks)  # a block that no model takes is better known before the records are read
    silent = True if args.quiet else None  # None: silent unless standard error is a terminal
    with tqdm(desc="reading", unit=" files", disable=silent) as bar:
        records, failures = read_all(paths, config.records.units, on_file=lambda *_: bar.update())
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
    """The configuration with what the command line adds, and the paths to read."""
    from dataclasses import replace

    from rockpulse.body import parse_block_option
    from rockpulse.config import Config, load_config
    from rockpulse.errors import ConfigError
    from rockpulse.readers.units import canonical_unit

    config = load_config(args.config) if args.config is not None else Config()
    paths = args.paths or [str(path) for path in config.record_paths()]
    if not paths:
        raise ConfigError("no records: name files, folders or globs, or give paths in the [records] section")
    records = replace(
        config.records,
        paths=tuple(args.paths) or config.records.paths,
        units=config.records.units if args.units is None else args.units,
    )
    if records.units is not None:
        canonical_unit(records.units, f"{args.config}: [records] units" if args.units is None else "--units")
    blocks = (*config.blocks, *(parse_block_option(option) for option in args.block))
    return replace(config, records=records, blocks=blocks), paths
