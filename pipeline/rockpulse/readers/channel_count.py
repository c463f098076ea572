"""Whether a file holds the channels that it should: none twice, as many of each recorder as its header counts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rockpulse.errors import RecordFormatError

__all__ = ["Counted", "completeness"]


@dataclass(frozen=True)
class Counted:
    """What one channel of a file says about the channels.

    Attributes
    ----------
    line : int
        Where it begins, from 1.
    recorder : str
        What tells its recorder from others.
    number : str
        What tells the channel from the others of the recorder; empty where the file does not say.
    counted : int
        Channels of the recorder; 0 where the file does not say.
    kind : str
        Acceleration, velocity, ... where a file may hold each of them as a channel of its own.
    """

    line: int
    recorder: str
    number: str
    counted: int
    kind: str = ""


def completeness(
    name: str, channels: Iterable[Counted], whose: str = "the header counts", closed: bool = False
) -> tuple[str, ...]:
    """A warning for each recorder of which the file holds fewer channels than it should.

    Parameters
    ----------
    name : str
        Name of the file.
    channels : iterable of Counted
        All channels of the file.
    whose : str
        Who counts the channels.
    closed : bool
        Whether the file ends as its format asks for. If it does, one channel is enough: agencies cut the records of
        structures into such files.

    Raises
    ------
    RecordFormatError
        For a channel that is there twice, with both lines.
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
