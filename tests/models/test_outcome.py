"""The words of outcomes and of the reasons why there is none, by the numbers that files of results keep."""

from rocking.response import Outcome, Reason


def test_outcomes_and_reasons_count_up_from_0_and_each_has_a_word():
    assert [one.word for one in Outcome] == ["at_rest", "rocks", "overturns", "unresolved"]
    assert [one.name.lower() for one in Reason] == [
        "none",
        "impact_limit",
        "free_flight",
        "half_cycle_limit",
        "no_sequence",
        "short_interval",
        "not_modelled",
    ]
    for every in (Outcome, Reason):
        assert [*every] == list(range(len(every)))
