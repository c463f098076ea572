"""The formulas of the manual, evaluated as they are printed there, against what rockpulse computes.

Nothing here calls the code that is judged to get the expected side: it is the page, typed again.
"""

import math

import numpy as np
import pytest

import rockpulse as rp
from rockpulse import models
from rockpulse.record.components import Pair

G = 9.81


def block_a(restitution=0.9):
    return models.Block(1.0, 3.872984, restitution=restitution, gravity=G)


def impulse_train(velocity, size, count, step, first):
    """x(T) and speed after natural motion by Eq. (2) with impulses -size, +size, ... from `first` on (units 1/p)."""
    x, speed, now = 0.0, velocity, 0.0
    for k in range(count):
        wait = first + k * step - now
        away, speed_before = x - 1.0, speed
        x = 1.0 + away * math.cosh(wait) + speed_before * math.sinh(wait)
        speed = away * math.sinh(wait) + speed_before * math.cosh(wait) - (-1) ** k * size
        now += wait
    return x, speed, now


def test_constants_of_a_block():
    """theory/motion: R, alpha_c, p, C; theory/impulses: the gain by M I a/I_0 (Eqs. 3, 4) and I_1c."""
    a, b = 1.936492, 0.5
    block = models.Block(half_width=b, half_height=a, gravity=G)
    radius = math.hypot(a, b)
    inertia_over_mass = 4.0 * (a * a + b * b) / 3.0
    assert block.alpha_c == pytest.approx(math.atan2(b, a))
    assert block.p == pytest.approx(math.sqrt(G * radius / inertia_over_mass))
    assert block.restitution == pytest.approx(1.0 - 1.5 * math.sin(math.atan2(b, a)) ** 2)
    gain = a / inertia_over_mass
    acceleration = 0.75 * b / (a * a + b * b) * G
    assert gain == pytest.approx(a / b * acceleration / G)
    assert gain == pytest.approx(block.p**2 * math.cos(block.alpha_c) / G)
    assert block.critical_impulse == pytest.approx(block.p * block.alpha_c / gain)
    nonlinear = 2.0 * G * math.sin(block.alpha_c / 2.0) / (block.p * math.cos(block.alpha_c))
    assert nonlinear / block.critical_impulse == pytest.approx(0.997, abs=5e-4)


@pytest.mark.parametrize("gain", ["paper", "linear", "exact", "tangent"])
def test_gains_of_an_impulse_and_their_sign(gain):
    block, impulse = block_a(), 0.01
    alpha, p = block.alpha_c, block.p
    factor = {
        "paper": p**2 * math.cos(alpha) / G,
        "linear": p**2 / G,
        "exact": p**2 * math.cos(alpha) / G,
        "tangent": p**2 * alpha / (G * math.tan(alpha)),
    }[gain]
    response = models.impulsive_response(block, [0.0], [impulse], 0.01, gain=gain, history_dt=1e-3)
    assert response.velocity[0] == pytest.approx(-factor * impulse)  # an impulse to the right turns it to the left
    assert response.rotation[1] < 0.0


def test_main_sequence_and_the_erratum():
    restitution, main = 0.9, 0.11
    block = block_a(restitution)
    table = models.resonance(block, main * block.critical_impulse, 10).half_cycles
    speed = 0.0
    for i in range(1, 11):
        speed = restitution * speed + main
        printed = 1.0 + sum(restitution**j for j in range(1, i)) - restitution ** (i - 1)
        assert table.start_velocity[i - 1] == pytest.approx(speed)
        assert speed == pytest.approx(main * (1.0 - restitution**i) / (1.0 - restitution))
        assert printed == pytest.approx((1.0 - restitution ** (i - 1)) / (1.0 - restitution))
        w = math.atanh(speed)
        assert table.peak[i - 1] == pytest.approx(1.0 - math.cosh(w) + speed * math.sinh(w))  # Eq. (6) as printed
        assert table.duration[i - 1] == pytest.approx(2.0 * w / block.p)  # Eq. (7) as printed
    for stronger in (0.3, 0.2, 0.15, 0.12):
        overturned = models.resonance(block, stronger * block.critical_impulse, 100).overturning_half_cycle
        assert overturned == math.ceil(math.log(1.0 - (1.0 - restitution) / stronger) / math.log(restitution))


