"""The section of the page on results: the progress of the assessment, the report, and the files to download."""

import csv
import math

from nicegui import ui

from rockpulse.app.fields import plain_error
from rockpulse.app.project import ASSESS, CONFIG, FRAGILITY, RECORDS, RESULTS, RISK, SELECTION, TABLE
from rockpulse.app.window import Panel, Progress, Table, Window
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
        self._assessed = page.project.assessed

    def show(self) -> None:
        """Build the section on the page."""
        self.start = self.page.button(say("app.results.start"), self.assess).props(remove="outline").mark("assess")
        self.fault = ui.label().classes("fault").props('role="alert"')
        self.progress = Progress(self.page, "assess", "report", "export", "fragility", "risk")
        self.note = ui.label(say("app.results.outdated")).classes("note").props('role="status"')
        self.found, self.risk, self.report = (ui.element("div").classes("wide") for _ in range(3))
        self._look()
        self._show_found()
        self._show_risk()
        self.page.looks.append(self._look)

    async def assess(self) -> None:
        """Assess the records and write the report; finished records of an interrupted assessment are not repeated."""
        if self.command.running or self.project.save():
            return
        await self.page.run(*ASSESS, "--resume", "--overwrite")
        if (self.project.folder / RESULTS).is_file():
            self.project.assessed += 1
            await self._write_report(".html")

    async def _write_report(self, suffix: str) -> str:
        """Write the report in the language of the page, and return the name of its file."""
        name = self.project.report(self.page.language, suffix).name
        await self.page.run("report", RESULTS, "-o", name, "--language", self.page.language, "--overwrite")
        return name

    async def _frequencies(self) -> None:
        of_config = "--config", CONFIG, "--overwrite", "-o"
        if not self.project.is_current(FRAGILITY):
            await self.page.run("fragility", *of_config, FRAGILITY, "--resume")
        await self.page.run("risk", FRAGILITY, *of_config, RISK)

    async def _save_pdf(self) -> None:
        ui.download(f"/files/{await self.page.after(self._write_report('.pdf'))}")

    async def _save_table(self) -> None:
        comma = ("--decimal-comma",) if self.page.language == "it" else ()
        await self.page.after(self.page.run("export", RESULTS, "-o", TABLE, "--overwrite", *comma))
        ui.download(f"/files/{TABLE}")

    def _look(self) -> None:
        """Show the progress of the command, and the results of commands started in any window."""
        if self.project.assessed != self._assessed:
            self._assessed = self.project.assessed
            ui.timer(0.05, self.page.handler(self.page.parts[0].read), once=True)  # what the assessment has rejected
        if self.progress.look():
            self.start.visible = not self.command.running
            if not self.command.running and self.command.verb in self.progress.verbs:  # not of a picture of spectra
                self._show_found()
                self._show_risk()

    def _show_found(self) -> None:
        """Show links to the files, the commands that repeat the run, and the report, once there are results."""
        self.found.clear()
        self.report.clear()
        if not (self.project.folder / RESULTS).is_file():
            return
        report, button = self.project.report(self.page.language), self.page.button
        with self.found:
            with ui.row().classes("files"):
                if report.is_file():
                    _link(say("app.results.html"), report.name)
                else:
                    button(say("app.results.make"), lambda: self._write_report(".html"))
                button("PDF", self._save_pdf)
                button("CSV", self._save_table)
                _link("HDF5", RESULTS)
                _link(CONFIG, CONFIG)
            Panel(self.page, say("app.results.commands"), self._show_commands)
        if report.is_file():
            with self.report:
                frame = ui.element("iframe").classes("report").props(f'title="{say("app.results.report")}"')
                frame.on("load", js_handler=FIT)
                frame.props(f'src="/files/{report.name}?{report.stat().st_mtime_ns}"')

    def _show_commands(self) -> None:
        report, folder = self.project.report(self.page.language).name, self.project.folder
        of_config = f"--config {CONFIG} -o"
        made = {
            RESULTS: (" ".join(ASSESS), f"report {RESULTS} -o {report} --language {self.page.language}"),
            SELECTION: (f"select {of_config} {SELECTION}",),
            RISK: (f"fragility {of_config} {FRAGILITY}", f"risk {FRAGILITY} {of_config} {RISK}"),
        }
        lines = [f"rockpulse {one}" for name, commands in made.items() if (folder / name).is_file() for one in commands]
        ui.html("\n".join([f"cd {folder}", *lines]), tag="pre").classes("pre").props('tabindex="0"')

    def _show_risk(self) -> None:
        """Show the annual frequencies of the bodies, and the button that computes them."""
        self.risk.clear()
        path = self.project.folder / RISK
        with self.risk:
            ui.html(say("app.risk.title"), tag="h3")
            with ui.row().classes("files"):
                self.page.button(say("app.risk.start"), self._frequencies)
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
