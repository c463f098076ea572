"""One record of a site: scaled, its sequence, and what its motion does to the blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rocking.block import Block
from rocking.recorded import recorded_response
from rocking.response import Outcome
from rocking.sequence import ImpulseSequence, sequence_response
from rockpulse.assessment.directions import Motion
from rockpulse.assessment.scene import extract
from rockpulse.calibration.response import calibrate_response
from rockpulse.config.configuration import Config
from rockpulse.errors import RecordRefused, TooWeak
from rockpulse.ladder import Scene
from rockpulse.record.conditioning import condition
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record
from rockpulse.remark import Remark, find
from rockpulse.studies.site.design import PARAMETERS
from rockpulse.studies.site.scaling import largest_impulse, scale_factor, scaled

__all__ = ["SiteRecord", "rotation_to_cover", "site_record"]

#: Smaller recorded peaks do not enter a misfit: just after uplift no sequence is comparable [-].
SMALLEST_PEAK = 0.01

#: Scale factors beyond these make a motion of another kind of earthquake than the one recorded.
USUAL_FACTORS = (0.25, 4.0)


@dataclass(frozen=True, eq=False)
class SiteRecord:
    """A record of a site; everything is that of the scaled motion.

    Attributes
    ----------
    record : Record
        Conditioned and scaled.
    channel : str
        Id of the channel behind it, of a pair the first one.
    factor : float
        On the record as conditioned [-].
    pga : float
        [m/s2].
    pgv, impulse : float
        PGV and largest half-wave impulse [m/s].
    sequence : ImpulseSequence
        The record's own.
    intervals : dict of str to (float, float)
        By parameter, where the method gives them.
    peaks : (m,) ndarray
        Recorded theta_max/alpha_c [-]: inf overturned, 0 at rest, NaN unresolved.
    misfit, unsafe_share : float
        Of the record's own sequence on the blocks that the motion lifts.
    remarks : tuple of str
        What the calibration of the sequence says of itself.
    """

    record: Record
    channel: str
    factor: float
    pga: float
    pgv: float
    impulse: float
    sequence: ImpulseSequence
    intervals: dict[str, tuple[float, float]]
    peaks: np.ndarray
    misfit: float
    unsafe_share: float
    remarks: tuple[str, ...]

    @property
    def values(self) -> list[float]:
        """The parameters of the sequence; NaN where there is no limit or no meaning."""
        sequence = self.sequence
        return [
            sequence.main,
            sequence.secondary / sequence.main,
            sequence.interval,
            math.nan if sequence.main_count is None else float(sequence.main_count),
            sequence.duration if math.isfinite(sequence.duration) else math.nan,
        ]

    def ends(self, side: int) -> list[float]:
        """Lower (0) or upper (1) ends of the intervals of the parameters; NaN without."""
        nothing = (math.nan, math.nan)
        return [float(self.intervals.get(name, nothing)[side]) for name in PARAMETERS]


def rotation_to_cover(peaks: np.ndarray) -> np.ndarray:
    """What a sequence has to reach in order to cover recorded rotations.

    Parameters
    ----------
    peaks : ndarray
        Recorded theta_max/alpha_c [-]: inf overturned, 0 at rest, NaN unresolved.

    Returns
    -------
    ndarray
        NaN at rest, which every sequence covers; inf where the answer is not known, for only an overturning sequence
        is sure to cover it.

    Examples
    --------
    >>> rotation_to_cover(np.array([0.2, 0.0, np.nan])).tolist()
    [0.2, nan, inf]
    """
    return np.where(peaks == 0.0, np.nan, np.where(np.isnan(peaks), np.inf, peaks))


def site_record(motion: Motion, blocks: Block, config: Config) -> SiteRecord:
    """Scale a record, calibrate its sequence, and let its motion act on the blocks.

    Parameters
    ----------
    motion : Motion
        A channel as read, or a rotated pair; the vertical channel that acts too is scaled alike.
    blocks : Block
        (m,) blocks.
    config : Config
        Every section but models and search is used.

    Raises
    ------
    ValueError
        Where the record cannot be conditioned, scaled or calibrated; TooWeak where it moves too few blocks.
    """
    vertical = motion.vertical
    conditioned = motion.record if motion.pair else condition(motion.record, **config.conditioning)
    factor = scale_factor(conditioned, config)
    if not USUAL_FACTORS[0] <= factor <= USUAL_FACTORS[1]:
        low, high = USUAL_FACTORS
        conditioned = conditioned.with_warning(Remark("scaled_far", factor=factor, low=low, high=high))
    if config.calibration.scale_to == "pgv" and find(conditioned.warnings, "baseline_drift"):
        conditioned = conditioned.with_warning(Remark("scaled_to_drift"))
    scene = extract(scaled(conditioned, factor), config, None if vertical is None else scaled(vertical, factor))
    response = recorded_response(blocks, scene.record.acceleration, scene.record.dt, vertical=scene.vertical)
    peaks = np.where(response.outcome == Outcome.UNRESOLVED, np.nan, response.peak_rotation_ratio)
    if scene.sequence is None:
        reason = find(scene.record.warnings, "no_sequence")
        raise (RecordRefused if np.any(peaks != 0.0) else TooWeak)(str(reason))
    sequence, intervals, remarks = _calibrated(scene, scene.sequence, blocks, config)
    misfit, unsafe = _compared(peaks, sequence, blocks)
    return SiteRecord(
        record=scene.record,
        channel=motion.channels[0].id,
        factor=factor,
        pga=scene.record.pga,
        pgv=pgv(scene.record),
        impulse=largest_impulse(scene.record, config),
        sequence=sequence,
        intervals=intervals,
        peaks=peaks,
        misfit=misfit,
        unsafe_share=unsafe,
        remarks=remarks,
    )


def _calibrated(
    scene: Scene, start: ImpulseSequence, blocks: Block, config: Config
) -> tuple[ImpulseSequence, dict[str, tuple[float, float]], tuple[str, ...]]:
    settings = config.calibration
    if settings.method == "statistics":
        return start, {}, ()
    found = calibrate_response(
        scene.record,
        blocks if settings.family == "blocks" else None,
        vertical=scene.vertical,
        start=start,
        spacing=config.sequence.spacing,
        confidence=settings.confidence,
        seed=config.run.seed,
    )
    return found.sequence, dict(found.intervals), found.remarks


def _compared(peaks: np.ndarray, sequence: ImpulseSequence, blocks: Block) -> tuple[float, float]:
    """Root mean square of ln(sequence/record) where both rock, and share of the lifted blocks that fall short."""
    reached = np.asarray(sequence_response(blocks, sequence, table_rows=0).peak_rotation_ratio)
    needed = rotation_to_cover(peaks)
    lifted = ~np.isnan(needed) & ~np.isnan(reached)
    both = lifted & np.isfinite(needed) & np.isfinite(reached) & (needed >= SMALLEST_PEAK) & (reached > 0.0)
    misfit = float(np.sqrt(np.mean(np.log(reached[both] / peaks[both]) ** 2))) if np.any(both) else math.nan
    unsafe = float(np.mean(reached[lifted] < needed[lifted])) if np.any(lifted) else math.nan
    return misfit, unsafe
