"""Arguments of which numpy would drop a part without a word are refused."""

import numpy as np
import pytest

from rocking.arguments import common_shape, numbers, positive, record_samples


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
    with pytest.raises(ValueError, match=r"ground: expected an? "):
        record_samples("ground", values)
    with pytest.raises(ValueError, match="size: expected a length, "):
        numbers("size", values, "a length")


def test_a_masked_array_without_a_masked_value_is_taken():
    values = np.ma.masked_array([1.0, 2.0], False)
    assert record_samples("ground", values).tolist() == numbers("size", values, "a length").tolist() == [1.0, 2.0]


def test_a_number_or_a_row_of_numbers_is_taken_where_lanes_are_allowed():
    assert numbers("size", "2.5", "a length").tolist() == 2.5
    assert numbers("size", [2, -3], "a length").tolist() == [2.0, -3.0]
    assert numbers("size", [], "a length").shape == (0,)
    assert numbers("size", 7, "a length", lanes=False).shape == ()
    with pytest.raises(ValueError, match=r"^size: expected a length, or an array of them, got shape \(1, 2\)$"):
        numbers("size", [[1.0, 2.0]], "a length")
    with pytest.raises(ValueError, match=r"^size: expected a length, not an array, got shape \(1,\)$"):
        numbers("size", [1.0], "a length", lanes=False)
    for one in (np.nan, np.inf, [1.0, -np.inf]):
        with pytest.raises(ValueError, match=r"^size: expected a length, finite, got "):
            numbers("size", one, "a length")


def test_positive_numbers_are_above_zero_each_of_them():
    assert positive("size", [0.5, 1e-300], "m").tolist() == [0.5, 1e-300]
    assert positive("size", 0.5, "m", lanes=False) == 0.5
    for one in (0.0, [1.0, 0.0], [-0.5, 1.0]):
        with pytest.raises(ValueError, match=r"^size: expected a positive, finite number in m, got "):
            positive("size", one, "m")
    with pytest.raises(ValueError, match="not an array"):
        positive("size", [1.0], "m", lanes=False)


def test_values_together_have_one_shape():
    first, second = common_shape(a=np.array(2.0), b=np.array([3.0, 4.0]))
    assert (first.tolist(), second.tolist()) == ([2.0, 2.0], [3.0, 4.0])
    with pytest.raises(ValueError, match=r"^a, b: expected .* arrays of one length, got a \(2,\), b \(3,\)$"):
        common_shape(a=np.zeros(2), b=np.zeros(3))


def test_a_record_has_two_finite_samples_at_least_and_cannot_be_written_to():
    given = np.array([0.5, -1.5])
    taken = record_samples("ground", given)
    assert taken.tolist() == [0.5, -1.5]
    assert (taken.flags.writeable, given.flags.writeable) == (False, True)
    for values in ([], [1.0], 1.0, [[1.0, 2.0], [3.0, 4.0]]):
        with pytest.raises(
            ValueError, match=r"^ground: expected an \(n,\) array of at least 2 samples in m/s2, got shape"
        ):
            record_samples("ground", values)
    for values, place in (([np.nan, 1.0, np.nan], 0), ([2.0, 1.0, np.inf, np.nan], 2), ([2.0, -np.inf], 1)):
        with pytest.raises(ValueError, match=f"^ground: sample {place} is {values[place]}; "):
            record_samples("ground", values)
