"""``rockpulse init-config``: the annotated template of a configuration."""

from __future__ import annotations

import argparse
import json
from importlib.resources import files
from pathlib import Path
from textwrap import wrap

from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb
from rockpulse.errors import ConfigError

__all__ = ["VERB", "template"]


#: The next line of a comment of the template, and its length.
COMMENT, WIDTH = "\n" + 28 * " " + "# ", 90


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", metavar="FILE", help="write here instead; a file that exists is left alone")


def template() -> str:
    """Every key of the configuration with its default and its meaning; what it says of models is from their table."""
    from rockpulse.model_table import DEFAULT_MODELS, MODELS, NAMES, UPPER_BOUND

    others = (
        f'"{row.name}" ({UPPER_BOUND})' if row.upper_bound else f'"{row.name}"'
        for row in MODELS.values()
        if not row.default
    )
    told = {
        "{default}": json.dumps(DEFAULT_MODELS),
        "{others}": COMMENT.join(wrap(", ".join(others), WIDTH)),
        "{names}": json.dumps(NAMES),
        "{searched}": ", ".join(row.name for row in MODELS.values() if row.searched),
    }
    text = files("rockpulse.config").joinpath("template.toml").read_text(encoding="utf-8")
    for place, words in told.items():
        text = text.replace(place, words)
    return text


def _run(args: argparse.Namespace) -> int:
    text = template()
    if args.output is None:
        tell(text.removesuffix("\n"))
        return 0
    try:
        with Path(args.output).open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        found = "a folder of this name" if Path(args.output).is_dir() else "the file"
        raise ConfigError(f"{args.output}: {found} exists; choose another name") from None
    tell(
        f"wrote {args.output}: fill in the blocks, then: rockpulse assess RECORDS --config {args.output} -o results.h5"
    )
    return 0


VERB = Verb(
    name="init-config",
    summary="write a configuration with every key explained",
    description="Print a configuration with every key, its default and its meaning, or write it to a new file.",
    add_arguments=_add_arguments,
    run=_run,
    examples=("rockpulse init-config -o site.toml",),
)
