"""Compares records with rejected duplicates of the same ground motion, and the two components of one instrument."""

import math
from array import array
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import PurePath
from typing import Literal, NamedTuple

import numpy as np

from rockpulse.errors import Failure
from rockpulse.readers.kit.channel import SIGNS
from rockpulse.record.components import concurrent, folder_of, instrument, offset, sensor_level
from rockpulse.record.defects import deciding, with_defects
from rockpulse.record.record import Record, id_matches, outline_of
from rockpulse.warning_text import WarningText, find

#: Largest ratio of the peaks, and smallest correlation, of two records of the same ground motion.
LARGEST_RATIO, LEAST_CORRELATION = 1.5, 0.7
#: Largest ratio of the peaks of the two horizontal components of one instrument.
COMPONENTS_RATIO = 5.0
#: Largest relative difference of the sampling intervals of the two horizontal components of one instrument.
INTERVALS_APART = 0.01
#: Smallest correlation of two components of which one is a copy of the other, whatever its sign and scale.
COPY_CORRELATION = 0.999
#: Smallest angle between the axes of the two components of a pair that are compared [degrees].
LEAST_TURN = 45.0
#: Frequency band in which records are compared [Hz]; upper limit of the band as a share of the lower sampling rate.
BAND, BAND_SHARE = (0.5, 10.0), 0.4
#: Largest error of a clock [s]; for two records of the same ground motion with such an error, smallest correlation and
#: largest relative difference of the durations in which equal shares of the energy arrive.
CLOCK_S, CLOCK_CORRELATION, CLOCK_SHARE = 86400.0 + 60.0, 0.95, 0.02
#: Width of the classes of azimuth [degrees]; only records of one class are compared as the same motion.
SAME_LINE = 5.0
#: Possible cause of each ratio of two peaks; a measured ratio may differ from it by 1.5 %.
CAUSES = {
    10.0: "one of them may be in mm/s2 and read as cm/s2, or in g/10 and read as g",
    9.80665: "one of them may be in g and read as m/s2",
    98.0665: "one of them may be in g/10 and read as cm/s2",
    100.0: "one of them may be in cm/s2 and read as m/s2",
    980.665: "one of them may be in g and read as cm/s2",
    1000.0: "one of them may be in mm/s2 and read as m/s2",
}


@dataclass(frozen=True, eq=False, slots=True)
class Comparison:
    """Another record with which a channel that will be assessed is compared."""

    # a duplicate; a record that may be the same motion with a wrong clock, or scaled; the other component
    kind: Literal["duplicate", "clock", "copy", "component"]
    channel: int  # index of the channel among the channels of the record to be assessed
    other: Record  # as read
    beside: tuple[Record, ...] = ()  # the channels recorded together with the other record, as read

    @property
    def records(self) -> tuple[Record, ...]:
        """The other record, and the channels recorded together with it."""
        return self.other, *self.beside


class Likeness(NamedTuple):
    """The similarity of two records of the same ground motion, filtered and aligned in time."""

    ratio: float  #: peak of the second record divided by the peak of the first
    correlation: float  #: over their common time, from -1 to 1


def likeness(record: Record, other: Record) -> Likeness:
    """Return the similarity of two records in :data:`BAND`, aligned at the largest absolute cross-correlation."""
    dt = max(record.dt, other.dt)
    first, second = (
        np.interp(np.arange(0.0, one.duration + 0.5 * dt, dt), one.time, one.acceleration - np.mean(one.acceleration))
        for one in (record, other)
    )
    size = 1 << (first.size + second.size - 1).bit_length()
    frequency = np.fft.rfftfreq(size, dt)
    low, high = BAND[0], min(BAND[1], BAND_SHARE / dt)
    window = (frequency**4 / (frequency**4 + low**4)) / (1.0 + (frequency / high) ** 8)
    spectra = [np.fft.rfft(one, size) * window for one in (first, second)]
    one, two = (np.fft.irfft(spectrum, size)[: n.size] for spectrum, n in zip(spectra, (first, second), strict=True))
    cross = np.fft.irfft(np.conj(spectra[0]) * spectra[1], size)
    shift = int(np.argmax(np.abs(cross)))
    shift -= size if shift >= second.size else 0
    # A short common part may agree by chance: at least half of each energy enters the norm.
    least = [0.5 * float(each @ each) for each in (one, two)]
    begin, end = max(0, -shift), min(one.size, two.size - shift)
    one, two = one[begin:end], two[begin + shift : end + shift]
    norm = math.sqrt(max(float(one @ one), least[0]) * max(float(two @ two), least[1]))
    peaks = float(np.max(np.abs(one), initial=0.0)), float(np.max(np.abs(two), initial=0.0))
    if norm == 0.0 or peaks[0] == 0.0:
        return Likeness(math.inf, 0.0)
    return Likeness(peaks[1] / peaks[0], float(one @ two) / norm)


