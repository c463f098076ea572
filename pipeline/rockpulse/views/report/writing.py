"""The report as a file: one page of HTML that asks nothing of a network, or the PDF that a browser prints of it."""

from __future__ import annotations

import base64
import hashlib
import os
import re
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from rockpulse.errors import ResultsError
from rockpulse.files import FileSet
from rockpulse.foreign_text import escaped
from rockpulse.storage.hdf5.atomic import ASSESSMENT, named
from rockpulse.storage.hdf5.results_file import load
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.version import __version__
from rockpulse.views.report.content import Content, gather
from rockpulse.views.report.explorer import explorer
from rockpulse.views.report.pairing import paired
from rockpulse.views.report.parties import logo, parties
from rockpulse.views.report.pictures import Pictures
from rockpulse.views.report.printing import browser, printed
from rockpulse.views.report.provenance import hash_of
from rockpulse.views.report.wording import Words, words_of
from rockpulse.views.shared.table import Fact

if TYPE_CHECKING:
    import xarray as xr

    from rockpulse.config.configuration import Config

__all__ = ["check_report_target", "report_page", "write_report"]

#: What the head of every report holds; a file without it is never replaced.
MARK = '<meta name="generator" content="rockpulse report'

#: The last line of every PDF of ours, which readers of PDF pass over; the same holds for it.
PDF_MARK = b"\n% rockpulse report\n"

#: Bytes at the head of a page that are searched for its mark.
HEAD = 4096

#: The parts of the annex, by their ids; one that the results have nothing for is left out.
ANNEXES = ("remarks", "site", "fragility", "all-answers", "bodies", "records", "method", "sources")

#: What a page shows for words of the terminal.
LETTERS = {
    "theta_max": "θ_max",
    "alpha_c": "α_c",
    "theta": "θ",
    "alpha": "α",
    "beta": "β",
    "dT": "ΔT",
    "m/s2": "m/s²",
}


def write_report(
    results: xr.DataTree | str | Path,
    path: str | Path,
    site: xr.DataTree | str | Path | None = None,
    fragility: xr.DataTree | str | Path | None = None,
    overwrite: bool = False,
    language: str = "en",
    config: Config | None = None,
) -> Path:
    """Write the results of an assessment as one file to hand over: HTML, or PDF by the name.

    Parameters
    ----------
    results : xarray.DataTree or path
        As :func:`rockpulse.assess` or :func:`rockpulse.assess_sequence` returns them, or a file of
        ``rockpulse assess``.
    path : str or Path
        File to write, `.html` or `.pdf`; a PDF is printed by the Chrome, Chromium or Edge of this machine.
    site : xarray.DataTree or path, optional
        A site calibration to show beside them (:func:`rockpulse.calibrate_site`).
    fragility : xarray.DataTree or path, optional
        Fragility curves to show beside them (:func:`rockpulse.fragility_curves`).
    overwrite : bool
        Whether a report that exists may be replaced; no other file ever is.
    language : str
        Of the words and numbers of the report: "en" or "it". Readers' warnings and reasons stay English.
    config : Config, optional
        Its author, client, project and logo ([report]) take the place of those in the results.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    ResultsError
        For results of another kind, a site or fragility file with another body of the same name
        (:func:`rockpulse.views.report.pairing.paired`), a target that exists and may not be replaced, or a PDF without
        a browser that prints it.
    OSError
        Where a file cannot be read or written.

    Notes
    -----
    The page holds its style, its script and its pictures, and a policy that forbids every request.
    """
    target = check_report_target(path, overwrite)
    as_pdf = target.suffix.lower() == ".pdf"
    if as_pdf:
        browser()  # asked for before any work is done
    page = report_page(results, site, fragility, language, config)
    with FileSet() as parts:
        parts.add(target, printed(page) + PDF_MARK if as_pdf else page.encode("utf-8", "replace"))
        check_report_target(path, overwrite)  # somebody else may have written it in the meantime
        parts.commit()
    return target


