"""The page: records, bodies, site and results of a project, one below the other, in one language."""

from importlib.resources import files

from nicegui import ui

from rockpulse.app.bodies import BodyPart
from rockpulse.app.project import Project
from rockpulse.app.records import RecordPart
from rockpulse.app.results import ResultPart
from rockpulse.app.site import SitePart
from rockpulse.app.window import Window
from rockpulse.version import __version__
from rockpulse.views.shared.words import LANGUAGES, say, writing

#: Names of the languages in themselves.
NAMES = {"en": "English", "it": "Italiano"}


def show_page(project: Project, language: str) -> None:
    """Build the page of a project in a language."""
    window = Window(project, language)
    window.parts = [RecordPart(window), BodyPart(window), SitePart(window), ResultPart(window)]
    ui.colors(primary="#0b4f9e", negative="#a3161f", positive="#14693a", secondary="#57606a")
    ui.add_css(_style())
    ui.page_title("rockpulse")
    ui.context.client.page.language = {"it": "it"}.get(language, "en-US")  # type: ignore[assignment]
    with writing(language):
        with ui.element("div").classes("head"):
            ui.html("rockpulse", tag="h1")
            ui.label(project.folder.name).classes("soft").tooltip(str(project.folder))
            with ui.element("nav").props(f'aria-label="{say("app.language")}"'):
                for code in LANGUAGES:
                    link = ui.link(NAMES[code], f"/?language={code}").props(f'lang="{code}"')
                    link.props('aria-current="true"' if code == language else "")
        with ui.element("nav").classes("steps").props(f'aria-label="{say("app.steps")}"'):
            for number, part in enumerate(window.parts, 1):
                ui.link(f"{number} {say(f'app.{part.name}.title')}", f"#{part.name}")
        for number, part in enumerate(window.parts, 1):
            with ui.element("section").props(f'id="{part.name}"'):
                ui.html(f"{number} {say(f'app.{part.name}.title')}", tag="h2")
                ui.label(say(f"app.{part.name}.intro")).classes("soft")
                part.show()
        ui.label(f"rockpulse {__version__}. {say('app.local')}").classes("soft foot")
    window.shown_error()
    ui.timer(0.5, window.look)


def _style() -> str:
    report = files("rockpulse.views.report").joinpath("templates", "report.css").read_text(encoding="utf-8")
    drawings = [line for line in report.splitlines() if line.startswith((":root", ".drawing", ".strip"))]
    return "\n".join([*drawings, files("rockpulse.app").joinpath("page.css").read_text(encoding="utf-8")])
