"""``rockpulse risk``: a fragility file, or results and an inventory, and a hazard in, annual frequencies out."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from rockpulse.commands.telling import QUIET, tell
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "fragility",
        metavar="FRAGILITY",
        help="file of rockpulse fragility; with --bodies results of rockpulse assess with [uncertainty] spectrum = "
        '"all"',
    )
    parser.add_argument(
        "--bodies",
        metavar="TABLE",
        help='free bodies, any number, that the spectra of results stand for: a table (CSV) with the columns "name", '
        '"width [m]", "height [m]", perhaps "restitution"',
    )
    parser.add_argument(
        "--hazard",
        metavar="CURVE",
        help='hazard curve (CSV): "pga [g],rate" or "pga [g],probability in 50 years", OpenQuake\'s hazard curves, or '
        'return periods "TR [years],ag [g]"; in place of section [hazard]',
    )
    parser.add_argument(
        "--site",
        nargs=2,
        type=float,
        metavar=("LONGITUDE", "LATITUDE"),
        help="site in a curve of several [degrees]; the nearest one is taken",
    )
    parser.add_argument(
        "--config", metavar="CONFIG", help="configuration with a section [hazard]; default: that of the fragility"
    )
    parser.add_argument("--limit-state", default="overturning", metavar="STATE", help="default: overturning")
    parser.add_argument("--years", type=float, metavar="T", help="time for the probability; default: that of [hazard]")
    parser.add_argument(
        "--resamples", type=int, default=500, metavar="N", help="draws for the bands, 0 for none; default: 500"
    )
    parser.add_argument("-o", "--output", metavar="TABLE", help="write the table too (CSV)")
    parser.add_argument("--overwrite", action="store_true", help="replace a file that exists")
    parser.add_argument("--quiet", action="store_true", help=QUIET)


def _run(args: argparse.Namespace) -> int:
    from rockpulse.config.configuration import config_from_text, load_config
    from rockpulse.errors import ConfigError
    from rockpulse.storage.save_load import load
    from rockpulse.studies.risk.frequency import annual_frequency
    from rockpulse.studies.risk.hazard import hazard_of, load_hazard
    from rockpulse.studies.risk.inventory import inventory_frequency, read_inventory
    from rockpulse.views.shared.output_files import check_file, csv_bytes, write_files
    from rockpulse.views.text.risk import inventory_overview, inventory_table, risk_overview, risk_table

    if args.output is not None:
        check_file(args.output, args.overwrite)
    if args.hazard is not None and args.config is not None:
        raise ConfigError("--hazard, --config: expected one source of the hazard, found both")
    tree = load(args.fragility)
    config = config_from_text(str(tree.attrs["configuration"])) if args.config is None else load_config(args.config)
    settings = config.hazard
    if args.site is not None:
        settings = replace(settings, longitude=args.site[0], latitude=args.site[1])
    if args.hazard is None:
        hazard = hazard_of(settings, config.folder)
    else:
        hazard = load_hazard(args.hazard, None if args.site is None else tuple(args.site))
    years = settings.years if args.years is None else args.years
    if args.bodies is not None:
        names, block = read_inventory(args.bodies)
        found = inventory_frequency(tree, block, hazard, years).assign_coords(body=names)
        table, told = inventory_table(found), inventory_overview(found)
    else:
        found = annual_frequency(tree, hazard, args.limit_state, years, resamples=args.resamples)
        table, told = risk_table(found), risk_overview(found)
    if args.output is not None:
        write_files({Path(args.output): csv_bytes(table)})
    if not args.quiet:
        tell(told + (f"\n\ntable: {args.output}" if args.output else ""))
    return 0


VERB = Verb(
    name="risk",
    summary="annual frequency of overturning from a fragility file and a hazard curve",
    description="Sum the fragility of each body over the hazard of its site: annual frequency of a limit state with a "
    "band over earthquakes, probability in so many years, and the levels of the ground that contribute. The hazard is "
    "taken as known; where much comes from levels that nothing was looked at, that is said.",
    add_arguments=_add_arguments,
    run=_run,
    examples=(
        "rockpulse risk fragility.h5 --hazard curve.csv",
        "rockpulse risk fragility.h5 --config site.toml --years 100 -o risk.csv",
        "rockpulse risk results.h5 --bodies inventory.csv --hazard curve.csv -o risk.csv",
    ),
)
