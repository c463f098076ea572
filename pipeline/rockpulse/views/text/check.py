"""The results of code checks as a table and notes, for the terminal and the report."""

import math
from collections.abc import Sequence
from dataclasses import replace

import xarray as xr

from rockpulse.views.shared.formatting import ABSENT, paragraph, ratio, six_digits, three_digits
from rockpulse.views.shared.table import Cell, Table, lines
from rockpulse.views.shared.table_columns import Column, tabulated, titled
from rockpulse.views.shared.words import counted_words, reason_words, result_text, say


def code_words(code: str) -> str:
    """Return the printed name of a code, or of a limit state checked under records scaled to a demand."""
    state, _, demand = code.removeprefix("records_").partition(", ")
    if not code.startswith("records_"):
        return say(f"check.{code}")
    return say("check.records", state=state.upper(), demand=f" ({demand})" * bool(demand))


def _value(value: float) -> Cell:
    return Cell(three_digits(value) if math.isfinite(value) else ABSENT)


def _moved(value: float) -> Cell:
    """Return the cell of a displacement demand; an infinite demand means that a record overturns the body."""
    return Cell(say("answer.overturns")) if math.isinf(value) else _value(value)


def _columns(check: xr.Dataset, report: bool = False) -> tuple[Column, ...]:
    """Return the columns of a row for each body and code; those for the report have titles, and other words."""
    demand, share = say("check.demand"), say("check.ratio")
    code, outcome = (say("check.code"), say("check.outcome")) if report else ("", "")
    passes, fails = (say(f"check.{word}") for word in (("yes", "no") if report else ("passes", "fails")))

    def word(value: float) -> Cell:
        good = Cell(passes, grade="good") if value >= 1.0 else Cell(fails, grade="bad")
        return Cell("") if math.isnan(value) else good

    counted = titled("n", lambda count: Cell(f"{count}" if count else ABSENT), "records")
    return (
        *([titled(say("head.body"), Cell, "block")] if report else []),
        titled(code, lambda code: Cell(code_words(code)), "code"),
        titled("alpha_0", _value, "multiplier"),
        titled("a_0*", _value, "activation", unit="m/s2"),
        titled(demand, _value, "activation_demand", unit="m/s2"),
        titled(share, _value, "activation_ratio"),
        titled(outcome, word, "activation_ratio"),
        titled("d_u", _value, "displacement", unit="m"),
        titled("T", _value, "period", unit="s"),
        titled(demand, _moved, "displacement_demand", unit="m"),
        titled(share, _value, "displacement_ratio"),
        titled(outcome, word, "displacement_ratio"),
        *([counted] if _of_records(check) else []),
    )


def check_table(check: xr.Dataset, order: Sequence[str]) -> Table:
    """Return the result of :func:`rockpulse.check` as a table with a row for each body (in `order`) and code."""
    checked = check.sel(block=list(order)).stack(row=("block", "code"))
    return tabulated("code-checks", check_title(check), _columns(check, report=True), checked)


def check_overview(check: xr.Dataset) -> str:
    """Return the result of :func:`rockpulse.check` as text: a table for all bodies, and notes."""
    names, codes = (check[dim].values.tolist() for dim in ("block", "code"))
    of_results: tuple[Column, ...] = ()
    if "probability" in check:
        of_results = (
            titled("P", lambda chance: Cell(ratio(chance)), "probability"),
            titled("median scale factor", _value, "factor_50"),
        )
    table = tabulated("", "", _columns(check) + of_results, check.stack(row=("block", "code")))
    below = []
    for place, name in enumerate(names):
        below += [(Cell(name), *[Cell("")] * (len(table.headings) - 1))]
        own = table.rows[place * len(codes) : (place + 1) * len(codes)]
        below += [(code._replace(text=f"  {code.text}"), *row) for code, *row in own]
    notes = check_notes(check)
    if of_results:
        notes.append(
            "P: probability of overturning as in the verdict: under the records as recorded or, with a [[demand]], "
            "scaled to it; that demand may differ from the one of [check]. Median scale factor: median over the "
            "records of the multiplier at P = 50 %."
        )
        notes += [f"{name}: {words}." for name, words in zip(names, check["beside"].values, strict=True) if words]
    return "\n".join(
        [
            paragraph(check_title(check)),
            *lines(replace(table, rows=tuple(below))),
            *(paragraph(line, "  ") for line in notes),
        ]
    )


def check_title(check: xr.Dataset) -> str:
    """Return number of bodies, spectrum, limit state and coefficients of the checks as text."""
    factors = {name: six_digits(check.attrs[name]) for name in ("q", "confidence_factor", "q_a", "gamma_a")}
    return say(
        "check.title",
        bodies=counted_words(check.sizes["block"], "body"),
        spectrum=result_text(check.attrs["spectrum"]),
        state=str(check.attrs["limit_state"]).upper(),
        **factors,
    )


def _of_records(check: xr.Dataset) -> bool:
    return any(code.startswith("records_") for code in check["code"].values.tolist())


def check_notes(check: xr.Dataset) -> list[str]:
    """Explain the columns of the checks, the governing directions, and missing values."""
    names, codes = (check[dim].values.tolist() for dim in ("block", "code"))
    notes, periods = [say("check.columns")], check["initial_period"].values
    if {"circolare_2009", "circolare_2019"} <= set(codes):
        notes.append(say("check.replaced"))
    if any(code.startswith("circolare_2019") for code in codes):
        notes += [
            say("check.vibrates", name=name, period=three_digits(period))
            for name, period in zip(names, periods, strict=True)
            if period > 0.0
        ]
        if not (periods > 0.0).any():
            notes.append(say("check.rigid"))
    if _of_records(check):
        notes.append(say("check.rotations", rule=check.attrs["rule"]))
    for place, name in enumerate(names):
        senses = (check[f"{what}_sense"].values[place] for what in ("activation", "displacement"))
        for code, opens, moves in zip(codes, *senses, strict=True):
            if opens:
                moved = say("check.moves", sense=say(f"check.{moves}")) if moves else ""
                sense = say(f"check.{opens}")
                notes.append(say("check.opens", name=name, code=code_words(code), sense=sense, moved=moved))
    for name, row in zip(names, check["statement"].values, strict=True):
        said = [reason_words(str(one)) for one in row]
        if len(row) > 1 and len(set(said)) == 1 and said[0]:
            notes.append(f"{name}: {said[0]}.")
        else:
            notes += [f"{name}, {code_words(code)}: {one}." for code, one in zip(codes, said, strict=True) if one]
    return notes
