"""The section of the page on results: the progress of the assessment, the report, and the files to download."""

from typing import Any

from nicegui import ui

from rockpulse.app.project import ASSESS, CONFIG, RESULTS, TABLE
from rockpulse.app.window import Window
from rockpulse.views.shared.words import say

#: Makes the frame of the report as high as the report.
FIT = """(event) => { const frame = event.target, page = frame.contentDocument;
  const fit = () => { frame.style.height = Math.ceil(page.documentElement.getBoundingClientRect().height) + 2 + 'px'; };
  const style = page.createElement('style'); page.head.append(style);
  style.textContent = 'html { overflow-y: hidden; } .card { content-visibility: visible; }';
  fit(); new ResizeObserver(fit).observe(page.body); }"""


class ResultPart:
    """The section of the page on results, the last one."""

    name = "results"

    def __init__(self, page: Window) -> None:
        self.page, self.project, self.command = page, page.project, page.project.command
        self._seen, self._assessed = -1, page.project.assessed

    def show(self) -> None:
        """Build the section on the page."""
        handler = self.page.handler
        with ui.row():
            self.start = ui.button(say("app.results.start"), on_click=handler(self.assess)).props("no-caps")
            self.stop = ui.button(say("app.results.cancel"), on_click=handler(self.command.cancel))
            self.stop.props("outline no-caps")
        self.start.mark("assess")
        self.fault = ui.label().classes("fault").props('role="alert"')
        self.bar = ui.linear_progress(0.0, show_value=False).props(f'aria-label="{say("app.results.progress")}"')
        self.state = ui.label().props('role="status"')
        self.note = ui.label(say("app.results.outdated")).classes("note").props('role="status"')
        self.found = ui.element("div").classes("wide")
        self._show_found()
        ui.timer(0.5, self._look)

    async def assess(self) -> None:
        """Assess the records and write the report; finished records of an interrupted assessment are not repeated."""
        if self.command.running or self.project.save():
            return
        code = await self.command.run((*ASSESS, "--resume", "--overwrite"))
        if code in (0, 1) and (self.project.folder / RESULTS).is_file():
            self.project.assessed += 1
            await self._write_report(".html")  # also if the window was closed

    async def _write_report(self, suffix: str) -> None:
        language = self.page.language
        name = self.project.report(language, suffix).name
        await self._run("report", RESULTS, "-o", name, "--language", language, "--overwrite")

    async def _run(self, *arguments: str) -> None:
        """Run a command until it ends; raise ValueError with its message if it fails."""
        code = 0 if self.command.running else await self.page.after(self.command.run(arguments))
        if code:
            raise ValueError(self.command.reason)

    def _saving(self, kind: str) -> Any:
        async def save() -> None:
            if kind == TABLE:
                comma = ("--decimal-comma",) if self.page.language == "it" else ()
                await self._run("export", RESULTS, "-o", TABLE, "--overwrite", *comma)
            else:
                await self._write_report(kind)
            ui.download(f"/files/{TABLE if kind == TABLE else self.project.report(self.page.language, kind).name}")

        return save

    def _look(self) -> None:
        """Show the progress of the command and the changes made by other windows, if there are any."""
        self.page.follow()
        if self.project.assessed != self._assessed:  # by any window
            self._assessed = self.project.assessed
            ui.timer(0.05, self.page.handler(self.page.parts[0].read), once=True)  # what the assessment has rejected
        if self.command.version != self._seen:
            self._seen = self.command.version
            with self.page.words():
                self._show_command()

    def _show_command(self) -> None:
        command = self.command
        self.start.visible, self.stop.visible = not command.running, command.running and command.verb == "assess"
        self.bar.visible = command.running
        if command.running:
            self.bar.value = command.done / command.total if command.total else 0.0
            self.bar.props(
                f"{'' if command.total else 'indeterminate'}", remove="" if not command.total else "indeterminate"
            )
            key = f"app.results.{command.verb}" if command.verb != "assess" or not command.total else "app.results.at"
            self.state.text = say(key, done=command.done, total=command.total, left=command.left, doing=command.doing)
            return
        ended = {None: "", 0: "", 1: "app.results.some", 130: "app.results.cancelled"}
        key = ended.get(command.code, "app.results.failed")
        self.state.text = say(key, reason=command.reason) if key else ""
        self._show_found()

    def _show_found(self) -> None:
        """Show links to the files, the commands that repeat the run, and the report, once there are results."""
        self.found.clear()
        results = self.project.folder / RESULTS
        if not results.is_file():
            return
        report, handler = self.project.report(self.page.language), self.page.handler
        with self.found:
            with ui.row().classes("files"):
                if report.is_file():
                    _link(say("app.results.html"), report.name)
                else:
                    make = ui.button(say("app.results.make"), on_click=handler(lambda: self._write_report(".html")))
                    make.props("outline no-caps")
                for label, kind in (("PDF", ".pdf"), ("CSV", TABLE)):
                    ui.button(label, on_click=handler(self._saving(kind))).props("outline no-caps")
                _link("HDF5", RESULTS)
                _link(CONFIG, CONFIG)
            with ui.expansion(say("app.results.commands")).classes("wide").props("dense"):
                again = f"rockpulse {' '.join(ASSESS)}\nrockpulse report {RESULTS} -o {report.name}"
                again += f" --language {self.page.language}"
                ui.html(f"cd {self.project.folder}\n{again}", tag="pre").classes("pre").props('tabindex="0"')
            if report.is_file():
                frame = ui.element("iframe").classes("report").props(f'title="{say("app.results.report")}"')
                frame.on("load", js_handler=FIT)
                frame.props(f'src="/files/{report.name}?{report.stat().st_mtime_ns}"')

    def show_error(self, error: str) -> None:
        """Enable the start button only if the configuration is valid and contains bodies and records."""
        lacking = "" if self.project.document.get("block") else say("app.results.no_body")
        if (
            not lacking
            and not self.project.record_files()
            and not self.project.document.get("records", {}).get("paths")
        ):
            lacking = say("app.results.no_record")
        self.fault.text = say("app.results.wrong", error=error) if error else lacking
        self.start.set_enabled(not error and not lacking)
        self.note.visible = self.project.outdated


def _link(words: str, name: str) -> None:
    ui.button(words).props(f'href="/files/{name}" target="_blank" outline no-caps')
