"""Speed of the rocking solvers compared with solve_ivp and a plain recurrence: ``python benchmarks/speed.py``.

All times are measured in one run, on the same cases for both sides. They are medians of whole calls, in processor time
of the calling thread (so that other work on the machine has little influence). ``--only`` selects sections, ``--runs``
sets the number of calls. ``make accuracy`` measures the error of the same kernels.
"""

import argparse
import logging
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable

import numpy as np
from numba import njit

from rocking.lanes import available_cores
from rockpulse.models import Block, Outcome, recorded_response
from rockpulse.studies.selftest.baseline import baseline_response as solve_ivp_response
from synthetic import synthetic_lanes, synthetic_motion

EQUATIONS = ("linear", "nonlinear")
DT = 0.01  # s
GRAVITY = 9.80665  # m/s2


def lanes(seed: int, count: int) -> tuple[Block, np.ndarray]:
    """Blocks with p of 1 to 8 1/s, alpha of 0.05 to 0.3, C = 0.9, and a motion of 0.3 g over 60 s."""
    drawn = synthetic_lanes(seed, count)
    block = Block.from_parameters(p=drawn.p, alpha=drawn.alpha, restitution=drawn.restitution, gravity=GRAVITY)
    return block, synthetic_motion(seed, pga=0.3 * GRAVITY)


def median(runs: int, call: Callable[[], object], clock: Callable[[], float] = time.thread_time) -> float:
    """Median time of a whole call [s], after one that warms up."""
    call()
    times = []
    for _ in range(runs):
        start = clock()
        call()
        times.append(clock() - start)
    return statistics.median(times)


def against_solve_ivp(runs: int, count: int) -> None:
    """Rows 1 and 2: per active block-sample against solve_ivp RK45 at rtol 1e-6 with events."""
    for equation in EQUATIONS:
        ours, theirs, active, their_active, differ = 0.0, 0.0, 0, 0, 0
        for seed in range(2):
            block, motion = lanes(seed, count)
            scales = np.linspace(0.7, 1.3, 3)

            def call(block=block, motion=motion, scales=scales, equation=equation):
                return recorded_response(block, motion, DT, equation, scale=scales, threads=1)

            answer = call()
            ours += median(runs, call)
            active += int(answer.active_samples.sum())
            for lane in range(count):
                for row, scale in enumerate(scales):
                    one = block.lane(lane)
                    start = time.thread_time()
                    other = solve_ivp_response(one.p, one.alpha_c, 0.9, motion, DT, equation, scale, GRAVITY)
                    theirs += time.thread_time() - start
                    their_active += other.active_samples
                    differ += Outcome(answer.outcome[row, lane]).name != other.outcome
        print(
            f"{equation} against solve_ivp: {ours / active * 1e9:.1f} ns against "
            f"{theirs / their_active * 1e9:,.0f} ns per"
            f" active block-sample ({6 * count} lanes, {active} active samples, {differ} outcomes differ):"
            f" {theirs / their_active / ours * active:,.0f}x"
        )


@njit(error_model="numpy", fastmath={"contract"})
def recurrence(motion, a, b, c, d, e, x, v):
    """The bare 2x2 recurrence of every lane over every sample: no uplift, no impact, no overturning."""
    for k in range(motion.size):
        ground = motion[k]
        for j in range(x.size):
            old = x[j]
            x[j] = a[j] * old + b[j] * v[j] - e[j] * ground
            v[j] = c[j] * old + d[j] * v[j] - e[j] * ground


def recurrence_numpy(motion, a, b, c, d, e, x, v):
    """The same, as vectorised numpy."""
    for ground in motion:
        push = e * ground
        x, v = a * x + b * v - push, c * x + d * v - push
    return x, v


