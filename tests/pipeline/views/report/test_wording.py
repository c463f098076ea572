"""The words of every language: none is missing, none has other fields, and a page holds no English in between."""

import ast
import re
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from string import Formatter

import pytest
from page_texts import QUOTED, page_texts
from report_cases import WORDS
from results_tree import results_tree

import rockpulse as rp
from rocking.response import Reason
from rockpulse.errors import ConfigError
from rockpulse.model_table import MODELS, UPPER_BOUND
from rockpulse.views.report.method import REFERENCE
from rockpulse.views.report.wording import LANGUAGES, words_of
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared import answer_cells, record_marks, verdict_notes
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Mark, number

OTHERS = [language for language in LANGUAGES if language != "en"]

#: The short texts that tables of the report take over from what the terminal shows.
SHARED = {
    *MODELS,
    *(model.words for model in MODELS.values()),
    UPPER_BOUND,
    *answer_cells.NAMES.values(),
    *answer_cells.TITLES.values(),
    *answer_cells._WORDS.values(),
    verdict_notes.BEYOND_CRITICAL,
    *(
        mark.note
        for module in (verdict_notes, record_marks, answer_cells)
        for mark in vars(module).values()
        if isinstance(mark, Mark)
    ),
}


def fields(text):
    return {name for _, name, _, _ in Formatter().parse(text) if name}


@pytest.mark.parametrize("language", OTHERS)
def test_no_word_is_missing_and_no_field_differs(language):
    other = words_of(language)
    assert set(other.table) == set(WORDS.table)
    assert {key for key, text in WORDS.table.items() if fields(text) != fields(other.table[key])} == set()
    assert {text for text in other.table.values() if not text.strip()} == set()


@pytest.mark.parametrize("language", OTHERS)
def test_no_text_that_is_shared_with_the_terminal_is_missing(language):
    assert SHARED - set(words_of(language).fixed) == set()


@pytest.mark.parametrize("language", OTHERS)
def test_the_english_forms_are_those_of_the_program(language):
    """Most pairs of words of a form stand in one text of the sources: else its English has changed, and it is dead."""
    said = {pair for reason in Reason for pair in pairs_in(reason.name.replace("_", " "))}
    for package in ("rockpulse", "rocking"):
        for path in Path(str(files(package))).rglob("*.py"):
            said |= {pair for text in texts_of(path.read_text(encoding="utf-8")) for pair in pairs_in(text)}
    forms = {form: pairs_in(re.sub(r"\{\w+\}", " 0 ", form)) for form in words_of(language).fixed}
    long = {form: pairs for form, pairs in forms.items() if len(pairs) > 1}
    assert len(long) > 100
    assert {form for form, pairs in long.items() if len(pairs & said) < 0.8 * len(pairs)} == set()


def test_every_word_is_asked_for_somewhere():
    folder = files("rockpulse.views.report")
    sources = [one.read_text(encoding="utf-8") for one in folder.iterdir() if one.name.endswith(".py")]
    sources += [one.read_text(encoding="utf-8") for one in folder.joinpath("templates").iterdir() if one.is_file()]
    text = "\n".join(sources)
    tops = {key.partition(".")[0] for key in WORDS.table if "." in key}
    assert {top for top in tops if f"{top}." not in text} == set()
    assert {key for key in WORDS.table if "." not in key and f'"{key}"' not in text} == set()


def test_numbers_have_the_decimal_sign_of_the_language_and_names_stay():
    italian = words_of("it")
    assert italian.ratio(0.412) == "0,41"
    assert italian.between(0.007, 0.94) == "da 0,007 a 0,94"
    assert italian.cell(number(1.31)) == "1,31"
    assert italian.cell(Cell(">10", 10.0)) == ">10"
    assert italian.cell(Cell("CI.CCC..360@20190706T031937")) == "CI.CCC..360@20190706T031937"
    assert italian.cell(Cell("at rest", 0.0)) == "fermo"
    assert WORDS.ratio(0.412) == "0.41"


def test_an_italian_page():
    page = report_page(results_tree(), language="it")
    assert '<html lang="it">' in page
    front = page.split('id="annex"')[0]
    for words in ("Giudizio", "Su che cosa si basa", "terremoti", "Non considerati: scorrimento"):
        assert words in front
    for words in ("earthquake", "verdict<", "Not covered", "smallest", "overturns"):
        assert words not in front.split("<body>")[1]


def pairs_in(text):
    """Neighbouring words in a text, without figures or stops between them."""
    return set(re.findall(r"(?=\b([a-z]{2,} [a-z]{2,})\b)", text.lower()))


def texts_of(source):
    """The texts in a module, those with fields in one piece."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(one.value) if isinstance(one, ast.Constant) else "0" for one in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def words_in(texts):
    """The words of four letters and more."""
    return {word.lower() for text in texts for word in re.findall(r"\b[^\W\d_]{4,}\b", text)}


def told(words):
    """The texts of a language without their fields."""
    every = [*words.table.values(), *words.fixed.values()]
    return [QUOTED.sub("", "".join(text for text, *_ in Formatter().parse(one))) for one in every]


@pytest.fixture(scope="module")
def of_intervals(bursts, bodies, config):
    """Results with intervals of overturning in place of a probability."""
    settings = replace(
        config,
        search=replace(config.search, intervals=True),
        uncertainty=replace(config.uncertainty, probability=False),
    )
    return rp.assess(bursts, settings, bodies)


@pytest.fixture(scope="module")
def of_sequence(site, bodies, config, tmp_path_factory):
    """The design sequence of the site, assessed."""
    path = tmp_path_factory.mktemp("site") / "site.h5"
    rp.save(site, path)
    return rp.assess_sequence(rp.load_design(path), config, bodies)


@pytest.mark.parametrize("language", OTHERS)
@pytest.mark.parametrize("case", ["results", "of_intervals", "of_sequence", "by hand"])
def test_no_english_word_is_left_on_a_page(request, language, case, site, fragility):
    words = words_of(language)
    beside = () if case in ("of_intervals", "by hand") else (site, fragility)
    results = results_tree(cases=2) if case == "by hand" else request.getfixturevalue(case)
    english = words_in([*told(WORDS), *words.fixed]) - words_in(told(words))
    assert {"overturns", "records", "uplift", "earthquakes"} <= english
    axes = ("record", "block", "event", "source")
    names = {str(name) for axis in axes if axis in results["summary"] for name in results["summary"][axis].values}
    names |= {str(name) for name in site["site"]["event"].values} | {REFERENCE}
    names.add(files_used(results).reasons or REFERENCE)
    facts = [words(f"fact.{name}") for name in ("warnings", "processing", "source", "component")]
    texts = page_texts(report_page(results, *beside, language=language), facts, sorted(names, key=len, reverse=True))
    assert len(texts) > 100
    assert {text: found for text in texts if (found := words_in([text]) & english)} == {}


def test_the_numbers_of_pictures_have_the_decimal_sign_of_the_language(results, site, fragility):
    page = report_page(results, site, fragility, language="it")
    pictures = re.findall(r"<svg.*?</svg>", page, re.DOTALL)
    assert len(pictures) > 10
    texts = [text for one in pictures for text in re.findall(r"<text[^>]*>(.*?)</text>", one, re.DOTALL)]
    assert [text for text in texts if re.search(r"\d\.\d", re.sub(r"<[^>]*>", "", text))] == []
    assert sum(bool(re.search(r"\d,\d", re.sub(r"<[^>]*>", "", text))) for text in texts) > 50


def test_a_language_without_words_is_named():
    with pytest.raises(ConfigError, match="no words for 'fr'"):
        words_of("fr")
