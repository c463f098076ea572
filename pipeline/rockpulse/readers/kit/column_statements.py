"""Finds the direction, the unit and the stated peak of the columns of a table."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from rockpulse.errors import Remedy, UnitError
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.kit.checks import held_direction
from rockpulse.readers.kit.direction import Direction, heading_direction, name_direction
from rockpulse.readers.kit.headings import ColumnHeading
from rockpulse.readers.kit.prose import other_units, positive_downwards, stated_direction, stated_peaks, stated_units
from rockpulse.readers.kit.text import GIVE_UNIT, UNITS, canonical_unit, printed_number, spelled_unit
from rockpulse.readers.source import SourceFile
from rockpulse.warning_text import WarningText

_HALF_TURN = 180.0  # degrees between two opposite directions


def column_directions(file: SourceFile, headings: Sequence[ColumnHeading], prose: Sequence[str]) -> list[Direction]:
    """Return the direction of each column from its heading; for a single column also from header text and file name."""
    found = [heading_direction(heading.name) for heading in headings]
    if len(found) == 1:
        for own, text in ((stated_direction(prose), "header text"), (name_direction(file), "name of the file")):
            note = f"the {text} says {own.label}, but another statement says {found[0].label}; the direction is unknown"
            upright = "vertical" in (own.orientation, found[0].orientation)
            found = [held_direction(found[0], own, note)]
            if upright and found[0].orientation == "unknown":
                found = [replace(found[0], orientation="vertical")]
    if positive_downwards(prose):
        found = [replace(one, sign=-1.0) if one.orientation == "vertical" else one for one in found]
    return found


def same_directions(headings: Sequence[ColumnHeading], facing: Sequence[Direction]) -> list[str]:
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
    for said in stated_peaks(prose)[:1]:
        value, rounding = printed_number(said.text)
        if not value > 0.0 or (said.unit and spelled_unit(said.unit) not in UNITS):
            return {}
        factors = [UNITS[spelled_unit(said.unit) if said.unit else unit] for unit in units]
        found = np.max(np.abs(table), axis=0) * [UNITS[unit] for unit in units]
        with np.errstate(divide="ignore"):
            nearest = int(np.argmin(np.abs(np.log(found / (value * np.array(factors))))))
        peaks[nearest + 1] = {"header_peak": (value, rounding), "peak_factor": factors[nearest]}
    return peaks


def column_units(name: str, headings: Sequence[ColumnHeading], prose: Sequence[str], options: ReadOptions) -> list[str]:
    """Return the unit of each column; raise UnitError if it is missing, or if header and options differ."""
    units = []
    for other in other_units(prose):
        found = f"the header states the unit {other.wording!r}, which is not one of acceleration"
        raise UnitError(f"{name}:{other.line}: {found}; convert the samples to {' or '.join(UNITS)} first")
    said = [(canonical_unit(unit.wording, f"{name}:{unit.line}"), unit) for unit in stated_units(prose)]
    named = [(unit, line) for unit, line in said if line.value]
    asked = None if options.units is None else canonical_unit(options.units, "option units")

    def against(found: str, stated: str) -> UnitError:
        remedy = Remedy("units", (stated,))
        right = f"--units {stated}, or in the configuration:\n" + remedy.lines(name, f'"{stated}"')
        wrong = f"{options.said_by('units')} says {asked}; correct the wrong one; if the header is right, give {right}"
        return UnitError(f"{found}, but {wrong}", remedy)

    for heading in headings:
        where = f"{name}: column {heading.name!r}"
        stated = canonical_unit(heading.unit, where) if heading.unit else None
        for further in heading.others:
            if stated and UNITS.get(spelled_unit(further)) != UNITS[stated]:
                two = f"the heading states two units, {heading.unit} and {further}"
                raise UnitError(f"{where}: {two}; correct the wrong one")
        for unit, line in named:
            wrong = stated or named[0][0]
            if UNITS[unit] != UNITS[wrong] and (stated or not asked):
                whose = f"the column {heading.name!r}" if stated else f"line {named[0][1].line}"
                found = f"the header states the unit {line.wording!r}, but {whose} says {wrong}"
                raise UnitError(f"{name}:{line.line}: {found}; correct the wrong one")
        if stated is None and asked is None and named:
            stated = named[0][0]
        if stated is None and asked is None:
            found = f"; line {said[0][1].line} of its header mentions {said[0][1].wording!r}" if said else ""
            lacking = f"{name}: plain columns do not state their unit{found}; {GIVE_UNIT.advice(name)}"
            raise UnitError(lacking, GIVE_UNIT)
        if stated and asked and UNITS[stated] != UNITS[asked]:
            raise against(f"{name}: the heading of column {heading.name!r} states {stated}", stated)
        if asked and not stated and said and all(UNITS[unit] != UNITS[asked] for unit, _ in said):
            raise against(f"{name}:{said[0][1].line}: the header says {said[0][1].wording!r}", said[0][0])
        units.append(asked or stated or "")
    return units
