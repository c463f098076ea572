"""Where the lanes of a body lie and what each stands for, by verdicts that are known."""

import numpy as np
import pytest
from scipy.special import ndtri

from rocking import Block, Outcome, Uncertainty
from rocking.spectrum import body_lanes as lane_march
from rocking.spectrum.body_lanes import LaneMarch, probability_lanes

PUSH = np.array([0.0, 1.0, 0.5, 0.0])
BODIES = Block(half_width=[0.3, 0.4], half_height=[1.2, 1.6], restitution=0.9)
#: Factor and geometry as by default; C from 0.7 to 0.9 for the nominal 0.9 of the bodies.
KNOWN = Uncertainty(restitution=(0.7 / 0.9, 1.0))
#: ln of the factor that lifts the body that lost the most of its angle: 9.80665 tan(alpha exp(-0.2)) over 1 m/s2.
UPLIFT = np.log(9.80665 * np.tan(np.arctan(0.25) * np.exp(-0.2)))


class Known(LaneMarch):
    """Marches whose verdicts are known: a factor overturns where its logarithm lies in one of the `bands`."""

    bands = ()
    free_flight = np.inf

    def _outcome(self, lanes, factor):
        logs = np.log(factor)
        found = np.where(np.any([(logs > low) & (logs < high) for low, high in self.bands], axis=0), 2, 1)
        return np.where(logs > self.free_flight, int(Outcome.UNRESOLVED), found)


def march_of(*bands, block=BODIES, known=KNOWN):
    march = Known(block, PUSH, 0.01, None, known, 3, 1)
    march.bands = bands
    return march


def stretches(march, body):
    """Ends of the grid of every part of a body, and its number of lanes."""
    return [
        (*part.grid[row, [0, -1]].tolist(), part.log_factor.shape[1])
        for part in march.parts
        for row in np.flatnonzero(part.body == body)
    ]


def approx(*rows):
    return [pytest.approx(row, abs=1e-12) for row in rows]


def test_lanes_lie_about_the_guess_and_where_verdicts_differ():
    """0.8 of ln f to both sides of it, and once more, twelve times as many."""
    march = march_of((2.3, 9.0))
    lanes = probability_lanes(march, 5.0, np.exp([2.0, 2.2]))
    assert stretches(march, 0) == approx((1.2, 2.8, 64), (1.2, 2.8, 768))
    assert stretches(march, 1) == approx((1.4, 3.0, 64), (1.4, 3.0, 768))
    assert [(one.bottom, one.top, one.open) for one in lanes] == approx((1.2, 2.8, False), (1.4, 3.0, False))
    assert lanes[0].over.tolist() == (lanes[0].log_factor > 2.3).tolist()


def test_the_density_of_the_second_part_is_the_deviation_of_the_verdicts_nearby():
    march = march_of((2.3, 9.0))
    lanes, _ = probability_lanes(march, 5.0, np.exp([2.0, 2.2]))
    first, second = march.parts
    logs, grid, density = first.log_factor[0], second.grid[0], second.density[0]
    assert grid == pytest.approx(np.linspace(1.2, 2.8, 201))
    share = []
    for place in grid:
        near = [np.exp(-0.5 * ((one - place) / 0.12) ** 2) for one in logs]
        share.append(sum(one for one, log in zip(near, logs, strict=True) if log > 2.3) / sum(near))
    wanted = np.sqrt(np.array(share) * (1.0 - np.array(share))) + 0.1
    assert density / density[0] == pytest.approx(wanted / wanted[0], rel=1e-9)
    assert np.sum(0.5 * (density[1:] + density[:-1])) * (grid[1] - grid[0]) == pytest.approx(768.0)
    # The lanes follow it: 24 Sobol sets of 32, each with a lane in every 32nd of them.
    below = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]))) * (grid[1] - grid[0])
    assert (
        np.sort(np.floor(np.interp(second.log_factor[0], grid, below) / 24.0)).tolist()
        == np.repeat(np.arange(32.0), 24).tolist()
    )
    # The weight of a lane is 1 over the density of both parts at its place.
    at = np.concatenate([logs, second.log_factor[0]])
    assert lanes.log_factor.tolist() == at.tolist()
    assert lanes.weight == pytest.approx(1.0 / (64 / 1.6 + np.interp(at, grid, density)))


