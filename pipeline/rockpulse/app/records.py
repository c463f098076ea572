"""The section of the page on records: the records read, and the files not used, with reasons and remedies."""

import math
from collections import Counter
from collections.abc import Collection
from functools import partial
from heapq import nsmallest
from operator import ne
from pathlib import Path
from typing import Any

import numpy as np
from nicegui import events, run, ui

from rockpulse.app.fields import value_of
from rockpulse.app.project import RECORDS, samples
from rockpulse.app.window import FIRST, Panel, Table, Window, file_input
from rockpulse.config.configuration import Config
from rockpulse.errors import NO_RECORD, Failure, Remedy, last_part
from rockpulse.readers.kit.spacing import same_step
from rockpulse.record.intensity import pgv
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.selection.directions import plan_motions
from rockpulse.selection.duplicate_selection import without_duplicates
from rockpulse.views.shared.files_used import translated_row
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.record_facts import facts_of
from rockpulse.views.shared.words import counted_words, in_dates, listed, say, section

#: Columns of the table, and those of numbers.
COLUMNS = ("station", "earthquake", "direction", "pga", "pgv", "length", "shape", "file")
NUMBERS = ("pga", "pgv", "length")
#: Cell of a station: a button that opens the picture of the record.
STATION = """<q-td :props="props"><q-btn flat dense no-caps color="primary" :label="props.value"
 :aria-label="props.value + ' {picture}'" @click="$parent.$emit('picture', props.row.id)" /></q-td>"""
#: Cell of a thumbnail: the vertical strokes of an accelerogram; the browser draws those on the page of the table.
SHAPE = """<q-td :props="props"><svg class="shape" viewBox="0 0 80 24" aria-hidden="true"
 @click="$parent.$emit('picture', props.row.id)"><path :d="props.value" /></svg></q-td>"""
#: Number of strokes of a thumbnail, and largest number of files to choose a partner from.
STROKES, PARTNERS = 40, 20
#: Largest cosine of the angle between the directions of a pair.
CROSSWISE = 0.2
#: Cell with the button that removes a file.
REMOVE = """<q-td :props="props" auto-width><q-btn flat dense icon="delete" color="secondary"
 :aria-label="'{remove} ' + props.value" @click="$parent.$emit('remove', props.value)" /></q-td>"""


