"""Facts about a record or a body as text; a missing fact is a dash, or an empty text if most records lack it."""

import json
import math
import re
from collections.abc import Callable
from typing import Any

import xarray as xr

from rocking.body.limits import radius_of_rectangle
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.record.rotation import rotated_component
from rockpulse.selection.events import UNKNOWN, words_of
from rockpulse.views.shared.formatting import ABSENT, six_digits, three_digits
from rockpulse.views.shared.words import counted_words, in_dates, numerals, say
from rockpulse.warning_text import has_warning, with_codes

#: Pattern of a date or year, and pattern of a magnitude, which are not repeated if the title contains them.
_DATED = re.compile(r"\b(?:19|20)\d\d\b|\b\d{1,2}[/-]\d{1,2}[/-]\d\d\b", re.ASCII)
_MEASURED = re.compile(r"\bM[A-Za-z]{0,2}\s?=?\s?\d", re.ASCII)


class RecordFacts:
    """The facts about one record; the method `value` returns a variable by name, or None if it is missing."""

    def __init__(self, value: Callable[[str], Any]) -> None:
        self.value = value

    def text(self, name: str) -> str:
        """Return a stored variable as text; empty if it is missing."""
        return str(self.value(name) or "").strip()

    def real(self, name: str) -> float:
        """Return a stored variable as a number; NaN if it is missing."""
        found = self.value(name)
        return math.nan if found is None else float(found)

    @property
    def described(self) -> str:
        """Return earthquake, station and direction of the record as text; empty if all of them are unknown."""
        station = f"{say('head.station')} {self.place}" if self.place else ""
        return ", ".join(filter(None, (self._earthquake, station, self.direction)))

    @property
    def _named(self) -> str:
        """Return the name of the earthquake; empty if the stored title is only a date or a number."""
        titles = (self.text("event_title"), self.text("event"))
        return next((title for title in titles if title != UNKNOWN and words_of(title)), "")

    @property
    def _earthquake(self) -> str:
        title, date, magnitude = self._named, in_dates(self.date), self.magnitude
        if title:
            more = ("" if _DATED.search(title) else date, "" if _MEASURED.search(title) else magnitude)
            return " ".join(filter(None, (title, *more)))
        if not date and not magnitude:
            return self.text("event_title")
        return f"{say('earthquake_of', date=date) if date else say('head.earthquake')} {magnitude}".rstrip()

    @property
    def title(self) -> str:
        """Return the name of the earthquake with its date; empty if the name is unknown."""
        title = self._named
        if not title or not self.date or _DATED.search(title):
            return title
        return say("earthquake_on", name=title, date=in_dates(self.date))

    @property
    def date(self) -> str:
        """Return the date of the earthquake or, if unknown, of the record [UTC, ISO 8601]; empty if unknown."""
        return (self.text("origin_time") or self.text("start_time"))[:10]

    @property
    def magnitude(self) -> str:
        """Return the magnitude of the earthquake with its scale, as stated in the file; empty if it is not stated."""
        magnitude = self.real("magnitude")
        if math.isnan(magnitude):
            return ""
        return f"{self.text('magnitude_type') or 'M'} {numerals(f'{magnitude:.2f}'.removesuffix('0'))}"

    @property
    def place(self) -> str:
        """Return code and name of the station; only one of them if the other is unknown."""
        code, name = self.text("station"), self.text("station_name").replace("_", " ")
        if not code.strip("0") or code.casefold() == name.casefold():
            code, name = name, ""
        return f"{code} ({name})" if name else code

    @property
    def direction(self) -> str:
        """Return the direction of the record in words or as an azimuth, or the component named in the file."""
        azimuth = self.real("azimuth")
        if math.isnan(azimuth):
            return self.text("component")
        line = {0.0: "north_south", 90.0: "east_west"}.get(azimuth % 180.0)
        words = say(f"direction.{line}") if line else say("direction.azimuth", angle=six_digits(azimuth))
        given = has_warning(self.text("warning_codes"), "direction_given")
        return say("direction.given", direction=words) if given else words


def facts_of(record: Record) -> RecordFacts:
    """Return the facts about a record that is not stored."""
    known = {"warning_codes": with_codes(record.warnings)[1], "event_title": record.event}
    return RecordFacts(lambda name: known[name] if name in known else getattr(record, name))


