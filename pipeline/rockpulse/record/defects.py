"""Detects defects of a channel from its samples before conditioning.

The defects are gaps, spikes, drift, noise, a missing start or end, and a long sampling interval. Their limits were
chosen with real records, see docs/decisions/022-defects.md.
"""

from dataclasses import replace

import numpy as np

from rockpulse.record.intensity import ground_velocity
from rockpulse.record.record import STANDARD_GRAVITY, Record, largest
from rockpulse.warning_text import WarningText, code_of, find, has_warning

#: Codes of the warnings on defects.
_CODES = (
    "dead_channel noise_only held_value filled_gap repeated_samples repeated_block spike starts_strong ends_strong "
    "coarse_sampling velocity_drift twin_differs components_apart interval_apart may_be_vertical length_differs "
    "same_samples same_direction"
)
DEFECTS = tuple(_CODES.split())
#: Number of samples that are processed at once, to save memory.
AT_ONCE = 2**18
#: Length of the shortest record that is checked for all defects [samples]. In shorter records, only a dead channel (all
#: samples are equal) is detected.
FEWEST = 100
#: Shortest straight line in a record that is reported, in [s] and in [samples]; digitised film contains shorter ones.
LINE_LENGTH, LINE_SAMPLES = 0.12, 8
#: Smallest ratio of the second differences on both sides of a straight line to the limit for those within it.
LINE_CONTRAST = 20.0
#: Smallest share of repeated samples in the strong part of a record that is reported; smallest median difference of
#: successive samples for which this is checked, as a multiple of the resolution.
REPEATED_SHARE, STEP_CONTRAST = 0.3, 10.0
#: Shortest repeated block of samples that is reported [samples].
BLOCK_SAMPLES = 32
#: Half widths [samples] of the running median with which each sample is compared, and of the surroundings of a spike.
SPIKE_HALF, SPIKE_AROUND = 3, 50
#: The deviation of a spike from the running median exceeds SPIKE_NEAR times all other deviations near it, and
#: SPIKE_NEAR_SHARE of the peak of the record; or the deviations of up to SPIKE_COUNT spikes exceed SPIKE_FAR times all
#: other deviations of the record, and SPIKE_FAR_SHARE of its peak.
SPIKE_NEAR, SPIKE_NEAR_SHARE = 12.0, 0.1
SPIKE_FAR, SPIKE_FAR_SHARE, SPIKE_COUNT = 3.0, 0.3, 12
#: Smallest number of lost samples that is reported; a lost sample is zero between two large samples of the same sign.
DROPOUTS = 3
#: Length of the first and the last part of a record [s], which are checked for strong motion; smallest ratios of the
#: root mean square of a part in strong motion to the peak, and to that of the quietest window of the same length.
END_LENGTH, END_SHARE, END_CONTRAST = 0.5, 0.14, 1.5
#: Largest ratio of the standard deviation in the strongest second to that in the median second, for two kinds of noise.
NOISE_CONTRAST = {"white": 1.5, "weak": 2.2}
#: Smallest energy of the differences of successive samples of white noise, divided by the energy of the samples;
#: largest amplitude of weak noise [m/s2]; smallest number of windows of 1 s in a record that is checked for noise;
#: largest range of the samples of a channel that contains only noise, as a multiple of the resolution.
WHITE, WEAK, NOISE_WINDOWS, DEAD_STEPS = 0.8, 0.02, 10, 8.0
#: Longest sampling interval that is not reported [s]. A record with a longer one must be confirmed if the energy of the
#: differences of successive samples, divided by the energy of the samples, exceeds the second number: it lacks
#: frequencies above the Nyquist frequency.
COARSE, UNDERSAMPLED = 0.0999, 1.0
#: Length of the moving mean that separates the slow ground velocity from the rest [s]; largest length as a share of the
#: duration of the record.
SLOW_LENGTH, SLOW_SHARE = 10.0, 0.25
#: Ratios of the slow velocity to the largest remaining velocity above which a drift is reported, and above which it
#: must be confirmed.
DRIFT, DECIDING_DRIFT = 1.25, 1.5


def with_defects(record: Record) -> Record:
    """Return the record with a warning on each defect of its samples; a record is checked only once."""
    if record.stage != "read":
        return record
    known = {code_of(warning) for warning in record.warnings}
    found = tuple(one for one in defects(record) if one.code not in known)
    return replace(record, warnings=(*record.warnings, *found), stage="checked")


