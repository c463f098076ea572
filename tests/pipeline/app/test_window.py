"""Work that goes on after its window was closed ends without a word, unless it has failed."""

import asyncio
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="no nicegui: pip install -e '.[app]'")
from rockpulse.app.project import Project
from rockpulse.app.window import Window


@pytest.fixture
def window(monkeypatch, tmp_path):
    said = []
    context = SimpleNamespace(client=SimpleNamespace(is_deleted=False))
    shown = SimpleNamespace(context=context, notify=lambda text, **_: said.append(text))
    monkeypatch.setattr("rockpulse.app.window.ui", shown)
    found = Window(Project(tmp_path), "en")
    found.said = said
    return found


@pytest.mark.parametrize("closed", [False, True])
def test_work_is_shown_only_on_a_window_that_is_open(window, closed):
    async def write():
        window.client.is_deleted = closed
        return "written"

    async def work():
        window.said.append(await window.after(write()))

    asyncio.run(window.handler(work)())
    assert window.said == ([] if closed else ["written"])


def test_a_fault_is_shown_or_raised_if_there_is_no_window(window):
    def fail():
        raise OSError("the disk is full")

    asyncio.run(window.handler(fail)())
    assert window.said == ["the disk is full"]
    window.client.is_deleted = True
    with pytest.raises(OSError, match="full"):
        asyncio.run(window.handler(fail)())
