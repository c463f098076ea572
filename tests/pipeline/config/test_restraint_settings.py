"""Bodies of the configuration that are no free-standing symmetric blocks."""

import pytest

from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import load_config
from rockpulse.errors import ConfigError

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
    facade, statue = config.blocks
    made = facade.block()
    assert (made.side, made.mass) == (1, 12960.0)
    assert [tie.yield_force for tie in made.restraints.ties] == [74e3]
    assert facade.floors[0].participation == 1.0
    assert statue.block().alpha_c < statue.block().alpha_2
    path.write_text(config.as_text(), encoding="utf-8")
    assert load_config(path) == config


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"width": 0.5, "height": 5.0, "rebound": 0.5}, "of a body before a wall; set one_sided = true"),
        ({"width": 0.5, "height": 5.0, "facing": 90.0}, "of a body before a wall; set one_sided = true"),
        ({"width": 0.5, "height": 5.0, "one_sided": True, "rebound": 1.5}, r"a share e in \[0, 1\]"),
        ({"width": 0.5, "height": 5.0, "friction": 0.0}, "friction: expected a number > 0"),
        ({"b_1": 0.2, "b_2": 0.3, "centre": 1.0}, "or b_1, b_2, centre and gyration"),
        ({"p": 2.0, "alpha": 0.2, "offset": 0.1}, "offset, lean, density and length go with width and height only"),
        ({"p": 2.0, "alpha": 0.2, "mass": 100.0}, "need a body with sizes"),
        ({"b_1": 20.0, "b_2": 0.3, "centre": 1.0, "gyration": 0.6}, "wider than high|larger than"),
    ],
)
def test_wrong_bodies_are_refused(given, words):
    with pytest.raises(ConfigError, match=words):
        BlockSettings(name="body", **given)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("[[block.tie]]\nheight = 12.0\nstiffness = 1e6", r'"body" ties, loads, thrusts: expected heights up to'),
        (
            "[[block.tie]]\nheight = 2.0\nstiffness = 1e6\ngap = -0.1",
            r"\[\[block.tie\]\] gap: expected a number in m >= 0",
        ),
        ("[[block.tie]]\nheight = 2.0", r"\[\[block.tie\]\] stiffness: this key is needed"),
        ("[[block.load]]\nweight = 1e3\nheight = 2.0\nfriction = 0", r"\[\[block.load\]\] friction"),
        ("[[block.thrust]]\nforce = 1e6\nheight = 2.0", "turn it over"),
        ("[[block.floor]]\nperiod = 0.4\ndamping = 0", r"\[\[block.floor\]\] damping"),
    ],
)
def test_wrong_restraints_are_refused_with_the_key(tmp_path, lines, words):
    path = tmp_path / "site.toml"
    path.write_text(f'[[block]]\nname = "body"\nwidth = 0.5\nheight = 5.0\nmass = 1e3\n{lines}\n', encoding="utf-8")
    with pytest.raises(ConfigError, match=words):
        [block.block() for block in load_config(path).blocks]
