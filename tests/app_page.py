"""A page of ``rockpulse app`` in a process of its own, files to drop on it, and its window in a browser."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from record_writers import at2

TIME = 0.01 * np.arange(400)
#: Longest time that a test waits for something on the page [s].
PATIENCE = 150.0


@dataclass(frozen=True)
class Served:
    """The process of the page, its address with the token, and its folder."""

    process: subprocess.Popen
    address: str
    folder: Path

    @property
    def token(self):
        """The token of the address."""
        return self.address.partition("token=")[2]

    @property
    def port(self):
        """The port of the server."""
        return int(self.address.partition("127.0.0.1:")[2].partition("/")[0])


@contextlib.contextmanager
def served(folder, *options):
    """The page of a folder; after the test Ctrl-C has ended it without an error."""
    command = [sys.executable, "-m", "rockpulse", "app", str(folder), "--no-browser", *options]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    try:
        first = process.stdout.readline().strip()
        assert "/?token=" in first, first + process.stdout.read()
        yield Served(process, first, Path(folder))
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=30)
        print(said)  # shown with a failure
    assert process.returncode in (0, -signal.SIGKILL), said
    assert "Traceback" not in said, said


def records(count=5):
    """Members of a zip: short records of as many earthquakes, and a text that is none."""
    found = {"readme.txt": b"Records of an agency.\n"}
    for number in range(count):
        motion = (0.25 + 0.05 * number) * np.exp(-(((TIME - 2.0) / 0.8) ** 2)) * np.sin(2.0 * np.pi * TIME)
        found[f"quake{number}.AT2"] = at2(
            motion, title=f"Quake {'ABCDE'[number] * 3}, {number + 1}/5/1980, Bagnoli, 270"
        )
    return found


def zipped(path, members):
    """The path of a zip with some members."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


class Window:
    """The page in the browser, by what a user sees."""

    def __init__(self, browser, served):
        self.browser, self.served = browser, served

    def open(self, address=None):
        self.browser.get("about:blank")
        self.browser.get_log("browser")
        self.browser.get_log("performance")
        self.browser.get(address or self.served.address)
        self.wait(lambda: self.find("#results h2"))
        return self

    def wait(self, seen, expected=""):
        from selenium.common.exceptions import (
            ElementClickInterceptedException,
            ElementNotInteractableException,
            StaleElementReferenceException,
            TimeoutException,
        )
        from selenium.webdriver.support.ui import WebDriverWait

        moving = (ElementClickInterceptedException, ElementNotInteractableException)
        ignored = (StaleElementReferenceException, *moving, IndexError)
        waiting = WebDriverWait(self.browser, PATIENCE, 0.1, ignored)
        try:
            return waiting.until(lambda _: seen())
        except TimeoutException:
            pytest.fail(f"expected {expected or 'something else'} on\n{self.find('body')[0].text}")

    def find(self, selector):
        return self.browser.find_elements("css selector", selector)

    def text(self, part):
        return self.find(f"#{part}")[0].text

    def says(self, part, *words):
        self.wait(lambda: all(word in self.text(part) for word in words), words)

    def drop(self, *paths):
        self.find("#records input[type=file]")[0].send_keys("\n".join(map(str, paths)))

    def choose_folder(self, path):
        self.find("#records input[webkitdirectory]")[0].send_keys(str(path))

    def drag(self, path):
        """Drop a file or a folder on the field of records, as with the mouse."""
        at = self.find("#records .drop")[0].rect
        data = {"items": [], "files": [str(path)], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            event = {"type": kind, "x": at["x"] + 50, "y": at["y"] + 20, "data": data}
            self.browser.execute_cdp_cmd("Input.dispatchDragEvent", event)

    def press(self, part, label):
        def pressed():
            found = [one for one in self.find(f"#{part} button") if one.text == label and one.is_enabled()]
            return found and self.browser.execute_script("arguments[0].click(); return true", found[0])

        self.wait(pressed)

    def click(self, selector):
        found = self.wait(lambda: self.find(selector))
        self.browser.execute_script("arguments[0].click()", found[0])

    def field(self, part, label, number=-1):
        return self.wait(lambda: self.find(f'#{part} input[aria-label="{label}"]'))[number]

    def type(self, part, label, text, number=-1):
        field = self.field(part, label, number)
        field.send_keys("\ue009a\ue000", text)  # Ctrl+A

    def choose(self, part, label, option):
        def opened():
            box = self.find(f'#{part} [role=combobox][aria-label="{label}"]')[0]
            self.browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", box)
            return box.click() or True  # raises an error, and is tried again, until it is there

        self.wait(opened)
        self.wait(lambda: [one for one in self.find("[role=option]") if one.text == option])[0].click()

    def console(self):
        """What the console says, less requests that a test has refused on purpose."""
        return [one["message"] for one in self.browser.get_log("browser") if one["level"] in ("SEVERE", "WARNING")]

    def hosts(self):
        """Hosts that the page has asked for something."""
        asked = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        found = [one["params"] for one in asked if one["method"] == "Network.requestWillBeSent"]
        urls = [one["request"]["url"] for one in found if not one["documentURL"].startswith("chrome")]
        return {url.split("/")[2] for url in urls if not url.startswith(("data:", "blob:"))}


def add(window, count):
    """Add a body to a page, which then has `count`."""
    window.press("bodies", "Add a body")
    window.wait(lambda: len(window.find(".body-row")) == count)


def walls(window):
    """Two bodies, the first one typed in millimetres and corrected."""
    add(window, 1)
    window.type("bodies", "name", "wall")
    window.type("bodies", "width [m]", "550")
    window.type("bodies", "height [m]", "4200")
    window.says("bodies", "are these millimetres?", "must be confirmed")
    assert "To be corrected first" in window.text("results")
    window.press("bodies", "Confirm this size")
    window.wait(lambda: "millimetres" not in window.text("bodies"))
    assert window.find("#bodies [aria-expanded=true]") == []
    window.type("bodies", "width [m]", "0.3")
    window.type("bodies", "height [m]", "2,4")
    window.says("bodies", "uplift PGA 0.125 g")
    add(window, 2)
    window.type("bodies", "name", "pier")
    window.type("bodies", "width [m]", "wide")
    window.says("bodies", "expected a positive number of metres")
    window.type("bodies", "width [m]", "1")
    window.type("bodies", "height [m]", "4")
    window.says("bodies", "uplift PGA 0.25 g")
