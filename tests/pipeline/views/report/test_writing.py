"""The page as text: what it says, that it asks nothing of anybody, and what it replaces."""

import base64
import hashlib
import html
import re
from html.parser import HTMLParser

import pytest
import xarray as xr
from results_tree import results_tree

import rockpulse as rp
from rockpulse.errors import ResultsError
from rockpulse.views.report import writing
from rockpulse.views.report.content import page_content
from rockpulse.views.report.plain_text import plain_words
from rockpulse.views.report.writing import report, report_page


class Page(HTMLParser):
    """Tags with their attributes, and the text of the page."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.words, self._inside = [], [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag in ("script", "style"):
            self._inside.append(tag)

    def handle_endtag(self, tag):
        if tag in ("script", "style"):
            self._inside.pop()

    def handle_data(self, data):
        if not self._inside:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module", params=["plain_page", pytest.param("whole_page", marks=pytest.mark.sweep)])
def page(request):
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="module")
def known():
    """The page of a tree of which every answer is known."""
    return report_page(results_tree())


def test_nothing_in_the_page_asks_for_anything_and_links_lead_to_unique_ids(page):
    found = Page(page)
    for tag, attrs in found.tags:
        assert tag not in ("img", "link", "iframe", "object", "embed", "base", "form", "audio", "video", "source"), tag
        assert not {name for name in attrs if name.startswith("on")}, (tag, attrs)
        assert "src" not in attrs, (tag, attrs)
        for name in ("href", "xlink:href"):
            assert attrs.get(name, "#").startswith("#"), (tag, attrs)
    assert not re.search(r"url\((?!#)|@import", page)
    policy = next(attrs["content"] for tag, attrs in found.tags if attrs.get("http-equiv"))
    assert policy.startswith("default-src 'none';")
    script = re.search(r"<script>(.*?)</script>", page, re.S).group(1)
    assert base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() in policy
    ids = [attrs["id"] for _, attrs in found.tags if "id" in attrs]
    assert len(ids) == len(set(ids))
    links = {attrs[name][1:] for _, attrs in found.tags for name in ("href", "xlink:href") if name in attrs}
    assert links <= set(ids)


def test_names_with_html_or_mathematics_are_text_and_the_parts_come_in_order(page, results):
    from rocking.response import Outcome

    found = Page(page)
    assert sum(tag == "script" for tag, _ in found.tags) == 1
    for words in ('Quake <script>alert("1")</script>', 'why <script>alert("1")</script>', "$\\frac{"):
        assert words in found.text, words
    assert int(results["summary"]["outcome"].max()) == Outcome.OVERTURNS
    sections = ("verdict", "grounds", "annex", "warnings", "site", "fragility", "bodies", "records")
    parts = ("Not covered", "Assumptions", "Left out", "Versions", "Configuration")
    heads = [f'<section id="{name}"' for name in sections] + [f"<h3>{words}" for words in parts]
    assert (places := [page.index(words) for words in heads]) == sorted(places)


def test_the_verdict_names_what_is_counted(page, results):
    words = Page(page).text
    for expected in (
        "By the nonlinear model, under 4 records of 4 earthquakes; 4 of 5 files used (1 rejected)",
        "records overturn it as recorded; smallest scale factor at P = 10 %: ",
        "A verdict needs the demand at the site",
        "because no demand is stated",
        "4 of 5 files used (1 rejected)",
        "the body is not lifted",
    ):
        assert expected in words, expected
    for digit in range(4):
        assert f"burst{digit}" in words
        assert f"{digit}" * 64 in words
    assert not re.search(r"\b(nan|None)\b", words)


def test_a_record_is_named_by_its_earthquake_on_the_first_two_pages(known):
    front = Page(known.split('id="annex"')[0]).text
    assert "Ridgecrest 2019-07-06" in front
    assert "CI.CCC" not in front
    words = Page(known).text
    assert "there is no verdict, because no demand is stated" in words.lower()


def test_words_of_the_configuration_and_folders_are_in_the_full_report_alone(known):
    words = Page(known).text
    assert not re.search(r"\[(records|conditioning|check|site|demand)\]|--[a-z]|\brockpulse [a-z]", words)
    assert plain_words("too wide (set confirm_size = true). Next; see [records] units.") == "too wide. Next."
    assert plain_words("/data/x/pga_min.csv", ("/data/x/",)) == "pga_min.csv"
    assert plain_words("of wall (soil_factor 2)", names=("wall (soil_factor 2)",)) == "of wall (soil_factor 2)"
    assert plain_words("without yield_force; as /data/x/a.csv", ("/data/x/",)) == "without yield force; as a.csv"


def test_without_factors_answers_or_records_a_body_is_not_called_safe(known, results):
    words = Page(known).text
    assert "safe under these" not in words.split("Verdict on each body")[0]
    assert "free flight" in words
    assert "replaces the probability of overturning" in words
    assert "cut.AT2:4 expected 100 samples, found 3" in words
    tree = results.copy()
    tree["summary"] = xr.DataTree(tree["summary"].to_dataset().isel(record=[]))
    found = page_content(tree)
    assert [card.verdict.text for card in found.cards] == ["-"] * 3


@pytest.mark.sweep
def test_the_resonance_model_is_named_for_what_it_is_where_it_judges(undrawn):
    tree = results_tree()
    summary = tree["summary"].to_dataset().sel(model=["resonance"])
    parts = {"/": tree.to_dataset(), "/summary": summary, "/failures": tree["failures"].to_dataset()}
    words = Page(report_page(xr.DataTree.from_dict(parts))).text
    assert "resonance model (upper-bound input, no prediction)" in words
    assert "judged by an upper-bound input" in words


def test_cases_of_restitution_are_bodies_of_their_own():
    assert "column, C = 0.830" in [row[0].text for row in page_content(results_tree(cases=2)).counts.rows]


@pytest.mark.sweep
def test_the_design_sequence_of_a_site(tmp_path, site, bodies, undrawn):
    rp.save(site, tmp_path / "site.h5")
    sequence = rp.load_design(tmp_path / "site.h5")
    results = rp.assess_sequence(sequence, bodies={name: bodies[name] for name in list(bodies)[:2]})
    assert "read and used" not in report_page(results)  # no file was read for it
    words = Page(report_page(results, site)).text
    assert "under one design sequence" in words
    said = words[words.index("The confidence is that of the site calibration") :].split("Site calibration")[0]
    assert "The design is the predictive 50 % quantile" in said
    assert "Sequence of the site: number of main impulses N = " in words


def changed(results, **values):
    """A copy with other values of the first record."""
    tree = results.copy()
    summary = tree["summary"].to_dataset().copy(deep=True)
    for name, value in values.items():
        summary[name].values[0] = value
    tree["summary"] = xr.DataTree(summary)
    return tree


def cells(table):
    return [cell.marked for row in table.rows for cell in row]


@pytest.mark.sweep
def test_a_record_of_a_doubtful_peak_is_marked_and_said_first(results):
    assert not any("peak?" in text for text in cells(page_content(results).answers))
    found = page_content(changed(results, pga=98.1))
    first = found.warnings[0]
    assert (first.grade, first.head) == ("decides", "the samples of 1 record are doubtful")
    assert found.limits[0].startswith("What may change a verdict: the samples of 1 record are doubtful")
    assert first.text.startswith("burst0 (peak?). (peak?): a peak above 5 g")
    assert "burst0 (peak?)" in cells(found.answers)
    assert found.records[0].name == "burst0 (peak?)"
    assert any("(peak?)" in text for body in found.bodies for text in cells(body.governing))
    assert any(note.startswith("(peak?): a peak above 5 g") for note in found.notes)


def test_where_nothing_was_found_the_page_says_up_to_where(results):
    found = page_content(results)
    assert ">10" in cells(found.answers)
    assert "none" not in cells(found.answers)
    assert any(">10: no overturning up to this scale factor" in note for note in found.notes)
    assert "at rest" in cells(found.answers)
    assert any("1 of 3 bodies not lifted by any of these motions" in one.head for one in found.warnings)


def test_the_file_is_written_and_only_a_report_is_replaced(tmp_path, monkeypatch, known):
    tree, path = results_tree(), tmp_path / "report.html"
    monkeypatch.setattr(writing, "report_page", lambda *given: known)
    assert report(tree, path) == path
    assert path.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    with pytest.raises(ResultsError, match="--overwrite"):
        report(tree, path)
    report(tree, path, overwrite=True)
    other = tmp_path / "notes.html"
    other.write_text("mine")
    with pytest.raises(ResultsError, match="not replaced even with"):
        report(tree, other, overwrite=True)
    assert other.read_text() == "mine"
    with pytest.raises(ResultsError, match="no folder"):
        report(tree, tmp_path / "none" / "report.html")
    with pytest.raises(ResultsError, match="a folder or a device"):
        report(tree, tmp_path, overwrite=True)


@pytest.mark.slow
def test_files_of_another_kind_are_refused(tmp_path, results, site):
    rp.save(site, tmp_path / "site.h5")
    rp.save(results, tmp_path / "results.h5")
    with pytest.raises(ResultsError, match="expected an assessment file, found a site calibration file"):
        report(tmp_path / "site.h5", tmp_path / "report.html")
    with pytest.raises(ResultsError, match="expected a fragility file, found a site calibration file"):
        report(tmp_path / "results.h5", tmp_path / "report.html", fragility=tmp_path / "site.h5")
    with pytest.raises(ResultsError, match=r"found a tree of another kind$"):
        report_page(xr.DataTree())
    assert not (tmp_path / "report.html").exists()


@pytest.mark.sweep
def test_the_files_are_named_with_their_hashes(tmp_path):
    path = tmp_path / "results.h5"
    rp.save(results_tree(), path)
    page = report_page(path, full=True)
    assert hashlib.sha256(path.read_bytes()).hexdigest() in page
    assert html.escape(str(path)) in page
