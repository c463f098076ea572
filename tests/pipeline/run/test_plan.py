"""Tasks are what the assessment in memory would do, and their fingerprints change with their answers."""

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import batch_runs
import pytest
from batch_runs import surveyed
from record_writers import at2, pulse

import rockpulse as rp
from rockpulse.assessment.assessment import Assessment
from rockpulse.config.configuration import Config
from rockpulse.run.tasks import configuration_fingerprint, digest_of, read_options, tasks_of
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration

SAMPLES = Path(__file__).parents[3] / "data" / "samples" / "records"
WALL = rp.BlockSettings(name="wall", width=0.4, height=3.0)
SWEEP = {"components": "sweep", "azimuth_step": 45.0, "include_vertical": True}


def config(**records):
    return Config(bodies=(WALL,), records=rp.RecordSettings(**records))


#: The same of files that stay as they are.
surveyed_once = cache(surveyed)


def planned(paths, options=None, analysis=Assessment):
    """The tasks of a run, and its plan."""
    return batch_runs.planned(paths, analysis(options or config()), surveyed_once if paths == SAMPLES else surveyed)


@pytest.mark.sweep
def test_a_record_of_many_takes_few_bytes_until_its_results(tmp_path):
    for number in range(100):
        title = f"Event {number // 20}, 1/2/2003, Station {number % 20}, 090"
        (tmp_path / f"r{number:03d}.AT2").write_bytes(at2(pulse(200, 0.2 + 0.01 * number), title=title))
    located, rows = surveyed(tmp_path, read_options(config()))
    planned = Assessment(config()).plan([one.record for one in located], rows).planned
    tasks = tasks_of(planned, located, config(), "assess")
    assert (planned, located) == ([], [])  # what is not packed is gone
    assert len({id(task.pattern) for task in tasks}) == 1
    assert len(tasks[0].pattern) < 8000
    assert sum(len(task.content) for task in tasks) < 400 * len(tasks)


def test_tasks_of_a_site_and_of_fragility_are_in_the_order_of_the_ids(tmp_path):
    for name in ("b", "a"):
        folder = tmp_path / ("1" if name == "b" else "2")
        folder.mkdir()
        (folder / f"{name}.AT2").write_bytes(at2(pulse(peak=0.1 if name == "a" else 0.2)))
    assert [task.key for task in planned(tmp_path)[0]] == ["b.090", "a.090"]
    for analysis in (SiteCalibration, FragilityAnalysis):
        assert [task.key for task in planned(tmp_path, analysis=analysis)[0]] == ["a.090", "b.090"]


def fingerprints(paths, options=None):
    return {task.key: task.fingerprint for task in planned(paths, options)[0]}


@pytest.mark.sweep
def test_a_fingerprint_is_the_same_in_every_run_and_another_for_every_record(samples):
    first = fingerprints(samples)
    assert fingerprints([samples]) == first  # surveyed again
    assert len(set(first.values())) == len(first) == 9


def test_a_fingerprint_changes_with_the_samples_and_with_what_is_known_of_the_record(tmp_path):
    path = tmp_path / "a.AT2"
    seen = []
    for content in (at2(pulse()), at2(pulse(peak=0.31)), at2(pulse(), title="Elsewhere, 1/2/2003, Station One, 090")):
        path.write_bytes(content)
        seen.append(fingerprints(path)["a.090"])
    path.rename(tmp_path / "b.AT2")
    seen.append(fingerprints(tmp_path / "b.AT2")["b.090"])
    assert len(set(seen)) == 4


@pytest.mark.sweep
def test_a_fingerprint_changes_with_the_vertical_channel(samples, tmp_path):
    for name in ("CICLC.v1", "CICCC.RAW"):
        shutil.copy(samples / name, tmp_path / name)
    options = config(include_vertical=True)
    before = fingerprints(tmp_path, options)
    text = (tmp_path / "CICLC.v1").read_bytes()
    lines = text.split(b"\n")
    # A number of the last block of data, which is that of the vertical channel.
    at = max(number for number, line in enumerate(lines) if line.count(b".") == 8)
    lines[at] = lines[at].replace(lines[at][:9], b" 0.012345", 1)
    (tmp_path / "CICLC.v1").write_bytes(b"\n".join(lines))
    after = fingerprints(tmp_path, options)
    assert list(after) == list(before)
    assert {name for name in before if before[name] != after[name]} == {name for name in before if "CLC" in name}


