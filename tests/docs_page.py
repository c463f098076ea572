"""A page of the manual as something that can be run: its commands, its Python, the files it shows, and what is printed.

What the runner looks for in a page, from top to bottom, in one folder and one Python session:

- a block of ``sh``: run by bash, stops at the first command that fails;
- a block of ``python``: run in the session of the page;
- a block of ``text`` right after one of them: what it printed. Every line has to be there, in order; ``...`` stands for
  lines left out. Words have to be the same and numbers within a tenth;
- a ``code-block`` with a caption: a file of that name;
- ``<!-- exit: 1 -->`` before commands: the exit code of the block;
- ``<!-- figures differ -->`` before a block of ``text``: its numbers are not compared (chaotic, or of the machine);
- ``*Not run by the tests of this manual: REASON*`` on the line above a block: left out, visibly. The tests hold
  the list of reasons.
"""

import contextlib
import io
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import pytest

__all__ = ["Block", "blocks", "missing_line", "pictures", "run_page"]

FENCE = re.compile(
    r"(?P<before>(?:^(?:<!--[^\n]*-->|\*Not run by the tests of this manual:[^\n]*\*)\n+)*)"
    r"^(?P<ticks>`{3,})(?P<info>[^\n`]*)\n(?P<body>.*?)^(?P=ticks)[ \t]*$",
    re.MULTILINE | re.DOTALL,
)
#: A picture that a command or a line of Python draws, and one that a page shows.
DRAWN = re.compile(r"""(?:-o |savefig\(")([^\s"]+\.png)""")
SHOWN = re.compile(r"!\[[^]]*\]\(\S*images/(\S+\.png)\)")

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

#: Numbers that a page shows may differ by this share [-], and by this where they are small.
TOLERANCE, SMALL = 0.1, 0.011


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    kind: str  #: "sh", "python", "text", "matlab" ..., or "file"
    name: str  #: of a "file", else empty
    body: str
    line: int  #: of the page, on which the body begins
    not_run: str = ""  #: the reason; empty where it is run
    exit_code: int = 0  #: what a block of commands has to end with
    figures: bool = True  #: whether the numbers of an output are compared


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    found = []
    for match in FENCE.finditer(text):
        before, info, body = match["before"], match["info"].strip(), match["body"]
        kind, name = info, ""
        if info.startswith("{code-block}"):
            caption = re.match(r"(?::[^\n]*\n)*?:caption: (?P<name>[^\n]*)\n(?::[^\n]*\n)*\n?", body)
            if caption is None:
                raise ValueError(f"{page}: a code-block without a caption: {body[:40]!r}")
            kind, name, body = "file", caption["name"].strip(), body[caption.end() :]
        reason = re.search(r"\*Not run by the tests of this manual: (.*?)\*\n", before)
        code = re.search(r"<!-- exit: (\d+) -->", before)
        line, figures = text.count("\n", 0, match.start("ticks")) + 2, "<!-- figures differ -->" not in before
        not_run, exit_code = reason[1] if reason else "", int(code[1]) if code else 0
        found.append(Block(kind, name, body, line, not_run, exit_code, figures))
    return found


def pictures(page: Path) -> tuple[set[str], set[str]]:
    """The names of the pictures that a page shows: those that its commands and its Python draw, and the others."""
    text = "\n".join(block.body for block in blocks(page) if block.kind in ("sh", "python"))
    shown = set(SHOWN.findall(page.read_text(encoding="utf-8")))
    drawn = {Path(name).name for name in DRAWN.findall(text)}
    return shown & drawn, shown - drawn


