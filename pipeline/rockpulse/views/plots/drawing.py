"""Draws any kind of picture of a results file, and pictures of objects by their type."""

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rocking.body.block import Block
from rocking.body.limits import RATES
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.response import Response
from rockpulse.assessment.spectra import ALPHAS, P, overturning_spectrum
from rockpulse.assessment.spectra import rocking_spectrum as compute_spectrum
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.option import hint
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.record import Record
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.hdf5.results_file import given_results
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.views.plots import ground_motion, selection, style
from rockpulse.views.plots.critical_factors import critical_scale, overturning_map
from rockpulse.views.plots.fragility_curves import fragility_panels
from rockpulse.views.plots.model_histories import histories
from rockpulse.views.plots.objects import block_outlines, bodies, half_wave_impulses, response, two_half_cycles
from rockpulse.views.plots.picture_kinds import KINDS, OPTIONS
from rockpulse.views.plots.probability_map import probability_map
from rockpulse.views.plots.rotation_panels import rotation_history
from rockpulse.views.plots.site import calibration, limit_accelerogram, site_accelerogram
from rockpulse.views.plots.spectra import overturning_spectra, rocking_spectrum, spectra_of_results
from rockpulse.views.shared.formatting import six_digits
from rockpulse.views.shared.record_facts import Known
from rockpulse.views.shared.words import say

#: Largest number of records whose spectra are recomputed for a picture, which takes some seconds.
MARCHED = 12
#: Frequency parameters of these spectra [1/s], half as many as in a file.
MARCHED_RATES = np.geomspace(RATES[0], RATES[-1], 12)
#: Options that accept several values.
SEVERAL = ("model", "limit_state")
#: Default pictures of results, by the kind of file.
FIRST = {ASSESSMENT: ("spectrum", "bodies"), FRAGILITY: ("fragility",), SITE_KIND: ("calibration",)}


def _pair(tree: xr.DataTree, record: str | None, block: str | None, case: int) -> tuple[str, str, str]:
    summary = tree["summary"].to_dataset()
    record, block = selection.one_name(summary, "record", record), selection.one_name(summary, "block", block)
    names = f"{style.plain(record)}, {style.plain(selection.named_body(summary, block, case))}"
    return record, block, f"{names}\n{style.plain(Known(summary, record=record).described)}".rstrip()


def _accelerogram(tree: xr.DataTree, axes: style.Panels | None = None, record: str | None = None) -> np.ndarray:
    record = selection.one_name(tree["summary"].to_dataset(), "record", record)
    return ground_motion.accelerogram(ground_motion.stored_motion(tree, record), axes)


def _limit_accelerogram(
    tree: xr.DataTree,
    axes: style.Panels | None = None,
    record: str | None = None,
    block: str | None = None,
    case: int = 1,
) -> np.ndarray:
    if "site" in tree.children:
        return site_accelerogram(tree, block, axes)
    record, block, name = _pair(tree, record, block, case)
    body, sequence = selection.block_of(tree["summary"].to_dataset(), block, case), selection.sequence_of(tree, record)
    try:
        return limit_accelerogram(body, sequence, axes, name)
    except ValueError as error:
        raise ResultsError(f"{record}, {block}: the sequence has no limit accelerogram: {error}") from error


def _rotation_history(
    tree: xr.DataTree,
    axes: style.Panels | None = None,
    record: str | None = None,
    block: str | None = None,
    **options: Any,
) -> np.ndarray:
    record, block, name = _pair(tree, record, block, options.get("case", 1))
    factor = options.get("factor", 1.0)
    name = name if factor == 1.0 else say("plot.motion.times", name=name, factor=six_digits(factor))
    return rotation_history(histories(tree, record, block, **options), axes, name)


def _rocking_spectrum(
    tree: xr.DataTree, axes: Axes | None = None, record: str | None = None, restitution: float | str = "housner"
) -> Axes:
    summary = tree["summary"].to_dataset()
    record = selection.one_name(summary, "record", record)
    if restitution != "housner" and not 0.0 <= float(restitution) <= 1.0:
        raise ConfigError(f'restitution: expected a number from 0 to 1 or "housner", got {restitution}')
    c: Any = restitution if restitution == "housner" else float(restitution)
    own = summary.sel(block=selection.plain_bodies(summary))
    names, rates, angles = (own[name].values.tolist() for name in ("block", "p", "alpha_c"))
    grid = _reaching(P, rates), _reaching(ALPHAS, angles)
    gravity = float(summary["gravity"][0])
    spectrum = compute_spectrum(ground_motion.stored_record(tree, record), *grid, restitution=c, gravity=gravity)
    note = " ".join(style.notes(no_vertical=ground_motion.had_vertical(summary, record)))
    marked = dict(zip(names, zip(rates, angles, strict=True), strict=True))
    return rocking_spectrum(spectrum, axes, bodies=marked, note=note)


