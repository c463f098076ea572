"""``rockpulse app``: open the local page of a project folder in the browser."""

import argparse
from importlib.util import find_spec
from pathlib import Path

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import tell
from rockpulse.errors import ConfigError


def _minutes(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value <= 1e4:
        raise argparse.ArgumentTypeError(f"expected a positive number of minutes, at most 10000, found {text!r:.40}")
    return value


def _port(text: str) -> int:
    value = int(text) if text.isdecimal() and len(text) < 6 else -1
    if not 0 <= value < 2**16:
        raise argparse.ArgumentTypeError(f"expected a port from 0 to 65535, found {text!r:.40}")
    return value


def _run(args: argparse.Namespace) -> int:
    if find_spec("nicegui") is None:
        raise ConfigError("rockpulse app needs the extra app: pip install 'rockpulse[app]'")
    folder = Path(args.folder)
    if folder.exists() and not folder.is_dir():
        raise ConfigError(f"{folder}: expected a folder, found a file; choose another name")

    from rockpulse.app.server import serve

    try:
        serve(folder, args.port, not args.no_browser, 60.0 * args.close_after, tell)
    except KeyboardInterrupt:  # the usual way to stop the server
        return 0
    return 0


VERB = Verb(
    name="app",
    summary="open a local page for records, bodies, site and results",
    description="Serve a page to the browser of this machine, on which you drop records, enter bodies and the site, "
    "and see results and report. The folder keeps site.toml, the records and the results, with which "
    "the other commands give the same numbers. Nothing is sent to another machine. Needs the extra app: pip install "
    "'rockpulse[app]'.",
    options=(
        {
            "FOLDER": (
                "project folder, created if missing; default: this folder",
                {"nargs": "?", "default": "."},
            ),
            "--no-browser": "print the address, without opening a browser",
            "--port N": ("port of the server; default: a free one", {"type": _port, "default": 0}),
            "--close-after MINUTES": (
                "time from the closing of the page to the end of the server; default: %(default)g",
                {"type": _minutes, "default": 10.0},
            ),
        },
    ),
    run=_run,
    examples=("rockpulse app", "rockpulse app basilica/"),
)
