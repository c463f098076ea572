"""Facts that a header states twice: where they differ, every reader tells (`make mutate` prints the table)."""

from __future__ import annotations

import header_facts
import pytest
from header_fact_table import TABLE
from header_facts import HeaderFact, facts, said

from rockpulse.readers import FORMATS

FACTS = list(facts())


def test_every_format_that_is_read_has_facts():
    assert {fact.format for fact in FACTS} == {row.name for row in FORMATS if row.unit != "-"}


def test_no_fact_is_listed_twice():
    assert len({(fact.sample, fact.what) for fact in FACTS}) == len(FACTS) == sum(map(len, TABLE.values()))


@pytest.mark.parametrize("fact", FACTS, ids=lambda fact: f"{fact.sample}-{fact.what}")
def test_a_fact_that_differs_from_its_partner_is_told(fact):
    told = fact.told()
    if fact.partner:
        assert told != "silent", f"{fact.what} of {fact.sample} changed, {fact.partner} not: nobody tells"
    else:
        assert told == "silent", f"{fact.what} of {fact.sample} is told by a {told}: name its partner"


def test_a_reader_that_says_nothing_is_seen(monkeypatch, capsys):
    silent = HeaderFact("CLC090.AT2", "interval", rb"(?<=DT= )0\.0100", b"0.0200", "a partner that nobody asks")
    monkeypatch.setattr(header_facts, "facts", lambda: iter([silent, FACTS[0]]))
    assert header_facts.main() == 1
    assert "2 facts with a partner: 1 told by a warning, 0 by a refusal, 1 silent; 0 facts" in capsys.readouterr().out


def test_a_change_keeps_the_width_and_happens():
    for sample in ("CLC090.AT2", "CI.CLC.xml"):
        assert said(sample, header_facts.contents()[sample])[1] == []
    with pytest.raises(ValueError, match="found 0"):
        HeaderFact("CLC090.AT2", "interval", rb"DT= 9", b"DT= 8", "").mutated()
    with pytest.raises(ValueError, match="found 1"):
        HeaderFact("CLC090.AT2", "interval", rb"DT= 0", b"DT= 10", "").mutated()