def _reaching(values: Sequence[float], marked: Sequence[float]) -> list[float]:
    """Return equally spaced values that span `values` and, with a margin of 10 %, also all values of `marked`."""
    low, high = min([values[0], *(0.9 * one for one in marked)]), max([values[-1], *(1.1 * one for one in marked)])
    return np.linspace(low, high, len(values)).tolist()


def _spectrum(
    tree: xr.DataTree, axes: Axes | None = None, record: str | None = None, restitution: float | str | None = None
) -> Axes:
    summary = tree["summary"].to_dataset()
    records = None if record is None else [selection.one_name(summary, "record", record)]
    if restitution == "housner":
        raise ConfigError("restitution: the spectrum is drawn at one C; expected a number from 0.75 to 1")
    c = float(summary["restitution"].median()) if restitution is None else float(restitution)
    return spectra_of_results(tree, spectra_of_records(tree, c, records), c, axes)


def has_spectra(tree: xr.DataTree) -> bool:
    """Return whether overturning spectra are stored or, with P and accelerograms of few records, can be computed."""
    if "spectra" in tree.children:
        return True
    probability = tree["summary"].to_dataset()["overturning_probability"].values
    stored = "records" in tree.children and "acceleration" in tree["records"]
    return stored and len(probability) <= MARCHED and bool(np.isfinite(probability).any())


def spectra_of_records(tree: xr.DataTree, restitution: float, records: Sequence[str] | None = None) -> xr.Dataset:
    """Return the stored spectra, or compute them from the records at the tabulated C nearest to `restitution`."""
    if "spectra" in tree.children:
        stored = tree["spectra"].to_dataset()
        return stored if records is None else stored.sel(record=list(records))
    names = tree["summary"].to_dataset()["record"].values.tolist() if records is None else list(records)
    if len(names) > MARCHED:
        raise ResultsError(
            f"the file does not contain the spectra of its {len(names)} records, and at most {MARCHED} spectra "
            'are computed for a picture: name one record, or assess again with [uncertainty] spectrum = "all"'
        )
    nearest = float(RESTITUTIONS[np.argmin(np.abs(RESTITUTIONS - restitution))])
    uncertainty = selection.settings_of(tree, UncertaintySettings).of_draws()
    motions = [ground_motion.stored_record(tree, name) for name in names]
    moving = [motion for motion in motions if np.any(motion.acceleration)]
    if not moving:
        raise ResultsError(f"{', '.join(names)}: the acceleration is zero throughout, so there is no spectrum")
    found = [
        overturning_spectrum(motion, MARCHED_RATES, [nearest], uncertainty=uncertainty, rotations=False)
        for motion in moving
    ]
    return xr.concat(found, xr.Variable("record", [motion.id for motion in moving]), combine_attrs="drop_conflicts")


#: For each kind of picture (:data:`rockpulse.plots.KINDS`): the function that draws it from a tree and options.
DRAWERS: dict[str, Callable[..., Figure | Axes | np.ndarray]] = {
    "accelerogram": _accelerogram,
    "bodies": bodies,
    "limit-accelerogram": _limit_accelerogram,
    "rotation-history": _rotation_history,
    "rocking-spectrum": _rocking_spectrum,
    "spectrum": _spectrum,
    "overturning-map": overturning_map,
    "probability": probability_map,
    "critical-scale": critical_scale,
    "fragility": fragility_panels,
    "calibration": calibration,
}


def draw(tree: xr.DataTree, kind: str, axes: style.Panels | None = None, **options: Any) -> Figure:
    """Draw a picture of a results file.

    Parameters
    ----------
    tree : xarray.DataTree
        Results from :func:`rockpulse.load`, or from the functions that compute them.
    kind : str
        One of :data:`~rockpulse.plots.KINDS`.
    axes : matplotlib Axes or array_like of Axes, optional
        Axes to draw on, one for each panel of the picture; by default on a new figure.
    **options
        Options of the kind: `record`, `block`, `demand`, `measure` (names), `model`, `limit_state` (a name or several
        names), `case` (number of the restitution, from 1), `factor` (on the record), `restitution` (a number or
        "housner"); None means the default. A record or a body may be omitted if there is only one; instead of a name,
        a pattern (* and ?) that matches one name may be given.

    Returns
    -------
    matplotlib Figure
        The figure of the axes, or a new one without a window; :func:`rockpulse.plots.svg` and ``savefig`` write it.

    Raises
    ------
    ResultsError
        For an unknown kind, option or name, a file of another kind, or a file without the data that the picture needs.

    Examples
    --------
    >>> rp.plots.draw(results, "bodies").axes[0].get_title()
    'stele'
    """
    if kind not in KINDS:
        available = f"there are: {', '.join(KINDS)}"
        raise ResultsError(f'no kind of picture "{kind}"{hint(kind, KINDS, available)}')
    row = KINDS[kind]
    found = str(tree.attrs.get("kind", ASSESSMENT))
    if found not in row.files:
        raise ResultsError(f"{kind}: expected a file of '{row.command}', found {kind_in_words(found)}")
    given = {name: value for name, value in options.items() if value is not None}
    for name in list(given):
        if name not in row.options:
            takes = ", ".join(f"{option} ({OPTIONS[option]})" for option in row.options) or "none"
            raise ResultsError(f'the picture "{kind}" has no option {name}; its options: {takes}')
        if name in SEVERAL:
            value = given.pop(name)
            given[f"{name}s"] = [value] if isinstance(value, str) else value
    return style.whole_figure(DRAWERS[kind](tree, axes=axes, **given))


