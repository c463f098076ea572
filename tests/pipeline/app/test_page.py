"""The page in a real browser: from a zip to the report, with the numbers of the command line."""

import os
import signal
import time
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from app_page import TIME, Window, records, served, walls
from real_browser import NEEDS_BROWSER
from record_writers import at2

from rockpulse.cli import main

pytest.importorskip("nicegui", reason="no nicegui: pip install -e '.[app]'")
pytestmark = [NEEDS_BROWSER, pytest.mark.sweep]


def test_the_whole_way_from_a_zip_to_the_report(browser, agency, tmp_path, monkeypatch):
    with served(tmp_path / "project") as page:
        window = Window(browser, page).open()
        assert "Enter a body first." in window.text("results")  # no bodies
        window.drop(*(agency / name for name in ("agency.zip", "damaged.zip", "notes.txt")))
        window.says("records", "5 channels, 5 earthquakes", "Not used (2)")
        window.drag(agency / "columns.txt")
        window.says("records", "Not used (3)", "do not state their unit")
        window.says("records", "Not used: columns.txt, damaged.zip, notes.txt.")
        window.choose("records", "unit", "m/s2")
        window.says("records", "6 channels", "Not used (2)")
        strokes = [one.get_attribute("d") for one in window.find("#records .shape path")]
        assert [(one.count("M"), len(one) < 500) for one in strokes] == [(40, True)] * 6
        walls(window)
        assert "confirm_size" not in (page.folder / "site.toml").read_text()  # the size was changed since
        window.choose("site", "given by", "PGA")
        window.type("site", "value", "30")
        window.says("site", "PGA of 30 g must be confirmed", "This value is correct")
        window.type("site", "value", "0,3")
        window.press("results", "Assess")
        window.wait(lambda: window.find("#results iframe"))
        assert window.console() == []
        assert window.hosts() == {f"127.0.0.1:{page.port}"}
        browser.switch_to.frame(window.find("#results iframe")[0])
        cards = window.wait(lambda: [one.text for one in window.find(".card h3")])
        browser.switch_to.default_content()
        high = wide_and_narrow(window)
        assert abs(high[0] - high[2]) < 20
        assert high[1] > high[2] + 100
        assert {card.split("\n")[0].split(" ")[0] for card in cards} == {"wall", "pier"}

        # The command line gives the same numbers.
        monkeypatch.chdir(page.folder)
        assert main(["assess", "--config", "site.toml", "-o", "again.h5", "--quiet"]) == 1  # the damaged zip
        assert main(["diff", "results.h5", "again.h5"]) == 0

        # A reload, also in the other language, shows everything again.
        window.open(f"http://127.0.0.1:{page.port}/?language=it")
        window.open().says("records", "6 canali")
        assert window.field("bodies", "larghezza [m]", 0).get_attribute("value") == "0,3"
        assert window.field("site", "valore", 0).get_attribute("value") == "0.3"
        window.says("records", "archivio zip danneggiato")
        window.type("bodies", "larghezza [m]", "largo", 0)
        window.says("bodies", "occorre un numero positivo di metri; è indicato 'largo'")
        window.says("results", "larghezza: occorre un numero positivo di metri")
        window.type("bodies", "larghezza [m]", "0,3", 0)
        window.says("bodies", "PGA di sollevamento 0,125 g")
        assert browser.execute_script("return document.documentElement.lang") == "it"
        window.press("results", "PDF")
        window.wait(lambda: (page.folder / "report-it.pdf").is_file())
        assert window.console() == []


def wide_and_narrow(window):
    """Height of the report on a wide window, a narrow one, and the wide one again [px]."""
    high = []
    for width in (1280, 700, 1280):
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        window.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        time.sleep(1.0)
        high.append(window.find("#results iframe")[0].size["height"])
        hidden = "const page = document.querySelector('#results iframe').contentDocument.documentElement;"
        assert window.browser.execute_script(hidden + "return page.scrollHeight - page.clientHeight") <= 0
    window.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    return high


