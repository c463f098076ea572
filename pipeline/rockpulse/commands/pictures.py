"""Commands that show results as a picture or a report: ``rockpulse plot`` and ``report``."""

import argparse
from typing import Any

from rockpulse.commands.parser import command
from rockpulse.commands.terminal import progress_bars, tell
from rockpulse.config import CODES
from rockpulse.errors import ConfigError


class _List(argparse.Action):
    def __init__(self, option_strings: Any, dest: str, **options: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from rockpulse.views.plots.picture_kinds import kind_list

        tell(kind_list())  # works also if standard output is closed, as by `| head`
        parser.exit()


@command(
    {
        "RESULTS": "file of rockpulse assess, calibrate or fragility",
        "KIND": (
            "kind of picture; --list shows all, with the file that each needs; default: the main picture of the file",
            {"nargs": "?"},
        ),
        "-o --output FILE !": "picture to write: .png, .svg or .pdf",
        "--list": ("list the kinds of pictures and exit", {"action": _List}),
        "--record ID": "one record, by its id or a pattern (* and ?) that matches it alone",
        "--block NAME": "one body, by its name or a pattern (* and ?) that matches it alone",
        "--model MODEL ...": ("a model; repeatable; default: all", {"default": None}),
        "--demand NAME": "a demand of the results; default: the records as recorded",
        "--case K": ("number, from 1, of the restitution if a body has a list of them", {"type": int}),
        "--factor F": ("scale factor [-] on the record of a rotation history; default: 1", {"type": float}),
        "--measure NAME": "intensity measure; default: velocity_ratio",
        "--limit-state STATE ...": ("a limit state of the file; repeatable; default: all", {"default": None}),
        "--restitution C": 'restitution [-] of the bodies of a spectrum, from 0 to 1; default: "housner"',
        "--overwrite": "replace an existing picture",
        "--quiet": "do not print the name of the file",
    },
    examples=("rockpulse plot results.h5 -o bodies.png", "rockpulse plot results.h5 probability -o probability.pdf"),
)
def plot(args: argparse.Namespace) -> int:
    """Draw a picture of a results file.

    Draw one picture of a results file as PNG, SVG or PDF, for a page of A4. The kinds, and the file that each is
    drawn from: rockpulse plot --list.
    """
    from rockpulse.files import check_file, write_files
    from rockpulse.views.plots.drawing import plot
    from rockpulse.views.plots.picture_kinds import OPTIONS
    from rockpulse.views.plots.style import picture_bytes

    target = check_file(args.output, args.overwrite, (".svg", ".png", ".pdf"))
    options = {name: getattr(args, name) for name in OPTIONS}
    if args.restitution not in (None, "housner"):
        try:
            options["restitution"] = float(args.restitution)
        except ValueError:
            raise ConfigError(
                f'--restitution: expected a number from 0 to 1 or "housner", got "{args.restitution}"'
            ) from None
    figure = plot(args.results, args.kind, **options)
    write_files({target: picture_bytes(figure, target.suffix[1:].lower())})
    if not args.quiet:
        tell(f"written: {target}")
    return 0


@command(
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
    examples=("rockpulse report results.h5", "rockpulse report results.h5 -o verifica.html --language it"),
)
def report(args: argparse.Namespace) -> int:
    """Write a report of the results in one file, HTML or PDF.

    Write the results as one file that needs no network: two pages with the verdict on every body and its basis,
    then an annex with every body and record, the method and its limits, and the origin of the data. A PDF is
    printed by the Chrome, Chromium or Edge of this machine.
    """
    from rockpulse.views.report.writing import report

    given = (args.results, args.output, args.site, args.fragility, args.overwrite)
    options = {"language": args.language, "config": args.config, "full": args.full, "code": args.code or None}
    bar = progress_bars(quiet=False)
    path = report(*given, **options, progress=lambda planned: bar(planned, desc="drawing", unit=" pictures"))
    tell(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0