def deciding(record: Record) -> list[WarningText]:
    """Return the defects of a conditioned record that may change its results and must be confirmed before use."""
    found = [one for one in record.warnings if isinstance(one, WarningText) and one.values.get("decides")]
    if find(record.warnings, "dead_channel"):
        found += [WarningText("dead_channel")]
    # A drift that the filter or the baseline has removed no longer affects the velocity.
    left = find(record.warnings, "baseline_drift")
    decides = left is not None and left.values["slow"] > DECIDING_DRIFT * left.values["rest"]
    return [one for one in found if one.code != "velocity_drift" or decides]


def drifts(record: Record) -> bool:
    """Return whether the ground velocity of a record drifts, or drifted before the baseline was subtracted."""
    return any(has_warning(code_of(one), "baseline_drift", "velocity_drift") for one in record.warnings)


def defects(record: Record) -> list[WarningText]:
    """Return a warning on each defect in the samples of a record that is not yet conditioned."""
    samples, dt = record.acceleration, record.dt
    resolution = _resolution(samples)
    if resolution == np.inf:
        return [WarningText("dead_channel")]
    if samples.size < FEWEST:
        return []
    centred = samples - np.median(samples)
    if dead := _noise(samples, dt, resolution):
        return [dead]
    strong = _strong_part(centred)
    found = [
        *_lines(record, centred, resolution, strong),
        *_repeated(samples, dt, resolution, strong),
        *_spikes(samples, centred, dt),
        *_ends(samples, centred, dt),
    ]
    if dt > COARSE:
        decides = bool(np.sum(np.diff(samples) ** 2) > UNDERSAMPLED * np.sum((samples - np.mean(samples)) ** 2))
        found.append(WarningText("coarse_sampling", rate=1.0 / dt, nyquist=0.5 / dt, decides=decides))
    constants = (0.0, np.mean(samples), np.median(samples))
    slow, rest = min((slow_velocity(samples - one, dt) for one in constants), key=lambda one: one[0] / one[1])
    if slow > DRIFT * rest:
        # A pulse that is given as an array may leave a velocity on purpose.
        found.append(WarningText("velocity_drift", slow=slow, rest=rest, decides=bool(record.source)))
    return found


def slow_velocity(acceleration: np.ndarray, dt: float) -> tuple[float, float]:
    """Return the largest absolute moving mean of the ground velocity, and the largest deviation from it [m/s]."""
    velocity = ground_velocity(acceleration, dt)
    size = velocity.size
    half = max(int(0.5 * min(SLOW_LENGTH, SLOW_SHARE * size * dt) / dt), 1)
    total = np.zeros(size + 1)
    np.cumsum(velocity, out=total[1:])
    largest_slow, largest_rest = 0.0, float(np.finfo(float).tiny)
    for first in range(0, size, AT_ONCE):
        place = np.arange(first, min(first + AT_ONCE, size))
        low, high = np.maximum(place - half, 0), np.minimum(place + half + 1, size)
        slow = (total[high] - total[low]) / (high - low)
        largest_slow = max(largest_slow, largest(slow))
        largest_rest = max(largest_rest, largest(velocity[place] - slow))
    return largest_slow, largest_rest


def _resolution(samples: np.ndarray) -> float:
    """Return the smallest step between two values of the samples; inf if all are equal."""
    steps = np.diff(np.unique(samples))
    return float(np.min(steps[steps > 1e-9 * np.ptp(samples)], initial=np.inf))


def _strong_part(centred: np.ndarray) -> np.ndarray:
    """Return the indices of the samples at which 5 % and 95 % of the energy are reached, (2,)."""
    energy = np.cumsum(centred**2)
    return np.searchsorted(energy, (0.05 * energy[-1], 0.95 * energy[-1]))


def _noise(samples: np.ndarray, dt: float, resolution: float) -> WarningText | None:
    """Return a warning on a channel that is dead or contains only noise; None for other channels."""
    span = float(np.ptp(samples))
    if span <= DEAD_STEPS * resolution:
        reason = f"the samples span only {span / resolution:.0f} steps of the resolution"
        return WarningText("noise_only", reason=reason, decides=True)
    length = max(round(1.0 / dt), 20)
    count = samples.size // length
    if count < NOISE_WINDOWS:
        return None
    levels = samples[: count * length].reshape(count, length).std(axis=1)
    median = float(np.median(levels))
    contrast = float(np.max(levels)) / median if median > 0.0 else np.inf
    white = np.sum(np.diff(samples) ** 2) > WHITE * np.sum((samples - np.mean(samples)) ** 2)
    weak = 0.5 * span < WEAK
    if (white and contrast < NOISE_CONTRAST["white"]) or (weak and contrast < NOISE_CONTRAST["weak"]):
        reason = f"the strongest second is {contrast:.2g} times as strong as the median second"
        return WarningText("noise_only", reason=reason, decides=True)
    return None