class Known(RecordFacts):
    """The facts about one record or body in the group /summary: ``Known(summary, record="a")``."""

    def __init__(self, summary: xr.Dataset, **labels: str) -> None:
        ((self._dim, label),) = labels.items()
        self._summary, self._row = summary, summary.get_index(self._dim).get_loc(label)
        super().__init__(self._value)

    def _value(self, name: str) -> Any:
        if name not in self._summary:
            return None
        return self._summary[name].variable[{self._dim: self._row}].values.item()

    def number(self, name: str, unit: str = "") -> str:
        """Return a stored variable as a number with its unit; a dash if it is missing."""
        found = self.value(name)
        return ABSENT if found is None else three_digits(float(found), unit)

    def words(self, name: str) -> str:
        """Return a stored variable as text; a dash if it is missing."""
        return str(self.value(name) or ABSENT)

    def lines(self, name: str) -> tuple[str, ...]:
        """Return the lines of a stored text, without empty lines."""
        return tuple(line for line in str(self.value(name) or "").split("\n") if line)

    @property
    def main_count(self) -> str:
        """Return the number of main impulses of the record as text, or "no limit"."""
        count = self.value("main_count")
        return say("fact.main_count") if count == -1 else str(count)

    @property
    def peak_velocity(self) -> str:
        """Return the PGV of the record in m/s, with a note if the baseline drifts."""
        pgv = self.number("pgv", "m/s")
        return say("fact.drift", pgv=pgv) if self.value("pgv_drift") else pgv

    @property
    def radius(self) -> str:
        """Return the radius R of the body in m, with a note if the body is not a rectangle."""
        text, width = self.number("radius", "m"), self.value("width")
        if text == ABSENT or width is None or not math.isnan(width):
            return text
        radius, p, gravity = (self.value(name) for name in ("radius", "p", "gravity"))
        rectangle = gravity is None or math.isclose(radius, radius_of_rectangle(p, gravity), rel_tol=1e-9)
        return say(f"fact.radius_of_{'rectangle' if rectangle else 'body'}", radius=text)

    @property
    def crushing(self) -> dict[str, str]:
        """Return depth of crushing, and critical angle with and without crushing, as texts; empty without crushing."""
        hinge = self.real("hinge_depth")
        if not hinge > 0.0:
            return {}
        alpha, radius = self.real("alpha_c"), self.real("radius")
        whole = math.atan2(radius * math.sin(alpha) + hinge, radius * math.cos(alpha))
        less = numerals(f"{100.0 * (alpha / whole - 1.0):.1f} %").replace("-", "−")
        words = {"alpha": three_digits(alpha, "rad"), "whole": three_digits(whole, "rad")}
        return words | {"hinge": three_digits(100.0 * hinge, "cm"), "less": less}

    @property
    def critical_angle(self) -> str:
        """Return the critical angle of the body, with a note on the crushing of its edge."""
        words = self.crushing
        return say("fact.crushed", **words) if words else self.number("alpha_c", "rad")

    @property
    def support(self) -> str:
        """Describe wall, restraints, floor, pedestal and friction of the body; empty if it has none of them."""
        found = []
        if self.value("one_sided"):
            facing = float(self.value("facing"))
            falls = "" if math.isnan(facing) else say("support.facing", angle=six_digits(facing))
            found.append(say("support.wall") + falls)
        if self.value("alpha_2") not in (None, self.value("alpha_c")) and not self.value("one_sided"):
            one, other = self.number("alpha_c", "rad"), self.number("alpha_2", "rad")
            found.append(say("support.corners", one=one, other=other))
        held = json.loads(str(self.value("restraints") or "{}"))
        found += [counted_words(len(held[name]), name[:-1]) for name in ("ties", "loads", "thrusts") if held.get(name)]
        if modes := json.loads(str(self.value("floors") or "[]")):
            found.append(say("support.floor", periods=", ".join(six_digits(one["period"]) for one in modes)))
        azimuth = self.value("body_azimuth")
        if azimuth is not None and not math.isnan(float(azimuth)) and float(azimuth) != self.value("facing"):
            found.append(say("support.azimuth", angle=six_digits(float(azimuth))))
        if self.value("pedestal_of"):
            found.append(say("support.pedestal", name=self.words("pedestal_of")))
        friction = self.value("friction")
        if friction is not None and not math.isnan(float(friction)):
            found.append(say("support.friction", friction=six_digits(friction)))
        return "; ".join(found)

    def impact_friction(self, c: float) -> float:
        """Return the ratio of horizontal to vertical impulse at an impact, h (1 - C)/(b_1 + C b_2).

        The ratio is 0 without friction or next to a wall. :func:`rocking.impact_friction` has the same formula.
        """
        friction = self.value("friction")
        if friction is None or math.isnan(float(friction)) or self.value("one_sided"):
            return 0.0
        radius, alpha = float(self.value("radius")), float(self.value("alpha_c"))
        left = float(self.value("radius_2")) * math.sin(float(self.value("alpha_2")))
        return radius * math.cos(alpha) * (1.0 - c) / (radius * math.sin(alpha) + c * left)

    @property
    def component(self) -> str:
        """Return the component named in the file or, if the record was rotated, its azimuth."""
        stated, azimuth = self.words("component"), self.real("azimuth")
        turned = not math.isnan(azimuth) and stated == rotated_component(azimuth)
        return say("direction.rotated", angle=six_digits(azimuth)) if turned else stated

    @property
    def stated(self) -> list[tuple[str, str]]:
        """Return names and values of the facts about earthquake and site that the record's file contains."""
        depth = self.real("hypocentre_depth")
        hypocentre = (
            self._coordinates("hypocentre"),
            "" if math.isnan(depth) else say("stated.depth", depth=three_digits(depth / 1000.0, "km")),
        )
        facts = {
            "agency": self.text("event_id"),
            "origin": in_dates(self.text("origin_time")),
            "magnitude": self.magnitude,
            "hypocentre": ", ".join(filter(None, hypocentre)),
            "distance": three_digits(self.real("epicentral_distance") / 1000.0, "km"),
            "place": self._coordinates("station"),
            "vs30": self.number("vs30", "m/s"),
            "site_class": self.text("site_class"),
        }
        return [(say(f"stated.{name}"), words) for name, words in facts.items() if words not in ("", ABSENT)]

    def _coordinates(self, of: str) -> str:
        """Return latitude and longitude of the station or the hypocentre as text; empty if unknown."""
        north, east = (self.real(f"{of}_{side}") for side in ("latitude", "longitude"))
        if math.isnan(north) or math.isnan(east):
            return ""
        signed = ((north, say("direction.north_south")), (east, say("direction.east_west")))
        return ", ".join(
            f"{numerals(f'{abs(angle):.5g}')}° {names[-1 if angle < 0.0 else 0]}" for angle, names in signed
        )

    @property
    def strength(self) -> list[str]:
        """Return PGA and PGV of the record as two texts."""
        return [f"PGA {three_digits(self.value('pga') / STANDARD_GRAVITY, 'g')}", f"PGV {self.peak_velocity}"]
