"""Epochs of the channels of station metadata."""

from types import SimpleNamespace

import pytest

from rockpulse.readers.station_xml import _overlap


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ((1, 3), (2, 4), True),
        ((1, 2), (3, 4), False),
        ((1, 2), (2, 4), True),
        ((1, None), (3, 4), True),
        ((None, None), (3, None), True),
        ((None, 2), (3, None), False),
        ((3, None), (None, 2), False),
    ],
)
def test_epochs_without_a_limit_are_open(one, other, expected):
    epochs = [SimpleNamespace(start_date=start, end_date=end) for start, end in (one, other)]
    assert _overlap(*epochs) is expected
    assert _overlap(*reversed(epochs)) is expected
