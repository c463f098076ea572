"""Warnings on records and results: each has a code and values, from which the English text is made."""

import json
import re
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

#: Template for each code of a warning on a record or of a processing step.
WARNINGS = {
    # a channel when it is read
    "dead_channel": "all samples are equal: a dead channel",
    "clipped": "{count:d} samples in a row at the {end} value: the record may be clipped",
    "clipped_crests": "{count:d} crests are flat at the largest or smallest value: the record may be clipped",
    "full_scale": "the peak reaches the limit of a 24-bit recorder ({counts:d} counts): the record may be clipped",
    "header_peak": "the header states a peak of {stated:.4g} g, but the data have {found:.4g} g; check the unit, and "
    "whether the file is complete",
    "header_peak_near": "the header states a peak of {stated:.4g} g, but the data have {found:.4g} g: {share:.1f} % "
    "{sense}",
    "odd_peak": "peak {peak:.3g} g if the unit is {unit}; {readings}",
    "scale_stated": "the header states a scale factor of {factor:g}; the samples are used as they are in the file",
    "same_direction": "channels {first} and {second} have the same direction; check their names",
    "same_samples": "the samples are those of {other}{turned}: one of them is a copy",
    "resampled_clock": "the times of the file are uneven by up to {uneven:.2g} of a step: interpolated at their mean "
    "interval of {interval:.6g} s",
    "long_interval": "a sampling interval of {interval:g} s is long for an accelerogram; check that it is in s",
    "part_of_record": "part {part:d} of a record that is split into several files; give all of them together",
    "vertical_by_code": "the channel code {channel} means vertical, but the header states {stated}; used as vertical",
    "may_be_vertical": "{stated}, and the channel may be vertical",
    "length_differs": "the header states a duration of {stated:g} s, "
    "but {count:d} samples at {interval:g} s last {found:g} s",
    "positive_downwards": "positive downwards in the file; the sign is changed so that upwards is positive",
    # the samples of a channel
    "noise_only": "no earthquake, but noise or a dead channel: {reason}",
    "held_value": "the samples stay at one value for {length:.3g} s from {start:.4g} s on, as in a gap",
    "filled_gap": "the samples are a straight line for {length:.3g} s from {start:.4g} s on, as in a filled gap",
    "repeated_samples": "{share:.0f} % of the samples of the strong motion repeat the preceding one",
    "repeated_block": "the samples of {length:.3g} s from {start:.4g} s on are repeated from {again:.4g} s on",
    "spike": "spikes: samples far outside the range of their neighbours, {count:d} in all, the largest of {peak:.3g} "
    "g at {time:.4g} s",
    "starts_strong": "the record begins in strong motion, at {share:.0f} % of its peak (root mean square of the first "
    "0.5 s): its beginning is missing",
    "ends_strong": "the record ends in strong motion, at {share:.0f} % of its peak (root mean square of the last "
    "0.5 s): its end is missing",
    "coarse_sampling": "{rate:.3g} samples per second: frequencies above {nyquist:.3g} Hz are missing, and peaks "
    "between samples are cut off",
    "velocity_drift": "baseline drift or step in the samples as read: whatever constant is subtracted, the slow drift "
    "of the ground velocity reaches {slow:.3g} m/s, the remaining motion {rest:.3g} m/s",
    # comparison with other records of the same ground motion
    "twin_differs": "{other} of {source} should be a record of the same ground motion, but {differences}",
    "components_apart": "its peak is {ratio} than that of {other}, the other component of its instrument: {cause}",
    "interval_apart": "its sampling interval is {interval:g} s, that of {other}, the other component of its "
    "instrument, {stated:g} s: one of them may be wrong",
    # conditioning and scaling of a record
    "on_structure": "recorded on a structure, assessed as ground motion",
    "orientation_unknown": "the orientation is unknown; assessed as horizontal",
    "direction_given": "the file states no direction; {side} is the direction that the user gave for the pair",
    "baseline_guessed": "the format does not state whether the record is processed: the mean was subtracted; set "
    "[conditioning] baseline to keep the offset or to remove it in another way",
    "baseline_drift": "baseline drift: the ground velocity ends at {velocity:.3g} m/s, its slow drift reaches "
    "{slow:.3g} m/s, and the PGV of {pgv:.3g} m/s may be wrong by as much; compare with another "
    "[conditioning] baseline, or with a high-pass filter (highpass_hz)",
    "start_assumed": "both channels are assumed to start together; their files state no times",
    "no_sequence": "no impulse sequence: {reason}",
    "scaled_far": "scaled by {factor:.3g}, outside {low:g} to {high:g}: the record no longer represents an "
    "earthquake of the strength to which it is scaled",
    "scaled_alone": "scaled to the demand by its own intensity, not by that of a pair: {reason}",
    "scaled_to_drift": "scaled to a PGV that is doubtful, because the baseline of the record drifts",
    # the vertical channel of a record
    "vertical_acceleration": "vertical acceleration: {record}",
    "vertical_missing": "no vertical channel of this station overlaps in time: vertical acceleration taken as zero",
    "vertical_start_assumed": "vertical channel: assumed to start together with this channel; the files state no times",
    "vertical_short": "vertical channel: its acceleration is taken as zero in the {missing:.4g} s that it does not "
    "cover",
    # a design sequence
    "demand_not_compared": "a sequence has no PGA or other intensity that could be scaled to the demand of the site "
    "([[demand]]): the demand is not used",
    # a body
    "tie_unlimited": "tie {number:d} at {height:.3g} m never breaks, because no ultimate elongation is given; give "
    "ultimate, the elongation at which the tie or its anchor fails",
    # a warning on another record that this one uses
    "of_vertical": "vertical channel: {warning}",
    "of_channel": "{channel}: {warning}",
}

