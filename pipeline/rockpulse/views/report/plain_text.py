"""Texts for readers who do not use the command line: without folders and advice on options of the program."""

import dataclasses
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import xarray as xr

from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import SECTIONS, SEVERAL
from rockpulse.errors import last_part
from rockpulse.record.record import BETWEEN
from rockpulse.views.shared.files_used import failure_rows
from rockpulse.views.shared.words import language, raw_text, table

#: Character that replaces the first protected name while a text is changed; private use in Unicode.
KEPT = 0xE000


@cache
def _option() -> re.Pattern[str]:
    """Return the pattern of a section or key of the configuration, or an option or verb of the command line."""

    def keys(cls: type) -> Iterator[str]:
        for item in dataclasses.fields(cls):
            yield item.name
            yield from keys(item.metadata["entries"]) if "entries" in item.metadata else ()

    names = {name for cls in (*SECTIONS.values(), BlockSettings) for name in keys(cls)}
    several = "|".join(sorted(name for name in names if re.fullmatch("[a-z]{2,}(_[a-z]{2,})+", name)))
    sections = "|".join([*SECTIONS, *SEVERAL])
    return re.compile(rf"\[\[?(?P<section>{sections})(?:\.\w+)?\]\]?|\b(?P<key>{several})\b|--[a-z]|\brockpulse [a-z]+")


def plain_words(words: str, folders: tuple[str, ...] = (), names: tuple[str, ...] = ()) -> str:
    """Return a text without folders and advice on options of the program; other keys are replaced by their meaning.

    A sentence, a part of a sentence after a semicolon, or a parenthesis is advice if it names an option. Names that
    the user gave are kept.

    >>> plain_words("the mean was subtracted; set [conditioning] baseline to keep it")
    'the mean was subtracted'
    """
    for folder in folders:
        words = words.replace(folder, "")
    for place, name in enumerate(names):
        words = words.replace(name, chr(KEPT + place))
    option = _option()
    if " " in words and option.search(words):  # without a blank: a name that the user gave, such as of a file
        words = re.sub(r" \([^()]*\)", lambda found: "" if option.search(found[0]) else found[0], words)
        first, *further = re.split(r"(?<=;) |(?<=\.) (?=[A-ZÀ-Ý])", words)
        kept = " ".join([first, *(part for part in further if not option.search(part))])
        if kept.endswith(";"):
            kept = kept[:-1] + "." * words.endswith(".")
        words = option.sub(_in_words, kept)
    for place, name in enumerate(names):
        words = words.replace(chr(KEPT + place), name)
    return words


def _in_words(option: re.Match[str]) -> str:
    if key := option["key"]:
        return raw_text(f"app.key.{key}") if f"app.key.{key}" in table(language()) else key.replace("_", " ")
    return option["section"] or option[0]


def folders_of(tree: xr.DataTree, results: xr.DataTree | str | Path | None) -> tuple[str, ...]:
    """Return the folders of the input files and of the results, as starts of paths; their common folder is first."""
    named = [Path(results).absolute()] if isinstance(results, str | Path) else []
    sources = [*tree["summary"].to_dataset()["source"].values.tolist(), *(row.file for row in failure_rows(tree))]
    named += [Path(name.partition("!")[0]) for source in sources for name in source.split(BETWEEN)]
    folders = {str(path.parent) for path in named if path.is_absolute()}
    common = os.path.commonpath(folders) if len({Path(one).drive for one in folders}) == 1 else ""
    if len(Path(common).parts) > 2:
        folders.add(common)
    return tuple(f"{folder}{os.sep}" for folder in sorted(folders, key=len) if len(Path(folder).parts) > 1)


def names_of(tree: xr.DataTree) -> tuple[str, ...]:
    """Return the names of bodies, demands, records and files that contain words of an option, the longest first."""
    summary = tree["summary"].to_dataset()
    found = {
        str(attrs.get(name, "")) for attrs in (tree.attrs, summary.attrs) for name in ("title", "site_description")
    }
    found.update(str(one) for name in ("block", "demand", "record") if name in summary for one in summary[name].values)
    for file in [*summary["source"].values.tolist(), *(row.file for row in failure_rows(tree))]:
        found.update(last_part(part) for one in file.split(BETWEEN) for part in (one, one.partition("!")[0]))
    return tuple(sorted((name for name in found if _option().search(name)), key=len, reverse=True))
