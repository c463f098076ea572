"""The direction of a channel by its SEED code and the angles of its station metadata."""

import numpy as np
import pytest

from rockpulse.readers.obspy_bridge import seed_direction


@pytest.mark.parametrize(
    ("code", "azimuth", "dip", "expected"),
    [
        ("HNE", None, None, ("horizontal", 90.0)),
        ("HN1", None, None, ("horizontal", None)),
        ("HN1", 33.0, None, ("horizontal", 33.0)),
        ("HNR", None, 0.0, ("horizontal", None)),
        ("HNR", 210.0, 0.0, ("horizontal", 210.0)),
        ("HNE", 450.0, 0.0, ("horizontal", 90.0)),
        ("HNE", float("nan"), float("inf"), ("horizontal", 90.0)),
        ("HNZ", 0.0, -90.0, ("vertical", None)),
        ("HNZ", 0.0, None, ("vertical", None)),
        ("HN3", 0.0, 90.0, ("vertical", None)),
        ("HNZ", 0.0, -45.0, ("unknown", None)),
        ("HNE", 90.0, -90.0, ("unknown", None)),
        ("HN1", 90.0, -35.3, ("unknown", None)),
        ("HNZ", 0.0, 1e9, ("unknown", None)),
    ],
)
def test_the_direction_of_a_channel_code_with_angles(code, azimuth, dip, expected):
    facing = seed_direction(code, azimuth, dip)
    assert (facing.orientation, None if np.isnan(facing.azimuth) else facing.azimuth) == expected
    assert bool(facing.note) == (expected[0] == "unknown")
    assert facing.sign == (-1.0 if (facing.orientation, dip) == ("vertical", 90.0) else 1.0)


def test_a_code_that_says_vertical_outweighs_a_dip_of_zero_and_says_so():
    facing = seed_direction("HNZ", 0.0, 0.0)
    assert (facing.orientation, facing.sign) == ("vertical", 1.0)
    assert facing.note == (
        "the channel code HNZ says vertical, the header a dip of 0 degrees (-90 is up, 0 horizontal); taken as vertical"
    )


def test_an_azimuth_far_from_the_axis_that_the_code_names_is_used_and_said():
    facing = seed_direction("HNE", 0.0, 0.0)
    assert facing.azimuth == 0.0
    assert "the channel code says 'HNE', the azimuth is 0 degrees" in facing.note
    assert not seed_direction("HNE", 270.0, 0.0).note
    assert not seed_direction("HNN", 359.0, 0.0).note
