"""The section of the page on results: the progress of the assessment, the report, and the files to download."""

import csv
import math
from typing import Any

from nicegui import ui

from rockpulse.app.fields import plain_error
from rockpulse.app.progress import Progress
from rockpulse.app.project import ASSESS, CONFIG, FRAGILITY, RECORDS, RESULTS, RISK, SELECTION, TABLE
from rockpulse.app.table import Table
from rockpulse.app.window import Window
from rockpulse.views.shared.formatting import between, fixed, share, three_digits
from rockpulse.views.shared.words import reason_words, say

#: Columns of the table of annual frequencies, and numbers in the file from which they are made.
COLUMNS = ("block", "frequency", "band", "period", "probability")
NUMBERS = ("frequency", "frequency_low", "frequency_high", "probability")

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
        self._assessed, self._shown = page.project.assessed, False

    def show(self) -> None:
        """Build the section on the page."""
        handler = self.page.handler
        self.start = ui.button(say("app.results.start"), on_click=handler(self.assess)).props("no-caps")
        self.start.mark("assess")
        self.fault = ui.label().classes("fault").props('role="alert"')
        self.progress = Progress(self.page, "assess", "report", "export", "fragility", "risk")
        self.note = ui.label(say("app.results.outdated")).classes("note").props('role="status"')
        self.risk = ui.element("div").classes("wide")
        self.found = ui.element("div").classes("wide")
        self._look()
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
        name = self.project.report(self.page.language, suffix).name
        await self.page.run("report", RESULTS, "-o", name, "--language", self.page.language, "--overwrite")

    async def _frequencies(self) -> None:
        of_config = "--config", CONFIG, "--overwrite", "-o"
        if not self.project.is_current(FRAGILITY):
            await self.page.run("fragility", *of_config, FRAGILITY, "--resume")
        await self.page.run("risk", FRAGILITY, *of_config, RISK)

    def _saving(self, kind: str) -> Any:
        async def save() -> None:
            if kind == TABLE:
                comma = ("--decimal-comma",) if self.page.language == "it" else ()
                await self.page.run("export", RESULTS, "-o", TABLE, "--overwrite", *comma)
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
        if self.progress.look():
            running = self.command.running
            self.start.visible = not running
            if not running and (self.command.verb in self.progress.verbs or not self._shown):
                self._shown = True
                with self.page.words():
                    self._show_found()
                    self._show_risk()

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
                again = [" ".join(ASSESS), f"report {RESULTS} -o {report.name} --language {self.page.language}"]
                if (self.project.folder / SELECTION).is_file():
                    again.append(f"select --config {CONFIG} -o {SELECTION}")
                if (self.project.folder / RISK).is_file():
                    again.append(f"fragility --config {CONFIG} -o {FRAGILITY}")
                    again.append(f"risk {FRAGILITY} --config {CONFIG} -o {RISK}")
                lines = "\n".join(f"rockpulse {one}" for one in again)
                ui.html(f"cd {self.project.folder}\n{lines}", tag="pre").classes("pre").props('tabindex="0"')
            if report.is_file():
                frame = ui.element("iframe").classes("report").props(f'title="{say("app.results.report")}"')
                frame.on("load", js_handler=FIT)
                frame.props(f'src="/files/{report.name}?{report.stat().st_mtime_ns}"')

    def _show_risk(self) -> None:
        """Show the annual frequencies of the bodies, and the button that computes them."""
        self.risk.clear()
        path = self.project.folder / RISK
        with self.risk:
            ui.html(say("app.risk.title"), tag="h3")
            with ui.row().classes("files"):
                make = ui.button(say("app.risk.start"), on_click=self.page.handler(self._frequencies))
                make.props("outline no-caps")
                if path.is_file():
                    _link("CSV", RISK)
            if not path.is_file() or self.project.newer_than(path):
                return
            with path.open(encoding="utf-8", newline="") as file:
                rows = [*csv.DictReader(file)]
            config = self.project.config()
            given = {"years": three_digits(config.hazard.years), "confidence": share(config.fragility.confidence)}
            labels = {name: say(f"app.risk.{name}", **given) for name in COLUMNS}
            columns = [{"name": name, "label": labels[name], "field": name, "align": "left"} for name in COLUMNS]
            Table(say("app.risk.title"), columns, [_frequency(row) for row in rows])
            for row in rows:
                if notes := ". ".join(reason_words(row[name]) for name in ("statement", "warning") if row[name]):
                    ui.label(f"{row['block']}: {notes}").classes("soft")

    def show_error(self, error: str) -> None:
        """Enable the start button only if the configuration is valid and contains bodies and records."""
        lacking = "" if self.project.document.get("block") else say("app.results.no_body")
        paths = self.project.document.get("records", {}).get("paths", [])
        if not lacking and paths in ([], [RECORDS]) and not self.project.record_files():
            lacking = say("app.results.no_record")
        self.fault.text = say("app.results.wrong", error=plain_error(error)) if error else lacking
        self.start.set_enabled(not error and not lacking)
        self.note.visible = self.project.outdated
        self.risk.visible = not error and bool({"file", "k0"} & {*self.project.section("hazard")})


def _frequency(row: dict[str, str]) -> dict[str, str]:
    """Return the cells of a body in the table of annual frequencies."""
    number = {name: float(value) if value else math.nan for name, value in row.items() if name in NUMBERS}
    years = float(f"{1.0 / number['frequency']:.2g}") if number["frequency"] else math.nan
    shown = {name: three_digits(value) for name, value in number.items()}
    band = between(number["frequency_low"], number["frequency_high"])
    return {**shown, "id": row["block"], "block": row["block"], "band": band, "period": fixed(years, 0)}


def _link(words: str, name: str) -> None:
    ui.button(words).props(f'href="/files/{name}" target="_blank" outline no-caps')
