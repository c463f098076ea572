"""``rockpulse init-config``: the annotated template of a configuration."""

from __future__ import annotations

import argparse
from importlib.resources import files
from pathlib import Path

__all__ = ["add_parser", "run"]


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb.

    Parameters
    ----------
    subparsers : argparse subparsers
        What ``add_subparsers`` returned.
    """
    parser = subparsers.add_parser(
        "init-config",
        help="write a configuration with every key explained",
        description="Print a configuration with every key, its default and its meaning, or write it to a new file.",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="write here instead; a file that exists is left alone")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print or write the template.

    Parameters
    ----------
    args : argparse.Namespace
        Arguments of the verb.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    ConfigError
        Where the file exists.
    """
    from rockpulse.errors import ConfigError

    template = files("rockpulse").joinpath("template.toml").read_text(encoding="utf-8")
    if args.output is None:
        print(template, end="")
        return 0
    try:
        with Path(args.output).open("x", encoding="utf-8", newline="\n") as file:
            file.write(template)
    except FileExistsError:
        raise ConfigError(f"{args.output}: the file exists; choose another name") from None
    print(
        f"wrote {args.output}: fill in the blocks, then: rockpulse assess RECORDS --config {args.output} -o results.h5"
    )
    return 0
