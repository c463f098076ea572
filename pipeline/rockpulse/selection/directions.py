"""Chooses the ground motions to assess, without reading samples: channels as recorded, or pairs to be rotated."""

import logging
import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

from rockpulse.config.configuration import Config
from rockpulse.errors import Failure, RecordRefused, Remedy, RockpulseError, stored_remedies
from rockpulse.readers.kit.channel import CREDIBLE_PEAK_G, odd_peak
from rockpulse.readers.kit.text import GIVE_UNIT
from rockpulse.record.components import Neighbours, Pair, find_pairs, matching_vertical, select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.defects import deciding
from rockpulse.record.record import STANDARD_GRAVITY, Record, id_matches
from rockpulse.record.rotation import condition_pair, pair_id, rotate, rotated_id, strongest_azimuth
from rockpulse.selection.twins import (
    Comparison,
    clock_candidates,
    compared,
    component_comparisons,
    copy_candidates,
    uneven_partners,
)
from rockpulse.warning_text import WarningText

logger = logging.getLogger("rockpulse")
#: Largest peak that is used without confirmation [m/s2].
LARGEST = CREDIBLE_PEAK_G[1] * STANDARD_GRAVITY
#: Largest angle to the requested direction at which a channel without a partner is used [degrees].
FACING_WITHIN = 1.0


@dataclass(frozen=True, eq=False, slots=True)
class PlannedMotion:
    """A record to be assessed: a channel or a pair of channels to be rotated, and the vertical channel used with it."""

    name: str  # id of the channel, or name of the pair; unique
    channels: tuple[Record, ...]  # one channel, or both channels of a pair, as read
    vertical: Record | None = None  # as read
    partner: Record | None = None  # for one channel: the other channel of its pair, as read, for the intensity of both
    warnings: tuple[str, ...] = ()  # warnings that each record made from the channels gets
    copy: int = 1  # number, from 1, among pairs whose rotated records would have the same id
    comparisons: tuple[Comparison, ...] = ()  # other records with which the channels are compared

    @property
    def rotated(self) -> bool:
        """Whether the record is a pair of channels to be rotated."""
        return len(self.channels) > 1

    def direction_id(self, azimuth: float) -> str:
        """Return the id of the record that is made from the pair in the direction `azimuth` [degrees]."""
        name = rotated_id(self.channels[0], azimuth)
        return name if self.copy == 1 else f"{name}~{self.copy}"


@dataclass(frozen=True, eq=False)
class Motion:
    """A conditioned horizontal record to be assessed, with its vertical acceleration."""

    record: Record  # a channel or a rotated pair, conditioned
    vertical: Record | None = None  # the vertical channel that acts together with it, conditioned
    channels: tuple[Record, ...] = ()  # the channel or pair from which the record is made, conditioned
    partner: Record | None = None  # the other channel of a single channel's pair, conditioned

    @property
    def pair(self) -> tuple[Record, ...]:
        """Return the channels whose intensity is measured: both channels of a pair, or the only known channel."""
        return self.channels if self.partner is None else (*self.channels, self.partner)


class VerticalRefused(RecordRefused):
    """Error: the vertical channel used with a horizontal record cannot be conditioned."""


def plan_motions(
    records: Sequence[Record], config: Config, twins: Mapping[str, list[Comparison]] | None = None
) -> tuple[list[PlannedMotion], list[Failure]]:
    """Return the channels and pairs to be assessed according to section [records], and failures of other channels.

    A channel without a pair is used if it is within :data:`FACING_WITHIN` of the requested azimuth. If a demand is a
    value of an intensity measure, each single channel is kept together with the other channel of its pair, because both
    channels have the same scale factor. `twins` are comparisons with rejected duplicates, by id of the accepted record.
    """
    horizontal, failures = select_horizontal(records, config.records.structural)
    pairs, alone = find_pairs(horizontal)
    partner = {id(one): other for pair in pairs for one, other in (pair.channels, pair.channels[::-1])}
    if config.records.components == "horizontal":
        alone.clear()  # there may be 100,000 of these rows
        planned = [PlannedMotion(record.id, (record,)) for record in horizontal]
    else:
        facing = [_facing(record, config.records.azimuth) for record in horizontal if id(record) not in partner]
        failures += [row for row, one in zip(alone, facing, strict=True) if one is None]
        names = _copies([pair_id(pair) for pair in pairs])
        rotated = _copies([rotated_id(pair.first, 0.0) for pair in pairs])
        planned = [
            PlannedMotion(f"{name}~{number}" if number > 1 else name, pair.channels, copy=copy)
            for pair, (name, number), (_, copy) in zip(pairs, names, rotated, strict=True)
        ]
        place = {id(record): number for number, record in enumerate(horizontal)}
        planned += [one for one in facing if one is not None]
        planned.sort(key=lambda one: place[id(one.channels[0])])
    planned = _with_comparisons(planned, horizontal, partner, twins or {})
    if any(one.selection is None for one in config.demands):
        planned = [one if one.rotated else _with_partner(one, partner.get(id(one.channels[0]))) for one in planned]
    if not config.records.include_vertical:
        return planned, failures
    verticals = Neighbours([record for record in records if record.orientation == "vertical"])
    return [_with_vertical(one, verticals) for one in planned], failures


