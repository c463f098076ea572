"""A page of ``rockpulse app`` in a process of its own, and files to drop on it."""

import contextlib
import os
import signal
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from record_writers import at2

TIME = 0.01 * np.arange(400)
#: Longest time that a test waits for something on the page [s].
PATIENCE = 150.0


@dataclass(frozen=True)
class Served:
    """The process of the page, its address with the token, and its folder."""

    process: subprocess.Popen
    address: str
    folder: Path

    @property
    def token(self):
        """The token of the address."""
        return self.address.partition("token=")[2]

    @property
    def port(self):
        """The port of the server."""
        return int(self.address.partition("127.0.0.1:")[2].partition("/")[0])


@contextlib.contextmanager
def served(folder, *options):
    """The page of a folder; after the test Ctrl-C has ended it without an error."""
    command = [sys.executable, "-m", "rockpulse", "app", str(folder), "--no-browser", *options]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    try:
        first = process.stdout.readline().strip()
        assert "/?token=" in first, first + process.stdout.read()
        yield Served(process, first, Path(folder))
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=30)
        print(said)  # shown with a failure
    assert process.returncode in (0, -signal.SIGKILL), said
    assert "Traceback" not in said, said


def records(count=5):
    """Members of a zip: short records of as many earthquakes, and a text that is none."""
    found = {"readme.txt": b"Records of an agency.\n"}
    for number in range(count):
        motion = (0.25 + 0.05 * number) * np.exp(-(((TIME - 2.0) / 0.8) ** 2)) * np.sin(2.0 * np.pi * TIME)
        found[f"quake{number}.AT2"] = at2(
            motion, title=f"Quake {'ABCDE'[number] * 3}, {number + 1}/5/1980, Bagnoli, 270"
        )
    return found


def zipped(path, members):
    """The path of a zip with some members."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path
