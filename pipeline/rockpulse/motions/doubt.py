"""Motions that are hardly earthquakes: until they are confirmed they decide nothing."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Sequence

from rockpulse.config.configuration import Config
from rockpulse.errors import Failure
from rockpulse.motions.directions import Motion, PlannedMotion
from rockpulse.readers.kit.channel import CREDIBLE_PEAK_G, odd_peak
from rockpulse.record.record import STANDARD_GRAVITY, Record, id_matches

logger = logging.getLogger("rockpulse")

#: No larger peak counts before it is confirmed [m/s2].
LARGEST = CREDIBLE_PEAK_G[1] * STANDARD_GRAVITY


def unconfirmed(conditioned: Record, confirm: Iterable[str], configured: bool = True) -> str:
    """Why a channel does not count, and what to do: its peak lies above 5 g, and no pattern of its id confirms it.

    Empty for every other channel. Without a configuration (`configured`) the advice names command-line options alone.
    """
    if not conditioned.pga > LARGEST or id_matches(conditioned.id, confirm):
        return ""
    found = odd_peak(conditioned.pga, conditioned.source_unit, conditioned.unit_factor)
    return f"{conditioned.id}: {found}. {_advice([conditioned], configured)}"


def unconfirmed_peaks(planned: PlannedMotion, motions: Sequence[Motion], config: Config, stage: str) -> list[Failure]:
    """A row for each channel for which a channel or a pair is left out, its vertical one and its partner among them.

    A horizontal channel that is left out with such a channel has a row of its own, behind them.
    A pair of which only a rotated motion lies above 5 g is left out as a whole, unless both channels are confirmed.
    """
    confirm = config.records.confirm
    channels, up = motions[0].channels, motions[0].vertical
    of_pair = f"{planned.name}: " if planned.rotated else ""
    acting = [(of_pair, one) for one in channels]
    if up is not None:
        acting.append((f"{planned.name}: its vertical channel ", up))
    if motions[0].partner is not None:
        acting.append((f"{planned.name}: the other channel of its pair ", motions[0].partner))
    doubted = {id(one): told for _, one in acting if (told := unconfirmed(one, confirm))}
    rows = [
        Failure(one.source, stage, f"{whose}{doubted[id(one)]}", "failed")
        for whose, one in acting
        if id(one) in doubted
    ]
    if doubted:
        cause = next(one for _, one in acting if id(one) in doubted)
        peak = f"whose peak of {cause.pga / STANDARD_GRAVITY:.3g} g nobody has confirmed"
        rows += [
            Failure(one.source, stage, f"{of_pair}{one.id}: left out with {cause.id}, {peak}", "failed")
            for one in channels
            if id(one) not in doubted
        ]
    strongest = max((motion.record for motion in motions), key=lambda record: record.pga)
    open_to_doubt = [one for one in channels if not id_matches(one.id, confirm)]
    if planned.rotated and not rows and open_to_doubt and strongest.pga > LARGEST:
        peak = f"peak {strongest.pga / STANDARD_GRAVITY:.3g} g, turned to {strongest.azimuth:g} degrees"
        rows = [Failure(strongest.source, stage, f"{planned.name}: {peak}. {_advice(open_to_doubt)}", "failed")]
    for row in rows:
        logger.error("%s", row.reason)
    return rows


def _advice(channels: Sequence[Record], configured: bool = True) -> str:
    options = " ".join(f"--confirm {one.id}" for one in channels)
    names = ", ".join(f'"{one.id}"' for one in channels)
    units = "--units, units under [records] or [[records.file]], or the file" if configured else "--units, or the file"
    confirm = f"{options}, or confirm = [{names}] under [records]" if configured else options
    return (
        f"A peak above {CREDIBLE_PEAK_G[1]:g} g after conditioning does not count before it is confirmed: correct the "
        f"unit ({units}), or, if it is right, give {confirm}"
    )