def against_recurrence(runs: int, count: int) -> None:
    """Row 3: nominal block-samples against a bare recurrence, in numba (vector instructions) and in numpy."""
    block, motion = lanes(1, count)
    h = np.asarray(block.p) * DT
    coefficients = (np.cosh(h), np.sinh(h), np.sinh(h), np.cosh(h), 0.5 * h)
    nominal = count * motion.size
    scales = {"0.2 g": 2 / 3, "0.3 g": 1.0, "0.4 g": 4 / 3}
    chunks = [slice(i, i + 256) for i in range(0, count, 256)]  # lanes that stay in the fastest cache

    def bare():
        for part in chunks:
            size = h[part].size
            recurrence(motion, *(value[part] for value in coefficients), np.zeros(size), np.zeros(size))

    bare_numpy = lambda: recurrence_numpy(motion, *coefficients, np.zeros(count), np.zeros(count))  # noqa: E731
    with np.errstate(all="ignore"):
        numba_time, numpy_time = median(runs, bare), median(max(3, runs // 4), bare_numpy)
    for name, scale in scales.items():
        ours = median(runs, lambda scale=scale: recorded_response(block, motion, DT, "linear", scale=scale, threads=1))
        print(
            f"linear over nominal block-samples, {name}: {ours / nominal * 1e9:.2f} ns; bare recurrence in numba "
            f"{numba_time / nominal * 1e9:.2f} ns ({ours / numba_time:.1f}x), in numpy "
            f"{numpy_time / nominal * 1e9:.2f} ns ({ours / numpy_time:.2f}x)"
        )


def many_lanes(runs: int) -> None:
    """Row 5: 64 factors x 400 blocks on one record against one lane alone, and two threads against one."""
    block, motion = lanes(2, 400)
    scales = np.geomspace(0.5, 2.0, 64)
    answer = recorded_response(block, motion, DT, "nonlinear", scale=scales, threads=1)
    together = median(max(3, runs // 4), lambda: recorded_response(block, motion, DT, scale=scales, threads=1))
    active = answer.active_samples
    chosen = [(row, lane) for row in range(0, 64, 9) for lane in range(0, 400, 57) if active[row, lane] > 300]
    alone = 0.0
    for row, lane in chosen:
        one = block.lane(lane)
        alone += median(5, lambda one=one, row=row: recorded_response(one, motion, DT, scale=scales[row], threads=1))
    share = sum(int(active[place]) for place in chosen)
    many, single = together / active.sum() * 1e9, alone / share * 1e9
    print(
        f"64 factors x 400 blocks: {many:.1f} ns per active sample; lanes alone {single:.1f} ns ({single / many:.2f}x)"
    )
    if available_cores() < 2:
        print("two threads: this process has one core")
        return
    wall = {
        threads: median(
            max(3, runs // 4),
            lambda threads=threads: recorded_response(block, motion, DT, scale=scales, threads=threads),
            time.perf_counter,
        )
        for threads in (1, 2)
    }
    load = os.getloadavg()[0]
    print(f"two threads against one, by the clock: {wall[1] / wall[2]:.2f}x (load of the machine {load:.1f})")


FIRST_CALLS = """
import logging, time
logging.disable(logging.WARNING)
import numpy as np
from rockpulse import models
block = models.Block(half_width=0.5, half_height=2.0)
motion = 5.0 * np.sin(0.06 * np.arange(500))
calls = {
    "recorded": lambda: [models.recorded_response(block, motion, 0.01, e) for e in ("linear", "nonlinear")],
    "impulsive": lambda: models.impulsive_response(block, [0.0, 0.5], [0.3, -0.3]),
    "sequence": lambda: models.sequence_response(block, models.ImpulseSequence(0.3, 0.1, 0.2, 10.0)),
    "resonance": lambda: models.resonance(block, 0.3, 10),
}
for name in ("recorded_response", "impulsive_response", "sequence_response", "resonance"):
    getattr(models, name)  # imports numba and the kernels' modules: no part of compiling them
for name, call in calls.items():
    start = time.process_time(); call(); print(name, time.process_time() - start)
"""


def compile_time() -> None:
    """Row 6: the first call of every kernel, compiled and from the cache."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "NUMBA_CACHE_DIR": folder}
        for state in ("compiled", "from cache"):
            done = subprocess.run(
                [sys.executable, "-c", FIRST_CALLS], env=environment, capture_output=True, text=True, check=True
            )
            rows = [line.split() for line in done.stdout.splitlines()]
            parts = ", ".join(f"{name} {float(seconds):.2f}" for name, seconds in rows)
            print(
                f"first calls, {state}: {sum(float(seconds) for _, seconds in rows):.2f} s of processor time ({parts})"
            )


def memory() -> None:
    """Row 7: what a call allocates on a record of a million samples, beside the answer."""
    motion = np.zeros(1_000_000)
    motion[::5000], motion[1::5000] = 4.0, -4.0
    count = 1000
    block = Block.from_parameters(p=np.linspace(1, 8, count), alpha=np.linspace(0.05, 0.3, count), restitution=0.9)
    recorded_response(block, motion[:10], DT, threads=2)
    tracemalloc.start()
    answer = recorded_response(block, motion, DT, threads=2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    output = sum(value.nbytes for value in vars(answer).values() if isinstance(value, np.ndarray))
    print(
        f"memory: a million samples ({motion.nbytes / 1e6:.0f} MB) x {count} blocks, two threads: "
        f"{(peak - output) / 1e6:.2f} MB beside input and output"
    )


#: Programs whose start is compared: the packages that an assessment needs, its modules, an empty program, the help.
STARTS = {
    "packages": ["-c", "import numpy, scipy.special, pandas, xarray, numba, h5py"],
    "assess": ["-c", "import rockpulse.run.batch, rockpulse.views.text.overview"],
    "python": ["-c", "pass"],
    "help": ["-m", "rockpulse", "--help"],
}


def start(runs: int) -> None:
    """Row 8: processor time until an assessment begins to read, and of the first screen of help, in new processes."""
    spent: dict[str, list[float]] = {name: [] for name in STARTS}
    for _ in range(runs + 1):  # in turn; the first of each loads the files into memory
        for name, arguments in STARTS.items():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    cost = {name: statistics.median(values[1:]) for name, values in spent.items()}
    print(
        f"start of an assessment: {cost['assess']:.2f} s of processor time, {cost['assess'] / cost['packages']:.2f} "
        f"times that of the packages it needs; help: {cost['help']:.2f} s, an empty program {cost['python']:.2f} s"
    )


SECTIONS: dict[str, Callable[[argparse.Namespace], None]] = {
    "solve_ivp": lambda args: against_solve_ivp(args.runs, args.lanes),
    "recurrence": lambda args: against_recurrence(args.runs, 2000),
    "lanes": lambda args: many_lanes(args.runs),
    "compile": lambda args: compile_time(),
    "memory": lambda args: memory(),
    "start": lambda args: start(max(3, args.runs // 4)),
}


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=21, help="calls of which the median is taken")
    parser.add_argument(
        "--lanes", type=int, default=24, help="blocks on each of two motions for solve_ivp, at three factors"
    )
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS))
    args = parser.parse_args()
    logging.getLogger("rockpulse").setLevel(logging.ERROR)
    for name in args.only:
        SECTIONS[name](args)


if __name__ == "__main__":
    main()
