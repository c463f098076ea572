"""Common parts of the verbs that read records: their arguments, and the configuration that follows from them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.commands.telling import QUIET

if TYPE_CHECKING:
    from rockpulse.config.configuration import Config
    from rockpulse.config.settings import RecordSettings

__all__ = [
    "add_confirm_argument",
    "add_reading_arguments",
    "add_record_arguments",
    "configured",
    "reading_options",
    "resolved",
]


def add_reading_arguments(parser: argparse.ArgumentParser) -> None:
    """Add options for properties that a file may not state: units and sampling interval."""
    parser.add_argument("--units", metavar="UNIT", help='unit of files that do not state theirs: "g", "cm/s2", ...')
    parser.add_argument(
        "--dt", type=float, metavar="SECONDS", help="sampling interval of columns without times, in s; such as 0.01"
    )


def add_confirm_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that lets records count whose peak is hardly that of an earthquake."""
    parser.add_argument(
        "--confirm",
        action="append",
        default=[],
        metavar="PATTERN",
        help="a peak above 5 g is right in channels of this id, which fail without; * and ? stand for any letters; "
        "repeatable",
    )


def reading_options(args: argparse.Namespace, settings: RecordSettings | None = None) -> RecordSettings:
    """The section [records], or its defaults, with the options of :func:`add_reading_arguments`, checked.

    An option of the command line holds for all files, whatever the rows of [[records.file]] say.

    Raises ConfigError or UnitError for an interval or a unit that cannot be.
    """
    from dataclasses import replace

    from rockpulse.config.settings import RecordSettings
    from rockpulse.errors import ConfigError
    from rockpulse.readers.units import canonical_unit

    records = settings or RecordSettings()
    if args.units is not None:
        canonical_unit(args.units, "option --units")
        records = replace(records, units=args.units)
    elif records.units is not None:
        canonical_unit(records.units, f"option [records] units of {args.config}")
    if args.dt is not None:
        try:
            records = replace(records, dt=args.dt)
        except ConfigError as error:
            raise ConfigError(f"--dt: {str(error).removeprefix('[records] dt: ')}") from None
    left = []
    for row in records.files:
        units, dt = row.units if args.units is None else None, row.dt if args.dt is None else None
        if units is not None or dt is not None:
            left.append(replace(row, units=units, dt=dt))
    return replace(records, files=tuple(left))


def add_record_arguments(parser: argparse.ArgumentParser, output: str) -> None:
    """Add the paths, the output (called RESULTS or SITE), the configuration, blocks and units."""
    parser.add_argument(
        "paths",
        nargs="*",
        metavar="PATHS",
        help="files, folders, zips or globs; they replace the paths of the configuration",
    )
    parser.add_argument("-o", "--output", required=True, metavar=output, help="file to write (HDF5)")
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="configuration (TOML) on the template of rockpulse init-config; default: every key as there, no blocks",
    )
    parser.add_argument(
        "--block",
        action="append",
        default=[],
        metavar="NAME=WIDTHxHEIGHT",
        help="a block by its full width and height in m, beside those of the configuration; repeatable",
    )
    parser.add_argument(
        "--confirm-size",
        action="store_true",
        help="take a --block that is larger than 30 m, less than 5 cm high or 1 mm wide, or wider than high",
    )
    add_reading_arguments(parser)
    add_confirm_argument(parser)
    parser.add_argument("--overwrite", action="store_true", help="replace results that exist; never any other file")
    parser.add_argument("--quiet", action="store_true", help=QUIET)


def configured(args: argparse.Namespace) -> Config:
    """The configuration with the blocks of the command line, its tables named absolutely.

    Raises ConfigError for a configuration or block that cannot be understood.
    """
    from dataclasses import replace

    from rockpulse.config.block_settings import parse_block_option
    from rockpulse.config.configuration import Config, load_config, located
    from rockpulse.config.settings import WEIGHTS

    config = load_config(args.config) if args.config is not None else Config()
    records, calibration = config.records, config.calibration
    if records.events is not None:
        records = replace(records, events=str(located(records.events, config.folder).resolve()))
    if calibration.weighting not in WEIGHTS:
        calibration = replace(calibration, weights=str(located(calibration.weighting, config.folder).resolve()))
    blocks = (*config.blocks, *(parse_block_option(option, args.confirm_size) for option in args.block))
    return replace(config, records=records, calibration=calibration, blocks=blocks)


def resolved(args: argparse.Namespace) -> tuple[Config, list[str]]:
    """The configuration with the arguments of the command line, and the paths to read, as the user wrote them.

    The configuration itself, which is stored, names files absolutely, so that it repeats the run from any folder.
    Raises ConfigError without records, and for options that cannot be understood.
    """
    from dataclasses import replace

    from rockpulse.config.configuration import located
    from rockpulse.errors import ConfigError

    config = configured(args)
    paths = args.paths or [str(path) for path in config.record_paths()]
    if not paths:
        raise ConfigError("no records: name files, folders, zips or globs, or give paths in the [records] section")
    where = tuple(str(located(path, Path.cwd())) for path in paths)
    records = reading_options(args, config.records)
    confirm = tuple(dict.fromkeys((*records.confirm, *args.confirm)))
    return replace(config, records=replace(records, paths=where, confirm=confirm)), paths
