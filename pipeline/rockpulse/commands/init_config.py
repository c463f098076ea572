"""``rockpulse init-config``: the annotated template of a configuration."""

from __future__ import annotations

import argparse
from importlib.resources import files
from pathlib import Path

from rockpulse.commands.telling import tell
from rockpulse.commands.verb import Verb
from rockpulse.errors import ConfigError

__all__ = ["VERB"]


def _add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", metavar="FILE", help="write here instead; a file that exists is left alone")


def _run(args: argparse.Namespace) -> int:
    template = files("rockpulse.config").joinpath("template.toml").read_text(encoding="utf-8")
    if args.output is None:
        tell(template.removesuffix("\n"))
        return 0
    try:
        with Path(args.output).open("x", encoding="utf-8", newline="\n") as file:
            file.write(template)
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
