"""The kept inputs of the coverage-guided fuzzer on the readers; `make fuzz` makes more where atheris is installed."""

from __future__ import annotations

import fuzz_inputs
import pytest

from rockpulse.readers import FORMATS

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:obspy")


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


def test_every_sample_is_a_seed_that_keeps_the_promises():
    seeds = fuzz_inputs.seeds()
    samples = fuzz_inputs.short_samples()
    assert {seed[1:] for seed in seeds} == set(samples.values())
    assert not [found for seed in seeds if (found := fuzz_inputs.fault(seed))]
    assert max(map(len, seeds)) <= fuzz_inputs.LONGEST


def test_a_broken_promise_is_seen(monkeypatch):
    seed = fuzz_inputs.seeds()[0]

    def raise_key_error(file, options):
        raise KeyError("NPTS")

    monkeypatch.setattr(fuzz_inputs, "read_source", raise_key_error)
    assert "KeyError: 'NPTS'" in fuzz_inputs.fault(seed)
    monkeypatch.setattr(fuzz_inputs, "read_source", lambda file, options: [])
    assert fuzz_inputs.fault(seed) == "no record and no error"
    assert fuzz_inputs.fault(seed[:1]) == ""


def test_a_change_keeps_the_circumstance_and_is_the_same_for_a_seed():
    seed = fuzz_inputs.seeds()[3]
    changed = {fuzz_inputs.mutated(seed, number) for number in range(60)}
    assert len(changed) > 30
    assert {data[0] for data in changed} == {seed[0]}
    assert fuzz_inputs.mutated(seed, 5) == fuzz_inputs.mutated(seed, 5)


def test_what_is_kept_is_read_again(monkeypatch, tmp_path):
    monkeypatch.setattr(fuzz_inputs, "CORPUS", tmp_path / "kept.tar.xz")
    size = fuzz_inputs.keep_corpus([b"\x01two", b"\x00one"])
    assert size == (tmp_path / "kept.tar.xz").stat().st_size
    assert fuzz_inputs.kept_corpus() == [b"\x00one", b"\x01two"]
