"""The ground motion of one record as a small dataset that the pictures take, from results or from a record itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rocking.impulses.impulse_sequence import ImpulseSequence
from rockpulse.errors import RecordRefused, ResultsError
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.intensity import IntensePhase, intense_phase
from rockpulse.record.record import Record
from rockpulse.sequences.estimators import calibrate
from rockpulse.storage.variables import real
from rockpulse.storage.variables.assessment import WAVES
from rockpulse.storage.variables.summary import RECORD
from rockpulse.views.plots.selection import ragged
from rockpulse.views.shared.facts import Known, RecordFacts

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["STORE", "had_vertical", "motion_of_record", "stored_motion", "stored_record"]

#: The remedy where the samples of a record are not in the file.
STORE = 'the file does not hold the accelerograms: assess again with [records] store = "all"'

#: Scalars of a motion, by their names in /summary.
_SCALARS = ("dt", "intense_start", "intense_end", "main_impulse", "secondary_impulse")

#: Stored variables that are fields of a record by another name: by it alone no record is counted to an earthquake.
_FIELDS = {"event_title": "event"}

_ACCELERATION = real("m s-2", "ground acceleration", dims=("sample",))
_TIME = real("s", "time from the first sample", dims=("sample",))


def stored_motion(tree: xr.DataTree, record: str) -> xr.Dataset:
    """Accelerogram, half-waves and calibrated impulses of a record of the results.

    Parameters
    ----------
    tree : xarray.DataTree
        Results of an assessment.
    record : str
        Id.

    Returns
    -------
    xarray.Dataset
        As :func:`motion_of_record` makes it, with the attributes of the results.

    Raises
    ------
    ResultsError
        Where the file does not hold the accelerogram.
    """
    import xarray as xr

    own = tree["summary"].to_dataset().sel(record=record)
    samples = ragged(tree, "row_size", ["acceleration"], record)
    waves = ragged(tree, "half_wave_row_size", [f"half_wave_{name}" for name in WAVES], record)
    if samples is None or waves is None:
        raise ResultsError(f"{record}: {_missing(own)}")
    motion = xr.Dataset(
        {
            **samples,
            **{name.removeprefix("half_wave_"): variable for name, variable in waves.items()},
            **{name: own[name].variable for name in _SCALARS},
        }
    )
    motion["time"] = _TIME.variable(float(own["dt"]) * np.arange(motion.sizes["sample"]))
    motion.attrs["record"] = record
    motion.attrs["words"] = Known(tree["summary"].to_dataset(), record=record).described
    return motion


def motion_of_record(
    record: Record,
    waves: HalfWaves | None = None,
    phase: IntensePhase | None = None,
    sequence: ImpulseSequence | None = None,
) -> xr.Dataset:
    """The same of a record that was read and conditioned.

    Parameters
    ----------
    record : Record
        Conditioned.
    waves : HalfWaves, optional
        By default those of :func:`rockpulse.half_waves`.
    phase : IntensePhase, optional
        By default that of :func:`rockpulse.intense_phase`.
    sequence : ImpulseSequence, optional
        By default that of :func:`rockpulse.calibrate`; none where the phase holds too few half-waves.

    Returns
    -------
    xarray.Dataset
        `acceleration`, `time` (sample), `impulse`, `centroid`, `start`, `end`, `peak` (wave), and the scalars `dt`,
        `intense_start`, `intense_end`, `main_impulse`, `secondary_impulse`, each with `units` and `long_name`.

    Examples
    --------
    >>> from rockpulse.record.record import Record
    >>> motion = motion_of_record(Record([0.0, 3.0, -3.0, 0.0, 1.0, 0.0], dt=0.1, id="three triangles"))
    >>> motion["impulse"].values.round(3).tolist(), motion["impulse"].attrs["units"]
    ([0.225, -0.225, 0.1], 'm s-1')
    """
    import xarray as xr

    waves = half_waves(record) if waves is None else waves
    phase = intense_phase(record) if phase is None else phase
    if sequence is None:
        try:
            sequence = calibrate(waves, phase=phase)
        except RecordRefused:
            sequence = None
    scalars = {
        "dt": record.dt,
        "intense_start": phase.start,
        "intense_end": phase.end,
        "main_impulse": np.nan if sequence is None else sequence.main,
        "secondary_impulse": np.nan if sequence is None else sequence.secondary,
    }
    motion = xr.Dataset(
        {
            "acceleration": _ACCELERATION.variable(record.acceleration),
            "time": _TIME.variable(record.time),
            **{name: variable.variable(getattr(waves, name)) for name, variable in WAVES.items()},
            **{name: RECORD[name].variable(value, ()) for name, value in scalars.items()},
        }
    )
    motion.attrs["record"] = record.id
    motion.attrs["words"] = RecordFacts(lambda name: getattr(record, _FIELDS.get(name, name))).described
    return motion


def stored_record(tree: xr.DataTree, record: str) -> Record:
    """The conditioned record stored in the results, for the models; ResultsError if the accelerogram is not stored."""
    samples = ragged(tree, "row_size", ["acceleration"], record)
    own = tree["summary"].to_dataset().sel(record=record)
    if samples is None:
        raise ResultsError(f"{record}: {_missing(own)}")
    dt = float(own["dt"])
    return Record(samples["acceleration"].values, dt=dt, id=record)


def _missing(own: xr.Dataset) -> str:
    """The reason why there are no samples, and a remedy."""
    return STORE if int(own["npts"]) >= 0 else "a sequence of impulses, which has no accelerogram"


def had_vertical(summary: xr.Dataset, record: str) -> bool:
    """Whether a vertical channel, which is not stored, acted on the nonlinear model of a record."""
    return bool(summary["vertical_channel"].sel(record=record).item())
