"""``rockpulse init-config``: write an annotated template of a configuration."""

import argparse
import json
import re
import textwrap
from pathlib import Path
from typing import Any

from rockpulse.commands.parser import command
from rockpulse.commands.terminal import tell
from rockpulse.errors import ConfigError
from rockpulse.files import write_files

#: First and last column of the comments in the template.
BEGIN, END = 28, 122


def config_template() -> str:
    """Return the text of the configuration template, with the names of models and measures filled in."""
    from rockpulse.config.study_settings import HAZARD_UNITS
    from rockpulse.model_table import DEFAULT_MODELS, MODELS, NAMES, UPPER_BOUND
    from rockpulse.record.measures import DEMAND, FRAGILITY, HAZARD, MEASURES, PERIODIC, ROWS, SCALING, USUAL

    named = {"hazard": HAZARD, "units": HAZARD_UNITS, "families": PERIODIC}
    fields = {of: " | ".join(f'"{name}"' for name in names) for of, names in named.items()}
    others = [row for row in MODELS.values() if not row.default]
    fields["others"] = ", ".join(f'"{row.name}"' + f" ({UPPER_BOUND})" * bool(row.upper_bound) for row in others)
    fields["searched"] = ", ".join(row.name for row in MODELS.values() if row.searched)
    fields |= {"default": json.dumps(DEFAULT_MODELS), "names": json.dumps(NAMES)}
    for use, names in (("scaling", SCALING), ("demand", DEMAND)):
        fields[use] = " | ".join(f'"{name}" ({_meaning(ROWS[name])})' for name in names)
    order = sorted(FRAGILITY, key=lambda name: name not in USUAL)
    entries = {f'{"    " if name in USUAL else "    # "}"{name}",': MEASURES[name] for name in order}
    fields["fragility"] = "\n".join(f"{entry:<{BEGIN}}# {_meaning(measure)}" for entry, measure in entries.items())
    from importlib.resources import files  # imported late, as the help does not need it

    text = files("rockpulse.config").joinpath("template.toml").read_text(encoding="utf-8")
    return "\n".join(_filled(line, fields) for line in text.split("\n"))


def _meaning(measure: Any) -> str:
    return f"{measure.meaning or measure.long_name}, {measure.shown_unit}".removesuffix(", ")


def _filled(line: str, fields: dict[str, str]) -> str:
    """Replace the names in braces in a line of the template, and wrap the comment at its end."""
    filled = re.sub(r"\{(\w+)\}", lambda name: fields[name[1]], line)
    if filled == line or "\n" in filled or not filled.startswith("# ", BEGIN):
        return filled
    comment = textwrap.wrap(filled[BEGIN:].removeprefix("# "), END - BEGIN - len("# "), break_on_hyphens=False)
    return filled[:BEGIN] + f"\n{'':{BEGIN}}".join(f"# {part}" for part in comment)


@command(
    {
        "--bodies": "write a table of bodies (CSV) in place of the configuration",
        "-o --output FILE": "file to write; an existing file is not replaced",
    },
    examples=("rockpulse init-config -o site.toml", "rockpulse init-config --bodies -o bodies.csv"),
)
def init_config(args: argparse.Namespace) -> int:
    """Write a configuration with every key explained.

    Print a configuration with every key, its default and its meaning, or write it to a new file. With --bodies,
    write a table with a row for each body instead.
    """
    from rockpulse.config.body_table import body_template

    text = "\n".join([*body_template(), ""]) if args.bodies else config_template()
    if args.output is None:
        tell(text.removesuffix("\n"))
        return 0
    if args.bodies and not args.output.lower().endswith(".csv"):
        raise ConfigError(f"{args.output}: expected a name that ends in .csv for a table of bodies")
    target = Path(args.output)
    if target.exists():
        found = "a folder of this name" if target.is_dir() else "the file"
        raise ConfigError(f"{target}: {found} exists; choose another name")
    write_files({target: text.encode()})
    fill, option = ("rows", "--bodies") if args.bodies else ("blocks", "--config")
    given = f"{option} {args.output}"
    tell(f"wrote {args.output}: fill in the {fill}, then: rockpulse assess RECORDS {given} -o results.h5")
    return 0
