"""A record made ready for the models: the vertical beside it, and the sequence that it is assessed by."""

from dataclasses import replace

import numpy as np
import pytest
from nominal import scene_of_record

import rockpulse as rp
from rockpulse.assessment.scene import extract

T = np.arange(0.0, 6.0, 0.01)
RECORD = rp.Record(3.0 * np.sin(9.0 * T) * np.exp(-(((T - 3.0) / 1.5) ** 2)), dt=0.01, id="burst", processed=True)
CONFIG = rp.Config(models=rp.ModelSettings(use=("sequence", "nonlinear")))


def codes(record):
    return [getattr(warning, "code", "") for warning in record.warnings]


@pytest.mark.parametrize(("samples", "short"), [(600, False), (599, False), (598, True), (300, True)])
def test_a_vertical_that_ends_more_than_a_sample_early_is_reported(samples, short):
    up = rp.Record(np.cos(T[:samples]), dt=0.01, id="up", processed=True, warnings=("clipped",))
    scene = extract(RECORD, CONFIG, up)
    np.testing.assert_allclose(scene.vertical, np.where(np.arange(600) < samples, np.cos(T), 0.0), atol=1e-12)
    assert codes(scene.record) == ["of_vertical/plain"] + ["vertical_short"] * short
    assert [getattr(note, "code", "") for note in scene.record.processing] == ["vertical_acceleration"]


def test_without_a_vertical_nothing_is_told_and_both_are_conditioned_alike():
    assert (extract(RECORD, CONFIG).vertical, extract(RECORD, CONFIG).record.warnings) == (None, ())
    linear = replace(CONFIG, conditioning={"baseline": "mean"})
    up = rp.Record(1.0 + np.cos(T), dt=0.01, id="up", processed=True)
    scene = scene_of_record(rp.Record(RECORD.acceleration + 0.2, dt=0.01, id="burst"), linear, up)
    assert abs(scene.record.acceleration.mean()) < 1e-12
    assert scene.vertical == pytest.approx(np.cos(T) - np.cos(T).mean())
    assert scene_of_record(RECORD, linear).vertical is None


@pytest.mark.parametrize(("method", "rule"), [("rule", "conservative"), ("statistics", "")])
def test_the_rule_of_a_sequence_is_named(method, rule):
    asked = replace(CONFIG, sequence=replace(CONFIG.sequence, method=method))
    assert extract(RECORD, asked).rule == rule
