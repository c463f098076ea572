"""The words of a picture: labels from the attributes of the data, and names given by users as plain text."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from rockpulse.foreign_text import escaped

__all__ = ["counted", "label", "plain", "readable", "unit", "wrapped"]

#: CF units of the results as an engineer writes them.
_UNITS = {"m s-2": "m/s²", "m s-1": "m/s", "s-1": "1/s", "rad s-1": "rad/s", "degree": "°", "1": "-"}

#: Symbols of the long names as mathematics; of those that begin alike the longer one first.
_SYMBOLS = {
    "theta_max/alpha_c": r"$\theta_{max}/\alpha_c$",
    "theta/alpha_c": r"$\theta/\alpha_c$",
    "alpha_c": r"$\alpha_c$",
    "I_s/I": "$I_s/I$",
    "I/I_1c": "$I/I_{1c}$",
    "I_1c": "$I_{1c}$",
    "I_2c": "$I_{2c}$",
    "I_s": "$I_s$",
    "dT": r"$\Delta T$",
}
_SYMBOL = re.compile(rf"\b({'|'.join(map(re.escape, _SYMBOLS))})\b")

#: Mathematics of matplotlib: between dollars that are not escaped.
_MATHEMATICS = re.compile(r"(?<!\\)\$[^$]+(?<!\\)\$")

#: First of the letters that no text has.
_PRIVATE = 0xE000


def unit(units: str) -> str:
    """The printed form of a unit in the results (attribute `units`, CF).

    Examples
    --------
    >>> unit("m s-2"), unit("s"), unit("1")
    ('m/s²', 's', '-')
    """
    return _UNITS.get(units, units)


def readable(long_name: str) -> str:
    r"""A long name with its symbols as mathematics, without the remarks that follow a semicolon.

    Examples
    --------
    >>> readable("largest rotation over alpha_c; inf where the block overturns, 0 at rest")
    'largest rotation over $\\alpha_c$'
    """
    return _SYMBOL.sub(lambda found: _SYMBOLS[found.group()], long_name.split(";")[0].strip())


def label(attrs: Mapping[Any, Any], units: str | None = None, symbol: str = "") -> str:
    """Text of an axis from the attributes `long_name` and `units`, with the letter of the quantity after its name.

    The argument `units`, if given, replaces the attribute, where that points elsewhere.

    Examples
    --------
    >>> label({"long_name": "main impulse I of the calibrated sequence", "units": "m s-1"})
    'main impulse I of the calibrated sequence [m/s]'
    """
    name = f"{readable(str(attrs['long_name']))} {symbol}".rstrip()
    return f"{name} [{unit(str(attrs['units']) if units is None else units)}]"


def plain(name: object) -> str:
    r"""A name given by the user (record, block, title), escaped so that it cannot start mathematics.

    Examples
    --------
    >>> plain("wall $1$")
    'wall \\$1\\$'
    """
    return escaped(str(name)).replace("$", r"\$")


def wrapped(words: str, width: int) -> str:
    r"""Text broken into lines by its drawn length: mathematics counts as long as it is drawn, and is never broken.

    `width` is the longest line in characters; longer words are cut, so that no id leaves the picture. Line breaks in
    the text stay.

    Examples
    --------
    >>> wrapped("a row of $\\alpha_c$ and so on", 13)
    'a row of $\\alpha_c$\nand so on'
    """
    pieces = _MATHEMATICS.findall(words)
    # Each piece is replaced by as many letters of its own as it shows.
    for place, piece in enumerate(pieces):
        shown = re.sub(r"\\[A-Za-z]+", "x", piece[1:-1])
        words = words.replace(piece, chr(_PRIVATE + place) * max(len(re.sub(r"[{}_^ ]", "", shown)), 1), 1)
    text = "\n".join(textwrap.fill(line, width, break_on_hyphens=False) for line in words.split("\n"))
    for place, piece in enumerate(pieces):
        letter = chr(_PRIVATE + place)
        text = re.sub(f"{letter}(\n?{letter})*", piece.replace("\\", r"\\"), text)
    return text


def counted(names: Iterable[object], most: int = 3) -> str:
    """The first few names, and the number of the others.

    Examples
    --------
    >>> counted(["a", "b", "c", "d", "e"])
    'a, b, c and 2 more'
    """
    listed = [str(name) for name in names]
    more = len(listed) - most
    return ", ".join(listed) if more <= 0 else f"{', '.join(listed[:most])} and {more} more"
