"""Test of the half-wave rule on records, compared with other measures, and a new fit.

``python -m laboratory.rule PATHS -o FOLDER [--fit]`` (``make rule RECORDS=FOLDER``) prints bias and scatter compared
with the nonlinear capacity and the missed and false verdicts, and writes them as CSV. With ``--fit`` it also writes a
rule, ``rule.toml``. A channel takes about a second on one core.
"""

import argparse
import json
import logging
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from laboratory.ensemble import PROCESSING, add_record_arguments, read_strong
from laboratory.rule.judgement import LIMIT, fit_rules, judge_rules, motion_cases, too_few
from laboratory.rule.measures import MEASURES
from laboratory.tables import plain, write_tables
from rockpulse.sequences.rule import POINTS, Rule, load_rule
from rockpulse.version import __version__

NAMES = MEASURES | {LIMIT: "the limit: P, nonlinear"}


def overview(tables: Mapping[str, pd.DataFrame]) -> str:
    """The tables of :func:`~laboratory.rule.judgement.judge_rules` as text."""
    two, three, percent = "{:.2f}".format, "{:.3f}".format, "{:.1%}".format
    capacities, rates, at_missed = (
        tables[name].assign(name=tables[name][key].map(NAMES))
        for name, key in (("capacities", "measure"), ("rates", "score"), ("at_missed", "score"))
    )
    of_capacities = {"name": str, "target": str, "kind": str}
    of_capacities |= dict.fromkeys(("coefficient", "bias", "bias_low", "bias_high"), two)
    of_capacities |= dict.fromkeys(("dispersion", "within", "within_low", "within_high"), three)
    shares = ("missed_share", "missed_low", "missed_high", "false_share", "false_low", "false_high")
    of_rates = dict.fromkeys(("name", "point", "kind", "missed", "false"), str) | dict.fromkeys(shares, percent)
    of_missed = {"name": str} | dict.fromkeys(("missed_share", "false_share", "false_low", "false_high"), percent)
    cases, first = tables["cases"], rates.iloc[0]
    return "\n\n".join(
        (
            f"{cases['record'].nunique()} channels of {cases['event'].nunique()} earthquakes on twelve bodies, against "
            "the nonlinear equation with 10 % on the factor,\nC times U(0.95, 1.05), alpha less 5 % |N|. left-out: "
            "with coefficients fitted without the earthquake. Intervals of 95 % over earthquakes.",
            f"Against capacities ({int(capacities['reached'].iloc[0])} mean ones reached)\n"
            + plain(capacities, of_capacities),
            f"Verdicts at factors of 0.5 and 1: {first['overturnings']} overturn, {first['survivors']} do not\n"
            + plain(rates, of_rates),
            f"False alarms at a missed share\n{plain(at_missed, of_missed)}",
        )
    )


def rule_text(rules: Mapping[str, Rule], tables: Mapping[str, pd.DataFrame], provenance: Mapping[str, Any]) -> str:
    """Fitted rules of one range as TOML, by working point, with their provenance and how they did on their cases."""
    measured: dict[Any, Any] = tables["capacities"].set_index(["measure", "target", "kind"]).to_dict("index")
    lines = [
        "# The rule of rockpulse.sequences.rule: demand = factor x march, an overturning at 1 and above.",
        "# Written by `make rule`; bias and log-dispersion of 1/demand against the nonlinear capacity, on earthquakes",
        "# left out.",
        "",
        "[provenance]",
        *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in provenance.items()),
    ]
    within = next(iter(rules.values())).within
    lines += ["", "[range]", *(f"{name} = [{least:.6g}, {most:.6g}]" for name, (least, most) in within.items())]
    for point, rule in rules.items():
        measure, target = POINTS[point]
        row = measured[measure, target, "left-out"]
        lines += ["", f"[{point}]", f"factor = {rule.factor:.6g}", f"target = {json.dumps(target)}"]
        lines += [f"{name} = {row[name]:.4f}" for name in ("bias", "dispersion", "within", "within_low", "within_high")]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Judge and print; with ``--fit`` fit and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_record_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder for tables and rule")
    parser.add_argument("--fit", action="store_true", help="fit a rule on the records, judge it and write it")
    parser.add_argument("--rule", help="rule to judge; default: the shipped one")
    parser.add_argument("--seed", type=int, default=0, help="seed of the bootstrap")
    args = parser.parse_args()
    logging.disable(logging.WARNING)
    motions = read_strong(args)
    if not motions:
        parser.exit(1, "no strong channel among the records\n")
    cases = pd.concat([motion_cases(motion) for motion in motions], ignore_index=True)
    if reason := too_few(cases):
        parser.exit(1, f"{reason}\n")
    rules = fit_rules(cases) if args.fit else {point: load_rule(point, args.rule) for point in POINTS}
    tables = judge_rules(cases, rules, args.seed)
    write_tables(args.output, tables)
    if args.fit:
        provenance = {
            "date": datetime.now(UTC).date().isoformat(),
            "version": __version__,
            "command": "make rule",
            "channels": int(cases["record"].nunique()),
            "earthquakes": int(cases["event"].nunique()),
            "cases": len(cases),
            "reached": int(np.isfinite(cases["factor_mean"]).sum()),
            "processing": PROCESSING,
            "events": sorted(cases["event"].unique()),
            "records": sorted(cases["record"].unique()),
        }
        (args.output / "rule.toml").write_text(rule_text(rules, tables, provenance), encoding="utf-8")
    print(overview(tables))


if __name__ == "__main__":
    main()
