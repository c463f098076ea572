"""A short run of the fuzzer, always the same; `make fuzz` is the long one."""

from collections import Counter
from dataclasses import replace

import fuzz
import fuzz_inputs
import pytest

from rockpulse.readers import FORMATS, read_source

SEEDS = 250


@pytest.mark.sweep
@pytest.mark.filterwarnings("ignore::UserWarning:obspy")
def test_damaged_files_give_records_or_a_refusal_on_every_reader():
    counts: Counter[str] = Counter()
    failures = []
    for seed in range(SEEDS):
        tried = fuzz.case(seed)
        counts[tried.sample] += 1
        failures += fuzz.faults(tried)
    assert not failures, "\n".join(failures)
    assert len(counts) > 30


@pytest.mark.sweep
def test_no_detector_stumbles_over_the_beginning_of_a_file():
    short, _ = fuzz.corpus()
    for name, content in short.items():
        for row in FORMATS:
            claims = {row.detect(content[:length], name) for length in (*range(0, 60, 3), *range(60, 3000, 211))}
            assert claims <= {True, False}, row.name
            assert row.detect(b"", name) is False


def break_promises(file, options):
    (record,) = read_source(file, options)
    object.__setattr__(record, "dt", -0.01)
    return [record]


def raise_key_error(file, options):
    raise KeyError("NPTS")


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("reader", "words"),
    [
        (break_promises, "expected a positive interval"),
        (raise_key_error, "KeyError: 'NPTS'"),
        (lambda file, options: [], "no record and no error"),
    ],
)
def test_the_fuzzer_sees_what_is_wrong(monkeypatch, reader, words):
    monkeypatch.setattr(fuzz, "read_source", reader)
    whole = replace(fuzz.case(0), sample="CLC090.AT2", content=fuzz.corpus()[0]["CLC090.AT2"])
    (fault,) = fuzz.faults(whole)
    assert fault.startswith("seed 0: CLC090.AT2")
    assert words in fault


pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:obspy")


@pytest.mark.slow
def test_kept_inputs_give_records_or_a_refusal():
    inputs = fuzz_inputs.kept_corpus()
    assert len(inputs) > 500
    faults = [found for data in inputs if (found := fuzz_inputs.fault(data))]
    assert not faults, "\n".join(faults)


def test_the_kept_inputs_are_small_and_of_every_format():
    assert fuzz_inputs.CORPUS.stat().st_size < 300_000
    heads = [data[1:] for data in fuzz_inputs.kept_corpus()]
    read = [row for row in FORMATS if row.unit != "-"]
    assert [row.name for row in read if not any(row.detect(head, "record.dat") for head in heads if head)] == []


@pytest.mark.sweep
def test_every_sample_is_a_seed_that_keeps_the_promises():
    seeds = fuzz_inputs.seeds()
    samples = fuzz_inputs.short_samples()
    assert {seed[1:] for seed in seeds} == set(samples.values())
    assert not [found for seed in seeds if (found := fuzz_inputs.fault(seed))]
    assert max(map(len, seeds)) <= fuzz_inputs.LONGEST
