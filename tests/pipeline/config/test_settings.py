"""The sections against the functions and tables that they serve."""

import dataclasses
import inspect

import pytest

import rockpulse as rp
from rockpulse import ConditioningSettings, ModelSettings, SequenceSettings
from rockpulse.config.configuration import Config
from rockpulse.errors import ConfigError


def test_a_section_unpacks_as_keyword_arguments():
    assert dict(**SequenceSettings(main_count=3))["main_count"] == 3
    assert set(ConditioningSettings().keys()) == {field.name for field in dataclasses.fields(ConditioningSettings)}


def test_python_values_are_checked_like_those_of_a_file():
    with pytest.raises(ConfigError, match=r"\[models\] gain: expected one of .*found 'exakt'; did you mean \"exact\""):
        ModelSettings(gain="exakt")


def test_the_words_are_those_of_the_modules_that_act_on_them():
    from rocking.sequence import SPACINGS
    from rockpulse.calibration import estimators
    from rockpulse.config import settings
    from rockpulse.motions.directions import DIRECTIONS
    from rockpulse.readers.format import RESPONSES
    from rockpulse.record.conditioning import BASELINES
    from rockpulse.record.intensity import INTENSE_PHASES
    from rockpulse.studies.site.design import DESIGN

    assert ("horizontal", *DIRECTIONS) == settings.COMPONENTS
    assert tuple(RESPONSES) == settings.RESPONSES
    assert tuple(BASELINES) == settings.BASELINES
    assert tuple(INTENSE_PHASES) == settings.PHASES
    assert tuple(SPACINGS) == settings.SPACINGS
    assert tuple(DESIGN) == settings.DESIGNS
    for stated, table in (
        (settings.MAINS, estimators.MAIN),
        (settings.SECONDARIES, estimators.SECONDARY),
        (settings.INTERVALS, estimators.INTERVAL),
        (settings.MAIN_COUNTS, estimators.MAIN_COUNT),
    ):
        assert set(stated) == set(table)


def test_models_are_kept_in_the_order_of_their_table():
    assert ModelSettings(use=["nonlinear", "resonance"]).use == ("resonance", "nonlinear")


@pytest.mark.parametrize("section", ["conditioning", "half_waves", "intense_phase", "sequence"])
def test_a_section_has_the_names_and_defaults_of_the_function_it_serves(section):
    functions = {
        "conditioning": rp.condition,
        "half_waves": rp.half_waves,
        "intense_phase": rp.intense_phase,
        "sequence": rp.calibrate,
    }
    parameters = list(inspect.signature(functions[section]).parameters.values())[1:]
    stated = dict(**getattr(Config(), section))
    stated.pop("method", None) if section == "sequence" else None
    assert {p.name: p.default for p in parameters if p.name != "phase"} == stated
