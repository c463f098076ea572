"""The report as axe-core judges it: contrast, names, roles and order, on a screen and on a phone, in every language."""

import pytest
from real_browser import NEEDS_BROWSER

import rockpulse as rp
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared.words import LANGUAGES

pytestmark = [NEEDS_BROWSER, pytest.mark.sweep]

#: Width and height of the window: a screen, a phone.
WINDOWS = ((1280, 1200), (390, 844))

#: Impacts that no finding may have.
GRAVE = ("serious", "critical")


@pytest.fixture(scope="module")
def sample_results(samples):
    """The samples on their four bodies, as the README assesses them."""
    config = rp.load_config(samples.parent / "site.toml")
    records, failures = rp.read_all(samples)
    return rp.assess(records, config, failures=failures)


@pytest.fixture(scope="module", params=[*LANGUAGES, "with site and fragility"])
def page(request, browser, tmp_path_factory):
    """The browser at a report with everything open: of the samples in a language, or of the bursts with all parts."""
    if request.param in LANGUAGES:
        text = report_page(request.getfixturevalue("sample_results"), language=request.param)
    else:
        text = request.getfixturevalue("whole_page")
    path = tmp_path_factory.mktemp("axe") / "report.html"
    path.write_text(text, encoding="utf-8")
    browser.get(path.as_uri())
    browser.execute_script("document.querySelector('[data-open=all]').click()")
    return browser


def violations(page, axe):
    """What axe-core finds wrong on the page as it is shown: the first places of each rule, by impact and rule."""
    page.execute_script(axe)
    found = page.execute_async_script(
        "const done = arguments[0]; axe.run({ resultTypes: ['violations'] }).then(done, done);"
    )
    assert len(found["passes"]) > 5  # it has looked
    return {
        (one["impact"], one["id"]): [node["html"][:200] for node in one["nodes"]][:5] for one in found["violations"]
    }


@pytest.mark.parametrize("window", WINDOWS)
def test_nothing_grave_is_found(axe, page, window):
    size = {"width": window[0], "height": window[1], "deviceScaleFactor": 1, "mobile": window[0] < 600}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        found = violations(page, axe)
    finally:
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert {rule: where for rule, where in found.items() if rule[0] in GRAVE} == {}


def test_what_is_grave_would_be_found(axe, browser, tmp_path):
    path = tmp_path / "wrong.html"
    path.write_text('<html lang="en"><title>t</title><button></button><p style="color: #ccc">too pale</p>')
    browser.get(path.as_uri())
    assert set(violations(browser, axe)) >= {("critical", "button-name"), ("serious", "color-contrast")}