def compared(channels: Sequence[Record], comparisons: Iterable[Comparison]) -> list[Record]:
    """Return the channels as read, with a warning on each channel that a comparison makes doubtful."""
    found = list(channels)
    for one in comparisons:
        channel = channels[one.channel]
        if one.kind in ("copy", "component"):
            warning = (_copy if one.kind == "copy" else _components)(channel, one.other)
        else:
            warning = _duplicate(channel, one)
        if warning is not None:
            found[one.channel] = found[one.channel].with_warning(warning)
    return found


def clock_twin(channels: Sequence[Record], comparisons: Iterable[Comparison], confirm: Sequence[str]) -> list[Failure]:
    """Return a failure row for each channel that repeats another record with a different clock time.

    Confirmed records are preferred to others, then processed records to raw records.
    """

    def place(record: Record) -> tuple[bool, int, str]:
        return not id_matches(record.id, confirm), [True, None, False].index(record.processed), record.id

    for one in comparisons:
        channel = channels[one.channel]
        if one.kind != "clock" or place(channel) < place(one.other):
            continue
        like = likeness(channel, one.other)
        if abs(like.correlation) >= CLOCK_CORRELATION:
            off = abs(offset(channel, one.other))
            reason = (
                f"the same motion as {one.other.id} of {one.other.source} (correlation {like.correlation:.3f}), "
                f"which is used instead; their clocks differ by {off:.6g} s"
            )
            return [Failure(each.source, "select", f"{each.id}: {reason}", "duplicate") for each in channels]
    return []


def _duplicate(channel: Record, against: Comparison) -> WarningText | None:
    like = likeness(channel, against.other)
    if against.kind == "clock" and abs(like.correlation) < CLOCK_CORRELATION:
        return None
    turned = 0.0 if channel.orientation == "vertical" else math.radians(channel.azimuth - against.other.azimuth)
    said: list[str] = []
    if abs(like.correlation) < LEAST_CORRELATION:
        said.append(f"the correlation is {like.correlation:.2f}")
        crosswise = ((other.id, likeness(channel, other).correlation) for other in against.beside)
        if swapped := next((one for one in crosswise if abs(one[1]) >= LEAST_CORRELATION), None):
            name, correlation = swapped
            said[0] += f", and {correlation:.2f} with {name}: the labels of the components may be swapped"
    elif like.correlation * math.cos(turned) < 0.0:
        said.append("the sign is opposite: one of them may be positive in the opposite direction")
    if not 1.0 / LARGEST_RATIO <= like.ratio <= LARGEST_RATIO:
        said.append(": ".join(filter(None, (f"it is {_ratio(like.ratio)}", _cause(like.ratio)))))
    if not said:
        return None
    source, differences = PurePath(against.other.source).name, "; ".join(said)
    return WarningText("twin_differs", other=against.other.id, source=source, differences=differences, decides=True)


def _ratio(ratio: float) -> str:
    return f"{ratio:.3g} times stronger" if ratio > 1.0 else f"{1.0 / ratio:.3g} times weaker"


def _cause(ratio: float) -> str:
    size = max(ratio, 1.0 / ratio)
    return next((cause for factor, cause in CAUSES.items() if abs(size / factor - 1.0) < 0.015), "")


def _components(channel: Record, other: Record) -> WarningText | None:
    """Return a warning if one component is a copy of the other, or if their intervals or peaks differ too much."""
    if abs(channel.dt / other.dt - 1.0) > INTERVALS_APART:
        return WarningText("interval_apart", interval=channel.dt, other=other.id, stated=other.dt, decides=True)
    mine, others = (outline_of(one) for one in (channel, other))
    if not mine or not others or any(deciding(with_defects(one)) for one in (channel, other)):
        return None
    if _apart(mine, others):
        ratio = mine[1] / others[1]
        cause = _cause(ratio) or "a unit or gain may be wrong"
        return WarningText("components_apart", ratio=_ratio(ratio), other=other.id, cause=cause, decides=True)
    return _copy(channel, other)


def _copy(channel: Record, other: Record) -> WarningText | None:
    """Return a warning if the samples of a channel are those of another channel, multiplied by a number."""
    correlation = likeness(channel, other).correlation
    if abs(correlation) < COPY_CORRELATION:
        return None
    return WarningText("same_samples", other=other.id, turned=SIGNS[math.copysign(1.0, correlation)])


def _apart(mine: Sequence[float], others: Sequence[float]) -> bool:
    """Return whether the peaks in the outlines of two records differ by a factor of `COMPONENTS_RATIO` or more."""
    return not 1.0 < COMPONENTS_RATIO * mine[1] / others[1] < COMPONENTS_RATIO**2


