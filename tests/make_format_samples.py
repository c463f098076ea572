"""Write data/samples/formats: one small file of each format and variant, from a real record (``make samples``).

Each module of tests/record_writers may have ``samples(channels) -> {file name: bytes}`` and ``OPTIONS``, what the files
do not say: {file name: keyword arguments of `rockpulse.read`}.
"""

import importlib
import pkgutil
from collections.abc import Iterator
from dataclasses import replace
from datetime import timedelta
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import record_writers

from rockpulse.readers import read
from rockpulse.record.record import STANDARD_GRAVITY, Record

SAMPLES = Path(__file__).parents[1] / "data" / "samples"
FORMATS = SAMPLES / "formats"
#: The main shock in a record that holds two earthquakes.
SOURCE, BEGIN, COUNT = "CICLC.v1", 230.0, 1200
HEADING = "## Format samples\n"


def source_channels(count: int = COUNT) -> list[Record]:
    """90, 360 and up of CI.CLC: the first of the main shock's samples, without their means."""
    channels = []
    for channel in read(SAMPLES / "records" / SOURCE):
        first = round(BEGIN / channel.dt)
        part = channel.acceleration[first : first + count]
        start = channel.start_time + timedelta(seconds=BEGIN)
        channels.append(replace(channel, acceleration=part - part.mean(), start_time=start))
    return channels


def writers() -> Iterator[ModuleType]:
    """The modules of tests/record_writers that write samples."""
    for found in pkgutil.iter_modules(record_writers.__path__):
        module = importlib.import_module(f"record_writers.{found.name}")
        if hasattr(module, "samples"):
            yield module


def format_samples(count: int = COUNT) -> dict[str, bytes]:
    """File name -> content, sorted, with `count` samples a channel."""
    channels = source_channels(count)
    files: dict[str, bytes] = {}
    for module in writers():
        for name, content in module.samples(channels).items():
            assert name not in files, f"{module.__name__}: {name} is taken"
            files[name] = content
    return dict(sorted(files.items()))


@cache
def read_options() -> dict[str, dict[str, Any]]:
    """Keyword arguments of `rockpulse.read` for the files that do not say everything."""
    return {name: options for module in writers() for name, options in getattr(module, "OPTIONS", {}).items()}


def table() -> str:
    """The rows of data/samples/README.md, from what the reader finds in the files."""
    heads = ["file", "format", "channels", "interval [s]", "unit", "samples", "peak [g]", "note"]
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    for path in sorted(FORMATS.iterdir()):
        if path.suffix == ".xml":
            lines.append(f"| `{path.name}` | StationXML | | | | | | gains of the miniSEED file |")
            continue
        given = read_options().get(path.name, {})
        first, *_ = records = read(path, **given)
        channels = ", ".join(record.component or "-" for record in records)
        peaks = ", ".join(f"{record.pga / STANDARD_GRAVITY:.3f}" for record in records)
        note = "needs " + ", ".join(f"`{key}={value!r}`" for key, value in given.items()) if given else ""
        facts = [first.format, channels, f"{first.dt:g}", first.source_unit, str(first.npts), peaks, note]
        lines.append(f"| `{path.name}` | {' | '.join(facts)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the files and the table of data/samples/README.md."""
    FORMATS.mkdir(exist_ok=True)
    files = format_samples()
    for path in FORMATS.iterdir():
        if path.name not in files:
            path.unlink()
    for name, content in files.items():
        (FORMATS / name).write_bytes(content)
    readme = SAMPLES / "README.md"
    text, heading, rest = readme.read_text(encoding="utf-8").partition(HEADING)
    words = rest.partition("| file |")[0]
    readme.write_text(text + heading + words + table(), encoding="utf-8")
    print(f"{len(files)} files, {sum(map(len, files.values())) / 1e6:.2f} MB in {FORMATS}")


if __name__ == "__main__":
    main()
