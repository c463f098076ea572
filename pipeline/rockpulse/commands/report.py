"""``rockpulse report``: make one page of HTML of a results file, to hand over."""

from __future__ import annotations

import argparse

from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", metavar="RESULTS", help="results file of rockpulse assess")
    parser.add_argument("--site", metavar="SITE", help="site file of rockpulse calibrate, shown beside the verdict")
    parser.add_argument("--fragility", metavar="FILE", help="fragility file of rockpulse fragility, shown likewise")
    parser.add_argument("-o", "--output", required=True, metavar="REPORT", help="page to write (HTML)")
    parser.add_argument("--overwrite", action="store_true", help="replace a report that exists; never another file")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.views.report.writing import write_report

    path = write_report(args.results, args.output, args.site, args.fragility, args.overwrite)
    tell(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0


VERB = Verb(
    name="report",
    summary="one HTML page of the results to hand over",
    description="Write the results as one page that needs no network: the verdict first, then the site, every body and "
    "every record with pictures, the method and what it does not cover, and where the numbers come from.",
    add_arguments=_add_arguments,
    run=_run,
)
