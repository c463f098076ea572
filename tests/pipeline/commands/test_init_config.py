"""``rockpulse init-config``."""

from rockpulse.config.configuration import load_config


def test_the_template_that_is_written_is_a_configuration(tmp_path, run):
    target = tmp_path / "site.toml"
    assert str(target) in run("init-config", "-o", target).out
    assert [block.name for block in load_config(target).bodies] == ["block"]
    target.write_text("mine")
    assert "the file exists" in run("init-config", "-o", target, code=2).err
    assert target.read_text() == "mine"
