"""Files that the user names: read only if they are files, and no larger than any of their kind needs to be."""

from __future__ import annotations

import os
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rockpulse.errors import ConfigError, RockpulseError

__all__ = ["TABLE_LIMIT", "TOML_LIMIT", "check_regular", "parse_toml", "read_text"]

#: Largest table and largest configuration that are read [bytes].
TABLE_LIMIT, TOML_LIMIT = 64 * 1024**2, 1024**2
#: How deep the sections and arrays of a TOML file may be nested, and how large its integers may be.
DEEPEST, LARGEST = 8, 2**63

_KINDS = {stat.S_ISFIFO: "a pipe", stat.S_ISSOCK: "a socket", stat.S_ISCHR: "a device", stat.S_ISBLK: "a device"}


def check_regular(path: str | os.PathLike[str], error: type[RockpulseError] = ConfigError) -> None:
    """Raise `error` for a pipe, a socket or a device, whose reading may never end; a missing file passes."""
    if not os.path.exists(path):  # noqa: PTH110 - Path.exists raises for a name that is too long
        return
    mode = os.stat(path).st_mode  # noqa: PTH116 - as above
    for is_kind, kind in _KINDS.items():
        if is_kind(mode):
            raise error(f"{path}: expected a file, found {kind}; write what it gives to a file, and name that one")


def read_text(path: Path, limit: int = TABLE_LIMIT, what: str = "a text file") -> str:
    """The text of a file in UTF-8, with or without a byte-order mark.

    Raises
    ------
    ConfigError
        For a pipe or a device, a file of more than `limit` bytes, and bytes that are no UTF-8; the message calls the
        file `what`.
    OSError
        Where the file cannot be opened.
    """
    check_regular(path)
    with path.open("rb") as file:
        content = file.read(limit + 1)
    if len(content) > limit:
        raise ConfigError(f"{path}: expected {what} of at most {limit:,} bytes, found more; is it the right file?")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: expected {what} in UTF-8, found byte {error.start} outside it") from None


def parse_toml(text: str, name: str, error: type[RockpulseError] = ConfigError) -> dict[str, Any]:
    """The content of a TOML text, which messages call by its `name`.

    Raises `error` for a text that is no TOML, is nested deeper than `DEEPEST`, or has an integer beyond `LARGEST`.
    """
    deep = f"{name}: sections and arrays are nested deeper than {DEEPEST} times, the limit"
    large = f"{name}: an integer is beyond the limit of 2^63; write a number with a decimal point"
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as fault:
        raise error(f"{name}: not valid TOML: {fault}") from None
    except RecursionError:
        raise error(deep) from None
    except ValueError:  # Python refuses integers of more than 4300 digits
        raise error(large) from None
    level: list[Any] = [document]
    for _ in range(DEEPEST):
        if any(type(value) is int and abs(value) >= LARGEST for value in level):
            raise error(large)
        level = [value for one in level for value in _inside(one)]
    if level:
        raise error(deep)
    return document


def _inside(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return value if isinstance(value, list) else []
