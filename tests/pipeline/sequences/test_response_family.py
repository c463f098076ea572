"""The family that a motion sets rocking: about the edge of overturning, chosen by parameters only."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from rocking.recorded import recorded_response
from rockpulse.errors import RecordRefused
from rockpulse.models import ImpulseSequence, Outcome, sequence_response
from rockpulse.record.record import Record
from rockpulse.sequences.response_targets import describe_family, motion_family, recorded_family


def motion(main, main_count=1, ratio=0.0):
    sequence = ImpulseSequence(main, ratio * main, 0.2, np.inf, main_count=main_count)
    return lambda blocks: sequence_response(blocks, sequence, table_rows=0, threads=1)


def shake(size, seconds=8.0):
    return Record(size * np.sin(2.0 * np.pi * np.arange(0.0, seconds, 0.01)), dt=0.01, id="shake")


def test_one_impulse_has_its_edge_where_the_critical_impulse_is():
    # Eq. 9: overturned where I > I_1c; elsewhere the peak is 1 - sqrt(1 - (I/I_1c)^2), at least 0.057 up to 3 I_1c.
    answer = motion(0.5)
    family = motion_family(answer)
    impulses = family.critical_impulse
    assert family.shape == (100,)
    # The edge is an I_1c of the pool, whose blocks of one restitution lie within 10 %.
    assert 0.8 * 0.5 <= impulses.min() < 0.8 * 0.55
    assert 2.5 * 0.5 < impulses.max() <= 3.0 * 0.55
    response = answer(family)
    assert np.array_equal(response.outcome == Outcome.OVERTURNS, impulses < 0.5)
    number = (response.outcome == Outcome.ROCKS) & (response.peak_rotation_ratio >= 0.05)
    assert np.count_nonzero(number) >= 75
    assert np.count_nonzero(response.outcome == Outcome.OVERTURNS) >= 5


def test_where_more_impulses_push_a_better_restitution_moves_the_edge_up():
    family = motion_family(motion(0.2, main_count=5, ratio=0.3)).critical_impulse.reshape(4, 25)
    assert np.all(np.diff(family.min(axis=1)) < 0.0)


def radical_inverse(index, base):
    """The digits of a number mirrored at the point: the sequence of van der Corput, of which that of Halton is made."""
    share, place = 0.0, 1.0
    while index:
        index, digit = divmod(index, base)
        place /= base
        share += digit * place
    return share


def housner(alpha):
    return 1.0 - 1.5 * np.sin(alpha) ** 2


@pytest.mark.parametrize(("overturning", "resting"), [(0.5, 9.0), (0.2, 0.25), (9.0, 0.2), (0.0, 0.3)])
def test_the_blocks_are_the_first_points_about_the_edge_of_each_restitution(overturning, resting):
    """Overturned are those of an impulse below one value times C, at rest those of an angle above another one."""
    asked = []

    def answer(blocks):
        asked.append(blocks)
        restitution = blocks.restitution / housner(blocks.alpha_c)
        outcome = np.where(blocks.critical_impulse < overturning * restitution, Outcome.OVERTURNS, Outcome.ROCKS)
        outcome[blocks.alpha_c > resting] = Outcome.AT_REST
        return SimpleNamespace(outcome=outcome)

    family = motion_family(answer)
    (pool,) = asked
    axes = np.geomspace(1.0, 5.0, 10), np.geomspace(0.08, 0.32, 10), np.array([1.0, 0.8, 0.6, 0.4])
    p, alpha, factor = (axis.ravel() for axis in np.meshgrid(*axes, indexing="ij"))
    assert (pool.p, pool.alpha_c) == (pytest.approx(p), pytest.approx(alpha))
    assert pool.restitution == pytest.approx(factor * housner(alpha))
    moved = pool.alpha_c <= resting
    stockiest = pool.alpha_c[moved].max()
    expected = []
    for restitution in axes[2]:
        here = np.sort(pool.critical_impulse[moved & np.isclose(factor, restitution)])
        fallen = np.count_nonzero(here < overturning * restitution)
        edge = here[fallen] if fallen < here.size else here[-1]
        own = []
        for index in range(8192):
            p, alpha = 5.0 ** radical_inverse(index, 2), 0.08 * (stockiest / 0.08) ** radical_inverse(index, 3)
            if 0.8 * edge <= 9.80665 * alpha / (p * np.cos(alpha)) <= 3.0 * edge:
                own.append((p, alpha, restitution * housner(alpha)))
            if len(own) == 25:
                break
        expected += own
    found = np.column_stack([family.p, family.alpha_c, family.restitution])
    assert found.shape == (len(expected), 3)
    assert found == pytest.approx(np.array(expected))


@pytest.mark.parametrize("main", [1e-3, 0.05, 0.3, 1.0, 30.0])
def test_from_the_weakest_to_the_strongest_motion_the_blocks_are_of_engineering_size_and_all_different(main):
    family = motion_family(motion(main, main_count=4))
    assert np.unique([family.p, family.alpha_c, family.restitution], axis=1).shape == (3, 100)
    assert np.all((family.p >= 1.0) & (family.p <= 5.0))
    assert np.all((family.slenderness >= 3.0) & (family.slenderness <= 12.5))
    assert family.warnings == ()


def test_the_choice_looks_at_outcomes_of_the_pool_only():
    answer = motion(0.2, main_count=3, ratio=0.4)
    blocks = motion_family(answer)
    other = motion_family(lambda pool: replace(answer(pool), peak_rotation_ratio=np.full(pool.shape, 0.3)))
    assert np.array_equal(blocks.p, other.p)
    assert np.array_equal(blocks.alpha_c, other.alpha_c)


def test_a_record_moves_every_block_of_its_family():
    record = shake(0.15 * 9.81)
    family = recorded_family(record, threads=1)
    response = recorded_response(family, record.acceleration, record.dt, threads=1)
    assert np.tan(family.alpha_c.max()) < 0.15
    assert not np.any(response.outcome == Outcome.AT_REST)
    said = describe_family(family)
    assert said.startswith("100 blocks chosen about the edge of overturning of this motion: I_1c 0.")
    low, high = family.slenderness.min(), family.slenderness.max()
    assert f", slenderness {low:.3g} to {high:.3g}, C {family.restitution.min():.3g} to " in said


def test_a_record_that_moves_no_block_is_refused_by_name():
    with pytest.raises(RecordRefused, match=r"shake: the motion moves none of 400 blocks of slenderness 3.02 to 12.5"):
        recorded_family(shake(0.5), threads=1)
