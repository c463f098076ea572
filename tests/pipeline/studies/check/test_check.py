"""The check of the bodies of a configuration: worse senses, bodies that a code cannot take, tables that end."""

from dataclasses import replace

import numpy as np
import pytest

import rockpulse as rp
from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError
from rockpulse.studies.check.check import check


def config(**more):
    wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    return rp.Config(bodies=(wall,), check=CheckSettings(spectrum="en_1998_1", ag=0.25, ground="C", **more))


def test_a_dataset_holds_all_codes_with_their_units():
    found = check(config=config())
    assert found["code"].values.tolist() == ["circolare_2009", "circolare_2019", "en_1998"]
    assert found["activation"].attrs["units"] == "m s^-2"
    assert found["activation_ratio"].sel(block="wall", code="circolare_2009").item() == pytest.approx(
        0.1 / 1.35 / 0.14375
    )
    assert "probability" not in found
    assert check(config=config(), code=["en_1998"]).sizes["code"] == 1


def test_a_body_that_a_check_cannot_take_is_told_and_the_others_stand():
    held = rp.BlockSettings(
        name="held", width=0.4, height=4.0, mass=1e3, ties=(rp.TieSettings(height=3.0, stiffness=1e6, side="both"),)
    )
    wall = config().bodies[0]
    found = check(config=rp.Config(bodies=(held, wall), check=config().check))
    assert np.isnan(found["multiplier"].values[0])
    assert "tie without yield_force" in found["statement"].values[0, 0]
    assert found["multiplier"].values[1] == pytest.approx(0.1)


def test_what_cannot_be_checked_at_all_is_an_error():
    with pytest.raises(ConfigError, match="no body to check"):
        check(config=rp.Config(check=config().check))
    with pytest.raises(ConfigError, match="no design spectrum is given"):
        check(config=rp.Config(bodies=config().bodies))
    with pytest.raises(ConfigError, match="expected one of circolare_2009"):
        check(config=config(), code=["asce"])


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"ag": 0.2}, "f0: ntc requires this key in addition to ag"),
        ({"f0": 2.4, "tc_star": 0.3}, "ag: ntc requires this key in addition to f0, tc_star"),
        ({"spectrum": "en_1998_1", "ag": 0.2, "f0": 2.4}, 'f0: it applies only to spectrum = "ntc"'),
        ({"spectrum": "en_1998_2", "ag": 0.2, "topography": "T2"}, "multiply ag by its factor"),
        ({"spectrum": "table", "ag": 0.2}, "takes its values from the file; remove this key"),
        ({"ag": 0.2, "file": "s.csv"}, 'file: it applies only to spectrum = "table"'),
        ({"ag": 25.0}, "ag: expected a positive number in g, <= 5, found 25.0"),
    ],
)
def test_wrong_parameters_are_reported(given, told):
    with pytest.raises(ConfigError, match=told):
        CheckSettings(**given)


def test_of_two_senses_the_worse_acceleration_and_the_worse_displacement_count():
    """0.8 x 4 m, 0.12 m off its middle, 6 t, under type 1, ground B, 0.3 g; a tie of 5 kN at 3.5 m breaks after 3 cm.

    Towards theta > 0 alpha_0 = 0.28/2 + 17.5/117.68 = 0.2887 and d_0 = 0.28 m (the tie is broken by then), towards
    theta < 0 alpha_0 = 0.52/2 = 0.26 and d_0 = 0.52 m: the first to open is not the one that falls first.
    """
    tie = rp.TieSettings(height=3.5, stiffness=1e6, yield_force=5e3, ultimate=0.03)
    body = rp.BlockSettings(name="a", width=0.8, height=4.0, offset=0.12, mass=6000.0, ties=(tie,))
    settings = CheckSettings(spectrum="en_1998_1", ag=0.3, ground="B", confidence_factor=1.0)
    found = check(config=rp.Config(bodies=(body,), check=settings))
    assert found["multiplier"].item() == pytest.approx(0.26)
    assert found["activation_sense"].values.tolist() == [["negative"] * 3]
    assert found["displacement_sense"].values.tolist() == [["positive", "positive", ""]]
    # The tie carries 0.1487 of 0.2887: SLV ends where it breaks, at 0.03/3.5 rad x 2 m (C8.7.1.2.1.6), SLC does not.
    assert found["displacement"].values[0, :2] == pytest.approx([0.112, 0.03 / 3.5 * 2.0])
    assert np.all(found["displacement_ratio"].values[0, :2] < 0.9)
    slc = check(config=rp.Config(bodies=(body,), check=replace(settings, limit_state="slc")), code="circolare_2019")
    assert slc["displacement"].item() == pytest.approx(0.6 * 0.28)
    free = replace(body, ties=(replace(tie, side="negative"),))
    other = check(config=rp.Config(bodies=(free,), check=settings))
    # The tie on the other side leaves theta > 0 at alpha_0 = 0.14, and its displacement as it was.
    assert other["multiplier"].item() == pytest.approx(0.14)
    assert other["displacement"].values[0, :2] == pytest.approx([0.112, 0.112])


