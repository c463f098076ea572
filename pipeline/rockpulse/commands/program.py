"""Commands on the program itself: ``rockpulse selftest``, ``app`` and ``completion``."""

import argparse
import math
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from rockpulse.commands.parser import command, number
from rockpulse.commands.shared_options import QUIET
from rockpulse.commands.terminal import tell
from rockpulse.errors import ConfigError

#: Columns of the table and their widths.
HEADS = {"case": -32, "kind": -13, "verdict": -10, "peak": 8, "error": 8, "bound": 6, "ns": 6}
HEADS |= {"solve_ivp: error": 17, "ns ": 9}


def _line(cells: list[str]) -> str:
    widths = zip(cells, HEADS.values(), strict=False)  # some cases cannot be solved by solve_ivp
    return " ".join(cell.ljust(-width) if width < 0 else cell.rjust(width) for cell, width in widths)


def _error(value: float) -> str:
    return "verdict" if math.isinf(value) else f"{value:.1e}" if value else "0"


def _cost(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:,.0f}"


def _machine() -> str:
    import platform
    from importlib.metadata import version
    from pathlib import Path

    from rocking.lanes import available_cores
    from rockpulse.version import __version__

    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.is_file() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    versions = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "scipy"))
    processor = names[0] if names else platform.processor() or platform.machine()
    return (
        f"rockpulse {__version__}, Python {platform.python_version()}, {versions}; {processor}, {available_cores()} "
        "threads available"
    )


@command({"--quiet": QUIET}, examples=("rockpulse selftest",))
def selftest(args: argparse.Namespace) -> int:
    """Solve stored cases and compare them with their stored results.

    Solve some thirty stored cases on this machine: error against results of 24 digits, verdicts, and the time per
    sample compared with scipy's solve_ivp. Exit code 0: every error is within its bound, 1: at least one is not.
    """
    from rockpulse.studies.selftest.selftest import solve_case, stored_cases

    found = [solve_case(case) for case in stored_cases()]
    failed = [one for one in found if not one.passed]
    if not args.quiet:
        tell(_line(list(HEADS)))
        for one in found:
            stored = one.stored
            cells = [stored.case.case, stored.case.kind, one.outcome, f"{float(stored.peak):.5f}"]
            cells += [_error(one.error), f"{stored.bound:.0e}", _cost(one.cost)]
            if not math.isnan(one.error_of_solve_ivp):
                cells += [_error(one.error_of_solve_ivp), _cost(one.cost_of_solve_ivp)]
            tell(_line(cells) + ("" if one.passed else f"  FAILED: expected {stored.outcome}"))
        tell(f"\n{_machine()}")
        tell(
            "peak, error: theta_max/alpha_c and its difference from the stored result of 24 digits; ns: time per "
            "sample in\nwhich the body moves, with 64 scale factors per call on one thread, and with solve_ivp (RK45, "
            "rtol 1e-6), one case per call."
        )
        flips = sum(math.isinf(one.error) for one in found)
        tell(f"\n{len(found)} cases: {len(failed)} outside their bounds, {flips} of them with a different verdict")
    return 1 if failed else 0


@command(
    {
        "FOLDER": ("project folder, created if missing; default: this folder", {"nargs": "?", "default": "."}),
        "--no-browser": "print the address, without opening a browser",
        "--port N": (
            "port of the server; default: a free one",
            {"type": number(int, 0, 2**16 - 1, "a port from 0 to 65535"), "default": 0},
        ),
        "--close-after MINUTES": (
            "time from the closing of the page to the end of the server; default: %(default)g",
            {"type": number(float, math.ulp(0.0), 1e4, "a positive number of minutes, at most 10000"), "default": 10.0},
        ),
    },
    examples=("rockpulse app", "rockpulse app basilica/"),
)
def app(args: argparse.Namespace) -> int:
    """Open a local page for records, bodies, site and results.

    Serve a page to the browser of this machine, on which you drop records, enter bodies and the site, and see
    results and report. The folder keeps site.toml, the records and the results, with which the other commands give
    the same numbers. Nothing is sent to another machine. Needs the extra app: pip install 'rockpulse[app]'.
    """
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


#: Command that installs the script, for each shell.
HOW = {
    "bash": "rockpulse completion bash > ~/.local/share/bash-completion/completions/rockpulse",
    "zsh": "rockpulse completion zsh > ~/.zfunc/_rockpulse     (~/.zfunc in fpath, before compinit)",
    "fish": "rockpulse completion fish > ~/.config/fish/completions/rockpulse.fish",
    "powershell": "rockpulse completion powershell >> $PROFILE",
}

#: Placeholders in the help (metavariables) for names of files.
FILES = frozenset(
    "PATHS RESULTS FILE SITE REPORT TABLE BEFORE AFTER FRAGILITY CURVE CONFIG OUT".split()  # noqa: SIM905
)


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for verb in action.choices.values():
                yield from _actions(verb)


@command(
    {"shell": ("shell that reads the script", {"choices": tuple(HOW), "metavar": None})}, examples=tuple(HOW.values())
)
def completion(args: argparse.Namespace) -> int:
    """Print a script for shell completion.

    Print a script with which a shell completes commands, options, kinds of pictures, units and file names. The
    examples show where to put it; it takes effect in the next shell.
    """
    import shtab

    from rockpulse.model_table import MODELS
    from rockpulse.readers import UNITS
    from rockpulse.views.plots.picture_kinds import KINDS

    words = {"KIND": tuple(KINDS), "UNIT": tuple(UNITS), "MODEL": tuple(MODELS)}
    for action in _actions(args.program):
        metavar = str(action.metavar)
        if action.choices is None and metavar in words:
            action.choices = words[metavar]
        if metavar in FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        if metavar == "FOLDER":
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    tell(shtab.complete(args.program, shell=args.shell))
    return 0
