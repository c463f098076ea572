"""Bodies as the user gives them: full sizes or parameters, from the file or the command line."""

import pytest

from rockpulse import BlockSettings
from rockpulse.config.block_settings import parse_block_option
from rockpulse.errors import ConfigError


def test_housner_for_a_squat_body_is_refused_with_its_name():
    squat = BlockSettings(name="slab", width=3.0, height=1.0)
    with pytest.raises(ConfigError, match=r'"slab".* restitution: .*slenderness of 0.707') as refused:
        squat.block()
    assert "3 m wide and 1 m high, are the two swapped?" in str(refused.value)


def test_a_block_has_half_the_full_sizes_and_a_lane_for_each_restitution():
    block = BlockSettings(name="a", width=1.0, height=4.0, restitution=[0.8, 0.9]).block()
    assert block.shape == (2,)
    assert block.half_width.tolist() == [0.5, 0.5]
    assert block.half_height.tolist() == [2.0, 2.0]
    assert block.restitution.tolist() == [0.8, 0.9]


def test_a_block_by_parameters_keeps_them():
    block = BlockSettings(name="statue", p=2.1, alpha=0.25, restitution=0.9).block()
    assert (block.p, block.alpha_c, block.restitution) == (2.1, 0.25, 0.9)


def test_block_option_may_hold_an_equals_sign_in_its_name():
    assert parse_block_option("wall=2=0.3X2.4") == BlockSettings(name="wall=2", width=0.3, height=2.4)


@pytest.mark.parametrize(
    "option", ["wall", "wall=", "wall=0.3", "wall=0.3x", "wall=axb", "=0.3x2", "wall=0x2", "wall=nanx2"]
)
def test_a_bad_block_option_is_refused(option):
    with pytest.raises(ConfigError, match=r"--block"):
        parse_block_option(option)
