"""Both channels of a pair made ready for rotation: the same time, the same conditioning, the same samples."""

from __future__ import annotations

import math
from dataclasses import replace
from datetime import timedelta
from typing import Any

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.record.components import Pair, offset
from rockpulse.record.conditioning import QUIET_LENGTH, condition, quiet_length
from rockpulse.record.record import Record
from rockpulse.record.rotation import check_angle
from rockpulse.remark import Remark

#: Starts that differ from whole sampling intervals by less than this share of one are taken as whole.
CLOCK_SHARE = 1e-3


def condition_pair(pair: Pair, **options: Any) -> Pair:
    """Both channels conditioned alike on the time that they have in common, with the same samples.

    Parameters
    ----------
    pair : Pair
        As read.
    **options
        Those of :func:`rockpulse.condition`.

    Returns
    -------
    Pair
        Each channel cut to the common time, conditioned, and brought to the samples of the first: as they are where
        those of the second fall on them, else linear between them. What was cut is a warning.

    Raises
    ------
    RecordRefused
        For channels that face almost the same way, share fewer than two samples, or differ in their interval after the
        conditioning.
    ConfigError
        For options that :func:`rockpulse.condition` refuses.

    Notes
    -----
    Every step of the conditioning is linear in the samples but the search for the pre-event window. Both channels get
    the shorter one of the two that are found, or the mean where that is below 1 s, so that the channels may be
    conditioned and then rotated or rotated and then conditioned in this way, with the same result but for rounding.
    """
    check_angle(pair)
    if pair.first.processed != pair.second.processed:
        raise RecordRefused(
            f"{pair.first.id}, {pair.second.id}: one of them is a corrected volume and the other is not; "
            "take both channels from one volume"
        )
    cut = Pair(_cut(pair.first, pair.second), _cut(pair.second, pair.first))
    options, note = _with_common_window(cut, options)
    noted = [channel.with_note(note) if note else channel for channel in cut.channels]
    if pair.first.source != pair.second.source and None in (pair.first.start_time, pair.second.start_time):
        noted = [channel.with_warning(Remark("start_assumed")) for channel in noted]
    first, second = (condition(channel, **options) for channel in noted)
    if not math.isclose(first.dt, second.dt, rel_tol=1e-9):
        raise RecordRefused(
            f"{first.id}, {second.id}: expected one sampling interval, found {first.dt:g} and {second.dt:g} s; "
            "give [conditioning] resample_s"
        )
    return Pair(*_same_samples(first, second))


def _check_overlap(channel: Record, other: Record, samples: int) -> None:
    if samples < 2:
        raise RecordRefused(
            f"{channel.id}, {other.id}: expected two samples or more in the time that both have, found "
            f"{max(samples, 0)}; they are no pair"
        )


def _cut(channel: Record, other: Record) -> Record:
    """The channel within the time of the other one, widened to whole samples; a warning names the part left out."""
    start = offset(channel, other)
    share = CLOCK_SHARE
    begin = max(0, math.floor(start / channel.dt + share))
    end = min(channel.npts - 1, math.ceil((start + other.duration) / channel.dt - share))
    _check_overlap(channel, other, end - begin + 1)
    if begin == 0 and end == channel.npts - 1:
        return channel
    lost = [
        f"{length:.4g} s at its {place}"
        for length, place in ((begin * channel.dt, "start"), (channel.duration - end * channel.dt, "end"))
        if length > 0.0
    ]
    moved = None if channel.start_time is None else channel.start_time + timedelta(seconds=begin * channel.dt)
    cut = replace(channel, acceleration=channel.acceleration[begin : end + 1], start_time=moved)
    return cut.with_warning(f"cut to the time in common with {other.id}: {' and '.join(lost)} left out")


def _with_common_window(pair: Pair, options: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The conditioning options for both channels, and the note on their pre-event window."""
    baseline = options.get("baseline", "auto")
    searched = baseline == "pre-event" or (baseline == "auto" and pair.first.processed is False)
    if not searched or options.get("pre_event_s") is not None:
        return options, ""
    quiet = min(quiet_length(channel) for channel in pair.channels)
    if quiet >= QUIET_LENGTH:
        return {**options, "pre_event_s": quiet}, f"pre-event window of both channels: 0 to {quiet:.4g} s"
    note = f"pre-event window of both channels: {quiet:.4g} s only (needed: {QUIET_LENGTH:g} s), the mean instead"
    return {**options, "baseline": "mean"}, note


def _same_samples(first: Record, second: Record) -> tuple[Record, Record]:
    start = offset(first, second) / first.dt
    whole = abs(start - round(start)) < CLOCK_SHARE
    start = round(start) if whole else start
    kept = np.arange(max(0, math.ceil(start)), min(first.npts - 1, math.floor(start + second.npts - 1)) + 1)
    _check_overlap(first, second, kept.size)
    place = kept - start
    if kept.size == first.npts == second.npts and whole:
        return first, replace(second, start_time=first.start_time)
    moved = None if first.start_time is None else first.start_time + timedelta(seconds=float(kept[0]) * first.dt)
    if whole:
        values = second.acceleration[place.astype(int)]
    else:
        values = np.interp(place, np.arange(second.npts), second.acceleration)
        second = second.with_note(
            f"linear between its samples at those of {first.id}, {start % 1.0:.3f} of an interval"
        )
    return (
        replace(first, acceleration=first.acceleration[kept], start_time=moved),
        replace(second, acceleration=values, start_time=moved),
    )
