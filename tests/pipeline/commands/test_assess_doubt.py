"""``rockpulse assess`` where sizes, peaks or units are in doubt: what it asks, and how that is answered."""

import pytest
from assess_command import STRONG, assess, configuration, values, write_at2

import rockpulse as rp


@pytest.fixture
def folder(tmp_path_factory):
    """One good record, apart from what a test writes."""
    folder = tmp_path_factory.mktemp("records")
    write_at2(folder / "strong.AT2", STRONG)
    return folder


@pytest.mark.sweep
def test_sizes_in_millimetres_are_exit_code_two_before_any_work_unless_confirmed(folder, quick, tmp_path, capsys):
    target = tmp_path / "results.h5"
    arguments = [folder / "strong.AT2", "--block", "statue=600x1700", "-o", target, "--config", quick]
    assert assess(*arguments) == 2
    assert capsys.readouterr().err.startswith(
        'rockpulse: --block "statue=600x1700": 600 x 1700: are these millimetres? A body '
    )
    assert not target.exists()
    assert assess(*arguments, "--confirm-size") == 0
    stored = tmp_path / "stored.toml"
    stored.write_text(rp.load(target).attrs["configuration"])
    assert rp.load_config(stored).bodies[0].confirm_size
    assert "600 m wide and 1700 m high" in rp.load(target)["summary"]["block_warnings"].values[0]


@pytest.mark.sweep
def test_a_record_in_the_wrong_unit_fails_until_it_is_confirmed(folder, quick, tmp_path, capsys):
    write_at2(tmp_path / "odd.AT2", 1000.0 * STRONG)
    target = tmp_path / "results.h5"
    given = [folder / "strong.AT2", tmp_path / "odd.AT2", "-o", target, "--workers", "1"]
    assert assess(*given, "--config", quick) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert values(target, "record") == ["strong.90"]
    assert values(target, "failures/kind") == ["failed"]
    assert "odd.90: peak 432 g if the unit is g; 0.44 g if it is cm/s2" in said
    assert "if it is right, give --confirm odd.90, or confirm" in said
    again = [*given, "--overwrite", "--config"]
    assert assess(*again, quick, "--confirm", "strong*", "--confirm", "odd.*") == 0
    said = " ".join(capsys.readouterr().out.split())
    assert sorted(values(target, "record")) == ["odd.90", "strong.90"]
    assert "odd.90 (peak?)" in said
    assert "odd_peak" in values(target, "warning_codes")[values(target, "record").index("odd.90")]
    assert 'confirm = ["strong*", "odd.*"]' in configuration(target)
    config = tmp_path / "site.toml"
    config.write_text(f'[records]\nconfirm = ["odd.90"]\n{quick.read_text()}')
    assert assess(*again, config) == 0
    capsys.readouterr()
    assert assess(*again, quick, "--confirm", "nothing") == 2
    assert "no record id matches nothing; the ids are" in capsys.readouterr().err


@pytest.mark.sweep
def test_what_is_confirmed_is_done_when_a_run_is_resumed_and_the_rest_is_kept(quick, tmp_path, capsys):
    write_at2(tmp_path / "a.AT2", STRONG)
    write_at2(tmp_path / "odd.AT2", 1000.0 * STRONG)
    given = [tmp_path / "a.AT2", tmp_path / "odd.AT2", "-o", tmp_path / "results.h5", "--workers", "1"]
    given += ["--config", quick]
    assert assess(*given, "--strict") == 1
    assert "peak 432 g" in capsys.readouterr().err
    assert assess(*given, "--resume", "--confirm", "odd*") == 0
    assert "1 of 2 records were finished before" in capsys.readouterr().err
    assert len(values(tmp_path / "results.h5", "record")) == 2


@pytest.mark.sweep
def test_unit_and_interval_of_some_files_yield_to_the_command_line(quick, tmp_path, capsys):
    for name in ("a.g3", "b.txt"):
        (tmp_path / name).write_text("\n".join(f"{value:.8f}" for value in STRONG * (1.0 if name == "a.g3" else 98.0)))
    config, target = tmp_path / "site.toml", tmp_path / "results.h5"
    config.write_text(
        '[records]\npaths = ["a.g3", "b.txt"]\nunits = "cm/s2"\ndt = 0.01\n'
        f'[[records.file]]\nmatch = "*.g3"\nunits = "g"\ndt = 0.02\n{quick.read_text()}'
    )
    assert assess("--config", config, "-o", target) == 0
    assert values(target, "record") == ["a.1", "b.1"]
    assert values(target, "pga") == pytest.approx([0.45 * 9.80665, 0.45 * 0.98], rel=0.05)
    assert values(target, "dt") == [0.02, 0.01]
    assert assess("--config", config, "-o", target, "--overwrite", "--dt", "0.005") == 0
    assert values(target, "dt") == [0.005, 0.005]
    assert values(target, "pga") == pytest.approx([0.45 * 9.80665, 0.45 * 0.98], rel=0.05)
    assert 'match = "*.g3"\nunits = "g"\n' in configuration(target)
    assert assess("--config", config, "-o", target, "--overwrite", "--dt", "0.005", "--units", "m/s2") == 0
    assert "[[records.file]]" not in configuration(target)
