"""The words of every language: none is missing, none has other fields, and a page holds no English in between."""

from importlib.resources import files
from string import Formatter

import pytest
from report_cases import WORDS
from results_tree import results_tree

from rockpulse.errors import ConfigError
from rockpulse.ladder import MODELS, UPPER_BOUND
from rockpulse.views.report.wording import LANGUAGES, words_of
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared import answer_cells, record_marks, verdict_notes
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


def test_a_language_without_words_is_named():
    with pytest.raises(ConfigError, match="no words for 'fr'"):
        words_of("fr")
