"""The section of the page on bodies: a row of inputs for each body, with a drawing to scale and its uplift PGA."""

import math
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from markupsafe import escape
from nicegui import run, ui

from rockpulse.app.fields import Fields
from rockpulse.app.project import body_error
from rockpulse.app.window import FIRST, Panel, Window, file_input
from rockpulse.config.block_settings import BlockSettings, PedestalSettings
from rockpulse.config.configuration import section_of
from rockpulse.config.restraint_settings import FloorSettings, LoadSettings, ThrustSettings, TieSettings
from rockpulse.option import Section
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.views.report.body_drawings import Support, body_drawing
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import error_words, say, writing

#: Keys in the row of a body, and in its panel of further keys.
ROW = ("name", "width", "height")
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
#: Module that computes the uplift PGA; its import takes a second.
SOLVERS = "rocking.search.capacity"


class BodyRow:
    """The row of inputs of one body; its values are the keys of the body's [[block]] in the configuration."""

    def __init__(self, part: "BodyPart", values: dict[str, Any]) -> None:
        self.page, self.values = part.page, values
        with ui.element("div").classes("body-row").props('role="group"') as self.frame:
            self.drawing = ui.html("", sanitize=False).classes("side")
            with ui.element("div").classes("main"):
                with ui.element("div").classes("keys"):
                    self.fields = [Fields(BlockSettings, values, self._changed).add(*ROW)]
                    self.page.bin(say("app.bodies.remove"), partial(part.remove, values))
                self.numbers = ui.label().props('role="status"')
                self.fault = ui.label().classes("fault").props('role="alert"')
                self.confirm = self.page.button(say("app.bodies.confirm"), self._confirm).props("dense")
                self.panel = Panel(self.page, say("app.bodies.more"), self._show_more)
        self.refresh()

    def _show_more(self) -> None:
        self.fields = self.fields[:1]
        with ui.element("div").classes("keys"):
            self.fields.append(Fields(BlockSettings, self.values, self._changed).add(*MORE))
        for part, (cls, names) in PARTS.items():
            for values in self.values.get(part, []):
                with ui.element("div").classes("keys part"):
                    ui.label(say(f"app.part.{part}")).classes("name")
                    self.fields.append(Fields(cls, values, self._changed).add(*names))
                    remove = f"{say('app.bodies.remove_part')} {say(f'app.part.{part}')}"
                    self.page.bin(remove, partial(self._drop, part, values))
        with ui.row():
            for part in PARTS:
                self.page.button(f"+ {say(f'app.part.{part}')}", partial(self._add, part)).props("dense")
        self.refresh()

    def _add(self, part: str) -> None:
        self.values.setdefault(part, []).append({})
        self._show_again()

    def _drop(self, part: str, values: dict[str, Any]) -> None:
        self.values[part] = [one for one in self.values.get(part, []) if one is not values]
        if not self.values[part]:
            del self.values[part]
        self._show_again()

    def _show_again(self) -> None:
        self.panel.renew()
        self.page.changed()

    def _confirm(self) -> None:
        self.values["confirm_size"] = True
        self._changed()

    def _changed(self) -> None:
        if self.size != (self.values.get("width"), self.values.get("height")):
            self.values.pop("confirm_size", None)  # it was given for another size
        with writing(self.page.language):
            self.refresh()
        self.page.changed()

    def refresh(self) -> None:
        """Draw the body and show its numbers or, if its values are wrong, the error at the input that is wrong."""
        fault = body_error(self.values)
        error = str(fault or "")
        self.size = self.values.get("width"), self.values.get("height")
        name = str(self.values.get("name", ""))
        self.frame.props(f'aria-label="{escape(name) or say("app.bodies.new")}"')
        empty = not set(self.values) & {"width", "height"}
        shown = [one.show(error if error.startswith(one.cls.heading) and not empty else "") for one in self.fields]
        said = error_words(error.partition("]] ")[2].removeprefix(f'"{name}"').partition(": ")[2])
        self.fault.text = "" if not error or any(shown) or empty else said[:1].upper() + said[1:]
        self.confirm.visible = bool(fault and fault.remedies)
        if error:
            self.numbers.text, self.drawing.content = say("app.bodies.incomplete") if empty else "", ""
        else:
            self.numbers.text, self.drawing.content = _facts(section_of(BlockSettings, self.values))


