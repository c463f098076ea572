"""The bands of annual frequencies hold the truth as often as they say: 200 synthetic cases, minutes each."""

import importlib.util
import math
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[4] / "benchmarks" / "risk_coverage.py"

#: Seed of the cases here, which is none of those on which methods were compared.
SEED = 31


@pytest.mark.slow
@pytest.mark.parametrize("place", [0, 1])
def test_bands_of_fourteen_earthquakes_cover_what_they_say(place):
    """Between 0.85 and 0.95 at a nominal 0.90, give or take the binomial error of 200 cases, 0.025 at 0.85."""
    spec = importlib.util.spec_from_file_location("risk_coverage", SCRIPT)
    benchmark = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(benchmark)
    assert benchmark.SETTINGS[place][0] == 14
    bands, low, high, _ = benchmark.coverage(place, cases=200, seed=SEED)
    assert bands >= 195
    inside = 1.0 - (low + high) / bands
    error = math.sqrt(0.85 * 0.15 / bands)
    assert 0.85 - 1.64 * error <= inside <= 0.95 + 1.64 * error
