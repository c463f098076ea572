"""``rockpulse plot``: a picture of a results file."""

from __future__ import annotations

import argparse
from typing import Any

from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb

__all__ = ["VERB"]


class _List(argparse.Action):
    """Print the kinds of pictures and leave, as --version does."""

    def __init__(self, option_strings: Any, dest: str, **options: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from rockpulse.views.plots.kinds import kind_list

        tell(kind_list())  # perhaps into `| head`
        parser.exit()


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", metavar="RESULTS", help="file of rockpulse assess, calibrate or fragility")
    parser.add_argument("kind", metavar="KIND", help="what to draw; --list shows all, and the file each needs")
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help="picture to write: .png, .svg or .pdf")
    parser.add_argument("--list", action=_List, help="list the kinds and leave")
    parser.add_argument("--record", metavar="ID", help="one record, or a pattern (* and ?) that no other one meets")
    parser.add_argument("--block", metavar="NAME", help="one block, or a pattern (* and ?) that no other one meets")
    parser.add_argument(
        "--model", dest="models", action="append", metavar="MODEL", help="a model; may be repeated; default: all drawn"
    )
    parser.add_argument("--demand", metavar="NAME", help="a demand of the file; default: the records as they are")
    parser.add_argument("--case", type=int, metavar="K", help="number of the restitution of a list, from 1")
    parser.add_argument(
        "--factor", type=float, metavar="F", help="factor on the record of a rotation history; default 1"
    )
    parser.add_argument("--measure", metavar="NAME", help="measure of intensity; default velocity_ratio")
    parser.add_argument(
        "--limit-state",
        dest="limit_states",
        action="append",
        metavar="STATE",
        help="a limit state of the file; may be repeated; default: all",
    )
    parser.add_argument("--restitution", metavar="C", help='of the blocks of a spectrum: a number; default "housner"')
    parser.add_argument("--overwrite", action="store_true", help="replace a picture that exists")
    parser.add_argument("--quiet", action="store_true", help="do not name the file that was written")


def _run(args: argparse.Namespace) -> int:
    from rockpulse.commands.output_files import PICTURES, check_file, write_files
    from rockpulse.errors import ConfigError
    from rockpulse.storage.hdf5.results_file import load
    from rockpulse.views.plots.kinds import OPTIONS, draw
    from rockpulse.views.plots.picture import picture_bytes

    target = check_file(args.output, args.overwrite, PICTURES)
    options = {name: getattr(args, name) for name in OPTIONS}
    if args.restitution not in (None, "housner"):
        try:
            options["restitution"] = float(args.restitution)
        except ValueError:
            raise ConfigError(
                f'--restitution: expected a number from 0 to 1 or "housner", got "{args.restitution}"'
            ) from None
    figure = draw(load(args.results), args.kind, **options)
    write_files({target: picture_bytes(figure, target.suffix[1:].lower())})
    if not args.quiet:
        tell(f"written: {target}")
    return 0


VERB = Verb(
    name="plot",
    summary="draw a picture of a results file",
    description="Draw one picture of a results file as PNG, SVG or PDF, for a page of A4. The kinds, and the file that "
    "each is drawn from: rockpulse plot --list.",
    add_arguments=_add_arguments,
    run=_run,
)
