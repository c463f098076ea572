"""The part to explore in a real browser: it moves and stops, by mouse and by keyboard, and draws what it holds."""

import base64
import json
import shlex
import time

import numpy as np
import pytest
from many_results import many_results
from real_browser import NEEDS_BROWSER

from rockpulse.cli import main
from rockpulse.views.report.writing import report

pytestmark = [NEEDS_BROWSER, pytest.mark.sweep]


@pytest.fixture
def page(browser, whole_folder):
    """The browser with the page freshly open at the part to explore, and nothing said in its console afterwards."""
    browser.get("about:blank")  # else the same address is no new page
    browser.get_log("browser")
    browser.get((whole_folder / "report.html").as_uri() + "#explore")
    yield browser
    assert browser.get_log("browser") == []


def part(page, name):
    return page.find_element("css selector", f"#explorer [data-part={name}]")


def angle(page):
    """The turn of the drawn body [degrees]."""
    found = part(page, "stage").find_element("tag name", "g").get_attribute("transform")
    return float(found.removeprefix("rotate(").split()[0])


def data(page):
    return json.loads(page.find_element("id", "explorer").get_attribute("data-motions"))


def rotation_of(step):
    """The middle of each column of the rotation at a factor, as a share of the critical angle."""
    whole = np.frombuffer(base64.b64decode(step["rotation"]["data"]), dtype="<i2").reshape(2, -1)
    return step["rotation"]["scale"] * whole.mean(axis=0)


def put(page, name, value):
    """Set a slider or a list as a user does."""
    page.execute_script(
        "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input', {bubbles: true}));"
        "arguments[0].dispatchEvent(new Event('change', {bubbles: true}));",
        part(page, name),
        value,
    )


def waited(found, seconds=10.0):
    """Whether something becomes true before long."""
    end = time.monotonic() + seconds
    while not found() and time.monotonic() < end:
        time.sleep(0.05)
    return bool(found())


def test_it_moves_and_stops(page):
    assert part(page, "play").text == "Play"
    first = part(page, "time").get_attribute("value")
    time.sleep(0.3)
    assert part(page, "time").get_attribute("value") == first  # nothing plays by itself
    steps = data(page)["bodies"][0]["scenes"][0]["steps"]
    largest = max((step for step in steps if step["ends"] == "rocks"), key=lambda step: step["peak"])
    put(page, "factor", steps.index(largest))
    put(page, "speed", 0.1)
    start = int(np.argmax(np.abs(rotation_of(largest)))) - 10
    put(page, "time", start)
    part(page, "play").click()
    assert part(page, "play").text == "Pause"
    assert part(page, "state").get_attribute("aria-live") == "off"
    assert waited(lambda: float(part(page, "time").get_attribute("value")) > start + 1)
    angles = {angle(page) for _ in range(10) if time.sleep(0.05) is None}
    assert len(angles) > 3
    part(page, "play").click()
    assert part(page, "play").text == "Play"
    assert part(page, "state").get_attribute("aria-live") == "polite"
    still = (part(page, "time").get_attribute("value"), angle(page), part(page, "state").text)
    time.sleep(0.3)
    assert (part(page, "time").get_attribute("value"), angle(page), part(page, "state").text) == still


def test_it_ends_by_itself_begins_again_and_is_not_printed(page):
    last = int(part(page, "time").get_attribute("max"))
    put(page, "time", last - 5)
    part(page, "play").click()
    assert waited(lambda: part(page, "play").text == "Play")
    assert float(part(page, "time").get_attribute("value")) == last
    part(page, "play").click()
    assert waited(lambda: 0 < float(part(page, "time").get_attribute("value")) < last)
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        assert not page.find_element("id", "explore").is_displayed()
    finally:
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def test_the_factor_changes_motion_verdict_and_probability(page):
    scene = data(page)["bodies"][0]["scenes"][0]
    put(page, "time", scene["columns"] - 1)
    seen = []
    for place, step in enumerate(scene["steps"]):
        put(page, "factor", place)
        assert f"{step['factor']:.3g}" in part(page, "chosen").text
        assert part(page, "factor").get_attribute("aria-valuetext") == part(page, "chosen").text.replace(" · ", ", ")
        assert ("overturns" in part(page, "verdict").text) == (step["ends"] == "overturns")
        seen.append((part(page, "verdict").text, part(page, "probability").get_attribute("innerHTML")))
        if step["ends"] == "overturns":
            assert abs(angle(page)) == 90.0
            assert "has overturned" in part(page, "state").text
    assert {step["ends"] for step in scene["steps"]} >= {"overturns", "rocks"}
    assert len(set(seen)) == 5


