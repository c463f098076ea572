"""Bodies as the user gives them: full sizes or parameters, from the file or the command line."""

import logging
import re

import pytest

from rockpulse import BlockSettings
from rockpulse.config.block_settings import parse_block_option
from rockpulse.config.configuration import load_config
from rockpulse.errors import ConfigError


def test_housner_for_a_squat_body_is_refused_with_its_name():
    squat = BlockSettings(name="slab", width=3.0, height=1.0, confirm_size=True)
    with pytest.raises(ConfigError, match=r'"slab".* restitution: .*slenderness of 0.707'):
        squat.block()


DOUBTED = [
    (
        {"width": 600, "height": 1700},
        '"statue": 600 x 1700: are these millimetres? A body larger than 30 m is accepted',
    ),
    ({"width": 60, "height": 170}, '"statue": 60 x 170: are these centimetres? A body larger than 30 m'),
    ({"width": 0.01, "height": 0.04}, '"statue": 0.01 x 0.04: are these metres? A body less than 5 cm high'),
    ({"width": 0.0006, "height": 1.7}, '"statue": 0.0006 x 1.7: are these metres? A body less than 1 mm wide'),
    ({"width": 1.7, "height": 0.6}, '"statue": 1.7 x 0.6: are width and height swapped? A body wider than high'),
    ({"p": 0.2, "alpha": 0.25}, '"statue": p and alpha of a rectangle of 91 x 356 m. A body larger than 30 m'),
    (
        {"p": 2.4, "alpha": 0.25, "radius": 1136},
        '"statue": radius and alpha of a rectangle of 562 x 2.2e+03 m. A body larger',
    ),
]


@pytest.mark.parametrize(("sizes", "message"), DOUBTED)
def test_a_doubted_size_is_refused_unless_it_is_confirmed(sizes, message):
    with pytest.raises(ConfigError, match=re.escape(message)) as refused:
        BlockSettings(name="statue", restitution=0.5, **sizes)
    assert str(refused.value).endswith("or set confirm_size = true in its [[block]]")
    confirmed = BlockSettings(name="statue", restitution=0.5, confirm_size=True, **sizes)
    assert {name: confirmed[name] for name in sizes} == sizes


def test_largest_and_smallest_sizes_that_are_not_doubted():
    for width, height in ((30.0, 30.0), (0.05, 0.05), (0.001, 30.0)):
        assert not BlockSettings(name="a", width=width, height=height, restitution=0.5).confirm_size


def test_an_option_that_is_doubted_names_the_option_that_confirms_it():
    with pytest.raises(
        ConfigError, match=r'--block "statue=600x1700": 600 x 1700: are these millimetres\? .* add --confirm-size$'
    ):
        parse_block_option("statue=600x1700")
    assert parse_block_option("statue=600x1700", True).confirm_size
    with pytest.raises(ConfigError, match="expected a positive number of metres"):
        parse_block_option("statue=0x1700", True)


def test_radius_is_of_a_body_by_parameters_and_judges_its_restitution():
    statue = BlockSettings(name="statue", p=2.385, alpha=0.2445, radius=1.136)
    assert statue.block().restitution == pytest.approx(0.9228, abs=5e-5)
    assert statue.block().radius == 1.136
    with pytest.raises(ConfigError, match=r"radius .*optional.* found height, radius, width"):
        BlockSettings(name="a", width=0.5, height=2.0, radius=1.0)
    with pytest.raises(ConfigError, match=r'"statue" radius: no body with p = 2\.385'):
        BlockSettings(name="statue", p=2.385, alpha=0.2445, radius=2.272).block()


def test_each_warning_is_logged_once_with_the_name_of_the_body(caplog):
    with caplog.at_level(logging.WARNING, logger="rockpulse"):
        block = BlockSettings(name="squat", width=1.0, height=2.0, restitution=0.95).block()
    assert [record.getMessage() for record in caplog.records] == [f"block squat: {text}" for text in block.warnings]
    assert len(block.warnings) == 2


def test_block_option_may_hold_an_equals_sign_in_its_name():
    assert parse_block_option("wall=2=0.3X2.4") == BlockSettings(name="wall=2", width=0.3, height=2.4)


FACADE = """
[[block]]
name = "façade"
width = 0.8
height = 9.0
one_sided = true
facing = 225.0
density = 1800.0
length = 1.0
friction = 0.6
[[block.tie]]
height = 8.0
stiffness = 6.3e6
yield_force = 74e3
[[block.load]]
weight = 2e4
height = 9.0
friction = 0.3
[[block.thrust]]
force = 800.0
height = 6.0
[[block.floor]]
period = 0.4
[[block]]
name = "statue"
b_1 = 0.2
b_2 = 0.3
centre = 1.0
gyration = 0.6
"""


def test_a_body_with_all_it_can_have_comes_back(tmp_path):
    path = tmp_path / "site.toml"
    path.write_text(FACADE, encoding="utf-8")
    config = load_config(path)
    facade, statue = config.bodies
    made = facade.block()
    assert (made.side, made.mass) == (1, 12960.0)
    assert [tie.yield_force for tie in made.restraints.ties] == [74e3]
    assert facade.floors[0].participation == 1.0
    assert statue.block().alpha_c < statue.block().alpha_2
    path.write_text(config.as_text(), encoding="utf-8")
    assert load_config(path) == config
