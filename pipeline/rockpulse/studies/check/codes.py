"""The checks of codes: of each body from its geometry and an elastic spectrum, on the ground and on floors.

.. note:: With the multiplier alpha_0, e* and d_0 of :mod:`rockpulse.studies.check.mechanism`, q, FC and the modes T_k,
   xi_k, gamma_k psi_k of the building. Circolare 617/2009, C8A.4: a_0* = alpha_0 g/(e* FC) (C8A.4.4); linear, a_0* >=
   a_g S/q and aloft S_e(T_1) psi gamma/q; nonlinear on the ground, d_u* = 0.4 d_0* >= S_De(T_s), T_s = 2 pi sqrt(d_s*/
   a_s*) at d_s* = 0.4 d_u*. Circolare 7/2019: linear, the same with a_Z(z) aloft (C8.7.1.8, C7.2.8); displacement,
   d_SLV = 0.4 d_0 or d_SLC = 0.6 d_0 against S_De(T), T = 1.68 pi or 1.56 pi sqrt(d/a(d)) (C8.7.1.10, .11), with a
   damping of 8 or 10 %, aloft the floor spectrum C7.2.5-C7.2.7 as in C8.7.1.12. EN 1998-1, 4.3.5.2: F_a = S_a W_a
   gamma_a/q_a (4.24), S_a = alpha S [3 (1 + z/H)/(1 + (1 - T_a/T_1)^2) - 0.5], at least alpha S (4.25), T_a = 0 for
   a rigid block.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rockpulse.config.check_settings import CODES, CheckSettings
from rockpulse.config.configuration import Config
from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.errors import ConfigError
from rockpulse.storage.variables.risk import CHECK
from rockpulse.studies.check.histories import of_histories
from rockpulse.studies.check.mechanism import SENSES, Mechanism, mechanisms
from rockpulse.studies.check.spectra import (
    DemandSpectrum,
    ElasticSpectrum,
    TableEnds,
    damping_factor,
    displacement_of,
    spectrum_of,
)

if TYPE_CHECKING:
    import xarray as xr


#: Circolare 617/2009: d_u* over d_0*, and d_s* over d_u* [-].
ULTIMATE, SECANT = 0.4, 0.4

#: Circolare 7/2019 by limit state: d over d_0 [-], the factor of T [pi], and the damping of the mechanism [-].
STATES = {"slv": (0.4, 1.68, 0.08), "slc": (0.6, 1.56, 0.1)}

#: a and b of Circolare 7/2019, C7.2.6: the periods over T_k between which the floor spectrum has its plateau.
PLATEAU = (0.8, 1.1)


class Checked(NamedTuple):
    """What a code says of one body; NaN for what it does not ask, or is not known."""

    activation: float = math.nan  #: spectral acceleration that opens the mechanism, with FC [m/s2]
    activation_demand: float = math.nan  #: what is asked of it, with q [m/s2]
    displacement: float = math.nan  #: spectral displacement that is allowed [m]
    period: float = math.nan  #: at which the displacement is asked for [s]
    displacement_demand: float = math.nan  #: what is asked of it [m]
    displacement_ratio: float = math.nan  #: allowed over asked [-]; at least 1 passes
    statement: str = ""  #: why something is missing
    activation_sense: str = ""  #: "positive" or "negative", the sense that the acceleration is of; empty where alike
    displacement_sense: str = ""  #: likewise of the displacement

    @property
    def activation_ratio(self) -> float:
        """Acceleration that opens over the one that is asked [-]; at least 1 passes."""
        return self.activation / self.activation_demand


def circolare_2009(
    body: Mechanism, spectrum: ElasticSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Linear and nonlinear kinematic analysis of Circolare 617/2009, C8A.4."""
    activation = _activation(body, settings)
    asked = spectrum.ground
    if floors:
        first = max(floors, key=lambda one: one.period)
        asked = max(asked, spectrum(first.period) * abs(first.participation))
        return Checked(
            activation,
            asked / settings.q,
            statement="of Circolare 617/2009 the displacement aloft is left out: its formula could not be established",
        )
    furthest = body.furthest
    allowed = ULTIMATE * furthest
    slowest = SECANT * allowed
    pull = body.capacity(slowest) * body.gravity / (body.share * settings.confidence_factor)
    period = 2.0 * math.pi * math.sqrt(slowest / pull)
    try:
        demand = displacement_of(period, spectrum(period))
    except TableEnds as error:
        return Checked(activation, asked / settings.q, allowed, period, statement=str(error))
    return Checked(activation, asked / settings.q, allowed, period, demand, allowed / demand)


