"""The section of the page on bodies: a row of inputs for each body, with a drawing to scale and its uplift PGA."""

import math
from functools import partial
from typing import Any

import numpy as np
from markupsafe import escape
from nicegui import events, ui

from rockpulse.app.fields import Fields, file_input, refused
from rockpulse.app.project import body_error
from rockpulse.app.window import Window
from rockpulse.config.block_settings import BlockSettings, PedestalSettings
from rockpulse.config.configuration import section_of
from rockpulse.config.floor_settings import FloorSettings
from rockpulse.config.restraint_settings import LoadSettings, ThrustSettings, TieSettings
from rockpulse.option import Section
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.body_drawings import Support, body_drawing
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import error_words, say

#: Keys in the row of a body, and in its panel of further keys.
FIRST = ("name", "width", "height")
MORE = ("one_sided", "friction", "restitution", "mass", "density", "length", "azimuth", "facing")
#: Restraints and supports that a body can have, with the keys of one of them.
PARTS: dict[str, tuple[type[Section], tuple[str, ...]]] = {
    "tie": (TieSettings, ("height", "stiffness", "gap", "yield_force", "ultimate")),
    "pedestal": (PedestalSettings, ("width", "height", "mass")),
    "floor": (FloorSettings, ("period", "damping", "participation")),
    "load": (LoadSettings, ("weight", "height", "friction")),
    "thrust": (ThrustSettings, ("force", "height")),
}
#: Headings that are put before a pasted table without any.
HEADINGS = "name,width [m],height [m]"


class BodyRow:
    """The row of inputs of one body; its values are the keys of the body's [[block]] in the configuration."""

    def __init__(self, page: Window, values: dict[str, Any]) -> None:
        self.page, self.values = page, values
        self.fields: list[tuple[str, Fields]] = []

    def show(self, remove: Any) -> None:
        """Build the row on the page."""
        with ui.element("div").classes("body-row").props('role="group"') as self.frame:
            self.drawing = ui.html("", sanitize=False).classes("side")
            with ui.element("div").classes("main"):
                with ui.element("div").classes("keys"):
                    self._fields("block", BlockSettings, self.values, FIRST)
                    button = ui.button(icon="delete", on_click=remove).props("flat dense color=secondary")
                    button.props(f'aria-label="{say("app.bodies.remove")}"')
                self.numbers = ui.label().props('role="status"')
                self.fault = ui.label().classes("fault").props('role="alert"')
                self.confirm = ui.button(say("app.bodies.confirm"), on_click=self.page.handler(self._confirm))
                self.confirm.props("outline no-caps dense")
                self.panel = ui.expansion(say("app.bodies.more"), on_value_change=self.page.handler(self._open))
                self.panel.props("dense")
        self.refresh()

    def _open(self, event: events.ValueChangeEventArguments) -> None:
        if event.value and len(self.fields) == 1:  # a panel for each of many bodies would make the page slow
            with self.panel:
                self._panel()
            self.refresh()

    def _panel(self) -> None:
        with ui.element("div").classes("keys"):
            self._fields("block", BlockSettings, self.values, MORE)
        for part, (cls, names) in PARTS.items():
            for values in self.values.get(part, []):
                with ui.element("div").classes("keys part"):
                    ui.label(say(f"app.part.{part}")).classes("name")
                    self._fields(part, cls, values, names)
                    click = self.page.handler(partial(self._drop, part, values))
                    button = ui.button(icon="delete", on_click=click).props("flat dense color=secondary")
                    button.props(f'aria-label="{say("app.bodies.remove_part")} {say(f"app.part.{part}")}"')
        with ui.row():
            for part in PARTS:
                label = f"+ {say(f'app.part.{part}')}"
                ui.button(label, on_click=self.page.handler(partial(self._add, part))).props("outline dense no-caps")

    def _fields(self, part: str, cls: type[Section], values: dict[str, Any], names: tuple[str, ...]) -> None:
        made = Fields(cls, values, self._changed)
        made.add(*names)
        self.fields.append((part, made))

    def _add(self, part: str) -> None:
        self.values.setdefault(part, []).append({})
        self._again()

    def _drop(self, part: str, values: dict[str, Any]) -> None:
        self.values[part] = [one for one in self.values[part] if one is not values]
        if not self.values[part]:
            del self.values[part]
        self._again()

    def _again(self) -> None:
        self.panel.clear()
        self.fields = self.fields[:1]
        with self.panel:
            self._panel()
        self._changed()

    def _confirm(self) -> None:
        self.values["confirm_size"] = True
        self._changed()

    def _changed(self) -> None:
        if self.size != (self.values.get("width"), self.values.get("height")):
            self.values.pop("confirm_size", None)  # it was given for another size
        with self.page.words():
            self.refresh()
        self.page.changed()

    def refresh(self) -> None:
        """Draw the body and show its numbers or, if its values are wrong, the error at the input that is wrong."""
        fault = body_error(self.values)
        error = str(fault or "")
        self.size = self.values.get("width"), self.values.get("height")
        heading = error.partition("]")[0].strip("[").rpartition(".")[2]
        name = str(self.values.get("name", ""))
        self.frame.props(f'aria-label="{escape(name) or say("app.bodies.new")}"')
        empty = not set(self.values) & {"width", "height"}
        shown = [one.show(error if part == heading and not empty else "") for part, one in self.fields]
        said = error_words(error.partition("]] ")[2].removeprefix(f'"{name}"').partition(": ")[2])
        self.fault.text = "" if not error or any(shown) or empty else said[:1].upper() + said[1:]
        self.confirm.visible = bool(fault and fault.remedies)
        if error:
            self.numbers.text = say("app.bodies.incomplete") if empty else ""
            self.drawing.content = ""
            return
        self.numbers.text, self.drawing.content = _facts(section_of(BlockSettings, self.values))


