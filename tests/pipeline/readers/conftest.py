"""Files of records that a test writes."""

import pytest


@pytest.fixture
def write(tmp_path, request):
    """The path of a file with some content, bytes or a text of latin-1, called as the `NAME` of the module says."""

    def written(content: bytes | str, name: str = getattr(request.module, "NAME", "record.txt")):
        path = tmp_path / name
        path.write_bytes(content.encode("latin-1") if isinstance(content, str) else content)
        return path

    return written
