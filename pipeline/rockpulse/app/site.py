"""The section of the page on the site: demand, directions of the records, code check, and title of the report."""

from functools import partial
from typing import Any

from nicegui import ui

from rockpulse.app.fields import Fields, plain_error, text_of
from rockpulse.app.project import CONFIG, SELECTION, SPECTRA
from rockpulse.app.window import Panel, Progress, Window, file_input
from rockpulse.config.settings import DemandSettings, RecordSettings, SiteSettings
from rockpulse.config.study_settings import CheckSettings, HazardSettings, ReportSettings, SelectionSettings
from rockpulse.option import Section
from rockpulse.record.measures import PGA, ROWS
from rockpulse.views.shared.words import error_words, say

#: Kinds of demand: none, a_g S of the site, and measures with the units that a value may have.
MEASURES = {"pga": ("g", "m/s2"), "pgv": ("m/s", "cm/s"), "sa": ("g", "m/s2")}
#: Keys of the directions of the records, of the code check, and of the head of the report.
DIRECTIONS = ("components", "azimuth", "include_vertical")
CHECK = ("spectrum", "ag", "f0", "tc_star", "ground", "topography", "limit_state", "q", "confidence_factor")
HEAD = ("author", "client", "project")


class SitePart:
    """The section of the page on the site, below the bodies."""

    name = "site"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project
        self.groups: list[Fields] = []
        self.values: list[tuple[ui.input, ui.button]] = []  # of the demands, each with the button that confirms it

    def show(self) -> None:
        """Build the section on the page."""
        site = self.project.section("site")
        self._group(SiteSettings, "name", "description", texts=("name", "description"))
        ui.html(say("app.site.demand"), tag="h3")
        of_site = [{"measure": PGA, "value": site[PGA]}] if PGA in site else []
        demands = self.project.several("demand") or of_site
        kind = demands[0].get("measure", PGA) if demands else "ag" if "ag" in site else "none"
        options = {one: say(f"app.demand.{one}") for one in ("none", "ag", *MEASURES)}
        options |= {} if kind in options else {kind: kind}
        with ui.element("div").classes("keys"):
            choice = ui.select(options, label=say("app.site.kind"), value=kind)
            choice.classes("key").props("dense outlined").mark("demand")
        self.demand = ui.element("div").classes("keys")
        self._show_demand(kind, demands)
        choice.on_value_change(self.page.handler(lambda event: self._choose(event.value)))
        Panel(self.page, say("app.site.directions"), partial(self._group, RecordSettings, *DIRECTIONS))
        Panel(self.page, say("app.site.check"), self._show_check)
        Panel(self.page, say("app.site.hazard"), self._show_hazard_panel)
        Panel(self.page, say("app.site.report"), partial(self._group, ReportSettings, *HEAD, texts=HEAD))
        self.fault = ui.label().classes("fault").props('role="alert"')

    def _group(self, cls: type[Section], *keys: str, texts: tuple[str, ...] = (), values: Any = None) -> None:
        """Show inputs of a section of the configuration, or of `values`."""
        values = self.project.section(cls.heading.strip("[]")) if values is None else values
        with ui.element("div").classes("keys"):
            self.groups.append(Fields(cls, values, self.page.changed).add(*keys, texts=texts))

    def _show_check(self) -> None:
        """Show the inputs of the check, and the picture of the records that are selected for its spectrum."""
        self._group(CheckSettings, *CHECK)
        self._group(SelectionSettings, "records")
        self.draw = self.page.button(say("app.site.spectra"), self._select)
        self.progress = Progress(self.page, "select")
        self.picture = ui.element("div").classes("picture")
        self.page.looks.append(self._look)
        self._look()

    async def _select(self) -> None:
        if self.project.error:  # the configuration in the file is an earlier one
            raise ValueError(self.project.error)
        of_language = "--overwrite", "--language", self.page.language
        await self.page.run("select", "--config", CONFIG, "-o", SELECTION, *of_language)

    def _look(self) -> None:
        if self.progress.look():
            self.draw.set_enabled(not self.progress.command.running)
            self.picture.clear()
            path = self.project.folder / SPECTRA
            if path.is_file() and not self.project.newer_than(path):
                with self.picture:
                    address = f"/files/{SPECTRA}?{path.stat().st_mtime_ns}"
                    ui.html(f'<img src="{address}" alt="{say("app.site.spectra_alt")}">', sanitize=False)
                    ui.link(say("app.site.selection"), f"/files/{SELECTION}")

    def _show_hazard_panel(self) -> None:
        ui.label(say("app.site.hazard_intro")).classes("soft")
        file_input(self.page, say("app.site.hazard_file"), "hazard", self._take_hazard)
        self.hazard = ui.element("div").classes("wide")
        self._show_hazard()

    async def _take_hazard(self) -> None:
        self._show_hazard()
        self.page.shown_error()

    def _show_hazard(self) -> None:
        self.hazard.clear()
        file = self.project.section("hazard").get("file")
        with self.hazard:
            if file:
                self.page.button(f"{say('app.records.remove')}: {file}", self._drop_hazard)
            else:
                self._group(HazardSettings, "measure", "unit", "k0", "k")
            self._group(HazardSettings, "longitude", "latitude", "soil_factor", "years")

    def _drop_hazard(self) -> None:
        del self.project.section("hazard")["file"]
        self._show_hazard()
        self.page.changed()

    def _choose(self, kind: str) -> None:
        site, demands = self.project.section("site"), self.project.several("demand")
        demands.clear()
        site.pop(PGA, None)
        if kind != "ag":
            site.pop("ag", None)
        if kind in MEASURES:
            demands.append({"measure": kind, **({"period": 1.0} if ROWS[kind].periods else {})})
        self._show_demand(kind, demands)
        if kind in ("none", "ag"):
            self.page.changed()

    def _show_demand(self, kind: str, demands: list[dict[str, Any]]) -> None:
        self.demand.clear()
        self.values.clear()
        with self.demand:
            if kind == "ag":
                self._group(SiteSettings, "ag", "ground")
            for number, row in enumerate(demands):
                self._show_value(row, number)

    def _show_value(self, row: dict[str, Any], number: int) -> None:
        """Show the inputs of a demand: its value with a unit and, for Sa, its period."""
        name = row.get("measure", PGA)
        units, measure = MEASURES.get(name, ()), ROWS.get(name)
        given = row.get("value")
        value, _, unit = given.partition(" ") if isinstance(given, str) else (text_of(given), "", "")
        if isinstance(given, int | float):  # a number is in the SI unit
            unit = measure.shown_unit if measure else ""
        typed = ui.input(say("app.site.value"), value=value).props("dense outlined inputmode=decimal").classes("key")
        chosen = ui.select([*units], label=say("app.site.unit"), value=unit if unit in units else (*units, "")[0])
        chosen.classes("key").props("dense outlined")

        def change(**confirmed: bool) -> None:
            if self.project.section("site").pop(PGA, None):  # it is the same as a demand, which can be confirmed
                self.project.several("demand").append(row)
            row.pop("confirm_value", None)  # it was given for another value
            row.update(confirmed, value=f"{(typed.value or '').replace(',', '.').strip()} {chosen.value}".strip())
            self.page.changed()

        typed.on_value_change(lambda: change())
        chosen.on_value_change(lambda: change())
        typed.mark(f"value{number}")
        sure = self.page.button(say("app.site.confirm"), lambda: change(confirm_value=True)).props("dense")
        self.values.append((typed.without_auto_validation(), sure))
        if measure and measure.periods:
            self._group(DemandSettings, "period", values=row)

    def show_error(self, error: str) -> None:
        """Show an error in the values of the site at its input or, if no input is named, below the inputs."""
        own = "" if error.startswith("[[block") else error
        of_demand = own.startswith("[[demand]]")
        for typed, sure in self.values:
            typed.error = error_words(own.partition(": ")[2]) if of_demand else None
            sure.visible = of_demand and "confirm_value" in own
        heading = own.partition("]")[0]
        shown = [group.show(own if heading and group.cls.heading.startswith(heading) else "") for group in self.groups]
        self.fault.text = "" if any(shown) or (of_demand and self.values) else plain_error(own)