#: Every section with a change, and the verbs whose numbers it changes.
CHANGES = [
    ({"site": rp.SiteSettings(name="x")}, ""),
    ({"records": rp.RecordSettings(paths=("x",))}, ""),
    ({"records": rp.RecordSettings(events="x.csv")}, ""),
    ({"run": rp.RunSettings(workers=3)}, ""),
    ({"fragility": rp.FragilitySettings(pga_min=0.5)}, "fragility"),
    ({"fragility": rp.FragilitySettings(data="cloud")}, "fragility"),
    ({"fragility": rp.FragilitySettings(confidence=0.8, model="logistic", overturning_model="lognormal")}, ""),
    ({"records": rp.RecordSettings(store="none")}, "assess calibrate fragility"),
    ({"records": rp.RecordSettings(include_vertical=True)}, "assess calibrate fragility"),
    # Told by the records that are read with them, and by each task.
    ({"records": rp.RecordSettings(units="g", dt=0.02, files=(rp.FileSettings(match="*", units="g"),))}, ""),
    ({"records": rp.RecordSettings(confirm=("*",))}, ""),
    ({"run": rp.RunSettings(seed=3)}, "assess"),
    ({"uncertainty": rp.UncertaintySettings(factor=0.2)}, "assess"),
    ({"conditioning": rp.ConditioningSettings(highpass_hz=0.1)}, "assess calibrate fragility"),
    ({"half_waves": rp.HalfWaveSettings(merge=False)}, "assess calibrate fragility"),
    ({"intense_phase": rp.IntensePhaseSettings(method="D5-75")}, "assess calibrate fragility"),
    ({"sequence": rp.SequenceSettings(spacing="middle")}, "assess calibrate fragility"),
    ({"bodies": ()}, "assess calibrate fragility"),
    ({"bodies": (replace(WALL, restitution=0.9),)}, "assess calibrate fragility"),
    ({"models": rp.ModelSettings(use=("linear",))}, "assess"),
    ({"search": rp.SearchSettings(factor_max=5.0)}, "assess fragility"),
    ({"search": rp.SearchSettings(intervals=True)}, "assess"),
    ({"demands": (rp.DemandSettings(name="x", value=1.0),)}, "assess calibrate fragility"),
    ({"calibration": rp.CalibrationSettings(spectrum="nonlinear")}, "calibrate"),
    ({"calibration": rp.CalibrationSettings(scale_to="pga", target=3.0)}, "calibrate"),
    ({"calibration": rp.CalibrationSettings(quantile=0.5, confidence=0.8, bootstrap=200, weights="w.csv")}, ""),
]


@pytest.mark.parametrize("verb", ["assess", "calibrate", "fragility"])
def test_the_fingerprint_of_the_configuration_changes_with_what_changes_numbers(verb):
    start = config()
    plain = configuration_fingerprint(start, verb)
    changed = [change for change, _ in CHANGES if configuration_fingerprint(replace(start, **change), verb) != plain]
    assert changed == [change for change, verbs in CHANGES if verb in verbs]


def test_the_seed_counts_in_an_assessment_only_where_there_is_a_probability():
    off = replace(config(), uncertainty=rp.UncertaintySettings(probability=False))
    for plain, same in ((config(), False), (off, True)):
        seeded = replace(plain, run=rp.RunSettings(seed=3))
        assert (configuration_fingerprint(plain, "assess") == configuration_fingerprint(seeded, "assess")) is same


def test_the_mean_over_directions_is_taken_when_all_records_are_done():
    swept = replace(config(), records=rp.RecordSettings(components="sweep"))
    mean = replace(swept, uncertainty=rp.UncertaintySettings(azimuth=True))
    assert configuration_fingerprint(swept, "assess") == configuration_fingerprint(mean, "assess")


def test_the_fingerprint_of_the_configuration_knows_verb_version_program_and_schema(monkeypatch):
    from rockpulse.run import tasks as module

    seen = {configuration_fingerprint(config(), verb) for verb in ("assess", "calibrate", "fragility")}
    monkeypatch.setattr(module, "__version__", "x")
    seen.add(configuration_fingerprint(config(), "assess"))
    monkeypatch.setattr(module, "SCHEMA_VERSION", "x")
    seen.add(configuration_fingerprint(config(), "assess"))
    monkeypatch.setattr(module, "program_digest", lambda: "x")
    seen.add(configuration_fingerprint(config(), "assess"))
    assert len(seen) == 6


def test_a_body_is_the_same_whether_its_size_was_confirmed_or_not():
    wall = rp.BlockSettings(name="wall", width=0.3, height=2.4)
    one, other = (
        configuration_fingerprint(Config(bodies=(body,)), "assess") for body in (wall, replace(wall, confirm_size=True))
    )
    assert one == other


