"""Samples two horizontal channels at the same times, rotates the pair, and finds its strongest direction.

.. note:: Azimuths are in degrees, clockwise from north. A channel with the azimuth z records x . u(z), where x is the
   horizontal acceleration and u(z) = (cos z, sin z) the unit vector, both with a north and an east component. Two
   channels that are not parallel determine x, and therefore the acceleration in direction psi,

       a(psi) = [a_1 sin(z_2 - psi) + a_2 sin(psi - z_1)]/sin(z_2 - z_1)

   which is exact for any angle between the channels. As a(psi + 180) = -a(psi), a half circle contains all directions.
"""

import math
from dataclasses import replace
from datetime import datetime, timedelta
from itertools import pairwise
from typing import Any

import numpy as np

from rockpulse.errors import RecordRefused
from rockpulse.record.components import Pair, offset
from rockpulse.record.conditioning import QUIET_LENGTH, condition, quiet_samples
from rockpulse.record.defects import with_defects
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import BETWEEN, Record, record_id
from rockpulse.warning_text import WarningText, code_of, has_warning

#: Smallest sine of the angle between two channels (10 degrees), at which rotation multiplies their noise by 6.
SMALLEST_SINE = 0.17
#: Search for the strongest direction: successive steps [degrees]; number of maxima of the first step that are refined;
#: smallest ratio of these to the highest maximum.
STEPS = (1.0, 0.1, 0.01)
MAXIMA = 5
MAXIMA_SHARE = 0.9


def rotate(pair: Pair, azimuth: float) -> Record:
    """Return the record in one horizontal direction, computed from a pair of channels.

    Parameters
    ----------
    pair : Pair
        Two channels with the same sample times, as ``condition_pair`` returns them.
    azimuth : float
        Direction, clockwise from north [degrees].

    Returns
    -------
    Record
        The rotated record, with the direction in the channel code of its id (``H045``), and with the sources, warnings
        and processing steps of both channels; one more step states the formula. In the direction of a channel, the
        rotated record has the samples of this channel.

    Raises
    ------
    RecordRefused
        For channels in almost the same direction, or with different sample times.

    Examples
    --------
    >>> east = Record([0.0, 1.0, 0.0], dt=0.01, id="x.E", azimuth=90.0)
    >>> north = Record([0.0, 1.0, 1.0], dt=0.01, id="x.N", azimuth=0.0)
    >>> rotate(Pair(east, north), 30.0).acceleration.round(6).tolist()
    [0.0, 1.366025, 0.866025]
    """
    first, second = pair.channels
    check_angle(pair)
    if first.npts != second.npts or not math.isclose(first.dt, second.dt, rel_tol=1e-9):
        raise RecordRefused(
            f"{first.id}, {second.id}: expected the same sample times in both, found {first.npts} samples at "
            f"{first.dt:g} s and {second.npts} at {second.dt:g} s; use condition_pair"
        )
    one, other = _weights(first.azimuth, second.azimuth, azimuth)
    note = (
        f"rotated to {azimuth:g} degrees: {one:.6g} x {first.id} ({first.azimuth:g} degrees) {other:+.6g} x "
        f"{second.id} ({second.azimuth:g} degrees), a = [a1 sin(z2 - psi) + a2 sin(psi - z1)]/sin(z2 - z1)"
    )
    same_unit = (first.source_unit, first.unit_factor) == (second.source_unit, second.unit_factor)
    rotated = replace(
        first,
        acceleration=one * first.acceleration + other * second.acceleration,
        id=rotated_id(first, azimuth),
        channel=f"H{math.floor(azimuth + 0.5):03d}",
        component=rotated_component(azimuth),
        azimuth=float(azimuth),
        orientation="structural" if first.orientation == "structural" else "horizontal",
        source=BETWEEN.join(dict.fromkeys(filter(None, (first.source, second.source)))),
        source_sha256=BETWEEN.join(dict.fromkeys(filter(None, (first.source_sha256, second.source_sha256)))),
        source_unit=first.source_unit if same_unit else "",
        unit_factor=first.unit_factor if same_unit else float("nan"),
        header_peak=float("nan"),
        stage="checked",  # the channels were checked for defects
        # The drift of the velocity depends on the direction.
        warnings=tuple(
            text for text in _of_both(first, second, "warnings") if not has_warning(code_of(text), "baseline_drift")
        ),
        processing=(*_of_both(first, second, "processing"), note),
    )
    return condition(rotated, baseline="none")  # warns if the velocity in this direction drifts


def pair_id(pair: Pair) -> str:
    """Return the name of a pair: the id of its first channel with the codes of both channels."""
    return _name(pair.first, f"{pair.first.channel}-{pair.second.channel}")


def rotated_id(record: Record, azimuth: float) -> str:
    """Return the id of a pair rotated to an azimuth [degrees], given the first channel of the pair."""
    return _name(record, f"H{math.floor(azimuth + 0.5):03d}")