def alike(shown: str, printed: str, figures: bool) -> bool:
    """Whether two lines have the same words and, where they are compared, numbers that are close."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed), strict=True)
    return not figures or all(math.isclose(float(a), float(b), rel_tol=TOLERANCE, abs_tol=SMALL) for a, b in pairs)


def missing_line(shown: str, printed: str, figures: bool = True) -> str | None:
    """First line of the shown output that the printed one lacks after those before it, or None."""
    rest = iter(printed.splitlines())
    for line in shown.splitlines():
        if line.strip() in ("", "..."):
            continue
        if not any(alike(line, candidate, figures) for candidate in rest):
            return line
    return None


def plain_words(line: str) -> list[str]:
    """The words of a command of rockpulse that needs nothing of a shell; [] for any other line."""
    unquoted = re.sub(r"'[^']*'|\"[^\"$`\\]*\"", "", line)
    if not line.startswith("rockpulse ") or set("|<>*?$&;~`()\\").intersection(unquoted.split(" #")[0]):
        return []
    return shlex.split(line, comments=True)[1:]


def parts(body: str) -> list[tuple[bool, list[str]]]:
    """The lines of a block in runs: True and commands of rockpulse alone, or False and what takes a shell."""
    lines = [line for line in body.replace("\\\n", " ").splitlines() if line.strip() and not line.startswith("#")]
    return [(plain, [*run]) for plain, run in groupby(lines, key=lambda line: bool(plain_words(line)))]


def run_here(lines: list[str], folder: Path, environment: dict[str, str]) -> tuple[str, int]:
    """What commands of rockpulse print, and the last exit code: in this process, for a new one takes seconds.

    As on a machine of one core, where no command starts processes unless it is given --workers.
    """
    from rockpulse.cli import main

    code: int = 0
    output = io.StringIO()
    with contextlib.chdir(folder), pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", environment["COLUMNS"])
        patch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            for line in lines:
                try:
                    code = main(plain_words(line))
                except SystemExit as end:
                    code = int(end.code or 0)
                if code:
                    break
    return output.getvalue(), code


def run_shell(lines: list[str], folder: Path, environment: dict[str, str]) -> tuple[str, int]:
    """What bash prints, and its exit code."""
    command = ["bash", "-euo", "pipefail", "-c", "\n".join(lines)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=900)
    return done.stdout + done.stderr, done.returncode


def run_page(page: Path, folder: Path) -> None:
    """Run a page in a folder; AssertionError, or what its Python raises, where it does not do what it says."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "COLUMNS": "110"}
    session: dict[str, object] = {"__name__": "__manual__"}
    printed = ""
    for block in blocks(page):
        where = f"{page.name}, line {block.line}"
        if block.not_run:
            continue
        if block.kind == "file":
            (folder / block.name).write_text(block.body, encoding="utf-8")
        elif block.kind == "sh":
            printed, code = "", 0
            for plain, lines in parts(block.body):
                text, code = (run_here if plain else run_shell)(lines, folder, environment)
                printed += text
                if code:
                    break
            assert code == block.exit_code, f"{where}: exit code {code}\n{printed}"
        elif block.kind == "python":
            code = compile("\n" * (block.line - 1) + block.body, str(page), "exec")
            with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()) as output:
                exec(code, session)
            printed = output.getvalue()
        elif block.kind == "text":
            line = missing_line(block.body, printed, block.figures)
            assert line is None, f"{where}: not printed: {line!r}; printed was\n{printed}"


def draw_pictures(docs: Path) -> None:
    """Run the pages that show pictures which their own commands draw, and put these into docs/images."""
    from PIL import Image

    for page in sorted(docs.rglob("*.md")):
        drawn, _ = pictures(page)
        if drawn:
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                (folder / "data").symlink_to(docs.parent / "data", target_is_directory=True)
                run_page(page, folder)
                for picture in sorted(drawn):
                    # 128 colours are enough for a diagram, and a third of the size.
                    Image.open(folder / picture).convert("RGB").quantize(128).save(
                        docs / "images" / picture, optimize=True
                    )
                    print(docs / "images" / picture)


if __name__ == "__main__":
    draw_pictures(Path(__file__).resolve().parents[1] / "docs")
