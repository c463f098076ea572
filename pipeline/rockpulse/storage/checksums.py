"""Checksums of a results file: SHA-256 of every variable, and one of all attributes (docs/schema.md).

The checksum of a variable is that of its type and shape in one line (``float64 3x2``; ``text 3``; sizes in order,
nothing for a single value), a line feed, and its values in C order: numbers little-endian, each text in UTF-8 with a
zero byte after it. That of the attributes is the one of sorted lines, ``PATH`` for each group, ``PATH DIMENSION...``
for each variable and ``PATH@ATTRIBUTE CHECKSUM`` for each attribute, that of its values as of a variable of one
dimension.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["CHECKSUM", "CHECKSUM_OF_ATTRIBUTES", "VariableChecksum", "attributes_checksum"]

#: Attribute of each variable.
CHECKSUM = "sha256"
#: Attribute of the root.
CHECKSUM_OF_ATTRIBUTES = "attributes_sha256"


class VariableChecksum:
    r"""The checksum of a variable whose values, numbers or texts (dtype of kind U or O), come piece by piece.

    Examples
    --------
    >>> whole = VariableChecksum(np.dtype(float), (3,))
    >>> whole.add(np.array([1.0, 2.0]))
    >>> whole.add(np.array([3.0]))
    >>> whole.hexdigest() == hashlib.sha256(b"float64 3\n" + np.array([1.0, 2.0, 3.0]).tobytes()).hexdigest()
    True
    """

    def __init__(self, dtype: np.dtype[Any], shape: tuple[int, ...]) -> None:
        self._text = dtype.kind in "UO"
        kind = "text" if self._text else dtype.name
        self._hash = hashlib.sha256(f"{kind} {'x'.join(map(str, shape))}\n".encode())

    def add(self, values: np.ndarray) -> None:
        """Take the next values in."""
        if self._text:
            self._hash.update(b"".join(_bytes(text) + b"\0" for text in values.ravel().tolist()))
        else:
            self._hash.update(np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).data)

    def hexdigest(self) -> str:
        """The checksum of what was added."""
        return self._hash.hexdigest()


def attributes_checksum(attrs: Mapping[str, Mapping[str, Any]], dimensions: Mapping[str, Sequence[str]]) -> str:
    """The checksum of all attributes, the checksums of the variables included.

    `attrs` holds those of each group and variable by its path, `dimensions` the names of those of each variable.
    """
    lines = [f"{path} {' '.join(dimensions[path])}" if path in dimensions else path for path in attrs]
    for path, own in attrs.items():
        for name, value in own.items():
            if (path, name) != ("/", CHECKSUM_OF_ATTRIBUTES):
                lines.append(f"{path}@{name} {_of_value(value)}")
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()


def _of_value(value: Any) -> str:
    values = np.atleast_1d(np.asarray(value))
    if values.dtype.kind == "S":  # a text too
        values = values.astype(object)
    checksum = VariableChecksum(values.dtype, values.shape)
    checksum.add(values)
    return checksum.hexdigest()


def _bytes(text: str | bytes) -> bytes:
    return text.encode() if isinstance(text, str) else text
