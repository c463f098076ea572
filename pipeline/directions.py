"""The motions that are assessed: channels as recorded, or pairs of them rotated."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from rockpulse.components import Pair, find_pairs, matching_vertical
from rockpulse.config import Config
from rockpulse.failures import Failure
from rockpulse.pair_conditioning import condition_pair
from rockpulse.record import Record, distinct_ids
from rockpulse.rotation import pair_id, rotate, strongest_azimuth

__all__ = ["DIRECTIONS", "Motion", "acting_vertical", "ground_motions", "sweep_azimuths"]

logger = logging.getLogger("rockpulse")


@dataclass(frozen=True, eq=False)
class Motion:
    """A horizontal motion that is assessed.

    Attributes
    ----------
    record : Record
        A channel as read, or a rotated pair, which is conditioned already.
    channels : tuple of Record
        The channels behind it, as read.
    pair : str
        Name of the pair that was rotated; empty for a channel as recorded.
    """

    record: Record
    channels: tuple[Record, ...]
    pair: str = ""


def ground_motions(horizontal: Sequence[Record], config: Config) -> tuple[list[Motion], list[Failure]]:
    """The motions to assess, as ``[records] components`` asks for them.

    Parameters
    ----------
    horizontal : sequence of Record
        Horizontal channels.
    config : Config
        Sections records, conditioning and half_waves are used.

    Returns
    -------
    motions : list of Motion
        With different ids; those of a pair one after the other.
    failures : list of Failure
        A row for each channel without a partner and each pair that cannot be rotated.
    """
    if config.records.components == "horizontal":
        return [Motion(record, (record,)) for record in horizontal], []
    pairs, failures = find_pairs(horizontal)
    motions = []
    names = _distinct([pair_id(pair) for pair in pairs])
    for pair, name in zip(pairs, names, strict=True):
        try:
            conditioned = condition_pair(pair, **config.conditioning)
            azimuths = DIRECTIONS[config.records.components](conditioned, config)
            motions += [Motion(rotate(conditioned, azimuth), pair.channels, name) for azimuth in azimuths]
        except ValueError as error:
            logger.error("%s: %s", name, error)
            failures += [Failure(channel.source, "rotate", str(error), "failed") for channel in pair.channels]
    records = distinct_ids([motion.record for motion in motions])
    return [replace(motion, record=record) for motion, record in zip(motions, records, strict=True)], failures


def acting_vertical(motion: Motion, verticals: Sequence[Record], config: Config) -> tuple[Record, Record | None]:
    """The record of a motion, with a warning where its vertical channel is in doubt, and that channel.

    Parameters
    ----------
    motion : Motion
        A horizontal motion.
    verticals : sequence of Record
        Vertical channels to choose from, as read.
    config : Config
        ``[records] include_vertical`` says whether one acts at all.

    Returns
    -------
    record : Record
        That of the motion.
    vertical : Record or None
        As read; None where none acts.
    """
    record = motion.record
    if not config.records.include_vertical:
        return record, None
    found = (matching_vertical(channel, verticals) for channel in motion.channels)
    vertical = next((one for one in found if one is not None), None)
    if vertical is None:
        record = record.with_warning("no vertical channel of this station overlaps: taken as zero")
    elif vertical.start_time is None and vertical.source not in [channel.source for channel in motion.channels]:
        record = record.with_warning("vertical channel: taken to start with this one, no times are known")
    return record, vertical


def sweep_azimuths(step: float) -> list[float]:
    """Directions from 0 up to 180 degrees, which are all: the motion in the opposite direction is the mirror image.

    Parameters
    ----------
    step : float
        A whole part of 180 degrees.
    """
    count = round(180.0 / step)
    return [180.0 * number / count for number in range(count)]


def _given(pair: Pair, config: Config) -> list[float]:
    assert config.records.azimuth is not None
    return [config.records.azimuth]


def _strongest(pair: Pair, config: Config) -> list[float]:
    return [strongest_azimuth(pair, **config.half_waves)[0]]


def _sweep(pair: Pair, config: Config) -> list[float]:
    return sweep_azimuths(config.records.azimuth_step)


#: The directions in which a conditioned pair is assessed, by the word of ``[records] components``.
DIRECTIONS: dict[str, Callable[[Pair, Config], list[float]]] = {
    "azimuth": _given,
    "strongest": _strongest,
    "sweep": _sweep,
}


def _distinct(names: Iterable[str]) -> list[str]:
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name}~{seen[name]}")
    return result
