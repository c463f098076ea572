"""What a picture takes from the stored configuration."""

import xarray as xr

import rockpulse as rp
from rockpulse.views.plots.selection import settings_of


def test_units_of_single_files_are_part_of_the_stored_section():
    given = rp.RecordSettings(files=[rp.FileSettings(match="columns.txt", units="g")])
    tree = xr.DataTree(xr.Dataset(attrs={"configuration": rp.Config(records=given).as_text()}))
    assert settings_of(tree, rp.RecordSettings) == given
