"""The progress of the commands that one part of the page starts, and the button that cancels them."""

from nicegui import ui

from rockpulse.app.fields import plain_error
from rockpulse.app.window import Window
from rockpulse.views.shared.words import say

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
