"""The configuration of an assessment: a strictly checked TOML file, or the same sections built in Python."""

import dataclasses
import hashlib
import math
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from glob import escape, has_magic
from pathlib import Path
from typing import Any, cast

from rocking.pictures import shortened_line
from rockpulse.config import settings, study_settings
from rockpulse.config.block_settings import BlockSettings, require_pairs
from rockpulse.config.ground_types import soil_factor
from rockpulse.config.study_settings import logo_bytes
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.files import TOML_LIMIT, parse_toml, read_table, read_text
from rockpulse.model_table import ModelSettings, SearchSettings, is_full
from rockpulse.option import Section, hint
from rockpulse.readers.file_pairs import PairSettings
from rockpulse.record.measures import PGA
from rockpulse.record.record import STANDARD_GRAVITY

#: Sections that may occur more than once.
SEVERAL = ("block", "demand")
#: Largest relative difference of two PGAs that are regarded as the same demand.
SAME = 0.02
#: Name of a stored configuration in messages.
STORED = "the configuration stored in the results"


@dataclass(frozen=True)
class Config:
    """The settings of an assessment: all inputs except the records.

    Attributes
    ----------
    site, records, conditioning, half_waves, intense_phase, sequence, models, search : Section
    uncertainty, calibration, selection, fragility, hazard, check, report, run : Section
        One dataclass per section, usable as keyword arguments: ``condition(record, **config.conditioning)``.
    bodies, demands : tuple of BlockSettings, tuple of DemandSettings
        The bodies ([[block]]) and the demands of the site ([[demand]]), in the order of the file. If no demand is
        given, it is `site.pga`, or the PGA a_g S from `site.ag`, with S for `site.ground` by the code of `check`.
    folder : Path
        Folder of the file, to which ``records.paths`` is relative; comparisons and :meth:`as_text` ignore it.

    Raises
    ------
    ConfigError
        If two bodies or two demands have the same name, or sections contradict each other.

    Examples
    --------
    >>> Config().sequence.main
    'largest'
    """

    def __repr__(self) -> str:
        changed = [repr(getattr(self, name)) for name, cls in SECTIONS.items() if getattr(self, name) != cls()]
        several = [
            f"{len(found)} {what}" for found, what in ((self.bodies, "bodies"), (self.demands, "demands")) if found
        ]
        return shortened_line(f"<Config {', '.join([*several, *changed]) or 'defaults'}>")

    site: settings.SiteSettings = field(default_factory=settings.SiteSettings)
    records: settings.RecordSettings = field(default_factory=settings.RecordSettings)
    conditioning: settings.ConditioningSettings = field(default_factory=settings.ConditioningSettings)
    half_waves: settings.HalfWaveSettings = field(default_factory=settings.HalfWaveSettings)
    intense_phase: settings.IntensePhaseSettings = field(default_factory=settings.IntensePhaseSettings)
    sequence: settings.SequenceSettings = field(default_factory=settings.SequenceSettings)
    models: ModelSettings = field(default_factory=ModelSettings)
    search: SearchSettings = field(default_factory=SearchSettings)
    uncertainty: study_settings.UncertaintySettings = field(default_factory=study_settings.UncertaintySettings)
    calibration: settings.CalibrationSettings = field(default_factory=settings.CalibrationSettings)
    selection: study_settings.SelectionSettings = field(default_factory=study_settings.SelectionSettings)
    fragility: study_settings.FragilitySettings = field(default_factory=study_settings.FragilitySettings)
    hazard: study_settings.HazardSettings = field(default_factory=study_settings.HazardSettings)
    check: study_settings.CheckSettings = field(default_factory=study_settings.CheckSettings)
    report: study_settings.ReportSettings = field(default_factory=study_settings.ReportSettings)
    run: settings.RunSettings = field(default_factory=settings.RunSettings)
    bodies: tuple[BlockSettings, ...] = ()
    demands: tuple[settings.DemandSettings, ...] = ()
    folder: Path = field(default=Path(), compare=False)

    def __post_init__(self) -> None:
        if self.records.pair_table is not None:
            pairs = (*self.records.pairs, *_pairs_of(self.records.pair_table, self.folder))
            object.__setattr__(self, "records", dataclasses.replace(self.records, pairs=pairs, pair_table=None))
        _require_different("[[block]]", [block.name for block in self.bodies])
        _require_different("[[demand]]", [demand.name for demand in self.demands])
        ratios = [(block.name, own) for block in self.bodies for own in (block.restitution, block.rebound)]
        lists = {name: len(own) for name, own in ratios if isinstance(own, tuple)}
        if len(set(lists.values())) > 1:
            found = ", ".join(f'{length} in "{name}"' for name, length in lists.items())
            raise ConfigError(f"[[block]] restitution: expected lists of equal length in all blocks, found {found}")
        if self.models.histories and self.records.store == "none":
            raise ConfigError(
                '[models] histories = true, but [records] store = "none" leaves them out of the results; '
                'set store = "half_waves" or "all", or histories = false'
            )
        tables = [("[fragility]", self.fragility.selection)]
        tables += [(f"[[demand]] {one.name}", one.selection) for one in self.demands]
        named = [where for where, table in tables if table is not None]
        if named and self.records.components == "strongest":
            raise ConfigError(
                f'{named[0]} selection: it names records, but with [records] components = "strongest" their ids are '
                'known only after the run; use "horizontal", "azimuth" or "sweep"'
            )
        require_pairs(self.bodies, self.records)
        if self.site.ag is not None and self.hazard.soil_factor is None:
            soil = soil_factor(self.check, self.site.ag, self.site.ground)
            object.__setattr__(self, "hazard", dataclasses.replace(self.hazard, soil_factor=soil))
        if not self.demands and (demand := self.site_demand) is not None:
            object.__setattr__(self, "demands", (demand,))
        if self.uncertainty.azimuth and self.records.components != "sweep":
            raise ConfigError(
                "[uncertainty] azimuth = true (mean over the directions of a pair of channels) needs [records] "
                f'components = "sweep", found "{self.records.components}"; change one of them'
            )

    @property
    def site_demand(self) -> settings.DemandSettings | None:
        """The demand from section [site]: `pga`, or a_g S; None if neither `pga` nor `ag` is given."""
        if self.site.pga is not None:
            return settings.DemandSettings(value=self.site.pga)
        if self.site.ag is None:
            return None
        soil = soil_factor(self.check, self.site.ag, self.site.ground)
        return settings.DemandSettings("a_g S", value=self.site.ag * soil * STANDARD_GRAVITY, confirm_value=True)

    @property
    def has_probability(self) -> bool:
        """Whether a probability of overturning is computed: it must be requested, and needs the nonlinear model."""
        return self.uncertainty.probability and any(map(is_full, self.models.use))

    def record_paths(self) -> list[Path]:
        """Return the paths of the records; relative paths are joined to the folder of the configuration."""
        return [located(path, self.folder) for path in self.records.paths]

    @cached_property
    def bodies_digest(self) -> str:
        """SHA-256 of all keys of all bodies except `confirm_size`; the value is computed once."""
        return hashlib.sha256(repr([_facts_of(body) for body in self.bodies]).encode()).hexdigest()

    def as_text(self) -> str:
        """Return the complete configuration as TOML, from which an equal Config can be loaded."""
        document: dict[str, Any] = {name: section_values(getattr(self, name)) for name in SECTIONS}
        several = zip(SEVERAL, (self.bodies, self.demands), strict=True)
        return document_as_text(document | {name: [*map(section_values, entries)] for name, entries in several})


