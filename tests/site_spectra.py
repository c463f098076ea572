"""A site from records with given overturning spectra."""

from contextlib import nullcontext
from functools import cache

import numpy as np

import rockpulse as rp
from rocking.body.limits import RATES
from rockpulse import CalibrationSettings
from rockpulse.models import Block
from rockpulse.selection.directions import Motion
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.studies.site.calibration import SiteCalibration
from rockpulse.studies.site.spectrum_design import site_spectrum_record

#: Slendernesses 10 and 4.5, and one that no spectrum stands for.
BLOCKS = {"wall": Block(0.3, 3.0), "pier": Block(0.8, 3.6), "chest": Block(1.6, 3.6, restitution=0.8)}

#: S of a record of strength 1 [m/s] over p and C: a power law, which interpolation in ln S, ln p and C meets exactly.
BASE = 0.4 * RATES[:, np.newaxis] ** 0.5 * np.exp(2.0 * (RESTITUTIONS - 0.9))


def base_at(block):
    return 0.4 * block.p**0.5 * np.exp(2.0 * (block.restitution - 0.9))


def done_with(strengths, events):
    """What the work on records of such strengths would find."""
    motion = rp.Record(np.sin(np.arange(0.0, 20.0, 0.1)), dt=0.1, id="motion", processed=True)
    facts = site_spectrum_record(Motion(motion), nullcontext, rp.Config())
    count = len(strengths)
    found = {name: np.repeat(value, count, axis=0) for name, value in facts.items()}
    return found | {
        "record": np.array([f"record{place:02d}" for place in range(count)]),
        "event": np.array([f"Earthquake {event}" for event in events]),
        "spectrum": np.asarray(strengths, dtype=float)[:, np.newaxis, np.newaxis] * BASE,
        "record_ratio": np.linspace(0.1, 0.5, count),
        "record_interval": np.linspace(0.1, 0.2, count),
        "record_main_count": np.arange(2.0, 2.0 + count),
    }


def site_of(strengths, events=None, blocks=BLOCKS, **calibration):
    """The tree of such records, of one earthquake each without `events`."""
    config = rp.Config(calibration=CalibrationSettings(**{"bootstrap": 100, **calibration}))
    done = done_with(strengths, range(len(strengths)) if events is None else events)
    return SiteCalibration(config, blocks or {}).collect([done], [], [])


@cache
def usual_site():
    """Ten earthquakes; to be left as it is."""
    return site_of(np.linspace(0.5, 1.4, 10))
