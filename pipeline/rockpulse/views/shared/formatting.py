"""Formats text for the terminal: wraps paragraphs, and writes numbers with an adequate number of digits."""

import math
import textwrap
from collections.abc import Callable
from typing import Any

from rockpulse.views.shared.words import numerals, say

#: Placeholder of a missing value.
ABSENT = "-"
#: Width of running text [characters].
WIDTH = 110


def ratio(value: float) -> str:
    """Format a ratio near 1 with two or three digits; NaN becomes a dash."""
    if math.isnan(value):
        return ABSENT
    if value == 0.0 or math.isinf(value):
        return f"{value:.0f}"
    if abs(value) < 0.001:
        return numerals("<0.001" if value > 0.0 else ">-0.001")
    return numerals(f"{value:.{3 if abs(value) < 0.1 else 2 if abs(value) < 10.0 else 1}f}")


def lower_bound(value: float) -> str:
    """Format a lower bound with the sign ">", rounded down to the digits of :func:`ratio`."""
    places = 3 if value < 0.1 else 2 if value < 10.0 else 1
    down = math.floor(value * 10**places) / 10**places
    return numerals(f">{down:.{places}f}") if down > 0.0 else ">0"


def restitution(value: float) -> str:
    """Format a coefficient of restitution with three decimals."""
    return numerals(f"{value:.3f}")


def three_digits(value: float, unit: str = "") -> str:
    """Format a number with three significant digits and its unit; NaN becomes a dash."""
    if math.isnan(value):
        return ABSENT
    return f"{numerals(f'{value:.3g}')} {unit}".rstrip()


def six_digits(value: float) -> str:
    """Format a number with at most six significant digits."""
    return numerals(f"{value:g}")


def fixed(value: float, places: int = 2) -> str:
    """Format a number with `places` decimals; NaN becomes a dash."""
    return ABSENT if math.isnan(value) else numerals(f"{value:.{places}f}")


def between(low: float, high: float, show: Callable[[float], str] = three_digits) -> str:
    """Format an interval as text; a dash if both limits are NaN."""
    if math.isnan(low) and math.isnan(high):
        return ABSENT
    return say("between", low=show(low), high=say("no_limit") if math.isinf(high) else show(high))


def share(value: float) -> str:
    """Format a share between 0 and 1 in whole percent; NaN becomes a dash."""
    return ABSENT if math.isnan(value) else f"{100.0 * value:.0f} %"


def several(count: int, noun: str) -> str:
    """Return a count with its English noun, such as "3 bodies"; `noun` is given in the singular."""
    if count == 1:
        return f"1 {noun}"
    head, of, tail = noun.partition(" of ")
    plural = f"{head[:-1]}ies" if head.endswith("y") else f"{head}s"
    return f"{count} {plural}{of}{tail}"


def shortened(words: str, width: int) -> str:
    """Shorten text to a width by cutting out its middle, so that both ends remain visible."""
    words = " ".join(words.splitlines())
    if len(words) <= width:
        return words
    tail = (width - 1) // 2
    return f"{words[: width - 1 - tail]}…{words[-tail:]}"


def paragraph(words: str, indent: str = "", first: str | None = None) -> str:
    """Wrap text to the width of the terminal and keep its line breaks; `first` is the indent of the first line."""
    options: dict[str, Any] = {"break_long_words": False, "break_on_hyphens": False, "subsequent_indent": indent}
    begin, *further = words.split("\n")
    first_line = textwrap.fill(begin, WIDTH, initial_indent=indent if first is None else first, **options)
    return "\n".join([first_line, *(textwrap.fill(one, WIDTH, initial_indent=indent, **options) for one in further)])
