"""The drawings of bodies on the first page, from what the results say of them."""

import numpy as np
import pytest
import xarray as xr
from results_tree import results_tree

from rockpulse.errors import ResultsError
from rockpulse.storage.variables.summary import SUMMARY
from rockpulse.views.report.writing import report_page


def test_a_pedestal_of_a_body_that_is_not_there_is_an_error_in_words():
    tree = results_tree()
    summary = tree["summary"].to_dataset()
    names = np.full(summary.sizes["block"], "", dtype=object)
    names[0] = "nobody"
    tree["summary"] = xr.DataTree(summary.assign(pedestal_of=SUMMARY["pedestal_of"].variable(names)))
    with pytest.raises(ResultsError, match="/summary/pedestal_of: expected the name of a body, found 'nobody'"):
        report_page(tree)