def test_a_table_that_ends_early_costs_only_what_it_does_not_reach(tmp_path):
    (tmp_path / "short.csv").write_text("period [s],Sa [g]\n0,0.3\n0.2,0.7\n1,0.3\n")
    settings = CheckSettings(spectrum="table", file="short.csv", confidence_factor=1.0)
    wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    found = check(config=rp.Config(bodies=(wall,), check=settings, folder=tmp_path))
    assert found["activation_ratio"].values[0] == pytest.approx([0.1 / 0.15, 0.1 / 0.15, 0.1 / 0.3])
    assert np.isnan(found["displacement_ratio"].values).all()
    told = found["statement"].values[0].tolist()
    assert "the table ends at 1 s, but 1.24 s is needed: extend it" in told[0]
    assert "but 1.95 s is needed" in told[1]
    assert told[2] == ""


def test_a_beam_that_loses_its_support_limits_the_displacement():
    """0.1 m at 4 m: 0.025 rad x 2 m = 0.05 m of the centre of mass, before 0.4 d_0 (0.08 m) and 0.6 d_0."""
    roof = rp.LoadSettings(weight=1e3, height=4.0, friction=0.4, support=0.1)
    wall = rp.BlockSettings(name="wall", width=0.4, height=4.0, mass=6000.0, loads=(roof,))
    assert wall.block().restraints is not None  # the support is no argument of the model
    for state in ("slv", "slc"):
        settings = CheckSettings(spectrum="en_1998_1", ag=0.25, limit_state=state)
        found = check(config=rp.Config(bodies=(wall,), check=settings), code="circolare_2019")
        assert found["displacement"].item() == pytest.approx(0.05)


def parapet(**more):
    return rp.BlockSettings(name="parapet", width=0.3, height=1.2, density=1800.0, length=1.0, **more)


def test_the_period_of_a_cantilever_is_that_of_the_beam():
    """T_0 = 6.2 x 4 x 1.2 m x sqrt(1800/1e9) = 0.0399 s; a beam with distributed mass has 2 pi sqrt(12)/1.8751^2."""
    found = parapet(elastic_modulus=1e9).initial_period
    assert found == pytest.approx(6.2 * 4.0 * 1.2 * (1800.0 / 1e9) ** 0.5)
    assert found == pytest.approx(2.0 * np.pi * 12.0**0.5 / 1.8751**2 * 4.0 * 1.2 * (1800.0 / 1e9) ** 0.5, rel=2e-3)
    assert parapet(elastic_modulus=1e9, kappa=2.2).initial_period == pytest.approx(found * 2.2 / 6.2)
    assert parapet().initial_period == 0.0


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"kappa": 6.2}, "kappa: it applies only with elastic_modulus"),
        ({"elastic_modulus": 1e9, "one_sided": True}, "no wall, ties, loads or thrusts"),
    ],
)
def test_an_element_that_is_not_free_to_vibrate_has_no_period(wrong, told):
    with pytest.raises(ConfigError, match=told):
        parapet(**wrong)


def test_a_tie_without_ultimate_is_stated_and_gives_no_displacement():
    """d_0 is that of the free wall, so that the allowed displacement does not grow with the force of the tie."""
    common = {"width": 0.4, "height": 4.0, "mass": 2000.0}
    tie = {"height": 3.5, "stiffness": 1e6, "yield_force": 1e4, "side": "both"}
    bodies = [
        rp.BlockSettings(name="free", **common),
        rp.BlockSettings(name="endless", **common, ties=(rp.TieSettings(**tie),)),
        rp.BlockSettings(name="limited", **common, ties=(rp.TieSettings(**tie, ultimate=0.4),)),
    ]
    settings = rp.CheckSettings(spectrum="en_1998_1", ag=0.15)
    found = rp.check(config=rp.Config(bodies=tuple(bodies), check=settings), code=["circolare_2009", "en_1998"])
    allowed = found["displacement"].sel(code="circolare_2009").values
    assert allowed == pytest.approx([0.08, 0.08, 0.08])
    assert (found["activation"][1] > found["activation"][0]).all()
    said = found["statement"].values
    assert "a tie has no ultimate elongation" in said[1, 0]
    assert [said[0, 0], said[2, 0], said[1, 1]] == ["", "", ""]