@pytest.mark.parametrize("package", ["rocking", "rockpulse"])
def test_the_program_is_known_by_its_sources(monkeypatch, tmp_path, package):
    from rockpulse.run import tasks as module

    for name in ("rocking/kernels/march.py", "rockpulse/run/tasks.py", "rocking/__init__.py", "rockpulse/__init__.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x = 1\n")
    monkeypatch.setattr(module.rocking, "__file__", str(tmp_path / "rocking" / "__init__.py"))
    monkeypatch.setattr(module, "__file__", str(tmp_path / "rockpulse" / "batch" / "plan.py"))
    digest = module.program_digest.__wrapped__
    seen = {digest()}
    for changed in ((tmp_path / package).glob("*/*.py"), (tmp_path / package).glob("*.py")):
        next(changed).write_text("x = 2\n")
        seen.add(digest())
    (tmp_path / package / "__init__.py").rename(tmp_path / package / "other.py")
    seen.add(digest())
    assert len(seen) == 4
    (tmp_path / "other.py").write_text("x = 3\n")
    assert digest() in seen


def test_unit_and_interval_of_some_files_change_the_fingerprints_of_these_only(tmp_path):
    for name in ("a.g3", "b.g3", "c.txt"):
        (tmp_path / name).write_text("\n".join(f"{value:.6f}" for value in pulse(300 + ord(name[0]))))
    rows = (rp.FileSettings(match="*", units="g", dt=0.01), rp.FileSettings(match="b.*", units="cm/s2"))
    before, units = (fingerprints(tmp_path, config(files=rows[:count])) for count in (1, 2))
    assert fingerprints(tmp_path, config(units="g", dt=0.01)) == before
    assert {name for name in before if before[name] != units[name]} == {"b.1"}
    dt = fingerprints(tmp_path, config(files=(*rows, rp.FileSettings(match="*.g3", dt=0.02))))
    assert {name for name in units if units[name] != dt[name]} == {"a.1", "b.1"}


def test_what_is_confirmed_changes_the_fingerprints_of_the_tasks_that_it_names(samples):
    plain = fingerprints(samples, config(include_vertical=True))
    named = fingerprints(samples, config(include_vertical=True, confirm=("CI.CLC*Up*", "*CCC*90@*")))
    changed = {name.partition("@")[0] for name in plain if plain[name] != named[name]}
    assert changed == {"CI.CLC..360", "CI.CLC..90", "CI.CCC..90"}


def test_what_a_run_is_asked_for_is_every_record_the_earthquake_of_each_and_the_whole_configuration(samples, tmp_path):
    weighted = replace(config(), calibration=rp.CalibrationSettings(weights="w.csv"), folder=tmp_path)
    (tmp_path / "w.csv").write_text("record,weight\na,1\n")
    tasks, _ = planned(samples, weighted)
    events = dict.fromkeys((task.key for task in tasks), "one")
    plain = digest_of(tasks, events, weighted, "assess")
    assert digest_of(tasks[::-1], events, weighted, "assess") == plain
    assert digest_of(tasks, events, replace(weighted, run=rp.RunSettings(workers=3)), "assess") == plain
    last = tasks[-1]
    seen = {
        plain,
        digest_of(tasks, events, weighted, "fragility"),
        digest_of(tasks, events, replace(weighted, site=rp.SiteSettings(name="x")), "assess"),
        digest_of(tasks, events, replace(weighted, run=rp.RunSettings(seed=3)), "assess"),
        digest_of(tasks[:-1], events, weighted, "assess"),
        digest_of(tasks, {**events, last.key: "other"}, weighted, "assess"),
        digest_of([*tasks[:-1], replace(last, fingerprint="x")], events, weighted, "assess"),
        digest_of([*tasks[:-1], replace(last, key="x")], events, weighted, "assess"),
    }
    (tmp_path / "w.csv").write_text("record,weight\na,2\n")
    seen.add(digest_of(tasks, events, weighted, "assess"))
    assert len(seen) == 9


def test_another_selection_of_records_is_another_task(tmp_path):
    chosen = replace(config(), fragility=rp.FragilitySettings(selection="chosen.csv"), folder=tmp_path)
    seen = set()
    for text in ("record,factor\na,1\n", "record,factor\na,2\n", "record,factor,weight\na,2,3\n"):
        (tmp_path / "chosen.csv").write_text(text)
        seen.add(configuration_fingerprint(chosen, "fragility"))
    assert len(seen) == 3
    # Whatever is asked of the results afterwards changes no record.
    for change in (
        {"hazard": rp.HazardSettings(k0=1e-4, k=2.0)},
        {"check": rp.CheckSettings(spectrum="en_1998_1", ag=0.2)},
    ):
        for verb in ("assess", "calibrate", "fragility"):
            plain, changed = (configuration_fingerprint(one, verb) for one in (config(), replace(config(), **change)))
            assert plain == changed
