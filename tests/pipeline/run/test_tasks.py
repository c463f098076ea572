"""Tasks carried out one by one give what the assessment in memory gives, and whatever goes wrong is a row."""

import logging
import pickle
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from batch_runs import planned
from nominal import Config, ida
from record_writers import at2, pulse
from record_writers.geonet import geonet

import rockpulse as rp
from rockpulse.assessment.assessment import Assessment, assess
from rockpulse.assessment.tree import joined_parts
from rockpulse.readers.folders import read_all
from rockpulse.run.analysis import run
from rockpulse.run.frames import unpack
from rockpulse.run.journal import UNFINISHED, Done
from rockpulse.run.tasks import carry_out
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration

WALL = rp.BlockSettings(name="wall", width=0.4, height=3.0)
TOWER = rp.BlockSettings(name="tower", width=1.0, height=5.0, restitution=(0.9, 0.95))
CHEAP = Config(
    bodies=(WALL, replace(TOWER, restitution="housner")),
    models=rp.ModelSettings(use=("sequence", "impulsive", "linear")),
    search=rp.SearchSettings(models=()),
)
CONFIGURATIONS = {
    "horizontal": CHEAP,
    "cases": replace(
        CHEAP,
        bodies=(replace(WALL, restitution=(0.91, 0.96)), TOWER),
        demands=(rp.DemandSettings(name="damage", value=1.0),),
    ),
    "vertical": replace(
        CHEAP,
        records=rp.RecordSettings(include_vertical=True, store="half_waves"),
        models=rp.ModelSettings(use=("nonlinear",), histories=True),
    ),
    "sweep": replace(
        CHEAP, records=rp.RecordSettings(components="sweep", azimuth_step=45.0, include_vertical=True, store="none")
    ),
    # The horizontal channels have 3 and -2.5 m/s2 at once: not every direction exceeds the bracket.
    "failing": replace(
        CHEAP,
        records=rp.RecordSettings(components="sweep", azimuth_step=20.0),
        intense_phase=rp.IntensePhaseSettings(method="bracketed", level=3.2),
    ),
}


def function_of(analysis):
    """What is sent to a worker."""
    function = partial(carry_out, work=analysis.work, stage=analysis.name, config=analysis.config)
    return pickle.loads(pickle.dumps(function))


@pytest.fixture
def two_files(tmp_path):
    """Two instruments of two horizontal channels and a vertical one [mm/s2]."""
    for number in range(2):
        channels = [pulse(300 + number, peak * (1.0 + 0.1 * number)) for peak in (3000.0, -2500.0, 1500.0)]
        (tmp_path / f"g{number}.V1A").write_bytes(geonet(channels, site=f"ST{number}"))
    return tmp_path


def carried_out(paths, analysis) -> tuple[list[tuple[str, Done]], list, list]:
    """Every task as another process would do it, with its earthquake; what was planned, and all rows."""
    tasks, plan = planned(paths, analysis)
    function = function_of(analysis)
    done = [pickle.loads(pickle.dumps(function(pickle.loads(pickle.dumps(task))))) for task in tasks]
    assert [(one.key, one.fingerprint) for one in done] == [(task.key, task.fingerprint) for task in tasks]
    rows = [*plan.failures, *(row for one in done for row in one.failures)]
    return [(plan.events[one.key], one) for one in done], plan.planned, rows


@pytest.mark.sweep
@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_tasks_one_by_one_give_the_arrays_of_the_assessment_in_memory(two_files, name):
    config = CONFIGURATIONS[name]
    done, _, rows = carried_out(two_files, Assessment(config))
    records, failures = read_all(two_files)
    tree = assess(records, config, failures=failures)
    arrays = joined_parts([unpack(part) for _, one in done for part in one.parts])
    assert len(arrays["/summary/record"]) == tree["summary"].sizes["record"] > 0
    assert len(arrays) > 50
    assert "/summary/event" not in arrays  # all records together tell it
    for path, values in arrays.items():
        np.testing.assert_array_equal(values, tree[path].values, strict=True, err_msg=path)
    told = zip(*(tree["failures"][key].values.tolist() for key in ("file", "stage", "reason", "kind")), strict=True)
    assert [(row.file, row.stage, row.reason, row.kind) for row in rows] == list(told)
    if name == "failing":
        assert any(row.stage == "assess" for row in rows)


