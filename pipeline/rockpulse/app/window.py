"""One open window of the page: its language, its sections, and the handlers of its events."""

from collections.abc import Awaitable, Callable
from functools import wraps
from typing import Any, TypeVar

from nicegui import ui

from rockpulse.app.fields import plain_error
from rockpulse.app.project import Project
from rockpulse.views.shared.words import say, writing

T = TypeVar("T")
#: Number of rows with inputs that are shown at first, as many make the page slow.
FIRST = 10
#: Number of calls of :meth:`Window.look` from a change in another window to the reload of the page.
PAUSE = 4
#: Commands that end with exit code 1 if only some of the records could be used.
SOME = ("assess", "fragility", "select")


class Closed(Exception):
    """Error: nothing more can be shown, as the window was closed or reloaded, or a command was cancelled."""


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
    looks : list
        Functions that show what has changed, called twice a second.
    """

    def __init__(self, project: Project, language: str) -> None:
        self.project, self.language = project, language
        self.parts: list[Any] = []
        self.looks: list[Callable[[], object]] = []
        self.client = ui.context.client
        self.sending, self._working = False, 0  # whether files are sent, and the number of handlers at work
        self._seen, self._differs = project.written, 0

    def look(self) -> None:
        """Show what has changed, and reload the page after a change in another window; called twice a second."""
        if self.sending or self._working:
            self._seen = self.project.written
        self._differs = self._differs + 1 if self.project.written != self._seen else 0
        if self._differs > PAUSE:
            ui.navigate.reload()
        with writing(self.language):
            for look in self.looks:
                look()

    async def after(self, work: Awaitable[T]) -> T:
        """Wait for `work` and return its result; raise Closed if the window was closed in the meantime."""
        found = await work
        if self.client.is_deleted:
            raise Closed
        return found

    async def run(self, *arguments: str) -> None:
        """Run a command of rockpulse to its end, also if the window is closed.

        Raises ValueError if another command is running, and Closed if this command fails or is cancelled.
        """
        command = self.project.command
        if command.running:
            raise ValueError(say("app.results.busy"))
        if await command.run(arguments) > (arguments[0] in SOME):
            raise Closed

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

    def button(self, label: str, work: Callable[..., Any]) -> ui.button:
        """Show a button that calls `work`."""
        return ui.button(label, on_click=self.handler(work)).props("outline no-caps")

    def bin(self, label: str, work: Callable[..., Any]) -> None:
        """Show a button that removes an item; the icon of the button is a bin."""
        ui.button(icon="delete", on_click=self.handler(work)).props(f'flat dense color=secondary aria-label="{label}"')


class Panel(ui.expansion):
    """A panel that makes its content with `make` when first opened, because hidden inputs slow down the page."""

    def __init__(self, page: Window, title: str, make: Callable[[], Any]) -> None:
        super().__init__(title, on_value_change=page.handler(self._opened))
        self._page, self._make = page, make
        self.classes("wide").props("dense")

    def renew(self) -> None:
        """Make the content again, now or when the panel is opened next."""
        self.clear()
        self._opened()

    def _opened(self) -> None:
        if self.value and not self.default_slot.children:
            with self:
                self._make()
            self._page.shown_error()