#: Template for each code of a warning on results.
STATEMENTS = {
    "plain": "{text}",
    # parts of a warning
    "record": "{count:d} record",
    "records": "{count:d} records",
    "event": "{count:d} earthquake",
    "events": "{count:d} earthquakes",
    "interval": "{low:.3g} to {high:.3g}",
    # the calibration of a site
    "scaled_far_in_all": "{count:d} of {total:d} records are scaled by less than {low:g} or more than {high:g} (from "
    "{least:.2g} to {most:.2g}): their duration and impulse interval are those of earthquakes of another strength",
    "too_few_events": "not enough earthquakes ({count:d}; at least {least:d} for the quantile {quantile:g})",
    "outside_spectrum": "no design for bodies outside the range of the spectrum: {names}",
    "vertical_left_out": "the vertical acceleration is left out: with it, no single spectrum would apply to all bodies",
    # a fragility curve
    "band_one_event": "no band: without the earthquake {event} there would be no curve",
    "band_few_events": "no band: the records come from {events}; at least {needed:d} are needed",
    "median_above": "extrapolated: the median, {median:.3g}, lies above all levels that were analysed, up to "
    "{level:.3g}; {reached} of {records:d} reached the limit state",
    "median_below": "extrapolated: the median, {median:.3g}, lies below all levels that were analysed, from "
    "{level:.3g}; {reached} of {records:d} reached the limit state",
    "no_record": "no curve: no record",
    "one_record_reached": "no curve: only one record (limit state reached at {levels}); at least two are needed for a "
    "dispersion",
    "one_record_not_reached": "no curve: only one record (limit state not reached at {levels}); at least two are "
    "needed for a dispersion",
    "nothing_reached": "no curve: none of {records} reached the limit state, at levels up to {level:.3g}",
    "nothing_reached_between": "no curve: none of {records} reached the limit state, although their highest levels are "
    "{low:.3g} to {high:.3g}",
    "everything_reached": "no curve: the limit state was reached by each of {records} at every level, from "
    "{level:.3g}; add lower levels",
    "one_reached": "no curve: only one of {records:d} records reached the limit state (at {levels}); at least two are "
    "needed for a dispersion",
    "step": "the curve is a step at {level:.3g}: all known capacities are equal; there is no dispersion",
    "not_increasing": "no curve: the limit state is not reached more often at higher levels",
    "no_maximum": "no curve: no maximum of the likelihood was found",
    "one_level": "no curve: all motions have the same level, {level:.3g}; at least two levels are needed for a "
    "dispersion",
    "separated_at": "no curve: no motion below {level:.3g} and every motion above it reached the limit state; the "
    "dispersion cannot be determined; add levels nearby",
    "separated": "no curve: no motion up to {low:.3g} and every motion from {high:.3g} reached the limit state; the "
    "median lies between them, the dispersion cannot be determined",
    "not_stronger": "no curve: the motions that reached the limit state are no stronger than the others",
}

