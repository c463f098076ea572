"""``rockpulse completion``: scripts of four shells, tried in those that are there."""

import shutil
import subprocess

import pytest

from rockpulse.cli import main
from rockpulse.commands import VERBS
from rockpulse.commands.program import HOW


def script(shell, capsys):
    assert main(["completion", shell]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("shell", HOW)
def test_every_verb_option_and_kind_stands_in_the_script(shell, capsys):
    text = script(shell, capsys)
    for word in (*(verb.name for verb in VERBS), "overturning-map", "resume"):
        assert word in text, word


@pytest.mark.skipif(not shutil.which("bash"), reason="no bash")
@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["ass"], "assess"),
        (["plot", "results.h5", "overturning-m"], "overturning-map"),
        (["assess", "--res"], "--resume"),
        (["assess", "--units", "cm"], "cm/s2"),
        (["report", "some-fi"], "some-file.h5"),
    ],
)
def test_bash_completes_verbs_kinds_options_units_and_files(words, found, tmp_path, capsys):
    (tmp_path / "some-file.h5").touch()
    (tmp_path / "rockpulse.bash").write_text(script("bash", capsys))
    given = " ".join(f"'{word}'" for word in ("rockpulse", *words))
    asked = (
        f"source rockpulse.bash; COMP_WORDS=({given}); COMP_CWORD={len(words)}; _shtab_rockpulse; "
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    run = subprocess.run(["bash", "-c", asked], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found in run.stdout.split()
