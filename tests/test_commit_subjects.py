"""The check of commit subjects finds what breaks the rule."""

import pytest
from commit_subjects import LONGEST, faults


@pytest.mark.parametrize(
    ("subject", "words"),
    [
        ("Skip files of velocities by name", []),
        ("Pass kappa on", []),
        ("Embed fonts", []),
        ("Add " + "x" * (LONGEST - 4), []),
        ("Skips files of velocities", ["Skips"]),
        ("Skipped files of velocities", ["Skipped"]),
        ("Skipping files of velocities", ["Skipping"]),
        ("skip files of velocities", ["skip"]),
        ("The files of velocities", ["The"]),
        ("Skip files of velocities.", ["full stop"]),
        ("Skip " + "x" * (LONGEST - 4), [str(LONGEST + 1)]),
    ],
)
def test_a_plain_imperative_passes_and_a_fault_is_named(subject, words):
    found = faults(subject)
    assert len(found) == len(words)
    assert all(word in fault for word, fault in zip(words, found, strict=True))
