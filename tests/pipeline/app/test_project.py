"""The project folder: its configuration is the one of the command line."""

import os
import time

import pytest
from results_tree import results_tree

import rockpulse as rp
from rockpulse.app.project import HEAD, LONGEST, Project, body_error, safe_name, safe_path
from rockpulse.cli import main
from rockpulse.errors import ConfigError


def test_without_the_extra_the_verb_says_what_to_install(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr("rockpulse.commands.program.find_spec", lambda name: None)
    assert main(["app", str(tmp_path / "new")]) == 2
    assert "pip install 'rockpulse[app]'" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("agency.zip", "agency.zip"),
        ("../../etc/passwd", "passwd"),
        (r"C:\records\a.AT2", "a.AT2"),
        (".hidden", "hidden"),
        ('<img src="x">.csv', "_img src=_x_.csv"),
        ("a\x00b\n.smc", "a_b_.smc"),
        ("con.txt", "_con.txt"),
        ("..", "file"),
        ("Città 1.AT2", "Città 1.AT2"),
    ],
)
def test_names_of_uploads_are_made_safe(given, kept):
    assert safe_name(given) == kept


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("hall/a.AT2", "hall/a.AT2"),
        ("/../../etc//passwd", "etc/passwd"),
        ("con/.hidden/x.csv", "_con/hidden/x.csv"),
        (r"hall/..\..\x.csv", "hall/x.csv"),
        ("1/2/3/4/5/6/7/x.csv", "3/4/5/6/7/x.csv"),
        ("..", "file"),
        ("", "file"),
    ],
)
def test_folders_of_uploads_are_kept_inside_that_of_the_records(given, kept):
    assert safe_path(given).as_posix() == kept


def test_a_long_name_keeps_its_end():
    for letter in ("x", "è", "震"):  # of one, two and three bytes
        name = safe_name(letter * 500 + ".zip")
        assert LONGEST - 3 < len(name.encode()) <= LONGEST
        assert name.endswith(f"{letter}.zip")


def test_the_configuration_is_read_changed_and_written(tmp_path):
    written = '# mine\n[site]\nname = "Old town"\n\n[uncertainty]\nrestitution = {mean = 0.98, deviation = 0.03}\n'
    (tmp_path / "site.toml").write_text(written)
    project = Project(tmp_path)
    project.several("block").append({"name": "wall", "width": 0.3, "height": 2.4, "pedestal": []})
    project.several("block")[0] |= {"mass": 600.0, "pedestal": [{"width": 0.9, "height": 1.2, "mass": 2300.0}]}
    assert project.save() == ""
    assert (tmp_path / "site.toml.bak").read_text() == written
    config = rp.load_config(tmp_path / "site.toml")
    assert config == project.config()
    assert config.site.name == "Old town"
    assert config.uncertainty == rp.UncertaintySettings(restitution={"mean": 0.98, "deviation": 0.03})
    assert config.bodies[0].pedestals == (rp.PedestalSettings(0.9, 1.2, 2300.0),)
    assert Project(tmp_path).document == project.document


def test_a_wrong_configuration_is_not_written(tmp_path):
    project = Project(tmp_path)
    project.several("block").append({"name": "wall", "width": 550.0, "height": 4200.0})
    assert "are these millimetres?" in project.save()
    assert not (tmp_path / "site.toml").exists()
    project.several("block")[0] |= {"width": 0.55, "height": 4.2}
    assert project.save() == ""
    assert (tmp_path / "site.toml").read_text().startswith(HEAD)
    (tmp_path / "site.toml").write_text("[site]\nnam = 1\n")
    assert project.changed_outside
    with pytest.raises(ConfigError, match=r"site\.toml: .*did you mean"):
        project.load()


@pytest.fixture
def sent(tmp_path_factory):
    """Writes a file that the browser has sent."""
    folder = tmp_path_factory.mktemp("sent")

    def write(content, name="sent.csv"):
        (folder / name).write_bytes(content)
        return folder / name

    return write


