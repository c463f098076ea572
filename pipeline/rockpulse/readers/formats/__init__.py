"""The formats. Each module of this package is found automatically and defines one or more of them."""

from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules

from rockpulse.readers.format import Format
from rockpulse.readers.formats import columns

_MODULES = [import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__)]
_ROWS = [row for module in _MODULES for row in vars(module).values() if isinstance(row, Format)]
#: Formats that each recognise only their own files, from the content.
_SPECIFIC = sorted((row for row in _ROWS if row is not columns.COLUMNS), key=lambda row: row.name)


def _is_nothing_but_columns(head: bytes, name: str) -> bool:
    return columns.is_columns(head, name) and not any(row.detect(head, name) for row in _SPECIFIC)


#: The formats in the order in which they are tried, with the least specific last; the first that recognises a file
#: reads it.
FORMATS: tuple[Format, ...] = (*_SPECIFIC, replace(columns.COLUMNS, detect=_is_nothing_but_columns))
