"""Bodies of the configuration that are no free-standing symmetric blocks."""

from rockpulse.config.configuration import load_config

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