#: Sections by their name in the file, in the order of the template.
SECTIONS: dict[str, type[Section]] = {
    item.name: cast(type[Section], item.default_factory)
    for item in dataclasses.fields(Config)
    if isinstance(item.default_factory, type)
}


def _facts_of(entry: Section) -> list[Any]:
    """Return the values of an entry and of its nested entries, except `confirm_size`."""
    facts: list[Any] = []
    for name, value in vars(entry).items():
        if isinstance(value, tuple) and value and isinstance(value[0], Section):
            value = [_facts_of(one) for one in value]
        if name != "confirm_size":
            facts.append(value)
    return facts


def _pairs_of(table: str, folder: Path) -> list[PairSettings]:
    """Read pairs of files from a CSV table with the columns north and east; raise ConfigError for any other table."""
    path, where = located(table, folder), "[records] pair_table"
    cells = read_table(path, ("north", "east"), "a CSV table with the columns north and east", where)
    found = []
    for number, (north, east) in enumerate(zip(cells["north"], cells["east"], strict=True), start=1):
        try:
            found.append(PairSettings(north=north, east=east))
        except ConfigError as error:
            raise ConfigError(f"{where}: {path}: row {number}: {error}") from None
    if not found:
        raise ConfigError(f"{where}: {path}: expected a row for each pair, found none")
    return found


