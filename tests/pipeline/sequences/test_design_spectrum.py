"""The design spectrum and the sequences that stand for it."""

from dataclasses import replace

import numpy as np
import pytest

from rocking.search.capacity import sequence_critical_scale
from rockpulse.models import Block, Outcome, critical_impulse, sequence_response
from rockpulse.sequences.design_spectrum import DesignSpectrum, at_blocks, critical_main

P, C = np.geomspace(0.5, 8.0, 7), np.linspace(0.75, 1.0, 4)
DESIGN = DesignSpectrum(
    p=P,
    restitution=C,
    spectrum=0.2 * P[:, np.newaxis] ** 0.5 * np.exp(2.0 * (C - 0.9)),
    ratio=0.35,
    interval=0.15,
    main_count=5,
)
GENERATOR = np.random.default_rng(4)
BODIES = Block.from_parameters(
    p=GENERATOR.uniform(0.5, 8.0, 100),
    alpha=np.arctan(1.0 / GENERATOR.uniform(3.5, 15.0, 100)),
    restitution=GENERATOR.uniform(0.75, 1.0, 100),
    log=False,
)
SPEED = BODIES.gravity * np.tan(BODIES.alpha_c) / BODIES.p


def test_a_power_law_is_read_between_the_nodes_without_error():
    expected = 0.2 * BODIES.p**0.5 * np.exp(2.0 * (BODIES.restitution - 0.9))
    np.testing.assert_allclose(DESIGN.effective_impulse(BODIES), expected, rtol=1e-12)
    np.testing.assert_allclose(DESIGN.factor(BODIES), SPEED / expected, rtol=1e-12)


def test_one_body_without_lanes_is_one_of_them():
    one = Block.from_parameters(p=2.0, alpha=0.1, restitution=0.9, log=False)
    for found in (DESIGN.effective_impulse(one), DESIGN.factor(one), DESIGN.sequence(one).main):
        assert found.shape == (1,)
    assert DESIGN.effective_impulse(one)[0] == pytest.approx(0.2 * 2.0**0.5)


@pytest.mark.sweep
@pytest.mark.parametrize("shape", [(0.35, 0.15, 5), (0.2, 0.5, 3), (0.3, 0.1, 12), (0.0, 0.1, 4)])
@pytest.mark.parametrize("spacing", ["end", "continuous"])
def test_a_body_overturns_under_its_sequence_where_the_spectrum_exceeds_its_speed(shape, spacing):
    ratio, interval, count = shape
    design = replace(DESIGN, ratio=ratio, interval=interval, main_count=count, spacing=spacing)
    factor, sequence = design.factor(BODIES), design.sequence(BODIES)
    assert 20 < np.count_nonzero(factor <= 1.0) < 80
    outcome = sequence_response(BODIES, sequence, table_rows=0, paired=True).outcome
    clear = np.abs(factor - 1.0) > 0.02
    np.testing.assert_array_equal((outcome == Outcome.OVERTURNS)[clear], (factor <= 1.0)[clear])
    found = sequence_critical_scale(BODIES, sequence, factor_max=1e4, paired=True).safety_factor
    np.testing.assert_allclose(found, factor, rtol=0.02)
    # The same by the march within 2 % of the edge, and at once below it.
    for shift, expected in ((1.02, Outcome.OVERTURNS), (1.0 - 1e-6, Outcome.ROCKS)):
        at = sequence_response(BODIES, sequence.scaled(shift * factor), table_rows=0, paired=True)
        assert np.all(at.outcome == expected)


def test_the_closed_form_is_near_the_march_and_that_of_the_paper_without_secondary_impulses():
    for count in (1, 2, 6):
        np.testing.assert_allclose(critical_main(BODIES, 0.0, 0.1, count), critical_impulse(BODIES, count), rtol=1e-12)
    found = DESIGN.sequence(BODIES).main * DESIGN.factor(BODIES)
    np.testing.assert_allclose(found, critical_main(BODIES, 0.35, 0.15, 5), rtol=0.02)


def test_the_effective_impulse_of_the_continuous_sequence_is_the_spectrum_in_the_slender_limit():
    sequence = replace(DESIGN, spacing="continuous").sequence(BODIES)
    effect = sequence.effective_impulse(BODIES.restitution)
    alpha = BODIES.alpha_c
    np.testing.assert_allclose(effect / DESIGN.effective_impulse(BODIES), alpha / np.sin(alpha), rtol=1e-9)
    assert (sequence.main_count == 5).all()
    np.testing.assert_allclose(sequence.secondary / sequence.main, 0.35)


@pytest.mark.parametrize(
    ("p", "slenderness", "restitution", "inside"),
    [
        (0.5, 3.5, 0.75, True),
        (8.0, 20.0, 1.0, True),
        (0.49, 5.0, 0.9, False),
        (8.1, 5.0, 0.9, False),
        (2.0, 3.4, 0.9, False),
        (2.0, 5.0, 0.74, False),
    ],
)
def test_what_it_covers(p, slenderness, restitution, inside):
    block = Block.from_parameters(p=p, alpha=np.arctan(1.0 / slenderness), restitution=restitution, log=False)
    assert DESIGN.covers(block).tolist() == [inside]
    if not inside:
        with pytest.raises(ValueError, match=r"not 1 of 1 blocks, the first at index 0"):
            DESIGN.sequence(block)


def test_the_first_block_that_is_not_covered_is_named():
    blocks = Block.from_parameters(p=[2.0, 9.0, 2.0, 0.1], alpha=0.1, restitution=0.9, log=False)
    assert DESIGN.covers(blocks).tolist() == [True, False, True, False]
    with pytest.raises(ValueError, match=r"C from 0.75 to 1, but not 2 of 4 blocks, .* at index 1"):
        DESIGN.factor(blocks)


def test_values_are_linear_in_ln_p_and_in_restitution_and_end_with_the_axes():
    blocks = Block.from_parameters(
        p=[1.0, 2.0, 4.0, 0.9, 9.0], alpha=0.1, restitution=[0.8, 0.85, 0.9, 0.7, 1.0], log=False
    )
    p, restitution = np.array([1.0, 4.0]), np.array([0.8, 0.9])
    values = np.array([[[1.0, 10.0], [2.0, 30.0]], [[5.0, 50.0], [8.0, 90.0]]])  # (a, c, k)
    expected = [[1.0, 10.0], [4.0, 45.0], [8.0, 90.0], [1.0, 10.0], [8.0, 90.0]]
    assert at_blocks(blocks, p, restitution, values) == pytest.approx(np.array(expected))
    assert at_blocks(blocks, p, restitution, values[..., 0]) == pytest.approx(np.array(expected)[:, 0])
    # An axis of one value stands for all.
    one_p = at_blocks(blocks, p[:1], restitution, values[:1])
    assert one_p == pytest.approx(np.array([[1.0, 10.0], [1.5, 20.0], [2.0, 30.0], [1.0, 10.0], [2.0, 30.0]]))
    one_c = at_blocks(blocks, p, restitution[:1], values[:, :1, 0])
    assert one_c == pytest.approx([1.0, 3.0, 5.0, 1.0, 5.0])
    assert at_blocks(blocks, p[:1], restitution[:1], values[:1, :1]).tolist() == [[1.0, 10.0]] * 5
