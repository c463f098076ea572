"""The page as a PDF, printed by a browser that is on this machine: Chrome, Chromium or Edge, without a window."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from rockpulse.errors import ResultsError

__all__ = ["browser", "printed"]

#: What these browsers are called on PATH.
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge", "msedge")

#: Where Windows and macOS keep them: below the folders of programs, and among the applications.
PROGRAMS = ("ProgramFiles", "ProgramFiles(x86)", "LocalAppData")
WINDOWS = (
    "Google/Chrome/Application/chrome.exe",
    "Chromium/Application/chrome.exe",
    "Microsoft/Edge/Application/msedge.exe",
)
MACOS = (
    "Google Chrome.app/Contents/MacOS/Google Chrome",
    "Chromium.app/Contents/MacOS/Chromium",
    "Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
)

#: Seconds that printing may take; a report of 200 records and 20 bodies takes some ten.
LONGEST = 180.0

#: What to do without it.
_INSTEAD = "write the report as .html and print it from a browser"

OPTIONS = (
    "--headless",
    "--disable-gpu",
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--no-pdf-header-footer",
)


def browser() -> str:
    """The program that prints; a ResultsError that says what to do where there is none."""
    for name in NAMES:
        if found := shutil.which(name):
            return found
    homes = [Path(home) for home in map(os.environ.get, PROGRAMS) if home]
    places = [home / name for home in homes for name in WINDOWS]
    if sys.platform == "darwin":
        applications = (Path("/Applications"), Path.home() / "Applications")
        places += [folder / name for folder in applications for name in MACOS]
    for place in places:
        if place.is_file():
            return str(place)
    raise ResultsError(
        "no Chrome, Chromium or Edge was found to print the PDF with; install one of them (Debian, Ubuntu: apt install "
        "chromium), or write the report as .html and print it from any browser"
    )


def printed(page: str) -> bytes:
    """The PDF of a page of HTML.

    Raises
    ------
    ResultsError
        Where there is no browser, or it does not print within the time.
    """
    program = browser()
    # A profile of its own: a browser that is open would take the page over, and print nothing.
    with tempfile.TemporaryDirectory(prefix="rockpulse-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder, "report.html"), Path(folder, "report.pdf")
        source.write_text(page, encoding="utf-8", errors="replace")
        command = [program, *OPTIONS, f"--user-data-dir={Path(folder, 'profile')}", f"--print-to-pdf={target}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.append("--no-sandbox")  # without which it refuses to run as root
        try:
            done = subprocess.run(
                [*command, source.as_uri()], capture_output=True, timeout=LONGEST, check=False, stdin=subprocess.DEVNULL
            )
        except subprocess.TimeoutExpired:
            raise ResultsError(f"{program}: did not print the report within {LONGEST:.0f} s; {_INSTEAD}") from None
        except OSError as error:
            raise ResultsError(f"{program}: cannot be run ({error.strerror}); {_INSTEAD}") from error
        if done.returncode or not target.is_file():
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()
            last = f": {said[-1]}" if said else ""
            raise ResultsError(f"{program}: printed no PDF (exit code {done.returncode}){last}; {_INSTEAD}")
        return target.read_bytes()
