"""``rockpulse calibrate``: derive the design spectrum and sequence of a site from records, with their uncertainty."""

import argparse
import sys

from rockpulse.commands.parser import Verb
from rockpulse.commands.running import batch_options, nothing_written, print_overview, recorded
from rockpulse.commands.shared_options import BATCH, from_records, resolved
from rockpulse.commands.terminal import tell


def _run(args: argparse.Namespace) -> int:
    config, paths = resolved(args)

    from rockpulse.errors import RecordRefused
    from rockpulse.run.batch import calibrate_files
    from rockpulse.storage.hdf5.results_file import load_tree
    from rockpulse.studies.site.calibration import NothingCalibrated
    from rockpulse.views.text.site import site_overview

    try:
        with recorded(args):
            calibrate_files(paths, config, args.output, batch_options(args))
    except NothingCalibrated as error:
        return nothing_written(error.failures, "calibrated", args.quiet)
    except RecordRefused as error:
        first = "; ".join(line.strip().partition("; ")[0] for line in str(error).splitlines())
        why = first if args.quiet else f"{error}\nrockpulse"
        tell(f"rockpulse: {why}: nothing was written", sys.stderr)
        return 1
    return print_overview(load_tree(args.output), args, lambda tree: f"{site_overview(tree)}\n\nsite: {args.output}")


VERB = Verb(
    name="calibrate",
    summary="derive the design spectrum and sequences of a site from its records",
    description="Read the records of a site, compute their overturning spectra and the quantiles of these over "
    "earthquakes, and derive the impulse sequence (I, I_s, dT, n) of the site for every body, with intervals by "
    "resampling of the earthquakes.",
    options=(from_records("SITE"), *BATCH),
    run=_run,
    examples=(
        "rockpulse calibrate records/ -o design.h5",
        "rockpulse calibrate records/ --config site.toml -o design.h5",
    ),
)