def plot(
    what: Record | HalfWaves | ImpulseSequence | Block | Response | xr.Dataset | xr.DataTree | str | os.PathLike[str],
    kind: str | None = None,
    *,
    block: Block | str | None = None,
    axes: style.Panels | None = None,
    **options: Any,
) -> Figure:
    """Draw a picture of an object by its type.

    Parameters
    ----------
    what : Record, HalfWaves, ImpulseSequence, Block, Response, xarray.Dataset, xarray.DataTree, str or Path
        A record is drawn with its intense phase and half-waves; a sequence as two half-cycles or, with a `block`, as
        the limit accelerogram; a response as its history or, without a history, its peaks. A dataset is the result of
        :func:`rockpulse.overturning_spectrum` or :func:`rockpulse.rocking_spectrum`; a tree or the path of a file
        contains results of any kind.
    kind : str, optional
        For results: one of :data:`rockpulse.plots.KINDS`; by default the overturning spectrum of an assessment (the
        bodies if it has no spectrum and no accelerograms), and the main picture of other files.
    block : Block or str, optional
        For a sequence, the Block whose half-cycles determine the times; for results, the name of a body.
    axes : matplotlib Axes or array_like of Axes, optional
        Axes to draw on, one for each panel of the picture; by default on a new figure.
    **options
        For results: other options of :func:`rockpulse.plots.draw`.

    Returns
    -------
    matplotlib Figure
        The figure of the axes, or a new one without a window, which a notebook shows once and ``savefig`` writes.

    Raises
    ------
    TypeError
        For an object without a picture, or an option that does not apply to it.
    ResultsError
        For results without the data that the picture needs.

    Examples
    --------
    >>> figure = rp.plot(rp.models.Block(width=0.25, height=2.2))
    >>> figure.axes[0].texts[0].get_text()
    '2.2 m'
    """
    if isinstance(what, (xr.DataTree, str, os.PathLike)):
        tree = given_results(what)
        return draw(tree, kind or _first(tree), axes, block=block, **options)
    if not isinstance(what, tuple(_BY_TYPE)):
        raise TypeError(
            "plot: expected a Record, HalfWaves, an ImpulseSequence, a Block, a Response, a dataset of a spectrum, a "
            f"tree of results or the path of a results file, found {type(what).__name__}"
        )
    given = {"kind": kind, **options} | ({} if isinstance(what, ImpulseSequence) else {"block": block})
    unknown = ", ".join(name for name, value in given.items() if value is not None)
    if unknown:
        raise TypeError(f"plot: a {type(what).__name__} takes no options, found {unknown}")
    if isinstance(what, ImpulseSequence) and block is not None:
        if not isinstance(block, Block):
            raise TypeError(f"plot: expected a Block, whose half-cycles give the times, found {type(block).__name__}")
        return style.whole_figure(limit_accelerogram(block, what, axes))
    drawer = next(draw for kind, draw in _BY_TYPE.items() if isinstance(what, kind))
    return style.whole_figure(drawer(what, axes))


def _of_dataset(spectrum: xr.Dataset, axes: Axes | None) -> Axes:
    if "spectrum" in spectrum:
        return overturning_spectra(spectrum, axes)
    if {"peak_rotation_ratio", "alpha_c", "p"} <= set(spectrum.variables) and "outcome" in spectrum:
        return rocking_spectrum(spectrum, axes)
    raise TypeError(
        "plot: expected a dataset of rockpulse.overturning_spectrum or rockpulse.rocking_spectrum, found one with "
        f"{', '.join(map(str, spectrum.data_vars)) or 'no variable'}"
    )


def _first(tree: xr.DataTree) -> str:
    """Return the kind of picture that is drawn if no kind is given."""
    found = str(tree.attrs.get("kind", ASSESSMENT))
    for kind in FIRST.get(found, ()):
        if kind != "spectrum" or has_spectra(tree):
            return kind
    raise ResultsError(f"plot: {kind_in_words(found)} cannot be drawn")


#: Functions that draw an object, by its type.
_BY_TYPE: dict[type, Callable[..., Figure | Axes | np.ndarray]] = {
    Record: lambda record, axes: ground_motion.accelerogram(ground_motion.motion_of_record(record), axes),
    HalfWaves: half_wave_impulses,
    ImpulseSequence: two_half_cycles,
    Block: block_outlines,
    Response: response,
    xr.Dataset: _of_dataset,
}