def test_tables_of_bodies_are_added(tmp_path, sent):
    project = Project(tmp_path)
    table = sent(b"name,width [cm],height [m],colour\nstele,30,2.4,grey\n")
    assert project.add_table("bodies.csv", table) == "bodies.csv: columns not used: colour"
    assert project.several("block") == [{"name": "stele", "width": 0.3, "height": 2.4}]
    with pytest.raises(ConfigError, match="names must differ"):
        project.add_table("bodies.csv", table)
    with pytest.raises(ConfigError, match=r"^a.csv: column"):
        project.take("bodies", "a.csv", sent(b"name,width,height [m]\nb,1,2\n"))
    assert [path.name for path in tmp_path.iterdir()] == ["site.toml"]


def test_a_file_is_kept_once_and_its_unit_is_removed_with_it(tmp_path, sent):
    project = Project(tmp_path)
    for content in (b"1", b"1", b"2"):
        project.add_record("a/columns.txt", sent(content))
    with pytest.raises(ConfigError, match="expected a folder, found a file of this name"):
        project.add_record("a/columns.txt/b.txt", sent(b"3"))
    first, second = (project.name_of(str(path)) for path in project.record_files())
    assert (first, second) == ("records/a/columns-2.txt", "records/a/columns.txt")
    assert project.remedy(second, "units", "g") == ""
    assert project.remedy(first, "pair", [first, second]) == ""
    assert project.remedy(second, "pair", [second, first]) == ""
    assert project.pairs_without("records/b/columns.txt") == [{"north": second, "east": first}]
    assert project.remedy(second, "confirm", ["columns.90", "quake.90"]) == ""
    records = project.config().records
    assert (records.files[0].match, records.pairs) == (second, (rp.PairSettings(second, first),))
    project.remove(tmp_path / second, {"columns.90"})
    records = project.config().records
    assert (records.files, records.pairs, records.confirm) == ((), (), ("quake.90",))


def test_the_error_of_a_body_names_its_key():
    assert body_error({"name": "wall", "width": 0.3, "height": 2.4}) is None
    fault = body_error({"name": "wall", "width": "wide", "height": 2.4})
    assert str(fault).startswith('[[block]] "wall" width: expected')
    assert not fault.remedies
    large = body_error({"name": "wall", "width": 550, "height": 2.4})
    assert [one.key for one in large.remedies] == ["confirm_size"]
    assert str(large).endswith(large.remedies[0].advice())


def test_a_hazard_curve_is_kept_in_place_of_a_power_law(tmp_path, sent):
    project = Project(tmp_path)
    project.section("hazard").update(k0=1e-3, k=2.5, years=100)
    project.set_hazard("curve.csv", sent(b"pga [g],rate\n0.1,0.01\n0.4,0.0005\n"))
    assert project.config().hazard == rp.HazardSettings(file="hazard.csv", years=100.0)
    assert rp.load_hazard(tmp_path / "hazard.csv").rate(0.4 * 9.80665) == pytest.approx(0.0005)
    with pytest.raises(ConfigError, match=r"^levels\.csv"):
        project.take("hazard", "levels.csv", sent(b"level,rate\n"))
    assert (tmp_path / "hazard.csv").read_bytes().startswith(b"pga [g],rate")  # the good one stays
    assert sorted(path.name for path in tmp_path.iterdir()) == ["hazard.csv", "site.toml"]


def test_results_are_current_until_a_record_is_removed_and_damaged_ones_never_are(tmp_path):
    tree, results, records = results_tree(), tmp_path / "results.h5", tmp_path / "records"
    (tmp_path / "site.toml").write_text(tree.attrs["configuration"])
    project, before = Project(tmp_path), time.time() - 10.0
    records.mkdir()
    (records / "a.csv").write_text("1\n")
    rp.save(tree, results)
    for path in (records / "a.csv", records):
        os.utime(path, (before, before))
    assert not project.outdated
    (records / "a.csv").unlink()
    assert project.outdated
    os.utime(records, (before, before))
    assert not project.outdated
    table = tmp_path / "selection.csv"
    table.write_text("record,factor\n")
    project.document["demand"] = [{"selection": table.name}]
    assert project.save() == ""
    tree.attrs["configuration"] = project.config().as_text()
    rp.save(tree, results, overwrite=True)
    os.utime(table, (before, before))
    assert not project.outdated
    os.utime(table)
    assert project.outdated
    results.write_bytes(b"damaged")
    assert project.outdated
    assert project.rejected() == []
