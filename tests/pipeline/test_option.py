"""What a key takes, and how a refusal is worded."""

import dataclasses
import math

import pytest

from rockpulse.errors import ConfigError
from rockpulse.option import Section, boolean, choice, choices, count, hint, is_number, number, text, texts


@dataclasses.dataclass(frozen=True)
class Everything(Section):
    """One key of every kind."""

    heading = "[everything]"
    words: str = text("")
    list: tuple = texts()
    flag: bool = boolean(False)
    one: str | int = choice("red", ("red", "green"), most=9)
    some: tuple = choices(("red",), ("red", "green", "blue"))
    number: float | None = number(None, low=0.0, above=True, high=1.0, unit="m")
    count: int = count(1, low=1, high=10)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("words", 1, "expected a text, found 1"),
        ("one", "gren", r"\"red\", \"green\" or an integer from 1 to 9, found 'gren'; did you mean \"green\""),
        ("some", ["blu"], 'did you mean "blue"'),
        ("number", -math.inf, "found -inf; it must be finite"),
        ("number", "inf", "found 'inf'$"),
        ("number", True, "found True"),
        ("count", True, "found True"),
    ],
)
def test_a_refusal_names_section_key_and_value(key, value, message):
    with pytest.raises(ConfigError, match=rf"^\[everything\] {key}: .*{message}"):
        Everything(**{key: value})


def test_a_hint_is_given_only_where_a_word_is_close():
    assert hint("basline", ["baseline", "order"]) == '; did you mean "baseline"?'
    assert hint("xyz", ["baseline", "order"]) == ""


def test_what_there_is_stands_behind_the_hint_as_a_sentence():
    assert hint("basline", ["baseline"], "there are: x") == '; did you mean "baseline"? There are: x'
    assert hint("xyz", ["baseline"], "there are: x") == "; there are: x"


@pytest.mark.parametrize(("value", "answer"), [(1, True), (1.5, True), (True, False), ("1", False), (math.inf, False)])
def test_only_finite_numbers_are_numbers(value, answer):
    assert is_number(value) is answer
