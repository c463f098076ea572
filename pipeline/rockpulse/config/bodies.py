"""The bodies of an assessment, from a configuration or from Python, combined in one array of blocks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from numbers import Real
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from rocking.body.block import Block
from rocking.body.limits import most_restitution, size_problem
from rocking.body.restraint import Restraints, Tie
from rockpulse.config.block_settings import BlockSettings, require_pairs
from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError
from rockpulse.warning_text import WarningText, with_codes

#: Largest mass of a body divided by the mass of its floor [-] at which the body hardly changes the floor's motion.
LIGHT = 0.05


class FeltMotion(NamedTuple):
    """The direction and the building modes that determine the motion under a body."""

    azimuth: float | None  #: azimuth to which the pair is rotated [degrees]; None for the azimuth of the record
    floors: tuple[FloorSettings, ...]  #: modes of the building under the body; empty on the ground


@dataclass(frozen=True, eq=False)
class Bodies:
    """The bodies of an assessment, in the order of the configuration, with one block for each body and restitution."""

    names: tuple[str, ...]
    #: Array of len(names) x `cases` blocks; the blocks of one body, with its restitutions, are adjacent.
    lanes: Block
    #: Number of restitution values per body; 1 unless a body has a list (other bodies then repeat their value).
    cases: int
    #: Full width and height of each body [m]; NaN for a body given by p and alpha.
    width: np.ndarray
    height: np.ndarray
    #: Azimuth towards which each one-sided body falls [degrees]; NaN if unknown.
    facing: np.ndarray
    #: Azimuth to which pairs of channels are rotated for each body [degrees]; NaN for the azimuth of the records.
    azimuth: np.ndarray
    #: Coefficient of friction at the base of each body [-]; NaN if not given.
    friction: np.ndarray
    #: Modes of the building under each body; empty on the ground.
    floors: tuple[tuple[FloorSettings, ...], ...]
    #: Name of the body that is combined with its pedestal; empty for other bodies.
    pedestal_of: tuple[str, ...]
    #: Warnings on each body, one per line, and their codes, separated by blanks.
    warnings: tuple[str, ...]
    warning_codes: tuple[str, ...]
    #: Largest number of ties of a body.
    tie_count: int

    def places(self, azimuth: float | None, within: float = 0.0) -> list[tuple[FeltMotion, np.ndarray]]:
        """Return each different motion under the bodies, with the indices of the bodies to which it applies.

        A direction that differs from `azimuth` by at most `within` degrees is treated as `azimuth`.
        """
        own = []
        for direction, floors in zip(self.azimuth.tolist(), self.floors, strict=True):
            other = azimuth is not None and abs(math.remainder(direction - azimuth, 180.0)) > within
            own.append(FeltMotion(direction if other else None, floors))
        every = sorted(dict.fromkeys(own), key=lambda place: (place.azimuth is not None, len(place.floors)))
        return [(one, np.flatnonzero([place == one for place in own])) for one in every]

    def chosen(self, places: np.ndarray) -> Bodies:
        """Return the bodies with these indices."""
        lanes = (places[:, np.newaxis] * self.cases + np.arange(self.cases)).reshape(-1)
        some: dict[str, Any] = {
            name: getattr(self, name)[places] for name in ("width", "height", "facing", "azimuth", "friction")
        }
        for name in ("names", "floors", "pedestal_of", "warnings", "warning_codes"):
            some[name] = tuple(getattr(self, name)[place] for place in places)
        return Bodies(lanes=self.lanes.take(lanes), cases=self.cases, tie_count=self.tie_count, **some)

    def per_case(self, values: np.ndarray) -> np.ndarray:
        """Reshape the values of all blocks (..., b x c), for b bodies with c restitutions each, to (..., b, c)."""
        return values.reshape(*values.shape[:-1], len(self.names), self.cases)

    def apart(self) -> tuple[list[str], Block, np.ndarray]:
        """Return names ("wall C 0.9"), blocks and body indices, with one entry for each body and restitution."""
        names, kept = [], []
        for place, (name, own) in enumerate(
            zip(self.names, self.per_case(np.asarray(self.lanes.restitution)), strict=True)
        ):
            ratios = own.tolist()
            values = list(dict.fromkeys(ratios))
            brief = [f"{ratio:g}" for ratio in values]
            shown = brief if len(set(brief)) == len(values) else [repr(ratio) for ratio in values]
            names += [name] if len(values) == 1 else [f"{name} C {ratio}" for ratio in shown]
            kept += [place * self.cases + ratios.index(ratio) for ratio in values]
        if len(set(names)) < len(names):
            twice = next(name for name in names if names.count(name) > 1)
            raise ConfigError(
                f'block "{twice}": two bodies get this name when restitutions are added to the names; rename one'
            )
        return names, Block.stack([self.lanes.lane(lane) for lane in kept]), np.array(kept) // self.cases


def gather_bodies(blocks: Blocks, records: RecordSettings | None = None) -> Bodies:
    """Collect the bodies of a configuration or from Python; an array of c blocks is one body with c restitutions."""
    bodies = list(given_bodies(blocks))
    if records is not None:
        require_pairs([one for _, one in bodies if isinstance(one, BlockSettings)], records)
    plain = [one for _, one in bodies if isinstance(one, BlockSettings) and _is_plain(one)]
    whole = _rectangles(plain)
    alike = {one.name for one in plain} if whole is not None else set()
    named: dict[str, Block | None] = {}  # None for the bodies in `whole`
    given: dict[str, BlockSettings] = {}
    alone: dict[str, str] = {}
    for body, one in bodies:
        if isinstance(one, Block):
            own: dict[str, Block | None] = {body: one}
        else:
            own = {body: None if body in alike else one.block(), **one.with_pedestals()}
        if twice := own.keys() & named.keys():
            raise ConfigError(f'[[block]]: two bodies have the name "{min(twice)}"; rename one')
        named |= own
        if isinstance(one, Block):
            continue
        given |= dict(zip(own, [one, *(replace(one, friction=part.friction) for part in one.pedestals)], strict=True))
        alone |= {name: one.name for name in own if name != one.name}
    if not named:
        raise ConfigError("no body to assess: give [[block]] entries in the configuration or --block NAME=WIDTHxHEIGHT")
    single = {name: block for name, block in named.items() if block is not None}
    lengths = {name: block.shape[0] for name, block in single.items() if block.shape}
    if len(set(lengths.values())) > 1:
        raise ConfigError(f"restitution: expected lists of equal length in all blocks, found {lengths}")
    gravities = {block.gravity for block in (*single.values(), whole) if block is not None}
    if len(gravities) > 1:
        raise ConfigError(f"gravity: expected one value for all blocks of an assessment, found {sorted(gravities)}")
    cases = next(iter(lengths.values()), 1)
    for name, block in single.items():
        if any(np.ptp(values) > 0.0 for values in (block.p, block.alpha_c, block.radius)):
            raise ConfigError(
                f'block "{name}": the blocks of one body may differ only in restitution; '
                "give bodies of different sizes different names"
            )

    facing, azimuth = _values_of_key(given, named, "facing"), _values_of_key(given, named, "azimuth")
    held = {name: block.lanes().lane(0).restraints for name, block in single.items()}
    ties = {name: own.ties if isinstance(own, Restraints) else () for name, own in held.items()}
    warned = {
        name: with_codes(
            [*block.warnings, *(_heavy(given[name], block) if name in given else []), *_unlimited(ties[name])]
        )
        for name, block in single.items()
    }
    warned = {name: warned.get(name, ("", "")) for name in named}
    parts = [block.lanes(cases) for block in single.values()]
    if whole is not None:
        parts.append(whole.take(np.repeat(np.arange(len(alike)), cases)))
    kept = np.array([block is not None for block in named.values()])
    place = np.where(kept, np.cumsum(kept) - 1, len(single) + np.cumsum(~kept) - 1)  # index in `parts`
    lanes = (place[:, np.newaxis] * cases + np.arange(cases)).reshape(-1)
    stacked = Block.stack(parts)
    blocks_in_order = stacked if whole is None else stacked.take(lanes)
    return Bodies(
        names=tuple(named),
        lanes=blocks_in_order,
        cases=cases,
        width=np.max(np.reshape(blocks_in_order.width, (-1, cases)), axis=1),
        height=np.max(np.reshape(blocks_in_order.height, (-1, cases)), axis=1),
        facing=facing,
        azimuth=np.where(np.isnan(azimuth), facing, azimuth),
        friction=_values_of_key(given, named, "friction"),
        floors=tuple(given[name].floors if name in given else () for name in named),
        pedestal_of=tuple(alone.get(name, "") for name in named),
        warnings=tuple(words for words, _ in warned.values()),
        warning_codes=tuple(codes for _, codes in warned.values()),
        tie_count=max(map(len, ties.values()), default=0),
    )


#: Keys that may be given for a rectangle that is made together with others, and its smallest slenderness (a body of
#: slenderness below 3 gets a warning).
PLAIN = ("name", "width", "height", "gravity", "confirm_size", "azimuth", "friction")
LEAST_PLAIN = 3.001
_DEFAULTS = {one.name: one.default for one in fields(BlockSettings) if one.name not in PLAIN}


def _is_plain(body: BlockSettings) -> bool:
    """Return whether a body is a free rectangle of usual size with Housner's restitution, and so without warnings."""
    width, height = body.width, body.height
    if width is None or height is None or height < LEAST_PLAIN * width or size_problem(width, height):
        return False
    return all(getattr(body, name) == value for name, value in _DEFAULTS.items())


