"""The commands of the README, the tour and the page on speed, one after the other, in a folder with what they name."""

import re
import zipfile
from pathlib import Path

import pytest
from docs_page import blocks, run_page
from record_writers import at2

from synthetic import synthetic_motion

TOP = Path(__file__).parents[2]

#: Beginnings of commands that are left out, and why.
LEFT_OUT = {
    "python3 -m venv": "they install; .ci/run runs them word for word",
    "rockpulse assess archive/ --config site.toml -o all.h5 --scheduler": "it needs a cluster; tests/pipeline/batch",
    "make ": "minutes to hours; tests/benchmarks",
    "python benchmarks/": "minutes to hours; CONTRIBUTING.md",
}


#: Pages whose commands are about files of one's own.
PAGES = ("README.md", "docs/tour.md", "docs/speed.md")


def commands():
    """Every command of these pages as it would be typed with the environment active; one that stands twice, once."""
    every = [block for page in PAGES for block in blocks(TOP / page) if block.kind == "sh"]
    lines = [line for block in every for line in block.body.splitlines()]
    typed = [line.replace(".venv/bin/", "").replace("--workers 8", "--workers 1") for line in lines]
    return list(dict.fromkeys(line.split("  #")[0].strip() for line in typed))


def test_the_readme_is_read_at_one_sitting():
    assert len((TOP / "README.md").read_text(encoding="utf-8").splitlines()) <= 120


@pytest.mark.sweep
def test_the_commands_do_what_the_readme_says(tmp_path):
    (tmp_path / "data").symlink_to(TOP / "data", target_is_directory=True)
    records = [TOP / "data/samples/formats/clc_90.v2"]  # one short channel: the commands are many
    for name in ("my_records", "archive"):
        (tmp_path / name).mkdir()
        for record in records:
            (tmp_path / name / record.name).symlink_to(record)
    with zipfile.ZipFile(tmp_path / "agency.zip", "w") as archive:
        for record in records:
            archive.write(record, record.name)
    (tmp_path / "site_records").mkdir()
    for year in range(2011, 2019):  # a design asks for seven earthquakes at least
        title = f"Earthquake {year}, 1/2/{year}, Station, 90"
        motion = synthetic_motion(seed=year, duration=6.0, pga=3.0) / 9.80665
        (tmp_path / "site_records" / f"{year}.AT2").write_bytes(at2(motion, title=title))
    first = "rockpulse assess data/samples/records --config data/samples/site.toml -o results.h5 --overwrite"
    assert any(first in line for line in commands())
    first = first.replace("data/samples/records", str(records[0]))  # .ci/run runs it word for word
    kept = [
        line.replace("calibrate my_records/", "calibrate site_records/").replace("*TOW2..90*", "*..90*")
        for line in commands()
        if not line.startswith(tuple(LEFT_OUT))
    ]
    again = next(place for place, line in enumerate(kept) if "--resume" in line)
    kept.insert(again, "rm all.h5")  # as if the run before had been cut off
    page = tmp_path / "README.md"
    typed = "\n".join([first, "cp results.h5 before.h5", *kept]).replace("before.h5 after.h5", "before.h5 results.h5")
    page.write_text("\n".join(f"```sh\n{line}\n```\n" for line in typed.splitlines()), encoding="utf-8")
    run_page(page, tmp_path)
    for line in kept:
        for made in re.findall(r"(?: -o|--log-file) (\S+)", line.split("  #")[0]):
            file = Path(made)
            found = [*tmp_path.glob(made), *tmp_path.glob(f"{file.stem}.*{file.suffix}")]  # convert: one a channel
            assert found, line
            assert all(one.stat().st_size > 0 for one in found), line


def test_what_is_left_out_is_there():
    for start in LEFT_OUT:
        assert any(line.startswith(start) for line in commands()), start
