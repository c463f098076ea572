"""Files are the same on every run, text stays text, and any number of SVGs stand in one page."""

import gc
import io
import re
import subprocess
import sys
import weakref
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor

import matplotlib
import pytest
from matplotlib.figure import Figure
from PIL import Image

import rockpulse as rp
from rockpulse.views.plots.picture import picture_bytes, svg
from rockpulse.views.plots.style import caption, figure_of, legend_above, one_axes, panel_title, title


def figure(words="a <b> & 'c'"):
    ax = one_axes(None)
    ax.plot([0, 1, 2], [0, 1, 0], marker="o", label="line")
    ax.fill_between([0, 1], [0, 1], hatch="//")
    ax.set_xlabel("time [s]")
    title(ax, words)
    legend_above(ax, 2)
    caption(ax, "small print")
    return ax.figure


@pytest.mark.parametrize("form", ["png", "svg", "pdf"])
def test_the_bytes_are_the_same_on_every_run(form):
    first = picture_bytes(figure(), form)
    assert first == picture_bytes(figure(), form)
    assert first.startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[form])


def test_text_is_text():
    text = svg(figure())
    assert ">a &lt;b&gt; &amp; 'c'</text>" in text
    assert ">time [s]</text>" in text
    assert text.startswith("<svg")
    assert "DOCTYPE" not in text
    assert "<style" not in text  # a rule would hold for the whole page
    assert "<metadata" not in text


def test_ids_are_unique_in_a_page_and_every_reference_finds_its_own():
    page = f"<div>{svg(figure(), 'one')}{svg(figure(), 'two')}{svg(figure('another'))}</div>"
    ET.fromstring(page)
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids)) > 20
    references = re.findall(r'(?:href="#|url\(#)([^")]*)', page)
    assert len(references) > 5
    assert set(references) <= set(ids)


def test_text_that_looks_like_an_id_stays_as_it_is():
    assert 'id="x" url(#y)</text>' in svg(figure('id="x" url(#y)'))


def test_a_name_that_cannot_begin_an_id_is_refused():
    with pytest.raises(ValueError, match="expected a letter"):
        svg(figure(), "1 x")


def test_no_window_and_no_list_of_figures_is_touched():
    script = (
        "import sys; from rockpulse.views.plots.picture import svg; from rockpulse.views.plots.style import one_axes;"
        "svg(one_axes(None).figure);"
        "print('matplotlib.pyplot' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "False"


def test_titles_and_small_print_of_somebody_elses_figure_stay():
    mine = Figure()
    mine.suptitle("mine")
    ax = mine.subplots()
    ax.set_xlabel("x")
    title(ax, "theirs")
    caption(ax, "small")
    assert mine.get_suptitle() == "mine"
    assert ax.get_title(loc="left") == "theirs"
    assert [text.get_text() for text in ax.texts] == ["small"]


def test_a_panel_of_somebody_elses_figure_keeps_what_it_says_of_itself():
    ax = Figure().subplots()
    panel_title(ax, "resonance: an upper-bound type input")
    title(ax, "a record")
    assert ax.get_title(loc="left") == "a record\nresonance: an upper-bound type input"


def test_threads_leave_the_settings_as_they_were():
    before = dict(matplotlib.rcParams)
    with ThreadPoolExecutor(3) as pool:
        drawn = list(pool.map(lambda _: svg(figure()), range(3)))
    assert set(drawn) == {svg(figure())}
    assert dict(matplotlib.rcParams) == before


def test_nothing_is_kept_of_a_picture():
    gone = weakref.ref(figure())
    gc.collect()
    assert gone() is None


def test_a_notebook_is_given_the_picture_and_its_width():
    data, told = rp.plot(rp.models.Block(width=0.25, height=2.2))._repr_png_()
    assert Image.open(io.BytesIO(data)).width == 1260  # 200 dots per inch
    assert told == {"width": 630}


@pytest.mark.parametrize("width", [2.0, 6.3])
def test_the_width_is_that_of_the_figure(width):
    figure = figure_of(width=width, height=1.0)
    assert figure._repr_png_()[1]["width"] == round(100.0 * width)