def conditioned_motions(planned: PlannedMotion, config: Config) -> list[Motion]:
    """Return the conditioned channel, or for a pair one conditioned record in each requested direction."""
    up = _conditioned_vertical(planned, config)
    planned = replace(planned, channels=tuple(compared(planned.channels, planned.comparisons)), comparisons=())
    if not planned.rotated:  # its warnings precede the warnings of conditioning
        warnings, partner = planned.warnings, None
        if planned.partner is not None:
            try:
                partner = conditioned(planned.partner, config)
            except RockpulseError as error:
                reason = f"the other channel, {planned.partner.id}, cannot be conditioned: {error}"
                warnings = (*warnings, WarningText("scaled_alone", reason=reason))
        motion = conditioned(_warned(planned.channels[0], warnings), config)
        return [Motion(motion, up, (motion,), partner)]
    pair = condition_pair(Pair(*planned.channels), **config.conditioning)
    azimuths = DIRECTIONS[config.records.components](pair, config)
    turned = [replace(rotate(pair, azimuth), id=planned.direction_id(azimuth)) for azimuth in azimuths]
    return [Motion(_warned(record, planned.warnings), up, pair.channels) for record in turned]


def conditioned(record: Record, config: Config) -> Record:
    """Condition a record with the options of section [conditioning]; a conditioned record is returned unchanged."""
    return record if record.stage == "conditioned" else condition(record, **config.conditioning)


def _conditioned_vertical(planned: PlannedMotion, config: Config) -> Record | None:
    if planned.vertical is None:
        return None
    try:
        return conditioned(planned.vertical, config)
    except RockpulseError as error:
        raise VerticalRefused(
            f"the vertical channel {planned.vertical.id} of {planned.name} cannot be conditioned: {error}. "
            "Correct its file or section [conditioning], or leave vertical motion out: include_vertical = false under "
            "[records]"
        ) from error


def _warned(record: Record, warnings: Iterable[str]) -> Record:
    return replace(record, warnings=(*record.warnings, *warnings))


def planned_ids(planned: PlannedMotion, config: Config) -> list[str]:
    """Return the ids of the records to be assessed; empty for the strongest direction, which depends on the samples."""
    if not planned.rotated:
        return [planned.name]
    if config.records.components == "strongest":
        return []
    return [planned.direction_id(azimuth) for azimuth in DIRECTIONS[config.records.components](None, config)]


def swept_directions(planned: Iterable[PlannedMotion], config: Config) -> dict[str, list[str]] | None:
    """Return the ids of the records in all directions, by name of the pair; None without a sweep over directions."""
    return {one.name: planned_ids(one, config) for one in planned} if config.records.components == "sweep" else None


def _with_comparisons(
    planned: Iterable[PlannedMotion],
    horizontal: Sequence[Record],
    partner: dict[int, Record],
    twins: Mapping[str, list[Comparison]],
) -> list[PlannedMotion]:
    """Add to each record to be assessed the other records with which its channels are compared."""
    clocks, copies, found = clock_candidates(horizontal), copy_candidates(horizontal), []
    near = partner | uneven_partners(horizontal, partner)
    for one in planned:
        comparisons = list(component_comparisons(one.channels, near))
        for place, channel in enumerate(one.channels):
            comparisons += [replace(twin, channel=place) for twin in twins.get(channel.id, ())]
            if id(channel) in clocks:
                comparisons.append(Comparison("clock", place, clocks[id(channel)]))
            elif id(channel) in copies and copies[id(channel)] is not partner.get(id(channel)):
                comparisons.append(Comparison("copy", place, copies[id(channel)]))
        found.append(replace(one, comparisons=tuple(comparisons)))
    return found


def _facing(record: Record, azimuth: float | None) -> PlannedMotion | None:
    """Return a channel without a pair as a record to be assessed if its direction is the azimuth; otherwise None."""
    if azimuth is None or not abs(math.remainder(record.azimuth - azimuth, 180.0)) <= FACING_WITHIN:
        return None
    against = abs(math.remainder(record.azimuth - azimuth, 360.0)) > FACING_WITHIN
    mirrored = " (its mirror image, with the same result for a body that rocks to both sides)" if against else ""
    motion = f"assessed as recorded, at {record.azimuth:g} degrees, in place of {azimuth:g} degrees"
    warning = f"no second channel: {motion}{mirrored}"
    return PlannedMotion(record.id, (record,), warnings=(warning,))


def _with_partner(planned: PlannedMotion, other: Record | None) -> PlannedMotion:
    if other is not None:
        return replace(planned, partner=other)
    alone = WarningText("scaled_alone", reason="no other horizontal channel is known to belong to it")
    return replace(planned, warnings=(*planned.warnings, alone))


