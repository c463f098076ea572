"""``rockpulse report``: write the report of a results file as an HTML page or a PDF."""

import argparse

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import progress_bars, tell
from rockpulse.config import CODES


def _run(args: argparse.Namespace) -> int:
    from rockpulse.views.report.writing import report

    given = (args.results, args.output, args.site, args.fragility, args.overwrite)
    options = {"language": args.language, "config": args.config, "full": args.full, "code": args.code or None}
    bar = progress_bars(quiet=False)
    path = report(*given, **options, progress=lambda planned: bar(planned, desc="drawing", unit=" pictures"))
    tell(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0


VERB = Verb(
    name="report",
    summary="write a report of the results in one file, HTML or PDF",
    description="Write the results as one file that needs no network: two pages with the verdict on every body and its "
    "basis, then an annex with every body and record, the method and its limits, and the origin of the data. A PDF is "
    "printed by the Chrome, Chromium or Edge of this machine.",
    options=(
        {
            "RESULTS": "results file of rockpulse assess",
            "--site SITE": "site file of rockpulse calibrate, added to the annex",
            "--fragility FILE": "file of rockpulse fragility, added to the annex",
            "-o --output REPORT": ("file to write: .html, or .pdf; default: %(default)s", {"default": "report.html"}),
            "--language LANGUAGE": ("language of the report: en (default) or it", {"default": "en"}),
            "--config FILE": "configuration whose [report] (author, client, logo) and [check] replace the stored ones",
            "--code CODE": (
                f"codes of the check: {', '.join(CODES)}; default: all but the last",
                {"nargs": "*", "choices": CODES},
            ),
            "--full": "add the configuration and the SHA-256 of all files",
            "--overwrite": "replace an existing report, but no other file",
        },
    ),
    run=_run,
    examples=("rockpulse report results.h5", "rockpulse report results.h5 -o verifica.html --language it"),
)
