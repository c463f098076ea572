"""One motion of a site: scaled, its overturning spectrum, and the shape of its half-waves at each p."""

from __future__ import annotations

import numpy as np

from rocking.half_wave_demand import lobe_shapes
from rocking.overturning_spectrum import OverturningSpectrum
from rocking.spectrum_lanes import RATES
from rockpulse.assessment.overturning import LANES
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused
from rockpulse.motions.directions import Motion
from rockpulse.motions.runner import Part, Watch
from rockpulse.record.half_wave import half_waves
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.record import facts_of_record, no_facts, scaled_motion

__all__ = ["no_spectrum_record", "site_spectrum_record"]


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
        lanes = LANES[config.calibration.spectrum](record, waves=waves)
        found = {
            **facts_of_record(record, factor, config),
            "spectrum": OverturningSpectrum(lanes).spectrum(RESTITUTIONS),
            "record_ratio": ratio,
            "record_main_count": count,
        }
    return {name: np.array([values]) for name, values in found.items()}


def no_spectrum_record() -> Part:
    """Every array of :func:`site_spectrum_record`, and "event", without a row."""
    return {
        **no_facts(),
        "spectrum": np.zeros((0, RATES.size, RESTITUTIONS.size)),
        **dict.fromkeys(("record_ratio", "record_main_count"), np.zeros((0, RATES.size))),
    }
