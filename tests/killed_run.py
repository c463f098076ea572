"""Run the command line in a process that kills itself at a named point: ``killed_run.py POINT NUMBER VERB ...``.

The number says at which passing of the point. Points: "record" (a finished record is in the journal), "assembly" (a
variable of the results is written), "rename" (the results are whole, their name not yet theirs), "renamed" (only the
journal is left), "interrupt" and "terminate" (as "record", by Ctrl-C and SIGTERM), and "moment" (after so many
milliseconds, wherever that is).
"""

import os
import signal
import sys
import threading
import traceback
from pathlib import Path

from rockpulse.cli import main
from rockpulse.run.journal import Journal
from rockpulse.storage.hdf5.writer import TreeWriter

#: What is passed, whether the signal comes before or after it, and which.
POINTS = {
    "record": (Journal, "add", "after", signal.SIGKILL),
    "assembly": (TreeWriter, "append", "after", signal.SIGKILL),
    "rename": (Path, "replace", "before", signal.SIGKILL),
    "renamed": (Journal, "remove", "before", signal.SIGKILL),
    "interrupt": (Journal, "add", "after", signal.SIGINT),
    "terminate": (Journal, "add", "after", signal.SIGTERM),
}


def strike_at(point: str, number: int) -> None:
    """Arrange for the signal at the given passing of the point."""
    owner, name, when, what = POINTS[point]
    original = getattr(owner, name)
    passed = 0

    def struck(*args, **kwargs):
        nonlocal passed
        passed += 1
        if passed == number and when == "before":
            os.kill(os.getpid(), what)
        result = original(*args, **kwargs)
        if passed == number and when == "after":
            os.kill(os.getpid(), what)
        return result

    setattr(owner, name, struck)


def run(point: str, number: int, arguments: list[str]) -> int:
    """The exit code of a command line that is struck at the given passing of the point."""
    # A shell that starts the tests in its background has SIGINT ignored, and whoever they start inherits that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if point == "moment":
        timer = threading.Timer(number / 1000.0, os.kill, (os.getpid(), signal.SIGKILL))
        timer.daemon = True
        timer.start()
    else:
        strike_at(point, number)
    return main(arguments)


def in_a_fork(call, target):
    """Exit code of a call in a fork of this process, minus the signal that ended it, and what it wrote to stderr."""
    messages = target.parent.with_name(f"{target.parent.name}.stderr")
    child = os.fork()
    if not child:
        code = 99
        try:
            sys.stderr = messages.open("w", buffering=1)
            code = call()
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status), messages.read_text()


if __name__ == "__main__":
    sys.exit(run(sys.argv[1], int(sys.argv[2]), sys.argv[3:]))
