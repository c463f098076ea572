"""Functions for the workers of the pool tests, in a module that a worker process can import."""

import multiprocessing.connection
import os
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rockpulse.run.processes import serve


def square(number):
    return number * number


class Counted:
    """A function of a megabyte that counts how often each process pickles and unpickles it."""

    pickled = unpickled = 0
    content = bytes(1_000_000)

    def __call__(self, number):
        return os.getpid(), Counted.unpickled

    def __reduce__(self):
        Counted.pickled += 1
        return Counted._again, (self.content,)

    @classmethod
    def _again(cls, content):
        cls.unpickled += 1
        return cls()


class Died(Exception):
    """In place of the error of dask for a group of items whose workers died."""


class Cluster(ThreadPoolExecutor):
    """An executor whose workers die of the item 3; it notes the groups of items that it is given."""

    def __init__(self):
        super().__init__(1)
        self.groups = []

    def submit(self, fn, once, items):
        self.groups.append(list(items))
        return super().submit(self._work, fn, once, items)

    def _work(self, fn, once, items):
        if 3 in items:
            raise Died
        return fn(once, items)


def slow_square(number):
    time.sleep(0.02)
    return number * number


def wait_for_file(job):
    """Returns the number of a job when its file, if it has one, is there, at most a minute later."""
    number, path = job
    end = time.monotonic() + 60.0
    while path is not None and not path.exists() and time.monotonic() < end:
        time.sleep(0.01)
    return number


def process_id(_):
    time.sleep(0.05)
    return os.getpid()


def modules(_):
    return set(sys.modules)


def kernel_threads(_):
    """On how many threads of a machine of six cores a kernel would run; 1 also where it runs in the calling thread."""
    from rocking import lanes as threads

    cores, pool, asked = threads.available_cores, threads.ThreadPoolExecutor, []
    threads.available_cores = lambda: 6
    threads.ThreadPoolExecutor = lambda count: asked.append(count) or pool(count)
    try:
        threads.split_lanes(lambda first, last: None, 1000, None)
    finally:
        threads.available_cores, threads.ThreadPoolExecutor = cores, pool
    return asked[0] if asked else 1


def kill_itself(number):
    """A worker that is given 3 is killed, as by the system when memory runs out."""
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def leave(number):
    if number == 3:
        os._exit(7)
    return number


def killed_once(job, constant=b""):
    """Killed the first time, and only then: the file that is there the second time says so."""
    number, folder = job
    seen = Path(folder) / f"{number}"
    if number % 3 == 0 and not seen.exists():
        seen.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def killed_while_answering(number):
    """Killed with half of its answer in the pipe."""

    def send_half(self, buffer, *_):
        os.write(self.fileno(), bytes(buffer[: len(buffer) // 2]))
        os.kill(os.getpid(), signal.SIGKILL)

    if number == 3:
        multiprocessing.connection.Connection._send = send_half
    return bytes(20_000)


def refuse(number):
    if number == 3:
        raise KeyError("three")
    return number


class Awkward(Exception):
    """Its arguments are not those of its class: it does not come back from pickle."""

    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


def refuse_awkwardly(_):
    raise Awkward(1, 2)


def stop_the_interpreter(_):
    sys.exit("enough")


def unpicklable(_):
    return lambda: None


def serve_at_the_second_start(pipe):
    """In place of `serve`: the first process is killed before it is ready."""
    seen = Path(os.environ["CREW_TEST_FILE"])
    if not seen.exists():
        seen.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    serve(pipe)


def always_killed(_):
    os.kill(os.getpid(), signal.SIGKILL)


def report_and_doze(folder):
    """Leaves the number of this process in the folder and sleeps for a minute."""
    (Path(folder) / str(os.getpid())).touch()
    time.sleep(60.0)
