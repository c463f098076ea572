"""One open window of the page, its event handlers, and the elements that its sections share."""

from collections.abc import Awaitable, Callable
from functools import wraps
from typing import Any, TypeVar

from nicegui import events, ui

from rockpulse.app.fields import plain_error
from rockpulse.app.project import Project
from rockpulse.views.shared.words import error_words, say, writing

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


#: Number of rows on a page.
PAGE = 10


class Table(ui.table):
    """A table in pages.

    NiceGUI stores the order and the page of a table on the server, and redraws the whole window if either changes.
    Here only the browser stores the order and the page.
    """

    pagination: Any = None  # what the browser reports; not a property of the table in the browser, as in the base class

    def __init__(self, label: str, columns: list[dict[str, Any]], rows: list[dict[str, Any]]) -> None:
        super().__init__(columns=columns, rows=rows)
        several = " hide-pagination" if len(rows) > PAGE else ""
        self.props(f"dense flat rows-per-page-options=[{PAGE},50,0]", remove=f"pagination{several}").classes("list")
        self.props(f'aria-label="{label}"')


#: Sends the chosen or dropped files, also those in folders, one after the other, and reports the file that is sent and,
#: at the end, the faults.
SEND = """async (event) => { event.preventDefault(); const faults = [], files = [];
  const inside = async (entry) => { if (!entry || entry.name.startsWith(".")) return;
    if (entry.isFile) files.push([entry.fullPath, await new Promise((found, fault) => entry.file(found, fault))]);
    else for (const reader = entry.createReader(); ;) {
      const some = await new Promise((found, fault) => reader.readEntries(found, fault)); if (!some.length) return;
      for (const one of some) await inside(one); } };
  if (event.dataTransfer) for (const entry of [...event.dataTransfer.items].map((one) => one.webkitGetAsEntry()))
    await inside(entry).catch((fault) => faults.push(`${entry.name}: ${fault}`));
  else files.push(...[...event.target.files].map((file) => [file.webkitRelativePath || file.name, file]));
  for (const [name, file] of files.filter(([name]) => !/[/][.]/.test(name))) { emit({sending: file.name, faults});
    try { const answer = await fetch(`/upload/KIND?name=${encodeURIComponent(name)}`, {method: "POST", body: file});
      if (!answer.ok) faults.push(`${name}: ${await answer.text()}`); }
    catch (fault) { faults.push(`${name}: ${fault}`); } }
  if (!event.dataTransfer) event.target.value = ""; emit({sending: "", faults}); }"""


def file_input(page: Window, label: str, kind: str, done: Callable[[], Awaitable[None]], folder: str = "") -> None:
    """Show an input for files and, with the label `folder`, one for a folder; `done` is called after each upload."""

    async def sent(event: events.GenericEventArguments) -> None:
        page.sending = bool(event.args["sending"])
        state.text = say("app.records.copying", name=event.args["sending"]) if page.sending else ""
        if not page.sending:
            await done()
            for name, _, fault in (one.partition(": ") for one in event.args["faults"]):
                shown = f"{name}: {error_words(fault.removeprefix(f'{name}: '))}"
                ui.notify(shown, type="negative", multi_line=True, close_button=True, timeout=0)

    handle, send = page.handler(sent), SEND.replace("KIND", kind)
    with ui.element("div").classes("drop").on("dragover", js_handler="(event) => event.preventDefault()") as field:
        field.on("drop", handle, js_handler=send)
        for text, several in ((label, "multiple"), (folder, "webkitdirectory")):
            if text:
                with ui.element("label"):
                    ui.label(text)
                    ui.element("input").props(f'type="file" {several}').on("change", handle, js_handler=send)
    state = ui.label().props('role="status"')


#: Texts for the exit codes of a command that has ended; another code means that it has failed.
ENDED = {None: "", 0: "", 1: "app.results.some", 130: "app.results.cancelled"}


class Progress:
    """A bar with the remaining time, a button to cancel, and how the last command ended."""

    def __init__(self, page: Window, *verbs: str) -> None:
        self.command, self.verbs, self._seen = page.project.command, verbs, -1
        self.stop = page.button(say("app.results.cancel"), self.command.cancel)
        self.bar = ui.linear_progress(0.0, show_value=False).props(
            f'instant-feedback aria-label="{say("app.results.progress")}"'
        )
        self.state = ui.label().props('role="status"')

    def look(self) -> bool:
        """Show the progress of the command, and return whether a command has started or ended since the last look."""
        command, seen = self.command, self._seen
        self._seen = command.turned
        own = command.verb in self.verbs
        self.stop.visible = self.bar.visible = own and command.running
        key = ENDED.get(command.code, "app.results.failed") if own else ""
        if own and command.running:
            self.bar.value = command.done / command.total if command.total else 0.0
            self.bar.props(f":indeterminate={'false' if command.total else 'true'}")
            key = "app.results.at" if command.total else f"app.results.{command.verb}"
        given = {"done": command.done, "total": command.total, "left": command.left}
        self.state.text = say(key, **given, reason=plain_error(command.reason)) if key else ""
        return seen != command.turned
