"""``rockpulse rule``: fit the rule that makes sequences of half-waves, and judge it on records."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from rockpulse.commands.arguments import add_strong_arguments, read_strong
from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import QUIET, compiling_told, progress_bars, tell

if TYPE_CHECKING:
    import pandas as pd

    from rockpulse.errors import Failure

__all__ = ["VERB"]


#: Why there is no configuration.
PROTOCOL = (
    "The protocol is fixed, so that verdicts can be compared, and takes no configuration: channels above 0.15 g, "
    "band-passed from 0.1 to 25 Hz, on twelve bodies of its own (slenderness 4 to 12, R 1 to 4 m), under the default "
    "uncertainty. A channel takes about a second of one core."
)


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(title="actions", dest="action", required=True, metavar="ACTION")
    fit = actions.add_parser(
        "fit",
        help="fit the working points on records and write them (TOML)",
        description=f"Fit the working points of the rule on records and write them as TOML. {PROTOCOL}",
    )
    judge = actions.add_parser(
        "judge",
        help="compare the rule and other measures with the nonlinear model",
        description="Bias and scatter of the rule and of other measures against the capacity by the nonlinear model, "
        f"and their missed and false alarms, on earthquakes left out. {PROTOCOL}",
    )
    for action, output, kind in ((fit, "RULE", "TOML"), (judge, "VERDICTS", "HDF5")):
        action.add_argument("-o", "--output", required=True, metavar=output, help=f"file to write ({kind})")
        if action is judge:
            action.add_argument(
                "--rule", metavar="RULE", help="rule to judge, of rockpulse rule fit; default: the shipped one"
            )
        add_strong_arguments(action)
        action.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the bootstrap; default: 0")
        action.add_argument("--overwrite", action="store_true", help="replace a file that exists")
        action.add_argument("--quiet", action="store_true", help=QUIET)


def _run(args: argparse.Namespace) -> int:
    from rockpulse.errors import ConfigError

    if args.seed < 0:
        raise ConfigError(f"--seed: expected a whole number from 0, got {args.seed}")
    return _fit(args) if args.action == "fit" else _judge(args)


def _fit(args: argparse.Namespace) -> int:
    from datetime import UTC, datetime

    import numpy as np

    from rockpulse.studies.rule.cases import PROCESSING
    from rockpulse.studies.rule.judgement import fit_rules, judge_rules
    from rockpulse.version import __version__
    from rockpulse.views.shared.output_files import check_file, write_files
    from rockpulse.views.text.rule import rule_overview, rule_text

    target = check_file(args.output, args.overwrite, (".toml",))
    cases, failures = _cases(args)
    if cases.empty:
        return _nothing_strong(args, failures)
    rules = fit_rules(cases)
    tree = judge_rules(cases, rules, failures, args.seed)
    provenance = {
        "date": datetime.now(UTC).date().isoformat(),
        "version": __version__,
        "command": "rockpulse rule fit",
        "channels": int(cases["record"].nunique()),
        "earthquakes": int(cases["event"].nunique()),
        "cases": len(cases),
        "reached": int(np.isfinite(cases["capacity_mean"]).sum()),
        "processing": PROCESSING,
        "events": sorted(cases["event"].unique()),
        "records": sorted(cases["record"].unique()),
    }
    write_files({target: rule_text(rules, tree, provenance).encode()})
    return _report(args, cases, failures, f"{rule_overview(tree)}\n\nrule: {args.output}")


def _judge(args: argparse.Namespace) -> int:
    from rockpulse.calibration.rule import POINTS, load_rule
    from rockpulse.storage.rule_variables import RULE_KIND
    from rockpulse.storage.save_load import check_target, save
    from rockpulse.studies.rule.judgement import judge_rules
    from rockpulse.views.text.rule import rule_overview

    check_target(args.output, args.overwrite, RULE_KIND)
    given = {point: load_rule(point, args.rule) for point in POINTS}
    cases, failures = _cases(args)
    if cases.empty:
        return _nothing_strong(args, failures)
    tree = judge_rules(cases, given, failures, args.seed)
    save(tree, args.output, overwrite=args.overwrite)
    return _report(args, cases, failures, f"{rule_overview(tree)}\n\nverdicts: {args.output}")


def _cases(args: argparse.Namespace) -> tuple[pd.DataFrame, list[Failure]]:
    from rockpulse.studies.rule.cases import rule_cases

    motions, failures = read_strong(args)
    bars = progress_bars(args.quiet)
    with compiling_told(args.quiet):
        cases, refused = rule_cases(motions, progress=lambda every: bars(every, desc="judging", unit=" channels"))
    return cases, [*failures, *refused]


def _nothing_strong(args: argparse.Namespace, failures: list[Failure]) -> int:
    from rockpulse.views.shared.files_used import count_files
    from rockpulse.views.text.left_out import rows_not_used

    failed = count_files((), failures).line
    why = "rockpulse: no strong channel among the records, nothing was written" + (f": {failed}" if failed else "")
    listed = "" if args.quiet else rows_not_used(failures, more_in="")
    tell("\n".join(filter(None, (listed, why))), sys.stderr)
    return 1


def _report(args: argparse.Namespace, cases: pd.DataFrame, failures: list[Failure], text: str) -> int:
    from rockpulse.views.shared.files_used import count_files
    from rockpulse.views.text.left_out import rows_not_used

    failed = count_files(cases["source"].unique(), failures).line
    if not args.quiet:
        tell("\n\n".join(filter(None, (rows_not_used(failures), text))))
    elif failed:
        tell(f"rockpulse: {failed}", sys.stderr)
    return 1 if failed else 0


VERB = Verb(
    name="rule",
    summary="fit or judge the rule from half-waves to sequences",
    description="Fit the rule that turns the half-waves of a record into an impulse sequence, or judge it on records "
    "against the nonlinear model, with other measures beside it.",
    add_arguments=_add_arguments,
    run=_run,
    examples=("rockpulse rule judge records/ -o verdicts.h5", "rockpulse rule fit records/ -o rule.toml"),
)
