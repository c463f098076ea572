"""One motion of a site: scaled, its overturning spectrum, and the shape of its half-waves at each p."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rocking.half_wave_demand import lobe_shapes
from rocking.overturning_spectrum import OverturningSpectrum
from rocking.spectrum_lanes import RATES, spectrum_lanes
from rockpulse.calibration.rule import load_rule
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.motions.directions import Motion
from rockpulse.motions.runner import Part, Watch
from rockpulse.record.half_wave import HalfWaves, half_waves
from rockpulse.record.record import Record
from rockpulse.storage.spectrum_variables import RESTITUTIONS
from rockpulse.studies.site.record import facts_of_record, scaled_motion

__all__ = ["SPECTRUM", "site_spectrum_record"]


def _by_rule(record: Record, waves: HalfWaves) -> np.ndarray:
    """S (a, c) [m/s] by the balanced rule, at most PGA/p, for without uplift nothing overturns."""
    spectrum = OverturningSpectrum(load_rule("balanced").spectrum_lanes(waves)).spectrum(RESTITUTIONS)
    return np.asarray(np.minimum(spectrum, record.pga / RATES[:, np.newaxis]))


def _by_nonlinear(record: Record, waves: HalfWaves) -> np.ndarray:
    """S (a, c) [m/s] by the nonlinear equation of motion under the uncertainty of :class:`rocking.Uncertainty`."""
    return OverturningSpectrum(spectrum_lanes(record.acceleration, record.dt)).spectrum(RESTITUTIONS)


#: The spectrum of a record over RATES and RESTITUTIONS, by the word of ``[calibration] spectrum``.
SPECTRUM: dict[str, Callable[[Record, HalfWaves], np.ndarray]] = {"rule": _by_rule, "nonlinear": _by_nonlinear}


def site_spectrum_record(motion: Motion, watch: Watch, config: Config) -> Part:
    """Scale a motion and work out its overturning spectrum: arrays by the names of the file.

    They are (1,), but "spectrum" (1, a, c), "record_ratio" and "record_main_count" (1, a). RecordRefused where the
    motion cannot be scaled or is nothing but zeros.
    """
    with watch("solve"):
        record, factor = scaled_motion(motion, config)
        if record.pga == 0.0:
            raise RecordRefused(f"{record.id}: nothing but zeros, which has no overturning spectrum")
        waves = half_waves(record, **config.half_waves)
        count, ratio, _ = lobe_shapes(waves.start, waves.centroid, waves.end, waves.impulse, RATES)
        found = {
            **facts_of_record(record, factor, config),
            "spectrum": SPECTRUM[config.calibration.spectrum](record, waves),
            "record_ratio": ratio,
            "record_main_count": count,
        }
    return {name: np.array([values]) for name, values in found.items()}