def _with_vertical(planned: PlannedMotion, verticals: Neighbours) -> PlannedMotion:
    found = (matching_vertical(channel, verticals.of(channel)) for channel in planned.channels)
    vertical = next((one for one in found if one is not None), None)
    if vertical is None:
        return replace(planned, warnings=(*planned.warnings, WarningText("vertical_missing")))
    warnings = planned.warnings
    if vertical.start_time is None and vertical.source not in [channel.source for channel in planned.channels]:
        warnings = (*warnings, WarningText("vertical_start_assumed"))
    return replace(planned, vertical=vertical, warnings=warnings)


def sweep_azimuths(step: float) -> list[float]:
    """Return the directions from 0 to below 180 degrees at equal steps; `step` must divide 180."""
    count = round(180.0 / step)
    return [180.0 * number / count for number in range(count)]


#: For each value of ``[records] components``, a function that returns the directions in which a conditioned pair is
#: assessed; only the strongest direction depends on the pair.
DIRECTIONS: dict[str, Callable[[Any, Config], list[Any]]] = {
    "azimuth": lambda pair, config: [config.records.azimuth],
    "strongest": lambda pair, config: [strongest_azimuth(pair, **config.half_waves)[0]],
    "sweep": lambda pair, config: sweep_azimuths(config.records.azimuth_step),
}


def _copies(names: Iterable[str]) -> list[tuple[str, int]]:
    """Return each name with the number of times that it has occurred so far, including this one."""
    seen: dict[str, Iterator[int]] = defaultdict(lambda: count(1))
    return [(name, next(seen[name])) for name in names]


def unconfirmed(conditioned: Record, confirm: Iterable[str]) -> RecordRefused | None:
    """Return the error for a channel with a doubtful peak or defect that the user has not confirmed, else None."""
    if id_matches(conditioned.id, confirm):
        return None
    if conditioned.pga > LARGEST:
        found = odd_peak(conditioned.pga, conditioned.source_unit, conditioned.unit_factor)
        return _too_strong(f"{conditioned.id}: {found}", [conditioned])
    if defects := deciding(conditioned):
        remedy = Remedy("confirm", (conditioned.id,))
        return RecordRefused(
            f"{conditioned.id}: {'; '.join(defects)}; it is not used until it is confirmed: correct or leave out "
            f"the file, or, if it is right, give {remedy.advice()}",
            remedy,
        )
    return None


def unconfirmed_channels(
    planned: PlannedMotion, motions: Sequence[Motion], config: Config, stage: str
) -> list[Failure]:
    """Return a failure for each channel that is left out because it, or a channel used with it, is doubtful."""
    confirm, first = config.records.confirm, motions[0]
    of_pair = f"{planned.name}: " if planned.rotated else ""
    acting = [(of_pair, one) for one in first.channels]
    others = (("its vertical channel", first.vertical), ("the other channel of its pair", first.partner))
    acting += [(f"{planned.name}: {whose} ", one) for whose, one in others if one is not None]
    doubted = [(one, error, whose) for whose, one in acting if (error := unconfirmed(one, confirm))]
    rows = [_row(one, stage, error, whose) for one, error, whose in doubted]
    if doubted:
        cause, doubtful = doubted[0][0], [id(one) for one, _, _ in doubted]
        peak = f"whose peak of {cause.pga / STANDARD_GRAVITY:.3g} g" if cause.pga > LARGEST else "whose defect"
        reason = f"left out together with {cause.id}, {peak} has not been confirmed"
        rest = [one for one in first.channels if id(one) not in doubtful]
        rows += [Failure(one.source, stage, f"{of_pair}{one.id}: {reason}", "failed") for one in rest]
    strongest = max((motion.record for motion in motions), key=lambda record: record.pga)
    open_to_doubt = [one for one in first.channels if not id_matches(one.id, confirm)]
    if planned.rotated and not rows and open_to_doubt and strongest.pga > LARGEST:
        peak = f"peak {strongest.pga / STANDARD_GRAVITY:.3g} g, turned to {strongest.azimuth:g} degrees"
        rows = [_row(strongest, stage, _too_strong(f"{planned.name}: {peak}", open_to_doubt))]
    for row in rows:
        logger.error("%s", row.reason)
    return rows


def _row(record: Record, stage: str, error: RockpulseError, whose: str = "") -> Failure:
    return Failure(record.source, stage, f"{whose}{error}", "failed", stored_remedies(error.remedies))


def _too_strong(found: str, channels: Sequence[Record]) -> RecordRefused:
    remedy = Remedy("confirm", tuple(one.id for one in channels))
    return RecordRefused(
        f"{found}; a peak above {CREDIBLE_PEAK_G[1]:g} g after conditioning is rejected unless it is confirmed: "
        "correct the unit (--units, units under [records] or [[records.file]], or the file), or, if it is right, give "
        f"{remedy.advice()}",
        GIVE_UNIT,
        remedy,
    )