def test_a_channel_that_the_assessment_rejects_is_confirmed_on_its_row(browser, tmp_path):
    folder = tmp_path / "project"
    members = records(1)
    strong = 6.0 * np.exp(-(((TIME - 2.0) / 0.3) ** 2)) * np.sin(30.0 * (TIME - 2.0))
    (folder / "records").mkdir(parents=True)
    for name, content in {**members, "strong.AT2": at2(strong, title="Strong, 1/1/2001, Station, 90")}.items():
        (folder / "records" / name).write_bytes(content)
    block = '[[block]]\nname = "wall"\nwidth = 0.3\nheight = 2\n'
    (folder / "site.toml").write_text(f'[records]\npaths = ["records"]\n[models]\nuse = ["sequence"]\n{block}')
    with served(folder) as page:
        window = Window(browser, page).open()
        window.says("records", "2 channels")
        window.press("results", "Assess")
        window.says("records", "Not used", "strong.AT2")
        assert "older than the records" not in window.text("results")
        window.press("records", "This channel is correct: use it")
        window.says("results", "older than the records")

        # Two files of a folder, whose directions are not stated, are a pair.
        hall = tmp_path / "hall"
        for name, motion in {"inside/a.csv": strong, "inside/b.csv": strong[::-1], ".hidden": TIME}.items():
            (hall / name).parent.mkdir(exist_ok=True, parents=True)
            rows = (f"{0.01 * n:.2f},{value / 6.0:.5f}\n" for n, value in enumerate(motion))
            (hall / name).write_text("time [s],acc [g]\n" + "".join(rows))
        window.choose_folder(hall)
        window.says("records", "4 channels")
        window.browser.execute_script("document.querySelectorAll('#site .q-item').forEach((one) => one.click())")
        window.choose("site", "directions", "the strongest direction of each pair")
        window.says("records", "Not used (5)", "its azimuth is unknown")
        window.choose("records", "file of the other direction", "b.csv")
        window.says("records", "Not used (3)")
    written = (folder / "site.toml").read_text()
    assert 'confirm = ["strong.90"]' in written
    assert 'north = "records/hall/inside/a.csv"\neast = "records/hall/inside/b.csv"' in written
    assert not (folder / "records" / "hall" / "hidden").exists()


#: Clicks on the heading of a column, and returns the time until the browser has shown another order [ms].
SORTED = """const [column, done] = arguments, start = performance.now();
const rows = () => document.querySelector('#records tbody').innerText, before = rows();
[...document.querySelectorAll('#records th')].find((one) => one.innerText.includes(column)).click();
const look = () => rows() === before ? requestAnimationFrame(look) : setTimeout(() => done(performance.now() - start));
look();"""


def test_200_records_and_50_bodies_are_shown_and_sorted_at_once(browser, tmp_path):
    (tmp_path / "records").mkdir()
    moments = 0.01 * np.arange(4000)
    for n in range(200):
        motion = (0.5 - 0.002 * n) * np.exp(-(((moments - 8.0) / 4.0) ** 2)) * np.sin((5.0 + 0.05 * n) * moments)
        name = f"{chr(65 + n // 26)}{chr(65 + n % 26)}" * 2
        title = f"{name}, {n % 12 + 1}/{n % 28 + 1}/{1950 + n % 60}, Bagnoli, {n}"
        (tmp_path / "records" / f"{n:03}.AT2").write_bytes(at2(motion, title=title))
    blocks = "".join(f'[[block]]\nname = "b{n}"\nwidth = {0.3 + 0.01 * n}\nheight = 2.4\n' for n in range(50))
    (tmp_path / "site.toml").write_text(f'[records]\npaths = ["records"]\ncomponents = "strongest"\n{blocks}')
    shown, ordered = [], []
    with served(tmp_path) as page:
        window = Window(browser, page)
        for _ in range(3):
            begin = perf_counter()
            window.open()
            window.wait(lambda: len(window.find("#records tbody tr")) >= 10)
            shown.append(perf_counter() - begin)
            window.says("records", "200 channels, 200 earthquakes", "Not used (200)")
            assert len(window.find("#records .left.failed")) == 10
            ordered += [browser.execute_async_script(SORTED, column) for column in ("PGA", "direction", "PGV")]
    print(f"first table after {[round(one, 2) for one in shown]} s, sorting {[round(one) for one in ordered]} ms")
    # The aim is 2 s on a quiet machine, where the server computes for 1.3 s, and for 0.2 s later; CI may be slower.
    assert shown[0] < 8.0
    assert min(shown) < 2.0
    assert sorted(ordered)[4] < 200.0


#: Opens all panels of the page.
OPENED = "document.querySelectorAll('.q-expansion-item__container > .q-item').forEach((one) => one.click())"


def test_spectra_over_that_of_the_code_and_the_annual_frequency(browser, tmp_path):
    folder = tmp_path / "project"
    (folder / "records").mkdir(parents=True)
    for name, content in records().items():
        (folder / "records" / name).write_bytes(content)
    check = "[check]\nag = 0.2\nf0 = 2.5\ntc_star = 0.3\n[selection]\nfactors = [0.1, 10]\nperiods = [0.7, 1.5]\n"
    block = '[[block]]\nname = "wall"\nwidth = 0.3\nheight = 2.4\n'
    (folder / "site.toml").write_text(f'[records]\npaths = ["records"]\n[hazard]\nk0 = 0.01\nk = 2\n{check}{block}')
    (folder / "results.h5").write_bytes(b"damaged")  # or from another version
    (tmp_path / "curve.csv").write_text("pga [g],rate\n0.1,0.01\n0.4,0.0005\n")
    with served(folder) as page:
        window = Window(browser, page).open()
        window.says("records", "5 channels, 5 earthquakes")
        browser.execute_script(OPENED)
        window.says("site", "Hazard curve: CSV")
        window.find("#site input[type=file]")[0].send_keys(str(tmp_path / "curve.csv"))
        window.says("site", "Remove: hazard.csv")
        window.type("site", "number of records", "3")
        window.press("site", "Draw the spectra of records over it")
        window.wait(lambda: window.find("#site img"))
        window.wait(lambda: browser.execute_script("return document.querySelector('#site img').naturalWidth > 500"))
        window.open()  # again, after another command than those of the results
        window.press("results", "Compute fragility and annual frequency")
        window.says("results", "return period", "wall")
        assert window.console() == []
    assert "records = 3" in (folder / "site.toml").read_text()
    assert len((folder / "risk.csv").read_text().splitlines()) == 2


