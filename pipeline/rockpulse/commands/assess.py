"""``rockpulse assess``: records or a design sequence and blocks in, a results file and a table of verdicts out."""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING

from rockpulse.commands.arguments import BATCH, batch_given, configured, from_records, resolved
from rockpulse.commands.parser import Verb
from rockpulse.commands.running import batch_options, nothing_written, recorded, told

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config


def _run(args: argparse.Namespace) -> int:
    return _of_records(args) if args.sequence is None else _of_sequence(args)


def _with_models(args: argparse.Namespace, config: Config) -> Config:
    """The configuration with every model, where the command line asks for them."""
    if not args.all_models:
        return config
    from dataclasses import replace

    from rockpulse.model_table import ALL_MODELS

    return replace(config, models=replace(config.models, use=ALL_MODELS))


def _of_records(args: argparse.Namespace) -> int:
    config, paths = resolved(args)
    config = _with_models(args, config)

    from rockpulse.run.batch import assess_files
    from rockpulse.storage.hdf5.results_file import open_results

    with recorded(args):
        report = assess_files(paths, config, args.output, batch_options(args))
    if report.path is None:
        return nothing_written(report.failures, "assessed", args.quiet)
    with open_results(report.path) as file, file.reading():
        return told(file.tree("summary", "directions", "failures"), args, partial(_overview, output=args.output))


def _of_sequence(args: argparse.Namespace) -> int:
    from rockpulse.errors import ConfigError
    from rockpulse.storage.hdf5.atomic import check_target
    from rockpulse.storage.hdf5.results_file import load, save
    from rockpulse.studies.site.calibration import load_design

    of_records = (("PATHS", args.paths), ("--units", args.units), ("--dt", args.dt), ("--confirm", args.confirm))
    given = [*(name for name, value in of_records if value), *batch_given(args)]
    if given:
        raise ConfigError(f"--sequence takes the place of the records: drop {' and '.join(given)}, or --sequence")
    config = _with_models(args, configured(args))
    check_target(args.output, args.overwrite)
    sequence = load_design(args.sequence)

    from rockpulse.assessment.assessment import assess_sequence

    quantile = float(load(args.sequence)["site"]["quantile"])
    name = f"design sequence {quantile:g}"
    tree = assess_sequence(sequence, config, name=name, source=str(args.sequence))
    save(tree, args.output, overwrite=args.overwrite)
    return told(tree, args, partial(_overview, output=args.output))


def _overview(tree: xr.DataTree, output: str) -> str:
    from rockpulse.views.text.overview import overview

    return f"{overview(tree)}\n\nresults: {output}"


VERB = Verb(
    name="assess",
    summary="assess blocks under records, or under the design sequence of a site",
    description="Read records, let every model answer for every block, write the results and show the verdicts. With "
    "--sequence the input is the design sequence of a site; the models that take a sequence answer.",
    options=(
        from_records("RESULTS"),
        {
            "--sequence SITE": "assess the design sequence of this site file (rockpulse calibrate), no PATHS",
            "--all-models": "every model side by side, from the upper bound of resonance to the nonlinear equation, in "
            "place of [models] use",
        },
        *BATCH,
    ),
    run=_run,
    examples=(
        "rockpulse assess records/ --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess records/ --config site.toml -o results.h5 --overwrite",
        "rockpulse assess history.csv --units cm/s2 --dt 0.01 --block wall=0.3x2.4 -o results.h5",
        "rockpulse assess --sequence design.h5 --config site.toml -o bodies.h5",
    ),
)
