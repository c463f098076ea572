"""The inputs of one section of the configuration, with units; an error is shown at the input that it concerns."""

import re
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from nicegui import ui

from rockpulse.config.study_settings import HAZARD_UNITS
from rockpulse.option import Section
from rockpulse.record.measures import MEASURES
from rockpulse.views.shared.words import error_words, numerals, say, section


def plain_error(error: str) -> str:
    """Return an error of the configuration in plain words of the current language, with names of body and inputs."""
    found = re.fullmatch(r'\[+[\w.]+\]+ ?(".*?" ?|)(.*?): (.*)', error, re.DOTALL)
    if found is None:
        return error_words(error)
    labels = section("app.key")
    named = found[1] + ", ".join(labels.get(key, key) for key in found[2].split(", "))
    return f"{named.strip()}: {error_words(found[3])}".removeprefix(": ")


def value_of(text: str | None) -> Any:
    """Convert a typed text to a value: a number (with point or comma), a text, or None for an empty input."""
    typed = (text or "").strip()
    try:
        return int(typed) if typed.isdecimal() else float(typed.replace(",", ".")) if typed else None
    except ValueError:
        return typed


def text_of(value: Any) -> str:
    """Return the text that an input shows for a value."""
    if isinstance(value, int | float):
        return numerals(f"{value:g}")
    return "" if value is None else str(value)


class Fields:
    """The inputs of one section: a change is stored in `values` by its TOML key; then `changed` is called."""

    def __init__(self, cls: type[Section], values: dict[str, Any], changed: Callable[[], object]) -> None:
        self.cls, self.values, self.changed = cls, values, changed
        self.items = {item.name: item for item in fields(cls)}
        self.inputs: dict[str, Any] = {}

    def add(self, *names: str, texts: tuple[str, ...] = ("name",)) -> "Fields":
        """Add an input for each key: a choice, a check box or a text field; in `texts`, typed numbers remain text."""
        for name in names:
            item = self.items[name]
            allowed = item.metadata["values"]
            label = say(f"app.key.{name}") + (f" [{allowed.unit}]" if allowed.unit else "")
            given = self.values.get(name)
            if "bool" in str(item.type):
                made: Any = ui.checkbox(label, value=bool(given), on_change=self._changing(name, lambda value: value))
            elif allowed.words and "float" not in str(item.type):
                measures = {word: MEASURES[word].title for word in allowed.words if word in MEASURES}
                units = {word: word for word in allowed.words if word in HAZARD_UNITS}
                named = measures | units
                options = {word: named.get(word) or say(f"app.word.{word}") for word in allowed.words}
                shown = item.default if given is None else given
                made = ui.select(options, label=label, value=shown, on_change=self._changing(name, lambda value: value))
            else:
                read = (lambda value: value or None) if name in texts else value_of
                made = ui.input(label, value=text_of(given), on_change=self._changing(name, read))
                made.without_auto_validation()  # the configuration validates
            made.classes("key").mark(name).props("dense outlined")
            if allowed.finite:
                made.props("inputmode=decimal")
            self.inputs[name] = made
        return self

    def _changing(self, name: str, read: Callable[[Any], Any]) -> Callable[[Any], None]:
        def change(event: Any) -> None:
            value = read(event.value)
            if value in (None, False) or value == self.items[name].default:
                self.values.pop(name, None)
            else:
                self.values[name] = value
            self.changed()

        return change

    def show(self, error: str) -> bool:
        """Show an error at the input of the key that it names; return whether such an input exists."""
        inputs = {name: made for name, made in self.inputs.items() if hasattr(made, "error") and not made.is_deleted}
        words = re.findall(r"[a-z_0-9]+", error.partition(": ")[0])
        at = next((word for word in reversed(words) if word in inputs), "")
        for name, made in inputs.items():
            made.error = error_words(error.partition(f"{name}: ")[2] or error) if name == at else None
        return bool(at)
