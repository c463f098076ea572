"""Records without their samples are those of read_all, and their samples are found again, or nothing is."""

import os
import pickle
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from batch_runs import surveyed
from record_writers import at2, pulse
from record_writers.renadic import renadic

from rockpulse.errors import RecordRefused
from rockpulse.readers import ReadOptions
from rockpulse.readers.folders import find_files, read_all
from rockpulse.readers.source import Archive
from rockpulse.record.record import Record
from rockpulse.run import survey
from rockpulse.run.survey import survey_file

OPTIONS = ReadOptions()


def known(record: Record) -> dict[str, object]:
    """Everything but the samples and what is kept in their place; NaN is equal to itself."""
    return {item.name: repr(getattr(record, item.name)) for item in fields(Record)[1:] if item.name != "outline"}


def assert_same(paths, options=OPTIONS):
    """What was surveyed is what read_all reads, now and when the samples are read again."""
    records, failures = read_all(paths, options.units, dt=options.dt)
    located, rows = surveyed(paths, options)
    assert rows == failures
    assert [known(one.record) for one in located] == [known(record) for record in records]
    for one, record in zip(located, records, strict=True):
        again = one.read(options)
        assert (one.record.npts, type(again)) == (record.npts, type(record))
        assert not one.record.acceleration.any()
        assert np.array_equal(again.acceleration, record.acceleration)
        assert known(again) == known(record)
    return located


@pytest.fixture
def folder(tmp_path):
    """Files, an archive, duplicates, one id twice, a record in two parts, damage, and what is no record."""
    one, two, three = (at2(pulse(peak=peak)) for peak in (0.3, 0.2, 0.1))
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.AT2").write_bytes(one)
    (tmp_path / "copy.AT2").write_bytes(one)
    (tmp_path / "sub" / "a.AT2").write_bytes(two)
    (tmp_path / "cut.AT2").write_bytes(one[:2000])
    (tmp_path / "notes.txt").write_text("nothing to read here\n")
    (tmp_path / "gone.AT2").symlink_to(tmp_path / "nowhere")
    values = [np.round(pulse(400, peak), 3) for peak in (1.5, 0.8, 1.2)]
    for number, (begin, last) in enumerate([(0, 250), (250, 400)], start=1):
        columns = [*(channel[begin:last] for channel in values), np.zeros(last - begin)]
        content = renadic(columns, components=("NS", "V", "EW", "INTC"), first=0.01 * begin)
        (tmp_path / f"curicoparte{number}.v1").write_bytes(content)
    with zipfile.ZipFile(tmp_path / "more.zip", "w") as archive:
        archive.writestr("b/x.AT2", three)
        archive.writestr("a/x.AT2", two)
        archive.writestr("damaged.AT2", three[:1500])
        archive.writestr("readme.txt", "nothing")
        archive.writestr("notes.md", "nothing")
    return tmp_path


def test_a_mixed_folder_is_surveyed_as_it_is_read(folder):
    located = assert_same([folder, folder / "notes.txt", folder / "nothing.AT2"])
    parts = {one.record.id: len(one.parts) for one in located}
    assert parts == {"a.090": 1, "curico.EW": 2, "curico.NS": 2, "curico.V": 2, "x.090": 1, "x.090~2": 1}
    assert len({one.digest for one in located}) == len(located)


@pytest.mark.sweep
def test_every_format_is_surveyed_as_it_is_read(samples):
    assert len(assert_same(samples.parent / "formats", ReadOptions(units="g"))) > 30


