"""Bodies on the floors of buildings, through an assessment."""

import numpy as np
import pytest

import rockpulse as rp
from rockpulse import models

T = np.arange(0.0, 6.0, 0.01)
GROUND = 1.5 * np.sin(2.0 * np.pi * T / 0.7) * np.exp(-(((T - 2.0) / 1.0) ** 2))
RECORD = rp.Record(GROUND, dt=0.01, id="burst", processed=True)
FLOOR = rp.FloorSettings(period=0.5, participation=1.3)


def body(name, **options):
    return rp.BlockSettings(name=name, width=0.4, height=3.0, **options)


def config(*blocks, **options):
    asked = rp.ModelSettings(use=("sequence", "nonlinear"), histories=True)
    return rp.Config(blocks=blocks, models=asked, search=rp.SearchSettings(intervals=True, points=16), **options)


def test_a_body_aloft_is_shaken_by_its_floor_and_the_others_by_the_ground():
    blocks = body("ground"), body("aloft", floors=(FLOOR,)), body("below", friction=0.2)
    tree = rp.assess([RECORD], config(*blocks))
    summary = tree["summary"].isel(record=0).sel(model="nonlinear")
    floor = models.floor_motion(GROUND, 0.01, 0.5, participation=1.3, quiet=1e-4 * 9.80665)
    block = body("one").block()
    aloft = models.recorded_response(block, floor.acceleration, floor.dt)
    ground = models.recorded_response(block, GROUND, 0.01)
    peaks = summary["peak_rotation_ratio"].values.tolist()
    assert peaks == [ground.peak_rotation_ratio, aloft.peak_rotation_ratio, ground.peak_rotation_ratio]
    assert summary["floor_amplification"].values.tolist() == pytest.approx([1.0, floor.amplification, 1.0])
    ratio = summary["uplift_ratio"].values
    assert ratio[1] == pytest.approx(ratio[0] * floor.amplification)
    asked = summary["friction_required"].values
    assert np.isnan(asked[:2]).all()
    assert asked[2] == pytest.approx(models.sliding_demand(block, GROUND, 0.01).required[0])
    history = {one.model: one for one in rp.plots.histories(tree, "burst", "aloft", ["nonlinear"])}["nonlinear"]
    known = np.abs(history.rotation[np.isfinite(history.rotation)])
    assert np.max(known) <= history.peak + 1e-12


def test_a_body_is_answered_alike_alone_and_among_others():
    blocks = body("ground"), body("aloft", floors=(FLOOR,))
    together = rp.assess([RECORD], config(*blocks))["summary"].isel(record=0)
    for block in blocks:
        alone = rp.assess([RECORD], config(block))["summary"].isel(record=0, block=0)
        for name in ("peak_rotation_ratio", "safety_factor", "overturning_probability", "uplift_ratio", "factor_50"):
            assert np.array_equal(together[name].sel(block=block.name), alone[name], equal_nan=True), name


def test_a_stiff_building_is_the_ground():
    stiff = body("aloft", floors=(rp.FloorSettings(period=0.01),))
    summary = rp.assess([RECORD], config(body("ground"), stiff))["summary"].isel(record=0).sel(model="nonlinear")
    assert summary["floor_amplification"].values[1] == pytest.approx(1.0, abs=0.01)
    assert np.ptp(summary["capacity_mean"].values) < 0.05 * summary["capacity_mean"].values[0]


def test_a_body_heavy_beside_its_floor_gets_a_remark():
    floor = rp.FloorSettings(period=0.5, mass=1e4)
    summary = rp.assess([RECORD], config(body("heavy", mass=2e3, floors=(floor,))))["summary"]
    assert "is 0.2 of its floor's" in str(summary["block_warnings"].values[0])


def test_what_is_of_the_ground_refuses_bodies_aloft():
    aloft = config(body("aloft", floors=(FLOOR,)))
    with pytest.raises(rp.ConfigError, match=r"\[\[block.floor\]\] of aloft: fragility"):
        rp.fragility_curves([RECORD], aloft)
    sequence = models.ImpulseSequence(0.5, 0.1, interval=0.1, duration=10.0, main_count=3)
    with pytest.raises(rp.ConfigError, match=r"\[\[block.floor\]\] of aloft: a design sequence"):
        rp.assess_sequence(sequence, aloft)