def test_lanes_are_added_downwards_while_the_lowest_ones_overturn():
    """0.8 of ln f each, down to uplift; the other body has no need of them."""
    march = march_of((1.05, 9.0))
    lanes = probability_lanes(march, 6.0, np.exp([3.0, 1.6]))
    down = (2.2, 3.8, 64), (1.4, 2.2, 32), (UPLIFT, 1.4, 32), (UPLIFT, 3.8, 768)
    assert UPLIFT > 0.6
    assert stretches(march, 0) == approx(*down)
    assert stretches(march, 1) == approx((0.8, 2.4, 64), (0.8, 2.4, 768))
    assert (lanes[0].bottom, lanes[0].top) == pytest.approx((UPLIFT, 3.8))
    # The weight of a lane is 1 over the summed density of the parts that contain it.
    *_, (last, row) = [(part, row) for part in march.parts for row in np.flatnonzero(part.body == 0)]
    at = lanes[0].log_factor
    density = np.interp(at, last.grid[row], last.density[row])
    density += sum(number / (high - low) * ((at >= low) & (at <= high)) for low, high, number in down[:3])
    assert lanes[0].weight == pytest.approx(1.0 / density)
    # A part of even density stands for its length over its lanes, 64 over 1.6 as 32 over 0.8.
    assert [part.density[0].tolist() for part in march.parts[:2]] == [pytest.approx([40.0, 40.0])] * 2


def test_lanes_are_added_upwards_while_the_highest_ones_stand():
    """Up to the largest factor, where those that stand leave open what comes above it."""
    march = march_of((4.3, 9.0))
    lanes = probability_lanes(march, 4.1, np.exp([2.0, 2.6]))
    assert stretches(march, 0) == approx((1.2, 2.8, 64), (2.8, 3.6, 32), (3.6, 4.1, 32))
    assert stretches(march, 1) == approx((1.8, 3.4, 64), (3.4, 4.1, 32))
    assert [one.open for one in lanes] == [True, True]
    march = march_of((3.5, 9.0))
    lanes = probability_lanes(march, 4.1, np.exp([2.0, 4.1]))
    assert stretches(march, 0) == approx((1.2, 2.8, 64), (2.8, 3.6, 32), (3.6, 4.1, 32), (1.2, 4.1, 768))
    # The first part of the other one has its whole length below the largest factor.
    assert stretches(march, 1) == approx((2.5, 4.1, 64), (2.5, 4.1, 768))
    assert [one.open for one in lanes] == [False, False]


def test_a_guess_is_not_looked_for_below_uplift_or_above_the_largest_factor():
    march = march_of((1.5, 9.0))
    probability_lanes(march, 3.0, np.array([1e-3, 1e6]))
    assert stretches(march, 0)[0] == pytest.approx((UPLIFT, UPLIFT + 1.6, 64))
    assert stretches(march, 1)[0] == pytest.approx((1.4, 3.0, 64))
    # Where there is less between them than the length of the first part, it is that.
    march = march_of((1.5, 9.0))
    probability_lanes(march, UPLIFT + 1.0, np.array([3.0, 3.0]))
    assert stretches(march, 0)[0] == pytest.approx((UPLIFT, UPLIFT + 1.0, 64))


def test_without_a_guess_lanes_lie_where_the_build_up_is_what_overturns(monkeypatch):
    """At 2.5 times what overturns a body at rest; as high as can be where the ground has no build-up."""
    told = type("Told", (), {"build_up": np.array([0.5, 0.0])})
    monkeypatch.setattr("rocking.spectrum.body_lanes.ground_demand", lambda block, ground, dt: told)
    march = march_of((2.0, 9.0))
    probability_lanes(march, 4.0)
    assert stretches(march, 0)[0] == pytest.approx((np.log(5.0) - 0.8, np.log(5.0) + 0.8, 64))
    assert stretches(march, 1)[0] == pytest.approx((2.4, 4.0, 64))


def test_bodies_that_no_draw_lifts_have_no_lanes():
    bodies = Block(half_width=[0.3, 0.9], half_height=[1.2, 1.2], restitution=0.9)
    march = march_of((1.2, 9.0), block=bodies)
    lanes = probability_lanes(march, 1.5)
    assert lanes[1] is None
    assert lanes[0].log_factor.size > 0
    march = march_of((1.2, 9.0))
    assert probability_lanes(march, UPLIFT - 1e-9) == [None, None]
    assert march.parts == []


