"""Settings of the bodies of a configuration, their restraints and supports, and their conversion to blocks."""

from __future__ import annotations

import dataclasses
import logging
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rocking.body.limits import LARGEST_SIZE, radius_of_rectangle, size_problem
from rockpulse.config.restraint_settings import FloorSettings, LoadSettings, ThrustSettings, TieSettings
from rockpulse.errors import ConfigError, Remedy
from rockpulse.option import KeyType, Section, boolean, entries, is_number, key, number
from rockpulse.record.record import STANDARD_GRAVITY

if TYPE_CHECKING:
    from rocking import Block
    from rockpulse.config.settings import RecordSettings

logger = logging.getLogger("rockpulse")
#: Coefficient kappa of the period T_0 of a cantilever [-]: 2 pi sqrt(12)/1.8751^2, rounded as in Circolare 7/2019.
CANTILEVER = 6.2
#: An unusually large size is assumed to be in millimetres from this number on, and in centimetres below it.
_MILLIMETRES = 500.0


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip()) and "/" not in value and value.isprintable()


def _is_ratio(value: Any) -> bool:
    return is_number(value) and 0.0 <= value <= 1.0


def _is_restitution(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return bool(value) and all(_is_ratio(item) for item in value)
    return value == "housner" or _is_ratio(value)


def _restitution(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return tuple(float(item) for item in value)
    return value if isinstance(value, str) else float(value)


_NAME = KeyType('a printable text without "/"', _is_name, str)
_REBOUND = KeyType(
    'a number e in [0, 1], "sorrentino", or a list of such numbers',
    lambda value: value == "sorrentino" or (_is_restitution(value) and value != "housner"),
    _restitution,
    ("sorrentino",),
)
_RESTITUTION = KeyType(
    'a velocity ratio in [0, 1], "housner", or a list of such numbers', _is_restitution, _restitution, ("housner",)
)


_CORNERS = ("b_1", "b_2", "centre", "gyration")


@dataclass(frozen=True)
class PedestalSettings(Section):
    """A rectangular pedestal centred under a body; both may rock together as one body.

    `friction` is the coefficient of friction at the base of the pedestal, used to check whether both slide together.

    >>> pedestal = rp.PedestalSettings(width=0.9, height=1.2, mass=2300.0)
    >>> list(rp.BlockSettings("statue", 0.5, 1.8, mass=600.0, pedestals=[pedestal]).with_pedestals())
    ['statue with pedestal']
    """

    heading = "[[block.pedestal]]"
    width: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    height: float = number(dataclasses.MISSING, low=0.0, above=True, unit="m")
    mass: float = number(dataclasses.MISSING, low=0.0, above=True, unit="kg")
    friction: float | None = number(None, low=0.0, above=True)


@dataclass(frozen=True)
class BlockSettings(Section):
    """One body, defined by full width and height, by its corners, or by p and alpha with an optional radius.

    Attributes
    ----------
    name : str
        Unique in a configuration.
    width, height : float or None
        Full size in the plane of rocking [m].
    p, alpha, radius : float or None
        Frequency parameter [1/s] and critical angle [rad] of a body of another shape, and distance R from the corner to
        the centre of mass [m], which determines the largest restitution; by default the R of a rectangle with the
        same p and alpha.
    restitution : float, str or tuple of float
        Velocity ratio of an impact [-], "housner" (the largest that angular momentum allows), or several values that
        are assessed in parallel.
    gravity : float
        Acceleration of gravity at the block [m/s2].
    b_1, b_2, centre, gyration : float or None
        An asymmetric body (:meth:`rocking.Block.from_corners`) [m]: the horizontal distances of its corners from the
        centre of mass, the height of the centre of mass and the radius of gyration about it.
    offset, lean : float
        Distance of the centre of mass of a rectangle from the middle of its base towards theta > 0 [m], and tilt to
        that side [rad].
    one_sided : bool
        Whether the body stands against a wall and can fall only away from it.
    rebound : float, str, tuple of float or None
        For a one-sided body, instead of the restitution: the share of the speed that remains after the impact on the
        wall [-], or "sorrentino" (default), the value of Sorrentino et al. (:meth:`rocking.Block`).
    facing, azimuth : float or None
        Azimuths, clockwise from north [degrees], towards which a one-sided body falls, and in which the body rocks (for
        pairs of channels). `azimuth` is by default `facing`, or the azimuth of [records] if neither is given.
    friction : float or None
        Coefficient of friction at the base, used to check sliding [-].
    mass, density, length : float or None
        Mass [kg], or density [kg/m3] and length along the base [m]: needed with ties, loads or thrusts.
    compressive_strength : float or None
        Compressive strength f of the masonry [Pa], with width, height, density and length (by default 1 m, for a body
        without ties, loads and thrusts): the corners of rotation move inwards by half the depth N/(0.85 f length) of
        the compressed edge, N the weight of the body and of its loads.
        Code checks divide f by the confidence factor.
    elastic_modulus : float or None
        Young's modulus E of an element that is free to vibrate (parapet, pinnacle) [Pa], reduced for cracking; with
        width, height and density. Code checks then take the demand at its period T_0.
    kappa : float or None
        Coefficient of T_0 [-] (Circolare 7/2019, C8.7.1.7); by default 6.2, a cantilever.
    ties, loads, thrusts, floors, pedestals : tuple
        In TOML [[block.tie]], [[block.load]], [[block.thrust]], [[block.floor]] and [[block.pedestal]]. Floors are the
        modes of the building under the body; pedestals are the parts below it from top to bottom: the body is assessed
        alone, as one body with the first pedestal, as one body with the first two pedestals, and so on.
    confirm_size : bool
        Accept a body that is larger than 30 m, less than 5 cm high, less than 1 mm wide, or wider than high. For a body
        given by p and alpha these limits apply to the rectangle with its R and alpha.

    Raises
    ------
    ConfigError
        If not exactly one of the three definitions is given, a value is invalid, or keys contradict each other.

    Examples
    --------
    >>> BlockSettings(name="pier", width=1.0, height=3.873).block().half_width
    0.5
    """

    heading = "[[block]]"
    name: str = key(dataclasses.MISSING, _NAME)
    width: float | None = number(None, low=0.0, above=True, unit="m")
    height: float | None = number(None, low=0.0, above=True, unit="m")
    p: float | None = number(None, low=0.0, above=True, unit="1/s")
    alpha: float | None = number(None, low=0.0, above=True, unit="rad")
    radius: float | None = number(None, low=0.0, above=True, unit="m")
    restitution: float | str | tuple[float, ...] = key("housner", _RESTITUTION)
    gravity: float = number(STANDARD_GRAVITY, low=0.0, above=True, unit="m/s2")
    b_1: float | None = number(None, low=0.0, above=True, unit="m")
    b_2: float | None = number(None, low=0.0, above=True, unit="m")
    centre: float | None = number(None, low=0.0, above=True, unit="m")
    gyration: float | None = number(None, low=0.0, above=True, unit="m")
    offset: float = number(0.0, unit="m")
    lean: float = number(0.0, low=-1.0, high=1.0, unit="rad")
    one_sided: bool = boolean(False)
    rebound: float | str | tuple[float, ...] | None = key(None, _REBOUND)
    facing: float | None = number(None, low=0.0, high=360.0, unit="degrees")
    azimuth: float | None = number(None, low=0.0, high=360.0, unit="degrees")
    friction: float | None = number(None, low=0.0, above=True)
    mass: float | None = number(None, low=0.0, above=True, unit="kg")
    density: float | None = number(None, low=0.0, above=True, unit="kg/m3")
    length: float | None = number(None, low=0.0, above=True, unit="m")
    compressive_strength: float | None = number(None, low=0.0, above=True, unit="Pa")
    elastic_modulus: float | None = number(None, low=0.0, above=True, unit="Pa")
    kappa: float | None = number(None, low=0.0, above=True)
    confirm_size: bool = boolean(False)
    ties: tuple[TieSettings, ...] = entries(TieSettings)
    loads: tuple[LoadSettings, ...] = entries(LoadSettings)
    thrusts: tuple[ThrustSettings, ...] = entries(ThrustSettings)
    floors: tuple[FloorSettings, ...] = entries(FloorSettings)
    pedestals: tuple[PedestalSettings, ...] = entries(PedestalSettings)

    @property
    def where(self) -> str:
        """Name of this block in messages."""
        return f'[[block]] "{self.name}"' if _is_name(self.name) else self.heading

    def __post_init__(self) -> None:
        super().__post_init__()
        names = ("width", "height", "p", "alpha", "radius", *_CORNERS)
        given = {name for name in names if self[name] is not None}
        if given not in ({"width", "height"}, {"p", "alpha"}, {"p", "alpha", "radius"}, set(_CORNERS)):
            found = ", ".join(sorted(given)) or "none of these"
            raise ConfigError(
                f"{self.where}: expected one of: width and height [m]; p [1/s] and alpha [rad] (radius [m] optional); "
                f"b_1, b_2, centre and gyration [m]; found {found}"
            )
        if self.width is None and (self.offset or self.lean or self.density or self.length):
            raise ConfigError(f"{self.where}: remove offset, lean, density and length, which need width and height")
        if self.compressive_strength is not None:
            free = not (self.ties or self.loads or self.thrusts)
            if self.density is not None and self.length is None and free:
                object.__setattr__(self, "length", 1.0)  # the depth does not depend on it
            if self.density is None or self.length is None or self.pedestals:
                raise ConfigError(
                    f"{self.where} compressive_strength: crushing of the edge needs width, height and density (and "
                    "length, if there are ties, loads or thrusts), and no pedestal; change these keys, or remove "
                    "compressive_strength"
                )
        if self.p is not None and (self.ties or self.loads or self.thrusts or self.mass):
            raise ConfigError(
                f"{self.where}: mass, ties, loads and thrusts need a body given by width and height, or by b_1, "
                "b_2, centre and gyration; found one given by p and alpha"
            )
        if self.kappa is not None and self.elastic_modulus is None:
            raise ConfigError(f"{self.where} kappa: it applies only with elastic_modulus; give both, or remove kappa")
        bound = self.one_sided or self.ties or self.loads or self.thrusts
        if self.elastic_modulus is not None and (self.width is None or self.density is None or bound):
            raise ConfigError(
                f"{self.where} elastic_modulus: the period of an element that is free to vibrate needs width, height "
                "and density, and no wall, ties, loads or thrusts; change these keys, or remove elastic_modulus"
            )
        if not self.one_sided and (self.rebound is not None or self.facing is not None):
            raise ConfigError(
                f"{self.where}: rebound and facing apply only to a body against a wall; set one_sided = true"
            )
        if self.one_sided and self.restitution != "housner":
            raise ConfigError(f"{self.where} restitution: not allowed for a one-sided body; give rebound instead")
        if self.azimuth is not None and self.facing is not None and math.remainder(self.azimuth - self.facing, 180.0):
            raise ConfigError(
                f"{self.where} azimuth: {self.azimuth:g} contradicts facing = {self.facing:g}; remove one"
            )
        if self.pedestals and (bound or self.p is not None):
            raise ConfigError(
                f"{self.where}: a pedestal needs a free-standing body that is given by its sizes; found a body given "
                "by p and alpha, against a wall, or with ties, loads or thrusts"
            )
        if self.pedestals and not (self.mass or self.density):
            raise ConfigError(f"{self.where}: a body on a pedestal needs a mass; give mass, or density and length")
        if self.alpha is not None and self.alpha >= math.pi / 2:
            raise ConfigError(
                f"{self.where} alpha: expected an angle below pi/2 rad, found {self.alpha:g}; is it in degrees?"
            )
        if not self.confirm_size and (doubt := _doubt(self)):
            remedy = Remedy("confirm_size")
            raise ConfigError(f"{self.where}: {doubt}, or {remedy.advice()}", remedy)

    @property
    def initial_period(self) -> float:
        """T_0 = kappa (height/width) height sqrt(density/E) [s], Circolare 7/2019, (C8.7.1.7); 0 if E is not given."""
        if self.elastic_modulus is None or self.width is None or self.height is None or self.density is None:
            return 0.0
        kappa = CANTILEVER if self.kappa is None else self.kappa
        return kappa * self.height**2 / self.width * math.sqrt(self.density / self.elastic_modulus)

    @property
    def unsupported(self) -> float:
        """Rotation at which the beams of a load lose their support [rad]; inf if no support is given."""
        return min((one.support / one.height for one in self.loads if one.support is not None), default=math.inf)

    def block(self) -> Block:
        """Return the block, or one for each restitution in a list, and log its warnings; ConfigError if invalid."""
        from rocking import Block

        common: dict[str, Any] = {name: self[name] for name in ("restitution", "gravity", "one_sided", "rebound")}
        common = {name: list(value) if isinstance(value, tuple) else value for name, value in common.items()}
        common["log"] = False
        held: dict[str, Any] = {name: [one.made() for one in self[name]] for name in ("ties", "loads", "thrusts")}
        held["mass"] = self.mass
        try:
            if self.width is not None and self.height is not None:
                held |= {name: self[name] for name in ("offset", "lean", "density", "length", "compressive_strength")}
                block = Block(width=self.width, height=self.height, **common, **held)
            elif self.b_1 is not None:
                corners = {name: self[name] for name in ("b_1", "b_2", "gyration")}
                block = Block.from_corners(height=self["centre"], **corners, **common, **held)
            else:
                block = Block.from_parameters(**{name: self[name] for name in ("p", "alpha", "radius")}, **common)
        except ValueError as error:
            raise ConfigError(f"{self.where} {error}") from None
        for warning in block.warnings:
            logger.warning("block %s: %s", self.name, warning)
        return block

    def with_pedestals(self) -> dict[str, Block]:
        """Return, by name, this body joined with its first pedestal, with its first two pedestals, and so on."""
        from rocking.body.supports import with_pedestal

        found: dict[str, Block] = {}
        if not self.pedestals:
            return found
        whole = self.block()
        restitution = list(self.restitution) if isinstance(self.restitution, tuple) else self.restitution
        for place, part in enumerate(self.pedestals, 1):
            try:
                whole = with_pedestal(whole.lanes().lane(0), part.width, part.height, part.mass, restitution)
            except ValueError as error:
                raise ConfigError(f"{self.where} pedestal {place}: {error}") from None
            found[f"{self.name} with pedestal{'' if place == 1 else f' {place}'}"] = whole
        return found


def require_pairs(blocks: Iterable[BlockSettings], records: RecordSettings) -> None:
    """Raise ConfigError if a body has its own direction but channels are used as recorded."""
    own = [block.where for block in blocks if block.azimuth is not None]
    if own and records.components == "horizontal":
        raise ConfigError(
            f"{own[0]} azimuth: a body with its own direction needs pairs of channels; set [records] components to "
            '"strongest", "sweep", or "azimuth" (with [records] azimuth for the other bodies)'
        )


def _doubt(block: BlockSettings) -> str:
    """Return why the size of a body is probably wrong, and what to give instead; empty for usual sizes."""
    if block.width is not None and block.height is not None:
        width, height = block.width, block.height
        larger = "are these millimetres?" if max(width, height) >= _MILLIMETRES else "are these centimetres?"
        swapped = "are width and height swapped?" if width > height else "are these metres?"
        found = f"{width:g} x {height:g}: {larger if max(width, height) > LARGEST_SIZE else swapped}"
        advice = "give full sizes in m"
    elif block.centre is not None:
        assert block.b_1 is not None
        assert block.b_2 is not None
        width, height = block.b_1 + block.b_2, 2.0 * block.centre
        found, advice = f"a base of {width:g} m and a centre of mass {block.centre:g} m above it", "give sizes in m"
        found += "."
    else:
        assert block.p is not None
        assert block.alpha is not None
        radius = block.radius or radius_of_rectangle(block.p, block.gravity)
        width, height = 2.0 * radius * math.sin(block.alpha), 2.0 * radius * math.cos(block.alpha)
        source = "p and alpha" if block.radius is None else "radius and alpha"
        found = f"{source} of a rectangle of {width:.3g} x {height:.3g} m."
        advice = "give p = sqrt(M g R/I_0) in 1/s, alpha in rad, the radius in m"
    doubt = size_problem(width, height)
    return doubt and f"{found} A body {doubt} is accepted only if confirmed: {advice}"


def parse_block_option(option: str, confirm_size: bool = False) -> BlockSettings:
    """Parse ``NAME=WIDTHxHEIGHT`` with full sizes in m; raise ConfigError for other text or unusual sizes."""
    name, equals, size = option.rpartition("=")
    width, times, height = size.lower().partition("x")
    if not (equals and times):
        raise ConfigError(
            f'--block: expected NAME=WIDTHxHEIGHT with sizes in m, such as "pier=0.8x3.2", found "{option}"'
        )
    try:
        block = BlockSettings(name=name, width=float(width), height=float(height), confirm_size=True)
    except ConfigError as error:
        raise ConfigError(f'--block "{option}": {error}') from None
    except ValueError:
        raise ConfigError(f'--block "{option}": expected two numbers in m, found "{width}" and "{height}"') from None
    if not confirm_size and (doubt := _doubt(block)):
        raise ConfigError(f'--block "{option}": {doubt}, or add --confirm-size')
    return dataclasses.replace(block, confirm_size=confirm_size)
