"""Fields of a sequence of impulses: ranges, lanes and scaling."""

import numpy as np
import pytest

from rocking.sequence import ImpulseSequence


def test_scaling_keeps_the_ratio_and_the_counts():
    series = ImpulseSequence(0.5, 0.2, 0.1, 20.0, main_count=3, intermediate_count=4, spacing="middle")
    scaled = series.scaled([1.0, 2.0])
    assert scaled.shape == (2,)
    assert scaled.main.tolist() == [0.5, 1.0]
    assert scaled.secondary.tolist() == [0.2, 0.4]
    assert (scaled.main_count, scaled.intermediate_count, scaled.spacing) == (3, 4, "middle")
    assert series.scaled(0.0).main == 0.0


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("main", -0.1),
        ("main", np.nan),
        ("main", np.inf),
        ("main", "large"),
        ("main", [[0.1]]),
        ("secondary", 0.6),
        ("secondary", -0.1),
        ("interval", 0.0),
        ("interval", np.nan),
        ("interval", np.inf),
        ("duration", 0.0),
        ("duration", np.nan),
        ("main_count", 0),
        ("main_count", 1.5),
        ("intermediate_count", 3),
        ("intermediate_count", 0),
        ("spacing", "late"),
    ],
)
def test_bad_fields_are_named(field, value):
    fields = {"main": 0.5, "secondary": 0.2, "interval": 0.1, "duration": 20.0, field: value}
    with pytest.raises(ValueError, match=field):
        ImpulseSequence(**fields)


def test_fields_of_different_lengths_and_bad_factors_are_refused():
    with pytest.raises(ValueError, match="one length"):
        ImpulseSequence([0.1, 0.2], 0.0, [0.1, 0.2, 0.3], 20.0)
    with pytest.raises(ValueError, match="factor"):
        ImpulseSequence(0.5, 0.2, 0.1, 20.0).scaled(-1.0)


def test_fields_are_broadcast_and_cannot_be_changed():
    series = ImpulseSequence([0.1, 0.2], 0.1, 0.1, np.inf)
    assert series.interval.shape == (2,)
    with pytest.raises(ValueError, match="read-only"):
        series.main[0] = 1.0
    with pytest.raises(AttributeError):
        series.main = 1.0
