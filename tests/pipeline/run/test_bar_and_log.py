"""Messages of a batch with a progress bar go to the log, and never between the updates of the bar."""

import io
import logging
import sys
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from batch_runs import CONFIG, bar_of
from record_writers import at2, pulse

import rockpulse as rp


def standard_error(monkeypatch):
    """Standard error of a library user: warnings, and the beginning, updates and end of bars; set within the test."""
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    return stream


def bars(stream):
    @contextmanager
    def bar(desc, **_):
        stream.write(f"<{desc}>")
        yield SimpleNamespace(update=lambda n: stream.write("."))
        stream.write("<end>\n")

    return bar


def run(tmp_path, stream, bar):
    for name in ("a", "b"):
        (tmp_path / f"{name}.AT2").write_bytes(at2(pulse(peak=0.3 if name == "a" else 0.2) + 0.05))  # drifts
    rp.assess_files(tmp_path, CONFIG, tmp_path / "r.h5", rp.BatchOptions(workers=1, bar=bar))
    return stream.getvalue()


@pytest.mark.parametrize("handled", [False, True])
def test_warnings_come_after_the_bar_whoever_prints_them(handled, tmp_path, monkeypatch):
    printed = standard_error(monkeypatch)
    logger = logging.getLogger("rockpulse")
    monkeypatch.setattr(logger, "propagate", False)  # pytest's own handlers
    monkeypatch.setattr(logger, "handlers", [logging.StreamHandler(printed)] if handled else [])
    monkeypatch.setattr(logging, "lastResort", logging.StreamHandler(printed))
    text = run(tmp_path, printed, bars(printed))
    assert "<reading>..<end>" in text
    assert "<assessing>..<end>" in text
    assert text.count("baseline drift") == 2


def test_a_log_in_a_file_has_the_warnings_at_once(tmp_path, monkeypatch):
    printed = standard_error(monkeypatch)
    logger, file = logging.getLogger("rockpulse"), io.StringIO()
    monkeypatch.setattr(logger, "handlers", [logging.StreamHandler(file)])
    monkeypatch.setattr(logger, "propagate", False)
    seen = []
    run(tmp_path, printed, bar_of(lambda desc: seen.append("baseline" in file.getvalue())))
    assert seen == [False, False, True, True]
    assert printed.getvalue() == ""
