"""The words of every language: none is missing, none has other fields, and a page holds no English in between."""

import re
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from string import Formatter
from time import process_time

import numpy as np
import pytest
import xarray as xr
from fuzz_inputs import kept_corpus, opened
from page_texts import QUOTED, READERS, page_texts
from results_tree import BLOCKS, RECORDS, results_tree

import rockpulse as rp
from rocking.response import Reason
from rockpulse.errors import ConfigError, Failure, RockpulseError
from rockpulse.model_table import MODELS
from rockpulse.readers import read_source
from rockpulse.readers.folders import Found, read_failure
from rockpulse.readers.kit.text import GIVE_UNIT
from rockpulse.record.conditioning import condition
from rockpulse.record.record import Record
from rockpulse.storage.variables import failure_table
from rockpulse.views.report.content import REFERENCE, page_content
from rockpulse.views.report.report_pictures import Pictures
from rockpulse.views.report.site_and_fragility import matched_file
from rockpulse.views.report.writing import report_page
from rockpulse.views.shared.files_used import files_used, translated_row
from rockpulse.views.shared.formatting import between, ratio
from rockpulse.views.shared.table_columns import columns, filled
from rockpulse.views.shared.words import LANGUAGES, in_numerals, result_texts, say, table, warning_words, writing
from rockpulse.warning_text import PLAIN, TEMPLATES, WarningText, with_codes

WORDS = table("en")
OTHERS = [language for language in LANGUAGES if language != "en"]

#: Sections of other languages for what is declared in English below the views.
BELOW = ("labels", "variables", "measures", "model_words", "parameters", "names", "warnings", "phrases", "options")
BELOW += ("other",)

#: Frequent English words that no other language has.
ENGLISH = re.compile(
    r"\b(the|of|is|are|was|were|not|and|it|its|which|with|from|has|have|by|to|for|at|an|as|that|this|only|on|one|be|"
    r"than|but|found|expected|write|correct|read|says|states)\b"
)
#: Quotations from files, names of files and ids, and what is typed.
FROM_FILES = re.compile(r"'[^']*'|\"[^\"]*\"|«[^»]*»|\S*[/.@]\S*|--\w+|\[+[\w.]+\]+|\w+ = \S+")


def fields(text):
    return {name for _, name, _, _ in Formatter().parse(text) if name}


def fixed_parts(text):
    return [part for fixed, *_ in Formatter().parse(text) if (part := fixed.strip(" ;,"))]


@pytest.mark.parametrize("language", OTHERS)
def test_no_word_is_missing_and_no_field_differs(language):
    other = {key: text for key, text in table(language).items() if key.partition(".")[0] not in BELOW}
    assert set(other) == set(WORDS)
    assert {key for key, text in WORDS.items() if fields(text) != fields(other[key])} == set()
    assert {text for text in other.values() if not text.strip()} == set()


@pytest.mark.parametrize("language", OTHERS)
def test_what_is_declared_below_has_words(language):
    told = {key.partition(".")[2]: text for key, text in table(language).items() if key.startswith("warnings.")}
    assert {code for code, text in told.items() if fields(text) != fields(TEMPLATES[code])} == set()
    assert set(TEMPLATES) - {PLAIN} == set(told)
    phrases = {key.partition(".")[2]: text for key, text in table(language).items() if key.startswith("phrases.")}
    assert {english for english, text in phrases.items() if not fields(text) <= fields(english)} == set()
    sources = [path.read_text(encoding="utf-8") for path in Path(str(files("rockpulse"))).rglob("*.py")]
    sources += [path.read_text(encoding="utf-8") for path in Path(str(files("rocking")), "body").glob("*.py")]
    written = re.sub(r'"\s*\n\s*f?"', "", "\n".join(sources))  # a text over several lines
    own = {english for english in phrases if not english.startswith("[Errno")}  # of the operating system
    assert {english for english in own if not any(part in written for part in fixed_parts(english))} == set()
    assert {f"{of}.{name}" for of in ("model_words", "labels") for name in MODELS} <= set(table(language))
    assert {f"models.{name}" for name in MODELS} <= set(WORDS)
    assert {f"unknown.{reason.name.lower()}" for reason in Reason if reason} <= set(WORDS)


def test_every_word_is_asked_for_and_every_one_asked_for_is_there():
    folders = [Path(str(files(f"rockpulse.{room}"))) for room in ("views", "app")]
    found = [one for folder in folders for one in folder.rglob("*") if one.suffix in (".py", ".html")]
    texts = {one: one.read_text(encoding="utf-8") for one in found}
    text = "\n".join(texts.values())
    tops = {key.partition(".")[0] for key in WORDS if "." in key}
    assert {top for top in tops if f"{top}." not in text and f'"{top}"' not in text} == set()
    assert {key for key in WORDS if "." not in key and f'"{key}"' not in text} == set()
    sources = "\n".join(text for one, text in texts.items() if one.suffix == ".py")
    asked = set(re.findall(r'\bsay\(\s*"([\w.-]+)"', sources))
    assert len(asked) > 100
    assert {one for one in asked - set(WORDS) if not one.startswith("other.")} == set()