@pytest.mark.parametrize(
    ("spacing", "first", "intervals"), [("end", 1.0, 6), ("middle", 0.5, 6), ("start", 0.0, 6), ("open", 1.0, 7)]
)
def test_conditions_of_the_secondary_sequence(spacing, first, intervals):
    """theory/impulses, the table of x(T) = 0 and u_r, and a march by Eq. (2) with the impulses where it puts them."""
    block, u, sigma, n = block_a(), 0.6, 0.4, 6
    sequence = models.ImpulseSequence(
        u * block.critical_impulse, sigma * u * block.critical_impulse, np.nan, np.inf, 1, n, spacing
    )
    table = models.sequence_response(block, sequence).half_cycles
    duration, impact = block.p * table.duration[0], table.impact_speed[0]
    t, h = duration / 2.0, sigma * u / 2.0
    v = u - h
    condition, target, speed = {
        "end": (math.tanh(t) * (1.0 - h * math.tanh(t / n)), v, u - 2.0 * h),
        "middle": (math.tanh(t) + h / math.cosh(t / n), u, u - 2.0 * h / math.cosh(t / n)),
        "start": (math.tanh(t) * (1.0 + h * math.tanh(t / n)), v, u - 2.0 * h),
        "open": (
            math.tanh(t) - h * math.tanh(t / (n + 1)) / math.tanh(t),
            v,
            u - 2.0 * h * (1.0 - math.tanh(t / (n + 1)) / math.tanh(t)),
        ),
    }[spacing]
    assert condition == pytest.approx(target, abs=1e-12)
    assert impact == pytest.approx(speed)
    step = duration / intervals
    x, last, now = impulse_train(u, sigma * u, n, step, first * step)
    wait = duration - now
    assert 1.0 + (x - 1.0) * math.cosh(wait) + last * math.sinh(wait) == pytest.approx(0.0, abs=1e-12)
    assert -((x - 1.0) * math.sinh(wait) + last * math.cosh(wait)) == pytest.approx(impact)


def test_steady_state_and_closed_safety_factor():
    restitution, sigma, main = 0.6, 0.7, 0.5
    block = block_a(restitution)
    impulse = main * block.critical_impulse
    endless = models.ImpulseSequence(impulse, sigma * impulse, np.nan, np.inf, spacing="continuous")
    steady = main * (1.0 - restitution * sigma) / (1.0 - restitution) - sigma * main / 2.0
    found = models.steady_state(block, endless)
    assert found.effective_velocity == pytest.approx(steady)
    assert found.peak == pytest.approx(1.0 - math.sqrt(1.0 - steady**2))
    for count in (1, 2, 5):
        limited = models.ImpulseSequence(impulse, sigma * impulse, np.nan, np.inf, count, spacing="continuous")
        amplified = (1.0 - restitution**count) / (1.0 - restitution)
        factor = models.sequence_critical_scale(block, limited).safety_factor[0]
        assert factor == pytest.approx(1.0 / (main * ((1.0 - sigma) * amplified + sigma / 2.0)))


@pytest.mark.parametrize(
    ("equation", "rise"), [("linear", 0.0), ("nonlinear", 0.0), ("nonlinear", -0.3), ("nonlinear", 0.3)]
)
def test_threshold_and_side_of_uplift(equation, rise):
    """theory/motion: |a_g| > (g + a_v) tan(alpha_c), or g alpha_c; to theta > 0 where a_g is negative."""
    block = block_a()
    threshold = G * block.alpha_c if equation == "linear" else G * (1.0 + rise) * math.tan(block.alpha_c)
    vertical = np.full(20, rise * G) if rise else None
    for factor, lifted in ((1.0 - 1e-9, False), (1.0 + 1e-6, True)):
        ground = np.full(20, -factor * threshold)
        motion = models.recorded_response(block, ground, 0.01, equation, vertical=vertical, history=True)
        assert (motion.outcome != models.Outcome.AT_REST) is lifted
        assert bool(motion.rotation[-1] > 0.0) is lifted


