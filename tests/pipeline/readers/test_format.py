"""Which files a pattern of the options of reading chooses."""

import pytest

from rockpulse.readers.format import FileSettings


@pytest.mark.parametrize(
    ("pattern", "name", "chosen"),
    [
        ("ARL [1].g3", "columns/ARL [1].g3", True),
        ("ARL [1].g3", "columns/ARL 1.g3", False),
        ("*[[]1].g3", "columns/ARL [1].g3", False),
        ("site 2\\*.g3", "site 2/ARL.g3", True),
        ("./columns/*.g3", "columns/ARL.g3", True),
        (".\\columns\\?RL.g3", "columns/ARL.g3", True),
        ("./columns/*.g3", "other/ARL.g3", False),
        ("old.zip", "old.zip!sub/ARL.g3", True),
    ],
)
def test_a_pattern_has_no_signs_but_those_that_the_manual_names(pattern, name, chosen):
    assert FileSettings(match=pattern, units="g").chooses(name) == chosen
