"""The manual: its commands run and print what it shows, and it leaves out no verb, no public name and no picture."""

import argparse
import importlib
import re
from pathlib import Path

import pytest
from docs_page import blocks, missing_line, pictures, run_page

import rockpulse
import rockpulse.models
import rockpulse.plots

TOP = Path(__file__).parents[2]
DOCS = TOP / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if page.parent.name != "decisions" and page.name != "schema.md")
#: Pages that test_readme runs, on files of one's own.
OWN_FILES = {DOCS / "tour.md", DOCS / "speed.md"}
RUN = [
    page
    for page in PAGES
    if page not in OWN_FILES and any(block.kind in ("sh", "python") and not block.not_run for block in blocks(page))
]
#: Pages that take half a minute or more; tests/pipeline/views/plots draws every kind of picture, of short records, and
#: tests/pipeline/studies/selftest runs the self-test.
LONG = {DOCS / "gallery.md", DOCS / "accuracy.md"}

#: All that the manual shows and no test runs, with the reason that stands above it on the page.
NOT_RUN = {
    ("accuracy.md", "it is the output of `make accuracy`"),
    ("index.md", "it installs the program"),
    ("installation.md", "it needs a container engine"),
    ("installation.md", "it writes to a system folder"),
    ("tutorials/app.md", "it needs the folder of the page"),
    ("tutorials/app.md", "it opens a page and waits"),
    ("tutorials/assess.md", "it installs the program"),
    ("tutorials/assess.md", "it is for Windows"),
    ("tutorials/batch.md", "it needs the address of a cluster"),
    ("tutorials/batch.md", "it installs the extra that a cluster needs"),
    ("tutorials/results.md", "it needs MATLAB"),
    ("tutorials/results.md", "it needs the tools of HDF5 or of netCDF"),
}

#: Pictures that no command of a page draws; tests/app_pictures.py draws those of the page in the browser.
OTHERWISE = {"app.png", "app-results.png", "ridgecrest.png", "accuracy.png", "code-check.png", "figure4.png"}


def name(page):
    return page.relative_to(DOCS).as_posix()


@pytest.fixture
def folder(tmp_path):
    """A folder with the samples where a clone of the repository has them."""
    (tmp_path / "data").symlink_to(TOP / "data", target_is_directory=True)
    return tmp_path


@pytest.mark.sweep
@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=[pytest.mark.slow] * (page in LONG)) for page in RUN], ids=name
)
def test_a_page_does_what_it_says(page, folder):
    run_page(page, folder)


def test_what_is_not_run_says_why():
    left_out = {(name(page), block.not_run) for page in PAGES for block in blocks(page) if block.not_run}
    assert left_out == NOT_RUN
    kinds = {block.kind for page in PAGES for block in blocks(page) if not block.not_run}
    assert kinds <= {"sh", "python", "text", "file"} | {kind for kind in kinds if kind.startswith("{")}


