"""Results in Python: read or opened, with the verdicts and margins that the overview shows, as tables and a card."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from report_cases import answers, summary_of
from results_tree import results_bytes, results_tree

import rockpulse as rp
from rockpulse.assessment.answers import answers_of
from rockpulse.assessment.results import Results
from rockpulse.assessment.verdict import verdicts
from rockpulse.errors import ResultsError

SINE = rp.Record(3.0 * np.sin(np.arange(0.0, 40.0, 0.1)), dt=0.1, id="sine", processed=True)
WEAK = rp.Record(0.1 * SINE.acceleration, dt=0.1, id="weak", processed=True)
BODIES = {"chest": (1.0, 1.2), "wall": (0.25, 2.2)}
DEMAND = rp.DemandSettings(name="SLV", measure="pga", value=3.0)


@pytest.fixture(scope="module")
def tree():
    models = rp.ModelSettings(use=("nonlinear",))
    return rp.assess([SINE, WEAK], rp.Config(models=models, demands=(DEMAND,)), bodies=BODIES)


@pytest.fixture
def path(tmp_path):
    target = tmp_path / "results.h5"
    target.write_bytes(results_bytes())
    return target


def test_verdicts_are_those_of_the_overview(tree):
    table = tree.rockpulse.verdicts()
    found = verdicts(answers_of(tree))
    assert table.index.tolist() == ["chest", "wall"]
    assert table.index.name == "body"
    assert table["verdict"].tolist() == [""] * 2  # one earthquake is too few
    assert table["demand"].tolist() == ["SLV"] * 2
    assert table["probability"].tolist() == [one.demands[0].share.value for one in found]
    assert table["overturned"].tolist() == [one.deciding.overturned for one in found]
    assert table["motions"].tolist() == [one.deciding.motions for one in found]
    assert table["largest_rotation"]["chest"] == found[0].deciding.largest_rotation
    assert table["governing"]["wall"] == "sine"
    assert tree.rockpulse.verdicts("SLV").equals(table)


def test_a_margin_that_may_be_larger_says_so(tree, monkeypatch):
    """The second of three factors is where the model gives no result, and may be as large as any."""
    monkeypatch.setattr(Results, "_answers", answers(summary_of([2.0, 3.0, 4.0], resolved=[1, 0, 1])))
    table = Results(tree).margin()
    assert table[["smallest", "smallest_is_bound", "median", "median_is_bound"]].values.tolist() == [
        [2.0, False, 3.0, True]
    ]


def test_margins_are_those_of_the_answers(tree):
    table = tree.rockpulse.margin()
    margins = [one.recorded.margin for one in verdicts(answers_of(tree))]
    assert table["smallest"].tolist() == [one.smallest for one in margins]
    assert table["median"].tolist() == [one.median for one in margins]
    assert table["motion"]["wall"] == "sine"
    assert list(zip(table["smallest_is_bound"], table["median_is_bound"], strict=True)) == [
        one.bounds for one in margins
    ]
    of_demand = tree.rockpulse.margin("SLV")
    smallest = [one.demands[0].margin.smallest for one in verdicts(answers_of(tree))]
    assert of_demand["smallest"].tolist() == pytest.approx(smallest, nan_ok=True)
    assert of_demand["smallest"]["wall"] != table["smallest"]["wall"]


def test_no_record_is_named_where_none_counts():
    """All leave the body at rest, and the model tells no factor."""
    found = Results(xr.DataTree.from_dict({"/summary": summary_of([np.nan] * 2, outcomes=[0, 0])}))
    assert found.verdicts()["governing"].tolist() == [""]
    assert found.margin()["motion"].tolist() == [""]


def test_a_demand_that_is_not_there_is_reported(tree):
    with pytest.raises(ResultsError, match=r"no demand 'SLX'; did you mean \"SLV\"|no demand 'SLX'"):
        tree.rockpulse.margin("SLX")
    with pytest.raises(ResultsError, match=r"no demand 'earthquake'.*demands in the file: SLV"):
        tree.rockpulse.verdicts("earthquake")


def test_a_body_with_several_restitutions_has_a_row_for_each():
    names = Results(results_tree(cases=2)).verdicts().index.tolist()
    assert len(names) == 5
    assert names[1] == "column, C = 0.930"


def test_results_are_told_in_a_line_and_drawn(tree):
    assert repr(tree.rockpulse) == "<Results 2 records, 2 bodies, model nonlinear>"
    alone = xr.DataTree.from_dict({"/summary": summary_of([2.0])})
    assert repr(Results(alone)) == "<Results 1 record, 1 body, model nonlinear>"
    assert repr(Results(xr.DataTree())) == "<Results kind unknown, groups>"
    card = Results(results_tree())._repr_html_()
    assert card.count("<circle") == 3
    assert "boundary wall" in card


@pytest.mark.sweep
def test_many_bodies_are_drawn_in_part():
    many = rp.assess(WEAK, bodies={f"<b>{number}": (1.0, 4.0 + 0.01 * number) for number in range(30)})
    card = many.rockpulse._repr_html_()
    assert card.count("<circle") == 20
    assert "<b>" not in card


def test_a_tree_that_is_no_assessment_says_so():
    other = xr.DataTree.from_dict({"/figure4": xr.Dataset()})
    other.attrs["kind"] = "study"
    named = xr.DataTree.from_dict({"/summary": xr.Dataset()})
    named.attrs["kind"] = "study"
    assert repr(Results(named)) == "<Results kind study, groups summary>"
    assert repr(Results(other)) == "<Results kind study, groups figure4>"
    assert "<svg" not in Results(other)._repr_html_()
    for ask in (Results(other).verdicts, Results(other).margin):
        with pytest.raises(ResultsError, match=r"expected results of rockpulse\.assess, found a study"):
            ask()
    with pytest.raises(ResultsError, match="a tree without the group summary"):
        Results(xr.DataTree()).verdicts()


@pytest.mark.sweep
def test_opened_results_are_those_that_are_loaded(path):
    loaded = rp.load(path)
    with rp.open_results(path) as opened:
        assert opened.rockpulse.verdicts().equals(loaded.rockpulse.verdicts())
        assert opened.rockpulse.margin().equals(loaded.rockpulse.margin())
        assert set(opened.children) == set(loaded.children)
        untouched = opened["summary"]["npts"]
        assert not untouched.variable._in_memory
        kept = opened["summary"]["pga"].load()
    assert kept.values.tolist() == loaded["summary"]["pga"].values.tolist()
    with pytest.raises(Exception, match=r"."):  # HDF5's own words for a file that is closed
        untouched.values  # noqa: B018


def test_what_cannot_be_opened_is_reported(tmp_path):
    broken = tmp_path / "broken.h5"
    broken.write_bytes(b"no results")
    with pytest.raises(ResultsError, match="not a rockpulse results file"), rp.open_results(broken):
        pass
    with pytest.raises(FileNotFoundError), rp.open_results(tmp_path / "none.h5"):
        pass


@pytest.mark.sweep
def test_the_accessor_is_there_once_results_are(path):
    twice = "with rp.open_results(path) as tree:\n    print(tree.rockpulse)\n" * 2
    script = f"import rockpulse as rp, warnings\nwarnings.simplefilter('error')\npath = {str(path)!r}\n{twice}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120)
    assert done.stdout.count("<Results 3 records, 3 bodies") == 2
