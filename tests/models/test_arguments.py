"""Arguments of which numpy would drop a part without a word are refused."""

import numpy as np
import pytest

from rocking.arguments import numbers, record_samples


@pytest.mark.parametrize(
    "values",
    [
        np.ma.masked_array([1.0, 2.0], [False, True]),
        np.array([1.0, 2.0 + 1j]),
        np.array([1.0, 2.0], dtype=complex),
        [1.0, 1j],
        ["a", "b"],
        None,
    ],
)
def test_masked_and_complex_values_are_refused(values):
    with pytest.raises(ValueError, match="ground: expected a "):
        record_samples("ground", values)
    with pytest.raises(ValueError, match="size: expected a length, "):
        numbers("size", values, "a length")


def test_a_masked_array_without_a_masked_value_is_taken():
    values = np.ma.masked_array([1.0, 2.0], False)
    assert record_samples("ground", values).tolist() == numbers("size", values, "a length").tolist() == [1.0, 2.0]
