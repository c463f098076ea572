"""A short run of the fuzzer, always the same; `make fuzz` is the long one.

The kept inputs of the coverage-guided fuzzer on the readers; `make fuzz` makes more where atheris is installed.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace

import fuzz
import fuzz_checks
import fuzz_inputs
import numpy as np
import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers import FORMATS, read_source

SEEDS = 2000


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
    assert min(counts.values()) >= 10


def test_no_detector_stumbles_over_the_beginning_of_a_file():
    short, _ = fuzz.corpus()
    for name, content in short.items():
        for row in FORMATS:
            claims = {row.detect(content[:length], name) for length in (*range(0, 60, 3), *range(60, 3000, 211))}
            assert claims <= {True, False}, row.name
            assert row.detect(b"", name) is False


def test_a_seed_is_a_case():
    assert fuzz.case(11) == fuzz.case(11) != fuzz.case(12)


def break_promises(file, options):
    (record,) = read_source(file, options)
    object.__setattr__(record, "dt", -0.01)
    return [record]


def raise_key_error(file, options):
    raise KeyError("NPTS")


def divide(file, options):
    return [np.ones(1) / np.zeros(1)]


def never_end(file, options):
    while True:
        pass


def say_nothing(file, options):
    raise RecordFormatError


@pytest.mark.parametrize(
    ("reader", "words"),
    [
        (break_promises, "expected a positive interval"),
        (raise_key_error, "KeyError: 'NPTS'"),
        (divide, "RuntimeWarning: divide by zero"),
        (never_end, "more than 0.05 s"),
        (say_nothing, "an error that does not name the file: RecordFormatError()"),
        (lambda file, options: [], "no record and no error"),
    ],
)
def test_the_fuzzer_sees_what_is_wrong(monkeypatch, reader, words):
    monkeypatch.setattr(fuzz, "TIME_LIMIT", 0.05)
    monkeypatch.setattr(fuzz, "read_source", reader)
    whole = replace(fuzz.case(0), sample="CLC090.AT2", content=fuzz.corpus()[0]["CLC090.AT2"])
    (fault,) = fuzz.faults(whole)
    assert fault.startswith("seed 0: CLC090.AT2")
    assert words in fault


def test_only_the_samples_of_these_names():
    names = {fuzz.case(seed, only=("*.acc", "*.g3")).sample for seed in range(40)}
    assert names == {"clc_H2.cor.acc", "clc_V.cor.acc", "clc_rows.g3"}


def read_otherwise(**changes):
    """A reader that gets a fact wrong and says nothing of it."""

    def read_wrongly(file, options):
        return [replace(record, warnings=(), **changes) for record in read_source(file, options)]

    return read_wrongly


@pytest.mark.parametrize("name", ["20190706031958_CLC_ap_AAD_Acc_E.asc", "clc_H2.cor.acc", "clc_end_data.txt"])
def test_what_contradicts_the_header_is_seen(monkeypatch, name):
    options = fuzz.ReadOptions(**fuzz.read_options().get(name, {}))
    whole = replace(fuzz.case(0), sample=name, content=fuzz.corpus()[0][name], beside=(), options=options)
    assert fuzz.outcome(whole) == ("silent", 1, "")
    (record,) = read_source(fuzz.SourceFile(name, whole.content, lambda: whole.content), options)
    wrong = [("step", {"dt": 0.02}), ("count", {"acceleration": record.acceleration[:-1]})]
    wrong += [("unit", {"unit_factor": 0.5 * record.unit_factor})]
    if name != "clc_end_data.txt":
        wrong += [("gal|m/s2", {"acceleration": 2.0 * record.acceleration})]
    for fact, changes in wrong:
        monkeypatch.setattr(fuzz, "read_source", read_otherwise(**changes))
        kind, _, fault = fuzz.outcome(whole)
        assert kind == "silent"
        assert re.search(f"the header states the ({fact}) ", fault)
    assert fuzz_checks.contradiction(replace(record, dt=0.02, warnings=("told",)), whole.content) == ""


def test_a_count_of_damaged_files_of_the_formats_in_words_and_numbers(capsys):
    only = ("*AAD*", "*.acc", "*.g3", "*end_data*")
    assert fuzz.count_cases(300, 5000, "", only) == 0
    assert " 300 files " in capsys.readouterr().out.splitlines()[-1]


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
