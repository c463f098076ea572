"""Epochs of the channels of station metadata."""

from types import SimpleNamespace

import pytest

from rockpulse.readers.kit.obspy_bridge import PROCESSED, _gap, _holds, _is_of, _overlap
from rockpulse.readers.source import SourceFile


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ((1, 3), (2, 4), True),
        ((1, 2), (3, 4), False),
        ((1, 2), (2, 4), True),
        ((1, None), (3, 4), True),
        ((None, None), (3, None), True),
        ((None, 2), (3, None), False),
        ((3, None), (None, 2), False),
    ],
)
def test_epochs_without_a_limit_are_open(one, other, expected):
    epochs = [SimpleNamespace(start_date=start, end_date=end) for start, end in (one, other)]
    assert _overlap(*epochs) is expected
    assert _overlap(*reversed(epochs)) is expected


@pytest.mark.parametrize(
    ("epoch", "holds"),
    [
        *((epoch, True) for epoch in ((None, None), (2, 5), (1, None), (None, 6))),
        *((epoch, False) for epoch in ((3, None), (None, 4), (3, 4), (1, 4), (3, 6))),
    ],
)
def test_an_epoch_holds_a_record_from_its_first_to_its_last_sample(epoch, holds):
    assert _holds(SimpleNamespace(start_date=epoch[0], end_date=epoch[1]), 2, 5) is holds


def channel(value=2.0, unit="m/s**2", azimuth=60.0, dip=0.0, description=None, code="HN3", stages=1):
    told = SimpleNamespace(value=value, input_units=unit)
    response = SimpleNamespace(instrument_sensitivity=told, stages=stages)
    return SimpleNamespace(code=code, azimuth=azimuth, dip=dip, description=description, response=response)


CORRECTED, RAW, EITHER = PROCESSED


@pytest.mark.parametrize(
    ("one", "other", "gap"),
    [
        ({}, {"unit": "M/S**2"}, None),
        ({}, {"azimuth": 420.0}, None),
        ({}, {"description": RAW}, None),
        ({}, {"description": "an accelerometer"}, None),
        ({}, {"value": 3.0}, ("sensitivities", "2.0 per M/S**2; 3.0 per M/S**2")),
        ({}, {"unit": "g"}, ("sensitivities", "2.0 per M/S**2; 2.0 per G")),
        ({}, {"azimuth": 61.0}, ("directions", "horizontal, azimuth 60; horizontal, azimuth 61")),
        ({}, {"dip": 90.0}, ("directions", "horizontal, azimuth 60; down")),
        ({"dip": -90.0}, {"dip": 90.0}, ("directions", "up; down")),
        ({}, {"description": CORRECTED}, ("states of processing", "raw; corrected")),
        ({"description": EITHER}, {}, ("states of processing", "unknown; raw")),
    ],
)
def test_what_two_channels_tell_differently(one, other, gap):
    assert _gap(channel(**one), channel(**other), full=False) == gap
    first, second = channel(**one), channel(**other)
    second.response = first.response if one.get("value") == other.get("value") else second.response
    if gap is None or gap[0] != "sensitivities":
        assert _gap(first, second, full=True) == gap
    else:
        assert _gap(channel(**one), channel(**other), full=True) == ("responses", "")


def test_a_station_file_is_that_of_a_record_by_its_name_or_the_callers_choice():
    def opened(**options):
        return SourceFile("b.zip!sub/XX.ABC.mseed.gz", b"", bytes, **options)

    assert _is_of("b.zip!sub/XX.ABC.xml", opened())
    assert _is_of("c\\XX.ABC.xml", opened())
    assert not _is_of("XX.DEF.xml", opened())
    assert _is_of("XX.DEF.xml", opened(chosen=True))
