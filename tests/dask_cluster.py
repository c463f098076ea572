"""A dask scheduler and workers as processes of this machine, on the loopback interface."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

TESTS = Path(__file__).parent


@contextmanager
def dask_cluster(folder, workers=2):
    """The address of a scheduler, its process, and those of the workers; all are ended with the block.

    Workers are single processes of one thread, without a nanny that would start them again. An item that took two of
    them with it is not tried on a third. What they say goes to log files in the folder.
    """
    path = os.pathsep.join(filter(None, (str(TESTS), os.environ.get("PYTHONPATH"))))
    environment = {**os.environ, "PYTHONPATH": path, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    processes = []

    def start(name, *options):
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", "--host", "127.0.0.1", "--no-dashboard"]
        with (folder / f"{name}-{len(processes)}.log").open("w") as log:
            processes.append(
                subprocess.Popen([*command, *options], env=environment, cwd=folder, stdout=log, stderr=log)
            )

    contact = folder / "scheduler.json"
    try:
        start("scheduler", "--port", "0", "--scheduler-file", str(contact))
        for _ in range(workers):
            start("worker", "--scheduler-file", str(contact), "--nthreads", "1", "--no-nanny")
        yield _address(contact, 300.0), processes[0], processes[1:]
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()


def _address(contact, seconds):
    end = time.monotonic() + seconds
    while True:
        try:
            return json.loads(contact.read_text())["address"]
        except (FileNotFoundError, json.JSONDecodeError):  # not there yet, or half written
            if time.monotonic() > end:
                raise
        time.sleep(0.1)


def wait_for_workers(pool, count, seconds=300.0):
    """Until the cluster behind the pool has so many workers; a scheduler is there long before they are."""
    end = time.monotonic() + seconds
    while pool.size != count:
        assert time.monotonic() < end, f"expected {count} workers, found {pool.size}"
        time.sleep(0.05)
