"""Writes the report as an HTML page without external resources, or as a PDF printed by a browser."""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from functools import partial
from importlib.resources import files
from pathlib import Path

import numpy as np
import xarray as xr

from rockpulse.config.configuration import Config, given_config
from rockpulse.errors import ResultsError
from rockpulse.files import FileSet
from rockpulse.foreign_text import escaped
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.hdf5.results_file import load_tree
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.version import __version__
from rockpulse.views.report.content import code_checks, logo, page_content, parties
from rockpulse.views.report.explorer import explorer
from rockpulse.views.report.plain_text import folders_of, names_of, plain_words
from rockpulse.views.report.record_tables import record_label
from rockpulse.views.report.report_pictures import Pictures
from rockpulse.views.report.site_and_fragility import matched_file
from rockpulse.views.report.verdict import by_severity
from rockpulse.views.shared.table import Fact
from rockpulse.views.shared.words import in_dates, own_name, result_texts, say, writing

#: Mark in the head of every report; a file without it is never replaced.
MARK = '<meta name="generator" content="rockpulse report'
#: Mark in the last line of every PDF of a report, which PDF readers ignore; a file without it is never replaced.
PDF_MARK = b"\n% rockpulse report\n"
#: Number of bytes at the start of a page in which the mark is searched.
HEAD = 4096
#: Printed names of the kinds of files.
_FILES = {ASSESSMENT: "assessment", SITE_KIND: "site", FRAGILITY: "fragility"}
#: Ids of the parts of the annex, of which empty ones are omitted.
ANNEXES = ("warnings", "site", "fragility", "all-answers", "bodies", "records", "method", "sources")
#: Replacements of terminal spellings by Greek letters and powers.
LETTERS = {
    "theta_max": "θ_max",
    "alpha_c": "α_c",
    "theta": "θ",
    "alpha_0": "α_0",
    "gamma_a": "γ_a",
    "alpha": "α",
    "beta": "β",
    "dT": "ΔT",
    "m/s2": "m/s²",
}
#: Names of the programs of usable browsers on PATH.
BROWSERS = (
    *("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge", "msedge"),
)
#: Locations of browsers: on Windows below the program folders, on macOS among the applications.
PROGRAMS = ("ProgramFiles", "ProgramFiles(x86)", "LocalAppData")
WINDOWS = tuple(
    f"{name}.exe"
    for name in ("Google/Chrome/Application/chrome", "Chromium/Application/chrome", "Microsoft/Edge/Application/msedge")
)
MACOS = tuple(f"{name}.app/Contents/MacOS/{name}" for name in ("Google Chrome", "Chromium", "Microsoft Edge"))
#: Time limit of printing [s]; a report of 200 records and 20 bodies takes about 10 s.
LONGEST = 180.0
#: Advice if no browser is found.
INSTEAD = "write the report as .html and print it from a browser"
PRINTING = (
    *("--headless", "--disable-gpu", "--no-first-run", "--disable-extensions"),
    *("--disable-background-networking", "--no-pdf-header-footer"),
)


def report(
    results: xr.DataTree | str | Path,
    output: str | Path = "report.html",
    site: xr.DataTree | str | Path | None = None,
    fragility: xr.DataTree | str | Path | None = None,
    overwrite: bool = False,
    language: str = "en",
    config: Config | str | Path | None = None,
    full: bool = False,
    code: str | Sequence[str] | None = None,
    progress: Callable[[Sequence[int]], Iterable[int]] | None = None,
) -> Path:
    """Write the report of an assessment as one file: HTML without external resources, or PDF.

    Parameters
    ----------
    results : xarray.DataTree or path
        Results of :func:`rockpulse.assess` or :func:`rockpulse.assess_sequence`, or a file of ``rockpulse assess``.
    output : str or Path
        File to write, `.html` or `.pdf`; a PDF is printed by the Chrome, Chromium or Edge of this machine.
    site : xarray.DataTree or path, optional
        A site calibration to include (:func:`rockpulse.calibrate`).
    fragility : xarray.DataTree or path, optional
        Fragility curves to include (:func:`rockpulse.fragility`).
    overwrite : bool
        Whether an existing report may be replaced; other files are never replaced.
    language : str
        Language of texts and numbers: "en" or "it".
    config : Config or path, optional
        Configuration whose author, client, project and logo ([report]) and, if it gives a spectrum, whose [check]
        replace the values in the results.
    full : bool
        Whether to add the configuration, the SHA-256 of the input files and of the files of results, and their folders.
    code : str or sequence of str, optional
        Codes of the check, as in :func:`rockpulse.check`; by default all that the results allow.
    progress : callable, optional
        Function that wraps the numbers of the pictures, as ``tqdm.tqdm`` does.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    ResultsError
        For results of another kind, a site or fragility file that contains another body of the same name, an existing
        target that may not be replaced, or a PDF without a browser to print it.
    OSError
        If a file cannot be read or written.

    Examples
    --------
    >>> rp.report(results, "report.html", overwrite=True).name
    'report.html'
    """
    target = check_report_target(output, overwrite)
    as_pdf = target.suffix.lower() == ".pdf"
    if as_pdf:
        browser()  # checked before any work
    page = report_page(
        results, site, fragility, language, None if config is None else given_config(config), full, code, progress
    )
    with FileSet() as parts:
        parts.add(target, printed(page) + PDF_MARK if as_pdf else page.encode("utf-8", "replace"))
        check_report_target(output, overwrite)  # another process may have written it in the meantime
        parts.commit()
    return target