def _runs(mask: np.ndarray) -> np.ndarray:
    """Return the index of the first True of each run of True in a mask, and of the first False after it, as (k, 2)."""
    return np.flatnonzero(np.diff(np.pad(mask.view(np.int8), 1))).reshape(-1, 2)


def _lines(record: Record, centred: np.ndarray, resolution: float, strong: np.ndarray) -> list[WarningText]:
    """Return a warning on the longest constant part of a record, and on its longest inclined straight part."""
    bend = np.abs(np.diff(centred, 2))
    peak = largest(centred)
    straight = max(2.1 * resolution, 1e-6 * peak)
    clipped = find(record.warnings, "clipped") is not None
    found: dict[str, list[WarningText]] = {"held_value": [], "filled_gap": []}
    for begin, end in _runs(bend <= straight).tolist():
        length = (end - begin + 1) * record.dt
        if end - begin + 2 < LINE_SAMPLES or length < LINE_LENGTH:
            continue
        around = max(end - begin, 20)
        sides = [bend[max(begin - around, 0) : begin], bend[end : end + around]]
        held = not np.any(np.diff(centred[begin : end + 2]))
        level = float(np.abs(centred[begin]))
        if min(side.size for side in sides) < LINE_SAMPLES // 2:
            # At an end of the record zeros are no defect, but a constant strong acceleration is.
            sides = [side for side in sides if side.size >= LINE_SAMPLES // 2]
            if not sides or level < END_SHARE * peak:
                continue
        if min(float(np.median(side)) for side in sides) < LINE_CONTRAST * straight:
            continue
        if held and clipped and level > 0.5 * peak:
            continue
        code = "held_value" if held else "filled_gap"
        decides = bool(end >= strong[0] and begin <= strong[1])
        found[code].append(WarningText(code, length=length, start=begin * record.dt, decides=decides))
    kinds = filter(None, found.values())
    return [max(every, key=lambda one: (one.values["decides"], one.values["length"])) for every in kinds]


def _repeated(samples: np.ndarray, dt: float, resolution: float, strong: np.ndarray) -> list[WarningText]:
    """Return a warning if many samples in strong motion equal the previous sample, or if a block is repeated."""
    change = np.abs(np.diff(samples[strong[0] : strong[1] + 1]))
    moved = change[change > 0.0]
    if not moved.size or np.median(moved) < STEP_CONTRAST * resolution:
        return []
    share = 1.0 - moved.size / change.size
    # One long run is reported as a gap; repeated samples form many runs.
    runs = _runs(change == 0.0)
    longest = int(np.max(runs[:, 1] - runs[:, 0], initial=0))
    share = share if len(runs) > 2 * longest else 0.0
    if share > REPEATED_SHARE:
        return [WarningText("repeated_samples", share=100.0 * share, decides=True)]
    return _block(samples, dt, resolution)


def _block(samples: np.ndarray, dt: float, resolution: float) -> list[WarningText]:
    """Return a warning if a block of samples occurs exactly twice; if it occurs more often, the record is periodic."""
    width = 8
    bits = samples.view(np.uint64)
    if samples.size < 4 * BLOCK_SAMPLES:
        return []
    code = np.zeros(samples.size - width + 1, dtype=np.uint64)
    for place in range(width):
        code *= np.uint64(0x9E3779B97F4A7C15)
        code += bits[place : place + code.size]
    order = np.argsort(code, kind="stable")
    code = code[order]
    twin = np.flatnonzero(code[1:] == code[:-1])
    first, lag = order[twin], order[twin + 1] - order[twin]
    if first.size < BLOCK_SAMPLES - width + 1:
        return []
    lags, counts = np.unique(lag, return_counts=True)
    for shift in lags[counts >= BLOCK_SAMPLES - width + 1].tolist():
        same = np.zeros(samples.size, dtype=bool)
        same[first[lag == shift]] = True
        for begin, end in _runs(same).tolist():
            length = end - begin + width - 1
            block = samples[begin : begin + length]
            third = samples[begin + 2 * shift : begin + 2 * shift + length]
            before = samples[max(begin - shift, 0) : max(begin - shift, 0) + length]
            rich = length >= BLOCK_SAMPLES and np.median(np.abs(np.diff(block))) > STEP_CONTRAST * resolution
            if rich and not np.array_equal(block, third) and not (begin >= shift and np.array_equal(block, before)):
                values = {"start": begin * dt, "length": length * dt, "again": (begin + shift) * dt}
                return [WarningText("repeated_block", **values, decides=True)]
    return []


def _spikes(samples: np.ndarray, centred: np.ndarray, dt: float) -> list[WarningText]:
    """Return a warning if samples differ greatly from their neighbours, or if samples in strong motion are zero."""
    windows = np.lib.stride_tricks.sliding_window_view(centred, 2 * SPIKE_HALF + 1)
    beyond = np.zeros(centred.size)
    for first in range(0, len(windows), AT_ONCE):
        median = np.partition(windows[first : first + AT_ONCE], SPIKE_HALF, axis=1)[:, SPIKE_HALF]
        here = slice(first + SPIKE_HALF, first + SPIKE_HALF + median.size)
        beyond[here] = np.abs(centred[here] - median)
    peak, strongest_sample = largest(centred), int(np.argmax(np.abs(centred)))
    # A cubic through its four neighbours finds a spike of one sample; the median finds spikes of up to three samples.
    curved = np.zeros(centred.size)
    curved[2:-2] = np.abs(centred[2:-2] - (4.0 * (centred[1:-3] + centred[3:-1]) - centred[:-4] - centred[4:]) / 6.0)
    spikes = sorted({*_outliers(beyond, peak), *_outliers(curved, peak)})
    blocks = beyond[: beyond.size // SPIKE_AROUND * SPIKE_AROUND].reshape(-1, SPIKE_AROUND)
    tops = np.argmax(blocks, axis=1) + SPIKE_AROUND * np.arange(len(blocks))
    for place in tops[beyond[tops] > SPIKE_NEAR_SHARE * peak].tolist():
        first = max(place - SPIKE_AROUND, 0)
        near = beyond[first : place + SPIKE_AROUND + 1].copy()
        near[max(place - SPIKE_HALF - 1 - first, 0) : place - first + SPIKE_HALF + 2] = 0.0
        if all(abs(place - one) > SPIKE_HALF for one in spikes) and beyond[place] > SPIKE_NEAR * float(np.max(near)):
            spikes.append(place)
    before, after = samples[:-2], samples[2:]
    beside = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    lost = 1 + np.flatnonzero((samples[1:-1] == 0.0) & (beside > SPIKE_NEAR_SHARE * peak))
    spikes += lost.tolist() if lost.size >= DROPOUTS else []
    if not spikes:
        return []
    decides = any(abs(place - strongest_sample) <= SPIKE_HALF for place in spikes)
    strongest = max(spikes, key=lambda place: beyond[place])
    height = float(np.abs(centred[strongest])) / STANDARD_GRAVITY
    return [WarningText("spike", count=len(spikes), peak=height, time=strongest * dt, decides=decides)]


def _outliers(beyond: np.ndarray, peak: float) -> list[int]:
    """Return the indices of the deviations, at most `SPIKE_COUNT`, that far exceed all other deviations."""
    left, places, heights = beyond.copy(), [], []
    for _ in range(SPIKE_COUNT + 1):
        place = int(np.argmax(left))
        places.append(place)
        heights.append(float(left[place]))
        left[max(place - SPIKE_HALF - 1, 0) : place + SPIKE_HALF + 2] = 0.0
    for count in range(SPIKE_COUNT, 0, -1):
        if heights[count - 1] > max(SPIKE_FAR * heights[count], SPIKE_FAR_SHARE * peak):
            return places[:count]
    return []


def _ends(samples: np.ndarray, centred: np.ndarray, dt: float) -> list[WarningText]:
    """Return a warning for each end of a record that is in strong motion, unless the sample at this end is zero."""
    peak, length = largest(centred), min(max(round(END_LENGTH / dt), 3), centred.size)
    whole = centred[: centred.size // length * length].reshape(-1, length)
    quietest = float(np.sqrt(np.min(np.mean(whole**2, axis=1))))
    ends = (("starts_strong", centred[:length], samples[0]), ("ends_strong", centred[-length:], samples[-1]))
    found = []
    for code, end, edge in ends:
        level = float(np.sqrt(np.mean(end**2)))
        if level > max(END_SHARE * peak, END_CONTRAST * quietest) and abs(edge) > 1e-6 * peak:
            found.append(WarningText(code, share=100.0 * level / peak))
    return found
