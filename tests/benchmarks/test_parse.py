"""The benchmark of the readers compares like with like."""

import io

import numpy as np
import pytest

from rockpulse.readers import read

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def layouts(parse):
    return parse.layouts()


def test_every_layout_is_a_megabyte_and_holds_the_numbers_that_loadtxt_gets(layouts):
    for name, (content, numbers, options) in layouts.items():
        assert 0.9e6 < len(content) < 1.1e6, name
        records = read(io.BytesIO(content), **options)
        values = numbers[:, -len(records) :] if numbers.ndim == 2 else numbers[:, None]
        assert [record.npts for record in records] == [len(values)] * len(records), name
        for record, column in zip(records, values.T, strict=True):
            found = record.acceleration / record.unit_factor
            offset = np.mean(column) if record.format == "knet" else 0.0
            assert np.allclose(found, column - offset, rtol=1e-4, atol=1e-6), name


def test_a_megabyte_is_read_in_time(parse, layouts):
    content, _, options = layouts["8F9.6, touching"]
    # Twice the limit, for machines that do other things.
    assert parse.median(3, lambda: read(io.BytesIO(content), **options)) < 2.0 * parse.LIMIT
