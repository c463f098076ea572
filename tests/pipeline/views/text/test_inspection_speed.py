"""Every look at a file of 5,000 records x 100 blocks takes less than a second, imports aside."""

import time

import pytest
from many_results import many_results

from rockpulse.cli import main
from rockpulse.storage.hdf5.results_file import save

LOOKS = {
    "overview": ["inspect", "{a}"],
    "records": ["inspect", "{a}", "--records"],
    "blocks": ["inspect", "{a}", "--blocks"],
    "filter": ["inspect", "{a}", "--outcome", "overturns", "--sort", "safety_factor"],
    "one record": ["inspect", "{a}", "--record", "{record}"],
    "one block": ["inspect", "{a}", "--block", "{block}"],
    "table": ["export", "{a}", "-o", "{table}", "--overwrite", "--sort", "safety_factor", "--limit", "1000"],
    "the same": ["diff", "{a}", "{a}"],
    "another run": ["diff", "{a}", "{b}", "--limit", "20"],
}


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    folder = tmp_path_factory.mktemp("large")
    tree = many_results(5000, 100, samples=1, seed=1)
    save(tree, folder / "a.h5")
    # The same run after a small change: a share of the answers moves, some verdicts flip.
    factor, outcome = (tree["summary"][name].values for name in ("safety_factor", "outcome"))
    factor[::50] *= 1.0 + 1e-4
    outcome[::100, 7, -1] = 2 - outcome[::100, 7, -1]
    save(tree, folder / "b.h5")
    record, block = (str(tree["summary"][dim].values[7]) for dim in ("record", "block"))
    others = {"table": str(folder / "table.csv"), "record": record, "block": block}
    return {name: str(folder / f"{name}.h5") for name in "ab"} | others


@pytest.mark.slow
@pytest.mark.parametrize("look", LOOKS)
def test_a_look_at_large_results_takes_less_than_a_second(names, look, capsys):
    command = [word.format(**names) for word in LOOKS[look]]
    took = []
    for _ in range(4):  # the first one imports
        start = time.perf_counter()
        assert main(command) in (0, 1)
        took.append(time.perf_counter() - start)
        assert capsys.readouterr().out
    assert min(took) < 1.0, took
