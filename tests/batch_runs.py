"""Runs of the command line on a folder of four records, and a folder for runs in Python."""

import pickle
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

from record_writers import at2, pulse

from rockpulse import BlockSettings, CalibrationSettings, Config, ModelSettings, SearchSettings
from rockpulse.cli import main
from rockpulse.readers.folders import find_files
from rockpulse.run import batch
from rockpulse.run.survey import gather_survey, survey_file
from rockpulse.run.tasks import read_options, tasks_of

RECORDS = 4
CONFIGURATION = """
[site]
name = "Test"
[models]
use = ["resonance"]
[search]
models = []
[[block]]
name = "wall"
width = 0.4
height = 3.0
"""

CONFIG = Config(
    models=ModelSettings(use=("resonance",)),
    search=SearchSettings(models=()),
    bodies=(BlockSettings(name="wall", width=0.4, height=3.0),),
)
SITE = Config(calibration=CalibrationSettings(bootstrap=100), bodies=CONFIG.bodies)


def surveyed(paths, options):
    """The records of files without samples, and the failures: surveyed in any order, as if by other processes."""
    found, failures = find_files(paths)
    surveys = [pickle.loads(pickle.dumps(survey_file(one, options))) for one in reversed(found)]
    rows = [*failures, *(row for survey in surveys for row in survey.failures)]
    return gather_survey([one for survey in surveys for one in survey.located], rows)


def planned(paths, analysis, survey=surveyed):
    """The tasks of an analysis, and its plan."""
    located, rows = survey(paths, read_options(analysis.config))
    plan = analysis.plan([one.record for one in located], rows)
    return tasks_of([*plan.planned], [*located], analysis.config, analysis.name), plan


def four_records(folder, longer=0):
    """The folder with three records that are worked on, r0 to r2, and another one, each by some samples longer."""
    for number, name in enumerate(("r0", "r1", "r2", "other")):
        title = f"Event {number}, 1/2/2003, Station {number}, 090"
        (folder / f"{name}.AT2").write_bytes(at2(pulse(400 + longer * number, 0.25 + 0.1 * number), title=title))
    return folder


def write(path, peak, samples=400):
    path.write_bytes(at2(pulse(samples, peak), title="Event, 1/2/2003, Station, 090"))


def records_in(folder, count, samples=400):
    """The folder with a number of records and a configuration."""
    for number in range(count):
        write(folder / f"r{number}.AT2", 0.2 + 0.05 * number, samples)
    (folder / "site.toml").write_text(CONFIGURATION)
    return folder


def without_results(monkeypatch):
    """The runs from now on write no results, where a test does not look at them."""
    monkeypatch.setattr(batch, "write_results", lambda path, parts, *given: sum(1 for _ in parts))


def bar_of(update):
    """A progress bar that calls a function with its description at each step."""

    @contextmanager
    def bar(desc, **about):
        yield SimpleNamespace(update=lambda n: update(desc))

    return bar


def names(folder):
    """What lies in a folder."""
    return sorted(path.name for path in Path(folder).iterdir())


def command(folder, target, *options):
    """The exit code of an assessment of the folder, by this process alone."""
    given = ["--config", str(folder / "site.toml"), "-o", str(target), "--workers", "1", *options]
    return main(["assess", str(folder), *given])
