"""The effect of one record on every body, before it becomes rows of the results."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.response import Response
from rocking.search.factors import ScaleIntervals
from rocking.spectrum.overturning import OverturningSpectrum
from rockpulse.assessment.spectra import spectrum_values
from rockpulse.config.bodies import Bodies
from rockpulse.config.configuration import Config
from rockpulse.model_row import Scene
from rockpulse.record.record import Record
from rockpulse.storage.variables.probability import AXIS_SIZES, SPECTRUM


class Rows(NamedTuple):
    """The rows that one model gives to a table of the results."""

    model: int  # its place in /summary
    lane: np.ndarray  # of each row, and below the body and the restitution case that the lane stands for
    block: np.ndarray
    case: np.ndarray
    source: Any  # what the columns are taken from
    cycle: np.ndarray  # in a table of half-cycles the number of each, from 0


@dataclass(frozen=True, eq=False)
class RecordAssessment:
    """The effect of one record on every body: the stored variables are taken from this (`take` of their declarations).

    Lanes are bodies times restitution cases, the cases of one body next to each other.
    """

    scene: Scene  # the conditioned record and what was extracted from it
    bodies: Bodies
    config: Config
    responses: dict[str, Response]  # by model, of all lanes, and so are the following
    scales: dict[str, ScaleIntervals]
    applicable: dict[str, np.ndarray]
    probability: dict[str, np.ndarray]  # of overturning, by variable, of all lanes
    strength: dict[str, np.ndarray]  # of the motion over that of the bodies, by variable, of all lanes
    spectrum: OverturningSpectrum | None = None  # None where no body is read from it
    shaken: bool = True  # False where a sequence of impulses stands in place of a record

    @property
    def record(self) -> Record:
        """The conditioned record."""
        return self.scene.record

    @cached_property
    def spectra(self) -> dict[str, np.ndarray]:
        """The variables of the overturning spectrum; NaN at frequency parameters that no body is read at."""
        found = {
            name: np.full([AXIS_SIZES[dim] for dim in variable.dims], np.nan) for name, variable in SPECTRUM.items()
        }
        if self.spectrum is not None:
            places = np.searchsorted(RATES, self.spectrum.p)
            for name, values in spectrum_values(self.spectrum).items():
                np.moveaxis(found[name], SPECTRUM[name].dims.index("p"), 0)[places] = np.moveaxis(
                    values, SPECTRUM[name].dims.index("p"), 0
                )
        return found

    @property
    def sequence(self) -> ImpulseSequence | None:
        """The calibrated sequence; None where the record gave none, or every body has one of its own."""
        sequence = self.scene.sequence
        return None if sequence is None or sequence.shape else sequence

    def per_lane(self, values: np.ndarray) -> np.ndarray:
        """(b x c, ...) values as (b, c, ...)."""
        return values.reshape(len(self.bodies.names), self.bodies.cases, *values.shape[1:])

    def per_model(self, values: Callable[[str], Any]) -> np.ndarray:
        """(b x c, ...) values of each of k models as (b, c, k, ...)."""
        return self.per_lane(np.stack([np.asarray(values(model)) for model in self.responses], axis=1))

    def half_cycles(self, column: Callable[[Rows], np.ndarray]) -> np.ndarray:
        """A column of the half-cycles of all models that have a table of them."""
        return _joined(map(column, self._half_cycles))

    def intervals(self, column: Callable[[Rows], np.ndarray]) -> np.ndarray:
        """A column of the intervals of overturning of all models."""
        return _joined(map(column, self._intervals))

    def histories(self, column: Callable[[Rows], np.ndarray]) -> np.ndarray:
        """A column of the lanes of all models that have histories."""
        return _joined(map(column, self._histories))

    @cached_property
    def _half_cycles(self) -> list[Rows]:
        found = []
        for place, response in enumerate(self.responses.values()):
            table = response.half_cycles
            if table is not None:
                lane, cycle = np.nonzero(np.isfinite(table.start_velocity).T)
                found.append(self._rows(place, lane, table, cycle))
        return found

    @cached_property
    def _intervals(self) -> list[Rows]:
        return [self._rows(place, one.lane, one) for place, one in enumerate(self.scales.values())]

    @cached_property
    def _histories(self) -> list[Rows]:
        lanes = np.arange(len(self.bodies.names) * self.bodies.cases)
        return [
            self._rows(place, lanes, response)
            for place, response in enumerate(self.responses.values())
            if response.rotation is not None and response.velocity is not None
        ]

    def _rows(self, model: int, lane: np.ndarray, source: Any, cycle: np.ndarray | None = None) -> Rows:
        cases = self.bodies.cases
        return Rows(model, lane, lane // cases, lane % cases, source, np.zeros(0, int) if cycle is None else cycle)


def _joined(parts: Iterable[np.ndarray]) -> np.ndarray:
    found = list(parts)
    return np.concatenate(found) if found else np.zeros(0)
