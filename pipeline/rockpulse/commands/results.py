"""Commands that export, compare and verify results files: ``rockpulse export``, ``diff`` and ``verify``."""

import argparse
import math

from rockpulse.commands.parser import command, number
from rockpulse.commands.shared_options import COUNT, SELECTION, read_selection
from rockpulse.commands.terminal import progress_bars, tell


def _names(joined: str | None) -> list[str] | None:
    return None if joined is None else [name.strip() for name in joined.split(",") if name.strip()]


@command(
    {
        "RESULTS": "results file of any kind",
        "-o --output TABLE !": "name.csv, name.csv.gz, name.xlsx or name.parquet (the last two: pip install "
        "'rockpulse[tables]'); TABLE.README.md, written next to it, explains the columns",
        "--group NAME": "group of the file, such as half_cycles, overturning_intervals, directions, failures or "
        "records; default: the group with the results (summary)",
        "--rows DIM[,DIM]": "dimensions of a row, such as record or record,block; default: record,block,model",
        "--columns NAME[,NAME]": "variables to write beside the names of record, block and model; default: all",
        "--record ID ...": "only this record (* and ? are wildcards); repeatable",
        "--block NAME ...": "only this body (* and ? are wildcards); repeatable",
        **SELECTION,
        "--decimal-comma": "write decimal commas, and semicolons between columns, for a spreadsheet in Italian, "
        "French, German ...; default: decimal points, and commas between columns",
        "--raw": "write texts as stored; default: control characters are escaped, and a text that a "
        "spreadsheet would read as a formula begins with an apostrophe",
        "--overwrite": "replace an existing table and its README",
    },
    examples=(
        "rockpulse export results.h5 -o table.csv",
        "rockpulse export results.h5 -o table.xlsx --model nonlinear",
        "rockpulse export results.h5 -o worst.csv --where 'safety_factor < 1' --sort safety_factor --limit 100",
        "rockpulse export results.h5 -o answers.csv --model nonlinear --columns pga,outcome,safety_factor "
        "--decimal-comma",
        "rockpulse export results.h5 -o records.csv --rows record --columns pga,pgv,main_impulse",
    ),
)
def export(args: argparse.Namespace) -> int:
    """Write results as a table.

    Write a group of a results file as a long table (CSV, a workbook, Parquet), one row for each result and one
    column for each variable, and a README that states the unit and the meaning of every column. Flags are written
    as words.
    """
    from rockpulse.assessment.site_demands import stored_demands
    from rockpulse.storage.export.long_table import long_table
    from rockpulse.storage.export.table_file import check_table_target, write_table
    from rockpulse.storage.hdf5.results_file import open_results_file

    selection = read_selection(args)
    check_table_target(args.output, args.overwrite)
    with open_results_file(args.results) as file, file.reading():
        table = long_table(file, args.group, _names(args.rows), selection, _names(args.columns))
        history = str(file.attrs.get("history", "")).splitlines()
        chosen = f" Selection: {'; '.join(selection.words)}." if selection.words else ""
        made = history[-1] if history else "no date"
        about = f"From `{file.path.name}` ({file.attrs.get('title', '')}; {made}).{chosen}"
        if "demand_acceleration" in table.left_out:  # the table has no column for the demands
            every = stored_demands(file.dataset(table.group)).items()
            about += f" Demands: {', '.join(f'{name}, {demand.words}' for name, demand in every)}."
        with progress_bars(quiet=False)(total=len(table), desc="writing", unit=" rows") as bar:
            written, readme = write_table(
                table, args.output, about, args.overwrite, bar.update, args.decimal_comma, args.raw
            )
    limited = f" of {table.found}" if table.found > len(table) else ""
    tell(f"{written}: {len(table)}{limited} rows{table.per}, {len(table.columns)} columns")
    tell(f"{readme}: meaning of the columns")
    return 0


#: Parser of a tolerance.
_TOLERANCE = number(float, 0.0, math.inf, "a number >= 0")


@command(
    {
        "first": ("results file", {"metavar": "BEFORE"}),
        "second": ("results file of the same kind", {"metavar": "AFTER"}),
        "--rtol R": ("relative tolerance; default: %(default)g", {"type": _TOLERANCE, "default": 1e-9}),
        "--atol A": (
            "absolute tolerance, in the unit of each variable; default: %(default)g",
            {"type": _TOLERANCE, "default": 0.0},
        ),
        "--ignore VARIABLE ...": "do not compare this variable, given by its name or its path (/summary/pga); "
        "repeatable",
        "--limit N": (
            "list at most N changed verdicts, and scale factors and capacities that crossed 1; default: 3, with "
            "--full 20",
            COUNT,
        ),
        "--full": "list every variable, name and line that differs; default: one screen",
    },
    examples=("rockpulse diff before.h5 after.h5", "rockpulse diff before.h5 after.h5 --rtol 1e-6 --ignore warnings"),
)
def diff(args: argparse.Namespace) -> int:
    """List what changed between two results files.

    Compare two results files: versions and configuration, records, blocks and models that only one of them has,
    verdicts that changed, scale factors and capacities over demand that crossed 1, and variables beyond a
    tolerance. Bodies are compared by the nonlinear model if it was run; its changes come first in every list. Rows
    are matched by name. Exit code 0: the results are the same, 1: they differ; differences of versions and
    configuration are listed, but do not change the exit code.
    """
    from rockpulse.views.diff.difference_overview import diff

    found = diff(args.first, args.second, args.rtol, args.atol, args.ignore, args.limit, args.full)
    tell(str(found))
    return 0 if found.same else 1


#: Largest number of missing input files in a message.
LISTED = 5


@command(
    {
        "RESULTS": "results file of any kind",
        "--inputs": (
            "also compare the record files with their checksums, if they still exist; default: yes",
            {"action": argparse.BooleanOptionalAction, "default": True},
        ),
        "--quiet": "print only what differs",
    },
    examples=("rockpulse verify results.h5",),
)
def verify(args: argparse.Namespace) -> int:
    """Check that a results file and its inputs are unchanged.

    Compare every variable and all attributes of a results file with the checksums stored when it was written, the
    file with its schema, and the record files with the SHA-256 of what was read. Exit code 0: unchanged, 1:
    something differs, 2: not a results file, or one that cannot be opened.
    """
    from rockpulse.storage.hdf5.verification import verify

    bars = progress_bars(args.quiet)
    found = verify(args.results, args.inputs, lambda items: bars(items, desc="verifying", leave=False))
    for difference in found.differences:
        tell(f"{args.results}: {difference}")
    if not args.quiet:
        count = len(found.differences)
        verdict = f"{count} difference{'s' * (count != 1)}" if count else "unchanged"
        tell(f"{args.results}: {found.kind}, schema {found.schema}, {found.variables} variables: {verdict}")
        if args.inputs:
            tell(f"input files checked: {found.inputs}, missing: {len(found.absent)}")
            for name in found.absent[:LISTED]:
                tell(f"  {name}")
            if len(found.absent) > LISTED:
                tell(f"  and {len(found.absent) - LISTED} more")
    return 1 if found.differences else 0
