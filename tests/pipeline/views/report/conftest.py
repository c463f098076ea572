"""Four bursts of four earthquakes on three bodies: assessed, calibrated, with fragility curves, once for all tests."""

import fcntl
from dataclasses import replace
from html import escape

import numpy as np
import pytest
from markupsafe import Markup
from matplotlib.text import Text
from nominal import ida

import rockpulse as rp
from rockpulse import CalibrationSettings, SearchSettings
from rockpulse.errors import Failure, ResultsError
from rockpulse.models import Block
from rockpulse.views.report.report_pictures import PageElement, Pictures
from rockpulse.views.report.writing import report_page

TIME = 0.02 * np.arange(500)

#: Names that would be a part of the page, a formula or a path if they were not taken as text.
HOSTILE = '<script>alert("1")</script>'
HOSTILE_BLOCK = "pier <img src=x onerror=alert(2)> $\\frac{"


@pytest.fixture(scope="session")
def bursts():
    """Records as they were read; the first is of a station with HTML in its name."""
    every = [
        rp.Record(
            (2.0 + 0.4 * number)
            * np.sin(2.0 * np.pi * TIME * (0.8 + 0.05 * number))
            * np.exp(-(((TIME - 4) / 2) ** 2)),
            dt=0.02,
            id=f"burst{number}",
            station=f"STA{number}",
            event=f"Quake {'ABCD'[number] * 3}",
            source=f"folder/burst{number}.AT2",
            source_sha256=f"{number}" * 64,
            processed=True,
        )
        for number in range(4)
    ]
    hostile = replace(every[0], station=HOSTILE, event=f"Quake {HOSTILE}", warnings=(f"warned of {HOSTILE}",))
    return [hostile, *every[1:]]


@pytest.fixture(scope="session")
def bodies():
    """One that every burst overturns, one of a hostile name, one that nothing lifts."""
    return {"stele": Block(0.2, 3.0), HOSTILE_BLOCK: Block(1.0, 4.0), "plinth": Block(2.0, 2.4)}


@pytest.fixture(scope="session")
def config():
    """Few factors, few resamples."""
    return rp.Config(
        search=SearchSettings(points=24),
        calibration=CalibrationSettings(quantile=0.5, bootstrap=100),
        fragility=ida(limit_states=("uplift", "overturning"), measures=("pga", "velocity_ratio")),
    )


@pytest.fixture(scope="session")
def results(bursts, bodies, config):
    """The assessment, with a file that failed for a reason with HTML in it."""
    return rp.assess(bursts, config, bodies, failures=[Failure("a.AT2", "read", f"why {HOSTILE}", "failed")])


@pytest.fixture(scope="session")
def site(bursts, bodies, config):
    """Calibration on the same records and one of a fifth earthquake."""
    fifth = replace(bursts[3], id="burst4", event="Quake EEE", source="folder/burst4.AT2")
    return rp.calibrate([*bursts, fifth], config, bodies)


@pytest.fixture(scope="session")
def fragility(bursts, bodies, config):
    """Curves of the same records."""
    return rp.fragility(bursts, config, bodies)


@pytest.fixture(scope="session")
def whole_folder(request, tmp_path_factory, worker_id):
    """A folder with the results in a file, and the page with everything on it, drawn once for all workers."""
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "whole"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "report.html").exists():
            results, site, fragility = map(request.getfixturevalue, ("results", "site", "fragility"))
            rp.save(results, folder / "some results.h5", overwrite=True)
            page = report_page(folder / "some results.h5", site, fragility, full=True)
            (folder / "report.html").write_text(page, encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def whole_page(whole_folder):
    """The page with everything on it; drawing its pictures takes seconds."""
    return (whole_folder / "report.html").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def plain_page(results, site, fragility):
    """The same with an empty picture in place of each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Pictures, "_drawn", empty)
        return report_page(results, site, fragility, full=True)


@pytest.fixture
def undrawn(monkeypatch):
    """Pages of which no picture is drawn."""
    monkeypatch.setattr(Pictures, "_drawn", empty)


def empty(pictures, draw, name, caption):
    return PageElement(Markup(f'<svg id="picture-{name}"></svg>'), caption)


def lettered(pictures, draw, name, caption):
    """The texts of a picture in its place."""
    try:
        drawn = draw().get_figure(root=True)
    except ResultsError as reason:
        return PageElement(Markup(""), str(reason))
    texts = [escape(one.get_text()) for one in drawn.findobj(Text) if one.get_visible()]
    return PageElement(Markup("<svg>" + "".join(f"<text>{text}</text>" for text in texts) + "</svg>"), caption)


@pytest.fixture
def letters_alone(monkeypatch):
    """Pages with the texts of each picture in its place."""
    monkeypatch.setattr(Pictures, "_drawn", lettered)


@pytest.fixture(scope="session")
def browser(driver):
    """The browser of the session."""
    return driver
