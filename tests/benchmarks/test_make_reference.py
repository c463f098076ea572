"""The reference table: the same text of a number whatever library computed it."""

import pytest

NUMBERS = ["6.43427455086507005905196123456e-1", "1.5", "3.25e-17", "9.9999999999999999999999996e-3", "0"]
TEXTS = [
    "6.43427455086507005905196e-01",
    "1.50000000000000000000000e+00",
    "3.25000000000000000000000e-17",
    "1.00000000000000000000000e-02",
    "0.00000000000000000000000e+00",
]


@pytest.mark.parametrize(("number", "expected"), list(zip(NUMBERS, TEXTS, strict=True)))
def test_both_kinds_of_numbers_have_one_text(make_reference, precise, precise_with_mpmath, number, expected):
    for numbers in (precise, precise_with_mpmath):
        assert make_reference.text(numbers.real(number)) == expected, numbers.NUMBERS


def test_overturned_and_unresolved_are_texts_that_the_table_can_hold(make_reference, precise, precise_with_mpmath):
    for numbers in (precise, precise_with_mpmath):
        assert [make_reference.text(numbers.real(word)) for word in ("inf", "nan")] == ["inf", "nan"]


def test_the_text_is_that_of_gmpy2(make_reference):
    """In which the shipped table is written."""
    gmpy2 = pytest.importorskip("gmpy2")
    for number in (gmpy2.mpfr(k) / 7**k for k in range(1, 40)):
        assert make_reference.text(number) == f"{number:.23e}"
