"""Figures 4 and 5 of Casapulla & Maione (2017) as pictures and tables, and a verdict on each statement of the paper.

``python -m laboratory.paper FOLDER`` (``make paper``) writes figure4.png, figure5.png and their numbers as CSV, and
prints the largest rotations, the half-cycles of both blocks and the verdicts.
"""

import argparse
import logging
import textwrap
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from laboratory.paper.figure4 import figure4, no_motions
from laboratory.paper.figure5 import figure5
from laboratory.paper.pictures import draw_figure4, draw_figure5
from laboratory.tables import plain, write_tables
from rocking.response import Outcome
from rockpulse.views.plots.style import picture_bytes

#: From this factor on a table marks a peak that an input without end exceeds.
MORE = 1.01
NOTES = (
    "(4): overturns in half-cycle 4, for Figure 5 with the time at which that starts; 14: 0.65: 14 half-cycles and the "
    f"largest theta/alpha_c. *: an input without end gives more, by over {MORE - 1.0:.0%}. !: no motion of a block "
    "(through the ground, or a peak beyond alpha_c)."
)


def curves_text(figure: xr.Dataset) -> str:
    """Figure 4 for the limit of infinitely many secondary impulses and the first p: a table for each restitution."""
    own = figure.sel(intermediate_count=np.inf).isel(p=0, spacing=0, secondary_ratio=slice(None, None, 10))
    parts = []
    for c in figure["restitution"].values:
        rows = {"I_s/I": [f"{share:g}" for share in own["secondary_ratio"].values]}
        for ratio in own["impulse_ratio"].values:
            column = own.sel(restitution=c, impulse_ratio=ratio)
            rows[f"I/I_1c {ratio:g}"] = [_peak(column.isel(secondary_ratio=k)) for k in range(len(rows["I_s/I"]))]
        title = f"Figure 4: theta_max/alpha_c, C = {c:g}, n -> infinity, p = {float(own['p']):.4g} 1/s"
        parts.append(f"{title}\n{plain(pd.DataFrame(rows))}")
    missing = no_motions(figure)
    formats = dict.fromkeys(missing, str) | {"largest_of_these": "{:.3g}".format}
    parts.append(f"Cases without a result, of all n and p\n{plain(missing, formats)}")
    return "\n\n".join(parts)


def _peak(case: xr.Dataset) -> str:
    peak = float(case["peak_rotation_ratio"])
    if int(case["outcome"]) == Outcome.OVERTURNS:
        return f"({int(case['overturning_half_cycle'])})"
    endless = float(case["endless_peak_rotation_ratio"]) > MORE * peak
    return f"{peak:.3f}{'!' if bool(case['no_motion']) else '*' if endless else ''}"


def histories_text(figure: xr.Dataset) -> str:
    """Figure 5: the impulses of both blocks, then a line for each block, restitution and ratio with all spacings."""
    of_blocks = figure[["radius", "slenderness", "p", "critical_impulse", "main_impulse", "housner_restitution"]]
    of_blocks = of_blocks.merge(figure[["double_impulse", "double_impulse_time", "second_impulse_time"]])
    numbers = of_blocks.drop_vars("interval").to_dataframe().reset_index()
    stacked = figure.stack(case=("block", "restitution", "secondary_ratio"))
    rows = []
    for k, (block, c, share) in enumerate(stacked["case"].values.tolist()):
        case = stacked.isel(case=k)
        endings = {str(name): _ending(case.sel(spacing=name)) for name in figure["spacing"].values}
        rows.append({"block": block, "C": f"{c:g}", "I_s/I": f"{share:g}"} | endings)
    return (
        "Figure 5: main impulses I_2c, critical double impulse of Nabeshima et al. (2016); m, s\n"
        f"{plain(numbers, {name: lambda v: f'{v:.4g}' if isinstance(v, float) else v for name in numbers})}\n\n"
        f"Half-cycles, trial interval {float(figure['interval']):g} s\n{plain(pd.DataFrame(rows))}"
    )


def _ending(case: xr.Dataset) -> str:
    mark = "!" if bool(case["no_motion"]) else ""
    if int(case["outcome"]) == Outcome.OVERTURNS:
        return f"({int(case['overturning_half_cycle'])}) {float(case['overturning_time']):.2f} s{mark}"
    return f"{int(case['half_cycle_count'])}: {float(case['peak_rotation_ratio']):.3f}{mark}"


def statements_text(statements: pd.DataFrame) -> str:
    """The verdict on each statement, its words, where it holds and the figures that show it."""
    lines = []
    for row in statements.itertuples():
        lines.append(f"{row.verdict.upper() if row.verdict == 'fails' else row.verdict}: {row.statement}")
        where = f"holds where: {row.where}" if row.verdict == "holds in part" else ""
        for words in filter(None, (f'"{row.words}"', where, row.numbers)):
            lines.append(textwrap.fill(words, 120, initial_indent="    ", subsequent_indent="    "))
    return "\n".join(lines)


def main() -> None:
    """Compute, write and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where pictures and tables go")
    folder = parser.parse_args().folder
    logging.disable(logging.WARNING)
    curves, of_curves = figure4()
    histories, scan, history_results = figure5()
    cycles = histories[[name for name, one in histories.data_vars.items() if "half_cycle" in one.dims]]
    cycles = cycles.to_dataframe().reset_index()
    tables = {
        "figure4": curves.to_dataframe().reset_index(),
        "figure5": histories[["rotation_ratio"]].to_dataframe().reset_index(),
        "half_cycles": cycles[cycles["start_velocity"].notna()],
        "intervals": scan.drop_dims("statement").drop_vars("all_hold").to_dataframe().reset_index(),
        "statements": pd.concat([of_curves, history_results], ignore_index=True),
    }
    write_tables(folder, tables)
    spacing = str(curves["spacing"].values[0])
    (folder / "figure4.png").write_bytes(picture_bytes(draw_figure4(curves, spacing), "png"))
    (folder / "figure5.png").write_bytes(picture_bytes(draw_figure5(histories, spacing), "png"))
    texts = [curves_text(curves), histories_text(histories), scan.attrs["comment"]]
    texts += [statements_text(tables["statements"]), textwrap.fill(NOTES, 120)]
    print("\n\n".join(texts))


if __name__ == "__main__":
    main()