TEMPLATES = WARNINGS | STATEMENTS
#: Code of a warning without a template.
PLAIN = "plain"


class WarningText(str):
    """A warning as English text, with a code from `TEMPLATES`, or two for a nested warning: ``of_vertical/clipped``.

    >>> WarningText("clipped", count=8, end="largest")
    '8 samples in a row at the largest value: the record may be clipped'
    """

    code: str
    values: dict[str, Any]

    def __new__(cls, code: str, /, **values: Any) -> "WarningText":
        """Make a warning from its code and the values that its template contains."""
        shown = {name: ", ".join(one) if isinstance(one, list) else one for name, one in values.items()}
        warning = super().__new__(cls, TEMPLATES[code].format_map(shown))
        warning.code = f"{code}/{code_of(values['warning'])}" if "warning" in values else code
        warning.values = values
        return warning

    def __getnewargs_ex__(self) -> tuple[tuple[str], dict[str, Any]]:
        return (self.code.partition("/")[0],), self.values


def code_of(text: str) -> str:
    """Return the code of a warning; `PLAIN` for any other text."""
    return text.code if isinstance(text, WarningText) else PLAIN


def find(warnings: Iterable[str], code: str) -> WarningText | None:
    """Return the first of the warnings with this code; None if no warning has it."""
    return next((one for one in warnings if isinstance(one, WarningText) and one.code == code), None)


@lru_cache(maxsize=1024)
def has_warning(codes: str, *wanted: str) -> bool:
    """Return whether stored codes contain a `wanted` code, alone or as a part of a nested code."""
    return not set(wanted).isdisjoint(re.split("[ /]", codes))


def with_codes(warnings: Iterable[str]) -> tuple[str, str]:
    """Return two strings for storage: the warnings, one per line, and their codes, separated by blanks."""
    lines = [(line, code_of(one)) for one in warnings for line in one.splitlines() if line]
    return "\n".join(line for line, _ in lines), " ".join(code for _, code in lines)


def counted(count: int, noun: str) -> WarningText:
    """Return a number with its noun, such as "2 records", for a warning."""
    return WarningText(noun if count == 1 else f"{noun}s", count=int(count))


def as_stored(warnings: Iterable[str]) -> str:
    """Return warnings as JSON of codes and values; text without a code gets the code `PLAIN`."""
    coded = (one if isinstance(one, WarningText) else WarningText(PLAIN, text=one) for one in warnings)
    return json.dumps([_packed(one) for one in coded], ensure_ascii=False)


def _packed(value: Any) -> Any:
    if isinstance(value, WarningText):
        return {
            "code": value.code.partition("/")[0],
            "values": {name: _packed(one) for name, one in value.values.items()},
        }
    return [_packed(one) for one in value] if isinstance(value, list) else value


def restored(stored: str) -> list[WarningText]:
    """Read the warnings written by :func:`as_stored`; an empty string contains none."""
    return json.loads(stored, object_hook=_unpacked) if stored else []


def _unpacked(found: dict[str, Any]) -> Any:
    return WarningText(found["code"], **found["values"]) if set(found) == {"code", "values"} else found
