"""One open window of the page: its language, its parts, and the events that change the project."""

from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any

from nicegui import ui

from rockpulse.app.project import Project
from rockpulse.views.shared.words import writing


class Window:
    """One open window of the page.

    Attributes
    ----------
    project : Project
        The project, which all windows share.
    language : str
        Code of the language of the texts.
    parts : list
        Records, bodies, site and results, each with a `name` and the methods `show` and `show_error`.
    """

    def __init__(self, project: Project, language: str) -> None:
        self.project, self.language = project, language
        self.parts: list[Any] = []

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
