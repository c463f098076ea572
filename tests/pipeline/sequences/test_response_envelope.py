"""The smallest main impulse that covers a share of the targets, where peaks are known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from rockpulse.models import Block, ImpulseSequence, Outcome
from rockpulse.sequences import response as response_envelope
from rockpulse.sequences.response import enveloping_main
from rockpulse.sequences.response_targets import ResponseTargets

BLOCKS = Block.from_parameters(np.linspace(1.0, 3.0, 10), np.linspace(0.1, 0.3, 10)[::-1], 0.9)
PEAKS = np.array([0.3, 0.1, 0.8, 0.5, 0.2, 0.7, np.inf, 0.02, 0.0, 0.4])
OUTCOMES = np.where(np.isinf(PEAKS), Outcome.OVERTURNS, np.where(PEAKS > 0.0, Outcome.ROCKS, Outcome.AT_REST))
TARGETS = ResponseTargets(BLOCKS, PEAKS, OUTCOMES)
ONE = ImpulseSequence(0.31, 0.0, 0.2, np.inf, main_count=1)


@pytest.mark.parametrize(("share", "covered"), [(1.0, 9), (0.84, 8), (0.5, 5), (5.0 / 9.0, 5), (0.56, 6), (0.1, 1)])
def test_of_one_impulse_the_factor_is_that_of_the_block_which_is_just_covered(share, covered):
    """Eq. 6: the peak x takes I/I_1c of sqrt(1 - (1 - x)^2), and overturning takes 1; the block at rest is silent."""
    taken = np.sqrt(1.0 - (1.0 - np.minimum(PEAKS, 1.0)) ** 2) * BLOCKS.critical_impulse / ONE.main
    expected = np.sort(np.delete(taken, 8))[covered - 1]
    factor, again = enveloping_main(TARGETS, ONE, share, threads=1)
    assert expected * (1.0 - 1e-9) <= factor <= expected * (1.0 + 1.01e-6)
    assert again is False


def covering(monkeypatch, inside):
    """The factor on ONE where a motion covers all targets at factors inside of a range, and none elsewhere."""
    seen = []

    def response(blocks, sequence, table_rows, threads):
        factors = np.asarray(sequence.main) / ONE.main
        seen.append(factors)
        peaks = np.where(inside(factors), np.inf, 0.0)
        return SimpleNamespace(peak_rotation_ratio=np.repeat(peaks[:, np.newaxis], blocks.shape[0], axis=1))

    monkeypatch.setattr(response_envelope, "sequence_response", response)
    return enveloping_main(TARGETS, ONE, 1.0), seen


def test_the_scan_goes_from_a_thousandth_of_the_least_to_four_times_the_largest_critical_impulse(monkeypatch):
    critical = np.delete(BLOCKS.critical_impulse, 8) / ONE.main  # of those that are not silent
    (factor, again), seen = covering(monkeypatch, lambda factors: factors > 0.0)
    assert (factor, again) == (pytest.approx(1e-3 * critical.min()), False)
    assert seen[0][-1] == pytest.approx(4.0 * critical.max())
    assert np.diff(np.log(seen[0])) == pytest.approx(np.log(seen[0][1] / seen[0][0]))
    assert len(seen) == 1  # nothing is left to refine
    last = seen[0][-1]
    (factor, _), _ = covering(monkeypatch, lambda factors: factors >= 0.9999 * last)
    assert factor == pytest.approx(0.9999 * last, rel=1.01e-6)


def test_larger_impulses_that_cover_less_are_told_and_the_first_edge_counts(monkeypatch):
    def bands(factors):
        return ((factors >= 0.7) & (factors < 0.8)) | (factors > 0.9)

    (factor, again), _ = covering(monkeypatch, bands)
    assert 0.7 <= factor <= 0.7 * (1.0 + 1.01e-6)
    assert again is True
