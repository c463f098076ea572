"""The table of ties at a demand, and what anchors must take; a record too far from the demand does not count."""

import numpy as np
import pytest
from results_tree import demanding, results_tree

from rocking import Tie
from rocking.body.restraint import Restraints
from rockpulse.assessment.answers import Answers
from rockpulse.assessment.verdict import verdicts
from rockpulse.storage.variables.summary import SUMMARY
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.table import Cell
from rockpulse.views.shared.verdict_table import tie_table
from rockpulse.views.shared.words import writing

STEEL = Tie(3.0, 2e6, yield_force=4e4, ultimate=0.2)
ENDLESS = Tie(3.0, 2e6)
INF = np.inf


def summary_of(tie, elongation, state):
    """A node /summary in which the first body has one tie; the elongations [m] are those of three records."""
    summary = demanding(results_tree()["summary"].to_dataset(), {"ULS": 5.0})
    held = Restraints((tie,)).as_text()
    force = np.minimum(np.multiply(elongation, tie.stiffness), min(tie.yield_force, tie.stiffness * tie.ultimate))
    dims, shape = ("record", "block", "demand", "tie"), (3, 3, 1, 1)
    added = {}
    for name, values in (("elongation", elongation), ("force", force), ("state", state)):
        whole = np.full(shape, SUMMARY[f"demand_tie_{name}"].absent, dtype=float)
        whole[:, 0, 0, 0] = values
        added[f"demand_tie_{name}"] = SUMMARY[f"demand_tie_{name}"].variable(whole, dims)
    return summary.assign(
        added | {"restraints": summary["restraints"].copy(data=np.array([held, "", ""], dtype=object))}
    )


def shown(tie, elongation, state):
    answers = Answers(summary_of(tie, elongation, state))
    table = tie_table(answers, verdicts(answers), lambda row: Cell("abc"[row]))
    return [cell.text for cell in table.rows[0]], table.footnotes[1]


@pytest.mark.parametrize(
    ("tie", "elongation", "state", "cells", "anchor"),
    [
        (STEEL, [0.01, 0.05, 9.0], [1, 2, 3], ["50", "25 %", "40", "1 of 2", "0 of 2", "b"],
         "must take 40 kN, the yield force of the tie, and an elongation of 50 mm."),
        (STEEL, [0.015, 0.01, 0.0], [1, 1, 0], ["15", "8 %", "30", "0 of 2", "0 of 2", "a"],
         "must take 30 kN at an elongation of 15 mm; the tie does not yield. For the tie to yield before the "
         "anchor fails, the anchor must take 40 kN."),
        (STEEL, [INF, 0.05, 0.0], [3, 2, 0], ["50", "25 %", "40", "2 of 2", "1 of 2", "b"],
         "it breaks under 1 of 2 motions, after carrying up to 40 kN: the tie"),
        (ENDLESS, [0.0, 0.0, 0.0], [0, 0, 0], ["0", "-", "0", "-", "-", "-"],
         "it carries no force at the demand. It never breaks"),
        (ENDLESS, [0.003, 0.02, 0.0], [1, 1, 0], ["20", "-", "40", "-", "-", "b"],
         "must take 40 kN at an elongation of 20 mm"),
    ],
)  # fmt: skip
def test_rows_and_anchors(tie, elongation, state, cells, anchor):
    row, note = shown(tie, elongation, state)
    assert row == ["boundary wall, tie 1", "3", *cells]
    assert anchor in note


def test_no_table_without_ties_and_italian_numbers():
    answers = Answers(demanding(results_tree()["summary"].to_dataset(), {"ULS": 5.0}))
    assert tie_table(answers, verdicts(answers), Cell) is None
    with writing("it"):
        row, note = shown(STEEL, [0.0015, 0.001, 0.0], [1, 1, 0])
    assert row[2:5] == ["1,5", "1 %", "3"]
    assert "l'ancoraggio deve resistere a 3 kN con un allungamento di 1,5 mm" in note


def test_the_effect_of_crushing_on_the_angle_is_stated():
    """tan(alpha) = 0.1 with the corner 2 cm inside the face, 1 m below the centre of mass: about the edge 0.12."""
    summary = results_tree()["summary"].to_dataset()
    radius, alpha = np.hypot(0.1, 1.0), np.arctan(0.1)
    values = {"radius": radius, "alpha_c": alpha, "hinge_depth": 0.02}
    summary = summary.assign({name: summary[name].copy(data=np.full(3, value)) for name, value in values.items()})
    said = Known(summary, block="column").critical_angle
    assert said == "0.0997 rad (crushed edge: corners 2 cm inside the faces; 0.119 rad about the edge, −16.5 %)"
