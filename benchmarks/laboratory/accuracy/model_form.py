"""Error of the simpler models compared with the nonlinear response to the record, over an ensemble.

.. note:: A lane is one combination of record, scale factor and block. Every model of an assessment can be compared; by
   default those of :data:`COMPARED` are. Errors are statistics of an ensemble and never those of one record, because
   the motion is chaotic near overturning.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import mannwhitneyu

from laboratory.ensemble import blocks
from rocking.body.block import Block
from rocking.response import Outcome
from rockpulse.assessment.scene import extract
from rockpulse.config.configuration import Config
from rockpulse.model_table import ALL_MODELS, MODELS, Scene
from rockpulse.record.intensity import pgv
from rockpulse.record.record import Record
from rockpulse.selection.directions import conditioned
from synthetic import synthetic_motion

#: The model that judges the others, and those that are judged.
JUDGE = "nonlinear"
COMPARED = tuple(model for model in ALL_MODELS if model != JUDGE)
#: Factors on each record [-].
SCALES = (0.5, 0.7, 1.0, 1.4)
#: Smaller peaks of the judge are left out of bias and dispersion, as theta_max/alpha_c [-].
SMALLEST_PEAK = 0.05
#: Lower edges of the demand levels, as p PGV/(g tan alpha) [-]; the last level has no upper edge.
LEVELS = (0.0, 0.25, 0.5, 1.0, 2.0)
#: Single numbers that are tried as classifiers of the verdict [-], each from a conditioned record and blocks.
DEMANDS: dict[str, Callable[[Scene, Block], Any]] = {
    "velocity_ratio": lambda scene, block: block.p * pgv(scene.record) / _capacity(block),
    "uplift_ratio": lambda scene, block: scene.record.pga / _capacity(block),
    "impulse_ratio": lambda scene, block: np.max(np.abs(scene.waves.impulse), initial=0.0) / block.critical_impulse,
}
#: The demand that the tables are sorted by.
BY_DEMAND = "velocity_ratio"
#: Shares of missed overturnings at which a classifier's false alarms are given [-].
MISSED_SHARES = (0.0, 0.05, 0.1)


def synthetic_records(seed: int, count: int) -> list[Record]:
    """Synthetic motions of the seeds `seed`, seed + 1 and so on, as records of a processed volume.

    60 s at 0.01 s each, peak 3 m/s2; see :func:`synthetic.synthetic_motion`.
    """
    return [
        Record(synthetic_motion(number), dt=0.01, id=f"synthetic.{number}", orientation="horizontal", processed=True)
        for number in range(seed, seed + count)
    ]


def model_form_lanes(
    ensemble: str,
    record: Record,
    config: Config | None = None,
    scales: Sequence[float] = SCALES,
    models: Sequence[str] = COMPARED,
) -> pd.DataFrame:
    """The answers of every model for every lane of a horizontal record as read, and of the nonlinear model.

    One row per lane: ensemble, record, scale, slenderness, radius [m], every demand of :data:`DEMANDS` [-], and for
    each model `peak <model>` (theta_max/alpha_c [-]) and `outcome <model>`. The configuration, by default that of an
    assessment, conditions and calibrates the record; `scales` are factors on it [-]. Raises RockpulseError where the
    record cannot be conditioned or has no intense phase.
    """
    config = config or Config()
    bodies, unscaled = blocks(), extract(conditioned(record, config), config)
    frames = []
    for scale in scales:
        scene = _scaled(unscaled, scale)
        columns: dict[str, Any] = {
            "ensemble": ensemble,
            "record": record.id,
            "scale": scale,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            **{name: demand(scene, bodies) for name, demand in DEMANDS.items()},
        }
        for model in (*models, JUDGE):
            response = MODELS[model].respond(bodies, scene)
            columns[f"peak {model}"] = response.peak_rotation_ratio
            columns[f"outcome {model}"] = response.outcome
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


def model_form_table(lanes: pd.DataFrame, models: Sequence[str] = COMPARED) -> pd.DataFrame:
    """Bias, dispersion, missed and false overturnings of each model by demand level.

    The lanes are those of :func:`model_form_lanes`; several ensembles may stand below each other.

    Returns
    -------
    DataFrame
        One row per ensemble, model and demand level, `demand_low` to `demand_high` [-], and one over all levels (0 to
        inf). `lanes` counts those that both model and judge can answer, `unresolved` those that either cannot, which
        are in no other number. `overturn`: by the judge. `missed` overturn by the judge only, `false` by the model
        only. `survivors`: both survive, the judge with a peak above 0.05; `at_rest` of them do not move in the model
        and are left out of `bias`, the median of the ratio model/judge of peaks [-], and `dispersion`, the standard
        deviation of its logarithm [-] (NaN below two).
    """
    rows = []
    for ensemble, members in lanes.groupby("ensemble", sort=False):
        for model in models:
            for low, high in [(0.0, np.inf), *zip(LEVELS, (*LEVELS[1:], np.inf), strict=True)]:
                level = members[(members[BY_DEMAND] >= low) & (members[BY_DEMAND] < high)]
                head = {"ensemble": ensemble, "model": model, "demand_low": low, "demand_high": high}
                rows.append({**head, **_compared(level, model)})
    return pd.DataFrame(rows)


def classifier_table(lanes: pd.DataFrame) -> pd.DataFrame:
    """Single numbers as classifiers of the nonlinear verdict, on lanes of :func:`model_form_lanes`.

    Returns
    -------
    DataFrame
        One row per ensemble and demand: `lanes`, `overturn`, `auc` (area under the ROC curve [-]: the chance that an
        overturned lane has the larger demand than one that survives, ties counting half), and `false_at_0`,
        `false_at_5`, `false_at_10`, the share of survivors [-] above the highest limit that misses at most 0, 5 or 10
        % of the overturnings. NaN where all lanes have one verdict.

    Notes
    -----
    AUC = U/(n_1 n_2) with the Mann-Whitney U: Hanley & McNeil (1982), Radiology 143(1), 29-36,
    doi:10.1148/radiology.143.1.7063747.
    """
    rows = []
    for ensemble, members in lanes.groupby("ensemble", sort=False):
        known = members[members[f"outcome {JUDGE}"] != Outcome.UNRESOLVED]
        over = known[f"outcome {JUDGE}"] == Outcome.OVERTURNS
        for demand in DEMANDS:
            fell, stood = np.sort(known.loc[over, demand]), known.loc[~over, demand].to_numpy()
            row = {"ensemble": ensemble, "demand": demand, "lanes": len(known), "overturn": fell.size}
            both = fell.size > 0 and stood.size > 0
            row["auc"] = mannwhitneyu(fell, stood).statistic / (fell.size * stood.size) if both else np.nan
            for share in MISSED_SHARES:
                # Lanes at the limit raise the alarm; the share below it may be missed.
                limit = fell[int(share * fell.size)] if both else np.nan
                row[f"false_at_{100 * share:.0f}"] = np.mean(stood >= limit) if both else np.nan
            rows.append(row)
    return pd.DataFrame(rows)


def _compared(lanes: pd.DataFrame, model: str) -> dict[str, Any]:
    outcomes = lanes[[f"outcome {JUDGE}", f"outcome {model}"]]
    known = lanes[(outcomes != Outcome.UNRESOLVED).all(axis=1)]
    judged = (known[f"outcome {JUDGE}"] == Outcome.OVERTURNS).to_numpy()
    told = (known[f"outcome {model}"] == Outcome.OVERTURNS).to_numpy()
    truth, peak = known[f"peak {JUDGE}"].to_numpy(), known[f"peak {model}"].to_numpy()
    survivors = ~judged & ~told & (truth > SMALLEST_PEAK)
    moving = survivors & (peak > 0.0)
    ratio = peak[moving] / truth[moving]
    return {
        "lanes": len(known),
        "unresolved": len(lanes) - len(known),
        "overturn": int(np.sum(judged)),
        "missed": int(np.sum(judged & ~told)),
        "false": int(np.sum(told & ~judged)),
        "survivors": int(np.sum(survivors)),
        "at_rest": int(np.sum(survivors & (peak == 0.0))),
        "bias": float(np.median(ratio)) if ratio.size else np.nan,
        "dispersion": float(np.std(np.log(ratio), ddof=1)) if ratio.size > 1 else np.nan,
    }


def _scaled(scene: Scene, factor: float) -> Scene:
    """The scene of the record times a factor: half-waves, phase and sequence keep their times."""
    record, waves = scene.record, scene.waves
    return replace(
        scene,
        record=replace(record, acceleration=factor * record.acceleration),
        waves=replace(waves, impulse=factor * waves.impulse, peak=factor * waves.peak),
        sequence=None if scene.sequence is None else scene.sequence.scaled(factor),
    )


def _capacity(block: Block) -> np.ndarray:
    """The acceleration of uplift g tan(alpha) [m/s2]."""
    return block.gravity * np.tan(block.alpha_c)