def component_comparisons(channels: Sequence[Record], partner: dict[int, Record]) -> Iterator[Comparison]:
    """Yield a comparison for each channel whose partner has a very different peak or interval, or may be a copy."""
    for place, channel in enumerate(channels):
        other = partner.get(id(channel))
        if other is None or _between(channel, other) < LEAST_TURN:
            continue
        mine, others = outline_of(channel), outline_of(other)
        if not mine or not others:
            continue
        alike = np.allclose(mine[2:], others[2:], rtol=0.0, atol=2.0 * channel.dt)
        uneven = abs(channel.dt / other.dt - 1.0) > INTERVALS_APART
        if uneven or _apart(mine, others) or (alike and not find(channel.warnings, "same_samples")):
            yield Comparison("component", place, other)


def _between(one: Record, other: Record) -> float:
    """Return the angle between the axes of two channels [degrees], from 0 to 90; 90 if an azimuth is unknown."""
    between = one.azimuth - other.azimuth
    return abs(math.remainder(between, 180.0)) if math.isfinite(between) else 90.0


def uneven_partners(horizontal: Sequence[Record], partner: dict[int, Record]) -> dict[int, Record]:
    """Return, by ``id(channel)``, the channel that would form a pair with it if their sampling intervals were equal."""
    groups: dict[tuple[object, ...], list[Record]] = defaultdict(list)
    for record in horizontal:
        if id(record) not in partner and record.start_time is None and record.event:
            recorded = record.event, record.station_name, folder_of(record)
            groups[*instrument(record), *recorded].append(record)
    pairs = [group for group in groups.values() if len(group) == 2 and group[0].dt != group[1].dt]
    return {id(one): other for pair in pairs for one, other in (pair, pair[::-1])}


def copy_candidates(records: Sequence[Record]) -> dict[int, Record]:
    """Return, by ``id(record)``, a record of another file with the same length and nearly the same growth of energy."""
    groups: dict[tuple[int, float], tuple[list[Record], array[float]]] = defaultdict(lambda: ([], array("d")))
    for record in sorted(records, key=attrgetter("id")):
        if outline := outline_of(record):
            group, times_of_all = groups[record.npts, record.dt]
            group.append(record)
            times_of_all.extend(outline[2:])
    found: dict[int, Record] = {}
    for (_, dt), (group, times_of_all) in groups.items():
        unsorted = np.frombuffer(times_of_all).reshape(-1, 5)
        order = np.argsort(unsorted[:, 2], kind="stable")
        times, group = unsorted[order].T.copy(), [group[place] for place in order.tolist()]
        firsts, lasts = np.searchsorted(times[2], times[2] + np.array([[-2.1], [2.1]]) * dt)
        for place, record in enumerate(group):
            first, last = firsts[place], lasts[place]
            alike = np.all(np.abs(times[:, first:last] - times[:, place, None]) <= 2.0 * dt, axis=0)
            others = (group[first + step] for step in np.flatnonzero(alike).tolist())
            if other := next((one for one in others if one.source != record.source), None):
                found[id(record)] = other
    return found


def clock_candidates(records: Sequence[Record]) -> dict[int, Record]:
    """Return, by ``id(record)``, another record that may contain the same motion at a wrong clock time, if any."""
    groups: dict[tuple[object, ...], list[tuple[float, Record, np.ndarray]]] = defaultdict(list)
    for record in records:
        if not record.station or record.start_time is None or not (outline := outline_of(record)):
            continue
        if record.orientation != "vertical" and not math.isfinite(record.azimuth):
            continue
        line = -1 if record.orientation == "vertical" else round(record.azimuth % 180.0 / SAME_LINE) % 36
        spans = np.diff(outline[2:])
        floor = record.component if record.orientation == "structural" else ""
        key = record.network, record.station, record.location, sensor_level(record), line, floor
        groups[key].append((float(spans.sum()), record, spans))
    found: dict[int, Record] = {}
    for group in groups.values():
        group.sort(key=lambda one: (one[0], one[1].id))
        totals = np.array([total for total, _, _ in group])
        spans = np.array([each for _, _, each in group])
        starts = np.array([one.start_time.timestamp() for _, one, _ in group if one.start_time is not None])
        lasts = np.searchsorted(totals, totals * (1.0 + CLOCK_SHARE) + 0.1, side="right").tolist()
        for place, (total, record, own) in enumerate(group):
            near = slice(place + 1, lasts[place])
            alike = np.all(np.abs(spans[near] - own) <= CLOCK_SHARE * total + 2.0 * record.dt, axis=1)
            alike &= np.abs(starts[near] - starts[place]) <= CLOCK_S
            for step in np.flatnonzero(alike).tolist():
                other = group[place + 1 + step][1]
                if other.source != record.source and not concurrent(record, other):
                    found.setdefault(id(record), other)
                    found.setdefault(id(other), record)
                    break
    return found