def strongest_azimuth(
    pair: Pair, threshold: float = 0.0, min_duration_s: float = 0.0, merge: bool = True
) -> tuple[float, float]:
    """Find the direction in which the largest half-wave impulse of a pair is largest.

    Parameters
    ----------
    pair : Pair
        Two channels with the same sample times.
    threshold, min_duration_s, merge
        Options of :func:`rockpulse.half_waves`.

    Returns
    -------
    azimuth : float
        Direction [degrees] from 0 to below 180, in steps of 0.01; the smallest if several give the same impulse.
    impulse : float
        The largest absolute half-wave impulse in that direction [m/s].

    Notes
    -----
    The impulse is a discontinuous function of the direction, as lobes split at zero and noise is merged, so that no
    formula gives its maximum. It is computed at every degree, then in steps of 0.1 and 0.01 degrees about the five
    highest local maxima (if above 0.9 times the highest one): in about 250 directions.

    Examples
    --------
    >>> azimuth, impulse = rp.strongest_azimuth(pair)
    >>> round(azimuth, 1), round(impulse, 2)
    (41.5, 1.43)
    """
    first, second = pair.channels
    check_angle(pair)
    found: dict[float, float] = {}

    def impulse(azimuth: float) -> float:
        azimuth = round(azimuth % 180.0, 6)
        if azimuth not in found:
            one, other = _weights(first.azimuth, second.azimuth, azimuth)
            turned = Record(one * first.acceleration + other * second.acceleration, first.dt, id=first.id)
            found[azimuth] = half_waves(turned, threshold, min_duration_s, merge).largest
        return found[azimuth]

    coarse = np.arange(0.0, 180.0, STEPS[0])
    values = np.array([impulse(azimuth) for azimuth in coarse])
    high = (values >= np.roll(values, 1)) & (values >= np.roll(values, -1)) & (values >= MAXIMA_SHARE * values.max())
    maxima = np.flatnonzero(high)
    for azimuth in coarse[maxima[np.argsort(-values[maxima], kind="stable")[:MAXIMA]]].tolist():
        for wide, narrow in pairwise(STEPS):
            steps = round(wide / narrow)
            around = [azimuth + narrow * step for step in range(-steps, steps + 1)]
            azimuth = max(around, key=impulse)
    largest = max(found.values())
    # Equal directions differ in their last digits.
    return min(azimuth for azimuth, value in found.items() if value >= largest * (1.0 - 1e-12)), largest


def rotated_component(azimuth: float) -> str:
    """Return the text of the field `component` for a record rotated to an azimuth [degrees]: "45 degrees, rotated"."""
    return f"{azimuth:g} degrees, rotated"


def _weights(first: float, second: float, azimuth: float) -> tuple[float, float]:
    between = _sine(second - first)
    return _sine(second - azimuth) / between, _sine(azimuth - first) / between


def _sine(degrees: float) -> float:
    """Return the sine of an angle in degrees; it is exact at multiples of 90 degrees."""
    turn = math.remainder(degrees, 360.0)
    folded = math.copysign(180.0, turn) - turn if abs(turn) > 90.0 else turn
    return math.sin(math.radians(folded))


def check_angle(pair: Pair) -> None:
    """Raise RecordRefused if the two channels of a pair are almost parallel, or if an azimuth is unknown."""
    first, second = pair.channels
    if not abs(_sine(second.azimuth - first.azimuth)) >= SMALLEST_SINE:
        raise RecordRefused(
            f"{first.id}, {second.id}: expected azimuths at least {math.degrees(math.asin(SMALLEST_SINE)):.3g} degrees "
            f"from parallel, found {first.azimuth:g} and {second.azimuth:g} degrees: they are not a horizontal pair; "
            'components = "horizontal" assesses them as they were recorded'
        )


def _name(record: Record, code: str) -> str:
    stem = record.id.removesuffix(f".{record.channel}")
    return record_id(record.network, record.station, record.location, code, record.start_time, stem, 0)


def _of_both(first: Record, second: Record, what: str) -> tuple[str, ...]:
    """Return the texts of both channels in the field `what`; a text of one channel begins with the channel's code."""
    mine, others = getattr(first, what), getattr(second, what)
    return tuple(
        text if text in mine and text in others else WarningText("of_channel", channel=record.channel, warning=text)
        for record, texts in ((first, mine), (second, others))
        for text in texts
        if record is first or text not in mine
    )


#: Largest deviation of a time from a whole number of sampling intervals that is ignored, as a share of an interval.
CLOCK_SHARE = 1e-3


