"""``rockpulse risk`` on a small fragility file."""

import pandas as pd
import pytest

import rockpulse as rp


@pytest.fixture(scope="module")
def fragility(golden, loaded_once):
    return golden.fragility


@pytest.mark.sweep
def test_the_hazard_of_the_fragility_or_of_a_file_gives_a_table(fragility, tmp_path, run):
    shown = run("risk", fragility, "--resamples", "0").out
    assert "Frequency of overturning, 2 bodies; hazard: power law 0.0001 x^-2.5 of pga in m/s2" in shown
    curve, table = tmp_path / "curve.csv", tmp_path / "risk.csv"
    # The same power law as a curve.
    curve.write_text("pga [m/s2],rate\n" + "".join(f"{x},{1e-4 * x**-2.5!r}\n" for x in (0.1, 1.0, 10.0, 100.0)))
    arguments = ["--hazard", str(curve), "--years", "10", "-o", str(table), "--resamples", "0"]
    assert f"table: {table}" in run("risk", fragility, *arguments).out
    found = pd.read_csv(table)
    assert found["block"].tolist() == ["stele", "pier"]
    assert "  cut at uplift: " in shown
    curves = rp.load(fragility)["fragility"].sel(limit_state="overturning", measure="pga")
    assert found["median"].tolist() == pytest.approx(curves["median"].values)
    assert found["beta"].tolist() == pytest.approx(curves["beta"].values)
    assert shown.split("stele")[1].split()[0].rstrip("!") == f"{found['frequency'][0]:.2e}"
    # What each range of levels contributes, in the unit of the hazard.
    levels = pd.read_csv(tmp_path / "risk_levels.csv")
    levels = levels[levels["block"] == "stele"]
    assert 0.99 < levels["share"].sum() <= 1.0
    assert levels["bin_low"].to_numpy()[1:] == pytest.approx(levels["bin_high"].to_numpy()[:-1])
    assert set(levels["unit"]) == {"m/s2"}


@pytest.mark.sweep
def test_a_tail_is_told_in_the_row_in_the_notes_and_on_standard_error(fragility, tmp_path, run):
    curve = tmp_path / "curve.csv"
    curve.write_text("pga [g],rate\n0.2,1e-2\n0.25,5e-3\n")
    out, err = run("risk", fragility, "--hazard", curve, "--resamples", "0")
    assert "of its frequency comes from levels above 0.25 g, where the hazard curve ends" in err
    assert err.startswith("warning: stele: ")
    row = next(line for line in out.splitlines() if line.startswith("  stele"))
    assert row.split()[1].endswith("!")
    assert "  ! stele: " in out
    assert "pga [g]" in out


def test_a_site_far_away_is_refused_and_the_soil_is_reported(fragility, tmp_path, run):
    curve = tmp_path / "curve.csv"
    curve.write_text("# investigation_time=1.0, imt='PGA'\nlon,lat,poe-0.1,poe-1.0\n13,42,0.1,0.001\n")
    assert "expected one within 50 km" in run("risk", fragility, "--hazard", curve, "--site", "8", "45", code=2).err
    arguments = ["--hazard", str(curve), "--site", "13.05", "42", "--soil-factor", "1.5", "--resamples", "0"]
    # 0.05 degrees of longitude at 42 degrees north: 6371 km pi/3600 cos 42 = 4.1 km.
    shown = " ".join(run("risk", fragility, *arguments).out.split())
    assert "place 13 E 42 N: 2 points of pga in g" in shown
    assert "4.1 km from the site" in shown
    assert "levels times the soil factor 1.5" in shown


def test_bodies_that_have_stood_are_a_test_of_the_hazard(fragility, run):
    frequency = float(run("risk", fragility, "--resamples", "0").out.split("stele")[1].split()[0].rstrip("!"))
    # At three times the age at which lambda T is one: exp(-3) = 0.0498, ln 20 = 2.9957 and the factor 0.99858.
    shown = run("risk", fragility, "--resamples", "0", "--age", f"{3.0 / frequency:.8g}").out
    row = shown.split("Bodies that have survived")[1].split("stele")[1].splitlines()[0].split()
    assert float(row[0]) == pytest.approx(0.0498, rel=2e-2)
    assert float(row[2]) == pytest.approx(0.9986, rel=6e-3)