@pytest.mark.sweep
def test_a_located_record_is_small_however_many_samples_it_has(tmp_path):
    sizes = []
    for count in (400, 40_000):
        path = tmp_path / f"{count}.AT2"
        path.write_bytes(at2(pulse(count)))
        (one,), _ = surveyed(path, OPTIONS)
        assert one.record.npts == count
        assert one.record.with_warning("x").acceleration.strides == (0,)
        sizes.append(len(pickle.dumps(one)))
    assert max(sizes) < 2000
    assert abs(sizes[1] - sizes[0]) < 20


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.replace(b"0.0", b"0.1"),
        lambda content: content.replace(b"Somewhere", b"Elsewhere"),
        lambda content: content.replace(b"DT= 0.0100", b"DT= 0.0200"),
    ],
    ids=["samples", "header", "interval"],
)
def test_a_file_that_has_changed_gives_no_samples(tmp_path, change):
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse()))
    (one,), _ = surveyed(path, OPTIONS)
    assert one.read(OPTIONS).npts == 400
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(RecordRefused, match=r"^[^:]*a.AT2 has changed since .* --resume"):
        one.read(OPTIONS)


def test_the_same_file_with_another_time_stamp_is_read(tmp_path):
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse()))
    (one,), _ = surveyed(path, OPTIONS)
    os.utime(path, (1.0, 1.0))
    assert one.read(OPTIONS).npts == 400


def test_a_file_with_fewer_channels_than_before_gives_no_samples(samples, tmp_path):
    path = tmp_path / "CICCC.RAW"
    path.write_bytes((samples / path.name).read_bytes())
    last = surveyed(path, OPTIONS)[0][-1]
    one = replace(last, parts=(replace(last.parts[0], channel=3),))
    with pytest.raises(RecordRefused, match="has changed"):
        one.read(OPTIONS)


def test_an_archive_that_lost_a_member_gives_no_samples(tmp_path):
    path = tmp_path / "x.zip"
    for count in (2, 1):
        with zipfile.ZipFile(path, "w") as archive:
            for number in range(count):
                archive.writestr(f"{number}.AT2", at2(pulse(peak=0.1 * (number + 1))))
        if count == 2:
            located, _ = surveyed(path, OPTIONS)
    assert located[0].read(OPTIONS).npts == 400
    with pytest.raises(RecordRefused, match="fewer files than at the beginning"):
        located[1].read(OPTIONS)


def test_the_members_of_an_archive_are_unpacked_once_each_and_the_archive_opened_once(tmp_path, monkeypatch):
    path = tmp_path / "x.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(12):
            archive.writestr(f"{number:02d}.AT2", at2(pulse(peak=0.1 + 0.01 * number)))
    located, _ = surveyed(path, OPTIONS)
    calls = {"open": 0, "member": 0}

    class Counted(Archive):
        def __init__(self, path):
            calls["open"] += 1
            super().__init__(path)

        def member(self, number):
            calls["member"] += 1
            return super().member(number)

    monkeypatch.setattr(survey, "Archive", Counted)
    survey._archive.cache_clear()
    assert [one.read(OPTIONS).npts for one in located] == [400] * 12
    assert calls == {"open": 1, "member": 12}


def test_a_fault_of_the_program_costs_one_member(tmp_path, monkeypatch):
    path = tmp_path / "x.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(3):
            archive.writestr(f"{number}.AT2", at2(pulse(peak=0.1 * (number + 1))))
    read = survey.read_opened

    def faulty(opened, options):
        if "!1.AT2" in opened.name:
            raise KeyError("x")
        return read(opened, options)

    monkeypatch.setattr(survey, "read_opened", faulty)
    (found,), _ = find_files(path)
    result = survey_file(found, OPTIONS)
    assert len(result.located) == 2
    (row,) = result.failures
    assert row.file == f"{path}!1.AT2"
    assert row.kind == "failed"
    assert "unexpected KeyError: 'x'; please report" in row.reason
    ((_, _, text),) = result.messages
    assert "Traceback" in text


def test_a_fault_of_the_program_on_opening_costs_one_file(tmp_path, monkeypatch):
    path = tmp_path / "a.AT2"
    path.write_bytes(at2(pulse()))

    def faulty(found, station_files):
        raise RuntimeError("broken")
        yield

    monkeypatch.setattr(survey, "open_files", faulty)
    (found,), _ = find_files(path)
    result = survey_file(found, OPTIONS)
    assert [row.reason for row in result.failures] == [
        f"{path}: unexpected RuntimeError: broken; please report it with this file"
    ]
