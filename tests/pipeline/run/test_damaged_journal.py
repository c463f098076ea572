"""Journals that were damaged or forged: what was in them is done again, and nothing else."""

import re
from dataclasses import replace

import numpy as np
import pytest
from batch_runs import CONFIG, SITE, four_records, records_in
from file_contents import assert_contents, contents
from record_writers import pulse

import rockpulse as rp
from rockpulse import FragilitySettings, ModelSettings
from rockpulse.assessment.assessment import Assessment
from rockpulse.config.study_settings import DATA
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.run import batch
from rockpulse.run.analysis import worked
from rockpulse.run.batch import assess_files
from rockpulse.run.frames import pack, unpack
from rockpulse.run.journal import Done, Journal, journal_path
from rockpulse.run.options import BatchOptions
from rockpulse.studies.fragility.fragility import FragilityAnalysis
from rockpulse.studies.site.calibration import SiteCalibration


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return four_records(tmp_path_factory.mktemp("records"))


def stopped_at_the_end(paths, output, monkeypatch):
    """A run that has all records in its journal and no results."""

    def interrupted(*given):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(batch, "write_results", interrupted)
        with pytest.raises(KeyboardInterrupt):
            assess_files(paths, CONFIG, output, BatchOptions(workers=1))


@pytest.mark.sweep
def test_a_result_that_was_damaged_in_the_journal_is_done_again_and_the_others_are_not(folder, tmp_path, monkeypatch):
    paths, output, told = sorted(folder.glob("r*")), tmp_path / "results.h5", []
    stopped_at_the_end(paths, output, monkeypatch)
    with Journal.open(output, resume=True) as journal:
        key = next(one for one in journal.finished() if one.startswith("r1"))
    content = bytearray(journal_path(output).read_bytes())
    content[content.index(f'"{key}"'.encode()) + 2000] ^= 4  # in the parts after the head
    journal_path(output).write_bytes(content)
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, tell=told.append))
    assert (report.records, report.resumed, report.failures) == (3, 2, [])
    assert told == [
        f"{journal_path(output)} is damaged: the results of {key} cannot be used; missing records are processed again",
        "2 of 3 records were finished before",
    ]
    assess_files(paths, CONFIG, tmp_path / "alone.h5", BatchOptions(workers=1))
    assert_contents(output, contents(tmp_path / "alone.h5"))


def headed(text):
    """The packed arrays of a header, without a value."""
    return b"RPA1" + len(text).to_bytes(8, "little") + text.encode()


def without(name, part):
    return pack({path: values for path, values in part.items() if path != name})


#: What somebody may put in the place of a part, with a checksum that fits.
FORGED = {
    "no part": lambda part: (),
    "no bytes": lambda part: (b"",),
    "no arrays": lambda part: (headed(""),),
    "no shape": lambda part: (headed('[["a", 3]]'),),
    "a hundred terabytes of texts without a letter": lambda part: (headed('[["a", "U0", [100000000000000]]]'),),
    "an array fewer": lambda part: (without("/summary/pga", part),),
    "a row more in one array": lambda part: (pack({**part, "/summary/pga": np.zeros(2)}),),
    "another shape": lambda part: (pack({**part, "/summary/peak_rotation_ratio": np.zeros((1, 7, 7))}),),
    "a number as such": lambda part: (pack({**part, "/summary/pga": np.array(1.0)}),),
    "texts for numbers": lambda part: (pack({**part, "/summary/pga": np.array(["1"])}),),
    "a sound and a wrong one": lambda part: (pack(part), without("/summary/pga", part)),
}


@pytest.mark.slow
def test_what_somebody_has_put_into_the_journal_as_a_result_is_done_again(tmp_path, monkeypatch):
    """Each in the place of a record of its own; the last record keeps its result."""
    records, output = records_in(tmp_path, len(FORGED) + 1), tmp_path / "results.h5"
    paths = sorted(records.glob("*.AT2"))
    assess_files(paths, CONFIG, tmp_path / "alone.h5", BatchOptions(workers=1))
    stopped_at_the_end(paths, output, monkeypatch)
    with Journal.open(output, resume=True) as journal:
        *keys, sound = journal.finished()
        for key, change in zip(keys, FORGED.values(), strict=True):
            journal.add(Done(key, journal.finished()[key], change(unpack(*journal.parts(key)))))
    add, again, told = Journal.add, [], []
    monkeypatch.setattr(Journal, "add", lambda self, done: again.append(done.key) or add(self, done))
    report = assess_files(paths, CONFIG, output, BatchOptions(workers=1, resume=True, tell=told.append))
    assert [forged for forged, key in zip(FORGED, keys, strict=True) if key not in again] == []
    assert sound not in again
    assert report.resumed == 1
    assert re.search(r"is damaged: the results of .* cannot be used; missing records are processed again", told[0])
    assert_contents(output, contents(tmp_path / "alone.h5"))


EVERY = {
    "assess": Assessment(replace(CONFIG, models=ModelSettings(use=("sequence", "nonlinear")))),
    "calibrate": SiteCalibration(SITE),
    **{data: FragilityAnalysis(replace(CONFIG, fragility=FragilitySettings(data=data))) for data in DATA},
}


@pytest.mark.sweep
@pytest.mark.parametrize("name", EVERY)
def test_a_part_fits_the_analysis_that_makes_it_and_no_other(name):
    record = rp.Record(pulse(400, 0.4) * STANDARD_GRAVITY, dt=0.01, id="r", processed=True)
    (planned,) = EVERY[name].plan([record]).planned
    (part,) = worked(planned, EVERY[name].work, name, EVERY[name].config)
    back = unpack(pack(part))
    assert [one for one, analysis in EVERY.items() if analysis.fits(back)] == [name]
