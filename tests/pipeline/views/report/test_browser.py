"""The page in a real browser: Chromium and its driver as Debian has them, without a window."""

import base64
import json
import re

import pytest
from many_results import many_results
from real_browser import NEEDS_BROWSER

from rockpulse.views.report.writing import report
from rockpulse.views.shared.verdict_table import factor_heading

pytestmark = [NEEDS_BROWSER, pytest.mark.sweep]

#: A4 in points.
A4 = (595, 842)


@pytest.fixture(scope="module")
def address(whole_folder):
    """Where the page with everything on it lies."""
    return (whole_folder / "report.html").as_uri()


@pytest.fixture
def page(browser, address):
    """The browser with the page freshly open."""
    from selenium.webdriver.support.ui import WebDriverWait

    browser.get("about:blank")  # else the page of the test before may be taken for this one on a busy machine
    browser.get_log("browser")
    browser.get_log("performance")
    browser.get(address)
    WebDriverWait(browser, 60).until(lambda page: page.execute_script("return document.readyState") == "complete")
    return browser


def column(page, table, number):
    """Texts of a column, those of hidden rows left out."""
    return page.execute_script(
        "return Array.from(document.getElementById(arguments[0]).tBodies[0].rows)"
        ".filter((row) => !row.hidden).map((row) => row.cells[arguments[1]].textContent)",
        table,
        number,
    )


def head(page, table, title):
    """The head of a column: its place, and what is clicked."""
    heads = page.find_elements("css selector", f"#{table} thead th")
    titles = page.execute_script(  # what is written, also where it is not laid out yet
        "return arguments[0].map((head) => Array.from(head.firstElementChild.childNodes)"
        ".filter((one) => one.nodeType === Node.TEXT_NODE).map((one) => one.textContent).join('').trim())",
        heads,
    )
    assert title in titles
    place = titles.index(title)
    return place, heads[place]


def test_no_error_and_no_request(page, address):
    page.execute_script("document.querySelector('[data-open=all]').click()")
    assert page.get_log("browser") == []
    asked = [json.loads(entry["message"])["message"] for entry in page.get_log("performance")]
    requests = [one["params"] for one in asked if one["method"] == "Network.requestWillBeSent"]
    # The browser's own start page may still be at it; what that asks for is of another document.
    urls = {one["request"]["url"] for one in requests if not one["documentURL"].startswith("chrome")}
    assert urls == {address}


def test_the_policy_stops_what_the_page_does_not_hold(page):
    page.execute_script(
        "const picture = document.createElement('img'); picture.src = 'https://example.org/x.png'; "
        "document.body.append(picture);"
        "const script = document.createElement('script'); script.textContent = 'window.ran = 1'; "
        "document.body.append(script);"
    )
    assert page.execute_script("return window.ran === undefined")
    said = " ".join(entry["message"] for entry in page.get_log("browser"))
    assert said.count("Content Security Policy") == 2


def test_every_figure_is_visible_with_everything_open(page):
    page.execute_script("document.querySelector('[data-open=all]').click()")
    sizes = page.execute_script(
        "return Array.from(document.querySelectorAll('figure:not(.card figure)'), (figure) => {"
        " const svg = figure.querySelector('svg'); if (!svg) return [figure.textContent, 0, 0];"
        " svg.scrollIntoView(); const box = svg.getBoundingClientRect();"
        " return [svg.checkVisibility() ? '' : 'hidden', box.width, box.height]; })"
    )
    # The spectra, three maps, two motions (nothing overturns the third body), four accelerograms, the site, the curves.
    assert len(sizes) == 14
    for words, width, height in sizes:
        assert words == ""
        assert width > 400
        assert height > 90


def test_sorting_by_mouse_puts_infinity_above_and_the_unknown_last(page):
    place, one = head(page, "answers", factor_heading("factor_10"))
    values = page.execute_script(
        "const cell = document.querySelector(`#answers tbody tr td:nth-child(${arguments[0] + 1})`);"
        "cell.dataset.v = 'nan'; cell.textContent = '-'; return null",
        place,
    )
    one.find_element("css selector", "[role=button]").click()
    assert one.get_attribute("aria-sort") == "ascending"
    up = column(page, "answers", place)
    one.find_element("css selector", "[role=button]").click()
    assert one.get_attribute("aria-sort") == "descending"
    down = column(page, "answers", place)
    assert values is None
    assert up[-1] == down[-1] == "-"
    assert up[-2] == down[0] == ">10"

    def known(texts):
        return [float(text.split()[0].strip("!")) for text in texts if text not in ("-", ">10")]

    assert known(up) == sorted(known(up))
    assert known(down) == sorted(known(up), reverse=True)
    assert len(known(up)) > 3


def test_sorting_by_keyboard_and_by_words(page):
    from selenium.webdriver.common.keys import Keys

    place, one = head(page, "answers", "body")
    one.find_element("css selector", "[role=button]").send_keys(Keys.ENTER)
    names = column(page, "answers", place)
    assert names == sorted(names)
    other = head(page, "answers", factor_heading("factor_10"))[1]
    other.find_element("css selector", "[role=button]").send_keys(Keys.SPACE)
    assert one.get_attribute("aria-sort") is None
    assert other.get_attribute("aria-sort") == "ascending"


def test_the_filter_takes_all_of_its_words(page):
    field = page.find_element("css selector", "input[data-filters=answers]")
    place = head(page, "answers", "body")[0]
    field.send_keys("STELE burst2")
    assert column(page, "answers", place) == ["stele"]
    assert page.find_element("css selector", "#all-answers output").text == "1 / 12"
    field.clear()
    field.send_keys("no such words")
    assert column(page, "answers", place) == []


def test_on_a_phone_nothing_of_the_first_page_is_scrolled_sideways(page):
    page.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride", {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    )
    try:
        wide = page.execute_script(
            "return Array.from(document.querySelectorAll('#verdict *'), (one) => [one.tagName, one.scrollWidth, "
            "one.getBoundingClientRect().right]).filter(([tag, width, right]) => width > 391 || right > 391)"
        )
        assert wide == []
        assert page.execute_script("return document.documentElement.scrollWidth") <= 390
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_it_prints_on_a4(page):
    printed = page.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})
    pdf = base64.b64decode(printed["data"])
    boxes = [tuple(map(round, map(float, box.split()[2:]))) for box in re.findall(rb"/MediaBox \[([\d. ]+)\]", pdf)]
    assert len(boxes) > 8
    # Chromium leaves a button out of a head that it repeats on the next page.
    assert page.find_elements("css selector", "thead button, thead input") == []
    for box in boxes:
        assert tuple(sorted(box)) == pytest.approx(A4, abs=1)


@pytest.mark.slow
def test_two_hundred_records_on_twenty_bodies_open_in_a_second_and_a_half(browser, tmp_path):
    path = report(many_results(200, 20, samples=12000), tmp_path / "report.html")
    assert path.stat().st_size < 15e6
    browser.get(path.as_uri())  # the first one warms the disk
    browser.get(path.as_uri())
    milliseconds = browser.execute_script("return performance.getEntriesByType('navigation')[0].loadEventEnd")
    assert milliseconds < 1500.0
    assert browser.get_log("browser") == []
    # A link into a closed part opens it.
    browser.execute_script("location.hash = '#record-150'")
    part = browser.find_element("id", "record-150")
    assert part.get_attribute("open")
    assert part.find_element("tag name", "table").is_displayed()
