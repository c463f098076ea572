"""The sections of the configuration: one dataclass per section with keys, defaults and allowed values."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rockpulse.errors import ConfigError, Remedy
from rockpulse.option import KeyType, Section, boolean, choice, count, entries, is_number, key, number, text, texts
from rockpulse.readers.file_pairs import PairSettings
from rockpulse.readers.format import FileSettings
from rockpulse.record.measures import DEMAND, PERIODIC, PGA, ROWS, SCALING, quoted, units_in_words

#: Ground types of NTC 2018 and EN 1998-1.
GROUND = ("A", "B", "C", "D", "E")
#: Names of the spacings of secondary impulses.
SPACINGS = ("end", "middle", "start", "open", "continuous")
#: Words allowed for `weights`, which may also be the name of a table.
WEIGHTS = ("equal", "event")
#: Largest number of processes on one machine.
MOST_WORKERS = 10_000


def misplaced(section: Section, keys: str, key: str, words: str, advice: str = "remove it") -> ConfigError:
    """Return the error for `keys` that may only be given if another key has the value `words`."""
    they = "they apply only" if "," in keys else "it applies only"
    return ConfigError(f'{section.where} {keys}: {they} to {key} = {words}, found {key} = "{section[key]}"; {advice}')


@dataclass(frozen=True)
class SiteSettings(Section):
    """Name and description of the study, and the seismic action at the site.

    `ag` is the peak acceleration on rock [g], `ground` the ground type. Both determine the default demand (a PGA of
    a_g S), the spectrum of the checks, and the soil factor of the hazard (see :class:`Config`). `pga` is the demand
    itself, on the ground of the site, as a text with its unit.

    Raises
    ------
    ConfigError
        If both `ag` and `pga` are given, or `pga` is not a positive number with a unit of acceleration.

    Examples
    --------
    >>> rp.Config(site=rp.SiteSettings(name="Basilica of San Bernardino")).site
    SiteSettings(name='Basilica of San Bernardino')
    """

    heading = "[site]"
    name: str = text()
    description: str = text()
    ag: float | None = number(None, low=0.0, above=True, high=5.0, unit="g")
    pga: str | None = text(None)
    ground: str = choice("A", GROUND)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.pga is None:
            return
        if self.ag is not None:
            raise ConfigError(
                f'[site] pga: expected pga or ag (on rock) for the demand, found both, "{self.pga}" and {self.ag:g} g; '
                "remove one, or move ag and ground to [check] if only the checks need them"
            )
        try:
            DemandSettings(value=self.pga)
        except ConfigError as error:
            raise ConfigError(str(error).replace("[[demand]] value", "[site] pga")) from None


@dataclass(frozen=True)
class RecordSettings(Section):
    """The records to read, the unit of files that do not state a unit, and the groups of results to store.

    `confirm` contains patterns of the ids of channels that are confirmed in spite of a doubt (a peak above 5 g, a
    defect, a duplicate that differs); `files` contains units and intervals of single files, in TOML [[records.file]];
    `pairs` contains the two files of each recording with one file per component, in TOML [[records.pair]]; `pair_table`
    is the file of a table of such pairs, which :class:`Config` reads into `pairs`.

    The azimuth is the direction in which the body rocks: for a wall or façade the normal to its plane, e.g. 45 degrees
    for a façade that faces north-east. For a body that rocks to both sides, 45 and 225 degrees are the same.

    >>> rp.RecordSettings(components="azimuth")
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [records] components: "azimuth" needs the direction in which the...
    """

    heading = "[records]"
    paths: tuple[str, ...] = texts()
    components: str = choice("horizontal", ("horizontal", "azimuth", "strongest", "sweep"))
    azimuth: float | None = number(None, low=0.0, high=360.0, unit="degrees")
    azimuth_step: float = number(10.0, low=1.0, high=90.0, unit="degrees")
    structural: bool = boolean(False)
    units: str | None = text(None)
    dt: float | None = number(None, low=0.0, above=True, unit="s")
    response: str = choice("sensitivity", ("sensitivity", "remove"))
    include_vertical: bool = boolean(False)
    events: str | None = text(None)
    pair_table: str | None = text(None)
    keep: tuple[str, ...] = texts()
    confirm: tuple[str, ...] = texts()
    store: str = choice("all", ("all", "half_waves", "none"))
    files: tuple[FileSettings, ...] = entries(FileSettings)
    pairs: tuple[PairSettings, ...] = entries(PairSettings)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.components == "azimuth" and self.azimuth is None:
            raise ConfigError(
                '[records] components: "azimuth" needs the direction in which the body rocks, for a wall or façade '
                "the perpendicular to its plane; give azimuth, in degrees clockwise from north (45 for a façade that "
                "faces north-east)"
            )
        if self.components != "azimuth" and self.azimuth is not None:
            raise misplaced(self, "azimuth", "components", '"azimuth"', "remove it or change components")
        if not math.isclose(180.0 / self.azimuth_step, round(180.0 / self.azimuth_step), rel_tol=1e-9):
            raise ConfigError(
                f"[records] azimuth_step: expected a divisor of 180 degrees, found {self.azimuth_step:g}; use 5, 10, "
                "15, 22.5, 30 or 45"
            )

    def for_all(self, units: str | None, dt: float | None) -> RecordSettings:
        """Return these settings with the given unit and interval [s], which also replace those in [[records.file]]."""
        rows = []
        for row in self.files:
            own = row.units if units is None else None, row.dt if dt is None else None
            if own != (None, None):
                rows.append(replace(row, units=own[0], dt=own[1]))
        units, dt = self.units if units is None else units, self.dt if dt is None else dt
        return replace(self, files=tuple(rows), units=units, dt=dt)


@dataclass(frozen=True)
class ConditioningSettings(Section):
    """Options of baseline, filter and sampling; keyword arguments of :func:`rockpulse.condition`.

    >>> rp.condition(record, **rp.ConditioningSettings(highpass_hz=0.1)).processing[-1].split(",")[0]
    'filter: Butterworth high-pass 0.1 Hz'
    """

    heading = "[conditioning]"
    baseline: str = choice("auto", ("auto", "none", "mean", "pre-event", "linear", "quadratic"))
    highpass_hz: float | None = number(None, low=0.0, above=True, unit="Hz")
    lowpass_hz: float | None = number(None, low=0.0, above=True, unit="Hz")
    order: int = count(2, low=1, high=10)
    taper_s: float | None = number(None, low=0.0, unit="s")
    resample_s: float | None = number(None, low=0.0, above=True, unit="s")
    pre_event_s: float | None = number(None, low=0.0, above=True, unit="s")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.highpass_hz is not None and self.lowpass_hz is not None and self.highpass_hz >= self.lowpass_hz:
            raise ConfigError(
                f"[conditioning] highpass_hz: expected a frequency below lowpass_hz = {self.lowpass_hz:g} Hz, "
                f"found {self.highpass_hz:g}; nothing would be left of the record"
            )


@dataclass(frozen=True)
class HalfWaveSettings(Section):
    """Criteria for half-waves; keyword arguments of :func:`rockpulse.half_waves`.

    >>> rp.half_waves(record, **rp.HalfWaveSettings(threshold=0.2))
    <HalfWaves of burst.2, waves 8, largest impulse 1.186 m/s, from 0 to 7.99 s>
    """

    heading = "[half_waves]"
    threshold: float = number(0.0, low=0.0, high=1.0)
    min_duration_s: float = number(0.0, low=0.0, unit="s")
    merge: bool = boolean(True)


@dataclass(frozen=True)
class IntensePhaseSettings(Section):
    """The part of the record used for calibration; keyword arguments of :func:`rockpulse.intense_phase`.

    >>> rp.intense_phase(record, **rp.IntensePhaseSettings(method="window", start_s=1.0, end_s=3.0))
    IntensePhase(start=1.0, end=3.0)
    """

    heading = "[intense_phase]"
    method: str = choice("D5-95", ("D5-95", "D5-75", "bracketed", "window"))
    start_s: float | None = number(None, low=0.0, unit="s")
    end_s: float | None = number(None, low=0.0, unit="s")
    level: float | None = number(None, low=0.0, above=True, unit="m/s2")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.method != "window" and (self.start_s is not None or self.end_s is not None):
            raise misplaced(self, "start_s, end_s", "method", '"window"', "remove them or change the method")
        if self.end_s is not None and self.start_s is None:
            raise ConfigError("[intense_phase] end_s: expected start_s as well, the start of the window; give both")
        if self.start_s is not None and self.end_s is not None and self.start_s >= self.end_s:
            raise ConfigError(
                f"[intense_phase] end_s: expected a time after start_s = {self.start_s:g}, found {self.end_s:g}"
            )
        if self.level is not None and self.method != "bracketed":
            raise misplaced(self, "level", "method", '"bracketed"', "remove it or change the method")


@dataclass(frozen=True)
class SequenceSettings(Section):
    """Options of a record's sequence; all except the method are arguments of :func:`rockpulse.record_sequence`.

    The method "rule" gives every body its own sequence, from the conservative variant of the rule; "statistics" gives
    one sequence for all bodies, from the half-waves of the record.

    >>> rp.record_sequence(rp.half_waves(record), **rp.SequenceSettings(secondary="mean").statistics)
    <ImpulseSequence I 1.186 m/s, I_s 0.2749 m/s, dT 0.4922 s, duration 7.99 s, main impulses 4, spacing end>
    """

    heading = "[sequence]"
    method: str = choice("rule", ("rule", "statistics"))
    main: str = choice("largest", ("largest", "mean-largest", "quantile"))
    secondary: str = choice("rms", ("rms", "median", "mean"))
    interval: str = choice("median", ("median", "mean"))
    main_count: str | int = choice("half-largest", ("half-largest", "none"), most=1_000_000)
    spacing: str = choice("end", SPACINGS)
    duration_s: float | None = number(None, low=0.0, above=True, unit="s")
    m: int = count(3, low=1)
    quantile: float = number(0.95, low=0.0, high=1.0)

    @property
    def statistics(self) -> dict[str, Any]:
        """The keyword arguments of :func:`rockpulse.record_sequence`."""
        return {name: value for name, value in {**self}.items() if name != "method"}


#: Pattern of a value with its unit.
_WITH_UNIT = re.compile(r"(\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)\s*(\D.*)?", re.ASCII)
_VALUE = KeyType(
    f'a number > 0 in {units_in_words(DEMAND)}, or a text with its unit, such as "0.35 g"',
    lambda value: isinstance(value, str) or (is_number(value) and value > 0.0),
    lambda value: value if isinstance(value, str) else float(value),
    finite=True,
)


@dataclass(frozen=True)
class DemandSettings(Section):
    """The demand of the site in one limit state: the intensity to which records are scaled to assess bodies.

    `value` is in the SI unit of the measure, or a text with its unit. The default of `name` is measure and value.
    `selection` replaces measure and value: a table with the columns record and factor, as :func:`rockpulse.select`
    makes it; each record is scaled by its own factor. `confirm_value` accepts a value above the usual demands
    (PGA 2 g, PGV 3 m/s, SI 5 m/s, Sa 6 g); without it such a value is rejected, as its unit is probably wrong.

    >>> rp.DemandSettings(measure="pgv", value="40 cm/s")
    DemandSettings(name='PGV 40 cm/s', measure='pgv', value=0.4)
    """

    heading = "[[demand]]"
    name: str = text()
    limit_state: str = text()
    measure: str = choice(PGA, DEMAND)
    value: float | str | None = key(None, _VALUE)
    period: float | None = number(None, low=0.02, unit="s")
    selection: str | None = text(None)
    confirm_value: bool = boolean(False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.selection is not None:
            others = [name for name in ("value", "period") if getattr(self, name) is not None]
            if others or self.measure != PGA:
                extra = ", ".join(others) or "measure"
                raise ConfigError(f"{self.where} {self.name}: selection gives the scale factors; remove {extra}")
            object.__setattr__(self, "name", self.name or Path(self.selection).stem)
            return
        if self.value is None:
            raise ConfigError(
                f'{self.where} {self.name}: expected the key value (such as "0.35 g" for a PGA) or '
                "selection, found neither"
            )
        periodic = bool(ROWS[self.measure].periods)
        if periodic and self.period is None:
            needed = f'measure = "{self.measure}" needs the period of the oscillator in s: sa(1.0)=0.4g or period = 1.0'
            raise ConfigError(f"{self.where} {self.name}: {needed}")
        if self.period is not None and not periodic:
            extra = f'period applies only to measure = {quoted(PERIODIC)}, found measure = "{self.measure}"; remove it'
            raise ConfigError(f"{self.where} {self.name}: {extra}")
        measure = ROWS[self.measure].at(self.period)
        if isinstance(self.value, str):
            shown, in_si = self._in_si(self.value)
        else:
            shown, in_si = f"{self.value:g} {measure.shown_unit}".rstrip(), self.value
        if not self.confirm_value and in_si > measure.usual:
            _, unit, factor = measure.column
            found, usual = f"{measure.title} of {in_si / factor:.3g} {unit}", f"{measure.usual / factor:g} {unit}"
            remedy = Remedy("confirm_value")
            raise ConfigError(
                f"{self.where} value: {found} is accepted only if confirmed, as demands above {usual} are rare: check "
                f"the number and its unit, or {remedy.advice()}",
                remedy,
            )
        object.__setattr__(self, "name", self.name or f"{measure.title} {shown}")
        object.__setattr__(self, "value", in_si)

    def _in_si(self, value: str) -> tuple[str, float]:
        """Return a value with its unit as text, and in SI; raise ConfigError if value or unit is wrong."""
        known, found = ROWS[self.measure].known_units, _WITH_UNIT.fullmatch(value.strip())
        unit = (found[2] or "").strip() if found else "?"
        if found is not None and unit in known and (size := float(found[1])) > 0.0:
            return f"{found[1]} {unit}".strip(), size * known[unit]
        units = ", ".join(filter(None, known)) or "no unit"
        raise ConfigError(f'{self.where} value: expected a positive number and its unit ({units}), found "{value}"')

    @property
    def strength(self) -> float:
        """The value of the demand, in the SI unit of the measure; NaN for a selection of records."""
        if self.value is None:
            return math.nan
        assert isinstance(self.value, float)  # converted above
        return self.value


def parse_demand_option(option: str) -> DemandSettings:
    """Parse ``MEASURE=VALUE UNIT``, the measure with its period as in ``sa(1.0)``; raise ConfigError for other text."""
    found = re.fullmatch(r"(\w+)(?:\(([.\d]+)\s*s?\))?\s*=\s*(.+)", option.strip())
    if found is None:
        raise ConfigError(
            f'--demand: expected MEASURE=VALUE with a unit, such as "pga=0.35g" or "sa(1.0)=0.4g", found "{option}"'
        )
    try:
        period = None if found[2] is None else float(found[2])
        return DemandSettings(measure=found[1].lower(), value=found[3], period=period)
    except (ConfigError, ValueError) as error:
        raise ConfigError(f'--demand "{option}": {error}') from None


@dataclass(frozen=True)
class CalibrationSettings(Section):
    """Options of :func:`rockpulse.calibrate`, which derives the impulse sequence of a site from records.

    The keys secondary, interval, main_count and spacing of ``[sequence]`` are used as well.

    >>> rp.CalibrationSettings().weights
    'event'
    """

    heading = "[calibration]"
    spectrum: str = choice("rule", ("rule", "nonlinear"))
    weights: str = text("event")
    scale_to: str = choice("none", ("none", *SCALING))
    target: float | None = number(None, low=0.0, above=True, unit=units_in_words(SCALING))
    quantile: float = number(0.84, low=0.01, high=0.99)
    confidence: float = number(0.9, low=0.5, high=0.99)
    bootstrap: int = count(1000, low=100)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.weights.strip():
            raise ConfigError(
                '[calibration] weights: expected "equal", "event" or the name of a CSV table, found nothing'
            )
        if self.scale_to != "none" and self.target is None:
            raise ConfigError(f'[calibration] scale_to: "{self.scale_to}" needs the value to scale to; give target')
        if self.scale_to == "none" and self.target is not None:
            raise misplaced(self, "target", "scale_to", quoted(SCALING), "remove it, or set scale_to")


@dataclass(frozen=True)
class RunSettings(Section):
    """Number of parallel processes and random seed of a run.

    >>> rp.RunSettings(workers=0)
    Traceback (most recent call last):
    rockpulse.errors.ConfigError: [run] workers: expected "all" or an integer from 1 to 10000, found 0
    """

    heading = "[run]"
    workers: str | int = choice("all", ("all",), most=MOST_WORKERS)
    seed: int = count(0, low=0)