def _require_different(heading: str, names: list[str]) -> None:
    for name, times in Counter(names).items():
        if times > 1:
            raise ConfigError(f'{heading} name: "{name}" is given {times} times; names must differ')


def located(path: str, folder: Path) -> Path:
    """Join a path or pattern to the folder to which it is relative; wildcards in the folder's name are escaped."""
    found = folder / path
    return Path(escape(str(folder))) / path if has_magic(path) and not os.path.lexists(found) else found


def config_from_text(text: str) -> Config:
    """Read a stored configuration written by :meth:`Config.as_text`; raise ResultsError for other text."""
    try:
        return config_of(stored_sections(text), Path())
    except ConfigError as error:
        raise ResultsError(f"{STORED}: {error}") from None


def stored_sections(text: str) -> dict[str, Any]:
    """Return the sections of a configuration stored in results; raise ResultsError if the text has no sections."""
    found = parse_toml(text, STORED, ResultsError)
    for name, values in found.items():
        several = name in SEVERAL and isinstance(values, list)
        if not all(isinstance(section, dict) for section in (values if several else [values])):
            raise ResultsError(f"{STORED}: [{name}]: expected a section with keys")
    return found


def given_config(
    config: Config | str | os.PathLike[str] | None, units: str | None = None, dt: float | None = None
) -> Config:
    """Return the given Config, a Config read from a path, or the defaults; `units` and `dt` replace its [records]."""
    if units is not None or dt is not None:
        asked = given_config(config)
        return dataclasses.replace(asked, records=asked.records.for_all(units, dt))
    if config is None:
        return Config()
    if isinstance(config, (str, os.PathLike)):
        return load_config(Path(config))
    if not isinstance(config, Config):
        raise ConfigError(f"config: expected a Config or the path of one, found {type(config).__name__} {config!r:.60}")
    return config


def load_config(path: str | Path) -> Config:
    """Read and check a TOML configuration.

    Parameters
    ----------
    path : str or Path
        The file; ``records.paths`` in it are relative to its folder.

    Returns
    -------
    Config

    Raises
    ------
    ConfigError
        For a pipe or a device, a file larger than 1 MB or not in TOML, an unknown section or key, a wrong type, a value
        that is not allowed, or a logo that is not a small PNG.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> rp.load_config("site.toml").bodies[0].block()
    <Block width 1 m, height 4 m, p 1.889 1/s, alpha_c 0.245 rad, C 0.9118>
    """
    path = Path(path)
    document = parse_toml(read_text(path, TOML_LIMIT, "a TOML file"), str(path))
    try:
        config = config_of(document, path.parent)
        _require_one_demand(config)
        logo_bytes(config.report, config.folder)  # reports an unusable logo before any work
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
    return config


def _require_one_demand(config: Config) -> None:
    """Raise ConfigError if a [[demand]] in the limit state of the checks states another PGA than [site]."""
    state, of_site = config.check.limit_state, config.site_demand
    given = [one for one in config.demands if one.measure == PGA and one.value is not None]
    given = [one for one in given if one.limit_state.casefold() in ("", state)]
    if of_site is None or not given or any(math.isclose(one.strength, of_site.strength, rel_tol=SAME) for one in given):
        return
    found, wanted = (f"{value / STANDARD_GRAVITY:.3g} g" for value in (given[0].strength, of_site.strength))
    checks = "" if config.site.ag is None else ", or move ag and ground to [check] if only the checks need them"
    raise ConfigError(
        f"[[demand]] {given[0].name}: expected the PGA of [site], {wanted} ({of_site.name}), found {found}; remove the "
        f"wrong one, or state the limit_state of the demand if it has another limit state{checks}"
    )


