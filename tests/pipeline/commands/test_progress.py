"""What a terminal is shown while the work goes on."""

import io
import os
import sys

from rocking import kernel_cache
from rockpulse.commands.terminal import kernel_messages, progress_bars


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


def test_without_a_terminal_the_number_of_many_records_is_one_line(monkeypatch):
    terminal = on_terminal(monkeypatch)
    monkeypatch.setattr(terminal, "isatty", lambda: False)
    for total in (19, 44):
        progress_bars(False)(total=total, initial=0, desc="assessing", unit=" records")
    assert terminal.getvalue() == "rockpulse: assessing: 44 records\n"


def told_by_kernels(quiet=False):
    """What happens while a verb runs: the kernels say twice that they are compiled, and that they cannot be kept."""
    kernel_cache.logged.clear()
    with kernel_messages(quiet):
        for _ in range(2):
            kernel_cache.logger.info(kernel_cache.COMPILING)
        kernel_cache.logger.warning("not kept")
    kernel_cache.logger.warning("after the verb")


def test_a_terminal_is_told_once_that_kernels_are_compiled(monkeypatch):
    terminal = on_terminal(monkeypatch)
    told_by_kernels()
    assert terminal.getvalue() == f"rockpulse: {kernel_cache.COMPILING}\nrockpulse: not kept\n"


def test_a_file_gets_the_faults_alone_and_quiet_nothing(monkeypatch):
    terminal = on_terminal(monkeypatch)
    told_by_kernels(quiet=True)
    assert terminal.getvalue() == ""
    monkeypatch.setattr(terminal, "isatty", lambda: False)
    told_by_kernels()
    assert terminal.getvalue() == "rockpulse: not kept\n"
