"""``rockpulse report``: make one file of a results file to hand over, a page of HTML or a PDF."""

from __future__ import annotations

import argparse

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import tell

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", metavar="RESULTS", help="results file of rockpulse assess")
    parser.add_argument("--site", metavar="SITE", help="site file of rockpulse calibrate, shown beside the verdict")
    parser.add_argument("--fragility", metavar="FILE", help="fragility file of rockpulse fragility, shown likewise")
    parser.add_argument("-o", "--output", required=True, metavar="REPORT", help="file to write: .html, or .pdf")
    parser.add_argument("--language", default="en", metavar="LANGUAGE", help="of the report: en (default) or it")
    parser.add_argument(
        "--config", metavar="FILE", help="author, client, project and logo of its [report], not those stored"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace a report that exists; never another file")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.config.configuration import load_config
    from rockpulse.views.report.writing import write_report

    config = load_config(args.config) if args.config else None
    given = (args.results, args.output, args.site, args.fragility, args.overwrite)
    path = write_report(*given, language=args.language, config=config)
    tell(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0


VERB = Verb(
    name="report",
    summary="one file of the results to hand over, HTML or PDF",
    description="Write the results as one file that needs no network: on two pages the verdict on every body and what "
    "it rests on, then an annex with every body and record, the method and what it does not cover, and where the "
    "numbers come from. A PDF is printed by the Chrome, Chromium or Edge of this machine.",
    add_arguments=_add_arguments,
    run=_run,
)
