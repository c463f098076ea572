"""The section of the page on records: the records read, and the files not used, with reasons and remedies."""

from typing import Any

from nicegui import events, run, ui

from rockpulse.app.fields import file_input, refused, value_of
from rockpulse.app.project import samples
from rockpulse.app.table import Table
from rockpulse.app.window import Window
from rockpulse.errors import Failure, last_part
from rockpulse.readers import UNITS
from rockpulse.record.intensity import pgv
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.selection.events import words_of
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import counted_words, in_dates, listed, say

#: Columns of the table, and those of numbers.
COLUMNS = ("station", "earthquake", "direction", "pga", "pgv", "length", "file")
NUMBERS = ("pga", "pgv", "length")
#: Cell of a station: a button that opens the picture of the record.
STATION = """<q-td :props="props"><q-btn flat dense no-caps color="primary" :label="props.value"
 :aria-label="props.value + ' {picture}'" @click="$parent.$emit('picture', props.row.id)" /></q-td>"""
#: Cell with the button that removes a file.
REMOVE = """<q-td :props="props" auto-width><q-btn flat dense icon="delete" color="secondary"
 :aria-label="'{remove} ' + props.value" @click="$parent.$emit('remove', props.value)" /></q-td>"""
#: Remedies: key of the configuration, and the option that a reason names for it.
REMEDIES = {"units": "--units", "dt": "--dt", "confirm": "--confirm"}


