"""``rockpulse fragility``: compute fragility curves of bodies under records, with their confidence bands."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from rockpulse.commands.parser import Verb
from rockpulse.commands.running import batch_options, nothing_written, print_overview, recorded
from rockpulse.commands.shared_options import BATCH, from_records, resolved

if TYPE_CHECKING:
    import xarray as xr


def _run(args: argparse.Namespace) -> int:
    config, paths = resolved(args)

    from rockpulse.run.batch import fragility_files
    from rockpulse.storage.hdf5.results_file import load_tree
    from rockpulse.views.shared.files_used import failure_rows
    from rockpulse.views.text.fragility import fragility_overview
    from rockpulse.views.text.left_out import rows_not_used

    with recorded(args):
        report = fragility_files(paths, config, args.output, batch_options(args))
    if report.path is None:
        return nothing_written(report.failures, "used", args.quiet)

    def overview(tree: xr.DataTree) -> str:
        unused = rows_not_used(failure_rows(tree))
        return "\n\n".join(filter(None, (fragility_overview(tree), unused, f"results: {args.output}")))

    return print_overview(load_tree(report.path), args, overview)


VERB = Verb(
    name="fragility",
    summary="compute fragility curves of blocks under a set of records",
    description="Scale every record until each limit state is reached (or to given levels), fit fragility curves with "
    "confidence bands over earthquakes in every intensity measure, and report the dispersion of capacity in each "
    "measure. Limit states, measures and the way of scaling are set in section [fragility] of the configuration.",
    options=(from_records("RESULTS"), *BATCH),
    run=_run,
    examples=(
        "rockpulse fragility records/ --block wall=0.3x2.4 -o fragility.h5",
        "rockpulse fragility records/ --config site.toml -o fragility.h5",
    ),
)
