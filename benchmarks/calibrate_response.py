"""`calibrate_response` of one sample record on the 100 blocks chosen for it, and a search a user would write.

    python benchmarks/calibrate_response.py [--record CICLC.v1] [--runs 3]

Prints the seconds of one core, the candidates, and the misfit and ln L reached by ``calibrate_response`` (choice of
blocks, sequence, profiles, intervals and remarks) and by scipy's ``differential_evolution`` with its defaults, which
asks ``models.sequence_response`` for one candidate at a time and gives the best sequence only; median of the runs.
"""

import argparse
import logging
import time
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rockpulse.readers.folders import read_all
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record
from rockpulse.sequences.response import ResponseCalibration, calibrate_response
from rockpulse.sequences.response_search import log_likelihood, search_space

SAMPLES = Path(__file__).parents[1] / "data" / "samples" / "records"

#: What the issue asks for [s].
LIMIT_S = 20.0


def one_at_a_time(fit: ResponseCalibration) -> tuple[float, float, int]:
    """Misfit, ln L and number of candidates of the plain search, on the targets and in the limits of a calibration."""
    targets, start = fit.targets, fit.start
    space = search_space(targets, start, fit.sequence.spacing)
    assert start is not None

    def sequence(values: np.ndarray) -> ImpulseSequence:
        main = float(np.exp(values[0]))
        return ImpulseSequence(
            main=main,
            secondary=min(values[1] * main, main),
            interval=float(np.exp(values[2])),
            duration=start.duration,
            main_count=round(values[3]),
            spacing=fit.sequence.spacing,
        )

    def peaks(values: np.ndarray) -> np.ndarray:
        response = sequence_response(targets.blocks, sequence(values), table_rows=0, threads=1)
        return np.asarray(response.peak_rotation_ratio)[np.newaxis]

    critical = np.asarray(targets.blocks.critical_impulse)
    limits = [tuple(np.log([0.02 * critical.min(), 2.0 * critical.max()]))]
    limits += list(zip(space.low[1:], space.high[1:], strict=True))
    found = differential_evolution(
        lambda values: -log_likelihood(peaks(values), targets)[0][0],
        limits,
        integrality=[False, False, False, True],
        polish=False,
        rng=0,
    )
    return float(targets.misfit(peaks(found.x))[0]), -float(found.fun), int(found.nfev)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--record", default="CICLC.v1", help="file among the samples; its first horizontal channel")
    parser.add_argument("--runs", type=int, default=3, help="runs of which the median is taken")
    options = parser.parse_args()
    logging.disable(logging.WARNING)
    record = strong_channel(SAMPLES / options.record)
    calibrate_response(record, threads=1)  # compiles, or reads the cache
    ours, theirs = [], []
    for _ in range(options.runs):
        start = time.process_time()
        fit = calibrate_response(record, threads=1)
        ours.append(time.process_time() - start)
        start = time.process_time()
        misfit, likelihood, candidates = one_at_a_time(fit)
        theirs.append(time.process_time() - start)
    reached = log_likelihood(fit.peaks[np.newaxis], fit.targets)[0][0]
    print(f"{record.id}, {fit.peaks.size} blocks, one thread, median of {options.runs} runs")
    print(
        f"  calibrate_response:     {np.median(ours):6.2f} s (limit {LIMIT_S:g} s), {fit.candidates} candidates, "
        f"misfit {fit.misfit:.3f}, ln L {reached:.2f}; with profiles and intervals"
    )
    print(
        f"  one candidate at a time {np.median(theirs):6.2f} s, {candidates} candidates, "
        f"misfit {misfit:.3f}, ln L {likelihood:.2f}; best sequence only"
    )
    print(f"  statistical estimate:   misfit {fit.start_misfit:.3f}")
    ratio = np.median(np.array(theirs) / np.array(ours))
    each = np.median(np.array(theirs)) / candidates / (np.median(np.array(ours)) / fit.candidates)
    print(f"  ratio of the times {ratio:.2f}, for each candidate {each:.2f}")


def strong_channel(path: Path) -> Record:
    """The first horizontal channel of a file, conditioned."""
    found, _ = read_all([path])
    return condition(next(record for record in found if record.orientation not in ("vertical", "structural")))


if __name__ == "__main__":
    main()
