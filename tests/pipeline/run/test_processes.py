"""What worker processes are started with."""

import os

import pytest

from rockpulse.run.processes import ALGEBRA, WorkerProcesses


@pytest.mark.parametrize("own", [None, "3"])
def test_workers_do_linear_algebra_on_one_thread_unless_the_user_says_otherwise(monkeypatch, own):
    for name in ALGEBRA:
        monkeypatch.delenv(name, raising=False)
    if own is not None:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", own)
    before = dict(os.environ)
    with WorkerProcesses(1) as pool:
        found = {name: pool.submit(os.getenv, name).result() for name in ALGEBRA}
    assert found == dict.fromkeys(ALGEBRA, "1") | ({} if own is None else {"OPENBLAS_NUM_THREADS": own})
    assert dict(os.environ) == before
