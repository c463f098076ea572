"""Text that is obeyed in place of being shown: escapes of terminals, formulas of spreadsheets, marks of direction."""

import unicodedata

import pytest

from rockpulse.foreign_text import escaped, first_line, not_a_formula


def test_every_control_character_but_tab_and_the_end_of_a_line_is_an_escape():
    everything = "".join(map(chr, range(0x11000)))
    left = [letter for letter in escaped(everything) if unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp")]
    assert left == ["\t", "\n"]
    assert escaped("\x1b[2J\x07\x9b1m\r\u202egnp.exe\u2066\x7f") == (r"\x1b[2J\x07\x9b1m\r\u202egnp.exe\u2066\x7f")


@pytest.mark.parametrize("text", ["", "façade", "Ύδρα", "鳥取", "a\tb\nc", "naïve 10 °C", "🗿", "\u200cjoined\u200d"])
def test_letters_of_any_language_stay(text):
    assert escaped(text) == text


@pytest.mark.parametrize("text", ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "--", "+39 06", "-1.5e"])
def test_what_a_spreadsheet_computes_is_text(text):
    assert not_a_formula(text) == "'" + text


@pytest.mark.parametrize("text", ["", "-", "+", "-1.5", "+2", "-3e-05", "wall", "a=b", "'=1"])
def test_numbers_and_other_texts_stay(text):
    assert not_a_formula(text) == text


def test_a_foreign_message_is_one_line_of_bounded_length():
    assert first_line("  \nUnable to open\n  #000 H5F.c line 1") == "Unable to open"
    assert first_line(KeyError()) == "KeyError"
    assert len(first_line("x" * 10_000)) == 303