def test_growing_mode_decides_on_a_block_that_lifts_from_rest():
    """theory/safety: overturning without an impact iff p |E|/(g alpha_c) > 1, and the build-up B."""
    block, ground, dt = block_a(), np.concatenate([np.full(41, 4.0), np.zeros(200)]), 0.01
    times = dt * np.arange(ground.size)
    fine = np.linspace(0.0, times[-1], 240001)
    weighted = np.trapezoid(np.interp(fine, times, ground) * np.exp(-block.p * fine), fine)
    factor = G * block.alpha_c / (block.p * weighted)
    found = models.critical_scale(block, ground, dt, equation="linear").safety_factor[0]
    assert found == pytest.approx(factor, rel=1e-5)
    both = np.concatenate([ground, -0.5 * ground])
    demand = models.ground_demand(block, both, dt)
    lobes = demand.lobes[0]
    assert np.all(np.diff(lobes) <= 0.0)
    assert demand.build_up[0] == pytest.approx(np.sum((0.9 * block.restitution) ** np.arange(lobes.size) * lobes))
    assert lobes[1] / lobes[0] > 0.4


def test_free_decay():
    """theory/motion: quarter period, and the peaks after each impact."""
    block, start, dt = block_a(), 0.5, 1e-3
    motion = models.recorded_response(
        block, np.zeros(8000), dt, "linear", initial_rotation=start * block.alpha_c, history=True
    )
    ratio = motion.rotation / block.alpha_c
    landing = np.flatnonzero(np.diff(np.sign(ratio)) != 0.0)
    assert block.p * dt * landing[0] == pytest.approx(math.acosh(1.0 / (1.0 - start)), abs=2.0 * block.p * dt)
    for n in (1, 2, 3):
        peak = np.max(np.abs(ratio[landing[n - 1] + 1 : landing[n] + 1]))
        energy = block.restitution ** (2 * n) * (1.0 - (1.0 - start) ** 2)
        assert peak == pytest.approx(1.0 - math.sqrt(1.0 - energy), abs=1e-5)


@pytest.mark.sweep
@pytest.mark.parametrize("ratio", [2.0, 3.0])
@pytest.mark.parametrize("halves", [1, 2])
def test_sine_pulses_that_overturn_without_an_impact(ratio, halves):
    """theory/motion: half a sine, and a full one; the last edge of the search is the mode without an impact."""
    block = block_a()
    length = halves * math.pi / (ratio * block.p)
    dt = length / 10000
    sine = G * block.alpha_c * np.sin(ratio * block.p * dt * np.arange(10001))
    amplitude = models.critical_scale(block, sine, dt, equation="linear").lower[-1]
    psi = math.asin(1.0 / amplitude)
    left = ratio * math.sin(psi) - math.cos(psi)
    left = left if halves == 1 else -left
    assert left == pytest.approx(math.exp(-(halves * math.pi - psi) / ratio), abs=1e-4)


