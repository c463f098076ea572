"""The synthetic ensemble: the same samples everywhere, no drift, and what was asked for."""

import hashlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rockpulse.errors import ConfigError
from synthetic import synthetic_lanes, synthetic_motion

SOME = settings(derandomize=True, deadline=None, max_examples=10)
SEEDS = st.integers(0, 2**32 - 1)


def test_motion_of_a_seed_never_changes():
    """The samples are the ground of stored references: another numpy must make the same ones."""
    digest = hashlib.sha256(np.rint(1e6 * synthetic_motion(0)).astype("<i8").tobytes()).hexdigest()
    assert digest == "5e2bd8929891bd9ab025de1012d01469e13e620f79e4fd1e9ae936a9f8ef0b21"


def test_lanes_of_a_seed_never_change():
    lanes = synthetic_lanes(0, 2)
    assert lanes.p.tolist() == [3.130603, 3.105121]
    assert lanes.alpha.tolist() == [0.228797, 0.155914]
    assert lanes.pga.tolist() == [3.143548, 3.228142]


@pytest.mark.slow
@SOME
@given(SEEDS, st.floats(5.0, 80.0), st.sampled_from([0.005, 0.01, 0.02]), st.floats(0.5, 10.0))
def test_motion_has_its_length_and_peak_and_ends_at_rest(seed, duration, dt, pga):
    motion = synthetic_motion(seed, duration, dt, pga)
    whole = np.rint(1e6 * motion).astype(np.int64)
    assert motion.size == round(duration / dt) + 1
    assert np.array_equal(motion, whole / 1e6)
    assert np.max(np.abs(motion)) == pytest.approx(pga, abs=1.1e-6)
    assert motion[0] == motion[-1] == 0.0
    assert whole.sum() == 0  # the velocity after the last sample, by the trapezoidal rule


@SOME
@given(SEEDS, st.integers(1, 50))
def test_lanes_are_in_their_ranges_and_those_of_a_longer_call(seed, count):
    lanes = synthetic_lanes(seed, count, restitution=0.95)
    assert np.all((lanes.p >= 1.0) & (lanes.p <= 8.0))
    assert np.all((lanes.alpha >= 0.05) & (lanes.alpha <= 0.3))
    assert np.all((lanes.pga >= 0.2 * 9.80665 - 1e-6) & (lanes.pga <= 0.4 * 9.80665 + 1e-6))
    assert lanes.restitution.tolist() == [0.95] * count
    longer = synthetic_lanes(seed, count + 7)
    assert np.array_equal(longer.p[:count], lanes.p)
    assert np.array_equal(longer.pga[:count], lanes.pga)


@pytest.mark.parametrize(
    ("name", "inside", "outside"),
    [
        ("duration", (1.0, 100.0), (0.999, 100000.1)),
        ("dt", (1e-4, 0.1), (0.999e-4, 0.1001)),
        ("pga", (1e-3, 1e3), (0.999e-3, 1000.1)),
        ("seed", (0, 2**32 - 1), (-1, 2**32)),
    ],
)
def test_values_out_of_range_are_refused_by_name(name, inside, outside):
    others = {"seed": 1, "duration": 1.0, "dt": 0.1}
    for value in inside:
        assert np.all(np.isfinite(synthetic_motion(**(others | {name: value}))))
    for value in (*outside, float("nan")):
        with pytest.raises(ConfigError, match=name):
            synthetic_motion(**(others | {name: value}))


def test_a_motion_is_written_out_by_its_formula():
    """Spectrum, envelope and peak worked out again; the last digits are those of what is left to balance."""
    seed, duration, dt, pga = 7, 30.0, 0.02, 2.5
    draw = np.random.RandomState(seed)
    ground, damping = 0.5 * 10.0 ** draw.uniform(), 0.3 + 0.4 * draw.uniform()
    rise, strong = 0.03 + 0.12 * draw.uniform(), 0.03 + 0.32 * draw.uniform()
    left = 10.0 ** (-6.0 + 4.5 * draw.uniform())
    noise = draw.standard_normal(1501)
    f = np.fft.rfftfreq(1501, dt)
    r, q = f / ground, f / (0.1 * ground)
    shape = (1 + (2 * damping * r) ** 2) / ((1 - r**2) ** 2 + (2 * damping * r) ** 2)
    shape *= q**4 / ((1 - q**2) ** 2 + (2 * 0.6 * q) ** 2)
    t = np.linspace(0.0, 1.0, 1501)
    envelope = np.interp(t, [0.0, rise, 1.0], [0.0, 1.0, 1.0]) ** 2
    envelope[t > rise + strong] = left ** ((t[t > rise + strong] - rise - strong) / (1.0 - rise - strong))
    envelope[-1] = 0.0
    motion = envelope * np.fft.irfft(np.sqrt(shape) * np.fft.rfft(noise), 1501)
    motion -= envelope * motion.sum() / envelope.sum()
    found = synthetic_motion(seed, duration, dt, pga)
    assert found == pytest.approx(motion * pga / np.abs(motion).max(), abs=2.1e-6)
