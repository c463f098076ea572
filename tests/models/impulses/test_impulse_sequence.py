"""Fields of a sequence of impulses: ranges, lanes and scaling; and what it shows of itself."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
from rocking.impulses.sequence import sequence_response
from rocking.pictures import BLUE, RED
from rocking.response import Outcome


def test_scaling_keeps_the_ratio_and_the_counts():
    series = ImpulseSequence(0.5, 0.2, 0.1, 20.0, main_count=3, intermediate_count=4, spacing="middle")
    scaled = series.scaled([1.0, 2.0])
    assert scaled.shape == (2,)
    assert scaled.main.tolist() == [0.5, 1.0]
    assert scaled.secondary.tolist() == [0.2, 0.4]
    assert (scaled.main_count, scaled.intermediate_count, scaled.spacing) == (3, 4, "middle")
    assert series.scaled(0.0).main == 0.0


BAD = {
    "main": [-0.1, np.nan, np.inf, [[0.1]]],
    "secondary": [0.6, -0.1, np.nan],
    "interval": [0.0, np.nan],
    "duration": [0.0, np.nan],
    "main_count": [0, 1.5, [1, 0], [1.0, 2.0], [[1, 2]]],
    "intermediate_count": [3, 1, 2.0],
    "spacing": ["late"],
}


@pytest.mark.parametrize(("field", "value"), [(field, value) for field, values in BAD.items() for value in values])
def test_bad_fields_are_named(field, value):
    fields = {"main": 0.5, "secondary": 0.2, "interval": 0.1, "duration": 20.0, field: value}
    with pytest.raises(ValueError, match=field):
        ImpulseSequence(**fields)


def test_the_ends_of_the_ranges_belong_to_them():
    for main, secondary in ((0.0, 0.0), (0.5, 0.5), (0.5, 0.0)):
        series = ImpulseSequence(main, secondary, 1e-9, 1e-9, main_count=1, intermediate_count=2)
        assert (series.main, series.secondary, series.main_count, series.intermediate_count) == (main, secondary, 1, 2)
    plain = ImpulseSequence(0.5, 0.2, 0.1, np.inf)
    assert (plain.main_count, plain.intermediate_count, plain.spacing, plain.shape) == (None, None, "end", ())
    assert type(plain.main) is float


def test_an_interval_is_asked_for_where_it_has_a_meaning():
    counted = ImpulseSequence(0.5, 0.2, [np.nan, 0.1], np.inf, intermediate_count=4)
    assert np.isnan(counted.interval).tolist() == [True, False]
    assert np.isnan(ImpulseSequence(0.5, 0.2, np.nan, np.inf, spacing="continuous").interval)
    for spacing, value in (("continuous", 0.0), ("continuous", -np.inf), ("end", [0.1, np.nan]), ("middle", np.nan)):
        with pytest.raises(ValueError, match=r"^interval: expected a positive, finite time"):
            ImpulseSequence(0.5, 0.2, value, np.inf, spacing=spacing)


def test_counts_of_each_sequence_are_kept_as_whole_numbers():
    series = ImpulseSequence(0.5, [0.2, 0.3], 0.1, 20.0, main_count=np.array([2, 5], dtype=np.int8))
    assert series.main_count.tolist() == [2, 5]
    assert series.main_count.dtype == np.int64
    assert ImpulseSequence(0.5, 0.2, 0.1, 20.0, main_count=[3]).main.tolist() == [0.5]
    assert ImpulseSequence(0.5, 0.2, 0.1, 20.0, main_count=np.int64(3)).main_count == 3
    for values in (series.main_count, series.secondary, series.duration):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1
    with pytest.raises(ValueError, match="one length"):
        ImpulseSequence([0.5, 0.6], 0.2, 0.1, 20.0, main_count=[1, 2, 3])


def test_a_factor_of_a_sequence_is_finite_and_not_negative():
    series = ImpulseSequence([0.5, 0.6], 0.2, 0.1, 20.0)
    assert series.scaled([0.0, 3.0]).main == pytest.approx([0.0, 1.8])
    for factor in (np.inf, np.nan, [1.0, -1e-9], "two", [[1.0]]):
        with pytest.raises(ValueError, match=r"^factor: "):
            series.scaled(factor)


def test_fields_are_broadcast_and_cannot_be_changed():
    series = ImpulseSequence([0.1, 0.2], 0.1, 0.1, np.inf)
    assert series.interval.shape == (2,)
    with pytest.raises(ValueError, match="read-only"):
        series.main[0] = 1.0
    with pytest.raises(AttributeError):
        series.main = 1.0


def continuous(main, ratio, count):
    return ImpulseSequence(main, ratio * main, np.nan, np.inf, main_count=count, spacing="continuous")


def test_a_sequence_overturns_where_its_effective_impulse_reaches_that_of_one_impulse():  # VALIDATION V27 (D)
    generator = np.random.default_rng(27)
    count, restitution = generator.integers(1, 16, 400), generator.uniform(0.0, 1.0, 400)
    ratio = generator.uniform(0.0, 1.0, 400)
    block = Block.from_parameters(p=generator.uniform(0.5, 8.0, 400), alpha=0.15, restitution=restitution, log=False)
    critical = block.critical_impulse
    # Half of them within a thousandth of the edge, on both sides of it.
    near = np.where(
        np.arange(400) % 2, np.exp(generator.uniform(-1.0, 1.0, 400)), generator.choice([0.999, 1.001], 400)
    )
    main = near * critical / continuous(np.ones(400), ratio, count).effective_impulse(restitution)
    sequence = continuous(main, ratio, count)
    overturns = sequence.effective_impulse(restitution) >= critical
    assert 150 < np.count_nonzero(overturns) < 250
    response = sequence_response(block, sequence, table_rows=0, paired=True)
    np.testing.assert_array_equal(response.outcome == Outcome.OVERTURNS, overturns)
    # The largest over k <= N is at k = N, with the recurrence u_(k+1) = C (u_k - sigma u_1) + u_1 of F4 written out.
    for one in range(0, 400, 10):
        speed, reached = 1.0, []
        for _ in range(count[one]):
            reached.append(speed - 0.5 * ratio[one])
            speed = restitution[one] * (speed - ratio[one]) + 1.0
        assert max(reached) == reached[-1]
        assert reached[-1] * main[one] == pytest.approx(sequence.effective_impulse(restitution)[one], rel=1e-12)


def test_without_a_last_main_impulse_the_effect_is_the_limit_of_many():
    for ratio in (0.0, 0.4):
        limit = continuous(0.3, ratio, None).effective_impulse(0.9)
        assert limit == pytest.approx(continuous(0.3, ratio, 1000).effective_impulse(0.9), rel=1e-12)
    assert continuous(0.3, 0.4, None).effective_impulse(1.0) == np.inf
    assert continuous(0.3, 1.0, None).effective_impulse(1.0) == 0.15
    # Without losses impulses add up, N of them; secondary ones of the same size leave half of one.
    assert continuous(0.3, 0.0, 5).effective_impulse(1.0) == pytest.approx(1.5)
    assert continuous(0.3, 0.25, None).effective_impulse([0.0, 0.8]) == pytest.approx(
        [0.3 * (0.75 + 0.125), 0.3 * (0.75 / 0.2 + 0.125)]
    )
    assert type(continuous(0.3, 0.4, 3).effective_impulse(0.0)) is float


def test_sequences_that_have_one_effect_may_be_nothing_or_have_no_secondary_impulses():
    nothing = ImpulseSequence([0.0, 0.4], 0.0, 0.1, np.inf, main_count=2)
    assert nothing.effective_impulse(0.5) == pytest.approx([0.0, 0.6])
    with pytest.raises(ValueError, match=r"^spacing: "):
        ImpulseSequence([0.5, 0.4], [0.0, 0.1], 0.1, np.inf, main_count=2).effective_impulse(0.5)
    with pytest.raises(ValueError, match=r"^restitution: "):
        nothing.effective_impulse([0.5, 1.0 + 1e-9])


@pytest.mark.parametrize(
    ("field", "value"), [("spacing", "end"), ("duration", 20.0), ("restitution", 1.1), ("restitution", -0.1)]
)
def test_the_effect_of_other_sequences_is_no_one_number(field, value):
    arguments = {"interval": 0.1, "duration": np.inf, "main_count": 3, "spacing": "continuous"}
    restitution = value if field == "restitution" else 0.9
    if field != "restitution":
        arguments[field] = value
    with pytest.raises(ValueError, match=f"^{field}: "):
        ImpulseSequence(0.5, 0.2, **arguments).effective_impulse(restitution)


SVG = "{http://www.w3.org/2000/svg}"


def stems(sequence, colour):
    """Places and sizes of the stems of a colour [px], upwards positive, over all half-cycles."""
    root = ET.fromstring(sequence._repr_html_()).find(f".//{SVG}svg")
    found = []
    for path in root.findall(f"{SVG}path"):
        if path.attrib["stroke"] == colour:
            numbers = re.findall(r"M([\d.]+) ([\d.]+)V([\d.]+)", path.attrib["d"])
            found += [(float(at), float(base) - float(tip)) for at, base, tip in numbers]
    return np.array(found)


def test_a_sequence_is_told_in_a_line():
    told = "<ImpulseSequence I 0.7 m/s, I_s 0.28 m/s, dT 0.1 s, duration 20 s, spacing end>"
    assert repr(ImpulseSequence(0.7, 0.28, 0.1, 20.0)) == told
    several = ImpulseSequence([0.7, 0.8], 0.28, np.nan, np.inf, main_count=4, spacing="continuous")
    told = "of 2 sequences, I 0.7 to 0.8 m/s, I_s 0.28 m/s, duration inf s, main impulses 4, spacing continuous"
    assert repr(several) == f"<ImpulseSequence {told}>"


def test_impulses_alternate_and_sum_to_zero_between_main_ones():
    sequence = ImpulseSequence(0.8, 0.2, 0.1, 20.0, intermediate_count=6)
    main, secondary = stems(sequence, RED), stems(sequence, BLUE)
    assert np.sign(main[:, 1]).tolist() == [1.0, -1.0]
    assert np.sign(secondary[:, 1]).tolist() == [-1.0, 1.0] * 3 + [1.0, -1.0] * 3
    assert np.sum(secondary[:6, 1]) == pytest.approx(0.0, abs=0.7)
    assert secondary[1, 1] / main[0, 1] == pytest.approx(0.25, abs=0.01)


@pytest.mark.parametrize(
    ("spacing", "first", "last"), [("end", 1.0, 0.0), ("middle", 0.5, 0.5), ("start", 0.0, 1.0), ("open", 1.0, 1.0)]
)
def test_a_spacing_is_drawn_where_the_impulses_act(spacing, first, last):
    sequence = ImpulseSequence(0.8, 0.2, 0.1, 20.0, intermediate_count=4, spacing=spacing)
    main, secondary = stems(sequence, RED), stems(sequence, BLUE)
    interval = secondary[1, 0] - secondary[0, 0]
    assert (secondary[0, 0] - main[0, 0]) / interval == pytest.approx(first, abs=0.02)
    assert (main[1, 0] - secondary[3, 0]) / interval == pytest.approx(last, abs=0.02)


def test_a_sequence_without_secondary_impulses_has_none_drawn():
    assert stems(ImpulseSequence(0.8, 0.0, 0.1, 20.0), BLUE).size == 0
    assert stems(ImpulseSequence(0.0, 0.0, 0.1, 20.0), RED).shape == (2, 2)