def check_report_target(path: str | Path, overwrite: bool = False) -> Path:
    """The path, if a report can be written there; ResultsError if not. Asked before any work is done."""
    target = Path(path)
    if target.suffix.lower() not in (".html", ".htm", ".pdf") and not target.is_dir():
        raise ResultsError(f"{path}: expected a name that ends in .html or .pdf")
    if not target.parent.is_dir():
        raise ResultsError(f"{path}: there is no folder {target.parent}; create it first")
    if not target.exists():
        return target
    if not target.is_file():
        raise ResultsError(f"{path}: expected the name of a report, found something that is no regular file")
    if not overwrite:
        raise ResultsError(f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite)")
    with target.open("rb") as file:
        first = file.read(HEAD)
        file.seek(-min(target.stat().st_size, len(PDF_MARK)), os.SEEK_END)
        if MARK.encode() not in first and not (first.startswith(b"%PDF") and file.read() == PDF_MARK):
            raise ResultsError(
                f"{path}: expected a report of rockpulse, found another file, which is not replaced even with "
                "--overwrite; choose another name, or remove it by hand"
            )
    return target


def report_page(
    results: xr.DataTree | str | Path,
    site: xr.DataTree | str | Path | None = None,
    fragility: xr.DataTree | str | Path | None = None,
    language: str = "en",
    config: Config | None = None,
) -> str:
    """The page of :func:`write_report` as a text."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    given = {ASSESSMENT: results, SITE_KIND: site, FRAGILITY: fragility}
    trees = {kind: _loaded(source, kind) for kind, source in given.items() if source is not None}
    tree = trees[ASSESSMENT]
    others = {
        kind: paired(tree, trees[kind], kind, _name(given[kind])) for kind in (SITE_KIND, FRAGILITY) if kind in trees
    }
    words = words_of(language)
    content = gather(words, tree, others.get(SITE_KIND), others.get(FRAGILITY))
    environment = Environment(
        loader=PackageLoader("rockpulse.views.report"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=lambda value: escaped(value) if type(value) is str else value,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["typeset"] = typeset
    script = "".join(map(_text, ("report.js", "explorer_drawing.js", "explorer.js")))
    return environment.get_template("report.html").render(
        words=words,
        parties=parties(words, tree, config),
        logo=logo(tree, config),
        content=content,
        annexes=[one for one in ANNEXES if getattr(content, one, True)],
        worst_curve=_worst_curve(content),
        pictures=Pictures(words, tree, others.get(SITE_KIND), others.get(FRAGILITY), content),
        files=tuple(
            Fact(words.shared(kind), _described(words, source)) for kind, source in given.items() if source is not None
        ),
        explorer=explorer(tree, words, str(results) if isinstance(results, str | Path) else "results.h5"),
        style=Markup(_text("report.css") + _text("explorer.css")),
        script=Markup(script),
        script_hash=base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii"),
        version=__version__,
        written=f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
    )


def _worst_curve(content: Content) -> str:
    """The body of the worst verdict among those that have curves, which the second page shows; empty without curves."""
    curves = content.fragility.blocks if content.fragility else ()
    worst = sorted(content.found, key=lambda one: (one.overall, one.decides.value), reverse=True)
    return next((one.body.block for one in worst if one.body.block in curves), curves[0] if curves else "")


def typeset(words: str) -> str:
    """Words of the terminal with the Greek letters and the powers that a page can show.

    Examples
    --------
    >>> typeset("theta_max/alpha_c, PGA [m/s2], dT [s]")
    'θ_max/α_c, PGA [m/s²], ΔT [s]'
    """
    return re.sub(rf"\b({'|'.join(LETTERS)})\b", lambda found: LETTERS[found[0]], words)


def _loaded(source: xr.DataTree | str | Path, kind: str) -> xr.DataTree:
    tree = load(source) if isinstance(source, str | Path) else source
    found = str(tree.attrs.get("kind", _kind_by_group(tree)))
    if found != kind:
        raise ResultsError(f"{_name(source)}: expected {named(kind)} of rockpulse, found {named(found)}")
    return tree


def _name(source: xr.DataTree | str | Path | None) -> str:
    return str(source) if isinstance(source, str | Path) else "the tree"


def _kind_by_group(tree: xr.DataTree) -> str:
    """Trees that were never saved may lack the attribute."""
    return (
        ASSESSMENT if "summary" in tree.children else SITE_KIND if "site" in tree.children else "tree of another kind"
    )


def _described(words: Words, source: xr.DataTree | str | Path) -> tuple[str, ...]:
    if isinstance(source, str | Path):
        return str(source), f"SHA-256 {hash_of(source)}"
    return (words("page.in_memory"),)


def _text(name: str) -> str:
    return files("rockpulse.views.report").joinpath("templates", name).read_text(encoding="utf-8")
