"""``rockpulse study``: the study of Casapulla & Maione (2017), section 4, and that of the checks of codes."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rockpulse.commands.arguments import add_strong_arguments, read_strong
from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import compiling_told, progress_bars, tell
from rockpulse.errors import ConfigError

__all__ = ["VERB"]

#: Tables that --csv writes of each figure.
TABLES = {
    "figure4": ("figure4", "statements"),
    "figure5": ("histories", "half_cycles", "intervals", "statements"),
    "code-check": ("code_check", "rates", "statements"),
}


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    figures = parser.add_subparsers(title="figures", required=True, metavar="FIGURE", dest="figure")
    four = figures.add_parser(
        "figure4",
        help="largest rotation against I_s/I for several I/I_1c",
        description="Largest rotation under 20 s of the limit accelerogram, with the same number n of secondary "
        "impulses in every half-cycle, for every spacing and for n -> infinity, and the verdict on each statement.",
    )
    five = figures.add_parser(
        "figure5",
        help="time histories of two blocks under main impulses of I_2c",
        description="Time histories and half-cycles of blocks A (R = 2 m) and B (R = 4 m), 2b = 1 m, for every "
        "spacing, and the verdict on each statement over a range of a common interval dT.",
    )
    codes = figures.add_parser(
        "code-check",
        help="checks of codes against time histories of records",
        description="Which bodies the kinematic checks of Italian practice pass though they overturn, and fail though "
        "they stand: strong channels, each with its own PGA as a_g S and its own spectrum as S_e, at half, one and "
        "twice their strength on twelve bodies (slenderness 4 to 12, R 1 to 4 m).",
    )
    add_strong_arguments(codes)
    codes.add_argument("--q", type=float, default=2.0, metavar="Q", help="behaviour factor; default: 2")
    codes.add_argument("--confidence-factor", type=float, default=1.0, metavar="FC", help="FC; default: 1")
    codes.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the bootstrap; default: 0")
    for figure in (four, five, codes):
        figure.add_argument("-o", "--output", required=True, metavar="STUDY", help="file to write (HDF5)")
    _add_numbers(four, "--restitution", "C", "restitutions; default: 0.9 0.6")
    _add_numbers(four, "--impulse-ratio", "RATIO", "I/I_1c; default: 0.1 to 1.0")
    _add_numbers(four, "--secondary-ratio", "RATIO", "I_s/I; default: 0 to 1 in steps of 0.01")
    _add_numbers(four, "--count", "N", "secondary impulses in every half-cycle, even, or inf; default: 2 6 20 inf")
    _add_numbers(four, "--p", "P", "frequency parameters in 1/s; default: those of blocks A and B (1.918 1.356)")
    _add_numbers(five, "--restitution", "C", "restitutions, two or more; default: 0.9 0.6")
    _add_numbers(five, "--secondary-ratio", "RATIO", "I_s/I, from 0; default: 0 0.3 0.5 0.7")
    five.add_argument("--interval", type=float, metavar="SECONDS", help="dT of the histories; default: 0.5 s")
    five.add_argument(
        "--scan",
        type=float,
        nargs=3,
        metavar=("FIRST", "LAST", "STEP"),
        help="intervals that the statements are looked at with; default: 0.02 0.61 0.002 s",
    )
    five.add_argument("--step", type=float, metavar="SECONDS", help="step of the histories; default: 0.01 s")
    for figure in (four, five):
        figure.add_argument("--duration", type=float, metavar="SECONDS", help="length of the input; default: 20 s")
    for figure in (four, five, codes):
        tables = ", ".join(TABLES[figure.prog.split()[-1]])
        figure.add_argument("--csv", metavar="FOLDER", help=f"also write {tables} as CSV into this folder")
        figure.add_argument("--overwrite", action="store_true", help="replace a study or tables that exist")
        figure.add_argument("--quiet", action="store_true", help="print nothing")


def _add_numbers(parser: argparse.ArgumentParser, name: str, metavar: str, words: str) -> None:
    parser.add_argument(name, type=float, nargs="+", metavar=metavar, help=words)


def _run(args: argparse.Namespace) -> int:
    from rockpulse.storage.save_load import check_target, save
    from rockpulse.storage.study_variables import STUDY
    from rockpulse.studies.paper.options import scan_values
    from rockpulse.views.shared.output_files import csv_bytes, csv_files, write_files

    check_target(args.output, args.overwrite, STUDY)
    files = {} if args.csv is None else csv_files(args.csv, TABLES[args.figure], args.overwrite)

    if args.figure == "code-check":
        return _run_codes(args, files)

    from rockpulse.studies.paper import figure4, figure5
    from rockpulse.studies.paper.tables import study_tables
    from rockpulse.views.text.study import study_overview

    given = {"restitutions": args.restitution, "secondary_ratios": args.secondary_ratio, "duration": args.duration}
    if args.figure == "figure4":
        given |= {"impulse_ratios": args.impulse_ratio, "counts": args.count, "p": args.p}
        tree = figure4(**{name: value for name, value in given.items() if value is not None})
    else:
        scan = None if args.scan is None else scan_values(*args.scan)
        given |= {"interval": args.interval, "intervals": scan, "step": args.step}
        tree = figure5(**{name: value for name, value in given.items() if value is not None})
    # The small files first: the study is there only if everything is.
    write_files({files[name]: csv_bytes(table) for name, table in study_tables(tree).items() if name in files})
    save(tree, args.output, overwrite=args.overwrite)
    if not args.quiet:
        tell(f"{study_overview(tree)}\n\nwritten: {', '.join(map(str, [Path(args.output), *files.values()]))}")
    return 0


def _run_codes(args: argparse.Namespace, files: dict[str, Path]) -> int:
    from rockpulse.config.study_settings import CheckSettings
    from rockpulse.storage.save_load import save
    from rockpulse.studies.check.against_histories import check_cases, check_study
    from rockpulse.studies.paper.tables import study_tables
    from rockpulse.views.shared.files_used import count_files
    from rockpulse.views.shared.output_files import csv_bytes, write_files
    from rockpulse.views.text.left_out import rows_not_used
    from rockpulse.views.text.study import study_overview

    settings = CheckSettings(q=args.q, confidence_factor=args.confidence_factor)
    if args.seed < 0:
        raise ConfigError(f"--seed: expected a whole number from 0, got {args.seed}")
    motions, left_out = read_strong(args)
    failed = count_files((), left_out).line
    listed = "" if args.quiet else rows_not_used(left_out)
    if not motions:
        why = f"rockpulse: no strong channel among the records{f': {failed}' if failed else ''}"
        tell("\n".join(filter(None, (listed, why))), sys.stderr)
        return 1
    bars = progress_bars(args.quiet)
    with compiling_told(args.quiet):
        cases = check_cases(motions, settings, lambda every: bars(every, desc="checking", unit=" channels"))
    tree = check_study(cases, settings, args.seed)
    write_files({files[name]: csv_bytes(table) for name, table in study_tables(tree).items() if name in files})
    save(tree, args.output, overwrite=args.overwrite)
    if not args.quiet:
        written = f"written: {', '.join(map(str, [Path(args.output), *files.values()]))}"
        tell("\n\n".join(filter(None, (listed, study_overview(tree), written))))
    return 1 if failed else 0


VERB = Verb(
    name="study",
    summary="compute the paper's parametric study, or judge the checks of codes on records",
    description="Compute section 4 of Casapulla & Maione (2017) as data, and say which of its statements hold where; "
    "or judge the kinematic checks of Italian practice against time histories of records.",
    add_arguments=_add_arguments,
    run=_run,
    examples=(
        "rockpulse study figure4 -o figure4.h5",
        "rockpulse study figure5 -o figure5.h5",
        "rockpulse study code-check records/ -o codes.h5",
    ),
)
