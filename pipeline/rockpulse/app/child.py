"""Runs commands of rockpulse in a separate process, which reports its progress and ends together with the page."""

import asyncio
import os
import re
import signal
import sys
import threading
from collections.abc import Sequence
from pathlib import Path

from rockpulse.app import CHILD

#: A progress bar as tqdm prints it: number done, total, and remaining time.
_BAR = re.compile(r"[^:|]+:\s+\d+%\|.*\| (\d+)/(\d+) \[[\d:]+<([\d:?]+)")
#: Number of lines of the output that are kept, and time after which an interrupted process is killed [s].
LINES, PATIENCE = 400, 10.0


def follow_parent() -> None:
    """Interrupt this process, as Ctrl-C does, when the parent process ends or closes the pipe to its standard input."""

    def wait() -> None:
        while os.read(0, 64):  # not sys.stdin, whose lock would block the end of the process
            continue
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        else:
            signal.raise_signal(signal.SIGINT)

    threading.Thread(target=wait, daemon=True).start()


class Command:
    """Runs one command at a time, such as ``assess --config site.toml``, and stores its progress and exit code."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.turned = 0  # number of times that a command has started or ended
        self._process: asyncio.subprocess.Process | None = None
        self._begin("")

    def _begin(self, verb: str) -> None:
        self.verb, self.done, self.total, self.left = verb, 0, 0, ""
        self.code: int | None = None
        self.lines: list[str] = []

    @property
    def running(self) -> bool:
        """Whether a command is running."""
        return self._process is not None

    @property
    def reason(self) -> str:
        """The last message of a command that failed, without the name of the program."""
        said = [line for line in self.lines if line.startswith("rockpulse: ")] or self.lines[-1:]
        return said[-1].removeprefix("rockpulse: ") if said else ""

    async def run(self, arguments: Sequence[str]) -> int:
        """Run a command of rockpulse in the project folder until it ends, and return its exit code."""
        self._begin(arguments[0])
        pipe = asyncio.subprocess.PIPE
        self._process = process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "rockpulse", *arguments),
            cwd=self.folder,
            stdin=pipe,
            stdout=pipe,
            stderr=asyncio.subprocess.STDOUT,
            env=os.environ | {CHILD: "1", "PYTHONUNBUFFERED": "1"},
        )
        self.turned += 1
        try:
            rest = ""
            while process.stdout is not None and (read := await process.stdout.read(4096)):
                *whole, rest = re.split(r"[\r\n]+", rest + read.decode("utf-8", "replace"))
                for line in filter(str.strip, whole):
                    self._take(line)
            self.lines += [rest] if rest.strip() else []
            self.code = await process.wait()
        finally:
            self._process = None
            self.turned += 1
        return self.code

    def _take(self, line: str) -> None:
        if bar := _BAR.match(line):
            self.done, self.total, self.left = int(bar[1]), int(bar[2]), bar[3]
        else:
            self.lines = [*self.lines[1 - LINES :], line]

    async def cancel(self) -> None:
        """Interrupt the command as Ctrl-C does, so that finished records are kept, and wait until it has ended."""
        process = self._process
        if process is None or process.stdin is None:
            return
        process.stdin.close()
        try:
            await asyncio.wait_for(process.wait(), PATIENCE)
        except TimeoutError:
            process.kill()
            await process.wait()