def _rectangles(bodies: Sequence[BlockSettings]) -> Block | None:
    """Return plain bodies as one array of blocks; None if there are no bodies, or if their gravities differ."""
    gravities = {body.gravity for body in bodies}
    if len(gravities) != 1:
        return None
    width, height = ([getattr(body, name) for body in bodies] for name in ("width", "height"))
    block = Block(width=width, height=height, gravity=gravities.pop(), log=False)
    # numpy squares one number and an array differently in the last digit: each body has the C that it has alone.
    pairs = zip(np.asarray(block.p), np.asarray(block.alpha_c), strict=True)
    most = np.array([most_restitution(p, alpha, None, block.gravity) for p, alpha in pairs])
    return block.changed(restitution=most, restitution_2=most)


def _unlimited(ties: Sequence[Tie]) -> list[str]:
    return [
        WarningText("tie_unlimited", number=number, height=tie.height)
        for number, tie in enumerate(ties, 1)
        if math.isinf(tie.ultimate)
    ]


def refuse_floors(bodies: Bodies, why: str) -> None:
    """Raise ConfigError with the reason `why` if a body is on a floor of a building."""
    names = [name for name, floors in zip(bodies.names, bodies.floors, strict=True) if floors]
    if names:
        raise ConfigError(f"[[block.floor]] of {', '.join(names)}: {why}; remove these bodies or their floors")


