"""``rockpulse assess``: assess bodies under records or a design sequence; write results and print verdicts."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from rockpulse.commands.parser import command
from rockpulse.commands.shared_options import BATCH, configured, from_records, resolved
from rockpulse.commands.terminal import batch_options, nothing_written, print_overview, recorded
from rockpulse.errors import ConfigError

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config


def _under_sequence(args: argparse.Namespace, config: Config) -> xr.DataTree:
    from rockpulse.storage.hdf5.atomic import check_target
    from rockpulse.storage.hdf5.results_file import load_tree, save
    from rockpulse.studies.site.calibration import load_design

    check_target(args.output, args.overwrite)
    sequence = load_design(args.sequence)

    from rockpulse.assessment.assessment import assess_sequence

    quantile = float(load_tree(args.sequence)["site"]["quantile"])
    tree = assess_sequence(sequence, config, name=f"design sequence {quantile:g}", source=str(args.sequence))
    save(tree, args.output, overwrite=args.overwrite)
    return tree


@command(
    from_records("RESULTS"),
    {
        "--sequence SITE": "assess the design sequence of this site file (rockpulse calibrate) instead of PATHS",
        "--demand MEASURE=VALUE ...": "scale the records to this demand, such as pga=0.35g or 'sa(1.0)=0.4g', in "
        "place of the demands of the configuration; repeatable",
        "--all-models": "run all models, from resonance (upper bound) to the nonlinear equation, instead "
        "of [models] use",
    },
    *BATCH,
    {
        "--append": "keep the rows of RESULTS, and add the records that it does not contain yet; PATHS must also "
        "contain its earlier records, and options, bodies and program must be the same"
    },
    examples=(
        "rockpulse assess records/ --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess records/ --block wall=0.3x2.4 --demand pga=0.35g -o results.h5",
        "rockpulse assess records/ --config site.toml -o results.h5 --overwrite",
        "rockpulse assess history.csv --units cm/s2 --dt 0.01 --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess records/ --bodies bodies.csv --demand pga=0.35g -o results.h5",
        "rockpulse assess records/ more/ --config site.toml -o results.h5 --append",
        "rockpulse assess --sequence design.h5 --config site.toml -o bodies.h5",
    ),
)
def assess(args: argparse.Namespace) -> int:
    """Assess blocks under records, or under the design sequence of a site.

    Read records, run every model on every body, write the results and show the verdicts. With --sequence the input
    is the design sequence of a site, and only the models that accept a sequence are run.
    """
    of_records = ("paths", "units", "dt", "confirm", "workers", "scheduler", "resume", "append", "strict", "log_file")
    options = {name: "PATHS" if name == "paths" else f"--{name.replace('_', '-')}" for name in of_records}
    given = [option for name, option in options.items() if getattr(args, name)]
    if args.sequence is not None and given:
        raise ConfigError(f"--sequence replaces the records: remove {' and '.join(given)}, or --sequence")
    config, paths = resolved(args) if args.sequence is None else (configured(args), [])
    if args.demand:
        from rockpulse.config.settings import parse_demand_option

        config = replace(config, demands=tuple(map(parse_demand_option, args.demand)))
    if args.all_models:
        from rockpulse.model_table import ALL_MODELS

        config = replace(config, models=replace(config.models, use=ALL_MODELS))

    def overview(tree: xr.DataTree) -> str:
        from rockpulse.views.text.overview import overview

        return f"{overview(tree)}\n\nresults: {args.output}"

    if args.sequence is not None:
        return print_overview(_under_sequence(args, config), args, overview)

    from rockpulse.run.batch import assess_files
    from rockpulse.storage.hdf5.results_file import open_results_file

    with recorded(args):
        report = assess_files(paths, config, args.output, batch_options(args))
    if report.path is None:
        return nothing_written(report.failures, "assessed", args.quiet)
    with open_results_file(report.path) as file, file.reading():
        return print_overview(file.tree("summary", "directions", "failures"), args, overview)
