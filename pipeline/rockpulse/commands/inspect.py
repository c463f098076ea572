"""``rockpulse inspect``: show the contents of a results file."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.commands.parser import command
from rockpulse.commands.shared_options import COUNT, SELECTION, read_selection
from rockpulse.commands.terminal import tell
from rockpulse.errors import ResultsError

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.storage.hdf5.results_file import ResultsFile

#: Groups that only files of other commands contain; each has a module that prints them.
SHOWN_WHOLE = ("site", "fragility")
#: Options that request a list of results.
OF_CASES = ("model", "outcome", "where", "sort", "limit", "worst")
#: Options that cannot be combined with the list of the worst results.
BESIDE_WORST = ("sort", "limit", "records", "blocks")
#: Default number of results in a list.
CASES = 20
NOTHING = "nothing failed and nothing was skipped"


def _parts(file: ResultsFile, args: argparse.Namespace) -> list[str]:
    """Return the texts that the options request, or the overview of the results if no option requests any."""
    from rockpulse.views.shared.files_used import failure_list
    from rockpulse.views.text.lists import block_list, record_list
    from rockpulse.views.text.overview import overview

    beside = [f"--{name}" for name in BESIDE_WORST if args.worst and getattr(args, name)]
    if beside:
        raise ResultsError(
            f"--worst lists results in its own order and cannot be combined with {', '.join(beside)}; use --sort "
            "VARIABLE --limit N instead"
        )
    selection = read_selection(args)
    summary = file.dataset("summary")
    parts = []
    if args.records or args.blocks:
        parts += [record_list(summary, selection)] if args.records else []
        parts += [block_list(summary, selection)] if args.blocks else []
    elif any(getattr(args, name) for name in OF_CASES):
        parts.append(_cases(summary, args))
    else:
        parts += _details(summary, args)
    if args.failures:
        parts.append(failure_list(file.tree("failures")) or NOTHING)
    return parts or [overview(file.tree("summary", "directions", "failures"), args.all)]


def _details(summary: xr.Dataset, args: argparse.Namespace) -> list[str]:
    """Return the facts of the selected record or body, or a list of results if a pattern selects several."""
    from rockpulse.storage.export.row_selection import positions_matching
    from rockpulse.views.text.overview import block_details, record_details

    pages = []
    for dim, details in (("record", record_details), ("block", block_details)):
        known = [str(label) for label in summary[dim].values]
        for pattern in getattr(args, dim) or ():
            found = positions_matching(known, [pattern], dim)
            if found.size > 1:
                return [_cases(summary, args)]
            pages.append(details(summary, known[int(found[0])]))
    return pages


def _cases(summary: xr.Dataset, args: argparse.Namespace) -> str:
    from dataclasses import replace

    from rockpulse.assessment.answers import Answers
    from rockpulse.views.text.lists import case_list, worst_cases

    selection = read_selection(args)
    limited = replace(selection, limit=args.worst or selection.limit or CASES)
    return (
        worst_cases(Answers(summary), limited) if args.worst or selection.sort is None else case_list(summary, limited)
    )


def _whole(file: ResultsFile, group: str, args: argparse.Namespace) -> str:
    from rockpulse.storage.hdf5.results_file import load_tree
    from rockpulse.views.shared.files_used import failure_list

    listed = "failures" in file.groups
    asked = [option for option in ("record", "block", "records", "blocks", *OF_CASES) if getattr(args, option)]
    if asked or (args.failures and not listed):
        options = ", ".join(f"--{option}" for option in asked or ["failures"])
        raise ResultsError(
            f"{args.results}: {options}: expected results of 'rockpulse assess'; this is a {group} file, which is "
            "shown in full: leave the options out"
        )
    if args.failures:
        return failure_list(file.tree("failures")) or NOTHING
    overview = getattr(import_module(f"rockpulse.views.text.{group}"), f"{group}_overview")
    return str(overview(load_tree(args.results)))


@command(
    {
        "RESULTS": "file of rockpulse assess, calibrate or fragility",
        "--record ID ...": "one record in detail, or the results of all that match '*CCC*' (* and ? are "
        "wildcards); repeatable",
        "--block NAME ...": "one body in detail, or the results of all that match a pattern; repeatable",
        "--all": "show the verdict of every model for every record and body",
        "--failures": "list the files and channels that failed or were skipped, with the reason",
        "--records": "list the records",
        "--blocks": "list the bodies",
        "--worst N": ("list the N results with the smallest capacity/demand (without a demand: scale factor)", COUNT),
        **SELECTION,
    },
    examples=(
        "rockpulse inspect results.h5",
        "rockpulse inspect results.h5 --record '*CCC*' --model nonlinear",
        "rockpulse inspect results.h5 --outcome overturns --sort safety_factor --limit 20",
    ),
)
def inspect(args: argparse.Namespace) -> int:
    """Show a results file.

    Show the verdict on every body and the worst records of a results file; options select all verdicts, one record
    or body in detail, the results that meet a condition, or what was not assessed.
    """
    from rockpulse.run.journal import Journal
    from rockpulse.storage.hdf5.results_file import open_results_file

    if not Path(args.results).exists() and (progress := Journal.progress(args.results)):
        raise ResultsError(f"{args.results}: {progress}")
    with open_results_file(args.results) as file, file.reading():
        whole = [group for group in SHOWN_WHOLE if group in file.groups]
        tell(_whole(file, whole[0], args) if whole else "\n\n".join(_parts(file, args)))
    return 0
