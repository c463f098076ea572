"""Options of several commands, and functions that return the configuration or the selected rows from them."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.commands.parser import Either, Options, number
from rockpulse.commands.terminal import tell
from rockpulse.errors import ConfigError, ResultsError

if TYPE_CHECKING:
    from rockpulse.config.block_settings import BlockSettings
    from rockpulse.config.configuration import Config
    from rockpulse.config.settings import RecordSettings
    from rockpulse.storage.export.row_selection import RowSelection


#: Help text of --quiet.
QUIET = "print only one line that summarises failures"

#: Options for the unit and the sampling interval of files that do not state them.
READING: Options = {
    "--units UNIT": 'unit of acceleration of files that do not state it, such as "g" or "cm/s2"',
    "--dt SECONDS": ("sampling interval [s] of files of columns without times, such as 0.01", {"type": float}),
}


def from_records(output: str, written: str = "file to write (HDF5)", bodies: bool = True) -> Options:
    """Return the options of a command that reads records and writes a file: paths, configuration and bodies."""
    of_bodies: Options = {
        "--block NAME=WIDTHxHEIGHT ...": "a body by its full width and height in m, in addition to those of the "
        "configuration; repeatable",
        "--bodies TABLE": "a table of bodies (CSV or XLSX, see rockpulse init-config --bodies), in addition to those "
        "of the configuration",
        "--confirm-size": "accept a --block larger than 30 m, lower than 5 cm, narrower than 1 mm, or wider than high",
    }
    return {
        "PATHS": ("files, folders, zip archives or patterns of records; default: [records] paths", {"nargs": "*"}),
        f"-o --output {output} !": written,
        "--config FILE": "configuration file (TOML, see rockpulse init-config); default: all keys at their defaults, "
        "no bodies",
        **(of_bodies if bodies else {}),
        **READING,
        "--confirm PATTERN ...": "accept a peak above 5 g, a defect or a differing duplicate in channels with this id "
        "(* and ? are wildcards), which are rejected otherwise; repeatable",
        "--overwrite": "replace an existing results file, but no other file" if bodies else "replace existing files",
        "--quiet": QUIET,
    }


def _workers(text: str) -> int | str:
    if text == "all":
        return text
    from rockpulse.config.settings import MOST_WORKERS

    return int(number(int, 1, MOST_WORKERS, f'"all" or an integer from 1 to {MOST_WORKERS}')(text))


#: Options for workers and for stopped runs.
BATCH: tuple[Options, ...] = (
    Either(
        {
            "--workers N": (
                'number of worker processes, or "all" (one per core; none for few files); default: [run] workers',
                {"type": _workers},
            ),
            "--scheduler ADDRESS": "address of a dask.distributed scheduler to run on, such as tcp://10.0.0.1:8786",
        }
    ),
    {
        "--resume": "continue a stopped run with its finished records, or start a new run",
        "--strict": "stop at the first file or record that fails and write no output; --resume continues from the "
        "finished records",
        "--log-file FILE": "append log messages with their times to this file",
    },
)


#: Keywords of an option whose value is a number of items.
COUNT = {"type": number(int, 1, math.inf, "a whole number >= 1")}
#: Options that select a part of the results, besides ``--record`` and ``--block``, which the command defines itself.
SELECTION: Options = {
    "--model NAME ...": "only this model (* and ? are wildcards); repeatable",
    "--outcome WORD ...": "only this outcome: at_rest, rocks, overturns or unresolved; repeatable",
    "--where CONDITION ...": "only rows in which a variable or a column of the tables meets a condition: "
    "'factor_10 < 1', 'SF < 1', 'P > 0.5', 'source = *.AT2'; repeatable, all must be met",
    "--sort VARIABLE": "sort by this variable or column, the smallest values first and unknown values last",
    "--descending": "sort by --sort with the largest values first",
    "--limit N": ("at most N rows", COUNT),
}


def read_selection(args: argparse.Namespace) -> RowSelection:
    """Return the rows selected by --record, --block and the options of SELECTION; raise ResultsError for bad values."""
    from rockpulse.storage.export.row_selection import SHOWN, Condition, RowSelection

    if args.descending and args.sort is None:
        raise ResultsError("--descending: expected --sort VARIABLE as well, found none; add it")
    names = {dim: tuple(getattr(args, dim)) for dim in ("record", "block", "model") if getattr(args, dim)}
    conditions = [Condition.parse(words) for words in args.where]
    if args.outcome:
        conditions.append(Condition("outcome", "=", "|".join(args.outcome)))
    return RowSelection(names, tuple(conditions), SHOWN.get(args.sort, args.sort), args.descending, args.limit)


def reading_options(args: argparse.Namespace, settings: RecordSettings | None = None) -> RecordSettings:
    """Return section [records] with the values of --units and --dt, which also replace those of [[records.file]]."""
    from rockpulse.config.settings import RecordSettings
    from rockpulse.readers.kit.text import canonical_unit

    records = settings or RecordSettings()
    if args.units is not None:
        canonical_unit(args.units, "--units")
    elif records.units is not None:
        canonical_unit(records.units, f"{args.config}: [records] units")
    try:
        return records.for_all(args.units, args.dt)
    except ConfigError as error:
        raise ConfigError(f"--dt: {str(error).removeprefix('[records] dt: ')}") from None


def bodies_of_table(path: str) -> tuple[BlockSettings, ...]:
    """Return the bodies of a table file, and print which of its columns are not used."""
    from rockpulse.config.body_table import read_bodies, unused_columns

    bodies, unused = read_bodies(path)
    if unused:
        tell(unused_columns(path, unused), sys.stderr)
    return bodies


def configured(args: argparse.Namespace) -> Config:
    """Return the configuration of --config with the bodies of --block added, and absolute paths of tables."""
    from rockpulse.config.block_settings import parse_block_option
    from rockpulse.config.configuration import Config, load_config, located
    from rockpulse.config.settings import WEIGHTS

    config = load_config(args.config) if args.config is not None else Config()
    records, calibration = config.records, config.calibration
    if records.events is not None:
        records = replace(records, events=str(located(records.events, config.folder).resolve()))
    if calibration.weights not in WEIGHTS:
        calibration = replace(calibration, weights=str(located(calibration.weights, config.folder).resolve()))
    blocks = (*config.bodies, *(parse_block_option(one, args.confirm_size) for one in getattr(args, "block", ())))
    if table := getattr(args, "bodies", None):
        blocks = (*blocks, *bodies_of_table(table))
    return replace(config, records=records, calibration=calibration, bodies=blocks)


def resolved(args: argparse.Namespace) -> tuple[Config, list[str]]:
    """Return the configuration with absolute paths, and the paths of the records as they were given."""
    from rockpulse.config.configuration import located

    config = configured(args)
    paths = args.paths or [str(path) for path in config.record_paths()]
    if not paths:
        raise ConfigError(
            "no records: expected files, folders, zips or globs on the command line, or [records] paths in the "
            "configuration"
        )
    where = tuple(str(located(path, Path.cwd())) for path in paths)
    records = reading_options(args, config.records)
    confirm = tuple(dict.fromkeys((*records.confirm, *args.confirm)))
    return replace(config, records=replace(records, paths=where, confirm=confirm)), paths
