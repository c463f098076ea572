"""The checks of codes as text and as a table."""

import math

import pandas as pd
import xarray as xr

from rockpulse.views.shared.table import Cell, Heading, Table, lines
from rockpulse.views.shared.terminal import ABSENT, figure, paragraph, ratio, several

#: What the codes are called.
CODE_WORDS = {
    "circolare_2009": "Circolare 617/2009",
    "circolare_2019": "Circolare 7/2019",
    "en_1998": "EN 1998-1, 4.3.5",
}


def check_overview(check: xr.Dataset) -> str:
    """The dataset of :func:`rockpulse.code_check` as text."""
    beside = "probability" in check
    heads = ["", "alpha_0", "a_0*", "asked", "ratio", "", "d_u", "T", "asked", "ratio", ""]
    heads += ["P", "f_50"] if beside else []
    rows = []
    for name in check["block"].values:
        rows.append((Cell(str(name)), *(Cell("") for _ in heads[1:])))
        for code in check["code"].values:
            one = check.sel(block=name, code=code)
            cells = [
                Cell(f"  {CODE_WORDS[str(code)]}"),
                Cell(_shown(one, "multiplier")),
                Cell(_shown(one, "activation")),
                Cell(_shown(one, "activation_demand")),
                Cell(_shown(one, "activation_ratio")),
                Cell(_word(float(one["activation_ratio"]))),
                Cell(_shown(one, "displacement")),
                Cell(_shown(one, "period")),
                Cell(_shown(one, "displacement_demand")),
                Cell(_shown(one, "displacement_ratio")),
                Cell(_word(float(one["displacement_ratio"]))),
            ]
            if beside:
                chance = float(one["probability"])
                cells += [Cell(ABSENT if math.isnan(chance) else ratio(chance)), Cell(_shown(one, "factor_50"))]
            rows.append(tuple(cells))
    state = str(check.attrs["limit_state"]).upper()
    title = (
        f"Checks of codes, {several(check.sizes['block'], 'body')}: {check.attrs['spectrum']}; {state}, q "
        f"{check.attrs['q']:g}, FC {check.attrs['confidence_factor']:g}, q_a {check.attrs['q_a']:g}, gamma_a "
        f"{check.attrs['gamma_a']:g}"
    )
    told = [
        "alpha_0: multiplier that opens the mechanism; a_0*: acceleration that does, with FC, and what is asked of it "
        "[m/s2]; d_u: displacement that is allowed [m] and asked for at the period T [s]; a ratio of 1 or more passes."
    ]
    if beside:
        told.append(
            "P: probability of overturning that the verdict of the results rests on, under the records as recorded or, "
            "where the site has a [[demand]], brought to it, which need not be that of [check]; f_50: median over the "
            "motions of the factor on each at which it is 50 %."
        )
        told += [
            f"{name}: {words}."
            for name, words in zip(check["block"].values, check["beside"].values, strict=True)
            if words
        ]
    told += _of_senses(check)
    for name, row in zip(check["block"].values, check["statement"].values, strict=True):
        if len(row) > 1 and len(set(row)) == 1 and row[0]:
            told.append(f"{name}: {row[0]}.")
        else:
            pairs = zip(check["code"].values, row, strict=True)
            told += [f"{name}, {CODE_WORDS[str(code)]}: {words}." for code, words in pairs if words]
    table = lines(Table("", "", tuple(map(Heading, heads)), tuple(rows)))
    return "\n".join([paragraph(title), *table, *(paragraph(line, "  ") for line in told)])


def _of_senses(check: xr.Dataset) -> list[str]:
    """A sentence for each body and code whose two senses are not alike."""
    found = []
    for name in check["block"].values:
        for code in check["code"].values:
            one = check.sel(block=name, code=code)
            opens, moves = (str(one[what].item()) for what in ("activation_sense", "displacement_sense"))
            if opens:
                moved = f", the displacement of the {moves} one" if moves else ""
                found.append(f"{name}, {CODE_WORDS[str(code)]}: the acceleration is of the {opens} sense{moved}.")
    return found


def check_table(check: xr.Dataset) -> pd.DataFrame:
    """A row for each body and code."""
    return check.to_dataframe().reset_index()


def _shown(one: xr.Dataset, name: str) -> str:
    value = float(one[name])
    return ABSENT if math.isnan(value) else "inf" if math.isinf(value) else figure(value)


def _word(value: float) -> str:
    return "" if math.isnan(value) else "passes" if value >= 1.0 else "FAILS"