def circolare_2019(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """Analysis with q, and displacement check, of Circolare 7/2019, C8.7.1.2.1."""
    activation, asked = _activation(body, settings), max(spectrum.ground, floor_peak(spectrum, floors))
    part, factor, damping = STATES[settings.limit_state]
    allowed = part * body.furthest
    pull = body.capacity(allowed) * body.gravity / (body.share * settings.confidence_factor)
    if pull <= 0.0:  # a tie that breaks leaves nothing at a displacement that the weights alone would allow
        return Checked(activation, asked / settings.q, allowed, statement="no resistance is left at the displacement")
    period = factor * math.pi * math.sqrt(allowed / pull)
    linear = settings.limit_state == "slv"
    found = Checked(activation, asked / settings.q if linear else math.nan, allowed, period)
    try:
        demand = _displacement(spectrum, floors, period, damping)
    except TableEnds as error:
        return found._replace(statement=str(error))
    return found._replace(
        displacement_demand=demand,
        # A mechanism that does not open passes (C8.7.1.2.1.8).
        displacement_ratio=max(allowed / demand, activation / asked),
        statement="" if linear else "the analysis with q is of SLV",
    )


def en_1998(
    body: Mechanism, spectrum: DemandSpectrum, floors: Sequence[FloorSettings], settings: CheckSettings
) -> Checked:
    """The force on a non-structural element of EN 1998-1, 4.3.5.2, against the moment of its weight."""
    levels = [one.level for one in floors if one.level is not None]
    opens = body.multiplier * body.gravity
    if floors and not levels:
        return Checked(opens, statement="level, the height of the floor over that of the building, was not given")
    height = max(levels, default=0.0)
    seismic = spectrum.ground * max(1.0, 3.0 * (1.0 + height) / 2.0 - 0.5)
    return Checked(opens, seismic * settings.gamma_a / settings.q_a)


def _activation(body: Mechanism, settings: CheckSettings) -> float:
    return body.multiplier * body.gravity / (body.share * settings.confidence_factor)


def floor_peak(spectrum: DemandSpectrum, floors: Sequence[FloorSettings]) -> float:
    """a_Z(z), the largest acceleration of a floor [m/s2]: Circolare 7/2019, (C7.2.7) and (C7.2.8); 0 on the ground."""
    return math.hypot(*(_mode_peak(spectrum, one) for one in floors)) if floors else 0.0


def _mode_peak(spectrum: DemandSpectrum, floor: FloorSettings) -> float:
    percent = 100.0 * floor.damping
    shake = spectrum(floor.period, floor.damping) * abs(floor.participation)
    return shake * math.sqrt(1.0 + 0.0004 * percent**2)


def floor_spectrum(spectrum: DemandSpectrum, floors: Sequence[FloorSettings], period: float, damping: float) -> float:
    """S_eZ(T, xi, z), the spectrum of a floor [m/s2]: Circolare 7/2019, (C7.2.5) and (C7.2.6)."""
    parts = []
    for floor in floors:
        # xi_k as a share: in percent, as the text has it, a floor would shake least what is tuned to it.
        high = 1.1 * floor.damping**-0.5 * damping_factor(damping)
        rising, falling = (share * floor.period for share in PLATEAU)
        below, above = max(0.0, 1.0 - period / rising), max(0.0, period / falling - 1.0)
        apart = below**1.6 + above**1.2
        parts.append(high * _mode_peak(spectrum, floor) / (1.0 + (high - 1.0) * apart))
    found = math.hypot(*parts)
    longest = max(floor.period for floor in floors)
    return max(found, spectrum(period, damping)) if period > longest else found


def _displacement(spectrum: DemandSpectrum, floors: Sequence[FloorSettings], period: float, damping: float) -> float:
    """Largest S_De up to a period [m] (C8.7.1.2.1.8); aloft as Circolare 7/2019, (C8.7.1.12) has it."""
    if not floors:
        return spectrum.displacement(period, damping)
    own = max(one.period for one in floors)
    found = displacement_of(period, floor_spectrum(spectrum, floors, period, damping))
    least = displacement_of(PLATEAU[1] * own, floor_spectrum(spectrum, floors, own, damping))
    return max(found, least) if period > PLATEAU[1] * own else found


CHECKS: dict[str, Callable[[Mechanism, DemandSpectrum, Sequence[FloorSettings], CheckSettings], Checked]] = dict(
    zip(CODES, (circolare_2009, circolare_2019, en_1998), strict=True)
)


def code_check(config: Config, codes: Sequence[str] = CODES, results: xr.DataTree | None = None) -> xr.Dataset:
    """What codes say of the bodies of a configuration, from their geometry and the demand of [check].

    Parameters
    ----------
    config : Config
        With [[block]] and [check].
    codes : sequence of str
        Of "circolare_2009", "circolare_2019", "en_1998".
    results : xarray.DataTree, optional
        Of :func:`rockpulse.assess` on the same bodies: what the time histories say stands beside the codes.

    Returns
    -------
    xarray.Dataset
        Over (block): `multiplier` alpha_0 [-] and `share` e* [-]; over (block, code): `activation` and its `_demand`
        [m/s2] with their `activation_ratio`, `displacement` and its `_demand` [m], the `period` [s] and
        `displacement_ratio`, and `statement`, why something is NaN. A ratio of 1 or more passes. Of the two senses of a
        body each ratio is the worse one, `activation_sense` and `displacement_sense` tell of which. With results over
        (block) `probability`, that of the verdict, under the records brought to the demands of the site where there
        are some, and `factor_50`, its median over the motions; of several restitutions the worst; and `beside`, why
        they are NaN.

    Raises
    ------
    ConfigError
        Without bodies or a demand, or for an unknown code.

    Examples
    --------
    >>> import rockpulse as rp
    >>> wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    >>> config = rp.Config(blocks=(wall,), check=rp.CheckSettings(spectrum="en_1998_1", ag=0.15, confidence_factor=1.0))
    >>> found = code_check(config, ["circolare_2009"])
    >>> [round(found[name].item(), 3) for name in ("multiplier", "activation_ratio", "period", "displacement_ratio")]
    [0.1, 1.333, 1.238, 1.734]
    """
    import xarray as xr

    if unknown := [code for code in codes if code not in CHECKS]:
        raise ConfigError(f"code: expected some of {', '.join(CODES)}, found {unknown[0]!r}")
    if not config.blocks:
        raise ConfigError("no body to check: give [[block]] entries in the configuration")
    spectrum = spectrum_of(config.check, config.folder)
    names: list[str] = []
    own: list[tuple[float, float]] = []
    rows: list[list[Checked]] = []
    for body in config.blocks:
        try:
            found = mechanisms(body)
        except ConfigError:
            raise
        except ValueError as error:
            names.append(body.name)
            own.append((math.nan, math.nan))
            rows.append([Checked(statement=str(error))] * len(codes))
            continue
        for name, senses in found.items():
            first = min(senses, key=lambda one: one.multiplier)
            names.append(name)
            own.append((first.multiplier, first.share))
            rows.append([_checked(code, senses, spectrum, body.floors, config.check) for code in codes])
    values = {
        "multiplier": np.array([one[0] for one in own]),
        "share": np.array([one[1] for one in own]),
        **({} if results is None else of_histories(results, config, names)),
        **{
            name: np.array([[getattr(one, name) for one in row] for row in rows])
            for name in (*Checked._fields, "activation_ratio")
        },
    }
    return xr.Dataset(
        {name: CHECK[name].variable(values[name]) for name in CHECK if name in values},
        {"block": names, "code": list(codes)},
        {"spectrum": spectrum.words, "limit_state": config.check.limit_state, **_factors(config.check)},
    )


def _checked(
    code: str,
    senses: Sequence[Mechanism],
    spectrum: DemandSpectrum,
    floors: Sequence[FloorSettings],
    settings: CheckSettings,
) -> Checked:
    try:
        return worst([CHECKS[code](one, spectrum, floors, settings) for one in senses])
    except TableEnds as error:
        return Checked(statement=str(error))


def worst(senses: Sequence[Checked]) -> Checked:
    """Of what a code says of the senses of a body the worse acceleration, and the worse displacement."""
    named = SENSES if len(senses) > 1 else ("",)

    def of_displacement(place: int) -> float:
        one = senses[place]
        if math.isnan(one.displacement_ratio):
            # Where a displacement is allowed, nothing holds the body there: worse than any ratio.
            return math.inf if math.isnan(one.displacement) else -math.inf
        return one.displacement_ratio

    places = range(len(senses))
    opens = min(places, key=lambda at: senses[at].activation)
    moves = min(places, key=of_displacement)
    told = dict.fromkeys(senses[at].statement for at in (opens, moves) if senses[at].statement)
    return senses[moves]._replace(
        activation=senses[opens].activation,
        activation_demand=senses[opens].activation_demand,
        statement="; ".join(told),
        activation_sense=named[opens],
        displacement_sense="" if math.isnan(senses[moves].displacement) else named[moves],
    )


def _factors(settings: CheckSettings) -> dict[str, float]:
    return {name: settings[name] for name in ("q", "confidence_factor", "q_a", "gamma_a")}
