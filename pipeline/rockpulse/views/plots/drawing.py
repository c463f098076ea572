"""The figure of each kind of picture, from a results file and the selection of the user."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rockpulse.assessment.spectra import ALPHAS, P, overturning_spectrum
from rockpulse.assessment.spectra import rocking_spectrum as compute_spectrum
from rockpulse.config.study_settings import UncertaintySettings
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.views.plots.critical_factors import critical_scale, overturning_map
from rockpulse.views.plots.fragility_curves import fragility_panels
from rockpulse.views.plots.ground_motion import accelerogram, had_vertical, stored_motion, stored_record
from rockpulse.views.plots.impulse_sequences import limit_accelerogram
from rockpulse.views.plots.model_histories import histories
from rockpulse.views.plots.objects import bodies
from rockpulse.views.plots.probability_map import probability_map
from rockpulse.views.plots.rotation import rotation_history
from rockpulse.views.plots.selection import block_of, named_body, one_name, plain_bodies, ragged, sequence_of, setting
from rockpulse.views.plots.site import calibration
from rockpulse.views.plots.spectra import rocking_spectrum, spectra_of_results
from rockpulse.views.plots.style import plain
from rockpulse.views.shared.facts import Known

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Most records whose spectra are marched again for a picture, some seconds in all.
MARCHED = 12


def _figure(ax: Axes) -> Figure:
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


def _title(summary: xr.Dataset, record: str, body: str) -> str:
    """Record and body, and in a second line what is known of the record in words."""
    return "\n".join(filter(None, (f"{plain(record)}, {plain(body)}", plain(Known(summary, record=record).described))))


def _accelerogram(tree: xr.DataTree, record: str | None = None) -> Figure:
    return _figure(accelerogram(stored_motion(tree, one_name(tree["summary"].to_dataset(), "record", record)))[0])


def _limit_accelerogram(
    tree: xr.DataTree, record: str | None = None, block: str | None = None, case: int = 1
) -> Figure:
    summary = tree["summary"].to_dataset()
    record, block = one_name(summary, "record", record), one_name(summary, "block", block)
    body = block_of(summary, block, case)
    name = _title(summary, record, named_body(summary, block, case))
    try:
        return _figure(limit_accelerogram(body, sequence_of(tree, record), name=name)[0])
    except ResultsError:
        raise
    except ValueError as error:
        raise ResultsError(f"{record}, {block}: the sequence has no limit accelerogram: {error}") from error


def _rotation_history(
    tree: xr.DataTree,
    record: str | None = None,
    block: str | None = None,
    models: Sequence[str] | None = None,
    case: int = 1,
    factor: float = 1.0,
) -> Figure:
    summary = tree["summary"].to_dataset()
    record, block = one_name(summary, "record", record), one_name(summary, "block", block)
    name = _title(summary, record, named_body(summary, block, case))
    if factor != 1.0:
        name += f", the record times {factor:g}"
    return _figure(rotation_history(histories(tree, record, block, models, case, factor), title=name)[0])


def _rocking_spectrum(tree: xr.DataTree, record: str | None = None, restitution: float | str = "housner") -> Figure:
    summary = tree["summary"].to_dataset()
    record = one_name(summary, "record", record)
    names = [str(name) for name in summary["block"].values]
    own = {name: summary.sel(block=name) for name in plain_bodies(summary)}
    bodies = {name: (float(one["p"]), float(one["alpha_c"])) for name, one in own.items()}
    p = _reaching(P, [rate for rate, _ in bodies.values()])
    alpha = _reaching(ALPHAS, [angle for _, angle in bodies.values()])
    if restitution != "housner" and not 0.0 <= float(restitution) <= 1.0:
        raise ConfigError(f'restitution: expected a number from 0 to 1 or "housner", got {restitution}')
    c: Any = restitution if restitution == "housner" else float(restitution)
    spectrum = compute_spectrum(
        stored_record(tree, record), p, alpha, restitution=c, gravity=block_of(summary, names[0]).gravity
    )
    note = ""
    if had_vertical(summary, record):
        note = "Without the vertical channel, which acted on the verdicts of the file and is not stored."
    return _figure(rocking_spectrum(spectrum, bodies=bodies, note=note))


def _reaching(values: Sequence[float], marked: Sequence[float]) -> list[float]:
    """Equally spaced values over the same range, widened to include every marked value."""
    low, high = min([values[0], *(0.9 * one for one in marked)]), max([values[-1], *(1.1 * one for one in marked)])
    return np.linspace(low, high, len(values)).tolist()


def _spectrum(tree: xr.DataTree, record: str | None = None, restitution: float | str | None = None) -> Figure:
    summary, spectra = tree["summary"].to_dataset(), tree["spectra"].to_dataset()
    if record is not None:
        spectra = spectra.sel(record=[one_name(summary, "record", record)])
    if restitution == "housner":
        raise ConfigError("restitution: the spectrum is drawn at one C; expected a number from 0.75 to 1")
    c = float(summary["restitution"].median()) if restitution is None else float(restitution)
    return _figure(spectra_of_results(tree, _whole(tree, spectra, c), c))


def _whole(tree: xr.DataTree, spectra: xr.Dataset, restitution: float) -> xr.Dataset:
    """Spectra at the stored C nearest to one: as stored, or of a few records marched again where they have gaps."""
    import xarray as xr

    records, grid = [str(name) for name in spectra["record"].values], spectra["restitution"].values
    nearest = float(grid[np.argmin(np.abs(grid - restitution))])
    there = np.isfinite(spectra["spectrum"].sel(restitution=nearest).transpose("record", "p").values)
    samples = [ragged(tree, "row_size", ["acceleration"], record) for record in records]
    if there.all() or not there.any() or len(records) > MARCHED or None in samples:
        return spectra
    stated = {name: setting(tree, "uncertainty", name, value) for name, value in dict(**UncertaintySettings()).items()}
    uncertainty = UncertaintySettings(**stated).of_draws()
    whole = [
        overturning_spectrum(stored_record(tree, record), restitution=[nearest], uncertainty=uncertainty)
        for record in records
    ]
    return xr.concat(whole, xr.Variable("record", records), combine_attrs="drop_conflicts")


def _overturning_map(
    tree: xr.DataTree, record: str | None = None, block: str | None = None, models: Sequence[str] | None = None
) -> Figure:
    if models is not None and len(models) != 1:
        raise ResultsError(f"overturning-map: expected one model, got {', '.join(models)}")
    return _figure(overturning_map(tree, record, block, None if models is None else models[0]))


def _probability(tree: xr.DataTree, demand: str | None = None) -> Figure:
    return _figure(probability_map(tree, demand))


def _critical_scale(
    tree: xr.DataTree, block: str | None = None, models: Sequence[str] | None = None, case: int = 1
) -> Figure:
    return _figure(critical_scale(tree, block, models, case))


def _fragility(
    tree: xr.DataTree,
    block: str | None = None,
    measure: str | None = None,
    limit_states: Sequence[str] | None = None,
) -> Figure:
    return _figure(fragility_panels(tree, block, None if measure is None else [measure], limit_states)[0])


def _calibration(tree: xr.DataTree) -> Figure:
    return _figure(calibration(tree)[0])


#: By the names of :data:`rockpulse.views.plots.kinds.KINDS`.
DRAWERS: dict[str, Callable[..., Figure]] = {
    "accelerogram": _accelerogram,
    "bodies": bodies,
    "limit-accelerogram": _limit_accelerogram,
    "rotation-history": _rotation_history,
    "rocking-spectrum": _rocking_spectrum,
    "spectrum": _spectrum,
    "overturning-map": _overturning_map,
    "probability": _probability,
    "critical-scale": _critical_scale,
    "fragility": _fragility,
    "calibration": _calibration,
}
