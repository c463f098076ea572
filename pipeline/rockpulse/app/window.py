"""One open window of the page: its language, its sections, and the handlers of its events."""

from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, TypeVar

from nicegui import ui

from rockpulse.app.fields import plain_error
from rockpulse.app.project import Project
from rockpulse.views.shared.words import say, writing

T = TypeVar("T")
#: Number of calls of :meth:`Window.follow` from a change in another window to the reload of the page.
PAUSE = 4
#: Commands that end with exit code 1 if only some of the records could be used.
SOME = ("assess", "fragility", "select")


class Closed(Exception):
    """Nothing more is to be shown: the window was closed or loaded again, or a command was cancelled."""


class Window:
    """One open window of the page.

    Attributes
    ----------
    project : Project
        The project, which all windows share.
    language : str
        Code of the language of the texts.
    parts : list
        The sections on records, bodies, site and results, with a `name` and the methods `show` and `show_error`.
    """

    def __init__(self, project: Project, language: str) -> None:
        self.project, self.language = project, language
        self.parts: list[Any] = []
        self.client = ui.context.client
        self.sending, self._working = False, 0  # whether files are sent, and the number of handlers at work
        self._seen, self._differs = project.written, 0

    def follow(self) -> None:
        """Reload the page shortly after another window has changed the project; called twice a second."""
        if self.sending or self._working:
            self._seen = self.project.written
        self._differs = self._differs + 1 if self.project.written != self._seen else 0
        if self._differs > PAUSE:
            ui.navigate.reload()

    async def after(self, work: Awaitable[T]) -> T:
        """Wait for `work` and return its result; raise Closed if the window was closed in the meantime."""
        found = await work
        if self.client.is_deleted:
            raise Closed
        return found

    async def run(self, *arguments: str) -> None:
        """Run a command of rockpulse to its end.

        Raises ValueError with its message if it fails or if another one is running, and Closed if it was cancelled.
        """
        command = self.project.command
        if command.running:
            raise ValueError(say("app.results.busy"))
        code = await self.after(command.run(arguments))
        if code == 130:
            raise Closed
        if code > (arguments[0] in SOME):
            raise ValueError(command.reason)

    def changed(self) -> None:
        """Write the configuration after a change on the page, and show whether it is valid."""
        if self.project.changed_outside:
            self.project.load()
            ui.navigate.reload()
            return
        self.project.save()
        self._seen = self.project.written
        self.shown_error()

    def shown_error(self) -> None:
        """Show the error in the configuration at its input and at the button that starts the assessment."""
        with writing(self.language):
            for part in self.parts:
                part.show_error(self.project.error)

    def handler(self, work: Callable[..., Any]) -> Callable[..., Awaitable[None]]:
        """Return an event handler that calls `work` with the language of the page set, and shows its errors."""

        @wraps(work)  # NiceGUI passes an event to a function that takes one
        async def handle(*given: Any) -> None:
            self._working += 1
            with writing(self.language):
                try:
                    found = work(*given)
                    if isinstance(found, Awaitable):
                        await found
                except Closed:
                    return
                except (ValueError, OSError) as error:
                    if self.client.is_deleted:
                        raise
                    ui.notify(plain_error(str(error)), type="negative", multi_line=True, close_button=True, timeout=0)
                finally:
                    self._working -= 1
                    self._seen = self.project.written

        return handle

    @contextmanager
    def words(self) -> Iterator[None]:
        """Set the language of the page in a ``with`` block."""
        with writing(self.language):
            yield
