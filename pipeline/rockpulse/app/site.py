"""The section of the page on the site: demand, directions of the records, code check, and title of the report."""

from typing import Any

from nicegui import ui

from rockpulse.app.fields import Fields, text_of
from rockpulse.app.window import Window
from rockpulse.config.settings import DemandSettings, RecordSettings, SiteSettings
from rockpulse.config.study_settings import CheckSettings, ReportSettings
from rockpulse.record.measures import PGA, ROWS
from rockpulse.views.shared.words import say

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

    def show(self) -> None:
        """Build the section on the page."""
        section = self.project.section
        with ui.element("div").classes("keys"):
            self._group(SiteSettings, section("site")).add("name", "description", texts=("name", "description"))
        ui.html(say("app.site.demand"), tag="h3")
        demands = self.project.several("demand")
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
        with ui.expansion(say("app.site.report")).classes("wide").props("dense"), ui.element("div").classes("keys"):
            names = ("author", "client", "project")
            self._group(ReportSettings, section("report")).add(*names, texts=names)
        self.fault = ui.label().classes("fault").props('role="alert"')

    def _group(self, cls: Any, values: dict[str, Any]) -> Fields:
        self.groups.append(Fields(cls, values, self.page.changed))
        return self.groups[-1]

    def _choose(self, kind: str) -> None:
        site, demands = self.project.section("site"), self.project.several("demand")
        demands.clear()
        if kind != "ag":
            site.pop("ag", None)
        if kind in MEASURES:
            demands.append({"measure": kind, **({"period": 1.0} if ROWS[kind].periods else {})})
        self._show_demand(kind)
        if kind in ("none", "ag"):
            self.page.changed()

    def _show_demand(self, kind: str) -> None:
        self.demand.clear()
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

        def change() -> None:
            row["value"] = f"{(typed.value or '').replace(',', '.').strip()} {chosen.value}".strip()
            self.page.changed()

        typed.on_value_change(change)
        chosen.on_value_change(change)
        typed.mark(f"value{number}")
        if measure and measure.periods:
            self._group(DemandSettings, row).add("period")

    def show_error(self, error: str) -> None:
        """Show an error in the values of the site at its input or, if no input is named, below the inputs."""
        own = error if error and not error.startswith("[[block") else ""
        heading = own.partition("]")[0]
        shown = [group.show(own if group.cls.heading.startswith(heading) else "") for group in self.groups if heading]
        if not heading:
            for group in self.groups:
                group.show("")
        self.fault.text = "" if any(shown) else own
