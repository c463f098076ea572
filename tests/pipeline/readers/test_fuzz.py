"""A short run of the fuzzer, always the same; `make fuzz` is the long one."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import fuzz
import numpy as np
import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers import FORMATS, read_source

SEEDS = 2000


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
