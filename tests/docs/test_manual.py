"""The manual: its commands run and print what it shows, and it leaves out no verb, no public name and no picture."""

import ast
import re
from pathlib import Path

import pytest
from docs_page import alike, blocks, missing_line, run_page

import rockpulse
import rockpulse.models
import rockpulse.plots
import rockpulse.study

TOP = Path(__file__).parents[2]
DOCS = TOP / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if page.parent.name != "decisions" and page.name != "schema.md")
RUN = [page for page in PAGES if any(block.kind in ("sh", "python") and not block.not_run for block in blocks(page))]

#: All that the manual shows and no test runs, with the reason that stands above it on the page.
NOT_RUN = {
    ("index.md", "it installs the program"),
    ("tutorials/assess.md", "it installs the program"),
    ("tutorials/batch.md", "it needs the address of a cluster"),
    ("tutorials/batch.md", "it installs the extra that a cluster needs"),
    ("tutorials/results.md", "it needs MATLAB"),
    ("tutorials/results.md", "it needs the tools of HDF5 or of netCDF"),
}


def name(page):
    return page.relative_to(DOCS).as_posix()


@pytest.fixture
def folder(tmp_path):
    """A folder with the samples where a clone of the repository has them."""
    (tmp_path / "data").symlink_to(TOP / "data", target_is_directory=True)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=name)
def test_a_page_does_what_it_says(page, folder):
    run_page(page, folder)


def test_what_is_not_run_says_why():
    left_out = {(name(page), block.not_run) for page in PAGES for block in blocks(page) if block.not_run}
    assert left_out == NOT_RUN
    kinds = {block.kind for page in PAGES for block in blocks(page) if not block.not_run}
    assert kinds <= {"sh", "python", "text", "file"} | {kind for kind in kinds if kind.startswith("{")}


def test_every_verb_is_used_in_the_manual():
    used = "\n".join(block.body for page in RUN for block in blocks(page) if block.kind == "sh" and not block.not_run)
    from rockpulse.commands import VERBS

    assert [verb.name for verb in VERBS if f"rockpulse {verb.name} " not in used] == []


@pytest.mark.parametrize(
    "module", [rockpulse, rockpulse.models, rockpulse.plots, rockpulse.study], ids=lambda m: m.__name__
)
def test_every_public_name_is_in_the_reference(module):
    text = (DOCS / "reference" / "api.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\.\. auto\w+:: ([\w.]+)$", text, re.MULTILINE))
    public = {f"{module.__name__}.{public}" for public in module.__all__ if public not in ("models", "plots", "study")}
    assert public - listed - {"rockpulse.__version__"} == set()


def test_every_picture_of_a_page_is_drawn_by_that_page():
    """docs/images holds what the commands of the pages draw: `make docs-pictures` writes them again."""
    for page in PAGES:
        drawn = {Path(path).name for block in blocks(page) for path in re.findall(r"-o (\S+\.png)", block.body)}
        shown = {Path(path).name for path in re.findall(r"!\[[^]]*\]\(\S*images/(\S+\.png)\)", page.read_text("utf-8"))}
        assert shown <= drawn | {"ridgecrest.png", "accuracy.png"}, name(page)
        assert all((DOCS / "images" / picture).is_file() for picture in shown), name(page)


def test_python_of_the_manual_is_python():
    for page in PAGES:
        for block in blocks(page):
            if block.kind == "python":
                ast.parse(block.body, filename=name(page))


@pytest.mark.parametrize(
    ("shown", "printed", "same"),
    [
        ("wall  0.981  4.50  0.53", "  wall 0.981 4.51 0.53", True),
        ("wall  0.981  4.50  0.53", "  wall 0.981 4.50 0.93", False),
        ("wall  OVERTURNS", "wall  0.30", False),
        ("I = 2.95e-14 m/s", "I = 2.95e-14 m/s", True),
    ],
)
def test_lines_are_compared_by_words_and_loosely_by_numbers(shown, printed, same):
    assert alike(shown, printed, figures=True) is same


def test_lines_have_to_come_in_their_order():
    assert missing_line("a\n...\nc", "a\nb\nc") is None
    assert missing_line("c\na", "a\nb\nc") == "a"
