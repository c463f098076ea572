"""Sections of the configuration for studies: [uncertainty], [selection], [fragility], [hazard], [check], [report]."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

from rockpulse.config.settings import GROUND, misplaced
from rockpulse.errors import ConfigError
from rockpulse.files import check_regular
from rockpulse.model_table import EQUATIONS
from rockpulse.option import KeyType, Section, boolean, choice, choices, count, is_number, key, number, text
from rockpulse.record.measures import FRAGILITY, HAZARD, MEASURES, PGA, REFERENCE, USUAL

if TYPE_CHECKING:
    from rocking.spectrum.probability import Uncertainty

#: Names of the limit states that are not rotations.
UPLIFT, OVERTURNING = "uplift", "overturning"
DATA = ("stripes", "ida", "cloud")
MODELS = ("lognormal", "logistic")
#: Allowed units of the values of each measure in a hazard curve.
HAZARD_UNITS = tuple(dict.fromkeys(unit for name in HAZARD for unit in MEASURES[name].known_units))
#: Largest logo [bytes]: it is stored as text in an attribute of the results file, which HDF5 limits to 64 kB.
LOGO_LIMIT = 45_000
#: Number of values that represent a normal distribution; distance of the largest value from the mean, with which linear
#: interpolation between the values has the stated deviation; smallest distance of the mean from 0 and from 2. Both
#: distances are in standard deviations.
VALUES, LARGEST_VALUE, MOST_DEVIATIONS = 65, 2.89, 3.0
#: First bytes of every PNG file.
PNG = b"\x89PNG\r\n\x1a\n"


def _are_numbers(value: Any, count: int = 0) -> bool:
    """Return whether a value is a list of positive numbers: exactly `count` or, if `count` is 0, at least one."""
    numbers = isinstance(value, (list, tuple)) and all(is_number(item) and item > 0.0 for item in value)
    return numbers and (len(value) == count if count else bool(value))


def _ascend(value: Any, count: int = 0) -> bool:
    return _are_numbers(value, count) and all(low < high for low, high in pairwise(value))


def _floats(value: Any) -> tuple[float, ...]:
    return tuple(map(float, value))


def _is_limit_states(value: Any) -> bool:
    if not isinstance(value, (list, tuple)) or not value:
        return False
    known = all(
        item in (UPLIFT, OVERTURNING) if isinstance(item, str) else is_number(item) and 0.0 < item <= 1.0
        for item in value
    )
    return known and len(set(value)) == len(value)


def _by_severity(value: Any) -> tuple[str | float, ...]:
    levels = sorted(float(item) for item in value if not isinstance(item, str))
    return (*(item for item in value if item == UPLIFT), *levels, *(item for item in value if item == OVERTURNING))


def _is_distribution(value: Any) -> bool:
    if isinstance(value, Mapping):
        known = set(value) == {"mean", "deviation"} and _are_numbers([*value.values()])
        return (
            known and MOST_DEVIATIONS * value["deviation"] < value["mean"] <= 2.0 - MOST_DEVIATIONS * value["deviation"]
        )
    return _are_numbers(value) and len(value) >= 2 and max(value) <= 2.0 and (len(value) > 2 or value[0] <= value[1])


def _distribution(value: Any) -> tuple[float, ...]:
    """Return a distribution as the two limits of a uniform one, or as three or more equally likely values."""
    if not isinstance(value, Mapping):
        return _floats(sorted(value))
    normal, end = NormalDist(value["mean"], value["deviation"]), LARGEST_VALUE * value["deviation"]
    inner = (normal.inv_cdf(k / (VALUES - 1)) for k in range(1, VALUES - 1))
    return (normal.mean - end, *inner, normal.mean + end)


_RANGE = KeyType(
    "values of C divided by the nominal C, above 0 and at most 2: [lowest, highest] of a uniform distribution, three "
    "or more measured values, or {mean = 0.98, deviation = 0.03} of a normal distribution",
    _is_distribution,
    _distribution,
)
_LIMIT_STATES = KeyType(
    'a list of "uplift", numbers in (0, 1] (rotations over alpha_c) and "overturning", each once',
    _is_limit_states,
    _by_severity,
    (UPLIFT, OVERTURNING),
)
_FACTORS = KeyType(
    "two positive numbers [lowest, highest] in ascending order", lambda value: _ascend(value, 2), _floats
)
_TOLERANCE = KeyType(
    "two positive numbers [below, above], fractions of the target", lambda value: _are_numbers(value, 2), _floats
)
_LEVELS = KeyType("a list of positive numbers in ascending order", _ascend, _floats)


@dataclass(frozen=True)
class UncertaintySettings(Section):
    """The uncertainties in the probability of overturning, and whether this probability is computed.

    The probability is computed only with the nonlinear model. `restitution` has values of C divided by the nominal C:
    two limits of a uniform distribution, three or more measured values, or mean and deviation of a normal distribution.

    >>> rp.UncertaintySettings(restitution=(0.85, 0.95)).of_draws()
    Uncertainty(restitution=(0.85, 0.95))
    """

    heading = "[uncertainty]"
    probability: bool = boolean(True)
    factor: float = number(0.10, low=0.02, high=1.0)  # the limits of the solver
    restitution: tuple[float, ...] = key((0.95, 1.05), _RANGE)
    geometry: float = number(0.05, low=0.0, high=1.0)
    azimuth: bool = boolean(False)
    spectrum: str = choice("auto", ("auto", "none", "all"))

    def of_draws(self) -> Uncertainty:
        """Return the uncertainties as a :class:`rocking.Uncertainty`."""
        from rocking.spectrum.probability import Uncertainty

        return Uncertainty(factor=self.factor, restitution=self.restitution, geometry=self.geometry)


@dataclass(frozen=True)
class SelectionSettings(Section):
    """Number and bounds of the records that :func:`rockpulse.select` chooses, and the target of their mean spectrum.

    Attributes
    ----------
    target : str or None
        Table "period [s],sa [g]" for 5 % damping, such as a uniform hazard spectrum; None: the spectrum of [check].
    records : int
        Number of records, or of pairs.
    periods : (2,) tuple of float
        Shortest and longest period at which the mean is compared with the target [s].
    factors : (2,) tuple of float
        Bounds of the scale factors [-].
    per_earthquake : int
        Largest number of records, or of pairs, of one earthquake.
    tolerance : (2,) tuple of float
        Largest deviation of the mean below and above the target, as fractions of the target.
    components : str
        "channels", or "pairs": both channels of an instrument with one scale factor.

    Examples
    --------
    >>> rp.SelectionSettings(factors=[2.0, 0.5])
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [selection] factors: expected two positive numbers [lowest, highest]...
    """

    heading = "[selection]"
    target: str | None = text(None)
    records: int = count(7, low=1, high=1000)
    periods: tuple[float, float] = key((0.15, 2.0), _FACTORS)
    factors: tuple[float, float] = key((0.25, 4.0), _FACTORS)
    per_earthquake: int = count(1, low=1)
    tolerance: tuple[float, float] = key((0.1, 0.3), _TOLERANCE)
    components: str = choice("channels", ("channels", "pairs"))


@dataclass(frozen=True)
class FragilitySettings(Section):
    """Limit states, measures and fits of :func:`rockpulse.fragility`.

    `selection` is a table of records selected by other software, with scale factors or values of the measure, and
    weights; it replaces `stripe_levels`, `factors` and `pga_min`.

    Raises
    ------
    ConfigError
        If `selection` is given and `data` is not "stripes".

    Examples
    --------
    >>> rp.FragilitySettings(limit_states=[2.0])
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [fragility] limit_states: expected a list of "uplift", numbers in...
    """

    heading = "[fragility]"
    limit_states: tuple[str | float, ...] = key((UPLIFT, 0.1, 0.4, 0.6, 1.0, OVERTURNING), _LIMIT_STATES)
    measures: tuple[str, ...] = choices(USUAL, FRAGILITY)
    pga_min: float = number(1.0, low=0.0, unit="m/s2")
    data: str = choice("stripes", DATA)
    stripe_measure: str = choice(REFERENCE, FRAGILITY)
    stripe_levels: tuple[float, ...] = key((0.15, 0.25, 0.4, 0.6, 0.9, 1.4), _LEVELS)
    factors: tuple[float, float] = key((0.25, 4.0), _FACTORS)
    selection: str | None = text(None)
    model: str = choice("lognormal", MODELS)
    overturning_model: str = choice("logistic", MODELS)
    confidence: float = number(0.9, low=0.5, high=0.999)
    equation: str = choice(EQUATIONS[0], EQUATIONS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.selection is not None and self.data != "stripes":
            raise ConfigError(
                f'[fragility] selection: expected data = "stripes", found data = "{self.data}"; change data, or remove '
                "selection"
            )


@dataclass(frozen=True)
class HazardSettings(Section):
    """The hazard of the site, as a file of hazard curves or a power law k0 x^-k, and the exposure time.

    `longitude` and `latitude` select the site in a file of several sites. `measure` and `unit` (by default SI) apply to
    the power law; a file states both. `soil_factor` converts values of the measure on rock to values on the ground of
    the site; the default is S of [site] ag and ground, or 1.

    Raises
    ------
    ConfigError
        If both a file and a power law are given, or only one of k0 and k, or only one of longitude and latitude.

    Examples
    --------
    >>> rp.HazardSettings(k0=1e-4)
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [hazard] k0, k: the power law k0 x^-k needs both keys, found one; give the other
    """

    heading = "[hazard]"
    file: str | None = text(None)
    longitude: float | None = number(None, low=-180.0, high=360.0, unit="degrees")
    latitude: float | None = number(None, low=-90.0, high=90.0, unit="degrees")
    k0: float | None = number(None, low=0.0, above=True, unit="1/year")
    k: float | None = number(None, low=0.0, above=True)
    measure: str = choice(PGA, HAZARD)
    unit: str | None = choice(None, HAZARD_UNITS)
    soil_factor: float | None = number(None, low=0.0, above=True)
    years: float = number(50.0, low=0.0, above=True, unit="years")

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.k0 is None) != (self.k is None):
            raise ConfigError("[hazard] k0, k: the power law k0 x^-k needs both keys, found one; give the other")
        if self.file is not None and self.k0 is not None:
            raise ConfigError("[hazard]: expected a file or the power law k0, k, found both; remove one of them")
        if (self.longitude is None) != (self.latitude is None):
            raise ConfigError("[hazard] longitude, latitude: expected both or neither, found one; give the other")

    @property
    def soil(self) -> float:
        """The soil factor S; 1 if none is given."""
        return 1.0 if self.soil_factor is None else self.soil_factor


@dataclass(frozen=True)
class CheckSettings(Section):
    """The elastic spectrum of a code in one limit state, and the factors of the checks.

    Attributes
    ----------
    spectrum : str
        "ntc": NTC 2018, 3.2.3.2.1; "en_1998_1" and "en_1998_2": EN 1998-1, 3.2.2.2, types 1 and 2; "table": `file`.
    ag : float or None
        Peak acceleration on rock [g] in the limit state that is checked, including the importance factor.
    f0, tc_star : float or None
        F_0 [-] and T_C* [s] of an NTC spectrum.
    ground, topography : str
        Ground type, and topographic category of NTC.
    file : str or None
        Table "period [s],sa [g]" from a period of 0, at which sa is the peak ground acceleration on soil.
    limit_state : str
        Limit state of Circolare 7/2019: "slv" or "slc".
    q, confidence_factor : float
        Behaviour factor of the linear checks, and confidence factor FC: the value for knowledge level LC1, unless the
        multiplier accounts for crushing of the masonry (Circolare 7/2019, C8.7.1.2.1.3).
    q_a, gamma_a : float
        Behaviour factor and importance factor of a non-structural element (EN 1998-1, 4.3.5).

    Raises
    ------
    ConfigError
        If "table" has no file, a file is given without "table", or parameters of the spectrum are missing.

    Examples
    --------
    >>> rp.CheckSettings(spectrum="en_1998_1", ag=0.15, ground="B").confidence_factor
    1.35
    """

    heading = "[check]"
    spectrum: str = choice("ntc", ("ntc", "en_1998_1", "en_1998_2", "table"))
    ag: float | None = number(None, low=0.0, above=True, high=5.0, unit="g")
    f0: float | None = number(None, low=1.0, high=10.0)
    tc_star: float | None = number(None, low=0.01, high=5.0, unit="s")
    ground: str = choice("A", GROUND)
    topography: str = choice("T1", ("T1", "T2", "T3", "T4"))
    file: str | None = text(None)
    limit_state: str = choice("slv", ("slv", "slc"))
    q: float = number(2.0, low=1.0)
    confidence_factor: float = number(1.35, low=1.0)
    q_a: float = number(1.0, low=1.0)
    gamma_a: float = number(1.0, low=0.0, above=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        of_ntc = {"f0": self.f0, "tc_star": self.tc_star}
        named = [name for name, value in {"ag": self.ag, **of_ntc}.items() if value is not None]
        if self.spectrum == "table" and named:
            raise ConfigError(f'[check] {named[0]}: spectrum = "table" takes its values from the file; remove this key')
        if self.spectrum != "table" and self.file is not None:
            raise misplaced(self, "file", "spectrum", '"table"')
        if self.spectrum != "ntc" and (given := [name for name, value in of_ntc.items() if value is not None]):
            raise misplaced(self, given[0], "spectrum", '"ntc"')
        if self.spectrum != "ntc" and self.topography != "T1":
            raise misplaced(self, "topography", "spectrum", '"ntc"', "multiply ag by its factor")
        needed = {"ntc": ("ag", "f0", "tc_star"), "table": ()}.get(self.spectrum, ("ag",))
        missing = [name for name in needed if name not in named]
        if named and missing:
            raise ConfigError(
                f"[check] {missing[0]}: {self.spectrum} requires this key in addition to {', '.join(named)}; give it"
            )

    @property
    def given(self) -> bool:
        """Whether a spectrum is given, by `ag` or by a file."""
        return self.ag is not None or self.file is not None


@dataclass(frozen=True)
class ReportSettings(Section):
    """Author, client and project of a report, and the PNG file of a logo, which is copied into the results.

    >>> rp.Config(report=rp.ReportSettings(author="A. Rossi")).report
    ReportSettings(author='A. Rossi')
    """

    heading = "[report]"
    author: str = text()
    client: str = text()
    project: str = text()
    logo: str | None = text(None)


def logo_bytes(report: ReportSettings, folder: Path) -> bytes:
    """Read the logo, whose path is relative to a folder; raise ConfigError if missing, too large or not a PNG."""
    if report.logo is None:
        return b""
    path = folder / report.logo
    check_regular(path)
    try:
        with path.open("rb") as file:
            content = file.read(LOGO_LIMIT + 1)
    except OSError as error:
        raise ConfigError(f"[report] logo: {path} cannot be read ({error.strerror}); check the path") from error
    if not content.startswith(PNG):
        raise ConfigError(f"[report] logo: {path}: expected a PNG picture, found another file")
    if len(content) > LOGO_LIMIT:
        raise ConfigError(f"[report] logo: {path}: expected at most {LOGO_LIMIT:,} bytes; make the picture smaller")
    return content
