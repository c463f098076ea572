"""Every kind is drawn from its file, and what does not fit is refused with what would."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
import xarray as xr

from rockpulse.accuracy_variables import REPORT
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.plots.drawing import DRAWERS
from rockpulse.plots.kinds import KINDS, OPTIONS, draw, kind_list
from rockpulse.plots.picture import svg

COLUMN = "column of $one$ piece"


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("accelerogram", ("record",)),
        ("limit-accelerogram", ("record", "block")),
        ("rotation-history", ("record", "block")),
        ("rocking-spectrum", ("record",)),
        ("overturning-map", ("record",)),
        ("critical-scale", ("block",)),
    ],
)
def test_kinds_of_an_assessment(assessed, kind, options):
    chosen = {"record": str(assessed["summary"]["record"].values[1]), "block": COLUMN}
    figure = draw(assessed, kind, **{name: chosen[name] for name in options})
    text = svg(figure)
    ET.fromstring(text)
    shown = chosen["record"] if "record" in options else COLUMN
    assert shown in text
    assert figure.get_size_inches()[0] == 6.3
    for ax in figure.axes:
        if ax.axison and ax.get_label() != "<colorbar>":
            assert ax.get_xlabel() or ax.get_shared_x_axes().get_siblings(ax) != [ax] or kind == "accelerogram"


def test_kinds_of_other_files(study4, study5, fragility_tree):
    assert len(draw(study4, "figure4", spacing="end", count=2).axes) == 2
    assert len(draw(study5, "figure5").axes) == 4
    assert len(draw(fragility_tree, "fragility", block="wall").axes) == 1


def test_an_accuracy_report_is_drawn(work_precision_rows):
    from rockpulse.accuracy_variables import TABLES

    rows = work_precision_rows.assign(
        **{name: np.nan for name in TABLES["work_precision"] if name not in work_precision_rows}
    )
    table = xr.Dataset.from_dataframe(rows.reset_index(drop=True).rename_axis("row"))
    tree = xr.DataTree.from_dict({"/work_precision": table})
    tree.attrs["kind"] = REPORT
    assert len(draw(tree, "work-precision").axes) == 2


def test_the_tables_agree():
    assert DRAWERS.keys() == KINDS.keys()
    assert {option for row in KINDS.values() for option in row.options} == OPTIONS.keys()
    words = kind_list()
    assert all(name in words and row.command in words for name, row in KINDS.items())


def test_an_unknown_kind_is_refused_with_the_nearest(assessed):
    with pytest.raises(ResultsError, match='did you mean "rotation-history"'):
        draw(assessed, "rotations-history")


def test_another_file_is_refused_with_the_command_that_makes_it(assessed, study4):
    with pytest.raises(ResultsError, match="expected a file of 'rockpulse fragility', found an assessment file"):
        draw(assessed, "fragility")
    with pytest.raises(ResultsError, match="'rockpulse study figure5', found a study file without the group figure5"):
        draw(study4, "figure5")


def test_an_option_of_another_kind_is_refused(assessed, study5):
    with pytest.raises(ResultsError, match="no block to choose; it takes record"):
        draw(assessed, "accelerogram", block="wall")
    with pytest.raises(ResultsError, match="no count to choose; it takes spacing"):
        draw(study5, "figure5", count=2)


def test_unknown_names_are_refused_with_the_nearest(assessed):
    record = str(assessed["summary"]["record"].values[0])
    with pytest.raises(ResultsError, match=f"nearest: .*{record}"):
        draw(assessed, "accelerogram", record=record[:-9])
    with pytest.raises(ResultsError, match="expected one of 2 records, none was named"):
        draw(assessed, "accelerogram")
    with pytest.raises(ResultsError, match="there are: wall"):
        draw(assessed, "critical-scale", block="xyz")
    with pytest.raises(ResultsError, match="from 1 to 1, got 2"):
        draw(assessed, "critical-scale", block="wall", case=2)
    with pytest.raises(ResultsError, match="expected one model"):
        draw(assessed, "overturning-map", block="wall", models=["linear", "nonlinear"])


def test_a_restitution_that_no_block_has_is_refused(assessed):
    with pytest.raises(ConfigError, match="from 0 to 1"):
        draw(assessed, "rocking-spectrum", record=str(assessed["summary"]["record"].values[0]), restitution=1.5)
