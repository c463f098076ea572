"""``rockpulse export``: write a results file as a table, with a README of its columns."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from rockpulse.commands.parser import Verb
from rockpulse.commands.shared_options import SELECTION, read_selection
from rockpulse.commands.terminal import progress_bars, tell

if TYPE_CHECKING:
    from rockpulse.storage.export.long_table import LongTable
    from rockpulse.storage.hdf5.results_file import ResultsFile


def _run(args: argparse.Namespace) -> int:
    from rockpulse.storage.export.long_table import long_table
    from rockpulse.storage.export.table_file import check_table_target, write_table
    from rockpulse.storage.hdf5.results_file import open_results_file

    selection = read_selection(args)
    check_table_target(args.output, args.overwrite)
    with open_results_file(args.results) as file, file.reading():
        table = long_table(file, args.group, _names(args.rows), selection, _names(args.columns))
        history = str(file.attrs.get("history", "")).splitlines()
        chosen = f" Selection: {'; '.join(selection.words)}." if selection.words else ""
        about = (
            f"From `{file.path.name}` ({file.attrs.get('title', '')}; "
            f"{history[-1] if history else 'no date'}).{chosen}{_demands(file, table)}"
        )
        with progress_bars(quiet=False)(total=len(table), desc="writing", unit=" rows") as bar:
            written, readme = write_table(
                table, args.output, about, args.overwrite, bar.update, args.decimal_comma, args.raw
            )
    limited = f" of {table.found}" if table.found > len(table) else ""
    tell(f"{written}: {len(table)}{limited} rows{table.per}, {len(table.columns)} columns")
    tell(f"{readme}: meaning of the columns")
    return 0


def _demands(file: ResultsFile, table: LongTable) -> str:
    """Return a sentence with the demands of the results if the table has no column for them, otherwise no text."""
    from rockpulse.assessment.site_demands import stored_demands

    if "demand_acceleration" not in table.left_out:
        return ""
    every = stored_demands(file.dataset(table.group)).items()
    return f" Demands: {', '.join(f'{name}, {demand.words}' for name, demand in every)}."


def _names(joined: str | None) -> list[str] | None:
    return None if joined is None else [name.strip() for name in joined.split(",") if name.strip()]


VERB = Verb(
    name="export",
    summary="write results as a table",
    description="Write a group of a results file as a long table (CSV, a workbook, Parquet), one row for each result "
    "and one column for each variable, and a README that states the unit and the meaning of every column. Flags are "
    "written as words.",
    options=(
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
    ),
    run=_run,
    examples=(
        "rockpulse export results.h5 -o table.csv",
        "rockpulse export results.h5 -o table.xlsx --model nonlinear",
        "rockpulse export results.h5 -o worst.csv --where 'safety_factor < 1' --sort safety_factor --limit 100",
        "rockpulse export results.h5 -o answers.csv --model nonlinear --columns pga,outcome,safety_factor "
        "--decimal-comma",
        "rockpulse export results.h5 -o records.csv --rows record --columns pga,pgv,main_impulse",
    ),
)