def test_numbers_have_the_decimal_sign_of_the_language_and_names_stay():
    with writing("it"):
        assert ratio(0.412) == "0,41"
        assert between(0.007, 0.94, ratio) == "da 0,007 a 0,94"
        rows = {"factor_10": [1.31, float("inf")], "factor_10_low": [1.0, 12.5]}
        (cell,), (none,) = filled(columns("factor_10"), rows)
        assert (cell.marked, none.marked) == ("1,31", ">12,5")
        assert in_numerals("CI.CCC..360@20190706T031937, 1.5 s") == "CI.CCC..360@20190706T031937, 1,5 s"
        assert say("answer.at_rest") == "fermo"
    assert ratio(0.412) == "0.41"


def test_a_warning_is_told_by_its_code_and_values():
    warning = WarningText("outside_spectrum", names="wall 2.5")
    assert warning_words(warning) == str(warning)
    with writing("it"):
        assert "wall 2.5" in warning_words(warning)
        assert warning_words(warning) != str(warning)
        few = warning_words(WarningText("too_few_events", count=3, least=7, quantile=0.84))
        assert "0,84" in few
        clipped = warning_words(WarningText("of_vertical", warning=WarningText("clipped", count=8, end="largest")))
        assert clipped.startswith("canale verticale: 8 campioni consecutivi al valore massimo: ")


def test_a_reason_keeps_its_place_and_values_and_what_was_typed():
    file = "/d/a b.AT2"
    said = (
        (
            ":12: expected 3 finite numbers, found '1; x'; correct the line",
            ":12: atteso: 3 numeri finiti, trovato: '1; x'; correggere la riga",
        ),
        (
            ": expected 400 samples (header), found 24; the file may be truncated: download it again",
            ": l'intestazione dichiara 400 campioni, il file ne contiene 24; il file potrebbe essere troncato:",
        ),
        (
            f": plain columns do not state their unit; {GIVE_UNIT.advice(file)}",
            ": le colonne non indicano la propria unità; indicare l'unità con --units g",
        ),
    )
    with writing("it"):
        for reason, words in said:
            row = translated_row(Failure(file, "read", f"{file}{reason}", "failed"))
            assert row.reason.startswith(f"{file}{words}")


def test_stored_texts_are_translated_with_their_numbers():
    record = Record(np.sin(np.arange(4000) * 0.05) + 0.5, dt=0.01, id="a", processed=False)
    drift = WarningText("baseline_drift", velocity=-0.96, slow=0.31, rest=0.2, pgv=0.96)
    warnings, codes = with_codes([drift, WarningText("of_channel", channel="HNE", warning=WarningText("dead_channel"))])
    structural = "channel on a structure; it was read but not assessed: only ground motion is assessed"
    with writing("it"):
        assert result_texts(f"{structural} ([records] structural = true assesses it as well)").startswith(
            "canale su una"
        )
        first, second = result_texts(warnings, codes).splitlines()
        steps = result_texts("\n".join(condition(record, highpass_hz=0.1, resample_s=0.005).processing)).splitlines()
        assert result_texts("una nota del committente, 0.5 m") == "una nota del committente, 0.5 m"
    assert "-0,96 m/s, la sua componente lenta (deriva) raggiunge 0,31 m/s" in first
    assert second == "HNE: tutti i campioni sono uguali: canale non funzionante"
    begins = "linea di base, linea di base, finestratura, filtro, ricampionamento"
    assert ", ".join(step.partition(":")[0] for step in steps) == begins
    assert not re.search(r"\d\.\d", " ".join(steps))


def words_in(texts):
    """The words of four letters and more."""
    return {word.lower() for text in texts for word in re.findall(r"\b[^\W\d_]{4,}\b", text)}


def told(words):
    """The texts of a language without their fields."""
    every = table(words).values()
    return [QUOTED.sub("", "".join(text for text, *_ in Formatter().parse(one))) for one in every]


@pytest.fixture(scope="module")
def of_intervals(bursts, bodies, config):
    """Results with intervals of overturning in place of a probability."""
    search, uncertainty = replace(config.search, intervals=True), replace(config.uncertainty, probability=False)
    return rp.assess(bursts, replace(config, search=search, uncertainty=uncertainty), bodies)


