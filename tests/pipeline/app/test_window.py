"""A window without a browser: its rows, choices and reasons, its errors, and work that goes on after it was closed."""

import asyncio
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="no nicegui: pip install -e '.[app]'")
from nicegui import ElementFilter, ui
from nicegui.events import ClickEventArguments, handle_event
from nicegui.testing import user_simulation

from rockpulse.app.fields import plain_error
from rockpulse.app.project import Project
from rockpulse.app.server import show_page
from rockpulse.app.window import FIRST, Panel, Window
from rockpulse.errors import Failure
from rockpulse.views.shared.words import reason_words, say, writing


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


def test_commands_follow_each_other_also_without_a_window(window):
    asked = []

    async def run(arguments):
        asked.append(arguments[0])
        window.client.is_deleted = True
        return 0

    async def work():
        await window.run("fragility", "--quiet")
        await window.run("risk", "--quiet")

    window.project.command.run = run
    asyncio.run(window.handler(work)())
    assert asked == ["fragility", "risk"]


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ({"hazard": {"k0": 0.001}}, "k0, k: La legge di potenza k0 x^-k richiede k0 e k."),
        ({"hazard": {"longitude": 12.0}}, "longitudine, latitudine: Indicare sia"),
        ({"check": {"ag": 0.2, "f0": 2.5}}, "T_C*: da indicare per questo spettro"),
        ({"check": {"ag": 0.2, "f0": 2.5, "spectrum": "en_1998_1"}}, "F_0: Questo spettro non lo prevede"),
        ({"records": {"components": "azimuth"}}, "direzioni: Indicare l'azimut"),
        ({"records": {"azimuth": 45.0}}, "azimut di oscillazione: L'azimut vale solo per registrazioni ruotate"),
        ({"demand": [{"measure": "pga"}]}, "Indicare il valore della domanda."),
        ({"demand": [{"measure": "pgv", "value": "fast cm/s"}]}, "valore: occorre un numero positivo"),
        ({"demand": [{"measure": "pga", "value": "35 m/s2"}]}, "valore: PGA di 3,57 g è da confermare, perché"),
        (
            {"block": [{"name": "w", "width": 550, "height": 4200}]},
            '"w": 550 x 4200: le dimensioni sono in millimetri? Dimensione',
        ),
    ],
)
def test_errors_have_the_words_of_the_page(tmp_path, document, words):
    project = Project(tmp_path)
    project.document = document
    with writing("it"):
        assert plain_error(project.save()).startswith(words)


def test_an_error_without_words_is_quoted_as_english():
    error = "a table of a kind that the page does not know"
    with writing("it"):
        assert plain_error(error) == f"messaggio del programma, in inglese: «{error}»"
        assert plain_error("È in corso un altro calcolo.") == "È in corso un altro calcolo."
    assert plain_error(error) == error


def test_notes_on_frequencies_are_translated():
    lost = "5% of the resamples give no curve, or no curve without one of their earthquakes"
    with writing("it"):
        narrow = reason_words("the band is too narrow: 5 earthquakes, but 14 are needed")
        both = reason_words(
            f"the band is too narrow: 5 earthquakes, but 14 are needed; {lost}: they are left out of the band"
        )
        ends = reason_words("12% of its frequency comes from levels above 0.4 g, where the hazard curve ends")
    assert narrow == "l'intervallo di confidenza è troppo stretto: i terremoti sono 5, ne servono 14"
    assert both.startswith(f"{narrow}; ricampionamenti che non danno una curva")
    assert both.endswith(": 5 % (non contribuiscono all'intervallo)")
    assert ends.startswith("parte della frequenza dovuta a livelli maggiori di 0,4 g")


def visit(project, work, language="en"):
    """Open the page of a project without a browser; `work` gets functions that find elements and act on them."""

    async def open_page():
        async with user_simulation(root=lambda: show_page(project, language)) as user:
            client = await user.open("/")

            def every(kind, label=""):
                with client:
                    found = [*ElementFilter(kind=kind)]
                return [one for one in found if label in (one.props.get("label"), one.props.get("aria-label"), "")]

            async def act(change, *given):
                with client:
                    change(*given)
                await asyncio.sleep(0.05)

            await asyncio.wait_for(work(every, act), 60.0)

    asyncio.run(open_page())


def click(button):
    (listener,) = (one for one in button._event_listeners.values() if one.type == "click")
    handle_event(listener.handler, ClickEventArguments(sender=button, client=button.client))


@pytest.mark.sweep
def test_rows_of_bodies_follow_the_project(tmp_path):
    project = Project(tmp_path)
    tie = {"height": 2.0, "stiffness": 1e5, "yield_force": 1e3, "ultimate": 0.1}
    project.document["block"] = [
        {"name": f"b{n}", "width": 0.3, "height": 2.4, "tie": [dict(tie)]} for n in range(FIRST + 2)
    ]
    assert project.save() == ""

    async def work(every, act):
        def rows():
            return [one for one in every(ui.element) if "body-row" in one.classes]

        while len(rows()) < FIRST:
            await act(int)
        (others,) = every(Panel, say("app.bodies.others"))
        for shown in (True, False):
            await act(others.set_value, shown)
        await act(click, every(ui.button, say("app.bodies.add"))[0])
        assert len(project.several("block")) == FIRST + 3
        assert len(others.default_slot.children) == 3

        # Another window has removed the tie of the first body, and then the body.
        await act(every(Panel, say("app.bodies.more"))[0].set_value, True)
        del project.several("block")[0]["tie"]
        remove = f"{say('app.bodies.remove_part')} {say('app.part.tie')}"
        await act(click, every(ui.button, remove)[0])
        assert every(ui.button, remove) == []
        del project.several("block")[0]
        await act(click, every(ui.button, say("app.bodies.remove"))[0])
        assert len(rows()) == len(project.several("block")) == FIRST + 2

    visit(project, work)


@pytest.mark.sweep
def test_a_reason_in_general_words_is_quoted_and_demands_keep_their_order(tmp_path, monkeypatch):
    project = Project(tmp_path)
    project.document["demand"] = [{"measure": "pgv", "value": "30 cm/s"}]
    assert project.save() == ""
    reasons = ("no record", "no record; it may hold what nobody has foreseen", "what nobody has foreseen")
    failures = [Failure(f"{n}.txt", "read", f"{n}.txt: {reason}", "failed") for n, reason in enumerate(reasons)]
    monkeypatch.setattr(Project, "read_records", lambda self: ([], failures))

    async def work(every, act):
        while not (why := every(Panel, "Motivo completo")):
            await act(int)
        for panel in why:
            await act(panel.set_value, True)
        shown = [panel.default_slot.children[0].text for panel in why]
        assert [text.partition("\n")[2] for text in shown] == [
            f"messaggio del programma, in inglese: «{reason}»" for reason in reasons[1:]
        ]
        (choice,) = every(ui.select, "definita da")
        assert [*choice.options] == ["none", "ag", "pga", "pgv", "sa"]

    visit(project, work, "it")