class RecordPart:
    """The section of the page on records, the first one."""

    name = "records"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project
        self.records: list[Record] = []
        self.failures: list[Failure] = []  # of reading, and of the last assessment
        self.unused: list[Failure] = []  # those that are shown, and the channels without a partner
        self.single: dict[str, Record] = {}  # the horizontal channels that are alone in their files, by file
        self.components = ""  # the directions for which the channels without a partner were found

    def show(self) -> None:
        """Build the section on the page, and read the records."""
        page = self.page
        file_input(page, say("app.records.drop"), "records", self.read, say("app.records.folder"))
        self.fault = ui.label().classes("fault").props('role="alert"')
        if samples():
            page.button(say("app.records.samples"), self._samples)
        self.state = ui.label().props('role="status"')
        self.table = ui.element("div").classes("wide")
        self.left = ui.element("div").classes("wide")
        self.others = Panel(page, say("app.records.others"), lambda: self._show_unused(self.unused[FIRST:]))
        self.files = Panel(page, say("app.records.files"), self._show_files)
        self.others.visible = self.files.visible = False
        if self.project.kept[0]:  # shown before they are compared with the files
            self.records = self.project.kept[0]
            self._show_records()
        ui.timer(0.05, page.handler(self.read), once=True)

    def show_error(self, error: str) -> None:
        """Update the list of unused channels if the requested directions have changed; errors are shown elsewhere."""
        if self.records and not error and self._components() != self.components:
            self._show_failures()

    async def _samples(self) -> None:
        await self.page.after(run.io_bound(self.project.add_samples))
        await self.read()

    async def read(self) -> None:
        """Read all records again, and show them."""
        after, known = self.page.after, self.records
        self.state.text = self.state.text or say("app.records.reading")
        found = await after(run.io_bound(self.project.read_records))
        self.records, failures = found or ([], [])  # without a value: the server ends
        if not self.records or self.records is not known:
            self._show_records()
        self.failures = [*failures, *(await after(run.io_bound(self.project.rejected)) or [])]
        self._show_failures()
        self.files.renew()
        self.files.visible = bool(self.project.record_files())
        self.page.shown_error()
        if self.records:
            events = await after(run.io_bound(self.project.earthquakes, self.records, failures)) or 0
            self.state.text = _counts(len(self.records), events)

    def _show_records(self) -> None:
        self.state.text = counted_words(len(self.records), "channel") if self.records else say("app.records.none")
        self.table.clear()
        if not self.records:
            return
        number = {"align": "right", ":format": f"value => value.toPrecision(3).replace('.', '{say('decimal')}')"}
        columns = [
            {"name": name, "label": say(f"app.column.{name}"), "field": name, "sortable": name != "shape"}
            | (number if name in NUMBERS else {"align": "left"})
            for name in COLUMNS
        ]
        with self.table:
            rows = [{"id": place, **_row(record)} for place, record in enumerate(self.records)]
            shown = Table(say("app.records.title"), columns, rows)
            shown.add_slot("body-cell-station", STATION.format(picture=say("app.records.picture")))
            shown.add_slot("body-cell-shape", SHAPE)
            shown.on("picture", self.page.handler(self._show_picture))
            ui.label(say("app.records.click")).classes("soft")

    async def _show_picture(self, event: events.GenericEventArguments) -> None:
        record = self.records[int(event.args)]
        with self.table, ui.dialog(value=True) as dialog, ui.card().classes("picture"):
            ui.label(f"{record.id}").classes("name")
            drawn = ui.html(say("app.records.drawing"), sanitize=False).classes("wide")
            ui.button(say("app.close"), on_click=dialog.close).props("flat no-caps")
        drawn.content = await self.page.after(run.io_bound(_drawn, record))

    def _show_failures(self) -> None:
        self.components = self._components()
        sources = Counter(record.source for record in self.records)
        self.single = {
            self.project.name_of(one.source): one
            for one in self.records
            if sources[one.source] == 1 and one.orientation != "vertical" and not one.together
        }
        lone = _alone(self.records, self.project.config(), self.failures)
        boxes = {_box(source) for source in sources}
        self.unused = [row for row in (*self.failures, *lone) if self._concerns(row, boxes)]
        names = [*dict.fromkeys(last_part(row.file) for row in self.unused)]
        self.fault.text = say("app.records.unused", files=listed(names)) if names else ""
        self.left.clear()
        with self.left:
            if names:
                ui.html(say("app.records.left", count=len(self.unused)), tag="h3")
            self._show_unused(self.unused[:FIRST])
        self.others.visible = len(self.unused) > FIRST
        self.others.renew()

    def _components(self) -> str:
        return str(self.project.section("records").get("components", ""))

    def _concerns(self, row: Failure, boxes: Collection[str]) -> bool:
        """Return whether a failure is shown; `boxes` are the folders and archives with records.

        Texts and spectra beside records are not shown, unless they are in the folder of records itself.
        """
        box = _box(row.file)
        if row.kind != "skipped" or row.remedy or box == str(self.project.folder / RECORDS):
            return True
        return row.bare != NO_RECORD and box not in boxes

    def _show_unused(self, rows: list[Failure]) -> None:
        for original in rows:
            row = translated_row(original)
            whole = row.bare
            if any(words in whole for words in section("other").values() if " " in words):  # general words only
                whole += f"\n{say('other.message', text=original.bare)}"
            with ui.element("div").classes(f"left {row.kind}"):
                ui.label(f"{last_part(row.file)} ({say(f'left_out.{row.kind}')})").classes("name")
                ui.label(row.found.replace(f"{self.project.folder}/", ""))
                for remedy in row.remedies:
                    self._show_remedy(row.file, remedy)
                if whole != row.found:
                    Panel(self.page, say("app.records.why"), partial(_show_reason, whole))

    def _show_remedy(self, source: str, remedy: Remedy) -> None:
        """Show the input of a remedy for a file or its channels."""
        key, name = remedy.key, self.project.name_of(source)
        paired = key == "pair" and self.project.pairs_without(name) != self.project.section("records").get("pair", [])
        if key == "confirm" or paired:  # no choice of a pair: the files are separated
            label = say("app.records.apart") if paired else say("app.records.confirm")
            self.page.button(label, lambda: self._apply(name, key, remedy.choices)).props("dense")
            return
        partners = self._partners(name) if key == "pair" else {}
        label = say(f"app.key.{key}") + (" [s]" if key == "dt" else "")
        apply = self.page.handler(lambda: self._apply(name, key, partners.get(made.value) or value_of(made.value)))
        if key == "dt" and not remedy.choices:
            made: Any = ui.input(label).props("inputmode=decimal").on("change", apply)
        elif options := {other: last_part(other) for other in partners} or [*remedy.choices]:
            made = ui.select(options, label=label, on_change=apply)
        else:
            return
        made.props("dense outlined").classes("key")

    async def _apply(self, name: str, key: str, value: Any) -> None:
        if fault := self.project.remedy(name, key, value):
            self.project.load()
            raise ValueError(fault)
        await self.read()

    def _partners(self, name: str) -> dict[str, list[str]]:
        """Return, for each possible partner of a file, the names of the north and east files; similar names first."""
        if name not in self.single:
            return {}
        one, last = self.single[name], last_part(name)
        found = {
            other: [other, name] if _eastward(one, record) else [name, other]
            for other, record in self.single.items()
            if record is not one and one.npts == record.npts and same_step((one.dt, record.dt))
            if not abs(math.cos(math.radians(one.azimuth - record.azimuth))) > CROSSWISE  # true if one is unknown
        }
        return {other: found[other] for other in nsmallest(PARTNERS, found, key=lambda other: _unlike(last, other))}

    def _show_files(self) -> None:
        columns = [{"name": name, "label": "", "field": "id", "align": "left"} for name in ("id", "remove")]
        folder = self.project.folder / RECORDS
        rows = [{"id": path.relative_to(folder).as_posix()} for path in self.project.record_files()]
        shown = Table(say("app.records.files"), columns, rows).props("hide-header")
        shown.add_slot("body-cell-remove", REMOVE.format(remove=say("app.records.remove")))
        shown.on("remove", self.page.handler(self._remove))

    async def _remove(self, event: events.GenericEventArguments) -> None:
        path = self.project.folder / RECORDS / event.args
        if path in self.project.record_files():
            self.project.remove(path, {one.id for one in self.records if f"{one.source}!".startswith(f"{path}!")})
        await self.read()


