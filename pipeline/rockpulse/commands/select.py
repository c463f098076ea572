"""``rockpulse select``: select records whose mean spectrum matches that of a code, a hazard study or a table."""

import argparse
import sys
from dataclasses import replace

from rockpulse.commands.parser import Verb
from rockpulse.commands.shared_options import from_records, parse_count, resolved
from rockpulse.commands.terminal import progress_bars, tell


def _run(args: argparse.Namespace) -> int:
    config, paths = resolved(args)
    if args.number is not None:
        config = replace(config, selection=replace(config.selection, records=args.number))

    from rockpulse.files import check_file, write_files
    from rockpulse.storage.export.table_file import table_csv
    from rockpulse.studies.selection.selection import select
    from rockpulse.views.plots.spectra import selected_spectra
    from rockpulse.views.plots.style import picture_bytes, whole_figure
    from rockpulse.views.shared.files_used import failure_rows, files_used
    from rockpulse.views.shared.words import writing
    from rockpulse.views.text.left_out import rows_not_used
    from rockpulse.views.text.selection import selection_overview, selection_table

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
            tell(f"rockpulse: {words}", sys.stderr)
    else:
        unused = rows_not_used(failure_rows(tree), more_in="")
        written = f"table: {table}\npicture: {picture}"
        tell("\n\n".join(filter(None, (selection_overview(tree), unused, written))))
    return 1 if failed else 0


VERB = Verb(
    name="select",
    summary="select records whose mean spectrum fits a target spectrum",
    description="Select records, or pairs of channels, and their scale factors so that the mean of their response "
    "spectra fits the spectrum of [check] (NTC 2018, EN 1998-1 or a table), or a uniform hazard spectrum in a table. "
    "Write a table of records and scale factors for [[demand]] selection and [fragility] selection, and beside it a "
    "picture of the spectra. Bounds and tolerance: section [selection] of the configuration.",
    options=(
        from_records("TABLE", "table to write (CSV); the picture beside it has the suffix .png", bodies=False),
        {
            "-n --number N": ("number of records, or of pairs; default: [selection] records", {"type": parse_count}),
            "--language LANGUAGE": ("language of the picture: en (default) or it", {"default": "en"}),
        },
    ),
    run=_run,
    examples=("rockpulse select records/ --config site.toml -n 5 -o selection.csv",),
)