def condition_pair(pair: Pair, **options: Any) -> Pair:
    """Condition both channels of a pair in the same way, and return them with the same sample times.

    Parameters
    ----------
    pair : Pair
        Two channels, in general as read.
    **options
        Options of :func:`rockpulse.condition`.

    Returns
    -------
    Pair
        Each channel cut to the common time, conditioned, and sampled at the times of the first channel: the second one
        is unchanged if its samples are at these times, else linearly interpolated. A warning states what was cut.

    Raises
    ------
    RecordRefused
        For channels in almost the same direction, with fewer than two common samples, or with different intervals after
        conditioning.
    ConfigError
        For options that :func:`rockpulse.condition` rejects.

    Notes
    -----
    The shorter of the two pre-event windows is used for both channels; if it is shorter than 1 s, the mean of all
    samples is subtracted instead. Every step is therefore linear in the samples, so that conditioning may precede or
    follow rotation.

    Examples
    --------
    >>> rp.condition_pair(pair, highpass_hz=0.1).second.processing[-1].split(",")[0]
    'filter: Butterworth high-pass 0.1 Hz'
    """
    check_angle(pair)
    if pair.first.processed != pair.second.processed:
        raise RecordRefused(
            f"{pair.first.id}, {pair.second.id}: one of them is a corrected record and the other is not; "
            "use two corrected channels, or two raw ones"
        )
    first, second = map(with_defects, pair.channels)
    cut = Pair(_cut(first, second), _cut(second, first))
    if all(channel.stage == "conditioned" for channel in pair.channels):
        return Pair(*_same_samples(*cut.channels))
    options, note = _with_common_window(cut, options)
    noted = [channel.with_note(note) if note else channel for channel in cut.channels]
    if pair.first.source != pair.second.source and None in (pair.first.start_time, pair.second.start_time):
        noted = [channel.with_warning(WarningText("start_assumed")) for channel in noted]
    first, second = (channel if channel.stage == "conditioned" else condition(channel, **options) for channel in noted)
    if not math.isclose(first.dt, second.dt, rel_tol=1e-9):
        raise RecordRefused(
            f"{first.id}, {second.id}: expected the same sampling interval in both, found {first.dt:g} and "
            f"{second.dt:g} s; give [conditioning] resample_s"
        )
    return Pair(*_same_samples(first, second))


def _check_overlap(channel: Record, other: Record, samples: int) -> None:
    if samples < 2:
        raise RecordRefused(
            f"{channel.id}, {other.id}: expected at least two samples in their common time, found "
            f"{max(samples, 0)}; they are not a pair"
        )


def _cut(channel: Record, other: Record) -> Record:
    """Return the channel cut to its common time with another channel, with a warning that states what was cut."""
    start = offset(channel, other)
    begin = max(0, math.floor(start / channel.dt + CLOCK_SHARE))
    end = min(channel.npts - 1, math.ceil((start + other.duration) / channel.dt - CLOCK_SHARE))
    _check_overlap(channel, other, end - begin + 1)
    if begin == 0 and end == channel.npts - 1:
        return channel
    ends = ((begin * channel.dt, "start"), (channel.duration - end * channel.dt, "end"))
    lost = [f"{length:.4g} s at its {place}" for length, place in ends if length > 0.0]
    cut = replace(channel, acceleration=channel.acceleration[begin : end + 1], start_time=_after(channel, begin))
    return cut.with_warning(f"cut to the time in common with {other.id}: {' and '.join(lost)} left out")


def _with_common_window(pair: Pair, options: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """Return options with one pre-event window for both channels, and a processing step that states this window."""
    baseline = options.get("baseline", "auto")
    searched = baseline == "pre-event" or (baseline == "auto" and pair.first.processed is False)
    if not searched or options.get("pre_event_s") is not None:
        return options, ""
    quiet = min((quiet_samples(channel) - 1) * channel.dt for channel in pair.channels)
    if quiet >= QUIET_LENGTH:
        return {**options, "pre_event_s": quiet}, f"pre-event window of both channels: 0 to {quiet:.4g} s"
    note = f"pre-event window of both channels: {quiet:.4g} s only (needed: {QUIET_LENGTH:g} s)"
    return {**options, "baseline": "mean"}, f"{note}: mean of all samples instead"


def _after(record: Record, samples: float) -> datetime | None:
    return None if record.start_time is None else record.start_time + timedelta(seconds=samples * record.dt)


def _same_samples(first: Record, second: Record) -> tuple[Record, Record]:
    start = offset(first, second) / first.dt
    whole = abs(start - round(start)) < CLOCK_SHARE
    start = round(start) if whole else start
    kept = np.arange(max(0, math.ceil(start)), min(first.npts - 1, math.floor(start + second.npts - 1)) + 1)
    _check_overlap(first, second, kept.size)
    place = kept - start
    if kept.size == first.npts == second.npts and whole:
        return first, replace(second, start_time=first.start_time)
    moved = _after(first, float(kept[0]))
    if whole:
        values = second.acceleration[place.astype(int)]
    else:
        values = np.interp(place, np.arange(second.npts), second.acceleration)
        note = f"interpolated linearly at the sample times of {first.id}, {start % 1.0:.3f} of an interval apart"
        second = second.with_note(note)
    first = replace(first, acceleration=first.acceleration[kept], start_time=moved)
    return first, replace(second, acceleration=values, start_time=moved)
