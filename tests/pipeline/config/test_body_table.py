"""Tables of bodies, in CSV and in workbooks, against the same bodies in a configuration."""

import math

import pandas as pd
import pytest

import rockpulse as rp
from rockpulse.cli import main
from rockpulse.config.body_table import body_template, read_bodies
from rockpulse.studies.risk.inventory import read_inventory

TABLE = [
    ["Name", "width [cm]", "height (m)", "restitution", "one_sided", "tie.height [m]", "tie.stiffness [kN/mm]", "room"],
    ["12", "35", "2.4", "", "", "", "", "A"],
    ["façade", "80", "9", "", "yes", "8", "2", "B"],
    ["chest", "60", "1.2", "0.7 0.8", "false", "", "", ""],
]
SAME = (
    rp.BlockSettings(name="12", width=0.35, height=2.4),
    rp.BlockSettings(
        name="façade", width=0.8, height=9.0, one_sided=True, ties=[rp.TieSettings(height=8.0, stiffness=2e6)]
    ),
    rp.BlockSettings(name="chest", width=0.6, height=1.2, restitution=(0.7, 0.8)),
)


def test_a_table_gives_the_bodies_of_a_configuration(tmp_path):
    path = tmp_path / "bodies.csv"
    path.write_text("\n".join(map(",".join, TABLE)), encoding="utf-8")
    assert read_bodies(path) == (SAME, ("room",))
    path.write_text("\n".join(map(";".join, TABLE)).replace(".4", ",4").replace(".2", ",2"), encoding="utf-8")
    assert rp.load_bodies(path) == SAME


def test_a_workbook_is_read_like_a_csv_table(tmp_path):
    path = tmp_path / "bodies.xlsx"
    head, *rows = TABLE
    cells = [[12, 35, 2.4, None, None, None, None, "A"], [*rows[1][:4], True, 8, 2, "B"], rows[2]]
    pd.DataFrame(cells, columns=head).to_excel(path, index=False)
    assert rp.load_bodies(path) == SAME
    path.write_bytes(b"PK no workbook")
    with pytest.raises(rp.ConfigError, match=r"bodies\.xlsx: cannot be read as a workbook .*; save it as CSV"):
        rp.load_bodies(path)


def test_units_of_headings(tmp_path):
    path = tmp_path / "bodies.csv"
    path.write_text("name,p [1/s],alpha [deg],azimuth\na,2,14,45\n")
    (body,) = rp.load_bodies(path)
    assert (body.p, body.azimuth) == (2.0, 45.0)
    assert body.alpha == pytest.approx(math.radians(14.0), rel=1e-15)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("name,width,height [m]\na,0.4,3\n", r'column "width": expected \[m\] or \[cm\] .*, found no unit'),
        ("name,width [kg],height [m]\na,0.4,3\n", r'column "width \[kg\]": expected \[m\].*found \[kg\]'),
        ("name,widht [m],height [m]\na,0.4,3\n", 'column "widht .*: unknown key; did you mean "width"'),
        ("name,width [m],Width [cm],height [m]\na,0.4,3,3\n", "expected one column of width, found two"),
        ("name,width [m],height [m]\na,0.4,3\nb,400,3000\n", r'row 2: \[\[block\]\] "b": .* are these millimetres'),
        ("name,width [m],height [m]\na,x,3\n", r'row 1: .*"a" width: expected a positive number of metres, found'),
        ("name,width [m],height [m],one_sided\na,0.4,3,1\n", "one_sided: expected true or false, found 1"),
        ("name,width [m],height [m],tie.height [m]\na,0.4,3,2\n", "stiffness: this key is required"),
        ("width [m],height [m]\n0.4,3\n", "name: this key is required"),
        ("name,width [m],height [m]\n", "expected a row for each body below the headings"),
    ],
)
def test_wrong_tables_are_reported(tmp_path, text, told):
    (tmp_path / "bodies.csv").write_text(text)
    with pytest.raises(rp.ConfigError, match=rf"bodies\.csv: .*{told}"):
        rp.load_bodies(tmp_path / "bodies.csv")


def test_the_template_is_a_table_of_bodies_for_every_verb(tmp_path):
    target = tmp_path / "bodies.csv"
    assert main(["init-config", "--bodies", "-o", str(target)]) == 0
    assert target.read_text(encoding="utf-8").splitlines() == body_template()
    assert [one.name for one in rp.load_bodies(target)] == read_inventory(target).names == ["statue", "cabinet"]
    # In a sheet, the comments stand in their own rows.
    cells = pd.DataFrame([pd.Series(line.split(",")) for line in body_template()])
    cells.to_excel(tmp_path / "b.xlsx", index=False, header=False)
    assert rp.load_bodies(tmp_path / "b.xlsx") == rp.load_bodies(target)


def test_bodies_of_a_table_are_checked(tmp_path, capsys):
    config, table = tmp_path / "site.toml", tmp_path / "bodies.csv"
    config.write_text("[check]\nag = 0.25\nf0 = 2.4\ntc_star = 0.35\n")
    table.write_text("name,width [cm],height [m],room\nstele,60,2,7\n")
    assert main(["check", "--config", str(config), "--bodies", str(table)]) == 0
    out, err = capsys.readouterr()
    assert "stele" in out
    assert "bodies.csv: columns not used: room" in err


@pytest.mark.sweep
def test_bodies_of_a_table_are_assessed(golden, tmp_path):
    table, results = tmp_path / "bodies.csv", tmp_path / "results.h5"
    table.write_text("name,width [cm],height [m]\nstele,30,2.4\n")
    arguments = [str(golden.records / "burst1.AT2"), "--bodies", str(table), "--block", "pier=0.5x3"]
    assert main(["assess", *arguments, "-o", str(results), "--quiet", "--workers", "1"]) == 0
    summary = rp.load(results)["summary"]
    assert dict(zip(summary["block"].values, summary["width"].values, strict=True)) == {"stele": 0.3, "pier": 0.5}
