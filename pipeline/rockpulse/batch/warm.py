"""Kernels compiled before the workers start: then each of them loads the cache, and none compiles for itself."""

from __future__ import annotations

from dataclasses import replace

from rocking.block import Block
from rockpulse.assessment.assessment import assess_record
from rockpulse.assessment.directions import Motion
from rockpulse.config.bodies import gather_bodies
from rockpulse.config.configuration import Config
from rockpulse.config.settings import CalibrationSettings
from rockpulse.record.record import Record
from rockpulse.record.synthetic import synthetic_motion

__all__ = ["warm_up"]


def warm_up(config: Config, calibration: bool = False) -> None:
    """Have this process compile, or load, every kernel that the work of a configuration calls.

    Parameters
    ----------
    config : Config
        Its models and searches answer once, under a synthetic motion of a few seconds.
    calibration : bool
        Whether the work is a calibration of sequences instead of an assessment.
    """
    motion = synthetic_motion(1, duration=8.0, pga=6.0)
    record = Record(motion, dt=0.01, id="warm-up", processed=True)
    # From a post that the motion overturns to a wall that it hardly moves: every rung of the ladder has work to do.
    blocks = [
        Block(half_width=b, half_height=h) for b, h in ((0.1, 1.0), (0.2, 2.0), (0.5, 2.5), (1.0, 5.0), (1.0, 4.0))
    ]
    if calibration:
        from rockpulse.studies.site.record import site_record

        statistics = Config(calibration=CalibrationSettings(method="statistics"))
        site_record(Motion(record, (record,)), Block.stack(blocks), statistics)
    else:
        plain = Config(models=config.models, search=replace(config.search, points=8, step=1.2))
        assess_record(record, gather_bodies(dict(zip("abcde", blocks, strict=True))), plain)