def config_of(document: Mapping[str, Any], folder: Path) -> Config:
    """Return the configuration of a TOML document in a folder; raise ConfigError for a wrong section or key."""
    known = [*SECTIONS, *SEVERAL]
    for name in document:
        if name not in known:
            known_sections = f"known sections: {', '.join(known)}"
            raise ConfigError(f"[{name}]: unknown section{hint(name, known, known_sections)}")
    document = _with_site(document)
    sections: Any = {name: section_of(cls, document[name]) for name, cls in SECTIONS.items() if name in document}
    blocks = _sections(BlockSettings, document, "block", "body")
    demands = _sections(settings.DemandSettings, document, "demand", "limit state")
    return Config(**sections, bodies=blocks, demands=demands, folder=folder)


def _with_site(document: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the document, with `ag` and `ground` copied from [site] to [check] if [check] does not define them."""
    site, check = document.get("site"), document.get("check")
    if not isinstance(site, Mapping) or not isinstance(check, Mapping) or check.get("spectrum") == "table":
        return document
    return {**document, "check": {key: site[key] for key in ("ag", "ground") if key in site} | {**check}}


def _sections(cls: type[Section], document: Mapping[str, Any], name: str, what: str) -> tuple[Any, ...]:
    entries = document.get(name, [])
    if not isinstance(entries, list):
        single = cls.heading.removeprefix("[").removesuffix("]")
        raise ConfigError(
            f"{single}: expected {cls.heading} with double brackets, one for each {what}, found a single section"
        )
    return tuple(section_of(cls, entry) for entry in entries)


def section_of(cls: type[Section], values: Any) -> Any:
    """Make a section from its keys in TOML; raise ConfigError for an unknown or a missing key, or a wrong value."""
    if not isinstance(values, Mapping):
        raise ConfigError(f"{cls.heading}: expected a section with keys, found {values!r}")
    known = {toml_key(item): item for item in dataclasses.fields(cls)}
    for key in values:
        if key not in known:
            otherwise = f"known keys: {', '.join(known)}"
            raise ConfigError(f"{cls.heading} {key}: unknown key{hint(key, list(known), otherwise)}")
    for key, item in known.items():
        if item.default is dataclasses.MISSING and key not in values:
            found = f"found only {', '.join(values)}" if values else "found no keys"
            raise ConfigError(f"{cls.heading} {key}: this key is required, {found}")
    given = {}
    for key, item in known.items():
        if key in values:
            inner = item.metadata.get("entries")
            given[item.name] = values[key] if inner is None else _sections(inner, values, key, key)
    return cls(**given)


def toml_key(item: dataclasses.Field[Any]) -> str:
    """Return the TOML key of a field; for a nested section, "file" in the heading [[records.file]]."""
    cls = item.metadata.get("entries")
    return item.name if cls is None else str(cls.heading).strip("[]").rpartition(".")[2]


def section_values(section: Section) -> dict[str, Any]:
    """Return the values of a section by their TOML keys, without keys that have no value."""
    found: dict[str, Any] = {}
    for item in dataclasses.fields(section):
        value = section[item.name]
        value = [*map(section_values, value)] or None if "entries" in item.metadata else value
        if value is not None:
            found[toml_key(item)] = value
    return found


def document_as_text(document: Mapping[str, Any]) -> str:
    """Return sections, and lists of sections, as TOML text."""
    parts = []
    for name, values in document.items():
        several = isinstance(values, list)
        parts += [_as_toml(f"[[{name}]]", one) for one in values] if several else [_as_toml(f"[{name}]", values)]
    return "\n".join(parts)


def _as_toml(heading: str, values: Mapping[str, Any]) -> str:
    lines, inner = [heading], []
    for name, value in values.items():
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            inner += [_as_toml(f"[[{heading.strip('[]')}.{name}]]", one) for one in value]
        else:
            lines.append(f"{name} = {_value(value)}")
    return "\n".join([*lines, "", *inner])


#: TOML escapes of the characters that a text in quotes cannot contain.
_ESCAPES = {code: f"\\u{code:04x}" for code in (*range(32), 127)} | {ord(sign): f"\\{sign}" for sign in '"\\'}


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value.translate(_ESCAPES)}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name} = {_value(one)}" for name, one in value.items()) + "}"
    return repr(value)
