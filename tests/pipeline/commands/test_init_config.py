"""``rockpulse init-config``."""

from rockpulse.cli import main
from rockpulse.config.configuration import load_config


def test_the_template_that_is_written_is_a_configuration(tmp_path, capsys):
    target = tmp_path / "site.toml"
    assert main(["init-config", "-o", str(target)]) == 0
    assert str(target) in capsys.readouterr().out
    assert [block.name for block in load_config(target).bodies] == ["block"]
    target.write_text("mine")
    assert main(["init-config", "-o", str(target)]) == 2
    assert "the file exists" in capsys.readouterr().err
    assert target.read_text() == "mine"
