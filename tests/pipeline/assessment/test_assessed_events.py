"""The earthquake of every record in an assessment, by the table, the title or the time, in memory and in a batch."""

from dataclasses import replace

import numpy as np
import pytest
from nominal import Config

import rockpulse as rp
from rockpulse import BlockSettings, ModelSettings, RecordSettings
from rockpulse.assessment.answers import answers_of
from rockpulse.errors import ConfigError
from rockpulse.readers.folders import read_all
from rockpulse.run import survey
from rockpulse.run.journal import journal_path
from rockpulse.run.options import BatchOptions
from rockpulse.selection.events import UNKNOWN
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.views.shared.verdict_table import of_unknown_event

CONFIG = Config(bodies=(BlockSettings(name="wall", width=0.3, height=2.4),), models=ModelSettings(use=("resonance",)))
TITLES = ("Kobe, 1/16/1995", "KOBE 01/16/95", "", "")


@pytest.fixture
def folder(tmp_path):
    """Four files: two of one title, two that tell nothing."""
    place = tmp_path / "records"
    place.mkdir()
    for number, title in enumerate(TITLES):
        motion = (3.0 + number) * np.sin(2.0 * np.pi * np.arange(0.0, 4.0, 0.02))
        rp.write(rp.Record(motion, dt=0.02, id=f"m{number}", event=title), place / f"m{number}.at2")
    return place


def with_table(tmp_path, text):
    (tmp_path / "events.csv").write_text(text)
    return replace(CONFIG, records=RecordSettings(events=str(tmp_path / "events.csv")))


def events(tree):
    return dict(zip(tree["summary"]["record"].values.tolist(), tree["summary"]["event"].values.tolist(), strict=True))


def both(folder, config, target, options=None):
    """Events by id, from memory and from a batch, which are the same."""
    records, failures = read_all(folder)
    found = events(rp.assess(records, config, failures=failures))
    rp.assess_files(folder, config, target, options)
    assert events(rp.load(target)) == found
    return found


def test_records_are_counted_by_title_and_those_that_tell_nothing_as_one(folder, tmp_path):
    records, failures = read_all(folder)
    tree = rp.assess(records, CONFIG, failures=failures)
    found = list(events(tree).values())
    assert found[0] == found[1]
    assert found[2:] == [UNKNOWN, UNKNOWN]
    assert tree["summary"]["event_title"].values.tolist() == list(TITLES)
    motions = answers_of(tree).motions
    assert motions.event_count == 1  # those that tell nothing add none
    assert "2 motions whose earthquake is stated neither" in of_unknown_event(motions)


@pytest.mark.slow
def test_the_table_decides(folder, tmp_path):
    names = [one.id for one in read_all(folder)[0]]
    config = with_table(tmp_path, f"record,event\n{names[1]},aftershock\n{names[3]},Maule\n")
    assert list(both(folder, config, tmp_path / "told.h5").values())[1:] == ["aftershock", UNKNOWN, "Maule"]
    assert answers_of(rp.load(tmp_path / "told.h5")).motions.event_count == 3
    known = "".join(f"{name},Maule\n" for name in names[2:])
    tree = rp.assess(read_all(folder)[0], with_table(tmp_path, f"record,event\n{known}"))
    assert events(tree)[names[2]] == "Maule"
    assert of_unknown_event(answers_of(tree).motions) == ""


def test_a_missing_or_wrong_table_is_refused_before_records_are_read(folder, tmp_path, monkeypatch):
    def never(*args):
        raise AssertionError("a record was read")

    monkeypatch.setattr(survey, "read_opened", never)
    config = replace(CONFIG, records=RecordSettings(events=str(tmp_path / "none.csv")))
    for verb in (rp.assess_files, rp.calibrate_files):
        with pytest.raises(ConfigError, match=r"\[records\] events: .*none\.csv: no such file"):
            verb(folder, config, tmp_path / "x.h5")
        with pytest.raises(ConfigError, match="missing: event"):
            verb(folder, with_table(tmp_path, "record,quake\nm0,Kobe\n"), tmp_path / "x.h5")
    assert not journal_path(tmp_path / "x.h5").exists()
    with pytest.raises(ConfigError, match=r"\[records\] events: .*none\.csv: no such file"):
        rp.assess([], config)


@pytest.mark.sweep
def test_unknown_ids_are_refused_or_told_where_a_file_was_not_read(folder, tmp_path):
    config = with_table(tmp_path, "record,event\nelsewhere,Kobe\n")
    with pytest.raises(ConfigError, match="no record has the id elsewhere"):
        both(folder, config, tmp_path / "x.h5")
    with pytest.raises(ConfigError, match="no record has the id elsewhere"):
        rp.assess_files(folder, config, tmp_path / "x.h5")
    (folder / "broken.at2").write_bytes((folder / "m0.at2").read_bytes()[:900])
    told = []
    both(folder, config, tmp_path / "y.h5", BatchOptions(tell=told.append))
    said = "[records] events names records that were not read: elsewhere; examples of the records that were read: m0"
    assert [line.startswith(said) for line in told] == [True]
    records, failures = read_all(folder)
    of_fragility = FragilityAnalysis(config).plan(records[:1], failures).failures
    kept = rp.load(tmp_path / "y.h5")["failures"]["reason"].values.tolist()
    for reasons in (kept, [row.reason for row in of_fragility]):
        assert sum(reason.startswith(said) for reason in reasons) == 1
