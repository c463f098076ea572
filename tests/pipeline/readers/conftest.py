"""Files of records that a test writes."""

import pytest


@pytest.fixture
def write(tmp_path):
    """The path of a file with some content, called record.txt by default."""

    def written(content: bytes, name: str = "record.txt"):
        path = tmp_path / name
        path.write_bytes(content)
        return path

    return written