def test_every_part_has_draws_of_its_own(monkeypatch):
    """A body that overturns in its lowest lanes and stands in its highest ones is marched to both sides at a time."""
    drawn, varied = [], Block.varied

    def record(self, loss, restitution):
        if np.size(loss) > 2:
            drawn.append((np.array(loss), np.array(restitution)))
        return varied(self, loss, restitution)

    monkeypatch.setattr(Block, "varied", record)
    march = march_of((-9.0, 4.0), block=BODIES.take(np.array([1])))
    probability_lanes(march, 7.0, np.exp([3.5]))
    assert [one.size for one, _ in drawn] == [64, *[32] * 7, 768]
    first = [tuple(restitution[:32]) for _, restitution in drawn]
    assert len(set(first)) == len(first)
    for loss, restitution in drawn:
        # Uniform from 0.7 to 0.9, and half-normal of 0.05 up to four deviations: the quartiles of 32 lanes or more.
        assert np.quantile(restitution, [0.0, 0.25, 0.5, 1.0]) == pytest.approx([0.7, 0.75, 0.8, 0.9], abs=0.012)
        assert np.quantile(loss, [0.25, 0.5, 0.75]) == pytest.approx(0.05 * ndtri([0.625, 0.75, 0.875]), abs=0.006)
        assert 0.0 <= np.min(loss) <= np.max(loss) <= 0.2


def test_a_body_without_loss_is_drawn_as_one_that_loses_a_little():
    """C = 1 as 0.999, whether all of its range lies there or its upper end alone."""
    for least in (1.0, 0.99):
        known = Uncertainty(restitution=(least / 0.9, 1.0 / 0.9))
        march = march_of((2.3, 9.0), known=known, block=BODIES.take(np.array([0])))
        seen = []
        march._outcome = lambda lanes, factor, seen=seen: seen.extend(lanes.restitution) or np.ones(factor.size, int)
        march.evenly(np.array([0]), np.array([1.0]), np.array([2.0]), 32, 0)
        assert max(seen) == pytest.approx(0.999, abs=0.01 * 0.05)
        assert min(seen) == pytest.approx(min(least, 0.999), abs=0.01 * 0.05)
        assert max(seen) <= 0.999


def test_what_flies_overturns_and_is_reported():
    march = march_of((2.0, 2.5))
    march.free_flight = 2.9
    march.evenly(np.array([1]), np.array([1.5]), np.array([3.1]), 64, 0)
    lanes = march.lanes(1, standing=True)
    assert lanes.over.tolist() == [2.0 < one < 2.5 or one > 2.9 for one in lanes.log_factor]
    assert lanes.unresolved.tolist() == [one > 2.9 for one in lanes.log_factor]
    assert lanes.unresolved.any()
    assert lanes.open


@pytest.mark.parametrize(("ground", "up"), [(PUSH, None), (0.0 * PUSH, None), (PUSH, 0.1 * PUSH)])
def test_only_bodies_of_the_measured_range_without_a_vertical_end_their_march_early(monkeypatch, ground, up):
    calls = []

    def respond(block, acceleration, dt, **options):
        calls.append((block.p.tolist(), options["verdict"] is not None, options["block_scale"].tolist()))
        return type("Told", (), {"outcome": np.where(block.p > 2.0, 2, 1)})

    monkeypatch.setattr(lane_march, "recorded_response", respond)
    monkeypatch.setattr(lane_march, "within_measured_range", lambda block, dt: block.p > 2.0)
    block = Block.from_parameters([1.0, 3.0, 1.5, 4.0], 0.2, 0.9, log=False)
    march = LaneMarch(block, ground, 0.01, up, KNOWN, 1, 1)
    assert march._outcome(block, np.array([0.5, 0.6, 0.7, 0.8])).tolist() == [1, 2, 1, 2]
    p = block.p.tolist()
    if up is None and ground.any():
        assert calls == [([p[1], p[3]], True, [0.6, 0.8]), ([p[0], p[2]], False, [0.5, 0.7])]
    else:
        assert calls == [(p, False, [0.5, 0.6, 0.7, 0.8])]
