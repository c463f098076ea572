"""Finds the direction, the unit and the stated peak of the columns of a table."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from rockpulse.errors import Remedy, UnitError
from rockpulse.readers import kit
from rockpulse.readers.format import ReadOptions
from rockpulse.warning_text import WarningText

_HALF_TURN = 180.0  # degrees between two opposite directions


def column_directions(
    file: kit.SourceFile, headings: Sequence[kit.ColumnHeading], prose: Sequence[str]
) -> list[kit.Direction]:
    """Return the direction of each column from its heading; for a single column also from header text and file name."""
    found = [kit.heading_direction(heading.name) for heading in headings]
    if len(found) == 1:
        for own, text in ((kit.stated_direction(prose), "header text"), (kit.name_direction(file), "name of the file")):
            note = f"the {text} says {own.label}, but another statement says {found[0].label}; the direction is unknown"
            upright = "vertical" in (own.orientation, found[0].orientation)
            found = [kit.held_direction(found[0], own, note)]
            if upright and found[0].orientation == "unknown":
                found = [replace(found[0], orientation="vertical")]
    if kit.positive_downwards(prose):
        found = [replace(one, sign=-1.0) if one.orientation == "vertical" else one for one in found]
    return found


def same_directions(headings: Sequence[kit.ColumnHeading], facing: Sequence[kit.Direction]) -> list[str]:
    """Return a warning for every two columns along the same axis, such as N and S."""
    notes: list[str] = []
    named = [(heading.name, one) for heading, one in zip(headings, facing, strict=True) if one.orientation != "unknown"]
    for (first, one), (second, other) in combinations(named, 2):
        turn = (one.azimuth - other.azimuth) % _HALF_TURN
        if one.orientation == other.orientation and (one.orientation == "vertical" or turn == 0.0):
            notes.append(WarningText("same_direction", first=repr(first), second=repr(second)))
    return notes


def stated_peak(table: np.ndarray, units: Sequence[str], prose: Sequence[str]) -> dict[int, dict[str, Any]]:
    """Return the stated peak as arguments of `build_record`, by the number (from 1) of the column that it fits best."""
    peaks: dict[int, dict[str, Any]] = {}
    for said in kit.stated_peaks(prose)[:1]:
        value, rounding = kit.printed_number(said.text)
        if not value > 0.0 or (said.unit and kit.spelled_unit(said.unit) not in kit.UNITS):
            return {}
        factors = [kit.UNITS[kit.spelled_unit(said.unit) if said.unit else unit] for unit in units]
        found = np.max(np.abs(table), axis=0) * [kit.UNITS[unit] for unit in units]
        with np.errstate(divide="ignore"):
            nearest = int(np.argmin(np.abs(np.log(found / (value * np.array(factors))))))
        peaks[nearest + 1] = {"header_peak": (value, rounding), "peak_factor": factors[nearest]}
    return peaks


def column_units(
    name: str, headings: Sequence[kit.ColumnHeading], prose: Sequence[str], options: ReadOptions
) -> list[str]:
    """Return the unit of each column; raise UnitError if it is missing, or if header and options differ."""
    units = []
    for other in kit.other_units(prose):
        found = f"the header states the unit {other.wording!r}, which is not one of acceleration"
        raise UnitError(f"{name}:{other.line}: {found}; convert the samples to {' or '.join(kit.UNITS)} first")
    said = [(kit.canonical_unit(unit.wording, f"{name}:{unit.line}"), unit) for unit in kit.stated_units(prose)]
    named = [(unit, line) for unit, line in said if line.value]
    asked = None if options.units is None else kit.canonical_unit(options.units, "option units")

    def against(found: str, stated: str) -> UnitError:
        remedy = Remedy("units", (stated,))
        right = f"--units {stated}, or in the configuration:\n" + remedy.lines(name, f'"{stated}"')
        wrong = f"{options.said_by('units')} says {asked}; correct the wrong one; if the header is right, give {right}"
        return UnitError(f"{found}, but {wrong}", remedy)

    for heading in headings:
        where = f"{name}: column {heading.name!r}"
        stated = kit.canonical_unit(heading.unit, where) if heading.unit else None
        for further in heading.others:
            if stated and kit.UNITS.get(kit.spelled_unit(further)) != kit.UNITS[stated]:
                two = f"the heading states two units, {heading.unit} and {further}"
                raise UnitError(f"{where}: {two}; correct the wrong one")
        for unit, line in named:
            wrong = stated or named[0][0]
            if kit.UNITS[unit] != kit.UNITS[wrong] and (stated or not asked):
                whose = f"the column {heading.name!r}" if stated else f"line {named[0][1].line}"
                found = f"the header states the unit {line.wording!r}, but {whose} says {wrong}"
                raise UnitError(f"{name}:{line.line}: {found}; correct the wrong one")
        if stated is None and asked is None and named:
            stated = named[0][0]
        if stated is None and asked is None:
            found = f"; line {said[0][1].line} of its header mentions {said[0][1].wording!r}" if said else ""
            lacking = f"{name}: plain columns do not state their unit{found}; {kit.GIVE_UNIT.advice(name)}"
            raise UnitError(lacking, kit.GIVE_UNIT)
        if stated and asked and kit.UNITS[stated] != kit.UNITS[asked]:
            raise against(f"{name}: the heading of column {heading.name!r} states {stated}", stated)
        if asked and not stated and said and all(kit.UNITS[unit] != kit.UNITS[asked] for unit, _ in said):
            raise against(f"{name}:{said[0][1].line}: the header says {said[0][1].wording!r}", said[0][0])
        units.append(asked or stated or "")
    return units
