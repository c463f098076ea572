"""Grids as a user may give them."""

import pytest

from rockpulse.errors import ConfigError
from rockpulse.studies.paper.options import scan_values


def test_a_scan_has_both_ends():
    assert scan_values(0.02, 0.61, 0.002)[-1] == 0.61
    assert scan_values(0.5, 0.5, 0.1) == [0.5]
    assert scan_values(0.1, 0.35, 0.1) == [0.1, 0.2, 0.3]


@pytest.mark.parametrize("given", [(0.3, 0.1, 0.1), (0.1, 0.3, 0.0), (0.0, 0.3, 0.1), (0.1, 1e9, 1e-6)])
def test_a_scan_that_is_none(given):
    with pytest.raises(ConfigError, match="scan"):
        scan_values(*given)
