"""The section [report] of the configuration: who made the study and for whom, as the head of a report shows it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rockpulse.errors import ConfigError
from rockpulse.input_file import check_regular
from rockpulse.option import Section, text

#: Largest logo [bytes]: as text it is an attribute of the results file, of which HDF5 takes 64 kB.
LOGO_LIMIT = 45_000

#: What every PNG begins with.
PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class ReportSettings(Section):
    """Author, client and project of a report, and the PNG file of a logo, which is copied into the results."""

    heading = "[report]"
    author: str = text()
    client: str = text()
    project: str = text()
    logo: str | None = text(None)


def logo_bytes(report: ReportSettings, folder: Path) -> bytes:
    """The logo, whose path counts from a folder; empty without one.

    Raises
    ------
    ConfigError
        For a file that is not there, is larger than `LOGO_LIMIT`, or is no PNG.
    """
    if report.logo is None:
        return b""
    path = folder / report.logo
    check_regular(path)
    try:
        with path.open("rb") as file:
            content = file.read(LOGO_LIMIT + 1)
    except OSError as error:
        raise ConfigError(f"[report] logo: {path} cannot be read ({error.strerror})") from error
    if not content.startswith(PNG):
        raise ConfigError(f"[report] logo: {path}: expected a PNG picture, found another file")
    if len(content) > LOGO_LIMIT:
        raise ConfigError(f"[report] logo: {path}: expected at most {LOGO_LIMIT:,} bytes; make the picture smaller")
    return content