def test_a_pair_that_cannot_be_rotated_is_rows_of_its_task(two_files):
    # Filtering needs corners below the Nyquist frequency.
    config = replace(
        CHEAP,
        records=rp.RecordSettings(components="azimuth", azimuth=30.0),
        conditioning=rp.ConditioningSettings(lowpass_hz=120.0),
    )
    done, _, rows = carried_out(two_files, Assessment(config))
    records, failures = read_all(two_files)
    tree = assess(records, config, failures=failures)
    assert [row.reason for row in rows] == tree["failures"]["reason"].values.tolist()
    lost = [one for _, one in done if not one.parts]
    assert lost
    assert all([row.stage for row in one.failures] == ["rotate", "rotate"] for one in lost)


@pytest.mark.parametrize(
    ("components", "analysis"),
    [pytest.param("horizontal", FragilityAnalysis, marks=pytest.mark.sweep), ("sweep", SiteCalibration)],
)
def test_the_tasks_of_any_order_give_the_tree_in_memory(two_files, components, analysis):
    asked = analysis(
        Config(
            bodies=CHEAP.bodies,
            calibration=rp.CalibrationSettings(bootstrap=100),
            fragility=ida(limit_states=("uplift", 0.4), measures=("pga", "demand_cubic"), pga_min=2.0),
            search=rp.SearchSettings(points=8),
            records=rp.RecordSettings(components=components, azimuth_step=90.0, include_vertical=True),
        )
    )
    done, motions, rows = carried_out(two_files, asked)
    packed = [(event, part) for event, one in reversed(done) for part in one.parts]
    assert max(len(part) for _, part in packed) < 8000  # no samples
    assert all(part[:4] == b"RPA1" for _, part in packed)  # no pickle
    found = asked.collect([asked.of_event(unpack(part), event) for event, part in packed], motions, rows)
    records, failures = read_all(two_files)
    expected = run(asked, records, failures)
    assert found.groups == expected.groups
    for group in expected.groups:
        assert found[group].to_dataset().identical(expected[group].to_dataset()), group


@pytest.fixture
def one_task(tmp_path):
    """A record of its own and the work on it."""
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse()))
    analysis = Assessment(CHEAP)
    ((task,), _) = planned(path, analysis)
    return path, task, function_of(analysis)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda path: path.write_bytes(at2(pulse(peak=0.2))), "has changed since"),
        (lambda path: path.unlink(), "No such file"),
    ],
)
def test_a_file_that_changed_or_vanished_since_the_survey_is_a_row(one_task, change, reason):
    path, task, function = one_task
    change(path)
    done = function(task)
    assert done.parts == ()
    assert done.fingerprint == UNFINISHED != task.fingerprint  # tried again when the run is resumed
    (row,) = done.failures
    assert (row.file, row.stage, row.kind) == (str(path), "read", "failed")
    assert reason in row.reason


def test_what_a_task_logs_comes_back_and_goes_nowhere_else(one_task, caplog):
    path = one_task[0]
    path.write_bytes(at2(pulse() + 0.05))  # the velocity drifts
    analysis = Assessment(replace(CHEAP, conditioning=rp.ConditioningSettings(baseline="none")))
    ((task,), _) = planned(path, analysis)
    done = function_of(analysis)(task)
    assert [(level, "baseline drift" in text) for _, level, text in done.messages] == [(logging.WARNING, True)]
    assert caplog.records == []
    logging.getLogger("rockpulse").warning("heard again")
    assert [record.message for record in caplog.records] == ["heard again"]
