"""The sections against the functions and tables that they serve."""

import dataclasses
import inspect

import pytest

import rockpulse as rp
from rockpulse import ConditioningSettings, ModelSettings, SequenceSettings
from rockpulse.config.configuration import SECTIONS, Config
from rockpulse.errors import ConfigError


def words_of(section, name):
    return section.__dataclass_fields__[name].metadata["values"].words


def test_a_section_unpacks_as_keyword_arguments():
    assert dict(**SequenceSettings(main_count=3))["main_count"] == 3
    assert set(ConditioningSettings().keys()) == {field.name for field in dataclasses.fields(ConditioningSettings)}


def test_python_values_are_checked_like_those_of_a_file():
    with pytest.raises(ConfigError, match=r"\[models\] gain: expected one of .*found 'exakt'; did you mean \"exact\""):
        ModelSettings(gain="exakt")


def test_the_words_are_those_of_the_modules_that_act_on_them():
    from rocking.impulses.impulse_sequence import SPACINGS
    from rockpulse.readers.format import RESPONSES
    from rockpulse.record.conditioning import BASELINES
    from rockpulse.record.intensity import INTENSE_PHASES
    from rockpulse.selection.directions import DIRECTIONS
    from rockpulse.sequences import estimators

    served = {
        ("records", "components"): ("horizontal", *DIRECTIONS),
        ("records", "response"): RESPONSES,
        ("conditioning", "baseline"): BASELINES,
        ("intense_phase", "method"): INTENSE_PHASES,
        ("sequence", "spacing"): SPACINGS,
        ("sequence", "main"): estimators.MAIN,
        ("sequence", "secondary"): estimators.SECONDARY,
        ("sequence", "interval"): estimators.INTERVAL,
        ("sequence", "main_count"): estimators.MAIN_COUNT,
    }
    for (section, name), table in served.items():
        assert set(words_of(SECTIONS[section], name)) == set(table), name


def test_models_are_kept_in_the_order_of_their_table():
    assert ModelSettings(use=["nonlinear", "resonance"]).use == ("resonance", "nonlinear")


@pytest.mark.parametrize("section", ["conditioning", "half_waves", "intense_phase", "sequence"])
def test_a_section_has_the_names_and_defaults_of_the_function_it_serves(section):
    functions = {
        "conditioning": rp.condition,
        "half_waves": rp.half_waves,
        "intense_phase": rp.intense_phase,
        "sequence": rp.record_sequence,
    }
    parameters = list(inspect.signature(functions[section]).parameters.values())[1:]
    stated = dict(**getattr(Config(), section))
    stated.pop("method", None) if section == "sequence" else None
    assert {p.name: p.default for p in parameters if p.name != "phase"} == stated
