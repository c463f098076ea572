"""The section [check] of the configuration: the demand that a code states for the site, and its factors."""

from __future__ import annotations

from dataclasses import dataclass

from rockpulse.errors import ConfigError
from rockpulse.option import Section, choice, number, text

#: The codes whose checks are known, in the order of tables.
CODES = ("circolare_2009", "circolare_2019", "en_1998")

SPECTRA = ("ntc", "en_1998_1", "en_1998_2", "table")
GROUNDS = ("A", "B", "C", "D", "E")
TOPOGRAPHIES = ("T1", "T2", "T3", "T4")
LIMIT_STATES = ("slv", "slc")


@dataclass(frozen=True)
class CheckSettings(Section):
    """The elastic spectrum of a code, of one limit state, and the factors of the checks.

    Attributes
    ----------
    spectrum : str
        "ntc": NTC 2018, 3.2.3.2.1; "en_1998_1" and "en_1998_2": EN 1998-1, 3.2.2.2, types 1 and 2; "table": `file`.
    ag : float or None
        Peak acceleration on rock [g], of the limit state that is checked; with the importance factor in it.
    f0, tc_star : float or None
        F_0 [-] and T_C* [s] of an NTC spectrum.
    ground, topography : str
        Categories; the topography is that of NTC.
    file : str or None
        Table "period [s],sa [g]" from a period of 0, that of the ground's peak with its soil.
    limit_state : str
        Of Circolare 7/2019: "slv" or "slc".
    q, confidence_factor : float
        Behaviour factor of the linear checks and FC. FC is that of knowledge level LC1 unless the masonry's crushing is
        in the multiplier (Circolare 7/2019, C8.7.1.2.1.3).
    q_a, gamma_a : float
        Behaviour factor and importance factor of a non-structural element (EN 1998-1, 4.3.5).

    Raises
    ------
    ConfigError
        For a table without its file, a file without "table", and a spectrum with only some of its numbers.
    """

    heading = "[check]"
    spectrum: str = choice("ntc", SPECTRA)
    ag: float | None = number(None, low=0.0, above=True, high=5.0, unit="g")
    f0: float | None = number(None, low=1.0, high=10.0)
    tc_star: float | None = number(None, low=0.01, high=5.0, unit="s")
    ground: str = choice("A", GROUNDS)
    topography: str = choice("T1", TOPOGRAPHIES)
    file: str | None = text(None)
    limit_state: str = choice("slv", LIMIT_STATES)
    q: float = number(2.0, low=1.0)
    confidence_factor: float = number(1.35, low=1.0)
    q_a: float = number(1.0, low=1.0)
    gamma_a: float = number(1.0, low=0.0, above=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        of_ntc = {"f0": self.f0, "tc_star": self.tc_star}
        named = [name for name, value in {"ag": self.ag, **of_ntc}.items() if value is not None]
        if self.spectrum == "table" and named:
            raise ConfigError(f'[check] {named[0]}: the numbers of spectrum = "table" are in its file; drop it')
        if self.spectrum != "table" and self.file is not None:
            raise ConfigError(f'[check] file: it belongs to spectrum = "table", found spectrum = "{self.spectrum}"')
        if self.spectrum != "ntc" and (given := [name for name, value in of_ntc.items() if value is not None]):
            raise ConfigError(f'[check] {given[0]}: it belongs to spectrum = "ntc", found "{self.spectrum}"; drop it')
        if self.spectrum != "ntc" and self.topography != "T1":
            raise ConfigError(
                f'[check] topography: it belongs to spectrum = "ntc", found spectrum = "{self.spectrum}"; put its '
                "factor into ag"
            )
        needed = {"ntc": ("ag", "f0", "tc_star"), "table": ()}.get(self.spectrum, ("ag",))
        missing = [name for name in needed if name not in named]
        if named and missing:
            raise ConfigError(f"[check] {missing[0]}: {self.spectrum} needs it beside {', '.join(named)}; give it")

    @property
    def given(self) -> bool:
        """Whether there is a demand."""
        return self.ag is not None or self.file is not None
