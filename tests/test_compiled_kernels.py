"""The kernels compiled before a long run: each call is compiled once, by one worker."""

import compiled_kernels
from compiled_kernels import calls, compile_share


def test_workers_share_the_calls_and_do_not_repeat_them(tmp_path, monkeypatch):
    made = []
    monkeypatch.setattr(compiled_kernels, "calls", lambda: [lambda k=k: made.append(k) for k in range(5)])
    monkeypatch.setattr(compiled_kernels, "PATIENCE", 0.0)
    monkeypatch.setattr(compiled_kernels, "folder", lambda: tmp_path)
    compile_share(0, 2)
    assert made == [0, 2, 4]
    compile_share(1, 2)
    compile_share(0, 2)
    assert made == [0, 2, 4, 1, 3]


def test_every_call_can_be_made():
    for call in calls():
        call()
