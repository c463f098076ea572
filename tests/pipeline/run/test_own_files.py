"""An output, its journal and a log that lie among the records are none of them."""

import os

import numpy as np
import pytest
from batch_runs import CONFIG, bar_of
from record_writers import at2, pulse

from rockpulse.errors import StoppedAtFailure
from rockpulse.run.batch import assess_files
from rockpulse.run.journal import holder, journal_path
from rockpulse.run.options import BatchOptions


@pytest.mark.sweep
def test_a_resumed_run_neither_reads_nor_unlocks_its_own_journal(tmp_path):
    (tmp_path / "a.AT2").write_bytes(at2(pulse(400)))
    (tmp_path / "still.AT2").write_bytes(at2(np.zeros(400)))
    log, output, link = tmp_path / "run.log", tmp_path / "results.out", tmp_path / "link.txt"
    log.write_text("2026 INFO rockpulse assess\n")
    with pytest.raises(StoppedAtFailure):
        assess_files(tmp_path, CONFIG, output, BatchOptions(workers=1, strict=True, written=(log,)))
    journal = journal_path(output)
    link.symlink_to(journal)  # a suffix that is not passed over by its name
    holders = []
    bar = bar_of(lambda desc: holders.append(holder(journal)))
    options = BatchOptions(workers=1, resume=True, written=(log,), bar=bar)
    report = assess_files([tmp_path, journal, log], CONFIG, output, options)
    assert [os.path.basename(row.file) for row in report.failures] == ["still.AT2"]  # noqa: PTH119
    assert (report.records, report.resumed) == (1, 2)
    if os.path.exists("/proc/locks"):  # noqa: PTH110
        assert set(holders) == {f"process {os.getpid()}"}
