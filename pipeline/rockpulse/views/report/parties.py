"""The head of the page: who made the study and for whom, and a logo, as [report] of the configuration has them."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING

from rockpulse.config.configuration import config_from_text
from rockpulse.config.study_settings import PNG, logo_bytes
from rockpulse.errors import ResultsError
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.table import Fact

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config

__all__ = ["logo", "parties"]


def parties(words: Words, tree: xr.DataTree, config: Config | None = None) -> tuple[Fact, ...]:
    """Project, client and author, those that are given: by a configuration, else by the one in the results."""
    chosen = config_from_text(str(tree.attrs.get("configuration", ""))) if config is None else config
    given = {name: str(chosen.report[name]) for name in ("project", "client", "author")}
    return tuple(Fact(words(f"page.{name}"), (told,)) for name, told in given.items() if told)


def logo(tree: xr.DataTree, config: Config | None = None) -> str:
    """The PNG of the logo in base64, of a configuration or of the results; empty where there is none."""
    if config is not None:
        return base64.b64encode(logo_bytes(config.report, config.folder)).decode("ascii")
    stored = str(tree.attrs.get("report_logo", ""))
    try:
        content = base64.b64decode(stored, validate=True)
    except ValueError as error:
        raise ResultsError("report_logo: expected a PNG in base64, found something else in the results") from error
    if stored and not content.startswith(PNG):
        raise ResultsError("report_logo: expected a PNG in base64, found something else in the results")
    return stored
