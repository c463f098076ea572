"""Ensemble of strong records and bodies, with one protocol for the rule and the code checks.

.. note:: The protocol: channels whose conditioned peak is above 0.15 g. The mean is removed, there is no taper, and the
   record is padded with zeros. The filter is a Butterworth of order 2 from 0.1 to 25 Hz with zero phase (without a
   low-pass if the Nyquist frequency is not higher). The record is 60 s long from 25 s before the peak, followed by 8 s
   of zeros; PGA and PGV refer to this part. The blocks have slenderness 4, 6, 8, 12, R of 1, 2, 4 m and Housner's
   restitution.
"""

import argparse
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rocking.body.block import Block
from rockpulse.config.settings import RecordSettings
from rockpulse.errors import ConfigError, Failure, RockpulseError, some
from rockpulse.readers.folders import read_all
from rockpulse.record.components import select_horizontal
from rockpulse.record.conditioning import condition
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.selection.directions import unconfirmed
from rockpulse.selection.duplicate_selection import unmatched_patterns, without_duplicates
from rockpulse.selection.events import group_events
from rockpulse.selection.tables import read_event_table

#: Bodies of the ensemble: every slenderness with every radius [m], Housner's restitution.
SLENDERNESS = (4.0, 6.0, 8.0, 12.0)
RADII = (1.0, 2.0, 4.0)
#: Weaker channels are left out [m/s2].
STRONG = 0.15 * STANDARD_GRAVITY
#: Corners of the band-pass [Hz] and the order of one pass.
BAND, ORDER = (0.1, 25.0), 2
#: The stretch that is judged: before the peak, in all, and the zeros after it [s].
BEFORE, LENGTH, QUIET = 25.0, 60.0, 8.0
#: The protocol in words, for the provenance of a fitted rule.
PROCESSING = (
    "mean removed, no taper, pads of zeros, Butterworth order 2, 0.1-25 Hz, zero phase; 60 s from 25 s before the "
    "peak, then 8 s of zeros; PGA and PGV of that stretch"
)
#: Two channels show one shaking where their waveforms about the peak correlate by this much [-]: the same record by way
#: of two agencies, with its samples rounded, resampled or turned round. Different ones of the sets at hand: below 0.52.
SAME_WAVEFORM = 0.95
#: The stretch that is compared, from the peak [s], and the interval [s].
COMPARED, COMPARED_DT = (-5.0, 15.0), 0.01


def blocks() -> Block:
    """The bodies of the ensemble, every slenderness with every radius, as the lanes of one block."""
    slenderness, radius = (values.ravel() for values in np.meshgrid(SLENDERNESS, RADII, indexing="ij"))
    alpha = np.arctan(1.0 / slenderness)
    return Block(half_width=radius * np.sin(alpha), half_height=radius * np.cos(alpha))


@dataclass(frozen=True, eq=False)
class StrongMotion:
    """A channel made ready."""

    record: Record  # the stretch that is judged, zeros included
    event: str  # label of its earthquake


def strong_motions(
    records: Iterable[Record],
    confirm: Sequence[str] = (),
    failures: Iterable[Failure] = (),
    titles: Mapping[str, str] | None = None,
    least: float = STRONG,
) -> tuple[list[StrongMotion], list[Failure]]:
    """The strong horizontal ground channels among records as read, one of each shaking, in the order given.

    With them come rows for the channels that are no horizontal ground motion, that another record of the same shaking
    stands for, by its station or by its waveform, that cannot be conditioned, or whose peak lies above 5 g and is not
    confirmed by a pattern of its id. Those below `least` [m/s2] are not named. A pattern that fits no id is an error,
    or a row where `failures` tell of files that could not be read.

    `titles` name the earthquake by record id in place of what the file says, such as "Kobe 1995-01-16": records are
    then grouped by name and year as by :func:`rockpulse.selection.events.group_events`. An id that no record has is a
    ConfigError.
    """
    titles = titles or {}
    every = [replace(record, event=titles.get(record.id, record.event)) for record in records]
    if unknown := sorted(set(titles) - {record.id for record in every}):
        raise ConfigError(f"--events: no record has the id {some(unknown, 5)}")
    idle = unmatched_patterns("--confirm", confirm, [record.id for record in every], failures)
    selected, rejected, _ = without_duplicates(every, RecordSettings(confirm=tuple(confirm)), advice="")
    horizontal, left_out = select_horizontal(selected, configured=False)
    rows = [*idle, *rejected, *left_out]
    found: list[tuple[Record, Record]] = []
    waveforms: list[np.ndarray] = []
    for record in horizontal:
        try:
            conditioned = _filtered(record)
        except (RockpulseError, ValueError) as error:  # scipy refuses records shorter than its pads
            rows.append(Failure(file=record.source, stage="rule", reason=str(error), kind="failed"))
            continue
        if doubt := unconfirmed(conditioned, confirm):
            rows.append(Failure(file=record.source, stage="rule", reason=doubt, kind="failed"))
        elif conditioned.pga > least:
            waveform = _waveform(conditioned)
            alike = np.flatnonzero([abs(waveform @ other) > SAME_WAVEFORM for other in waveforms])
            if alike.size:
                reason = f"{record.id}: the same waveform as {found[alike[0]][0].id}"
                rows.append(Failure(file=record.source, stage="rule", reason=reason, kind="duplicate"))
                continue
            waveforms.append(waveform)
            found.append((record, _stretch(conditioned)))
    events = group_events([record for record, _ in found])
    return [StrongMotion(stretch, event) for (_, stretch), event in zip(found, events, strict=True)], rows


def _filtered(record: Record) -> Record:
    low, high = BAND
    below = high if high < 0.5 / record.dt * (1.0 - 1e-9) else None
    return condition(record, baseline="mean", highpass_hz=low, lowpass_hz=below, order=ORDER, taper_s=0.0)


def _waveform(record: Record) -> np.ndarray:
    """The acceleration about its peak, of length 1."""
    acceleration = record.acceleration
    time = (np.arange(acceleration.size) - int(np.argmax(np.abs(acceleration)))) * record.dt
    around = np.interp(np.arange(*COMPARED, COMPARED_DT), time, acceleration, left=0.0, right=0.0)
    return np.asarray(around / np.linalg.norm(around))


def _stretch(record: Record) -> Record:
    acceleration, dt = record.acceleration, record.dt
    first = max(0, int(np.argmax(np.abs(acceleration))) - round(BEFORE / dt))
    kept = acceleration[first : first + round(LENGTH / dt) + 1]
    return replace(record, acceleration=np.concatenate([kept, np.zeros(round(QUIET / dt))]))


def add_record_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the records, and what may have to be said of them."""
    parser.add_argument("paths", nargs="+", help="files, folders, zips or globs of records")
    parser.add_argument("--units", help="unit of files that do not state theirs")
    parser.add_argument("--confirm", action="append", default=[], help="a peak above 5 g is right in this channel")
    parser.add_argument("--events", help="CSV table (record, event) for channels whose files name no earthquake")


def read_strong(args: argparse.Namespace, least: float = STRONG) -> list[StrongMotion]:
    """The strong motions that the arguments of :func:`add_record_arguments` name; what is left out is printed."""
    records, failures = read_all(args.paths, args.units)
    titles = read_event_table(Path(args.events)) if args.events else None
    motions, left_out = strong_motions(records, args.confirm, failures, titles, least)
    for row in (*failures, *left_out):
        print(f"not used ({row.kind}): {row.reason}")
    return motions
