"""What a terminal is shown while the work goes on."""

import io
import os
import sys

import pytest

from rockpulse.commands.terminal import COMPILING, announce_compilation, progress_bars


class Terminal(io.StringIO):
    """A standard error that says it is one."""

    def isatty(self):
        return True

    def fileno(self):
        return 2


def on_terminal(monkeypatch):
    """From here on; a fixture would come before pytest takes standard error for the test."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    return terminal


def shown(terminal, quiet=False):
    """The lines of a bar over four items."""
    for _ in progress_bars(quiet)(range(4), desc="reading", mininterval=0.0, miniters=1, file=terminal):
        pass
    return [line for line in terminal.getvalue().splitlines() if line.strip()]


def test_a_terminal_that_does_not_tell_its_size_has_a_bar_of_80_columns(monkeypatch):
    terminal = on_terminal(monkeypatch)
    monkeypatch.setattr(os, "get_terminal_size", lambda fd: os.terminal_size((0, 0)))
    lines = shown(terminal)
    assert any("100%" in line for line in lines)
    assert max(map(len, lines)) == 80


def test_quiet_is_quiet_and_so_is_what_is_no_terminal(monkeypatch):
    terminal = on_terminal(monkeypatch)
    monkeypatch.setattr(os, "get_terminal_size", lambda fd: os.terminal_size((100, 30)))
    assert shown(terminal, quiet=True) == []
    monkeypatch.setattr(terminal, "isatty", lambda: False)
    assert shown(terminal) == []


def test_compiling_is_told_once_and_loading_never(monkeypatch):
    terminal = on_terminal(monkeypatch)
    event = pytest.importorskip("numba.core.event")
    with announce_compilation(quiet=False):
        assert terminal.getvalue() == ""
        for _ in range(2):
            with event.trigger_event("numba:compile"):
                pass
    assert terminal.getvalue() == f"{COMPILING}\n"
    with event.trigger_event("numba:compile"):
        pass
    assert terminal.getvalue() == f"{COMPILING}\n"


def test_a_kernel_that_is_compiled_is_such_an_event(monkeypatch):
    terminal = on_terminal(monkeypatch)
    numba = pytest.importorskip("numba")
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled without the compiler")
    with announce_compilation(quiet=False):
        numba.njit(lambda x: x + 1)(2)
    assert terminal.getvalue() == f"{COMPILING}\n"
