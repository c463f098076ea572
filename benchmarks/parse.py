"""Time to read 1 MB of each format, beside ``numpy.loadtxt`` on the same numbers: ``python benchmarks/parse.py``.

Times are medians of whole calls of `rockpulse.read` on bytes in memory, in processor time (so that other work on the
machine has little influence). They include the recognition of the format, every check, the digest and the conversion to
m/s2. ``numpy.loadtxt`` only reads the same numbers, separated by blanks. The numbers are random, so that no field is
easier to read than another.
"""

import argparse
import io
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from record_writers import at2, csmip_equal, csmip_pairs, knet, smc
from record_writers.columns import columns

from rockpulse.readers import read

SIZE = 1e6  # bytes
LIMIT = 0.060  # s
DT = 0.005  # s


def noise(count: int, peak: float, decimals: int = 12) -> np.ndarray:
    """(count,) Numbers of normal distribution with about this largest absolute value."""
    return np.round(0.2 * peak * np.random.default_rng(5).standard_normal(count), decimals)


def pairs(count: int) -> tuple[bytes, np.ndarray]:
    """Times and accelerations, fields of width 7."""
    times, values = DT * np.arange(count), noise(count, 2.0, 3)
    return csmip_pairs(times, values), np.column_stack([times, values])


def layouts() -> dict[str, tuple[bytes, np.ndarray, dict[str, Any]]]:
    """Name -> file, its numbers, what the file does not say."""
    file: dict[str, tuple[bytes, np.ndarray, dict[str, Any]]] = {}
    values = noise(int(SIZE / 9.25), 0.9, 6)
    file["8F9.6, touching"] = (csmip_equal(values), values, {})
    values = noise(int(SIZE / 15.2), 0.9)
    file["5E15.7"] = (at2(values), values, {})
    values = -1.0 - np.abs(noise(int(SIZE / 10.125), 20.0, 5))
    file["8F10.5"] = (at2(values, field="{:10.5f}", per_row=8), values, {})
    values = noise(int(SIZE / 10.125), 300.0)
    file["8E10.4, touching"] = (smc(values), values, {})
    content, values = pairs(int(SIZE / 14.4))
    file["pairs, 10F7.3"] = (content, values, {})
    values = np.round(noise(int(SIZE / 9.125), 9e5))
    file["8I8 counts"] = (knet(list(values.astype(int))), values, {})
    values = noise(int(SIZE / 10.4), 0.9)
    file["1 column"] = (columns(values[:, None], field="{:.7f}"), values, {"units": "g", "dt": DT})
    values = noise(int(SIZE / 19.0), 0.9)
    values = np.column_stack([DT * np.arange(values.size), values])
    file["2 columns, blanks"] = (columns(values, field="{:.6f}"), values, {"units": "g"})
    file["2 columns, commas"] = (columns(values, separator=",", field="{:.6f}"), values, {"units": "g"})
    values = np.column_stack([DT * np.arange(int(SIZE / 40.0)), *noise(3 * int(SIZE / 40.0), 0.9).reshape(3, -1)])
    file["4 columns, tabs"] = (columns(values, separator="\t", field="{:.7f}"), values, {"units": "g"})
    return file


def median(runs: int, call: Callable[[], object]) -> float:
    """Median time of a call [s], after one that warms up."""
    call()
    times = []
    for _ in range(runs):
        start = time.thread_time()
        call()
        times.append(time.thread_time() - start)
    return statistics.median(times)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=9)
    runs = parser.parse_args().runs
    print(f"{'layout':20s} {'size':>8s} {'numbers':>8s} {'read':>9s} {'loadtxt':>9s} {'ratio':>6s}")
    slow = 0
    for name, (content, numbers, options) in layouts().items():
        plain = io.BytesIO()
        np.savetxt(plain, numbers, fmt="%.7g")

        def ours(content: bytes = content, options: dict[str, Any] = options) -> object:
            return read(io.BytesIO(content), **options)

        def theirs(plain: bytes = plain.getvalue()) -> object:
            return np.loadtxt(io.BytesIO(plain))

        taken, reference = median(runs, ours), median(runs, theirs)
        slow += taken > LIMIT
        print(
            f"{name:20s} {len(content) / 1e6:5.2f} MB {numbers.size:8d} "
            f"{1e3 * taken:6.1f} ms {1e3 * reference:6.1f} ms {taken / reference:6.2f}"
        )
    print(f"{slow} of {len(layouts())} layouts above {1e3 * LIMIT:.0f} ms")
    return slow


if __name__ == "__main__":
    sys.exit(main())