def _show_reason(whole: str) -> None:
    ui.label(whole).classes("pre")


def _counts(channels: int, events: int) -> str:
    """Return the numbers of channels and earthquakes as text, with the number needed for a verdict if it is larger."""
    from rockpulse.assessment.verdict import FEWEST_AT_DEMAND

    key = "app.records.few" if events < FEWEST_AT_DEMAND else "app.records.counts"
    words = {"channels": counted_words(channels, "channel"), "events": counted_words(events, "earthquake")}
    return say(key, **words, needed=FEWEST_AT_DEMAND)


def _row(record: Record) -> dict[str, Any]:
    facts = facts_of(record)
    vertical = f" ({say('left_out.vertical')})" if record.orientation == "vertical" else ""
    return {
        "station": facts.place or record.id,
        "earthquake": facts.title or in_dates(facts.date),
        "direction": f"{facts.direction}{vertical}",
        "pga": record.pga / STANDARD_GRAVITY,
        "pgv": pgv(record),
        "length": record.duration,
        "shape": _shape(record),
        "file": last_part(record.source),
    }


def _shape(record: Record) -> str:
    """Return the path of a thumbnail: the range of the acceleration in each of equal parts of the record."""
    begins = np.linspace(0, record.npts, STROKES, endpoint=False).astype(int)
    scale = 11.0 / (record.pga or 1.0)
    ends = (12.0 - scale * find.reduceat(record.acceleration, begins) for find in (np.maximum, np.minimum))
    strokes = zip(*(np.rint(end).astype(int).tolist() for end in ends), strict=True)
    return "".join(f"M{2 * place + 1} {top}V{bottom}" for place, (top, bottom) in enumerate(strokes))


def _alone(records: list[Record], config: Config, failures: list[Failure]) -> list[Failure]:
    """Return the failures of the channels without a partner, if pairs are to be rotated."""
    if config.records.components == "horizontal":
        return []
    selected, _, _ = without_duplicates(records, config.records, failures)
    return [row for row in plan_motions(selected, config)[1] if row.stage == "pair"]


def _box(file: str) -> str:
    """Return the archive or the folder of a file."""
    archive, mark, _ = file.rpartition("!")
    return archive if mark else str(Path(file).parent)


def _unlike(last: str, file: str) -> int:
    """Return the number of characters in which the name of a file differs from the name `last`."""
    other = last_part(file)
    return sum(map(ne, last, other)) + abs(len(last) - len(other))


def _eastward(one: Record, other: Record) -> bool:
    """Return whether the first of two perpendicular channels is nearer to east, by the stated azimuths."""
    angles = [math.radians(azimuth) for azimuth in (one.azimuth, other.azimuth + 90.0) if math.isfinite(azimuth)]
    return bool(angles) and abs(math.sin(angles[0])) > abs(math.cos(angles[0]))


def _drawn(record: Record) -> str:
    """Return a picture (SVG) of a record, its intense phase and its half-waves."""
    from rockpulse.views.plots import plot, svg

    return f"{svg(plot(record))}<p>PGA {three_digits(record.pga / STANDARD_GRAVITY, 'g')}</p>"