class RecordPart:
    """The section of the page on records, the first one."""

    name = "records"

    def __init__(self, page: Window) -> None:
        self.page, self.project = page, page.project
        self.records: list[Record] = []

    def show(self) -> None:
        """Build the section on the page, and read the records."""
        page = self.page
        file_input(say("app.records.drop"), "/upload", page.handler(self._taken))
        self.unused = ui.label().classes("fault").props('role="alert"')
        if samples():
            ui.button(say("app.records.samples"), on_click=page.handler(self._samples)).props("outline no-caps")
        self.state = ui.label().props('role="status"')
        self.table = ui.element("div").classes("wide")
        self.left = ui.element("div").classes("wide")
        self.files = ui.expansion(say("app.records.files")).classes("wide").props("dense")
        ui.timer(0.05, page.handler(self.read), once=True)

    def show_error(self, error: str) -> None:
        """Do nothing: errors of records are shown beside their files."""

    async def _taken(self, event: events.GenericEventArguments) -> None:
        self.page.sending = bool(event.args["sending"])
        if self.page.sending:
            self.state.text = say("app.records.copying", name=event.args["sending"])
        else:
            await self.read()
            refused(event.args["faults"])

    async def _samples(self) -> None:
        await self.page.after(run.io_bound(self.project.add_samples))
        await self.read()

    async def read(self) -> None:
        """Read all records again, and show them."""
        self.state.text = say("app.records.reading")
        found = await self.page.after(run.io_bound(self.project.read_records))
        self.records, failures = found or ([], [])
        rejected = await self.page.after(run.io_bound(self.project.rejected)) or []
        with self.page.words():
            self._show_records()
            self._show_left([*failures, *rejected])
            self._show_files()
        self.page.shown_error()
        if self.records:
            events = await self.page.after(run.io_bound(self.project.earthquakes, self.records, failures)) or 0
            with self.page.words():
                self.state.text = _counts(len(self.records), events)

    def _show_records(self) -> None:
        self.state.text = counted_words(len(self.records), "channel") if self.records else say("app.records.none")
        self.table.clear()
        if not self.records:
            return
        columns = [
            {
                "name": name,
                "label": say(f"app.column.{name}"),
                "field": name,
                "sortable": True,
                "align": "right" if name in NUMBERS else "left",
                **(
                    {":format": f"value => value.toPrecision(3).replace('.', '{say('decimal')}')"}
                    if name in NUMBERS
                    else {}
                ),
            }
            for name in COLUMNS
        ]
        with self.table:
            rows = [{"id": place, **_row(record)} for place, record in enumerate(self.records)]
            shown = Table(say("app.records.title"), columns, rows)
            shown.add_slot("body-cell-station", STATION.format(picture=say("app.records.picture")))
            shown.on("picture", self.page.handler(self._picture))
            ui.label(say("app.records.click")).classes("soft")

    async def _picture(self, event: events.GenericEventArguments) -> None:
        record = self.records[int(event.args)]
        with self.table, ui.dialog(value=True) as dialog, ui.card().classes("picture"):
            ui.label(f"{record.id}").classes("name")
            drawn = ui.html(say("app.records.drawing"), sanitize=False).classes("wide")
            ui.button(say("app.close"), on_click=dialog.close).props("flat no-caps")
        drawn.content = await self.page.after(run.io_bound(_drawn, record))

    def _show_left(self, failures: list[Failure]) -> None:
        self.left.clear()
        given = {str(path) for path in self.project.record_files()}
        left_out = [
            row
            for row in failures
            if row.kind in ("failed", "duplicate") or row.reason.count("; ") or row.file in given
        ]
        names = [*dict.fromkeys(last_part(row.file) for row in left_out)]
        self.unused.text = say("app.records.unused", files=listed(names)) if left_out else ""
        if not left_out:
            return
        with self.left:
            ui.html(say("app.records.left", count=len(left_out)), tag="h3")
            for row in left_out:
                with ui.element("div").classes(f"left {row.kind}"):
                    self._left(row)

    def _left(self, row: Failure) -> None:
        file, brief = last_part(row.place.rpartition(":")[0] or row.place), row.bare.partition("; ")[0]
        ui.label(f"{last_part(row.file)} ({say(f'left_out.{row.kind}')})").classes("name")
        ui.label(brief)
        remedies = [key for key, option in REMEDIES.items() if option in row.reason]
        match = last_part(row.file)
        for key in remedies:
            if key == "units":
                choice = ui.select([*UNITS], label=say("app.key.units")).props("dense outlined").classes("key")
                choice.on_value_change(self._remedy(match, key))
            elif key == "dt":
                typed = ui.input(f"{say('app.key.dt')} [s]").props("dense outlined inputmode=decimal").classes("key")
                typed.on("change", self._remedy(match, key, typed))
            else:
                place = row.place or file
                ui.button(say("app.records.confirm"), on_click=self._remedy(place, key)).props("outline no-caps dense")
        if row.bare != brief:
            with ui.expansion(say("app.records.why")).props("dense"):
                ui.label(row.bare).classes("pre")

    def _remedy(self, match: str, key: str, typed: Any = None) -> Any:
        async def set_value(event: Any) -> None:
            value = value_of(typed.value) if typed is not None else getattr(event, "value", True)
            if fault := self.project.remedy(match, key, value):
                self.project.load()
                raise ValueError(fault)
            await self.read()

        return self.page.handler(set_value)

    def _show_files(self) -> None:
        self.files.clear()
        paths = self.project.record_files()
        self.files.visible = bool(paths)
        columns = [{"name": name, "label": "", "field": "id", "align": "left"} for name in ("id", "remove")]
        with self.files:
            shown = Table(say("app.records.files"), columns, [{"id": path.name} for path in paths]).props("hide-header")
            shown.add_slot("body-cell-remove", REMOVE.format(remove=say("app.records.remove")))
            shown.on("remove", self.page.handler(self._remove))

    async def _remove(self, event: events.GenericEventArguments) -> None:
        self.project.remove(next(path for path in self.project.record_files() if path.name == event.args))
        await self.read()


def _counts(channels: int, events: int) -> str:
    """Return the numbers of channels and earthquakes as text, with the number needed for a verdict if it is larger."""
    from rockpulse.assessment.verdict import FEWEST_AT_DEMAND

    key = "app.records.few" if events < FEWEST_AT_DEMAND else "app.records.counts"
    words = {"channels": counted_words(channels, "channel"), "events": counted_words(events, "earthquake")}
    return say(key, **words, needed=FEWEST_AT_DEMAND)


def _row(record: Record) -> dict[str, Any]:
    when = record.origin_time or record.start_time
    vertical = f"({say('left_out.vertical')})" if record.orientation == "vertical" else ""
    return {
        "station": " ".join(filter(None, (record.network, record.station))) or record.id,
        "earthquake": record.event if words_of(record.event) else (in_dates(f"{when:%Y-%m-%d}") if when else ""),
        "direction": " ".join(filter(None, (record.component, vertical))),
        "pga": record.pga / STANDARD_GRAVITY,
        "pgv": pgv(record),
        "length": record.duration,
        "file": last_part(record.source),
    }


def _drawn(record: Record) -> str:
    """Return a picture (SVG) of a record, its intense phase and its half-waves."""
    from rockpulse.views.plots import plot, svg

    return f"{svg(plot(record))}<p>PGA {three_digits(record.pga / STANDARD_GRAVITY, 'g')}</p>"