def _facts(body: BlockSettings) -> tuple[str, str]:
    """Return uplift PGA, p and alpha_c of a body as one text, and its drawing as SVG."""
    from rocking.body.outline import Outline

    block = body.block().lanes().lane(0)
    lifting = import_module(SOLVERS).uplift_scale(block, np.array([-1.0, 1.0]))
    uplift = float(np.min(lifting)) / STANDARD_GRAVITY
    support = Support(bool(body.floors), [(one.width, one.height) for one in body.pedestals])
    label = str(escape(say("drawing.label", name=body.name, held="")))
    words = say(
        "app.bodies.numbers",
        uplift=three_digits(uplift, "g") if math.isfinite(uplift) else "-",
        p=three_digits(float(np.min(block.p))),
        alpha=three_digits(float(np.min(block.alpha_c))),
    )
    return words, body_drawing(Outline.of(block), support, label, lambda value: three_digits(value, "m"))


class BodyPart:
    """The section of the page on bodies, below the records."""

    name = "bodies"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project

    def show(self) -> None:
        """Build the section on the page; the rows follow once the solvers are imported."""
        self.rows = ui.element("div").classes("wide")
        self.others = Panel(
            self.page, say("app.bodies.others"), lambda: self._add_rows(self.project.several("block")[FIRST:])
        )
        self.others.visible = False
        self.page.button(say("app.bodies.add"), self._add).props(remove="outline").mark("add-body")
        self.table = Panel(self.page, say("app.bodies.paste"), self._show_table)
        self.fault = ui.label().classes("fault").props('role="alert"')
        ui.timer(0.05, self.page.handler(self._show_first), once=True)

    async def _show_first(self) -> None:
        await self.page.after(run.io_bound(import_module, SOLVERS))
        self._show_rows()

    def _show_rows(self) -> None:
        bodies = self.project.several("block")
        self.rows.clear()
        with self.rows:
            self._add_rows(bodies[:FIRST])
        self.others.visible = len(bodies) > FIRST
        self.others.renew()

    def _add_rows(self, bodies: list[dict[str, Any]]) -> None:
        for values in bodies:
            BodyRow(self, values)

    def _add(self) -> None:
        bodies = self.project.several("block")
        names = {row.get("name") for row in bodies}
        number = next(number for number in range(1, len(names) + 2) if say("app.bodies.name", n=number) not in names)
        bodies.append({"name": say("app.bodies.name", n=number)})
        if len(bodies) > FIRST and not self.others.value:
            self.others.visible = self.others.value = True
            self.others.renew()  # one that was open before has its rows still
        else:
            with self.rows if len(bodies) <= FIRST else self.others:
                self._add_rows(bodies[-1:])
        self.page.changed()

    def remove(self, values: dict[str, Any]) -> None:
        """Remove a body."""
        bodies = self.project.several("block")
        bodies[:] = [one for one in bodies if one is not values]  # another window may have removed it
        self._show_rows()
        self.page.changed()

    def _show_table(self) -> None:
        ui.label(say("app.bodies.paste_intro"))
        pasted = ui.textarea(say("app.bodies.table"), placeholder=f"{HEADINGS}\nwall,0.55,4.2")
        pasted.props("outlined").classes("wide")
        self.page.button(say("app.bodies.take"), lambda: self._take(pasted.value or ""))
        file_input(self.page, say("app.bodies.file"), "bodies", self._show_added)

    async def _take(self, text: str) -> None:
        if not text.lstrip().lower().startswith("name"):
            mark = next((mark for mark in ("\t", ";") if mark in text), ",")
            text = f"{HEADINGS.replace(',', mark)}\n{text}"
        with TemporaryDirectory() as folder:
            path = Path(folder, "pasted.csv")
            path.write_text(text, encoding="utf-8")
            unused = self.project.take("bodies", path.name, path)
        if unused:
            ui.notify(unused)
        await self._show_added()

    async def _show_added(self) -> None:
        self.table.value = False
        self._show_rows()
        self.others.value = True
        self.page.shown_error()

    def show_error(self, error: str) -> None:
        """Show an error that concerns several bodies."""
        same = error.startswith("[[block]] name:") and "times" in error
        self.fault.text = error_words(error.partition(": ")[2]) if same else ""
