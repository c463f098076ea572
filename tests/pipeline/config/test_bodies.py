"""Named bodies as lanes."""

import numpy as np
import pytest

from rockpulse import BlockSettings
from rockpulse.config.bodies import gather_bodies
from rockpulse.errors import ConfigError
from rockpulse.models import Block

WALL = BlockSettings(name="wall", width=0.4, height=3.0)
STATUE = BlockSettings(name="statue", p=2.4, alpha=0.3, restitution=0.85)


def test_lanes_stand_in_the_order_of_the_bodies():
    bodies = gather_bodies([WALL, STATUE])
    assert bodies.names == ("wall", "statue")
    assert bodies.lanes.p == pytest.approx([WALL.block().p, 2.4])
    assert bodies.lanes.restitution == pytest.approx([WALL.block().restitution, 0.85])
    assert bodies.width == pytest.approx([0.4, np.nan], nan_ok=True)
    assert bodies.cases == 1


def test_restitution_list_makes_cases_and_repeats_single_values():
    column = BlockSettings(name="column", width=1.0, height=6.0, restitution=[0.9, 0.95, 0.99])
    bodies = gather_bodies([column, STATUE])
    assert bodies.cases == 3
    assert bodies.per_case(bodies.lanes.restitution) == pytest.approx(np.array([[0.9, 0.95, 0.99], [0.85] * 3]))


def test_mapping_of_blocks_is_taken_as_it_is():
    bodies = gather_bodies({"pier": Block(1.0, 4.0)})
    assert bodies.width == pytest.approx([1.0])
    assert bodies.lanes.shape == (1,)


def test_warnings_stay_with_their_body():
    squat = BlockSettings(name="squat", width=1.0, height=2.0, restitution=0.95)
    bodies = gather_bodies([WALL, squat])
    assert bodies.warnings[0] == ""
    assert "Housner" in bodies.warnings[1]
    assert "slenderness 2" in bodies.warnings[1]


def test_bodies_apart_have_each_restitution_once_and_a_name_for_each():
    several = [
        BlockSettings(name=name, width=1.0, height=6.0, restitution=[0.9, c]) for name, c in (("a", 0.95), ("b", 0.9))
    ]
    names, lanes, owner = gather_bodies([several[0], STATUE, several[1]]).apart()
    assert names == ["a C 0.9", "a C 0.95", "statue", "b"]
    assert lanes.restitution.tolist() == [0.9, 0.95, 0.85, 0.9]
    assert lanes.p[2] == 2.4
    assert owner.tolist() == [0, 0, 1, 2]
    assert gather_bodies([WALL, STATUE]).apart()[0] == ["wall", "statue"]


def test_names_of_bodies_apart_differ_however_close_the_restitutions_are():
    close = BlockSettings(name="a", width=1.0, height=6.0, restitution=[0.9, 0.90000001])
    assert gather_bodies([close]).apart()[0] == ["a C 0.9", "a C 0.90000001"]
    other = BlockSettings(name="a C 0.90000001", width=1.0, height=6.0)
    with pytest.raises(ConfigError, match=r'block "a C 0\.90000001": this name is also that of'):
        gather_bodies([close, other]).apart()


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        ({}, "no body to assess"),
        (
            {"a": Block(1.0, 4.0, restitution=[0.8, 0.9]), "b": Block(1.0, 4.0, restitution=[0.7, 0.8, 0.9])},
            "equal length",
        ),
        ({"a": Block(1.0, 4.0), "b": Block(1.0, 4.0, gravity=9.81)}, "gravity"),
        ({"a": Block(half_width=[0.5, 0.6], half_height=2.0)}, "only in restitution"),
        ({"a": Block.from_parameters(2.0, 0.2, 0.9, radius=[1.0, 1.1])}, "only in restitution"),
    ],
)
def test_bodies_that_cannot_be_lined_up_are_refused(blocks, message):
    with pytest.raises(ConfigError, match=message):
        gather_bodies(blocks)


def test_bodies_made_together_are_those_made_alone():
    rng = np.random.default_rng(5)
    sizes = zip(0.2 * 10.0 ** rng.uniform(size=300), rng.uniform(2.5, 8.0, 300), strict=True)
    bodies = [BlockSettings(name=f"{k}", width=w, height=w * slenderness) for k, (w, slenderness) in enumerate(sizes)]
    bodies[7] = BlockSettings(name="two", width=0.5, height=2.0, restitution=[0.8, 0.9])
    together, alone = gather_bodies(bodies), gather_bodies({one.name: one.block() for one in bodies})
    assert together.names == alone.names
    assert together.warnings == alone.warnings
    for name in Block.lane_fields():
        assert np.array_equal(getattr(together.lanes, name), getattr(alone.lanes, name), equal_nan=name != "restraints")