def check_report_target(path: str | Path, overwrite: bool = False) -> Path:
    """Return the path of a report to be written; raise ResultsError if it must not or cannot be written."""
    target = Path(path)
    if target.suffix.lower() not in (".html", ".htm", ".pdf") and not target.is_dir():
        raise ResultsError(f"{path}: expected a name that ends in .html or .pdf")
    if not target.parent.is_dir():
        raise ResultsError(f"{path}: there is no folder {target.parent}; create it first")
    if not target.exists():
        return target
    if not target.is_file():
        raise ResultsError(f"{path}: expected the name of a report, found a folder or a device")
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
    full: bool = False,
    code: str | Sequence[str] | None = None,
    progress: Callable[[Sequence[int]], Iterable[int]] | None = None,
) -> str:
    """Return the HTML page of the report as text."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    given = {ASSESSMENT: results, SITE_KIND: site, FRAGILITY: fragility}
    loaded = {kind: _loaded(source, kind) for kind, source in given.items() if source is not None}
    with writing(language):
        trees = loaded if language == "en" else {kind: _in_language(tree) for kind, tree in loaded.items()}
    tree, stored = trees[ASSESSMENT], [str(name) for name in loaded[ASSESSMENT]["summary"].to_dataset()["block"].values]
    kinds = [kind for kind in (SITE_KIND, FRAGILITY) if kind in trees]
    others = {kind: matched_file(tree, trees[kind], kind, _name(given[kind])) for kind in kinds}
    beside = others.get(SITE_KIND), others.get(FRAGILITY)
    checked = code_checks(loaded[ASSESSMENT], config, code)
    if isinstance(checked, xr.Dataset):
        named = dict(zip(stored, tree["summary"].to_dataset()["block"].values.tolist(), strict=True))
        checked = checked.assign_coords(block=[named.get(name, name) for name in checked["block"].values.tolist()])
    folders = folders_of(loaded[ASSESSMENT], given[ASSESSMENT])
    plain = str if full else partial(plain_words, folders=folders, names=names_of(tree))
    environment = Environment(
        loader=PackageLoader("rockpulse.views.report"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=lambda value: escaped(plain(value)) if type(value) is str else value,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["with_symbols"] = with_symbols
    script = "".join(map(_text, ("report.js", "explorer_drawing.js", "explorer.js")))
    with writing(language):
        content = page_content(tree, *beside, checked, full)
        curves = content.fragility.blocks if content.fragility else ()
        gravest = sorted(content.found, key=by_severity)
        worst = [one.body.block for one in gravest]
        return environment.get_template("report.html").render(
            say=say,
            language=language,
            parties=parties(tree, config),
            logo=logo(tree, config),
            content=content,
            annexes=[one for one in ANNEXES if getattr(content, one, True)],
            worst_curve=next((name for name in worst if name in curves), curves[0] if curves else ""),
            pictures=Pictures(tree, *beside, content.found, progress),
            files=[
                Fact(say(f"page.file.{_FILES[kind]}"), _described(given[kind], full)) for kind in given if kind in trees
            ],
            explorer=explorer(tree, Path(results).name if isinstance(results, str | Path) else "results.h5", stored),
            style=Markup(_text("report.css") + _text("explorer.css")),
            script=Markup(script),
            script_hash=base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii"),
            version=__version__,
            written=in_dates(f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"),
        )


def _in_language(tree: xr.DataTree) -> xr.DataTree:
    """Return the results with sample names, warnings and processing notes in the current language."""

    def renamed(node: xr.Dataset) -> xr.Dataset:
        attrs = {name: own_name(str(node.attrs[name])) for name in ("title", "site_description") if name in node.attrs}
        of_demand = ("demand", "limit_state") if "demand" in node.dims else ()
        kept = [name for name in ("block", "pedestal_of", *of_demand) if name in node]
        names = {name: [own_name(str(one)) for one in node[name].values] for name in kept}
        if "record" in node.dims:
            names["record"] = [record_label(str(one)) for one in node["record"].values]
        if any(len(set(every)) < node.sizes.get(name, 0) for name, every in names.items()):
            names = {}  # two bodies or demands would have one name
        for name in (name for name in ("warnings", "processing", "block_warnings") if name in node):
            coded = f"{name.removesuffix('s')}_codes"
            codes = node[coded].values.tolist() if coded in node else [""] * node[name].size
            names[name] = [result_texts(str(one), code) for one, code in zip(node[name].values, codes, strict=True)]
        changed = {name: (node[name].dims, np.array(every, dtype=object)) for name, every in names.items()}
        return node.assign(changed).assign_attrs(attrs)

    return tree.map_over_datasets(renamed)


def with_symbols(words: str) -> str:
    """Replace names such as alpha_c and m/s2 in a text by Greek letters and superscripts."""
    return re.sub(rf"\b({'|'.join(LETTERS)})\b", lambda found: LETTERS[found[0]], words)


def _loaded(source: xr.DataTree | str | Path, kind: str) -> xr.DataTree:
    tree = load_tree(source) if isinstance(source, str | Path) else source
    groups = {"summary": ASSESSMENT, "site": SITE_KIND}  # an unsaved tree may lack the attribute
    by_group = next((groups[name] for name in groups if name in tree.children), "")
    if (found := str(tree.attrs.get("kind", by_group))) != kind:
        words = kind_in_words(found) if found else "a tree of another kind"
        raise ResultsError(f"{_name(source)}: expected {kind_in_words(kind)}, found {words}")
    return tree


def _name(source: xr.DataTree | str | Path | None) -> str:
    return str(source) if isinstance(source, str | Path) else "the tree"


def _described(source: xr.DataTree | str | Path | None, full: bool) -> tuple[str, ...]:
    if not isinstance(source, str | Path):
        return (say("page.in_memory"),)
    if not full:
        return (Path(source).name,)
    with Path(source).open("rb") as file:
        return str(source), f"SHA-256 {hashlib.file_digest(file, 'sha256').hexdigest()}"


def _text(name: str) -> str:
    return files("rockpulse.views.report").joinpath("templates", name).read_text(encoding="utf-8")


def browser() -> str:
    """Return the path of a browser that can print a PDF; raise ResultsError if none is found."""
    for name in BROWSERS:
        if found := shutil.which(name):
            return found
    homes = [Path(home) for home in map(os.environ.get, PROGRAMS) if home]
    places = [home / name for home in homes for name in WINDOWS]
    if sys.platform == "darwin":
        applications = (Path("/Applications"), Path.home() / "Applications")
        places += [folder / name for folder in applications for name in MACOS]
    for place in places:
        if place.is_file():
            return str(place)
    raise ResultsError(
        "no Chrome, Chromium or Edge was found to print the PDF with; install one of them (Debian, Ubuntu: apt install "
        "chromium), or write the report as .html and print it from any browser"
    )


def printed(page: str) -> bytes:
    """Convert an HTML page to a PDF with a browser, and return the PDF; raise ResultsError if this fails."""
    program = browser()
    # A separate profile, as an open browser would take over the page and print nothing.
    with tempfile.TemporaryDirectory(prefix="rockpulse-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder, "report.html"), Path(folder, "report.pdf")
        source.write_text(page, encoding="utf-8", errors="replace")
        command = [program, *PRINTING, f"--user-data-dir={Path(folder, 'profile')}", f"--print-to-pdf={target}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.append("--no-sandbox")  # needed to run as root
        try:
            done = subprocess.run(
                [*command, source.as_uri()], capture_output=True, timeout=LONGEST, check=False, stdin=subprocess.DEVNULL
            )
        except subprocess.TimeoutExpired:
            raise ResultsError(f"{program}: did not print the report within {LONGEST:.0f} s; {INSTEAD}") from None
        except OSError as error:
            raise ResultsError(f"{program}: cannot be run ({error.strerror}); {INSTEAD}") from error
        if done.returncode or not target.is_file():
            last = "".join(f": {line}" for line in done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:])
            raise ResultsError(f"{program}: printed no PDF (exit code {done.returncode}){last}; {INSTEAD}")
        return target.read_bytes()
