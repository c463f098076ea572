"""The table of sufficiency: a column for every quality that was tested, and how many records state it."""

import numpy as np
import pytest
import xarray as xr

from rockpulse.views.text.fragility import sufficiency_tables

QUALITIES = ["duration", "strength", "magnitude", "epicentral_distance", "vs30"]


@pytest.fixture
def efficiency():
    """Two measures, two limit states; eight of ten records state a magnitude, two a distance, none a velocity."""
    p_value = np.full((2, 2, 5), 0.5)
    p_value[0, 0, 2] = 0.01
    p_value[..., 3:] = np.nan
    of = ("measure", "limit_state", "quality")
    return xr.Dataset(
        {
            "pooled_p_value": (of, p_value),
            "quality_records": ("quality", [10, 10, 8, 2, 0]),
            "quality_events": ("quality", [5, 5, 4, 1, 0]),
        },
        {"measure": ["velocity_ratio", "impulse_ratio"], "limit_state": ["0.4", "overturning"], "quality": QUALITIES},
    )


def test_a_quality_that_files_state_has_a_column_and_it_is_said_how_many_state_it(efficiency):
    (table,) = sufficiency_tables(efficiency)
    assert [heading.title for heading in table.headings] == ["", "duration", "strength", "magnitude"]
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["velocity_ratio", "0 of 2", "0 of 2", "1 of 2"],
        ["impulse_ratio", "0 of 2", "0 of 2", "0 of 2"],
    ]
    assert table.notes[0].startswith("12 tests: about 1 of them")
    (table,) = sufficiency_tables(efficiency)
    assert table.notes[1:] == (
        "magnitude: stated for 8 of 10 records (4 earthquakes).",
        "epicentral distance: stated for 2 of 10 records (1 earthquake); "
        "the values are too few for a test, or all equal.",
    )


def test_what_no_file_states_is_not_shown(efficiency):
    nothing = efficiency.copy(deep=True)
    nothing["pooled_p_value"][..., 2:] = np.nan
    nothing["quality_records"][2:] = 0
    assert sufficiency_tables(nothing) == sufficiency_tables(efficiency.isel(quality=[0, 1]))
    efficiency["pooled_p_value"][:] = np.nan
    assert sufficiency_tables(efficiency) == []
