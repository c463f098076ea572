"""Data of each record for the test of a site calibration, computed once: capacities and overturning spectra.

.. note:: The capacity of a body is `factor_50` of the nonlinear overturning spectrum of the record, under the default
   uncertainty. The spectrum is that of ``rockpulse calibrate`` for one record.
"""

import re
from contextlib import nullcontext
from pathlib import Path

import numpy as np

from laboratory.ensemble import StrongMotion
from rocking.body.block import Block
from rocking.spectrum.overturning import OverturningSpectrum
from rocking.spectrum.slender_lanes import spectrum_lanes
from rockpulse.config.configuration import Config
from rockpulse.selection.directions import Motion
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.spectrum_design import site_spectrum_record

__all__ = ["BODIES", "known_of"]

#: Frequency parameters [1/s], and the slendernesses with their restitutions [-] that are tried at each.
RATES, SHAPES = (0.5, 1.25, 3.0, 8.0), np.array([(4.0, 0.8), (6.0, 0.9), (10.0, 0.97)])

#: The twelve bodies of the study.
BODIES = Block.from_parameters(
    p=np.repeat(RATES, len(SHAPES)),
    alpha=np.tile(np.arctan(1.0 / SHAPES[:, 0]), len(RATES)),
    restitution=np.tile(SHAPES[:, 1], len(RATES)),
    log=False,
)


def known_of(motion: StrongMotion, folder: Path) -> dict[str, np.ndarray]:
    """Capacities and spectra of a motion by name, from its file in a folder if there is one.

    `capacity` (12,) [-], `rule` and `nonlinear` (a, c) [m/s].
    """
    # Files without station give equal ids.
    name = f"{motion.event} {motion.record.id} {motion.record.npts}"
    path = folder / f"{re.sub('[^A-Za-z0-9.-]', '_', name)}.npz"
    if not path.exists():
        np.savez(path, **_computed(motion))
    with np.load(path) as stored:
        return dict(stored)


def _computed(motion: StrongMotion) -> dict[str, np.ndarray]:
    record, config = motion.record, Config()
    own = OverturningSpectrum(spectrum_lanes(record.acceleration, record.dt))
    of_rule = site_spectrum_record(Motion(record), lambda _: nullcontext(), config)
    return {
        "capacity": own.factors(BODIES).factor_50,
        "nonlinear": own.spectrum(RESTITUTIONS),
        "rule": of_rule["spectrum"][0],
    }
