"""``rockpulse selftest``: run the solvers of this installation on stored cases whose results are known to 24 digits."""

import argparse
import math

from rockpulse.commands.parser import Verb
from rockpulse.commands.shared_options import QUIET
from rockpulse.commands.terminal import tell

#: Columns of the table and their widths.
HEADS = {"case": -32, "kind": -13, "verdict": -10, "peak": 8, "error": 8, "bound": 6, "ns": 6}
HEADS |= {"solve_ivp: error": 17, "ns ": 9}


def _run(args: argparse.Namespace) -> int:
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


VERB = Verb(
    name="selftest",
    summary="solve stored cases and compare them with their stored results",
    description="Solve some thirty stored cases on this machine: error against results of 24 digits, verdicts, and the "
    "time per sample compared with scipy's solve_ivp. Exit code 0: every error is within its bound, 1: at least one is "
    "not.",
    options=({"--quiet": QUIET},),
    run=_run,
    examples=("rockpulse selftest",),
)