@pytest.fixture(scope="module")
def of_sequence(site, bodies, config, tmp_path_factory):
    """The design sequence of the site, assessed."""
    path = tmp_path_factory.mktemp("site") / "site.h5"
    rp.save(site, path)
    return rp.assess_sequence(rp.load_design(path), config, {name: bodies[name] for name in list(bodies)[:2]})


@pytest.mark.sweep
@pytest.mark.parametrize("language", OTHERS)
@pytest.mark.parametrize(
    "case",
    ["results", "by hand", *(pytest.param(one, marks=pytest.mark.slow) for one in ("of_intervals", "of_sequence"))],
)
def test_no_english_word_is_left_on_a_page(request, language, case, site, fragility, letters_alone):
    beside = () if case in ("of_intervals", "by hand") else (site, fragility)
    results = results_tree(cases=2) if case == "by hand" else request.getfixturevalue(case)
    english = words_in(told("en")) - words_in(told(language))
    assert {"overturns", "records", "uplift", "earthquakes"} <= english
    axes = ("record", "block", "event", "source")
    names = {str(name) for axis in axes if axis in results["summary"] for name in results["summary"][axis].values}
    names |= {str(name) for name in site["site"]["event"].values} | {REFERENCE}
    names.add(files_used(results).reasons or REFERENCE)
    invented = case == "by hand"  # warnings and reasons that no reader gives
    kept = ("source", "component", *(("warnings", "processing") if invented else ()))
    facts = [table(language)[f"fact.{name}"] for name in kept]
    page, longest = report_page(results, *beside, language=language), sorted(names, key=len, reverse=True)
    texts = page_texts(page, facts, longest, READERS if invented else frozenset())
    assert f'<html lang="{language}">' in page
    assert len(texts) > 100
    assert {text: found for text in texts if (found := words_in([text]) & english)} == {}


def of_damaged_files(step):
    """The failures of every `step`-th damaged file of the corpus, and the warnings on the records of the others."""
    rows, warnings = [], {}
    for data in kept_corpus()[::step]:
        file, options = opened(data)
        try:
            warnings |= {str(one): one for record in read_source(file, options) for one in record.warnings}
        except RockpulseError as error:
            rows.append(read_failure(Found(file.name, True), file.name, error))
    return rows, list(warnings.values())


def test_a_reason_with_many_quotations_is_translated_at_once():
    row = Failure("a.csv", "read", "a.csv:9: expected 2 columns, found 20: " + ",".join(['""'] * 60), "failed")
    begin = process_time()
    with writing("it"):
        assert not ENGLISH.search(translated_row(row).reason)
    assert process_time() - begin < 1.0  # 25 s if each quotation could be read in two ways


@pytest.mark.sweep
@pytest.mark.parametrize("language", OTHERS)
def test_reasons_and_warnings_on_damaged_files_are_not_english(language):
    rows, warnings = of_damaged_files(step=12)
    rows.append(Failure("a.txt", "read", "a.txt:3: a sentence of the reader that has no translation; try it", "failed"))
    texts, codes = with_codes([*warnings, "a note of the reader that has no translation"])
    results = results_tree()
    summary = results["summary"].to_dataset()
    summary["warnings"][0], summary["warning_codes"][0] = texts, codes
    results = results.assign({"summary": xr.DataTree(summary), "failures": xr.DataTree(failure_table(rows))})
    names = sorted({*RECORDS, *BLOCKS, REFERENCE, *(row.file for row in rows)}, key=len, reverse=True)
    told = page_texts(report_page(results, language=language), (), names)
    found = [text for text in told if ENGLISH.search(FROM_FILES.sub("", text))]
    assert len(rows) > 40
    assert len(warnings) > 20
    assert found == []
    with writing(language):
        unknown = [row for row in map(translated_row, rows) if say("other.reason") in row.reason]
        assert say("other.reason") in translated_row(rows[-1]).reason
    assert len(unknown) < 0.1 * len(rows)


@pytest.mark.sweep
def test_the_numbers_of_pictures_have_the_decimal_sign_of_the_language(results, fragility):
    beside = matched_file(results, fragility, "fragility", "it")
    with writing("it"):
        pictures = Pictures(results, None, beside, page_content(results).found)
        drawn = [str(one.svg) for one in (pictures.body(0), pictures.strip(0), pictures.fragility("stele"))]
    texts = [re.sub(r"<[^>]*>", "", text) for text in re.findall(r"<text[^>]*>(.*?)</text>", "".join(drawn), re.DOTALL)]
    assert [text for text in texts if re.search(r"\d\.\d", text)] == []
    assert sum(bool(re.search(r"\d,\d", text)) for text in texts) > 10


def test_a_language_without_words_is_named():
    with pytest.raises(ConfigError, match="unknown code 'fr'"), writing("fr"):
        pass
