"""One call for a picture of whatever there is: a record, half-waves, a sequence, a block, a response, results."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import xarray as xr

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.response import Response
from rockpulse.errors import ResultsError
from rockpulse.record.half_wave import HalfWaves
from rockpulse.record.record import Record
from rockpulse.storage.hdf5.atomic import ASSESSMENT, named
from rockpulse.storage.hdf5.results_file import load
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.views.plots.ground_motion import accelerogram, motion_of_record
from rockpulse.views.plots.impulse_sequences import limit_accelerogram
from rockpulse.views.plots.kinds import KINDS, draw
from rockpulse.views.plots.objects import block_outlines, half_wave_impulses, response, two_half_cycles
from rockpulse.views.plots.spectra import overturning_spectra, rocking_spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: What is drawn of results where no kind is asked for, by the kind of their file.
FIRST: dict[str, tuple[str, ...]] = {
    ASSESSMENT: ("spectrum", "bodies"),
    FRAGILITY: ("fragility",),
    SITE_KIND: ("calibration",),
}


def plot(
    what: Record | HalfWaves | ImpulseSequence | Block | Response | xr.Dataset | xr.DataTree | str | os.PathLike[str],
    kind: str | None = None,
    *,
    block: Block | str | None = None,
    **options: Any,
) -> Figure:
    """A picture of an object, by its type.

    Parameters
    ----------
    what : Record, HalfWaves, ImpulseSequence, Block, Response, xarray.Dataset, xarray.DataTree, str or Path
        A record: with its intense phase and half-waves. A sequence: two half-cycles, or with a `block` the limit
        accelerogram. A response: its history where it has one, else its peaks. A dataset: of
        :func:`rockpulse.overturning_spectrum` or :func:`rockpulse.rocking_spectrum`. A tree or the path of a file:
        results of any kind.
    kind : str, optional
        Of results: one of :data:`rockpulse.plots.KINDS`; by default the overturning spectrum of an assessment where it
        has one, else its bodies, and of other files their main picture.
    block : Block or str, optional
        Of a sequence: the Block whose half-cycles give it times. Of results: the name of a body.
    **options
        Of results: what else is chosen, see :func:`rockpulse.plots.draw`.

    Returns
    -------
    matplotlib Figure
        Bound to no window, so that a notebook shows it once; ``savefig`` writes it. The functions of
        :mod:`rockpulse.plots` draw on Axes of your own.

    Raises
    ------
    TypeError
        For an object that has no picture, or an option that it has not.
    ResultsError
        For results that do not hold what the picture needs.

    Examples
    --------
    >>> import rockpulse as rp
    >>> figure = rp.plot(rp.models.Block(width=0.25, height=2.2))
    >>> figure.axes[0].texts[0].get_text()
    '2.2 m'
    """
    if isinstance(what, (xr.DataTree, str, os.PathLike)):
        tree = what if isinstance(what, xr.DataTree) else load(what)
        return draw(tree, kind or _first(tree), block=block, **options)
    if not isinstance(what, (Record, HalfWaves, ImpulseSequence, Block, Response, xr.Dataset)):
        raise TypeError(
            "plot: expected a Record, HalfWaves, an ImpulseSequence, a Block, a Response, a dataset of a spectrum, a "
            f"tree of results or the path of a results file, found {type(what).__name__}"
        )
    given = {"kind": kind, **options} | ({} if isinstance(what, ImpulseSequence) else {"block": block})
    unknown = ", ".join(name for name, value in given.items() if value is not None)
    if unknown:
        raise TypeError(f"plot: there is nothing to choose of a {type(what).__name__}, found {unknown}")
    if isinstance(what, Record):
        return _figure(accelerogram(motion_of_record(what))[0])
    if isinstance(what, HalfWaves):
        return _figure(half_wave_impulses(what))
    if isinstance(what, ImpulseSequence):
        if block is None:
            return _figure(two_half_cycles(what))
        if not isinstance(block, Block):
            raise TypeError(f"plot: expected a Block that gives the sequence its times, found {type(block).__name__}")
        return _figure(limit_accelerogram(block, what)[0])
    if isinstance(what, Block):
        return block_outlines(what)
    return _figure(response(what) if isinstance(what, Response) else _of_dataset(what))


def _of_dataset(spectrum: xr.Dataset) -> Axes:
    if "spectrum" in spectrum:
        return overturning_spectra(spectrum)
    if {"peak_rotation_ratio", "alpha_c", "p"} <= set(spectrum.variables) and "outcome" in spectrum:
        return rocking_spectrum(spectrum)
    raise TypeError(
        "plot: expected a dataset of rockpulse.overturning_spectrum or rockpulse.rocking_spectrum, found one with "
        f"{', '.join(map(str, spectrum.data_vars)) or 'no variable'}"
    )


def _first(tree: xr.DataTree) -> str:
    """The kind of picture that results are drawn as where none is asked for."""
    found = str(tree.attrs.get("kind", ASSESSMENT))
    for kind in FIRST.get(found, ()):
        if not KINDS[kind].group or KINDS[kind].group in tree.children:
            return kind
    raise ResultsError(f"plot: of {named(found)} there is no picture")


def _figure(ax: Axes) -> Figure:
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure
