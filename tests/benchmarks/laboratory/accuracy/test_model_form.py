"""The errors of models against a judge, and demands as classifiers of overturning."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from laboratory.accuracy.model_form import (
    COMPARED,
    JUDGE,
    LEVELS,
    classifier_table,
    model_form_lanes,
    model_form_table,
    synthetic_records,
)
from rocking.response import Outcome

pytestmark = pytest.mark.slow


REST, ROCKS, OVER, UNRESOLVED = (int(outcome) for outcome in Outcome)


def made_up(rows):
    """Lanes of one model "cheap" from (demand, judge's peak, judge's outcome, model's peak, model's outcome)."""
    frame = pd.DataFrame(
        rows, columns=["velocity_ratio", f"peak {JUDGE}", f"outcome {JUDGE}", "peak cheap", "outcome cheap"]
    )
    other = {"ensemble": "made up", "uplift_ratio": -frame["velocity_ratio"], "impulse_ratio": 1.0}
    return frame.assign(**other)


LANES = made_up(
    [
        (0.1, 0.10, ROCKS, 0.20, ROCKS),  # ratio 2
        (0.1, 0.20, ROCKS, 0.10, ROCKS),  # ratio 1/2
        (0.3, 0.10, ROCKS, 0.40, ROCKS),  # ratio 4
        (0.3, 0.01, ROCKS, 0.50, ROCKS),  # too small a peak
        (0.3, 0.30, ROCKS, 0.00, REST),  # at rest in the model
        (0.7, 0.30, ROCKS, np.inf, OVER),  # false
        (0.7, np.inf, OVER, 0.50, ROCKS),  # missed
        (0.7, np.inf, OVER, 0.20, ROCKS),  # missed
        (3.0, np.inf, OVER, np.inf, OVER),
        (3.0, np.inf, OVER, np.nan, UNRESOLVED),
        (3.0, np.nan, UNRESOLVED, np.inf, OVER),
    ]
)


def level(demand_low, demand_high):
    table = model_form_table(LANES, models=("cheap",))
    return table[(table["demand_low"] == demand_low) & (table["demand_high"] == demand_high)].iloc[0]


def test_all_lanes_together():
    whole = level(0.0, np.inf)
    assert whole[["lanes", "unresolved", "overturn", "missed", "false"]].tolist() == [9, 2, 3, 2, 1]
    assert whole[["survivors", "at_rest"]].tolist() == [4, 1]
    assert whole["bias"] == pytest.approx(2.0)
    logs = np.log([2.0, 0.5, 4.0])
    assert whole["dispersion"] == pytest.approx(np.sqrt(np.sum((logs - logs.mean()) ** 2) / 2.0))


def test_the_levels_hold_every_lane_once():
    table = model_form_table(LANES, models=("cheap",))
    for column in ("lanes", "unresolved", "overturn", "missed", "false", "survivors"):
        assert table[column].iloc[1:].sum() == table[column].iloc[0], column
    assert len(table) == 1 + len(LEVELS)


def classified(fell, stood):
    over = [(value, np.inf, OVER, 0.0, REST) for value in fell]
    still = [(value, 0.1, ROCKS, 0.0, REST) for value in stood]
    table = classifier_table(made_up([*over, *still])).set_index("demand")
    return table.loc["velocity_ratio"], table.loc["uplift_ratio"], table.loc["impulse_ratio"]


def test_a_perfect_classifier_its_mirror_image_and_none():
    perfect, mirrored, constant = classified([2.0, 3.0], [0.5, 1.0])
    assert (perfect["auc"], mirrored["auc"], constant["auc"]) == (1.0, 0.0, 0.5)
    assert (perfect["false_at_0"], mirrored["false_at_0"], constant["false_at_0"]) == (0.0, 1.0, 1.0)


def test_false_alarms_at_a_share_of_missed_overturnings():
    """Twenty overturnings at 1 to 20, four survivors between them: one may be missed at 5 %, two at 10 %."""
    found, _, _ = classified(np.arange(1.0, 21.0), [0.5, 1.5, 2.5, 30.0])
    assert [found[f"false_at_{share}"] for share in (0, 5, 10)] == [0.75, 0.5, 0.25]
    # Pairs in which the overturned lane has the larger demand: 20 + 19 + 18 + 0 of 80.
    assert found["auc"] == pytest.approx(57 / 80)


@pytest.mark.slow
def test_a_factor_is_the_same_as_a_stronger_record():
    """Half-waves, phase and sequence of the scaled scene are those that the scaled record would have given."""
    record = synthetic_records(7, 1)[0]
    stronger = replace(record, acceleration=1.4 * record.acceleration)
    scaled = model_form_lanes("a", record, scales=(1.4,))
    direct = model_form_lanes("a", stronger, scales=(1.0,))
    for model in COMPARED:
        assert (scaled[f"outcome {model}"] == direct[f"outcome {model}"]).all(), model
        np.testing.assert_allclose(scaled[f"peak {model}"], direct[f"peak {model}"], rtol=1e-6)
