"""Bodies as Python gives them, and what is said of anything else."""

from dataclasses import replace

import numpy as np
import pytest

from rockpulse import BlockSettings, Config, PedestalSettings, Record, RecordSettings, assess, calibrate, fragility
from rockpulse.config.bodies import gather_bodies, given_bodies
from rockpulse.errors import ConfigError, RecordRefused
from rockpulse.models import Block

WALL = BlockSettings(name="wall", width=0.25, height=2.2)
SHAKING = Record(3.0 * np.sin(np.arange(0.0, 40.0, 0.1)), dt=0.1, id="sine", processed=True)


def test_full_sizes_by_name_are_the_body_of_the_configuration():
    assert list(given_bodies({"wall": (0.25, 2.2)})) == [("wall", WALL)]
    assert list(given_bodies({"wall": [np.float32(0.25), 2]})) == [("wall", BlockSettings("wall", 0.25, 2.0))]
    lanes = gather_bodies({"wall": (0.25, 2.2)}).lanes
    assert (lanes.half_width.item(), lanes.half_height.item()) == (0.125, 1.1)


def test_a_mapping_may_mix_sizes_blocks_and_settings():
    stands_on = PedestalSettings(width=0.6, height=0.5, mass=400.0)
    statue = BlockSettings("other", 0.4, 1.6, mass=300.0, pedestals=(stands_on,))
    bodies = gather_bodies({"wall": (0.25, 2.2), "pier": Block(width=1.0, height=4.0), "statue": statue})
    assert bodies.names == ("wall", "pier", "statue", "statue with pedestal")
    assert bodies.width[:3].tolist() == [0.25, 1.0, 0.4]


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
        ({"wall": (0.25, 2.2, 1.0)}, r'bodies "wall": expected \(width, height\)'),
        ({"wall": ("0.25", "2.2")}, r'bodies "wall": expected \(width, height\)'),
        ({"wall": (True, 2.2)}, r'bodies "wall": expected \(width, height\)'),
        ({"wall": {"width": 0.25, "height": 2.2}}, r'bodies "wall": expected \(width, height\)'),
        ({1: (0.25, 2.2)}, "expected strings as the names of bodies, found int 1"),
        ({"a/b": (0.25, 2.2)}, "name"),
        ({"wall": (-0.25, 2.2)}, r'\[\[block\]\] "wall" width'),
        ({"wall": (float("nan"), 2.2)}, r'\[\[block\]\] "wall" width'),
        ({"wall": (2.2, 0.25)}, "are width and height swapped"),
        ({"wall": (250.0, 2200.0)}, "millimetres"),
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


@pytest.mark.sweep
def test_one_record_and_sizes_are_enough_for_an_assessment():
    tree = assess(SHAKING, bodies={"wall": (0.25, 2.2), "chest": (1.0, 1.2)})
    assert tree["summary"]["record"].values.tolist() == ["sine"]
    assert tree["summary"]["width"].values.tolist() == [0.25, 1.0]
