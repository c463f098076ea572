"""``rockpulse fragility``: records and blocks in, fragility curves with their bands out."""

from __future__ import annotations

import argparse
import sys

from rockpulse.commands.progress import compiling_told, progress_bars
from rockpulse.commands.record_input import add_record_arguments, resolved
from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    add_record_arguments(parser, "RESULTS")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.storage.fragility_variables import FRAGILITY
    from rockpulse.storage.save_load import check_target, save

    config, paths = resolved(args)
    check_target(args.output, args.overwrite, FRAGILITY)

    from rockpulse.config.bodies import gather_bodies
    from rockpulse.readers.folders import read_all
    from rockpulse.studies.fragility.assessment import fragility_curves
    from rockpulse.views.text.fragility import fragility_overview
    from rockpulse.views.text.left_out import failure_list, not_used

    gather_bodies(config.blocks)  # a block that no model takes is better known before the records are read
    bars = progress_bars(args.quiet)
    with bars(desc="reading", unit=" files") as bar:
        records, failures = read_all(
            paths,
            config.records.units,
            on_file=lambda *_: bar.update(),
            dt=config.records.dt,
            response=config.records.response,
        )
    with compiling_told(args.quiet):
        tree = fragility_curves(
            records,
            config,
            failures=failures,
            progress=lambda motions: bars(motions, desc="scaling", unit=" records"),
        )
    if tree["capacities"].sizes["record"] == 0:
        tell(f"{failure_list(tree)}\nrockpulse: not one record could be used, nothing was written", sys.stderr)
        return 1
    save(tree, args.output, overwrite=args.overwrite)
    failed = failure_list(tree, kinds=("failed",))
    if not args.quiet:
        parts = (fragility_overview(tree), not_used(tree), f"results: {args.output}")
        tell("\n\n".join(part for part in parts if part))
    elif failed:
        tell(failed, sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="fragility",
    summary="fragility curves of blocks under a set of records",
    description="Scale every record until each limit state is reached (or to given levels), fit fragility curves with "
    "confidence bands over earthquakes in every intensity measure, and say which measure serves best. Limit states, "
    "measures and the way of scaling: section [fragility] of the configuration; without one its defaults.",
    add_arguments=_add_arguments,
    run=_run,
    examples=(
        "rockpulse fragility records/ --block wall=0.3x2.4 -o fragility.h5",
        "rockpulse fragility records/ --config site.toml -o fragility.h5",
    ),
)
