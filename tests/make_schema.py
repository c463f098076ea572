"""Writes the tables of docs/schema.md from the declarations of the stored variables; the text between them stays."""

import re
from pathlib import Path

from rockpulse.storage.hdf5.layout import GROUPS

PAGE = Path(__file__).parents[1] / "docs" / "schema.md"

#: Declarations by the first word of the kind of file, and by group.
KINDS = {kind.partition(" ")[0]: groups for kind, groups in GROUPS.items()}

#: A table: the kind of file and, where it is of one group, the group.
TABLE = re.compile(r"(<!-- variables: (\w+)(?: (/\w+))? -->\n).*?(<!-- end -->)", re.DOTALL)


def meaning(variable):
    """What the page says of a variable: its long name, its explanation, the words of a flag."""
    told = "; ".join(filter(None, [variable.long_name, variable.explanation]))
    if variable.words:
        values = range(variable.first, variable.first + len(variable.words))
        told += f" (flag: {', '.join(f'{value} {word}' for value, word in zip(values, variable.words, strict=True))})"
    return told


def row(name, variable):
    dims = ", ".join("[case]" if dim == "case" else dim for dim in variable.dims)
    return [f"`{name}`", dims, variable.units, meaning(variable)]


def table(kind, only=None):
    """The variables of a kind of file, or of one of its groups."""
    groups = {group: declared for group, declared in KINDS[kind].items() if only in (None, group)}
    heads = ["variable", "dimensions", "unit", "meaning"]
    rows = [(group, row(name, variable)) for group, declared in groups.items() for name, variable in declared.items()]
    lines = [cells if only else [code(group), *cells] for group, cells in rows]
    heads = heads if only else ["group", *heads]
    rule = f"|{'---|' * len(heads)}\n"
    return "".join([f"| {' | '.join(heads)} |\n", rule, *(f"| {' | '.join(cells)} |\n" for cells in lines)])


def code(group):
    """The group as code, and of which results it is."""
    path, comma, which = group.partition(",")
    return f"`{path}`{comma}{which}"


def with_tables(page):
    """The page with every table as the declarations say."""
    return TABLE.sub(lambda found: f"{found[1]}{table(found[2], found[3])}{found[4]}", page)


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
