"""The section of the page on the site: demand, directions of the records, code check, and title of the report."""

from typing import Any

from nicegui import events, ui

from rockpulse.app.fields import Fields, file_input, plain_error, refused, text_of
from rockpulse.app.progress import Progress
from rockpulse.app.project import CONFIG, SELECTION, SPECTRA
from rockpulse.app.window import Window
from rockpulse.config.settings import DemandSettings, RecordSettings, SiteSettings
from rockpulse.config.study_settings import CheckSettings, HazardSettings, ReportSettings, SelectionSettings
from rockpulse.record.measures import PGA, ROWS
from rockpulse.views.shared.words import error_words, say

#: Kinds of demand: none, a_g S of the site, and measures with the units that a value may have.
MEASURES = {"pga": ("g", "m/s2"), "pgv": ("m/s", "cm/s"), "sa": ("g", "m/s2")}
#: Keys of each group of inputs, by section.
CHECK = ("spectrum", "ag", "f0", "tc_star", "ground", "topography", "limit_state", "q", "confidence_factor")


class SitePart:
    """The section of the page on the site, below the bodies."""

    name = "site"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project
        self.groups: list[Fields] = []
        self.values: list[tuple[ui.input, ui.button]] = []  # of the demands, each with the button that confirms it

    def show(self) -> None:
        """Build the section on the page."""
        section = self.project.section
        with ui.element("div").classes("keys"):
            self._group(SiteSettings, section("site")).add("name", "description", texts=("name", "description"))
        ui.html(say("app.site.demand"), tag="h3")
        demands = self.project.several("demand")
        if not demands and PGA in section("site"):  # the same as a demand
            demands.append({"measure": PGA, "value": section("site").pop(PGA)})
        kind = "none" if not demands else demands[0].get("measure", PGA)
        kind = "ag" if not demands and "ag" in section("site") else kind
        options = {one: say(f"app.demand.{one}") for one in ("none", "ag", *MEASURES)}
        options |= {} if kind in options else {kind: kind}
        with ui.element("div").classes("keys"):
            choice = ui.select(options, label=say("app.site.kind"), value=kind)
            choice.classes("key").props("dense outlined").mark("demand")
        self.demand = ui.element("div").classes("keys")
        self._show_demand(kind)
        choice.on_value_change(self.page.handler(lambda event: self._choose(event.value)))
        with ui.expansion(say("app.site.directions")).classes("wide").props("dense"), ui.element("div").classes("keys"):
            self._group(RecordSettings, section("records")).add("components", "azimuth", "include_vertical")
        with ui.expansion(say("app.site.check")).classes("wide").props("dense"), ui.element("div").classes("keys"):
            self._group(CheckSettings, section("check")).add(*CHECK)
            self._group(SelectionSettings, section("selection")).add("records")
            self._spectra()
        with ui.expansion(say("app.site.hazard")).classes("wide").props("dense"):
            ui.label(say("app.site.hazard_intro")).classes("soft")
            file_input(say("app.site.hazard_file"), "/hazard", self.page.handler(self._hazard_taken))
            self.hazard = ui.element("div").classes("keys")
            self._show_hazard()
        with ui.expansion(say("app.site.report")).classes("wide").props("dense"), ui.element("div").classes("keys"):
            names = ("author", "client", "project")
            self._group(ReportSettings, section("report")).add(*names, texts=names)
        self.fault = ui.label().classes("fault").props('role="alert"')

    def _group(self, cls: Any, values: dict[str, Any]) -> Fields:
        self.groups.append(Fields(cls, values, self.page.changed))
        return self.groups[-1]

    def _spectra(self) -> None:
        """Show the button that selects records for the spectrum of the check, and the picture of their spectra."""
        self.draw = ui.button(say("app.site.spectra"), on_click=self.page.handler(self._select))
        self.draw.props("outline no-caps")
        self.progress = Progress(self.page, "select")
        self.picture = ui.element("div").classes("picture")
        self._look()
        ui.timer(0.5, self._look)

    async def _select(self) -> None:
        if self.project.error:  # the configuration in the file is an earlier one
            raise ValueError(self.project.error)
        of_language = "--overwrite", "--language", self.page.language
        await self.page.run("select", "--config", CONFIG, "-o", SELECTION, *of_language)

    def _look(self) -> None:
        if self.progress.look():
            self.draw.set_enabled(not self.progress.command.running)
            with self.page.words():
                self._show_picture()

    def _show_picture(self) -> None:
        self.picture.clear()
        path = self.project.folder / SPECTRA
        if path.is_file() and not self.project.newer_than(path):
            with self.picture:
                address = f"/files/{SPECTRA}?{path.stat().st_mtime_ns}"
                ui.html(f'<img src="{address}" alt="{say("app.site.spectra_alt")}">', sanitize=False)
                ui.link(say("app.site.selection"), f"/files/{SELECTION}")

    def _hazard_taken(self, event: events.GenericEventArguments) -> None:
        if not event.args["sending"]:
            self._show_hazard()
            self.page.shown_error()
            refused(event.args["faults"])

    def _show_hazard(self) -> None:
        self.hazard.clear()
        values = self.project.section("hazard")
        with self.hazard:
            if "file" in values:
                remove = ui.button(
                    f"{say('app.records.remove')}: {values['file']}", on_click=self.page.handler(self._drop)
                )
                remove.props("outline no-caps")
            else:
                self._group(HazardSettings, values).add("measure", "unit", "k0", "k")
            self._group(HazardSettings, values).add("longitude", "latitude", "soil_factor", "years")

    def _drop(self) -> None:
        del self.project.section("hazard")["file"]
        self._show_hazard()
        self.page.changed()

    def _choose(self, kind: str) -> None:
        site, demands = self.project.section("site"), self.project.several("demand")
        demands.clear()
        if kind != "ag":
            site.pop("ag", None)
        site.pop(PGA, None)
        if kind in MEASURES:
            demands.append({"measure": kind, **({"period": 1.0} if ROWS[kind].periods else {})})
        self._show_demand(kind)
        if kind in ("none", "ag"):
            self.page.changed()

    def _show_demand(self, kind: str) -> None:
        self.demand.clear()
        self.values.clear()
        with self.demand:
            if kind == "ag":
                self._group(SiteSettings, self.project.section("site")).add("ag", "ground")
            for number, row in enumerate(self.project.several("demand")):
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

        def confirm() -> None:
            row["confirm_value"] = True
            self.page.changed()

        def change() -> None:
            row.pop("confirm_value", None)  # it was given for another value
            row["value"] = f"{(typed.value or '').replace(',', '.').strip()} {chosen.value}".strip()
            self.page.changed()

        typed.on_value_change(change)
        chosen.on_value_change(change)
        typed.mark(f"value{number}")
        sure = ui.button(say("app.site.confirm"), on_click=self.page.handler(confirm)).props("outline no-caps dense")
        self.values.append((typed.without_auto_validation(), sure))
        if measure and measure.periods:
            self._group(DemandSettings, row).add("period")

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
