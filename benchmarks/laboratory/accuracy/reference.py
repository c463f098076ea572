"""The stored high-precision reference responses, and the ground motions that belong to them.

``benchmarks/make_reference.py`` writes the table ``rocking_reference.csv``, whose first lines state how it was made.
"""

import hashlib
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from rockpulse.errors import RockpulseError
from rockpulse.record.record import Record
from synthetic import synthetic_motion

TABLE = Path(__file__).with_name("rocking_reference.csv")
COLUMNS = ("case", "motion", "motion_sha256", "dt", "scale", "equation", "p", "alpha", "restitution", "gravity")
COLUMNS += ("peak_text", "outcome", "overturning_time", "impacts")
COLUMNS += tuple(f"{how}_{name}" for how in ("lowered", "scaled") for name in ("peak_text", "outcome", "impacts"))
FLOATS = ("dt", "scale", "p", "alpha", "restitution", "gravity", "overturning_time")
COUNTS = ("impacts", "lowered_impacts", "scaled_impacts")
PEAKS = ("peak", "lowered_peak", "scaled_peak")
#: Name of a synthetic motion: this and its seed.
SYNTHETIC = "synthetic-"
#: Decimals of the samples of a conditioned record [m/s2]: the last bits of a mean differ between machines.
SAMPLE_DECIMALS = 9


def load_reference(path: Path = TABLE) -> pd.DataFrame:
    """The reference responses, one row a case; RockpulseError for a table with other columns.

    Returns
    -------
    pandas.DataFrame
        case, motion (``synthetic-<seed>`` or the id of a sample record), motion_sha256, dt [s], scale [-], equation, p
        [1/s], alpha [rad], restitution [-], gravity [m/s2], peak (theta_max/alpha_c; inf when overturned), outcome
        (name of a `models.Outcome`), overturning_time [s] (nonlinear, at pi/2; else NaN), impacts, and the same under
        two perturbations: lowered_peak, lowered_outcome, lowered_impacts (C times 1 - 1e-13) and scaled_peak,
        scaled_outcome, scaled_impacts (record times 1 + 1e-13). Each peak is there as float64 and, in 24 digits, as
        text (peak_text, ...). spread is the larger distance of the two perturbed peaks from peak [-]: 0 where all
        three overturn, inf where an outcome flips.
        ``DataFrame.attrs["provenance"]`` has the head of the file.
    """
    with path.open(encoding="utf-8") as file:
        head = [line[1:].strip() for line in file if line.startswith("#")]
    # As text: not every version of pandas reads a float64 to the last bit.
    table = pd.read_csv(path, comment="#", dtype=str, keep_default_na=False)
    if tuple(table.columns) != COLUMNS:
        raise RockpulseError(
            f"{path}: expected the columns {', '.join(COLUMNS)}, found {', '.join(table.columns)}; "
            "make the table anew with benchmarks/make_reference.py"
        )
    for name in FLOATS:
        table[name] = [float(text) for text in table[name]]
    for name in COUNTS:
        table[name] = [int(text) for text in table[name]]
    for peak in PEAKS:
        table[peak] = [float(text) for text in table[f"{peak}_text"]]
    table["spread"] = np.maximum(_distance(table, "lowered"), _distance(table, "scaled"))
    table.attrs["provenance"] = "\n".join(head)
    return table


def motion_of(row: Any, records: Mapping[str, Record] | None = None) -> tuple[np.ndarray, float]:
    """Acceleration (n,) [m/s2] before the scale of the row, and interval [s], of a row of `load_reference`.

    `records` are the sample records by id, conditioned with the default options; they are needed for rows that are not
    synthetic. Raises RockpulseError for a record that is not given, or samples other than those of the reference.
    """
    if not isinstance(row, pd.Series):
        row = pd.Series(row._asdict())
    name, case, dt = str(row["motion"]), row["case"], float(row["dt"])
    if name.startswith(SYNTHETIC):
        motion = synthetic_motion(int(name.removeprefix(SYNTHETIC)), dt=dt)
    elif records is not None and name in records:
        motion = sample_motion(records[name])
    else:
        raise RockpulseError(
            f"reference case {case}: expected the record {name}, which is not among those given; "
            "read the repository's data/samples/records, condition with the default options and pass it in `records`"
        )
    found = motion_sha256(motion)
    if found != row["motion_sha256"]:
        raise RockpulseError(
            f"reference case {case}: expected the motion {name} with SHA-256 {row['motion_sha256']}, found {found}; "
            "the record was conditioned otherwise, or this numpy makes another motion: the reference does not apply"
        )
    return motion, dt


def sample_motion(record: Record) -> np.ndarray:
    """(n,) Acceleration of a conditioned record [m/s2], rounded so that it is the same on every machine."""
    return np.round(record.acceleration, SAMPLE_DECIMALS)


def motion_sha256(acceleration: np.ndarray) -> str:
    """SHA-256 of the samples as little-endian float64, negative zeros taken as zeros."""
    return hashlib.sha256((np.asarray(acceleration) + 0.0).astype("<f8").tobytes()).hexdigest()


def _distance(table: pd.DataFrame, perturbed: str) -> np.ndarray:
    """Distance of the peak to a perturbed one, by the digits of the texts; inf where the outcomes differ."""
    pairs = zip(table["peak_text"], table[f"{perturbed}_peak_text"], strict=True)
    distance = [0.0 if exact == other else float(abs(Decimal(exact) - Decimal(other))) for exact, other in pairs]
    return np.where(table["outcome"] == table[f"{perturbed}_outcome"], distance, np.inf)
