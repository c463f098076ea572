"""Plain text for the terminal: wrapped paragraphs and numbers with as many digits as they deserve."""

import math
import textwrap
from collections.abc import Callable
from typing import Any

from rockpulse.views.shared.words import numerals, say

#: Stands for what is absent or not computed.
ABSENT = "-"
#: Columns of running text.
WIDTH = 110


def ratio(value: float) -> str:
    """A ratio around one with two or three digits."""
    if math.isnan(value):
        return ABSENT
    if value == 0.0 or math.isinf(value):
        return f"{value:.0f}"
    if abs(value) < 0.001:
        return numerals("<0.001" if value > 0.0 else ">-0.001")
    return numerals(f"{value:.{3 if abs(value) < 0.1 else 2 if abs(value) < 10.0 else 1}f}")


def lower_bound(value: float) -> str:
    """A ratio that may be larger: the digits of :func:`ratio` behind a mark, rounded down."""
    places = 3 if value < 0.1 else 2 if value < 10.0 else 1
    down = math.floor(value * 10**places) / 10**places
    return numerals(f">{down:.{places}f}") if down > 0.0 else ">0"


def restitution(value: float) -> str:
    """A velocity ratio of impacts with three decimals: its distance from one decides how long a block rocks."""
    return numerals(f"{value:.3f}")


def three_digits(value: float, unit: str = "") -> str:
    """A number with three digits and its unit."""
    if math.isnan(value):
        return ABSENT
    return f"{numerals(f'{value:.3g}')} {unit}".rstrip()


def six_digits(value: float) -> str:
    """A number with the digits that it has, six at most."""
    return numerals(f"{value:g}")


def fixed(value: float, places: int = 2) -> str:
    """A number with so many decimals; a dash where it is not known."""
    return ABSENT if math.isnan(value) else numerals(f"{value:.{places}f}")


def between(low: float, high: float, show: Callable[[float], str] = three_digits) -> str:
    """An interval; a dash where neither end is known."""
    if math.isnan(low) and math.isnan(high):
        return ABSENT
    return say("between", low=show(low), high=say("no_limit") if math.isinf(high) else show(high))


def share(value: float) -> str:
    """A share in whole percent; a dash where it is not known."""
    return ABSENT if math.isnan(value) else f"{100.0 * value:.0f} %"


def several(count: int, noun: str) -> str:
    """A number and what is counted, the noun in the singular."""
    if count == 1:
        return f"1 {noun}"
    head, of, tail = noun.partition(" of ")
    plural = f"{head[:-1]}ies" if head.endswith("y") else f"{head}s"
    return f"{count} {plural}{of}{tail}"


def shortened(words: str, width: int) -> str:
    """Text in one line, cut in the middle to a width, so that both its ends can be recognised."""
    words = " ".join(words.splitlines())
    if len(words) <= width:
        return words
    tail = (width - 1) // 2
    return f"{words[: width - 1 - tail]}…{words[-tail:]}"


def paragraph(words: str, indent: str = "", first: str | None = None) -> str:
    """Running text, wrapped."""
    options: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False, "subsequent_indent": indent}
    return textwrap.fill(words, WIDTH, initial_indent=indent if first is None else first, **options)