def test_no_block_hides_from_the_test():
    """Every fence is one that `blocks` sees: none is indented, of tildes, or a code-block of colons."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        fences = re.findall(r"^[ \t]*(?:`{3,}|~{3,}|:{3,}\{code)", text, re.MULTILINE)
        assert len(fences) == 2 * len(blocks(page)), name(page)


def options_of_the_template():
    """Every (section, key) of the configuration."""
    from rockpulse.commands.init_config import config_template

    keys, heading = set(), ""
    for line in config_template().splitlines():
        if found := re.match(r"(?:# )?\[+(\w+)\]+", line):
            heading = found[1]
        elif found := re.match(r"(?:# )?(\w+) = ", line):
            keys.add((heading, found[1]))
    return keys


@pytest.mark.sweep
def test_every_option_is_spoken_of():
    """The template says what each option is; the pages say what it does."""
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    keys = options_of_the_template() - {("site", "description")}
    assert len(keys) > 60
    assert [f"[{section}] {key}" for section, key in sorted(keys) if not re.search(rf"\b{key}\b", text)] == []


def test_what_the_text_names_exists():
    """Options, keys, functions and files in the running text, which no test runs, are those of the program."""
    from rockpulse.cli import build_parser
    from rockpulse.commands import VERBS

    options, parsers = {"--help", "-m", "-s", "-k"}, [build_parser()]
    while parsers:
        for action in parsers.pop()._actions:
            options |= set(action.option_strings)
            if isinstance(action, argparse._SubParsersAction):
                parsers += action.choices.values()
    benchmarks = "".join(path.read_text(encoding="utf-8") for path in (TOP / "benchmarks").rglob("*.py"))
    targets = set(re.findall(r"^([a-z-]+):", (TOP / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    keys = options_of_the_template()
    verbs = {verb.name for verb in VERBS} | {"COMMAND"}
    for page in PAGES:
        prose = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        for code in re.findall(r"`([^`\n]+)`", prose):
            if code.startswith(("podman ", "docker ", "pip ")):  # options of their own
                continue
            where = f"{name(page)}: `{code}`"
            for option in re.findall(r"(?:^|\s)(--?[a-z][\w-]*)", code):
                of_script = re.match("(python )?benchmarks/|make ", code) and f'"{option}"' in benchmarks
                assert option in options or of_script, where
            for verb in re.findall(r"^rockpulse (\w[\w-]*)", code):
                assert verb in verbs, where
            for target in re.findall(r"^make (\w[\w-]*)", code):
                assert target in targets, where
            for section, key in re.findall(r"\[(\w+)\]+ (\w+)", code):
                assert (section, key) in keys, where
            for module, attribute in re.findall(r"\b(rp|models|plots)\.(\w+)", code):
                assert hasattr(
                    {"rp": rockpulse, "models": rockpulse.models, "plots": rockpulse.plots}[module], attribute
                ), where
            for path in re.findall(r"\b(?:benchmarks|tests|data|docs)/[\w./]+", code):
                assert (TOP / path).exists(), where


def test_every_verb_is_used_in_the_manual():
    used = "\n".join(block.body for page in RUN for block in blocks(page) if block.kind == "sh" and not block.not_run)
    from rockpulse.commands import VERBS

    assert [verb.name for verb in VERBS if f"rockpulse {verb.name} " not in used] == []


@pytest.mark.parametrize("module", [rockpulse, rockpulse.models, rockpulse.plots], ids=lambda m: m.__name__)
def test_every_public_name_is_in_the_reference_and_every_callable_shows_an_example_that_is_run(module):
    """`make doctest` runs the examples; it would pass over those that are to be skipped."""
    text = (DOCS / "reference" / "api.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\.\. auto\w+:: ([\w.]+)$", text, re.MULTILINE))
    public = {f"{module.__name__}.{public}" for public in module.__all__ if public not in ("models", "plots")}
    assert public - listed - {"rockpulse.__version__", "rockpulse.Block"} == set()  # Block: as rockpulse.models.Block
    named = {public: getattr(module, public) for public in module.__all__}
    shown = {public: one.__doc__ or "" for public, one in named.items() if callable(one)}
    assert [public for public, text in shown.items() if ">>> " not in text or "+SKIP" in text] == []


def test_every_picture_of_a_page_is_drawn_by_that_page():
    """docs/images holds what the commands of the pages draw: `make docs-pictures` writes them again."""
    for page in PAGES:
        drawn, others = pictures(page)
        assert others <= OTHERWISE, name(page)
        assert all((DOCS / "images" / picture).is_file() for picture in drawn | others), name(page)


def test_no_picture_is_kept_that_no_page_shows():
    pages = [TOP / "README.md", *DOCS.rglob("*.md")]
    shown = {picture for page in pages for which in pictures(page) for picture in which}
    assert {path.name for path in (DOCS / "images").glob("*.png")} == shown


@pytest.mark.sweep
def test_an_index_of_a_dotted_letter_stands_beside_it(monkeypatch):
    pytest.importorskip("docutils", reason="no docutils: pip install -e '.[docs]'")
    monkeypatch.syspath_prepend(str(DOCS / "extensions"))
    translated = importlib.import_module("mathml").translated
    assert "munderover" not in translated(r"\dot{\theta}_i = C\,\dot{\theta}^{-}", as_block=True)


@pytest.mark.parametrize(
    ("shown", "printed", "first"),
    [
        ("wall  0.981  4.50  0.53", "  wall 0.981 4.51 0.53", None),
        ("wall  0.981  4.50  0.53", "  wall 0.981 4.50 0.93", "wall  0.981  4.50  0.53"),
        ("wall  OVERTURNS", "wall  0.30", "wall  OVERTURNS"),
        ("I = 2.95e-14 m/s", "I = 2.95e-14 m/s", None),
        ("a\n...\nc", "a\nb\nc", None),
        ("c\na", "a\nb\nc", "a"),
    ],
)
def test_lines_are_compared_in_their_order_by_words_and_loosely_by_numbers(shown, printed, first):
    assert missing_line(shown, printed) == first


def test_lines_of_markdown_are_at_most_120_columns_wide():
    """But for tables, code, formulas, pictures and links, which cannot be broken."""
    for page in [TOP / "README.md", TOP / "CHANGELOG.md", TOP / "CONTRIBUTING.md", *DOCS.rglob("*.md")]:
        inside = False
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            if re.match(r"\s*```|\s*\$\$", line):
                inside = not inside if line.count("$$") < 2 else inside
            elif not re.match(r"\s*\||\s*!?\[.*\]\(\S+\)$|\[\S+\]: ", line):
                assert inside or len(line) <= 120, f"{page.relative_to(TOP)}:{number}"
