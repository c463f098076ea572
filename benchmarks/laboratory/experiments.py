"""Overturning tests on a shake table, compared with the nonlinear response of the body and with single thresholds.

``python -m laboratory.experiments FOLDER`` (``make experiments TESTS=FOLDER``) reads the runs of Chen et al. (2022,
arXiv 2212.10763; github.com/DREAMS-lab/shakebot_motion, MIT licence): a 3D-printed model of a rock under single cosine
pulses.

.. note:: A run states PGA [g], PGV/PGA [s] and whether the rock overturned. The commanded ground motion is a(t) = PGA
   cos(2 pi F t) for one period, F = 1/(2 pi PGV/PGA); that of the table itself was not published. Mass, inertia and
   height of the centre are those of the model of the rock and are not fitted, nor is C. One critical angle is fitted
   for each orientation, with the other side three times as slender. Each threshold on PGA or PGV is fitted likewise. A
   fit is judged on runs that it has not seen: fitted on every other run, judged on the rest, and the reverse.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd

from rocking import Block, recorded_response
from rocking.body.block import STANDARD_GRAVITY
from rocking.response import Outcome

#: Files of runs, one orientation of the rock each.
FILES = ("exp0.csv", "exp270.csv", "PBR_0.csv", "PBR_90.csv")
#: Mass [kg], mean of both horizontal moments of inertia about the centre of mass [kg m2], and height of that [m].
MASS, INERTIA, CENTRE = 0.403494, 0.5 * (0.0005253 + 0.0006321), 0.063
#: Restitution, and critical angle of the stronger side divided by that of the weaker one [-].
RESTITUTION, STRONGER = 0.9, 3.0
#: Critical angles of the weaker side that are tried [rad].
ANGLES = np.geomspace(0.01, 0.35, 72)
#: Samples of a pulse, and quiet time after it, in periods.
SAMPLES, AFTER = 200, 6


def read_runs(path: Path) -> pd.DataFrame:
    """Return the runs of a file: `ratio` (PGV/PGA [s]), `pga` [g], `pgv` [m/s] and whether the rock `toppled`."""
    runs = pd.read_csv(path, skiprows=1, header=None, names=["time", "ratio", "pga", "status"])
    # "n" and ".N" occur, and one run without a status, "0".
    runs["status"] = runs["status"].astype(str).str.upper().str.extract(r"([YN])\s*$", expand=False)
    runs = runs.dropna()
    if runs.empty:
        raise SystemExit(f"{path}: expected rows of time, PGV/PGA [s], PGA [g] and Y or N, found none")
    pgv = runs["ratio"] * runs["pga"] * STANDARD_GRAVITY
    return runs.assign(toppled=runs["status"] == "Y", pgv=pgv)[["ratio", "pga", "pgv", "toppled"]]


def rocks(angle: np.ndarray) -> Block:
    """Return the rock with critical angles (m,) of its weaker side [rad]."""
    near, far = CENTRE * np.tan(angle), CENTRE * np.tan(np.minimum(STRONGER * angle, 1.2))
    gyration = np.sqrt(INERTIA / MASS)
    return Block.from_corners(near, far, CENTRE, gyration, restitution=RESTITUTION, log=False)


def predicted(runs: pd.DataFrame, angle: np.ndarray = ANGLES) -> np.ndarray:
    """Return whether the rock overturns in each run with each critical angle (r, m), in the worse of both senses."""
    body = rocks(angle)
    mirror = body.mirrored()
    found = []
    for ratio, pga in zip(runs["ratio"], runs["pga"], strict=True):
        period = 2.0 * np.pi * ratio
        time = np.linspace(0.0, 1.0, SAMPLES + 1)
        pulse = np.append(pga * STANDARD_GRAVITY * np.cos(2.0 * np.pi * time), np.zeros(AFTER * SAMPLES))
        outcomes = [recorded_response(one, pulse, period / SAMPLES).outcome for one in (body, mirror)]
        found.append(np.any([outcome >= Outcome.OVERTURNS for outcome in outcomes], axis=0))
    return np.array(found)


def thresholds(values: np.ndarray) -> np.ndarray:
    """Return the predictions (r, m) of every threshold between the values (r,) of a measure."""
    ordered = np.unique(values)
    between = np.concatenate([[-np.inf], 0.5 * (ordered[1:] + ordered[:-1]), [np.inf]])
    return values[:, np.newaxis] > between


def judged(answers: np.ndarray, toppled: np.ndarray) -> tuple[float, float]:
    """Return the share of runs that the best of m predictions gives correctly: on all runs, and on runs left out."""
    right = answers == toppled[:, np.newaxis]
    half = np.arange(toppled.size) % 2 == 0
    unseen = [right[~part, np.argmax(right[part].mean(axis=0))] for part in (half, ~half)]
    return float(right.mean(axis=0).max()), float(np.concatenate(unseen).mean())


def compared(folder: Path) -> pd.DataFrame:
    """Compare the shares of runs that the response and the best thresholds predict correctly, for each file."""
    rows = []
    for name in FILES:
        runs = read_runs(folder / name)
        toppled, response = runs["toppled"].to_numpy(), predicted(runs)
        angle = ANGLES[np.argmax((response == toppled[:, np.newaxis]).mean(axis=0))]
        row = {"file": name, "runs": len(runs), "toppled": int(toppled.sum()), "angle [rad]": float(angle)}
        for words, answers in (
            ("response", response),
            ("PGA", thresholds(runs["pga"].to_numpy())),
            ("PGV", thresholds(runs["pgv"].to_numpy())),
        ):
            row[f"{words}, all"], row[f"{words}, left out"] = judged(answers, toppled)
        rows.append(row)
    return pd.DataFrame(rows)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="folder with the files of the runs")
    print(compared(parser.parse_args().folder).round(3).to_string(index=False))


if __name__ == "__main__":
    main()
