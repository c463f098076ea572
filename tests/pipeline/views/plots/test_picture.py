"""Files are the same on every run, text stays text, and any number of SVGs stand in one page."""

import gc
import io
import re
import weakref
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib
import pytest
from matplotlib.figure import Figure
from PIL import Image

from rockpulse.views.plots import style
from rockpulse.views.plots.style import caption, legend_above, one_axes, panel_title, picture_bytes, svg, title, wrapped
from rockpulse.views.shared.words import writing


def figure(words="a <b> & 'c'"):
    ax = one_axes(None, height=1.0)
    ax.plot([0, 1, 2], [0, 1, 0], marker="o", label="line")
    ax.fill_between([0, 1], [0, 1], hatch="//")
    title(ax, words)
    legend_above(ax, 2)
    caption(ax, "small print")
    return ax.figure


@pytest.mark.parametrize(
    ("form", "begin"), [("png", b"\x89PNG"), pytest.param("pdf", b"%PDF", marks=pytest.mark.sweep)]
)
def test_the_bytes_are_the_same_on_every_run(form, begin):
    first = picture_bytes(figure(), form)
    assert first == picture_bytes(figure(), form)
    assert first.startswith(begin)


@pytest.mark.sweep
def test_svgs_of_threads_are_the_same_and_leave_the_settings_as_they_were():
    before = dict(matplotlib.rcParams)
    with ThreadPoolExecutor(2) as pool:
        drawn = list(pool.map(lambda _: svg(figure()), range(2)))
    assert drawn[0] == drawn[1]
    assert dict(matplotlib.rcParams) == before


@pytest.mark.sweep
def test_any_number_of_svgs_stand_in_a_page():
    one, two = svg(figure(), "one"), svg(figure('id="x" url(#y)'))
    assert one.startswith("<svg")
    assert ">a &lt;b&gt; &amp; 'c'</text>" in one
    assert 'id="x" url(#y)</text>' in two  # looks like an id, and is text
    for part in ("DOCTYPE", "<style", "<metadata"):  # a style would be a rule for the whole page
        assert part not in one
    page = f"<div>{one}{two}</div>"
    ET.fromstring(page)
    ids = re.findall(r'\bid="([^"]*)"', re.sub(r">[^<]*<", "><", page))
    assert len(ids) == len(set(ids)) > 20
    references = re.findall(r'(?:href="#|url\(#)([^")]*)', re.sub(r">[^<]*<", "><", page))
    assert len(references) > 5
    assert set(references) <= set(ids)
    with pytest.raises(ValueError, match="expected a letter"):
        svg(one_axes(height=0.5).figure, "1 x")


def test_no_window_is_touched_and_nothing_is_kept_of_a_picture():
    sources = Path(style.__file__).parent.glob("*.py")
    assert [path.name for path in sources if re.search(r"^\s*(import|from) .*pyplot", path.read_text(), re.M)] == []
    gc.freeze()  # what was there before is not looked through
    try:
        gone = weakref.ref(figure())
        gc.collect()
        assert gone() is None
    finally:
        gc.unfreeze()


def test_titles_and_small_print_of_somebody_elses_figure_stay():
    mine = Figure()
    mine.suptitle("mine")
    ax = mine.subplots()
    panel_title(ax, "resonance: an upper-bound input")
    title(ax, "a record")
    caption(ax, "small")
    assert mine.get_suptitle() == "mine"
    assert ax.get_title(loc="left") == "a record\nresonance: an upper-bound input"
    assert [text.get_text() for text in ax.texts] == ["small"]


def test_a_notebook_is_given_the_picture_and_its_width():
    data, told = one_axes(height=0.5).figure._repr_png_()
    assert Image.open(io.BytesIO(data)).width == 1260  # 200 dots per inch
    assert told == {"width": 630}


def test_mathematics_is_not_broken_and_ticks_have_the_decimal_sign_of_the_language():
    assert wrapped("a row of $\\alpha_c$ and so on", 13) == "a row of $\\alpha_c$\nand so on"
    with writing("it"):
        ax = one_axes(None)
        ax.set_xticks([0.0, 0.5])
        assert [tick.get_text() for tick in ax.get_xticklabels()] == ["0,0", "0,5"]
