"""Commands that check bodies by codes and compute annual frequencies: ``rockpulse check`` and ``risk``."""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from rockpulse.commands.parser import command
from rockpulse.commands.shared_options import QUIET, bodies_of_table
from rockpulse.commands.terminal import tell
from rockpulse.config import CODES
from rockpulse.errors import ConfigError


@command(
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
    examples=(
        "rockpulse check --config site.toml --code",
        "rockpulse check --config site.toml --bodies bodies.csv",
        "rockpulse check results.h5 --config site.toml --code circolare_2019 -o check.csv",
    ),
)
def check(args: argparse.Namespace) -> int:
    """Check the bodies by building codes, from their geometry and a design spectrum.

    Check each body by the kinematic analysis of Italian practice (Circolare 617/2009, Circolare 7/2019) and as a
    non-structural element of EN 1998-1, from its geometry and the spectrum of [check] alone. With results, also
    show the probability of overturning of the same body and, with a [[demand]], check the rotations under the
    records (C8.7.1.2.1.9). A check by a spectrum is not a model of rocking: some bodies that pass overturn, and
    many that fail do not.
    """
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


@command(
    {
        "FRAGILITY": "file of rockpulse fragility; with --bodies results of rockpulse assess with [uncertainty] "
        'spectrum = "all"',
        "--bodies TABLE": "any number of free bodies that the spectra of the results cover: a table (CSV or "
        'XLSX) with the columns "name", "width [m]", "height [m]", and optionally "restitution", "longitude" and '
        '"latitude", for the hazard of each body\'s own site, and "soil_factor"',
        "--hazard CURVE": 'hazard curve (CSV): "pga [g],rate" or "pga [g],probability in 50 years", OpenQuake\'s '
        'hazard curves, or return periods "TR [years],ag [g]", or the grid of NTC 2008; in place of section '
        "[hazard]",
        "--site LONGITUDE": (
            "position [degrees] of the site, for a file of several curves; the nearest one within 50 km is used",
            {"nargs": 2, "type": float, "metavar": ("LONGITUDE", "LATITUDE")},
        ),
        "--soil-factor S": (
            "soil factor S [-], a multiplier on the levels of a hazard on rock; default: [hazard] soil_factor",
            {"type": float},
        ),
        "--config CONFIG": "configuration with a section [hazard]; default: that of the fragility file",
        "--limit-state STATE": "limit state of the fragility file; default: overturning",
        "--years T": ("exposure time [years] of the probability; default: [hazard] years", {"type": float}),
        "--age YEARS": (
            "time [years] that the bodies have survived, to test whether it contradicts the hazard",
            {"type": float},
        ),
        "--resamples N": ("bootstrap samples for the bands, 0 for no bands; default: 500", {"type": int}),
        "-o --output TABLE": "file for the table (CSV); for a fragility file, TABLE_levels.csv is added with the "
        "contribution of each range of levels; default: the table is only printed",
        "--overwrite": "replace an existing file",
        "--quiet": QUIET,
    },
    examples=(
        "rockpulse risk fragility.h5 --hazard curve.csv",
        "rockpulse risk fragility.h5 --config site.toml --years 100 -o risk.csv",
        "rockpulse risk results.h5 --bodies inventory.csv --hazard curve.csv -o risk.csv",
        "rockpulse risk results.h5 --bodies rocks.csv --hazard curve.csv --age 10000",
    ),
)
def risk(args: argparse.Namespace) -> int:
    """Compute the annual frequency of overturning from a fragility file and a hazard curve.

    Integrate the fragility of each body over the hazard curve of its site: annual frequency of a limit state with a
    band over earthquakes, probability in a number of years, and the levels of ground motion that contribute. The
    hazard is taken as known; a warning is given if much of the frequency comes from levels that were not analysed.
    """
    from rockpulse.config.body_table import unused_columns
    from rockpulse.files import check_file, write_files
    from rockpulse.storage.export.table_file import table_csv
    from rockpulse.studies.risk.frequency import standing_test
    from rockpulse.studies.risk.inventory import read_inventory
    from rockpulse.studies.risk.risk import risk
    from rockpulse.views.text import risk as text

    if args.bodies is not None and (args.limit_state is not None or args.resamples is not None):
        raise ConfigError(
            "--bodies: cannot be combined with --limit-state or --resamples, because the spectra contain only the "
            "probability of overturning, and the band of an inventory needs no resamples; remove those options, or "
            "give a fragility file"
        )
    limit_state = args.limit_state or "overturning"
    if args.age is not None and limit_state != "overturning":
        raise ConfigError(
            f"--age: expected --limit-state overturning, because the bodies are still standing, found {limit_state}"
        )
    files = [] if args.output is None else [Path(args.output)]
    if files and args.bodies is None:  # a second file with the annual frequency at each intensity level
        files.append(files[0].with_name(f"{files[0].stem}_levels{files[0].suffix}"))
    for path in files:
        check_file(path, args.overwrite)
    if args.hazard is not None and args.config is not None:
        raise ConfigError("--hazard, --config: expected one source of the hazard, found both")
    bodies = None if args.bodies is None else read_inventory(args.bodies)
    if bodies is not None and bodies.passed_over:
        tell(unused_columns(args.bodies, bodies.passed_over), sys.stderr)
    found = risk(
        args.fragility,
        args.hazard,
        limit_state,
        args.years,
        resamples=500 if args.resamples is None else args.resamples,
        config=args.config,
        site=args.site,
        soil_factor=args.soil_factor,
        bodies=bodies,
    )
    standing = None if args.age is None else standing_test(found, args.age)
    if args.bodies is not None:
        contents = [text.inventory_table(found, standing)]
        shown, warnings = text.inventory_overview(found), text.inventory_warnings(found)
    else:
        contents = [text.risk_table(found, standing), text.levels_table(found)]
        shown, warnings = text.risk_overview(found), text.risk_warnings(found)
    write_files({path: table_csv(table) for path, table in zip(files, contents, strict=False)})
    if not args.quiet:
        shown += f"\n\n{text.standing_overview(standing)}" if standing is not None else ""
        tell(shown + (f"\n\ntable: {', '.join(map(str, files))}" if files else ""))
        for words in warnings:
            tell(f"warning: {words}", sys.stderr)
    return 0