def _values_of_key(given: Mapping[str, BlockSettings], names: Iterable[str], key: str) -> np.ndarray:
    """Return the value of a key for each body; NaN if no value was given or the body is a Block."""
    values = [given[name][key] if name in given else None for name in names]
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _heavy(body: BlockSettings, block: Block) -> list[str]:
    masses = [floor.mass for floor in body.floors if floor.mass is not None]
    mass = float(np.max(block.mass))
    if not masses or not mass > LIGHT * min(masses):
        return []
    return [
        f"mass {mass:.4g} kg is {mass / min(masses):.2g} times the mass of its floor: the floor's motion is computed "
        f"without the body, which is accurate up to a ratio of {LIGHT:g}"
    ]


#: Bodies: a mapping from names to full (width, height) in m, Blocks or BlockSettings; a sequence of BlockSettings; or
#: one Block.
Blocks: TypeAlias = Mapping[str, tuple[float, float] | Block | BlockSettings] | Sequence[BlockSettings] | Block

EXPECTED = (
    'bodies: expected a mapping of names to (width, height) in m, such as {"wall": (0.25, 2.2)}, to Block or to '
    "BlockSettings, or a sequence of BlockSettings, or one Block"
)


def given_bodies(blocks: Blocks) -> Iterator[tuple[str, Block | BlockSettings]]:
    """Yield the name and the body of each block; sizes become BlockSettings; raise ConfigError for other input."""
    if isinstance(blocks, Block | BlockSettings):
        blocks = {getattr(blocks, "name", "block"): blocks}
    if isinstance(blocks, Mapping):
        for name, body in blocks.items():
            yield name, _named(name, body)
    elif isinstance(blocks, Sequence) and not isinstance(blocks, str):
        for body in blocks:
            if not isinstance(body, BlockSettings):
                raise ConfigError(f"{EXPECTED}; found a sequence with {_found(body)}")
            yield body.name, body
    else:
        raise ConfigError(f"{EXPECTED}; found {_found(blocks)}")


def _named(name: Any, body: Any) -> Block | BlockSettings:
    if not isinstance(name, str):
        raise ConfigError(f"bodies: expected strings as the names of bodies, found {_found(name)}")
    if isinstance(body, Block):
        return body
    if isinstance(body, BlockSettings):
        return replace(body, name=name)
    size = body if isinstance(body, (tuple, list)) else ()
    if len(size) != 2 or not all(isinstance(value, Real) and not isinstance(value, bool) for value in size):
        raise ConfigError(
            f'bodies "{name}": expected (width, height) in m, a Block or BlockSettings, found {_found(body)}'
        )
    return BlockSettings(name=name, width=float(size[0]), height=float(size[1]))


def _found(value: Any) -> str:
    """Describe a wrong value by its type and the first 60 characters of its text."""
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) <= 60 else text[:57] + '...'}"
