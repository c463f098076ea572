"""Kernels compiled before the workers start: then each of them loads the cache, and none compiles for itself."""

from __future__ import annotations

from dataclasses import replace

from rocking.block import Block
from rockpulse.config.configuration import Config
from rockpulse.config.settings import CalibrationSettings
from rockpulse.motions.directions import conditioned_motions
from rockpulse.motions.runner import Analysis, unwatched
from rockpulse.record.record import Record
from rockpulse.record.synthetic import synthetic_motion

__all__ = ["warm_up"]


def warm_up(analysis: Analysis) -> None:
    """Have this process compile, or load, every kernel that the work of an analysis calls.

    Its models and searches answer once, under a synthetic motion of a few seconds.
    """
    config = analysis.config
    plain = Config(
        models=config.models,
        search=replace(config.search, points=8, step=1.2),
        uncertainty=replace(config.uncertainty, azimuth=False),
        calibration=CalibrationSettings(
            method="spectrum" if config.calibration.method == "spectrum" else "statistics",
            spectrum=config.calibration.spectrum,
        ),
        fragility=replace(config.fragility, pga_min=0.0),
    )
    record = Record(synthetic_motion(1, duration=8.0, pga=6.0), dt=0.01, id="warm-up", processed=True)
    # From a post that the motion overturns to a wall that it hardly moves: every kernel has work to do.
    sizes = {"a": (0.1, 1.0), "b": (0.2, 2.0), "c": (0.5, 2.5), "d": (1.0, 5.0), "e": (1.0, 4.0)}
    blocks = {name: Block(half_width=b, half_height=h) for name, (b, h) in sizes.items()}
    small = type(analysis)(plain, blocks)
    for one in small.prepare([record]).planned:
        for motion in conditioned_motions(one, plain):
            small.work(motion, unwatched)
