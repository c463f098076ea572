"""The page: records, bodies, site and results of a project, one below the other, in one language."""

from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from importlib.resources import files
from typing import Any

from nicegui import ui

from rockpulse.app.bodies import BodyPart
from rockpulse.app.project import Project
from rockpulse.app.records import RecordPart
from rockpulse.app.results import ResultPart
from rockpulse.app.site import SitePart
from rockpulse.version import __version__
from rockpulse.views.shared.words import LANGUAGES, say, writing

#: Names of the languages in themselves.
NAMES = {"en": "English", "it": "Italiano"}


class Page:
    """One open window of the page."""

    def __init__(self, project: Project, language: str) -> None:
        self.project, self.language = project, language
        self.parts: list[Any] = [RecordPart(self), BodyPart(self), SitePart(self), ResultPart(self)]

    def show(self) -> None:
        """Build the page."""
        ui.colors(primary="#0b4f9e", negative="#a3161f", positive="#14693a", secondary="#57606a")
        ui.add_css(_style())
        ui.page_title("rockpulse")
        ui.context.client.page.language = {"it": "it"}.get(self.language, "en-US")  # type: ignore[assignment]
        with writing(self.language):
            with ui.element("div").classes("head"):
                ui.html("rockpulse", tag="h1")
                ui.label(str(self.project.folder)).classes("soft")
                with ui.element("nav").props(f'aria-label="{say("app.language")}"'):
                    for code in LANGUAGES:
                        link = ui.link(NAMES[code], f"/?language={code}").props(f'lang="{code}"')
                        link.props('aria-current="true"' if code == self.language else "")
            with ui.element("nav").classes("steps").props(f'aria-label="{say("app.steps")}"'):
                for number, part in enumerate(self.parts, 1):
                    ui.link(f"{number} {say(f'app.{part.name}.title')}", f"#{part.name}")
            for number, part in enumerate(self.parts, 1):
                with ui.element("section").props(f'id="{part.name}"'):
                    ui.html(f"{number} {say(f'app.{part.name}.title')}", tag="h2")
                    ui.label(say(f"app.{part.name}.intro")).classes("soft")
                    part.show()
            ui.label(f"rockpulse {__version__}. {say('app.local')}").classes("soft foot")
        self.shown_error()

    def changed(self) -> None:
        """Write the configuration after a change on the page, and show whether it is valid."""
        if self.project.changed_outside:
            self.project.load()
            ui.navigate.reload()
            return
        self.project.save()
        self.shown_error()

    def shown_error(self) -> None:
        """Show the error of the configuration at its input and at the button that begins the assessment."""
        with writing(self.language):
            for part in self.parts:
                part.show_error(self.project.error)

    def handler(self, work: Callable[..., Any]) -> Callable[..., Awaitable[None]]:
        """Return a handler of events that does some work in the language of the page, and shows its errors."""

        @wraps(work)  # NiceGUI passes an event to a function that takes one
        async def handle(*given: Any) -> None:
            with writing(self.language):
                try:
                    found = work(*given)
                    if isinstance(found, Awaitable):
                        await found
                except (ValueError, OSError) as error:
                    ui.notify(str(error), type="negative", multi_line=True, close_button=True, timeout=0)

        return handle

    @contextmanager
    def words(self) -> Iterator[None]:
        """Set the language of the page in a ``with`` block."""
        with writing(self.language):
            yield


def _style() -> str:
    """Return the style of the page, with that of the drawings in the report."""
    report = files("rockpulse.views.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    drawings = [line for line in report.splitlines() if line.startswith((":root", ".drawing", ".strip"))]
    return "\n".join([*drawings, files("rockpulse.app").joinpath("page.css").read_text(encoding="utf-8")])
