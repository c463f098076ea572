"""Files that are dropped on the page, and the browser that opens it."""

import io
import os
from pathlib import Path

import numpy as np
import pytest
from app_page import TIME, records, zipped
from real_browser import chromium


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


@pytest.fixture(scope="session")
def driver(tmp_path_factory):
    """One browser for all tests of the page."""
    driver = chromium(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.fixture
def browser(driver):
    """The browser without cookies, which keep the language."""
    driver.execute_cdp_cmd("Network.clearBrowserCookies", {})
    return driver


@pytest.fixture(scope="session")
def axe():
    """The script of axe-core, which npm brings and the repository does not; ROCKPULSE_AXE names it."""
    script = os.environ.get("ROCKPULSE_AXE")
    if not script:
        pytest.skip("ROCKPULSE_AXE is not set: npm install axe-core, and set it to the path of axe.min.js")
    return Path(script).read_text(encoding="utf-8")
