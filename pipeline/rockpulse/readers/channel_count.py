"""Completeness of a file: no channel twice, and as many of each recorder as its header counts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rockpulse.errors import RecordFormatError

__all__ = ["Counted", "completeness"]


@dataclass(frozen=True)
class Counted:
    """The statements of one channel of a file about its recorder, by which channels are counted."""

    line: int  # where the channel begins, from 1
    recorder: str  # words or number that tell the recorder from others
    number: str  # tells the channel from others of the recorder; empty where the file does not say
    counted: int  # channels of the recorder; 0 where the file does not say
    kind: str = ""  # acceleration, velocity, ... where a file may hold each of them as a channel of its own


def completeness(
    name: str, channels: Iterable[Counted], whose: str = "the header counts", closed: bool = False
) -> tuple[str, ...]:
    """A warning for each recorder of which the file holds fewer channels than it should.

    `whose` says in the message who counts the channels. If the file is `closed`, that is, ends as its format asks for,
    one channel is enough: agencies cut the records of structures into such files. Raises RecordFormatError for a
    channel that is there twice, with both lines.
    """
    first: dict[tuple[str, str, str], int] = {}
    held: dict[str, set[str | int]] = {}
    counted: dict[str, int] = {}
    for channel in channels:
        key = (channel.recorder, channel.number, channel.kind)
        if channel.number and key in first:
            raise RecordFormatError(
                f"{name}:{channel.line}: expected another channel, found that of line {first[key]} a second time; "
                "the file is damaged: download it again"
            )
        first[key] = channel.line
        held.setdefault(channel.recorder, set()).add(channel.number or channel.line)
        counted[channel.recorder] = max(channel.counted, counted.get(channel.recorder, 0))
    if closed and len(first) == 1:
        return ()
    return tuple(
        f"{whose} {counted[recorder]} channels of this recorder, the file holds {len(numbers)}; it may be truncated"
        for recorder, numbers in held.items()
        if len(numbers) < counted[recorder]
    )
