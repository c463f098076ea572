"""The kernels as plain Python: the same answers as compiled, but for the last digits.

Compiled kernels fuse a multiplication and an addition into one rounding, and plain Python does not, so that agreement
is to 1e-9 on cases that do not amplify rounding. ``test_sequence.py`` has more of the sequence models.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
import reduced_set

from rocking import Outcome, Reason

TOLERANCE = 1e-9


@pytest.fixture(scope="module")
def compiled():
    assert not numba.config.DISABLE_JIT, "nothing to compare with: run this test without NUMBA_DISABLE_JIT"
    return reduced_set.answers()


@pytest.fixture(scope="module")
def plain():
    run = subprocess.run(
        [sys.executable, reduced_set.__file__],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


@pytest.mark.sweep
def test_plain_python_answers_as_the_compiled_kernels_do(compiled, plain):
    assert plain.keys() == compiled.keys()
    for name, values in compiled.items():
        assert plain[name] == pytest.approx(values, rel=TOLERANCE, abs=1e-12, nan_ok=True), name


def test_reduced_set_has_every_end_of_a_lane_and_both_sides_of_a_history(compiled):
    for equation in ("linear", "nonlinear"):
        outcomes = set(compiled[f"{equation}: plain: outcome"])
        assert outcomes == {Outcome.AT_REST, Outcome.ROCKS, Outcome.OVERTURNS}
        rotation = np.array(compiled[f"{equation}: history: rotation"])
        assert np.nanmin(rotation) < 0.0 < np.nanmax(rotation)
        # A chatter that dies out under the record: many impacts, then rest before its end.
        impacts, active = (np.array(compiled[f"{equation}: chatter: {name}"]) for name in ("impacts", "active_samples"))
        assert np.any((impacts > 5) & (active < reduced_set.PULSE.size - 1))
    assert set(compiled["nonlinear: free flight: reason"]) >= {Reason.FREE_FLIGHT}
    for name in ("impulsive", "sequence"):
        assert set(compiled[f"{name}: outcome"]) >= {Outcome.ROCKS, Outcome.OVERTURNS}
    assert set(compiled["search of the safety factor"]) == {Outcome.ROCKS, Outcome.OVERTURNS}