def test_the_drawn_rotation_is_the_stored_one_and_a_click_on_its_curve_moves_the_cursor(page):
    body = data(page)["bodies"][0]
    stored = rotation_of(next(step for step in body["scenes"][0]["steps"] if step["factor"] == 1.0))
    place = int(np.argmax(np.where(np.abs(stored) < 0.95, np.abs(stored), 0.0)))
    put(page, "time", place)
    assert angle(page) == pytest.approx(np.degrees(stored[place] * body["alpha"][0]), abs=0.01)
    assert abs(angle(page)) > 1.0
    assert "rocking" in part(page, "state").text
    from selenium.webdriver.common.action_chains import ActionChains

    ActionChains(page).move_to_element(part(page, "rotation")).click().perform()
    place, last = (float(part(page, "time").get_attribute(name)) for name in ("value", "max"))
    assert place == pytest.approx(0.48 * last, rel=0.1)


def test_the_keyboard_is_enough_and_every_control_has_a_name(page):
    from selenium.webdriver.common.keys import Keys

    before = part(page, "state").text
    part(page, "time").send_keys(Keys.ARROW_RIGHT * 40)
    assert part(page, "time").get_attribute("value") == "40"
    assert part(page, "state").text != before
    part(page, "forward").send_keys(Keys.SPACE)
    assert float(part(page, "time").get_attribute("value")) > 41.0
    chosen = part(page, "chosen").text
    part(page, "factor").send_keys(Keys.HOME)
    assert part(page, "chosen").text != chosen
    part(page, "play").send_keys(Keys.ENTER)
    assert part(page, "play").text == "Pause"
    part(page, "play").send_keys(Keys.SPACE)
    assert part(page, "play").text == "Play"
    part(page, "body").send_keys(Keys.ARROW_DOWN)
    assert part(page, "stage").get_attribute("aria-label").startswith("pier <img src=x onerror=alert(2)> $\\frac{,")
    nameless = page.execute_script(
        "return Array.from(document.querySelectorAll('#explorer input, #explorer select, #explorer button'))"
        ".filter((one) => !(one.getAttribute('aria-label') || one.textContent && one.matches('button') ||"
        " Array.from(one.labels ?? []).some((label) => label.textContent.trim()))).map((one) => one.outerHTML)"
    )
    assert nameless == []


def test_a_motion_that_is_not_stored_has_the_command_that_draws_it(page, whole_folder, tmp_path, monkeypatch):
    put(page, "body", 1)
    rows = [int(one.get_attribute("value")) for one in part(page, "record").find_elements("tag name", "option")]
    stored = {scene["record"] for scene in data(page)["bodies"][1]["scenes"]}
    (missing, *_) = [row for row in rows if row not in stored]
    put(page, "record", missing)
    assert not part(page, "scene").is_displayed()
    assert "is not stored on this page" in part(page, "missing").text
    command = shlex.split(part(page, "missing").find_element("tag name", "pre").text)
    assert command[:2] == ["rockpulse", "plot"]
    monkeypatch.chdir(whole_folder)
    assert main([*command[1:-1], str(tmp_path / command[-1])]) == 0
    assert (tmp_path / "rotation.png").stat().st_size > 10_000
    put(page, "record", rows[0])
    assert part(page, "scene").is_displayed()


def test_less_motion_is_respected(page):
    emulate = {"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]}
    part(page, "play").click()
    page.execute_cdp_cmd("Emulation.setEmulatedMedia", emulate)
    try:
        assert waited(lambda: not part(page, "play").is_displayed())
        still = part(page, "time").get_attribute("value")
        time.sleep(0.3)
        assert part(page, "time").get_attribute("value") == still
        assert "set to reduced motion" in part(page, "reduced").text
        part(page, "forward").click()
        assert float(part(page, "time").get_attribute("value")) > float(still)
        page.refresh()
        assert not part(page, "play").is_displayed()
    finally:
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def test_a_phone_needs_no_sideways_scrolling(page):
    size = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        explore = page.find_element("id", "explore")
        assert waited(lambda: explore.size["width"] <= 390)
        outside = page.execute_script(
            "return Array.from(document.querySelectorAll('#explorer *')).filter((one) => {"
            " const box = one.getBoundingClientRect(); return box.width && box.right > 390.5; }).length"
        )
        assert outside == 0
        viewed = part(page, "rotation").get_dom_attribute("viewBox").split()
        assert float(viewed[2]) == pytest.approx(part(page, "rotation").size["width"], abs=1)
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.slow
def test_any_of_twenty_bodies_is_drawn_at_once(browser, tmp_path):
    path = report(many_results(200, 20, samples=12000), tmp_path / "report.html")
    browser.get(path.as_uri())
    bodies = data(browser)["bodies"]
    assert [len(body["scenes"]) for body in bodies] == [3] * 20
    times = browser.execute_script(
        "const list = document.querySelector('#explorer [data-part=body]');"
        "return Array.from(list.options, (_, place) => { const start = performance.now(); list.value = place;"
        " list.dispatchEvent(new Event('change')); return performance.now() - start; })"
    )
    assert sorted(times)[10] < 300.0
    assert browser.get_log("browser") == []