def _facts(body: BlockSettings) -> tuple[str, str]:
    """Return uplift PGA, p and alpha_c of a body as one text, and its drawing as SVG."""
    from rocking.body.outline import Outline
    from rocking.search.capacity import uplift_scale

    block = body.block().lanes().lane(0)
    uplift = float(np.min(uplift_scale(block, np.array([-1.0, 1.0])))) / STANDARD_GRAVITY
    p, alpha = float(np.min(block.p)), float(np.min(block.alpha_c))
    pedestals = [(one.width, one.height) for one in body.pedestals]
    label = str(escape(say("drawing.label", name=body.name, held="")))
    support = Support(bool(body.floors), pedestals)
    drawing = body_drawing(Outline.of(block), support, label, lambda value: three_digits(value, "m"))
    words = say(
        "app.bodies.numbers",
        uplift=three_digits(uplift, "g") if math.isfinite(uplift) else "-",
        p=three_digits(p),
        alpha=three_digits(alpha),
    )
    return words, drawing


class BodyPart:
    """The section of the page on bodies, below the records."""

    name = "bodies"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project

    def show(self) -> None:
        """Build the section on the page."""
        self.rows = ui.element("div").classes("wide")
        self._show_rows()
        with ui.row():
            ui.button(say("app.bodies.add"), on_click=self.page.handler(self._add)).props("no-caps").mark("add-body")
            ui.button(say("app.bodies.paste"), on_click=self.page.handler(self._paste)).props("outline no-caps")
        self.fault = ui.label().classes("fault").props('role="alert"')

    def _show_rows(self) -> None:
        self.rows.clear()
        with self.page.words():
            for values in self.project.several("block"):
                self._show_row(values)

    def _show_row(self, values: dict[str, Any]) -> None:
        with self.rows:
            BodyRow(self.page, values).show(self.page.handler(partial(self._remove, values)))

    def _add(self) -> None:
        names = {row.get("name") for row in self.project.several("block")}
        number = next(number for number in range(1, len(names) + 2) if say("app.bodies.name", n=number) not in names)
        values = {"name": say("app.bodies.name", n=number)}
        self.project.several("block").append(values)
        self._show_row(values)
        self.page.changed()

    def _remove(self, values: dict[str, Any]) -> None:
        self.project.document["block"] = [row for row in self.project.several("block") if row is not values]
        self._show_rows()
        self.page.changed()

    def _paste(self) -> None:
        with self.rows, ui.dialog(value=True) as dialog, ui.card().classes("picture"):
            ui.label(say("app.bodies.paste_intro"))
            pasted = ui.textarea(say("app.bodies.table"), placeholder=f"{HEADINGS}\nwall,0.55,4.2")
            pasted.props("outlined").classes("wide")
            taken = self.page.handler(lambda event: self._file(event, dialog))
            file_input(say("app.bodies.file"), "/table", taken)
            with ui.row():
                take = self.page.handler(lambda: self._text(pasted.value or "", dialog))
                ui.button(say("app.bodies.take"), on_click=take).props("no-caps")
                ui.button(say("app.close"), on_click=dialog.close).props("flat no-caps")

    def _text(self, text: str, dialog: Any) -> None:
        headed = text if text.lstrip().lower().startswith("name") else f"{_headings(text)}\n{text}"
        unused = self.project.add_table("pasted.csv", headed.encode())
        self._added(dialog)
        if unused:
            ui.notify(error_words(unused))

    def _file(self, event: events.GenericEventArguments, dialog: Any) -> None:
        if not event.args["sending"]:
            self._added(dialog)
            refused(event.args["faults"])

    def _added(self, dialog: Any) -> None:
        dialog.close()
        self._show_rows()
        self.page.shown_error()

    def show_error(self, error: str) -> None:
        """Show an error that concerns several bodies."""
        same = error.startswith("[[block]] name:") and "times" in error
        self.fault.text = error_words(error.partition(": ")[2]) if same else ""


def _headings(text: str) -> str:
    mark = next((mark for mark in ("\t", ";") if mark in text), ",")
    return HEADINGS.replace(",", mark)
