"""Helpers for the readers of formats; CONTRIBUTING.md lists those that most formats use."""

# ruff: noqa: F401 - the formats import these names

from rockpulse.readers.kit.channel import PEAK_TOLERANCE, build_record, clipping_warning, usable_channels, with_warnings
from rockpulse.readers.kit.checks import (
    Counted,
    Span,
    completeness,
    contradictory,
    distinct_sections,
    doubted_direction,
    fixed_block,
    held_direction,
    held_length,
    held_lengths_of_units,
    held_peak_time,
    held_units,
    last_of_equal,
    repeated_marker,
    surplus,
)
from rockpulse.readers.kit.direction import Direction, direction, heading_direction, name_direction, on_structure
from rockpulse.readers.kit.facts import coordinates, instant, later, magnitudes, near_event, preferred, written
from rockpulse.readers.kit.motion_kinds import kind_of_name
from rockpulse.readers.kit.number_table import end_of_numbers, runs_on, split_row
from rockpulse.readers.kit.prose import (
    other_units,
    positive_downwards,
    reversed_polarity,
    stated_counts,
    stated_durations,
    stated_kinds,
    stated_peaks,
    stated_scales,
    stated_start,
    stated_station,
    stated_steps,
    stated_units,
    surely_counts,
)
from rockpulse.readers.kit.spacing import ChannelSamples, declared_points, make_even, pair_block, pair_unit, printed_at
from rockpulse.readers.kit.text import (
    ACCELERATION_FILE,
    FILE_DAMAGED,
    GIVE_INTERVAL,
    GIVE_UNIT,
    LINE_DAMAGED,
    LONGEST_LINE,
    OWN_FILE,
    TRUNCATED,
    UNITS,
    Entries,
    Entry,
    canonical_unit,
    check_count,
    fixed_width,
    free_numbers,
    free_rows,
    matched,
    no_acceleration,
    other_kind,
    printed_number,
    spelled_unit,
    text_lines,
    unexpected,
)
from rockpulse.readers.source import NotAcceleration, SourceFile
from rockpulse.record.record import STANDARD_GRAVITY, Record
