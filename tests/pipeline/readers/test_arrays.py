"""Workbooks, MATLAB and numpy files as columns; files of one channel that follow each other."""

import io

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RockpulseError, UnitError
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.source import TableOfResults

VALUES = pulse(400, 3.0)
TIME = 0.01 * np.arange(400)


def numpy_file(path, **arrays):
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    path.write_bytes(buffer.getvalue())
    return path


def test_named_arrays_are_columns_with_their_names(tmp_path):
    north, east = read(numpy_file(tmp_path / "a.npz", time=TIME, acc_N=VALUES, acc_E=2.0 * VALUES, units="m/s2"))
    assert (north.dt, north.azimuth, east.azimuth, north.source_unit) == (0.01, 0.0, 90.0, "m/s2")
    assert np.array_equal(north.acceleration, VALUES)
    assert np.array_equal(east.acceleration, 2.0 * VALUES)
    assert len(north.source_sha256) == 64


def test_an_interval_or_a_rate_beside_an_array_is_that_of_the_samples(tmp_path):
    for facts in ({"dt": 0.02}, {"fs": 50.0}):
        (record,) = read(numpy_file(tmp_path / "a.npz", acc=VALUES, units="g", **facts))
        assert (record.dt, record.npts, record.source_unit) == (0.02, 400, "g")


def test_an_array_without_a_unit_asks_for_it(tmp_path):
    np.save(tmp_path / "a.npy", VALUES)
    with pytest.raises(UnitError, match="do not state their unit"):
        read(tmp_path / "a.npy", dt=0.01)
    assert np.array_equal(read(tmp_path / "a.npy", units="m/s2", dt=0.01)[0].acceleration, VALUES)
    np.save(tmp_path / "a.npy", np.column_stack([TIME, VALUES, VALUES]))
    assert [record.dt for record in read(tmp_path / "a.npy", units="g")] == [0.01, 0.01]


def test_velocities_among_the_arrays_are_left_out(tmp_path):
    velocity = np.cumsum(VALUES) * 0.01
    (record,) = read(numpy_file(tmp_path / "a.npz", t=TIME, acc=VALUES, vel=velocity, units="m/s2"))
    assert record.channel == "acc"


def test_arrays_of_objects_are_refused(tmp_path):
    np.save(tmp_path / "a.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(RockpulseError, match="cannot be read as arrays of numpy"):
        read(tmp_path / "a.npy", units="g")


def test_variables_and_structures_of_matlab_are_columns(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "a.mat", {"acc": VALUES, "dt": 0.01, "units": "m/s2"})
    savemat(tmp_path / "b.mat", {"eq": {"time": TIME, "acc_EW": VALUES, "units": "m/s2"}})
    assert read(tmp_path / "a.mat")[0].dt == 0.01
    assert read(tmp_path / "b.mat")[0].azimuth == 90.0
    (tmp_path / "a.mat").write_bytes(b"MATLAB 5.0 MAT-file" + b"\0" * 200)
    with pytest.raises(RockpulseError, match="MATLAB"):
        read(tmp_path / "a.mat")


def sheet(path, **sheets):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    with pandas.ExcelWriter(path) as writer:
        for name, columns in sheets.items():
            pandas.DataFrame(columns).to_excel(writer, sheet_name=name, index=False)
    return path


@pytest.mark.sweep
def test_the_sheet_of_a_workbook_that_holds_samples_is_read(tmp_path):
    info = {"station": ["A", "B", "C"], "note": ["x", "y", "z"]}
    path = sheet(tmp_path / "a.xlsx", info=info, data={"time [s]": TIME, "acc N [g]": VALUES, "acc Z [g]": VALUES})
    north, up = read(path)
    assert (north.azimuth, up.orientation, north.source_unit) == (0.0, "vertical", "g")
    assert [record.id for record in read_all(tmp_path)[0]] == ["a.acc_N", "a.acc_Z"]


@pytest.mark.sweep
def test_a_workbook_beside_the_records_is_skipped(tmp_path):
    path = sheet(tmp_path / "list.xlsx", list={"station": ["A", "B"], "PGA": [0.1, 0.2]})
    with pytest.raises(TableOfResults):
        read(path)
    assert [row.kind for row in read_all(tmp_path)[1]] == ["skipped"]


def at(second: int) -> str:
    start = f"INITIAL TIME = 2024 01 01 16 10 {second:02d}"
    return f"SITE CODE= E0001 Town\n SAMPLING RATE= 100Hz\n UNIT  = gal\n{start}\n NS\n"


@pytest.mark.parametrize(
    ("begins", "counts"), [((0, 4), [800]), ((0, 5), [400, 400]), ((0, 3), [400, 400]), ((0, 8, 12), [400, 800])]
)
def test_files_of_a_channel_are_joined_where_one_begins_as_the_other_ends(tmp_path, begins, counts):
    for number, begin in enumerate(begins):
        rows = "".join(f"{100.0 * value:.3f}\n" for value in (1.0 + number) * VALUES)
        (tmp_path / f"{9 - number}.csv").write_text(at(begin) + rows, encoding="ascii")
    records, failures = read_all(tmp_path)
    assert failures == []
    assert sorted(record.npts for record in records) == counts
    if counts == [800]:
        assert records[0].acceleration[400:] == pytest.approx(2.0 * records[0].acceleration[:400], abs=2e-5)
        assert records[0].processing == ("2 files of one channel joined: each begins where the previous one ends",)
