"""Draws the pictures of docs/tutorials/app.md: the page with records and bodies, and with results."""

import base64
import io
import sys
import tempfile
import time
from pathlib import Path

from app_page import Window, records, served, walls, zipped
from PIL import Image
from real_browser import chromium

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
#: Width of the window, and height of each picture [px].
WIDTH, HEIGHT = 1000, 1225


def picture(browser, name, first):
    """Write what the window shows from an element on, with as few colours as a diagram has."""
    browser.execute_script(f"document.querySelector('{first}').scrollIntoView()")
    time.sleep(1.5)  # what is out of sight is not drawn
    top = browser.execute_script(f"return document.querySelector('{first}').getBoundingClientRect().top + scrollY")
    clip = {"x": 0, "y": max(top - 10, 0), "width": WIDTH, "height": HEIGHT, "scale": 1}
    browser.execute_script("document.querySelector('.steps').style.position = 'static'; document.activeElement.blur()")
    shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": clip})["data"]
    image = Image.open(io.BytesIO(base64.b64decode(shot))).convert("RGB").quantize(64)
    image.save(IMAGES / name, optimize=True)
    print(IMAGES / name)


def main():
    """Go the whole way on records of five earthquakes, in a folder of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "basilica")
        browser = chromium(Path(name, "profile"))
        browser.set_window_size(WIDTH, 1400)
        try:
            with served(folder) as page:
                window = Window(browser, page).open()
                window.drop(zipped(Path(name, "agency.zip"), records()))
                window.says("records", "5 channels")
                walls(window)
                window.choose("site", "given by", "PGA")
                window.type("site", "value", "0.3")
                picture(browser, "app.png", "body")
                window.press("results", "Assess")
                window.wait(lambda: window.find("#results iframe"))
                window.wait(lambda: window.find("#results iframe")[0].size["height"] > 1000)
                picture(browser, "app-results.png", "#results")
        finally:
            browser.quit()


if __name__ == "__main__":
    sys.exit(main())
