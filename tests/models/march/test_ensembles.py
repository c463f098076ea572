"""What holds for ensembles of ground motions and for no single one (VALIDATION V19, V20).

A share P of N motions has the standard error sqrt(P (1 - P)/N), at most 0.046 for the 120 motions here. All blocks
stand on the same motions, so two shares are compared motion by motion: the standard error of their difference is that
of the mean of the N differences, which is smaller. "Rises" means by more than three of these.
"""

import numpy as np
import pytest

from rocking import Block, Outcome, recorded_response
from synthetic import synthetic_motion

MOTIONS = 120
DT = 0.01
GRAVITY = 9.80665

#: Levels: PGA [g], slenderness, R [m].
PGA = (0.2, 0.3, 0.45, 0.7)
SLENDERNESS = (3.0, 4.0, 6.0, 8.0)
RADII = (0.5, 1.0, 2.0, 4.0)
AXES = {"intensity": 1, "slenderness": 2, "size": 3}

#: Standard errors that a difference must exceed.
ERRORS = 3.0


@pytest.fixture(scope="module")
def motions():
    return [synthetic_motion(seed, duration=30.0, dt=DT, pga=GRAVITY) for seed in range(MOTIONS)]


BOTH = ["nonlinear", pytest.param("linear", marks=pytest.mark.sweep)]


@pytest.fixture(scope="module", params=BOTH)
def fallen(request, motions):
    """(motions, PGA, slenderness, R): whether the block overturns, with Housner's restitution."""
    slenderness, radius = np.meshgrid(SLENDERNESS, RADII, indexing="ij")
    alpha = np.arctan(1.0 / slenderness).ravel()
    block = Block(
        half_width=radius.ravel() * np.sin(alpha),
        half_height=radius.ravel() * np.cos(alpha),
        restitution="housner",
        gravity=GRAVITY,
    )
    outcome = np.array([recorded_response(block, motion, DT, request.param, scale=PGA).outcome for motion in motions])
    assert set(np.unique(outcome)) == {Outcome.AT_REST, Outcome.ROCKS, Outcome.OVERTURNS}
    return (outcome == Outcome.OVERTURNS).reshape(MOTIONS, len(PGA), len(SLENDERNESS), len(RADII))


def mean_and_error(differences):
    """Mean over the motions, the first axis, and its standard error."""
    return np.mean(differences, axis=0), np.std(differences, axis=0, ddof=1) / np.sqrt(len(differences))


@pytest.mark.parametrize(("what", "sign"), [("intensity", 1), ("slenderness", 1), ("size", -1)])
def test_probability_of_overturning_rises_with_intensity_and_slenderness_and_falls_with_size(
    fallen, what, sign
):  # VALIDATION V19 (Yim, Chopra & Penzien 1980)
    steps = sign * np.diff(fallen.astype(float), axis=AXES[what])
    others = tuple(axis for axis in AXES.values() if axis != AXES[what])
    mean, error = mean_and_error(steps.mean(axis=others))
    assert mean.shape == (3,)
    assert np.all(mean > ERRORS * error), f"{what}: {mean} +- {error}"
    # No single pair of neighbouring blocks or intensities says the contrary.
    mean, error = mean_and_error(steps)
    assert np.all(mean >= -ERRORS * error)


@pytest.mark.parametrize(("what", "sign"), [("intensity", 1), ("slenderness", 1), ("size", -1)])
def test_single_record_may_say_the_contrary(fallen, what, sign):  # VALIDATION V19: never per record
    steps = sign * np.diff(fallen.astype(int), axis=AXES[what])
    contrary = np.any(steps < 0, axis=tuple(AXES.values()))
    assert 0 < np.count_nonzero(contrary) < MOTIONS


#: Measured C over Housner's (VALIDATION V20, ElGawady): rubber, concrete from and to; and Housner's own.
RUBBER, CONCRETE_LOW, CONCRETE_HIGH, HOUSNER = 0.67, 0.95, 0.97, 1.0


def column(*ratios):
    """A column of 0.5 m x 3 m, one lane for each multiple of Housner's restitution."""
    housner = Block(0.5, 3.0, restitution="housner", gravity=GRAVITY).restitution
    return Block(0.5, 3.0, restitution=np.array(ratios) * housner, gravity=GRAVITY)


@pytest.fixture(scope="module", params=BOTH)
def peaks(request, motions):
    """(motions, C) theta_max/alpha_c under 0.3 g: rubber, concrete twice, Housner's."""
    block = column(RUBBER, CONCRETE_LOW, CONCRETE_HIGH, HOUSNER)
    return np.array(
        [recorded_response(block, motion, DT, request.param, scale=0.3).peak_rotation_ratio for motion in motions]
    )


def test_lower_restitution_overturns_less_often(peaks):  # VALIDATION V20
    over = np.isinf(peaks).astype(float)
    mean, error = mean_and_error(over[:, 1:] - over[:, :1])
    assert np.all(mean > ERRORS * error), f"{mean} +- {error}"


def test_lower_restitution_lowers_the_peak_of_blocks_that_survive(peaks):  # VALIDATION V20
    survive = np.all(np.isfinite(peaks) & (peaks > 0.0), axis=1)
    assert np.count_nonzero(survive) >= 40
    logs = np.log(peaks[survive])
    mean, error = mean_and_error(logs[:, 1:] - logs[:, :1])
    assert np.all(mean > ERRORS * error), f"{mean} +- {error}"


def test_within_the_range_of_one_material_a_single_record_may_go_either_way(peaks):  # VALIDATION V20: a range
    low, high = peaks[:, 1], peaks[:, 2]
    assert np.any(high > 1.2 * low)
    assert np.any(low > 1.2 * high)
