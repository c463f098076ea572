"""A folder with several records of one motion: one of them is assessed, and the list says why."""

import numpy as np
import pytest
from assess_command import QUICK
from record_writers import knet, pulse
from record_writers.geonet import geonet

import rockpulse as rp
from rockpulse.cli import main

COUNT = 200
WAVES = [pulse(COUNT, peak) for peak in (0.3, 0.2, 0.1)]
RAW, CORRECTED, BOTTOM, SURFACE = "hses.V1A", "hses.V2A", "AKT0139608110312.{}1", "AKT0139608110312.{}2"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """GeoNet's raw and processed record of one motion, and the files of a KiK-net station, in three components."""
    folder = tmp_path_factory.mktemp("records")
    for name, corrected in ((RAW, False), (CORRECTED, True)):
        columns = [(9806.65 + 100.0 * corrected) * wave for wave in WAVES]
        (folder / name).write_bytes(geonet(columns, corrected=corrected, dt=0.01))
    for number, (direction, wave) in enumerate(zip(("EW", "NS", "UD"), WAVES, strict=True)):
        for place, strength in ((BOTTOM, 1e6), (SURFACE, 2e6)):
            counts = np.rint(strength * wave).astype(int)
            code = str(number + 1 + 3 * (place is SURFACE))
            (folder / place.format(direction)).write_bytes(knet(counts, direction=code))
    return folder


def assess(folder, *lines):
    """Exit code, and the tree of an assessment with some lines of section [records]."""
    config, output = folder.parent / "site.toml", folder.parent / "results.h5"
    config.write_text("\n".join(["[records]", *lines, QUICK]))
    given = ["--block", "wall=0.3x3.0", "-o", str(output), "--overwrite", "--quiet"]
    code = main(["assess", str(folder), "--config", str(config), *given])
    return code, rp.load(output)


def used(tree):
    return sorted({source.rpartition("/")[2] for source in tree["summary"]["source"].values})


def left(tree):
    rows = zip(*(tree["failures"][name].values for name in ("kind", "file")), strict=True)
    return sorted((str(kind), str(file).rpartition("/")[2]) for kind, file in rows)


@pytest.mark.sweep
def test_one_record_of_each_motion_is_assessed_and_the_list_says_why(folder, run):
    code, tree = assess(folder)
    assert code == 0
    assert used(tree) == sorted([CORRECTED, SURFACE.format("EW"), SURFACE.format("NS")])
    assert tree["summary"].sizes["record"] == 4
    assert left(tree) == sorted(
        [("duplicate", RAW)] * 3
        + [("depth", BOTTOM.format(direction)) for direction in ("EW", "NS", "UD")]
        + [("vertical", CORRECTED), ("vertical", SURFACE.format("UD"))]
    )
    told = " ".join(run("inspect", folder.parent / "results.h5", "--failures").out.split())
    assert "a processed record is preferred to a raw one" in told
    assert "this one was recorded at the bottom of a borehole, the other at the surface" in told
    assert told.count("[records] keep with this id assesses both") == 6


@pytest.mark.sweep
def test_what_is_kept_is_assessed_too(folder):
    code, tree = assess(folder, 'keep = [".HSES.*", "*.EW1@*"]')
    assert code == 0
    assert used(tree) == sorted([RAW, CORRECTED, BOTTOM.format("EW"), SURFACE.format("EW"), SURFACE.format("NS")])
