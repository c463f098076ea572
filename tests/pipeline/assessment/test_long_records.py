"""The memory of an assessment grows little with the length of the record."""

import tracemalloc

import numpy as np
import pytest

import rockpulse as rp
from rocking.lanes import thread_limit
from rockpulse.record.half_wave import COLUMNS, half_waves
from rockpulse.record.record import Record
from synthetic import synthetic_motion

#: Largest memory beside the samples with one thread [bytes per sample]; half-waves of noise take 13, a day at 200 Hz is
#: 17 million samples. When the tables of several threads exist at the same time depends on the machine.
MOST = 60.0


def long_record(count):
    """Noise throughout, with one earthquake in it."""
    samples = np.random.default_rng(1).normal(0.0, 0.002, count + 2)
    samples = 0.25 * samples[:-2] + 0.5 * samples[1:-1] + 0.25 * samples[2:]
    motion = synthetic_motion(3, pga=3.0)
    samples[count // 3 : count // 3 + motion.size] += motion
    return Record(samples, dt=0.005, id="long", processed=False)


def peak_of(record):
    tracemalloc.start()
    try:
        with thread_limit(1):
            found = rp.assess(record, bodies={"pier": (1.0, 8.0), "stele": (0.5, 3.0)})
        return tracemalloc.get_traced_memory()[1], found
    finally:
        tracemalloc.stop()


@pytest.mark.sweep
def test_a_long_record_takes_a_bounded_memory_for_each_sample():
    peak_of(long_record(20_000))  # what is imported and compiled once
    sizes = 500_000, 700_000  # the tables of the march are full from 200,000 samples on
    (less, _), (more, found) = (peak_of(long_record(size)) for size in sizes)
    assert (more - less) / (sizes[1] - sizes[0]) < MOST
    assert found["summary"]["outcome"].shape == (1, 2, 2)


def test_lobes_computed_in_parts_are_those_of_the_whole(monkeypatch):
    record = long_record(10_000)
    whole = half_waves(record)
    monkeypatch.setattr("rockpulse.record.half_wave.AT_ONCE", 97)
    parts = half_waves(record)
    assert all(np.array_equal(getattr(whole, name), getattr(parts, name)) for name in COLUMNS)
