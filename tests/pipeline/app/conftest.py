"""Files that are dropped on the page, and the browser that opens it."""

import io

import numpy as np
import pytest
from app_page import TIME, records, zipped


@pytest.fixture(scope="session")
def agency(tmp_path_factory):
    """Files to drop: a zip of five records, a damaged one, and columns without a unit."""
    folder = tmp_path_factory.mktemp("agency")
    zipped(folder / "agency.zip", records())
    whole = io.BytesIO()
    zipped(whole, records(1))
    (folder / "damaged.zip").write_bytes(whole.getvalue()[: len(whole.getvalue()) // 2])
    (folder / "notes.txt").write_text("Received on Monday.\n")
    motion = 3.0 * np.exp(-(((TIME - 2.0) / 0.8) ** 2)) * np.sin(7.0 * (TIME - 2.0))
    (folder / "columns.txt").write_text("".join(f"{0.01 * n:.2f} {value:.5f}\n" for n, value in enumerate(motion)))
    return folder


@pytest.fixture
def browser(driver):
    """The browser without cookies, which keep the language."""
    driver.execute_cdp_cmd("Network.clearBrowserCookies", {})
    return driver
