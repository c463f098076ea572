"""The kinds of pictures: what each of them shows, which command makes its file, and which options it has."""

from dataclasses import dataclass

from rockpulse.storage.hdf5.atomic import ASSESSMENT
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND


@dataclass(frozen=True)
class PictureKind:
    """One kind of picture: its options, its content, and the files from which it can be drawn."""

    options: tuple[str, ...]  # keywords of :func:`~rockpulse.plots.draw`
    summary: str  # content of the picture
    command: str = "rockpulse assess"  # command that makes its file
    files: tuple[str, ...] = (ASSESSMENT,)  # kinds of that file


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
        "rockpulse assess or rockpulse calibrate",
        (ASSESSMENT, SITE_KIND),
    ),
    "rotation-history": PictureKind(
        ("record", "block", "model", "case", "factor"),
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
        f'{_STORED} or [uncertainty] spectrum = "all"',
    ),
    "overturning-map": PictureKind(
        ("record", "block", "model"),
        "scale factors at which bodies overturn: all bodies under a record, or all records for a body",
    ),
    "probability": PictureKind(
        ("demand",), "probability that each record, unscaled or scaled to a demand, overturns each body"
    ),
    "critical-scale": PictureKind(
        ("block", "model", "case"), "smallest scale factor on every record at which a body overturns, in each model"
    ),
    "fragility": PictureKind(
        ("block", "measure", "limit_state"),
        "fragility curves of a block, and the band of one of them, in p PGV/(g tan alpha) and PGA",
        "rockpulse fragility",
        (FRAGILITY,),
    ),
    "calibration": PictureKind(
        (),
        "overturning spectrum of a site and its bodies, and the sequences of equal effect",
        "rockpulse calibrate",
        (SITE_KIND,),
    ),
}

#: Options of the command line for each keyword of :func:`~rockpulse.plots.draw`.
OPTIONS = {name: f"--{name.replace('_', '-')}" for row in KINDS.values() for name in row.options}


def kind_list() -> str:
    """Return the list of all kinds of pictures as text for the terminal."""
    from rockpulse.views.shared.formatting import paragraph

    lines = []
    for name, row in KINDS.items():
        options = ", ".join(OPTIONS[option] for option in row.options) or "none"
        texts = (row.summary, f"from: {row.command}; options: {options}")
        lines += [name, *(paragraph(words, "    ", "    ") for words in texts)]
    words = (
        "--record and --block may be omitted if the file has only one. A pattern (*, ?) may replace a name if it "
        "matches exactly one."
    )
    return "\n".join([*lines, paragraph(words)])
