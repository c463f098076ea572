"""`calibrate_response`: known sequences come back, records are reproduced, and a share of the blocks is covered."""

from dataclasses import replace

import numpy as np
import pytest

from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block, ImpulseSequence, Outcome, sequence_response
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record
from rockpulse.sequences import response as module
from rockpulse.sequences import response_posterior, response_search
from rockpulse.sequences.response import calibrate_response, envelope, enveloping_main
from rockpulse.sequences.response_posterior import deviance_threshold
from rockpulse.sequences.response_targets import ResponseTargets, block_family, motion_family

NAMES = ("main", "ratio", "interval", "main_count")


def thinned(blocks, every):
    """Every so many of the blocks."""
    return Block.from_parameters(blocks.p[::every], blocks.alpha_c[::every], blocks.restitution[::every])


THIRD = thinned(block_family(), 3)


@pytest.fixture(scope="module")
def quick():
    """A search of fewer rounds."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in (("GENERATIONS", 8), ("SURVEY", 256), ("ROUNDS", 8)):
            patch.setattr(response_search, name, value)
        patch.setattr(response_posterior, "ADDED", 0)
        yield


def response(blocks, sequence):
    return sequence_response(blocks, sequence, table_rows=0, threads=1)


def fit_sequence(blocks, peaks, outcomes, start=None, spacing="end", confidence=0.9, seed=0, name=""):
    targets = ResponseTargets(blocks, peaks, outcomes)
    return module.fit_sequence(targets, start, spacing, confidence, np.random.default_rng(seed), 1, name)


def recovered(seed, counts, every=1):
    """A sequence from the middle of what is searched, responses of its family with noise of 10 %, and the fit."""
    rng = np.random.default_rng(seed)
    main, interval = np.exp(rng.uniform(np.log([0.1, 0.1]), np.log([0.5, 0.5])))
    truth = {"main": main, "ratio": rng.uniform(0.2, 0.8), "interval": interval}
    truth["main_count"] = int(rng.choice(counts))
    sequence = ImpulseSequence(main, truth["ratio"] * main, interval, np.inf, main_count=truth["main_count"])
    blocks = thinned(motion_family(lambda pool: response(pool, sequence)), every)
    answer = response(blocks, sequence)
    peaks = answer.peak_rotation_ratio * np.exp(0.1 * rng.standard_normal(blocks.shape))
    return truth, fit_sequence(blocks, peaks, answer.outcome, seed=seed)


def coverage(cases):
    """Share of the cases whose interval holds the truth, by parameter; of dT where it is not flat."""
    covered = {}
    for name in NAMES:
        told = [
            (truth[name], *fit.intervals[name]) for truth, fit in cases if name != "interval" or name not in fit.flat
        ]
        covered[name] = float(np.mean([low <= value <= high for value, low, high in told]))
    return covered


def relative_widths(cases):
    """Width of the interval of I over I."""
    return np.array([np.diff(fit.intervals["main"])[0] / fit.parameters["main"] for _, fit in cases])


def promised(cases):
    """Mean probability that the posteriors give to the intervals of the number of main impulses."""
    held = []
    for _, fit in cases:
        low, high = fit.intervals["main_count"]
        held.append(sum(share for count, share in fit.main_counts.items() if low <= count <= high))
    return np.mean(held)


@pytest.mark.sweep
def test_five_sequences_with_noise_are_recovered():
    cases = [recovered(seed, counts=(2, 3), every=3) for seed in range(5)]
    # At 0.9 fewer than 3 of 5 have a probability of 0.9 %.
    assert all(share >= 0.6 for share in coverage(cases).values())
    assert np.median(relative_widths(cases)) < 0.25
    assert np.median([fit.spread for _, fit in cases]) == pytest.approx(0.1, abs=0.015)


@pytest.mark.slow
def test_a_hundred_sequences_with_noise_are_recovered():
    # calibrate_response finds 4 to 29 main impulses on strong records, 22 of 23 within the 20 that are searched;
    # calibrate, which looks at half-waves, 2 to 35.
    cases = [recovered(seed, counts=range(2, 21)) for seed in range(100)]
    found = coverage(cases)
    assert all(0.83 <= share <= 0.97 for share in found.values())
    held = promised(cases)
    assert found["main_count"] == pytest.approx(held, abs=3.0 * np.sqrt(held * (1.0 - held) / 100.0))
    # 99: a motion too weak to overturn any block leaves 0.251.
    assert np.mean(relative_widths(cases) < 0.25) >= 0.98


def test_without_noise_the_parameters_come_back_and_a_start_that_is_the_truth_is_no_worse(quick):
    sequence = ImpulseSequence(0.25, 0.125, 0.2, 8.0, main_count=3)
    answer = response(THIRD, sequence)
    fit = fit_sequence(THIRD, answer.peak_rotation_ratio, answer.outcome, start=sequence)
    assert fit.parameters["main_count"] == 3
    assert fit.parameters["main"] == pytest.approx(0.25, rel=0.01)
    assert fit.parameters["ratio"] == pytest.approx(0.5, abs=0.01)
    assert fit.start_misfit == pytest.approx(0.0, abs=1e-9)
    assert fit.misfit < 0.01
    assert np.array_equal(np.isinf(fit.peaks), answer.outcome == Outcome.OVERTURNS)


def test_one_main_impulse_says_that_impulse_and_ratio_are_one(quick):
    # N = 1 in the continuous limit: the response knows I (1 - sigma/2) only.
    sequence = ImpulseSequence(0.5, 0.2, np.nan, np.inf, main_count=1, spacing="continuous")
    answer = response(THIRD, sequence)
    rng = np.random.default_rng(2)
    peaks = answer.peak_rotation_ratio * np.exp(0.1 * rng.standard_normal(THIRD.shape))
    fit = fit_sequence(THIRD, peaks, answer.outcome, spacing="continuous")
    assert np.isnan(fit.parameters["interval"])
    assert any("main and ratio are not told apart" in remark for remark in fit.remarks)
    assert any("infinitely many secondary impulses" in remark for remark in fit.remarks)
    # More main impulses with I_s/I next to 1 are the same: only v I_1c is known, here at C = 0.8.
    ratio, more = fit.parameters["ratio"], range(1, int(fit.parameters["main_count"]))
    known = fit.parameters["main"] * (1.0 - 0.5 * ratio + (1.0 - ratio) * sum(0.8**j for j in more))
    assert known == pytest.approx(0.5 * 0.8, rel=0.03)
    low, high = fit.intervals["main"]
    assert low <= 0.5 <= high


@pytest.fixture(scope="module")
def strong(ridgecrest):
    """One channel of Christmas Canyon, conditioned."""
    return condition(next(channel for channel in ridgecrest if channel.station == "CCC" and channel.azimuth == 90.0))


@pytest.fixture(scope="module")
def fit(strong, quick):
    return calibrate_response(strong, THIRD, threads=1)


def test_a_record_is_reproduced_better_than_by_its_statistics(fit, strong):
    assert fit.record_id == strong.id
    assert fit.misfit < 0.5 * fit.start_misfit
    assert fit.start_unsafe_share == 0.0
    assert fit.sequence.duration == fit.start.duration
    missed = fit.targets.overturned & np.isfinite(fit.peaks)
    called = (fit.targets.outcomes == Outcome.ROCKS) & np.isinf(fit.peaks)
    assert np.count_nonzero(missed | called) <= 0.1 * fit.peaks.size


def test_what_is_reported_is_that_of_the_sequence(fit):
    peaks = response(THIRD, fit.sequence).peak_rotation_ratio
    assert np.array_equal(peaks, fit.peaks)
    assert fit.sequence.secondary == pytest.approx(fit.parameters["ratio"] * fit.sequence.main)
    assert fit.unsafe_share == fit.targets.short_of(peaks[np.newaxis])[0]
    for name, (values, deviance) in fit.profiles.items():
        assert np.all(np.diff(values) > 0.0), name
        assert np.all(deviance >= 0.0)
        assert deviance.min() == pytest.approx(0.0, abs=0.5)
    assert sum(fit.main_counts.values()) == pytest.approx(1.0)
    for name in NAMES:
        assert fit.intervals[name][0] <= fit.parameters[name] <= fit.intervals[name][1]


@pytest.mark.sweep
def test_the_answer_depends_neither_on_threads_nor_on_the_hour(fit, strong):
    again = calibrate_response(strong, THIRD, threads=2)
    assert again.parameters == fit.parameters
    assert again.intervals == fit.intervals


def test_a_vertical_acceleration_reaches_the_targets(monkeypatch, strong):
    seen = {}

    def targets(record, blocks, smallest, threads, vertical):
        seen["vertical"] = vertical
        raise RecordRefused("seen")

    monkeypatch.setattr("rockpulse.sequences.response.recorded_targets", targets)
    up = np.zeros(strong.npts)
    with pytest.raises(RecordRefused, match="seen"):
        calibrate_response(strong, THIRD, vertical=up)
    assert seen["vertical"] is up


def test_the_envelope_is_the_smallest_impulse_that_covers_the_share(fit):
    for share in (0.84, 1.0):
        over = envelope(fit, share, threads=1)
        assert over.form == "enveloping"
        assert 1.0 - over.unsafe_share >= share - 1e-12
        below = response(THIRD, over.sequence.scaled(1.0 - 1e-4)).peak_rotation_ratio
        assert 1.0 - fit.targets.short_of(below[np.newaxis])[0] < share
        assert over.parameters["ratio"] == fit.parameters["ratio"]
        assert over.sequence.secondary / over.sequence.main == pytest.approx(fit.sequence.secondary / fit.sequence.main)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"form": "best"}, "form"),
        ({"spacing": "even"}, "spacing"),
        ({"share": 0.0}, "share"),
        ({"share": 1.01}, "share"),
        ({"confidence": 1.0}, "confidence"),
        ({"confidence": 0.0}, "confidence"),
        ({"smallest": 2.0}, "smallest"),
    ],
)
def test_options_out_of_range_are_named(strong, options, message):
    with pytest.raises(ConfigError, match=message):
        calibrate_response(strong, THIRD, **options)


def test_a_motion_that_moves_no_block_is_refused():
    weak = Record(0.05 * np.sin(np.arange(400.0)), dt=0.01, id="weak")
    with pytest.raises(RecordRefused, match="weak: the motion moves none of 400 blocks"):
        calibrate_response(weak, threads=1)


PEAKS = np.linspace(0.1, 0.8, 12)
TWELVE = Block.from_parameters(np.linspace(1.0, 3.0, 12), 0.2, 0.9)
ROCK = np.full(12, Outcome.ROCKS)


@pytest.fixture
def short(monkeypatch):
    """A search of few candidates, and two rounds of samples."""
    for name, value in (("GENERATIONS", 1), ("SURVEY", 64), ("ROUNDS", 1)):
        monkeypatch.setattr(response_search, name, value)
    for name, value in (("TEMPERED", (0.5, 1.0)), ("ADDED", 0)):
        monkeypatch.setattr(response_posterior, name, value)


def test_a_fit_without_a_start_says_what_its_sequence_does(short):
    plain = fit_sequence(TWELVE, PEAKS, ROCK)
    other = fit_sequence(TWELVE, PEAKS, ROCK, seed=1, confidence=0.5, name="one")
    assert plain.intervals != other.intervals
    assert (other.confidence, other.record_id, other.form) == (0.5, "one", "fit")
    assert np.isnan([plain.start_misfit, plain.start_unsafe_share]).all()
    assert plain.start is None
    for fit in (plain, other):
        peaks = response(TWELVE, fit.sequence).peak_rotation_ratio
        assert fit.peaks.tolist() == peaks.tolist()
        assert fit.misfit == pytest.approx(np.sqrt(np.mean(fit.targets.residuals(peaks[np.newaxis]) ** 2)))
        assert fit.unsafe_share == np.mean(peaks < PEAKS)


def test_the_search_looks_as_far_as_four_thresholds_and_a_parameter_is_flat_up_to_one(monkeypatch, short):
    confidence = 0.6
    threshold = deviance_threshold(12, confidence)
    seen, explore = {}, module.explore

    def spied(targets, space, point, enough, rng, threads):
        seen.update(point=point, enough=enough)
        return explore(targets, space, point, enough, rng, threads)

    ends = {"ratio": (True, True), "interval": (True, True), "main_count": (True, False)}
    just = {"ratio": threshold, "interval": threshold * 1.001, "main_count": 0.0, "main": 0.0}
    monkeypatch.setattr(module, "explore", spied)
    monkeypatch.setattr(response_posterior, "flat_ends", lambda *_: ends)
    monkeypatch.setattr(
        response_posterior,
        "profiles",
        lambda *_: {name: (np.arange(2.0), np.array([0.0, end])) for name, end in just.items()},
    )
    still = ImpulseSequence(0.0, 0.0, 0.2, 9.0, main_count=3)
    for start, there in ((None, False), (still, False), (ImpulseSequence(0.5, 0.2, 0.2, 9.0, main_count=3), True)):
        fit = fit_sequence(TWELVE, PEAKS, ROCK, start=start, confidence=confidence)
        assert fit.flat == ("ratio",)
        assert seen["enough"] == pytest.approx(4.0 * threshold)
        assert (seen["point"] is not None) is there
        assert np.isfinite(fit.start_misfit) == np.isfinite(fit.start_unsafe_share) == (start is not None)
    assert fit.start_unsafe_share == np.mean(response(TWELVE, start).peak_rotation_ratio < PEAKS)


def test_family_seed_and_form_are_those_that_are_asked_for(monkeypatch, fit, strong):
    fitted, shares = [], []
    monkeypatch.setattr(module, "fit_sequence", lambda *asked: fitted.append(asked) or fit)
    monkeypatch.setattr(module, "recorded_family", lambda record, threads, vertical: THIRD)
    monkeypatch.setattr(module, "envelope", lambda fit, share, threads: shares.append(share) or fit)
    assert calibrate_response(strong, THIRD) is fit
    own = calibrate_response(strong)
    assert own.remarks[0].startswith(f"{THIRD.shape[0]} blocks chosen about the edge of overturning")
    assert own.remarks[1:] == fit.remarks
    assert shares == []
    calibrate_response(strong, THIRD, form="enveloping", seed=1)
    calibrate_response(replace(strong, id="other"), THIRD, form="enveloping", share=1.0)
    assert shares == [0.84, 1.0]
    first = [asked[4].random() for asked in fitted]  # the generator: of the seed and the record
    assert first[0] == first[1]
    assert len(set(first)) == 3


def test_the_envelope_says_its_factor_and_whether_cover_is_monotonic(monkeypatch, fit):
    over = envelope(fit, 0.84, threads=1)
    factor = over.sequence.main / fit.sequence.main
    assert over.remarks[-1] == (
        f"the enveloping main impulse is {factor:.3g} times the fitted one and covers 84% of the blocks"
    )
    peaks = response(THIRD, over.sequence).peak_rotation_ratio
    assert over.peaks.tolist() == peaks.tolist()
    assert over.misfit == fit.targets.misfit(peaks[np.newaxis])[0]
    assert over.parameters == fit.parameters | {"main": float(over.sequence.main)}
    monkeypatch.setattr(module, "enveloping_main", lambda *_: (1.5, True))
    again = envelope(fit, 0.84, threads=1)
    assert again.sequence.main == pytest.approx(1.5 * fit.sequence.main)
    assert again.remarks[-1].endswith("cover is not monotonic in the impulse")


BLOCKS = Block.from_parameters(np.linspace(1.0, 3.0, 10), np.linspace(0.1, 0.3, 10)[::-1], 0.9)
TEN_PEAKS = np.array([0.3, 0.1, 0.8, 0.5, 0.2, 0.7, np.inf, 0.02, 0.0, 0.4])
OUTCOMES = np.where(np.isinf(TEN_PEAKS), Outcome.OVERTURNS, np.where(TEN_PEAKS > 0.0, Outcome.ROCKS, Outcome.AT_REST))
TARGETS = ResponseTargets(BLOCKS, TEN_PEAKS, OUTCOMES)
ONE = ImpulseSequence(0.31, 0.0, 0.2, np.inf, main_count=1)


@pytest.mark.parametrize(("share", "covered"), [(1.0, 9), (0.84, 8), (0.5, 5), (5.0 / 9.0, 5), (0.56, 6), (0.1, 1)])
def test_of_one_impulse_the_factor_is_that_of_the_block_which_is_just_covered(share, covered):
    """Eq. 6: the peak x takes I/I_1c of sqrt(1 - (1 - x)^2), and overturning takes 1; the block at rest is silent."""
    taken = np.sqrt(1.0 - (1.0 - np.minimum(TEN_PEAKS, 1.0)) ** 2) * BLOCKS.critical_impulse / ONE.main
    expected = np.sort(np.delete(taken, 8))[covered - 1]
    factor, again = enveloping_main(TARGETS, ONE, share, threads=1)
    assert expected * (1.0 - 1e-9) <= factor <= expected * (1.0 + 1.01e-6)
    assert again is False


def covering(monkeypatch, inside):
    """The factor on ONE where a motion covers all targets at factors inside of a range, and none elsewhere."""
    seen = []

    def reached(targets, sequence, threads):
        factors = np.asarray(sequence.main) / ONE.main
        seen.append(factors)
        peaks = np.where(inside(factors), np.inf, 0.0)
        return np.repeat(peaks[:, np.newaxis], targets.blocks.shape[0], axis=1)

    monkeypatch.setattr(ResponseTargets, "reached", reached)
    return enveloping_main(TARGETS, ONE, 1.0), seen


def test_the_scan_goes_from_a_thousandth_of_the_least_to_four_times_the_largest_critical_impulse(monkeypatch):
    critical = np.delete(BLOCKS.critical_impulse, 8) / ONE.main  # of those that are not silent
    (factor, again), seen = covering(monkeypatch, lambda factors: factors > 0.0)
    assert (factor, again) == (pytest.approx(1e-3 * critical.min()), False)
    assert seen[0][-1] == pytest.approx(4.0 * critical.max())
    assert np.diff(np.log(seen[0])) == pytest.approx(np.log(seen[0][1] / seen[0][0]))
    assert len(seen) == 1  # nothing is left to refine
    last = seen[0][-1]
    (factor, _), _ = covering(monkeypatch, lambda factors: factors >= 0.9999 * last)
    assert factor == pytest.approx(0.9999 * last, rel=1.01e-6)


def test_larger_impulses_that_cover_less_are_told_and_the_first_edge_counts(monkeypatch):
    def bands(factors):
        return ((factors >= 0.7) & (factors < 0.8)) | (factors > 0.9)

    (factor, again), _ = covering(monkeypatch, bands)
    assert 0.7 <= factor <= 0.7 * (1.0 + 1.01e-6)
    assert again is True