@pytest.mark.slow
def test_an_inventory_is_read_from_the_spectra_of_results(golden, tmp_path, run):
    (tmp_path / "site.toml").write_text('[models]\nuse = ["nonlinear"]\n[uncertainty]\nspectrum = "all"\n')
    results = tmp_path / "results.h5"
    arguments = [str(golden.records / "burst1.AT2"), "--config", str(tmp_path / "site.toml"), "--block", "any=0.4x3"]
    run("assess", *arguments, "-o", results, "--quiet", "--workers", "1")
    bodies, table, curve = (tmp_path / name for name in ("bodies.csv", "risk.csv", "curve.csv"))
    bodies.write_text("name,width [m],height [m]\n" + "".join(f"b{k},{0.3 + 0.02 * k},3\n" for k in range(15)))
    curve.write_text("pga [m/s2],rate\n0.1,0.1\n1,1e-3\n10,1e-5\n")
    arguments = ["risk", str(results), "--bodies", str(bodies), "--hazard", str(curve), "-o", str(table)]
    shown = run(*arguments).out
    assert "Frequency of overturning, 15 bodies" in shown
    assert "the 10 bodies that overturn most often" in shown
    found = pd.read_csv(table)
    assert found["body"].tolist() == [f"b{k}" for k in range(15)]
    assert found["frequency"].is_monotonic_decreasing  # the wider, the rarer
    total = sum(found["frequency"])
    assert f"expected number of bodies overturned: {total:.2e} per year" in " ".join(shown.split())
    # The same bodies at sites of their own: the last ten at one whose rates are ten times as high.
    east = ["13" if k < 5 else "14" for k in range(15)]
    rows = "".join(f"b{k},{0.3 + 0.02 * k},3,{east[k]},42.01\n" for k in range(15))
    bodies.write_text(f"name,width [m],height [m],longitude,latitude\n{rows}")
    curve.write_text("LON,LAT,TR=10ag [g],TR=1000ag [g]\n13,42,0.0102,0.102\n14,42,0.0323,0.323\n".replace("TR=", "T"))
    shown = " ".join(run(*arguments, "--overwrite").out.split())
    assert "given for the point nearest to each body, up to 1.1 km away" in shown
    sited = pd.read_csv(table)
    ratio = (sited["frequency"] / found["frequency"]).to_numpy()
    assert ratio[5:] == pytest.approx(10.0 * ratio[:5].mean(), rel=2e-2)
    assert sited["hazard_distance"].to_numpy() == pytest.approx(1112.0, abs=1.0)
    said = run(*arguments, "--overwrite", "--site", "13", "42", code=2).err
    assert "[hazard] longitude, latitude: also given for each body" in said
    # The ground of each body, in the spelling of the configuration, and a column that says nothing here.
    rows = "".join(f"b{k},{0.3 + 0.02 * k},3,1.2,brick\n" for k in range(15))
    bodies.write_text(f"name,width [m],height [m],Soil_Factor,made of\n{rows}")
    curve.write_text("TR [years],ag [g]\n10,0.0102\n1000,0.102\n")
    shown, told = run(*arguments, "--overwrite")
    assert "bodies.csv: columns not used: made of" in told
    assert "times the soil factor 1.2" in " ".join(shown.split())
    assert "a_g is given for rock" not in shown
    said = run(*arguments, "--overwrite", "--soil-factor", "1.4", code=2).err
    assert "[hazard] soil_factor: also given for each body" in said
    said = run(*arguments, "--overwrite", "--site", "13", "42", code=2).err
    assert "one hazard curve without coordinates, so no site can be looked up" in said


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("name,width [m]\na,1\n", "missing: height [m]"),
        ("name,width [m],height [m],tie.height [m]\na,1,2,\nb,1,2,1\n", "b: tie.height: the spectra cover free"),
        ("name,width [m],height [m]\na,0.4,3\na,0.4,3\n", "a unique name for each body"),
        ("name,width [m],height [m]\na,0.4,x\n", "row 1 of column 'height': expected a number, found 'x'"),
        ("name,width [m],height [m]\na,0.4,-3\n", "a: height: expected a positive number, found -3"),
        ("name,width [m],height [m]\na,0.4,3,13.4\n", "row 1: expected 3 cells, as in the heading, found 4"),
        ("name,width [m],height [m],restitution\na,0.4,3,1.5\n", "restitution"),
        ("name,width [m],height [m],longitude\na,0.4,3,13\n", "longitude and latitude [degrees] or neither"),
        (
            "name,width [m],height [m],longitude,latitude\na,0.4,3,13,142\n",
            "a: latitude: expected degrees from -90 to 90, found 142",
        ),
        ("name,width [m],height [m],soil factor\na,0.4,3,\n", "column 'soil_factor': expected a number, found ''"),
    ],
)
def test_wrong_inventories_are_reported(fragility, tmp_path, run, text, told):
    (tmp_path / "bodies.csv").write_text(text)
    assert told in run("risk", fragility, "--bodies", tmp_path / "bodies.csv", code=2).err
