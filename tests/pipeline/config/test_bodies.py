"""Named bodies as lanes, bodies as Python gives them, and what is said of anything else."""

from dataclasses import replace

import numpy as np
import pytest

from rockpulse import BlockSettings, Config, PedestalSettings, Record, RecordSettings, assess, calibrate, fragility
from rockpulse.config.bodies import gather_bodies, given_bodies
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block

WALL = BlockSettings(name="wall", width=0.4, height=3.0)
STATUE = BlockSettings(name="statue", p=2.4, alpha=0.3, restitution=0.85)
THIN = BlockSettings(name="wall", width=0.25, height=2.2)
SHAKING = Record(3.0 * np.sin(np.arange(0.0, 40.0, 0.1)), dt=0.1, id="sine", processed=True)


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
    with pytest.raises(ConfigError, match=r'block "a C 0\.90000001": two bodies get this name'):
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


def test_full_sizes_by_name_are_the_body_of_the_configuration():
    assert list(given_bodies({"wall": (0.25, 2.2)})) == [("wall", THIN)]
    assert list(given_bodies({"wall": [np.float32(0.25), 2]})) == [("wall", BlockSettings("wall", 0.25, 2.0))]
    lanes = gather_bodies({"wall": (0.25, 2.2)}).lanes
    assert (lanes.half_width.item(), lanes.half_height.item()) == (0.125, 1.1)


def test_a_mapping_may_mix_sizes_blocks_and_settings():
    stands_on = PedestalSettings(width=0.6, height=0.5, mass=400.0)
    statue = BlockSettings("other", 0.4, 1.6, mass=300.0, pedestals=(stands_on,))
    bodies = gather_bodies({"wall": (0.25, 2.2), "pier": Block(width=1.0, height=4.0), "statue": statue})
    assert bodies.names == ("wall", "pier", "statue", "statue with pedestal")
    assert bodies.width[:3].tolist() == [0.25, 1.0, 0.4]
    assert bodies.lanes.shape == (4,)


def test_a_body_with_a_list_of_restitutions_has_pedestals():
    one, other = (PedestalSettings(width=width, height=0.5, mass=400.0) for width in (0.6, 0.8))
    settings = {c: BlockSettings("s", 0.4, 1.6, mass=300.0, pedestals=(one, other), restitution=c) for c in (0.9, 0.8)}
    listed = gather_bodies([replace(settings[0.9], restitution=(0.9, 0.8))])
    assert listed.names == ("s", "s with pedestal", "s with pedestal 2")
    for case, alone in enumerate(settings.values()):
        expected = gather_bodies([alone]).lanes
        for name in ("p", "alpha_c", "restitution"):
            found = listed.per_case(np.asarray(getattr(listed.lanes, name)))[:, case]
            np.testing.assert_allclose(found, getattr(expected, name))


def test_settings_of_a_mapping_keep_what_a_direction_of_their_own_needs():
    own = BlockSettings("wall", 0.25, 2.2, azimuth=30.0)
    with pytest.raises(ConfigError, match="needs pairs of channels"):
        gather_bodies({"wall": own}, RecordSettings())


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        ("site.toml", "found str 'site.toml'"),
        (3.0, "found float 3.0"),
        ([("wall", 0.25, 2.2)], r"found a sequence with tuple \('wall', 0\.25, 2\.2\)"),
        ([Block(width=0.25, height=2.2)], "found a sequence with Block"),
        ({"wall": 0.25}, r'bodies "wall": expected \(width, height\) in m, .* found float 0\.25'),
        ({"wall": ("0.25", "2.2")}, r'bodies "wall": expected \(width, height\)'),
        ({1: (0.25, 2.2)}, "expected strings as the names of bodies, found int 1"),
        ({"a/b": (0.25, 2.2)}, "name"),
        ({"wall": (-0.25, 2.2)}, r'\[\[block\]\] "wall" width'),
    ],
)
def test_what_is_no_body_is_refused_in_words(blocks, message):
    with pytest.raises(ConfigError, match=message):
        gather_bodies(blocks)


@pytest.mark.parametrize("question", [assess, fragility, calibrate])
def test_records_and_a_configuration_are_asked_for_in_words(question):
    sizes = {"wall": (0.25, 2.2)}
    with pytest.raises(ConfigError, match="config: expected a Config or the path of one, found int 3"):
        question([SHAKING], 3, bodies=sizes)
    with pytest.raises(RecordRefused, match="records: no record in a folder: a folder: "):
        question("a folder", bodies=sizes)
    with pytest.raises(ConfigError, match="not both, found "):
        question([SHAKING, "a folder"], bodies=sizes)
    with pytest.raises(ConfigError, match=r"found 3$"):
        question([SHAKING, 3], Config(), bodies=sizes)
