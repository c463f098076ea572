"""``rockpulse check``: check bodies according to design codes, and compare these checks with results of records."""

import argparse
from dataclasses import replace
from pathlib import Path

from rockpulse.commands.parser import Verb
from rockpulse.commands.shared_options import QUIET, bodies_of_table
from rockpulse.commands.terminal import tell
from rockpulse.config import CODES
from rockpulse.errors import ConfigError


def _run(args: argparse.Namespace) -> int:
    from rockpulse.config.configuration import load_config
    from rockpulse.files import check_file, write_files
    from rockpulse.storage.export.table_file import table_csv
    from rockpulse.studies.check.check import check
    from rockpulse.views.text.check import check_overview

    if args.output is not None:
        check_file(args.output, args.overwrite)
    config = args.config
    if args.bodies is not None:
        if config is None:
            raise ConfigError("--bodies: expected --config with a section [check] as well, found none")
        config = load_config(config)
        config = replace(config, bodies=(*config.bodies, *bodies_of_table(args.bodies)))
    found = check(args.results, config, args.code or None)
    if args.output is not None:
        write_files({Path(args.output): table_csv(found.to_dataframe().reset_index())})
    if not args.quiet:
        tell(check_overview(found) + (f"\n\ntable: {args.output}" if args.output else ""))
    return 0


VERB = Verb(
    name="check",
    summary="check the bodies by building codes, from their geometry and a design spectrum",
    description="Check each body by the kinematic analysis of Italian practice (Circolare 617/2009, Circolare 7/2019) "
    "and as a non-structural element of EN 1998-1, from its geometry and the spectrum of [check] alone. With results, "
    "also show the probability of overturning of the same body and, with a [[demand]], check the rotations under the "
    "records (C8.7.1.2.1.9). A check by a spectrum is not a model of rocking: some bodies that pass overturn, and many "
    "that fail do not.",
    options=(
        {
            "RESULTS": (
                "results of rockpulse assess: probability of overturning, and rotations at the demand",
                {"nargs": "?"},
            ),
            "--config CONFIG": "configuration with [[block]] and [check]; default: the one stored in the results",
            "--bodies TABLE": "a table of bodies (CSV or XLSX), in addition to those of the configuration",
            "--code CODE": (
                f"codes to check: {', '.join(CODES)}; default: all but the last",
                {"nargs": "*", "choices": CODES},
            ),
            "-o --output TABLE": "file for the table (CSV); default: the table is only printed",
            "--overwrite": "replace an existing file",
            "--quiet": QUIET,
        },
    ),
    run=_run,
    examples=(
        "rockpulse check --config site.toml --code",
        "rockpulse check --config site.toml --bodies bodies.csv",
        "rockpulse check results.h5 --config site.toml --code circolare_2019 -o check.csv",
    ),
)
