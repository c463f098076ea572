"""The results of code checks as text for the terminal."""

import math
from dataclasses import replace

import xarray as xr

from rockpulse.views.shared.formatting import ABSENT, paragraph, ratio, several, three_digits
from rockpulse.views.shared.table import Cell, lines
from rockpulse.views.shared.table_columns import tabulated, titled

#: Printed names of the codes.
CODE_WORDS = {
    "circolare_2009": "Circolare 617/2009",
    "circolare_2019": "Circolare 7/2019",
    "en_1998": "EN 1998-1, 4.3.5",
    "circolare_2019_frame": "C7.2.11 (frame)",
}


def code_words(code: str) -> str:
    """Return the printed name of a code, or of a limit state that is checked by records at a demand."""
    state, _, demand = code.removeprefix("records_").partition(", ")
    return CODE_WORDS.get(code) or f"{state.upper()}, records{f' ({demand})' * bool(demand)}"


def _value(value: float) -> Cell:
    return Cell(ABSENT if math.isnan(value) else "inf" if math.isinf(value) else three_digits(value))


def _word(value: float) -> Cell:
    return Cell("" if math.isnan(value) else "passes" if value >= 1.0 else "FAILS")


#: Columns on the code checks, and columns on the time histories.
_OF_CODE = (
    titled("", lambda code: Cell(f"  {code_words(code)}"), "code"),
    titled("alpha_0", _value, "multiplier"),
    titled("a_0*", _value, "activation"),
    titled("demand", _value, "activation_demand"),
    titled("ratio", _value, "activation_ratio"),
    titled("", _word, "activation_ratio"),
    titled("d_u", _value, "displacement"),
    titled("T", _value, "period"),
    titled("demand", _value, "displacement_demand"),
    titled("ratio", _value, "displacement_ratio"),
    titled("", _word, "displacement_ratio"),
)
_OF_RECORDS = (titled("n", lambda count: Cell(f"{count}" if count else ABSENT), "records"),)
_OF_RESULTS = (
    titled("P", lambda chance: Cell(ratio(chance)), "probability"),
    titled("median scale factor", _value, "factor_50"),
)


def check_overview(check: xr.Dataset) -> str:
    """Return the result of :func:`rockpulse.check` as text: a table for all bodies, and notes."""
    beside = "probability" in check
    names, codes = (check[dim].values.tolist() for dim in ("block", "code"))
    rows = check.stack(row=("block", "code"))
    of_records = any(code.startswith("records_") for code in codes)
    table = tabulated("", "", _OF_CODE + _OF_RECORDS * of_records + _OF_RESULTS * beside, rows)
    below = []
    for place, name in enumerate(names):
        below += [(Cell(name), *[Cell("")] * (len(table.headings) - 1))]
        below += table.rows[place * len(codes) : (place + 1) * len(codes)]
    title = (
        f"Checks of codes, {several(len(names), 'body')}: {check.attrs['spectrum']}; "
        f"{str(check.attrs['limit_state']).upper()}, q {check.attrs['q']:g}, FC {check.attrs['confidence_factor']:g}, "
        f"q_a {check.attrs['q_a']:g}, gamma_a {check.attrs['gamma_a']:g}"
    )
    notes = [
        "alpha_0: load multiplier that activates the mechanism; a_0*: its spectral acceleration, with FC, and the "
        "demand [m/s2]; d_u: ultimate displacement and the demand [m] at the period T [s]; a ratio of 1 or more passes."
    ]
    periods = check["initial_period"].values
    if any(code.startswith("circolare_2019") for code in codes):
        notes += [
            f"{name}: free to vibrate, T_0 {period:.3g} s: the demand is S_eZ(T_0) (C8.7.1.9)."
            for name, period in zip(names, periods, strict=True)
            if period > 0.0
        ]
        if not (periods > 0.0).any():
            notes.append(
                "Circolare 7/2019: bodies are rigid until they open (a_Z, C8.7.1.8). Parapets and pinnacles are free "
                "to vibrate: give their elastic_modulus and density."
            )
    if of_records:
        notes.append(
            "SLV and SLC, records (C8.7.1.2.1.9): the demand is the mean displacement under n records scaled to the "
            f"[[demand]], for fewer than 7 the largest ({check.attrs['rule']}); inf: a record overturns the body. d_u: "
            "0.4 d_0 (SLV) or 0.6 d_0 (SLC), less if a tie breaks (SLV) or a beam loses its support. No record may "
            "pass d_0."
        )
    if beside:
        notes.append(
            "P: probability of overturning as in the verdict: under the records as recorded or, with a [[demand]], "
            "scaled to it; that demand may differ from the one of [check]. Median scale factor: median over the "
            "records of the multiplier at P = 50 %."
        )
        notes += [f"{name}: {words}." for name, words in zip(names, check["beside"].values, strict=True) if words]
    for place, name in enumerate(names):
        senses = (check[f"{what}_sense"].values[place] for what in ("activation", "displacement"))
        for code, opens, moves in zip(codes, *senses, strict=True):
            if opens:
                moved = f", the displacement in the {moves} one" if moves else ""
                notes.append(f"{name}, {code_words(code)}: the acceleration governs in the {opens} sense{moved}.")
    for name, row in zip(names, check["statement"].values, strict=True):
        if len(row) > 1 and len(set(row)) == 1 and row[0]:
            notes.append(f"{name}: {row[0]}.")
        else:
            pairs = zip(codes, row, strict=True)
            notes += [f"{name}, {code_words(code)}: {words}." for code, words in pairs if words]
    return "\n".join(
        [paragraph(title), *lines(replace(table, rows=tuple(below))), *(paragraph(line, "  ") for line in notes)]
    )
