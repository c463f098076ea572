"""Remarks on a record: a code and values, and the English text that is made of both."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import cache
from string import Formatter
from typing import Any

__all__ = ["PLAIN", "TEMPLATES", "Remark", "code_of", "find", "recognised", "remarked", "with_codes"]

#: The text of each code. Texts of before are recognised in this order and by these words: other words, another code.
TEMPLATES = {
    # a channel as it was read
    "dead_channel": "all samples are zero: a dead channel",
    "clipped": "{count:d} samples in a row at the {end} value: the record may be clipped",
    "full_scale": (
        "the peak is where the range of a 24-bit recorder ends ({counts:d} counts): the record may be clipped"
    ),
    "header_peak": (
        "the header states a peak of {stated:.4g} g, the data have {found:.4g} g; check the unit and that the file is "
        "whole"
    ),
    "header_peak_near": (
        "the header states a peak of {stated:.4g} g, the data have {found:.4g} g: {share:.1f} % {sense}"
    ),
    "odd_peak": "peak {peak:.3g} g in the unit {unit}; the values would be {readings}",
    "long_interval": "a sampling interval of {interval:g} s is long for an accelerogram; is it in s?",
    "part_of_record": "part {part:d} of a record that is cut into files: give all of them together",
    "vertical_by_code": "the channel code {channel} says vertical, the header {told}; taken as vertical",
    "positive_downwards": "positive downwards in the file; the sign is changed so that upwards is positive",
    # a record on its way to the models
    "on_structure": "on a structure, assessed as if this were ground motion",
    "orientation_unknown": "the orientation is unknown; assessed as horizontal",
    "baseline_guessed": (
        "the format does not say whether the record is processed: the mean was subtracted; choose a baseline to keep "
        "or correct it"
    ),
    "baseline_drift": (
        "baseline drift: the ground velocity ends at {velocity:.3g} m/s, the PGV of {pgv:.3g} m/s may be off by as "
        "much; compare with another baseline or a high-pass"
    ),
    "start_assumed": "both channels are taken to start together, no times are known",
    "no_sequence": "no impulse sequence: {reason}",
    "scaled_far": (
        "scaled by {factor:.3g}: outside {low:g} to {high:g} a scaled record stands for no recorded earthquake of that "
        "strength"
    ),
    "scaled_alone": "brought to the demand by its own strength, not by that of a pair: {reason}",
    "scaled_to_drift": "scaled to a PGV that its drifting baseline puts in doubt",
    # its vertical channel
    "vertical_acceleration": "vertical acceleration: {record}",
    "vertical_missing": "no vertical channel of this station overlaps: taken as zero",
    "vertical_start_assumed": "vertical channel: taken to start with this one, no times are known",
    "vertical_short": "vertical channel: taken as zero for {missing:.4g} s without it",
    # a sequence in place of a record
    "demand_not_compared": (
        "a sequence has no PGA, nor any other strength to bring to the demand of the site ([[demand]]): nothing is "
        "compared with it"
    ),
    # a remark on another record, behind this one
    "of_vertical": "vertical channel: {remark}",
    "of_channel": "{channel}: {remark}",
}

#: In place of a code, of a text that is none of these.
PLAIN = "plain"

_NUMBER = r"[-+]?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|inf|nan)"


class Remark(str):
    """A remark as its English text, with the code and the values that the text is made of.

    `code` is a key of `TEMPLATES`; of a remark that holds another one both codes, ``of_vertical/clipped``. `values` are
    the numbers, texts, or the other remark that the text names.

    Examples
    --------
    >>> remark = Remark("clipped", count=8, end="largest")
    >>> remark, remark.code
    ('8 samples in a row at the largest value: the record may be clipped', 'clipped')
    """

    code: str
    values: dict[str, Any]

    def __new__(cls, code: str, /, **values: Any) -> Remark:
        """The remark of a code, with what its template asks for."""
        remark = super().__new__(cls, TEMPLATES[code].format_map(values))
        remark.code = f"{code}/{code_of(values['remark'])}" if "remark" in values else code
        remark.values = values
        return remark

    def __getnewargs_ex__(self) -> tuple[tuple[str], dict[str, Any]]:
        return (self.code.partition("/")[0],), self.values


def code_of(text: str) -> str:
    """The code of a remark; `PLAIN` for any other text."""
    return text.code if isinstance(text, Remark) else PLAIN


def find(remarks: Iterable[str], code: str) -> Remark | None:
    """The first remark of a code."""
    return next((one for one in remarks if isinstance(one, Remark) and one.code == code), None)


def remarked(codes: str, *wanted: str) -> bool:
    """Whether one of some codes is among stored ones, be it of a channel behind the record."""
    return not set(wanted).isdisjoint(re.split("[ /]", codes))


def with_codes(remarks: Iterable[str]) -> tuple[str, str]:
    """Remarks as they are stored: their texts, one a line, and a code for each line, with blanks between them."""
    lines = [(line, code_of(one)) for one in remarks for line in one.splitlines() if line]
    return "\n".join(line for line, _ in lines), " ".join(code for _, code in lines)


def recognised(text: str) -> str:
    """The remark that a text is by its words, with the digits that it shows; a text that is none stays as it is."""
    if isinstance(text, Remark):
        return text
    for code, (pattern, kinds) in _patterns().items():
        if match := pattern.fullmatch(text):
            remark = Remark(code, **{name: kinds[name](value) for name, value in match.groupdict().items()})
            # A name and a colon begin many texts.
            if remark == text and remark.code != f"of_channel/{PLAIN}":
                return remark
    return text


@cache
def _patterns() -> dict[str, tuple[re.Pattern[str], dict[str, Callable[[str], Any]]]]:
    """The pattern of the text of each code, and how its values are read."""
    found = {}
    for code, template in TEMPLATES.items():
        pattern = ""
        kinds: dict[str, Callable[[str], Any]] = {}
        for words, name, form, _ in Formatter().parse(template):
            pattern += re.escape(words)
            if name:
                kinds[name] = recognised if name == "remark" else int if form == "d" else float if form else str
                pattern += f"(?P<{name}>{_NUMBER if form else '.+?'})"
        found[code] = re.compile(pattern), kinds
    return found
