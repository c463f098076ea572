"""Contains the table of the intensity measures of a record; a new measure is added only here, as a row of the table."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.record import intensity
from rockpulse.record.record import STANDARD_GRAVITY, Record

if TYPE_CHECKING:
    from rocking.body.block import Block
    from rocking.march.demand import Demand
    from rockpulse.record.half_wave import HalfWaves

#: For each SI unit, the units in which values may be given (first the unit that is displayed) with factors to SI.
UNITS = {
    "m s^-2": {"m/s2": 1.0, "g": STANDARD_GRAVITY, "g/10": 0.1 * STANDARD_GRAVITY, "cm/s2": 0.01, "gal": 0.01},
    "m s^-1": {"m/s": 1.0, "cm/s": 0.01},
    "1": {"": 1.0},
}
#: Measures that the code uses by name: the PGA alone determines whether a body on the ground lifts, a drifting baseline
#: makes the PGV doubtful, and the reference makes bodies of all sizes comparable.
PGA, PGV, IMPULSE, REFERENCE = "pga", "pgv", "impulse", "velocity_ratio"
UPLIFT_RATIO = "uplift_ratio"
#: Number of largest lobes of E, the impulse on the time scale of the block, whose root mean square is a measure.
LARGEST_LOBES = 6


@dataclass(frozen=True)
class RecordOnBodies:
    """The input of a measure: a conditioned record, its half-waves, and (m,) bodies if the measure depends on them."""

    record: Record
    waves: Callable[[], HalfWaves]
    block: Any = None  # Block
    lifting: Any = None  # (m,) acceleration that lifts each body [m/s2]

    @classmethod
    def slender(cls, record: Record, waves: Callable[[], HalfWaves], block: Block) -> RecordOnBodies:
        """Return the input for a record and slender bodies, which lift at g tan(alpha_c)."""
        return cls(record, waves, block, np.asarray(block.gravity * np.tan(block.alpha_c)))

    @property
    def demand(self) -> Demand:
        """Return the demand of the record on the bodies; see :class:`rocking.march.demand.Demand`."""
        from rocking.march.demand import ground_demand  # compiled

        return ground_demand(self.block, self.record.acceleration, self.record.dt)


@dataclass(frozen=True)
class Measure:
    """An intensity measure, or a family with one measure for each period."""

    name: str
    unit: str  # in SI, as in the files of results
    title: str
    #: Function of a RecordOnBodies and, for a family, of the period [s]; returns a number or, for bodies, (m,) numbers.
    value: Callable[..., Any]
    detail: str = ""  # addition to the title in the long name
    uses: str = ""  # uses besides fragility, such as "demand hazard scaling"
    usual: float = math.inf  # largest value of a usual demand, in SI
    of_bodies: bool = False
    proportional: bool = True  # whether it is proportional to the scale factor on the record
    periods: tuple[float, ...] = ()  # periods of the members of a family [s]; empty for one measure
    drifts: bool = False  # whether a drifting baseline makes it doubtful
    openquake: str = ""  # unit of its values in OpenQuake's hazard curves; empty if they do not contain it
    stored: str | None = None  # addition to its meaning in /summary; None if it is not stored there
    meaning: str = ""  # description; by default the long name
    heading: str = ""  # heading in tables; by default the title
    explanation: str = ""  # text in docs/schema.md

    @property
    def long_name(self) -> str:
        """The title with its addition `detail`."""
        return f"{self.title}{self.detail}"

    @property
    def known_units(self) -> dict[str, float]:
        """The units in which values of the measure may be given, with factors to SI."""
        return UNITS.get(self.unit, {self.unit: 1.0})

    @property
    def shown_unit(self) -> str:
        """The SI unit in the form that users see."""
        return next(iter(self.known_units))

    @property
    def column(self) -> tuple[str, str, float]:
        """Return heading, unit and factor to SI for a column of a printed table, in which accelerations are in g."""
        unit = "g" if "g" in self.known_units else self.shown_unit
        return self.heading or self.title, unit, self.known_units[unit]

    def at(self, period: float | None) -> Measure:
        """Return the measure at a period [s], such as Sa(1 s); if `period` is None, the measure itself."""
        if period is None:
            return self
        name, title = f"{self.name}_{period:g}", f"{self.title}({period:g} s)"
        return replace(self, name=name, title=title, meaning="", value=partial(self.value, period=period), periods=())


def _rms_of_lobes(on: RecordOnBodies) -> np.ndarray:
    return np.asarray(np.sqrt(np.mean(on.demand.lobes[:, :LARGEST_LOBES] ** 2, axis=1)))


def _change_ratio(on: RecordOnBodies) -> np.ndarray:
    rates, place = np.unique(on.block.p, return_inverse=True)
    largest = np.array([intensity.largest_change(on.record, 2.0 / rate) for rate in rates])[place]
    return np.asarray(on.block.p * largest / on.lifting)


def _ratio(name: str, title: str, value: Callable[[RecordOnBodies], Any], **more: Any) -> Measure:
    return Measure(name, "1", title, value, of_bodies=True, **more)


_TABLE = (
    Measure(
        PGA,
        "m s^-2",
        "PGA",
        lambda on: on.record.pga,
        usual=2.0 * STANDARD_GRAVITY,
        meaning="peak ground acceleration",
        stored=" after conditioning",
        uses="demand hazard scaling",
        openquake="g",
    ),
    Measure(
        PGV,
        "m s^-1",
        "PGV",
        lambda on: intensity.pgv(on.record),
        usual=3.0,
        meaning="peak ground velocity",
        stored=" after conditioning, from rest at the first sample",
        uses="demand hazard scaling",
        openquake="cm/s",
        drifts=True,
    ),
    Measure(
        "arias_intensity",
        "m s^-1",
        "Arias intensity",
        lambda on: intensity.arias_intensity(on.record),
        heading="Arias",
        stored="",
        explanation="after conditioning",
        proportional=False,
    ),
    Measure(
        "si",
        "m s^-1",
        "SI",
        lambda on: intensity.spectrum_intensity(on.record),
        detail=" (mean pseudo-velocity, 0.1 to 2.5 s)",
        usual=5.0,
        meaning="Housner's intensity: mean pseudo-velocity, 0.1 to 2.5 s",
        uses="demand hazard",
    ),
    Measure("fajfar", "m s-3/4", "PGV t_D^(1/4), t_D = D5-95", lambda on: intensity.fajfar_index(on.record)),
    Measure(
        "sa",
        "m s^-2",
        "Sa",
        lambda on, period: intensity.spectral_acceleration(on.record, period),
        detail=", 5 %",
        usual=6.0 * STANDARD_GRAVITY,
        meaning="pseudo-acceleration at the period, 5 %",
        uses="demand hazard",
        periods=(0.5, 1.0, 2.0),
        openquake="g",
    ),
    _ratio(
        UPLIFT_RATIO,
        "PGA/(g tan alpha_c)",
        lambda on: on.record.pga / on.lifting,
        heading="uplift ratio",
        stored="",
        explanation="PGA divided by `uplift_acceleration`; for a body on a floor, the PGA of the floor",
    ),
    _ratio(
        REFERENCE,
        "p PGV/(g tan alpha_c)",
        lambda on: on.block.p * intensity.pgv(on.record) / on.lifting,
        stored="",
        uses="demand",
    ),
    _ratio(
        "si_ratio", "p SI/(g tan alpha_c)", lambda on: on.block.p * intensity.spectrum_intensity(on.record) / on.lifting
    ),
    _ratio("change_ratio", "p times the largest change of velocity within 2/p, over g tan alpha_c", _change_ratio),
    Measure(IMPULSE, "m s^-1", "largest half-wave impulse I", lambda on: on.waves().largest, uses="scaling"),
    _ratio("impulse_ratio", "I/I_1c", lambda on: on.waves().largest / on.block.critical_impulse),
    _ratio("demand_largest", "largest p abs(E)/(g tan alpha_c)", lambda on: on.demand.largest),
    _ratio("demand_rms", "root mean square of the six largest lobes of p abs(E)/(g tan alpha_c)", _rms_of_lobes),
    _ratio(
        "demand_cubic",
        "cube root of the sum of the cubes of the lobes of p abs(E)/(g tan alpha_c)",
        lambda on: np.cbrt(np.sum(on.demand.lobes**3, axis=1)),
    ),
    _ratio(
        "demand_build_up",
        "sum of (0.9 C)^k times the k-th largest lobe of p abs(E)/(g tan alpha_c), k = 0 to 15",
        lambda on: on.demand.build_up,
    ),
)
#: All rows of the table by name; all measures by name, in which each family is replaced by its members.
ROWS = {row.name: row for row in _TABLE}
MEASURES = {one.name: one for row in _TABLE for one in (map(row.at, row.periods) if row.periods else [row])}
#: Names of the measures for each use. A demand names a family, such as "sa", and states the period separately.
FRAGILITY = tuple(name for name, one in MEASURES.items() if one.proportional)
#: Measures of [fragility] by default.
USUAL = (PGA, PGV, "si", REFERENCE)
HAZARD, SCALING = (tuple(name for name, one in MEASURES.items() if use in one.uses) for use in ("hazard", "scaling"))
DEMAND = tuple(name for name, row in ROWS.items() if "demand" in row.uses)
PERIODIC = tuple(name for name in DEMAND if ROWS[name].periods)
#: Measures stored for each record; measures among them that are proportional to the scale factor; measures stored for
#: each record and body.
STORED = tuple(row for row in _TABLE if row.stored is not None and not row.of_bodies)
STORED_LEVELS = tuple(row for row in STORED if row.proportional)
STORED_OF_BODIES = tuple(row for row in _TABLE if row.stored is not None and row.of_bodies)


def units_in_words(names: tuple[str, ...]) -> str:
    """Return the units of the named measures as text: "m/s2 (pga) or m/s (pgv, impulse)"."""
    units = dict.fromkeys(ROWS[name].shown_unit for name in names)
    choices = [f"{unit or 1} ({', '.join(name for name in names if ROWS[name].shown_unit == unit)})" for unit in units]
    return _either(choices)


def quoted(names: tuple[str, ...]) -> str:
    """Return the names in quotation marks, with "or" before the last."""
    return _either([f'"{name}"' for name in names])


def _either(words: list[str]) -> str:
    return " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
