"""Commands that read records for a site or a study: ``rockpulse calibrate``, ``fragility`` and ``select``."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from rockpulse.commands.parser import command
from rockpulse.commands.shared_options import BATCH, COUNT, from_records, resolved
from rockpulse.commands.terminal import (
    batch_options,
    nothing_written,
    print_overview,
    progress_bars,
    recorded,
    tell,
    warn,
)

if TYPE_CHECKING:
    import xarray as xr


@command(
    from_records("SITE"),
    *BATCH,
    examples=(
        "rockpulse calibrate records/ -o design.h5",
        "rockpulse calibrate records/ --config site.toml -o design.h5",
    ),
)
def calibrate(args: argparse.Namespace) -> int:
    """Derive the design spectrum and sequences of a site from its records.

    Read the records of a site, compute their overturning spectra and the quantiles of these over earthquakes, and
    derive the impulse sequence (I, I_s, dT, n) of the site for every body, with intervals by resampling of the
    earthquakes.
    """
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
        warn(f"{why}: nothing was written")
        return 1
    return print_overview(load_tree(args.output), args, lambda tree: f"{site_overview(tree)}\n\nsite: {args.output}")


@command(
    from_records("RESULTS"),
    *BATCH,
    examples=(
        "rockpulse fragility records/ --block wall=0.3x2.4 -o fragility.h5",
        "rockpulse fragility records/ --config site.toml -o fragility.h5",
    ),
)
def fragility(args: argparse.Namespace) -> int:
    """Compute fragility curves of blocks under a set of records.

    Scale every record until each limit state is reached (or to given levels), fit fragility curves with confidence
    bands over earthquakes in every intensity measure, and report the dispersion of capacity in each measure. Limit
    states, measures and the way of scaling are set in section [fragility] of the configuration.
    """
    config, paths = resolved(args)

    from rockpulse.run.batch import fragility_files
    from rockpulse.storage.hdf5.results_file import load_tree
    from rockpulse.views.shared.files_used import failure_rows, rows_not_used
    from rockpulse.views.text.fragility import fragility_overview

    with recorded(args):
        report = fragility_files(paths, config, args.output, batch_options(args))
    if report.path is None:
        return nothing_written(report.failures, "used", args.quiet)

    def overview(tree: xr.DataTree) -> str:
        unused = rows_not_used(failure_rows(tree))
        return "\n\n".join(filter(None, (fragility_overview(tree), unused, f"results: {args.output}")))

    return print_overview(load_tree(report.path), args, overview)


@command(
    from_records("TABLE", "table to write (CSV); the picture beside it has the suffix .png", bodies=False),
    {
        "-n --number N": ("number of records, or of pairs; default: [selection] records", COUNT),
        "--language LANGUAGE": ("language of the picture: en (default) or it", {"default": "en"}),
    },
    examples=("rockpulse select records/ --config site.toml -n 5 -o selection.csv",),
)
def select(args: argparse.Namespace) -> int:
    """Select records whose mean spectrum fits a target spectrum.

    Select records, or pairs of channels, and their scale factors so that the mean of their response spectra fits
    the spectrum of [check] (NTC 2018, EN 1998-1 or a table), or a uniform hazard spectrum in a table. Write a table
    of records and scale factors for [[demand]] selection and [fragility] selection, and beside it a picture of the
    spectra. Bounds and tolerance: section [selection] of the configuration.
    """
    config, paths = resolved(args)
    if args.number is not None:
        config = replace(config, selection=replace(config.selection, records=args.number))

    from rockpulse.files import check_file, write_files
    from rockpulse.storage.export.table_file import table_csv
    from rockpulse.studies.selection.selection import select
    from rockpulse.views.plots.spectra import selected_spectra
    from rockpulse.views.plots.style import picture_bytes, whole_figure
    from rockpulse.views.shared.files_used import failure_rows, files_used, rows_not_used
    from rockpulse.views.shared.words import writing
    from rockpulse.views.text.site import selection_overview, selection_table

    table = check_file(args.output, args.overwrite)
    picture = check_file(table.with_suffix(".png"), args.overwrite, (".png",))
    bar = progress_bars(args.quiet)
    tree = select(paths, config, progress=lambda planned: bar(planned, desc="computing spectra", unit=" records"))
    with writing(args.language):
        drawn = picture_bytes(whole_figure(selected_spectra(tree)), "png")
    write_files({table: table_csv(selection_table(tree)), picture: drawn})
    failed = files_used(tree).line
    if args.quiet:
        outside = "" if tree["selection"].attrs["compatible"] else "the mean spectrum is not within the tolerance"
        for words in filter(None, (failed, outside)):
            warn(words)
    else:
        unused = rows_not_used(failure_rows(tree), more_in="")
        written = f"table: {table}\npicture: {picture}"
        tell("\n\n".join(filter(None, (selection_overview(tree), unused, written))))
    return 1 if failed else 0