def test_rotation_of_a_pair_is_the_projection_of_the_vector():
    """theory/record: a(psi), for channels that are not at right angles."""
    rng = np.random.default_rng(3)
    north, east = rng.standard_normal((2, 50))

    def towards(azimuth):
        angle = math.radians(azimuth)
        return north * math.cos(angle) + east * math.sin(angle)

    pair = Pair(*(rp.Record(towards(z), dt=0.01, id=f"x.{z}", azimuth=float(z)) for z in (20, 85)))
    for psi in (0.0, 50.0, 133.0):
        assert rp.rotate(pair, psi).acceleration == pytest.approx(towards(psi), abs=1e-12)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_gain_of_the_filters(order):
    """theory/record: 1/[1 + (f_c/f)^(2n)] and 1/[1 + (f/f_c)^(2n)]."""
    time = 0.005 * np.arange(40001)
    for frequency in (0.5, 1.0, 2.0):
        record = rp.Record(np.sin(2.0 * np.pi * frequency * time), dt=0.005, id="sine", processed=True)
        inside = slice(15000, 25000)
        for corner, ratio in (({"highpass_hz": 1.0}, 1.0 / frequency), ({"lowpass_hz": 1.0}, frequency)):
            filtered = rp.condition(record, order=order, **corner).acceleration[inside]
            assert np.max(np.abs(filtered)) == pytest.approx(1.0 / (1.0 + ratio ** (2 * order)), rel=2e-3, abs=1e-4)


@pytest.mark.sweep
@pytest.mark.parametrize("height", [2.4])
def test_sequence_of_the_rule(ridgecrest, height):
    """theory/calibration: D, I = D I_1c/[(1 - sigma) S_N + sigma/2], peak 1 - sqrt(1 - D^2), safety factor 1/D."""
    record = rp.condition(next(channel for channel in ridgecrest if channel.station == "CLC"))
    block, rule = models.Block(half_width=height / 10.0, half_height=height / 2.0), rp.load_rule("balanced")
    waves = rp.half_waves(record)
    asked = models.demand_of_half_waves(block, waves.start, waves.centroid, waves.end, waves.impulse)
    assert round(rule.factor, 3) == 0.967
    demand = min(rule.factor * asked.march[0], record.pga / (block.gravity * math.tan(block.alpha_c)))
    sequence = rule.sequence(waves, block)
    count, sigma = int(asked.main_count[0]), float(asked.ratio[0])
    amplified = (1.0 - block.restitution**count) / (1.0 - block.restitution)
    assert sequence.main[0] == pytest.approx(
        demand * block.critical_impulse / ((1.0 - sigma) * amplified + sigma / 2.0)
    )
    assert rule.safety_factor(waves, block)[0] == pytest.approx(1.0 / demand)
    peak = models.sequence_response(block, sequence).peak_rotation_ratio[0]
    assert peak == pytest.approx(1.0 - math.sqrt(1.0 - demand**2) if demand < 1.0 else math.inf)


def test_fragility_of_known_capacities_is_mean_and_deviation_of_their_logarithms():
    """theory/safety: median e^(-a/b), beta 1/b."""
    capacities = np.exp(np.random.default_rng(5).normal(-0.5, 0.4, 60))
    curve = rp.fit_capacities(capacities)
    assert curve.median == pytest.approx(math.exp(np.mean(np.log(capacities))))
    assert curve.beta == pytest.approx(np.std(np.log(capacities)))
    halfway, above, _ = curve.probability([curve.median, curve.median * math.exp(curve.beta), 1.0])[0]
    assert (halfway, above) == pytest.approx((0.5, 0.841345), abs=1e-6)


def test_friction_that_rocking_needs():
    """limits: (width/height)(3 + uplift ratio)/4 is what pure rocking needs at uplift, and never less than it."""
    for slenderness in (3.0, 5.0, 10.0):
        alpha = math.atan(1.0 / slenderness)
        for ratio in (1.0, 2.0, 4.0, 6.0):
            ground = ratio * math.tan(alpha)  # over g; the angular acceleration is k g/R
            k = 0.75 * (ground * math.cos(alpha) - math.sin(alpha))
            needed = (ground - k * math.cos(alpha)) / (1.0 + k * math.sin(alpha))
            stated = (3.0 + ratio) / (4.0 * slenderness)
            assert needed <= stated * (1.0 + 1e-12)
            assert needed > (0.8 if slenderness > 4.0 else 0.55) * stated
