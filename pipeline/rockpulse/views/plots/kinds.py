"""The kinds of pictures: what each shows, which file it is drawn from, and what may be chosen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rockpulse.errors import ResultsError
from rockpulse.option import hint
from rockpulse.storage.hdf5.atomic import ASSESSMENT, named
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PictureKind:
    """One kind of picture."""

    #: What may be chosen, by the names of the keywords of :func:`draw`.
    options: tuple[str, ...]
    #: What it shows.
    summary: str
    #: The command that makes a file from which it is drawn, the kind of that file, and a group that it must have.
    command: str = "rockpulse assess"
    file: str = ASSESSMENT
    group: str = ""


_STORED = 'rockpulse assess with [records] store = "all"'

KINDS = {
    "accelerogram": PictureKind(
        ("record",), "accelerogram, its half-waves as impulses at their centroids, the intense phase", _STORED
    ),
    "bodies": PictureKind(
        ("block",), "bodies with their sizes, walls, ties, loads and floors, drawn from their numbers"
    ),
    "limit-accelerogram": PictureKind(
        ("record", "block", "case"),
        "limit accelerogram of a block and its secondary sequence (the paper's Figures 1 and 2)",
    ),
    "rotation-history": PictureKind(
        ("record", "block", "models", "case", "factor"),
        "rotation of a block under a record by several models, impacts and overturning",
        _STORED,
    ),
    "rocking-spectrum": PictureKind(
        ("record", "restitution"),
        "largest rotation under a record over p and alpha_c, with the bodies of the file",
        _STORED,
    ),
    "spectrum": PictureKind(
        ("record", "restitution"),
        "overturning spectrum of a record, or of all with their median, and the bodies of the file",
        group="spectra",
    ),
    "overturning-map": PictureKind(
        ("record", "block", "models"),
        "factors on the input that overturn, of all blocks under a record or all records on a block",
    ),
    "probability": PictureKind(
        ("demand",), "probability that each record, as it is or brought to a demand, overturns each body"
    ),
    "critical-scale": PictureKind(
        ("block", "models", "case"), "smallest factor on every record that overturns a block, by each model"
    ),
    "fragility": PictureKind(
        ("block", "measure", "limit_states"),
        "fragility curves of a block, and the band of one of them, in p PGV/(g tan alpha) and PGA",
        "rockpulse fragility",
        FRAGILITY,
    ),
    "calibration": PictureKind(
        (),
        "overturning spectrum of a site and its bodies, or the records over the parameters of the design sequence",
        "rockpulse calibrate",
        SITE_KIND,
    ),
}

#: Options of the command line by the keywords of :func:`draw`, each in the singular.
OPTIONS = {
    name: f"--{name.removesuffix('s').replace('_', '-')}"
    for name in ("record", "block", "models", "demand", "case", "factor", "measure", "limit_states", "restitution")
}


def draw(tree: xr.DataTree, kind: str, **options: Any) -> Figure:
    """A picture of a results file.

    Parameters
    ----------
    tree : xarray.DataTree
        As :func:`rockpulse.load` reads it, or as the functions that compute it return it.
    kind : str
        One of :data:`KINDS`.
    **options
        What is chosen, those of the kind: `record`, `block`, `demand`, `measure` (names), `models`, `limit_states`
        (sequences of names), `case` (number of the restitution, from 1), `factor` (on the record), `restitution` (a
        number or "housner"). None stands for the default. A record or a block may be left out where there is one only;
        for a name of the file a pattern (* and ?) does that no other name meets.

    Returns
    -------
    matplotlib Figure
        Bound to no window; :func:`rockpulse.plots.svg` and ``savefig`` make text and files of it.

    Raises
    ------
    ResultsError
        For an unknown kind, option or name, a file of another kind, or one that does not hold what the picture needs.

    Examples
    --------
    >>> import rockpulse as rp
    >>> record = rp.read("data/samples/records/CICLC.v1")[0]
    >>> results = rp.assess([record], rp.Config(blocks=[rp.BlockSettings("wall", width=0.5, height=4.0)]))
    >>> len(rp.plots.draw(results, "bodies").axes)
    1
    """
    if kind not in KINDS:
        told = f"there are: {', '.join(KINDS)}"
        raise ResultsError(f'no kind of picture "{kind}"{hint(kind, KINDS, told)}')
    row = KINDS[kind]
    found = str(tree.attrs.get("kind", ASSESSMENT))
    if found != row.file or (row.group and row.group not in tree.children):
        without = f" without the group {row.group}" if found == row.file else ""
        raise ResultsError(f"{kind}: expected a file of '{row.command}', found {named(found)} file{without}")
    given = {name: value for name, value in options.items() if value is not None}
    for name in given:
        if name not in row.options:
            flags = ", ".join(OPTIONS[option] for option in row.options)
            takes = f"it takes {', '.join(row.options)} ({flags})" if flags else "the picture is always the same"
            raise ResultsError(f"{kind}: there is no {name} to choose; {takes}")
    from rockpulse.views.plots.drawing import DRAWERS
    from rockpulse.views.plots.style import whole_figure

    return whole_figure(DRAWERS[kind](tree, **given))


def kind_list() -> str:
    """The kinds, what each shows, the command that makes its file and its options, as text."""
    from rockpulse.views.shared.terminal import paragraph

    lines = []
    for name, row in KINDS.items():
        options = ", ".join(OPTIONS[option] for option in row.options) or "none"
        told = (row.summary, f"from: {row.command}; options: {options}")
        lines += [name, *(paragraph(words, "    ", "    ") for words in told)]
    words = (
        "A record or a block may be left out where the file has one only. Instead of a name a pattern does, with * "
        "and ? for any letters, if one name only meets it."
    )
    return "\n".join([*lines, paragraph(words)])