def children(pid):
    """Processes that a process has started, as the system lists them."""
    return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def running(pid):
    status = Path(f"/proc/{pid}/status")
    return status.exists() and "\nState:\tZ" not in status.read_text()


def ends(pid):
    for _ in range(100):
        if not running(pid):
            return True
        time.sleep(0.1)
    return False


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs /proc")
def test_a_run_is_cancelled_and_ends_with_the_server(browser, samples, tmp_path):
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "records").symlink_to(samples, target_is_directory=True)
    blocks = "".join(f'[[block]]\nname = "b{n}"\nwidth = {0.3 + 0.01 * n}\nheight = 2.4\n' for n in range(30))
    (folder / "site.toml").write_text(f'[records]\npaths = ["records"]\n{blocks}')
    with served(folder) as page:
        window = Window(browser, page).open()
        window.press("results", "Assess")
        window.wait(lambda: " of 9, remaining time" in window.text("results"))
        (child,) = children(page.process.pid)
        window.press("results", "Cancel")
        window.says("results", "Cancelled. Finished records are kept.")
        assert ends(child)
        assert not (folder / "results.h5").exists()
        window.press("results", "Assess")
        window.wait(lambda: children(page.process.pid))
        (child,) = children(page.process.pid)
        os.kill(page.process.pid, signal.SIGKILL)
        assert ends(child)


def test_a_second_window_follows_the_first(browser, tmp_path):
    block = '[[block]]\nname = "wall"\nwidth = 0.3\nheight = 2.4\n'
    (tmp_path / "site.toml").write_text(f'[site]\npga = "0.35 g"\n{block}')
    with served(tmp_path) as page:
        first = Window(browser, page).open()
        one = browser.current_window_handle
        browser.switch_to.new_window("tab")
        second = Window(browser, page).open()
        second.says("bodies", "uplift PGA 0.125 g")
        two = browser.current_window_handle
        browser.switch_to.window(one)
        first.type("bodies", "width [m]", "0.6")
        first.says("bodies", "uplift PGA 0.25 g")
        browser.switch_to.window(two)
        second.says("bodies", "uplift PGA 0.25 g")
        browser.close()
        browser.switch_to.window(one)
        assert first.field("bodies", "width [m]").get_attribute("value") == "0.6"
        assert "width = 0.6" in (tmp_path / "site.toml").read_text()

        # A tie is added and removed, and so is the body.
        first.click("#bodies .q-expansion-item .q-item")
        first.press("bodies", "+ tie")
        first.says("bodies", "ultimate elongation", "must be given")
        first.click('#bodies button[aria-label="Remove: tie"]')
        first.wait(lambda: "ultimate elongation" not in first.text("bodies"))
        first.click('#bodies button[aria-label="Remove this body"]')
        first.wait(lambda: first.find(".body-row") == [])
        assert first.field("site", "value").get_attribute("value") == "0.35"
    written = (tmp_path / "site.toml").read_text()
    assert "[[block]]" not in written
    assert 'pga = "0.35 g"' in written  # as it was given
    assert "wall" in (tmp_path / "site.toml.bak").read_text()


def test_the_page_ends_after_its_window_was_closed(browser, tmp_path):
    with served(tmp_path, "--close-after", "0.03") as page:
        Window(browser, page).open()
        time.sleep(3.0)
        assert page.process.poll() is None
        browser.get("about:blank")
        assert page.process.wait(60) == 0


def test_nothing_grave_is_found_by_axe(axe, browser, agency, tmp_path):
    grave, wide = [], {}
    with served(tmp_path) as page:
        window = Window(browser, page).open()
        window.drop(agency / "agency.zip", agency / "columns.txt")
        window.says("records", "5 channels", "Not used (1)")
        walls(window)
        browser.execute_script(OPENED)
        window.says("site", "behaviour factor q")
        browser.execute_script(axe)
        for width in (1280, 390):
            size = {"width": width, "height": 1200, "deviceScaleFactor": 1, "mobile": width < 600}
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
            try:
                wide[width] = browser.execute_script("return document.documentElement.scrollWidth")
                found = browser.execute_async_script(
                    "const done = arguments[0]; axe.run({ resultTypes: ['violations'] }).then(done, done);"
                )
            finally:
                browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
            grave += [one for one in found["violations"] if one["impact"] in ("serious", "critical")]
            assert len(found["passes"]) > 5  # it has looked
    assert [(one["id"], [node["html"] for node in one["nodes"]]) for one in grave] == []
    assert all(found <= width for width, found in wide.items())
