"""The kind of motion and the direction that names of files, titles and prose state."""

from pathlib import Path

import numpy as np
import pytest
from record_writers import pulse

from rockpulse.errors import RecordFormatError
from rockpulse.readers import read
from rockpulse.readers.folders import read_all
from rockpulse.readers.kit.direction import heading_direction, name_direction
from rockpulse.readers.kit.motion_kinds import kind_of_name, kinds_of
from rockpulse.readers.source import OtherKind, SourceFile

STEP = 0.005


def rows(values, dt=STEP) -> str:
    return "".join(f"{dt * index:.5f} {value:.6f}\n" for index, value in enumerate(values))


def named(name: str, *beside: str) -> SourceFile:
    return SourceFile(f"/data/{name}", b"1", lambda: b"1", beside=lambda other: b"1" if other in beside else None)


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        *(("a_E.acc", "acceleration"), ("a.accel", "acceleration"), ("accelerogram_accEW.txt", "acceleration")),
        *(("a_E.vel", "velocity"), ("a_velocity.txt", "velocity"), ("velNS.txt", "velocity"), ("a.VT2", "velocity")),
        *(("a-Velocidad.csv", "velocity"), ("hiz_1.txt", "velocity"), ("velocita-3.txt", "velocity")),
        *(("a.dis", "displacement"), ("a_E.disp", "displacement"), ("DISPL_2.txt", "displacement")),
        *(("a.DT2", "displacement"), ("spostamento.csv", "displacement"), ("rawDisp.txt", "displacement")),
        *(("psa_5.txt", "spectrum"), ("response_spectrum.csv", "spectrum"), ("spectrum_matched_1.txt", "")),
        *(("Vel_Dam.acc", "acceleration"), ("acc_vel_disp.txt", ""), ("station.txt", ""), ("level3.txt", "")),
        *(("VEL/a.txt", "velocity"), ("Displacements/a.txt", "displacement"), ("velocity_pulses/a.txt", "")),
        *(("速度_1.csv", "velocity"), ("加速度.csv", "acceleration")),
    ],
)
def test_the_name_of_a_file_says_its_kind(name, kind):
    assert kind_of_name(named(name)) == kind


def test_a_letter_is_a_kind_where_the_two_others_lie_beside():
    assert kind_of_name(named("r_v.txt", "r_a.txt", "r_d.txt")) == "velocity"
    assert kind_of_name(named("rec.d", "rec.a", "rec.v")) == "displacement"
    assert kind_of_name(named("r_v.txt", "r_a.txt")) == ""


def test_an_ordinate_is_a_spectrum_where_accelerations_of_the_name_lie_beside():
    assert kind_of_name(named("Sa_N.txt", "acc_N.txt")) == "spectrum"
    assert kind_of_name(named("SA_N.txt")) == ""


@pytest.mark.parametrize("heading", ["Скорость (м/с)", "velocità", "brzina", "Ταχύτητα", "速度"])
def test_headings_of_other_languages_name_velocities(heading):
    assert kinds_of(heading)[0] == "velocity"


def test_a_folder_of_three_kinds_gives_its_accelerations_only(tmp_path):
    motion = pulse(400, 3.0)
    velocity = np.cumsum(motion) * STEP
    kinds = {"acc": motion, "vel": velocity, "disp": np.cumsum(velocity) * STEP}
    for suffix, values in kinds.items():
        for side in "ENZ":
            (tmp_path / f"m_{side}.{suffix}").write_text(rows(values), encoding="ascii")
    records, failures = read_all(sorted(tmp_path.iterdir()), units="m/s2")
    assert [(Path(one.source).suffix, one.orientation) for one in records] == [
        (".acc", "horizontal"),
        (".acc", "horizontal"),
        (".acc", "vertical"),
    ]
    assert len({one.id for one in records}) == 3
    skipped = {
        (Path(row.file).suffix, row.kind, "velocity" in row.reason) for row in failures if row.kind != "duplicate"
    }
    assert skipped == {(".vel", "skipped", True), (".disp", "skipped", False)}


@pytest.mark.parametrize("heading", ["", "acc (m/s2)\n"])
def test_the_integrals_of_a_file_are_skipped_whatever_their_heading(tmp_path, heading):
    rng = np.random.default_rng(3)
    motion = np.convolve(rng.normal(size=2000), np.hanning(21), "same")
    velocity = np.cumsum(motion) * STEP
    for name, values in zip(("x1", "x2", "x3"), (np.cumsum(velocity) * STEP, velocity, motion), strict=True):
        (tmp_path / f"{name}.txt").write_text(heading + "".join(f"{value:.9e}\n" for value in values), encoding="ascii")
    other = np.convolve(rng.normal(size=2000), np.hanning(21), "same")
    (tmp_path / "x4.txt").write_text(heading + "".join(f"{value:.9e}\n" for value in other), encoding="ascii")
    records, failures = read_all(tmp_path, units="m/s2", dt=STEP)
    assert len(repr(records[0])) < 100
    assert [Path(one.source).stem for one in records] == ["x3", "x4"]
    assert [(Path(row.file).stem, row.kind) for row in failures] == [("x1", "skipped"), ("x2", "skipped")]
    assert "its derivative is the series of x3.txt" in failures[1].reason


def test_a_name_and_a_header_of_two_kinds_are_told(tmp_path):
    path = tmp_path / "m.vel"
    path.write_text(rows(pulse()), encoding="ascii")
    with pytest.raises(OtherKind, match="velocity, as the file name says"):
        read(path, units="g")
    path.write_text("t [s],acc [g]\n" + rows(pulse()).replace(" ", ","), encoding="ascii")
    assert any("says velocity" in note for note in read(path)[0].warnings)
    path.write_text("Acceleration record of a station\n" + rows(pulse()), encoding="ascii")
    with pytest.raises(RecordFormatError, match="found acceleration in the header and velocity in the file name"):
        read(path, units="g")


@pytest.mark.parametrize(
    ("name", "orientation", "azimuth"),
    [
        *(("a_E.acc", "horizontal", 90.0), ("a-N.txt", "horizontal", 0.0), ("EW.txt", "horizontal", 90.0)),
        *(("a.NS", "horizontal", 0.0), ("a.00N", "horizontal", 0.0), ("a.00E", "horizontal", 90.0)),
        *(("a.00U", "vertical", np.nan), ("a_Z.txt", "vertical", np.nan), ("a_UP.txt", "vertical", np.nan)),
        *(("PIC090.txt", "horizontal", 90.0), ("PICDWN.txt", "vertical", np.nan), ("a.HNZ.dat", "vertical", np.nan)),
        *(("a_vert.csv", "vertical", np.nan), ("a_N-S.txt", "horizontal", 0.0), ("accEW.txt", "horizontal", 90.0)),
        *(("KUZEY.txt", "horizontal", 0.0), ("a_EW1.txt", "horizontal", 90.0), ("a_E_raw.txt", "horizontal", 90.0)),
        *(("TCU068.txt", "unknown", np.nan), ("TCU068-V.txt", "vertical", np.nan), ("SETUP.txt", "unknown", np.nan)),
        *(("rec.V", "vertical", np.nan), ("rec.L", "horizontal", np.nan), ("rec_T.txt", "horizontal", np.nan)),
        *(("120111.txt", "unknown", np.nan), ("San_E_Street.txt", "unknown", np.nan)),
    ],
)
def test_the_name_of_a_file_says_its_direction(name, orientation, azimuth):
    facing = name_direction(named(name))
    assert facing.orientation == orientation
    assert facing.azimuth == azimuth or np.isnan(azimuth)


def test_three_digits_are_an_azimuth_beside_a_file_a_right_angle_apart():
    assert name_direction(named("GIL067.txt", "GIL337.txt")).azimuth == 67.0
    assert name_direction(named("GIL067.txt")).orientation == "unknown"


@pytest.mark.parametrize(
    ("azimuth", "headings"),
    [(0.0, ["acc N-S [g]", "Norte (gal)", "acc (N) [g]"]), (90.0, ["E/W", "H1_90", "W-E", "accEW"])],
)
def test_words_of_a_heading_are_one_direction(azimuth, headings):
    assert {heading_direction(heading).azimuth for heading in headings} == {azimuth}


@pytest.mark.parametrize("heading", ["az (m/s2)", "acc (V) [g]", "AccUD", "gFz", "accel_z", "acc Up [g]"])
def test_a_vertical_heading_is_one_however_it_is_glued(heading):
    assert heading_direction(heading).orientation == "vertical"


TITLES = [
    ("EQ 01/01/99 2146, STA031, V, (CWB)      ", "vertical", np.nan),
    ("EQ 01/01/99 2146, STA031, DWN (USGS STATI", "vertical", np.nan),
    ("EQ 01/01/99, A STATION,  UP (USGS STATION 99)", "vertical", np.nan),
    ("EQ 01/01/99, A STATION, VERT", "vertical", np.nan),
    ("EQ 01/01/99, A STATION, 067 (CUE)", "horizontal", 67.0),
    ("EQ 01/01/99, A STATION, N, (CWB)", "horizontal", 0.0),
]


def at2(title: str, *above: str, below: str = "") -> bytes:
    lines = [*(above or ("A RECORD",)), title, "ACCELERATION TIME SERIES IN UNITS OF G", "NPTS=  400, DT= .0100 SEC"]
    return "\n".join([*lines, *(f"{value:15.7E}" for value in pulse()), below]).encode()


@pytest.mark.parametrize(("title", "orientation", "azimuth"), TITLES)
def test_the_component_of_an_at2_title_stands_before_what_is_in_brackets(tmp_path, title, orientation, azimuth):
    (tmp_path / "a.AT2").write_bytes(at2(title))
    (record,) = read(tmp_path / "a.AT2")
    assert record.orientation == orientation
    assert record.azimuth == azimuth or np.isnan(azimuth)
    assert record.station_name in ("STA031", "A STATION")


def test_the_direction_of_a_rotated_record_is_its_own(tmp_path):
    title = "  H1 for rotation: AN EQ 01/01/87, A STATION, 090 (USGS STATION 99)"
    content = at2(title, "Orig PEER filename = X/A_FN.acc, Scale factor = 2").replace(
        b"ACCELERATION TIME", b"  FN component, azimuth =   310.0\nACCELERATION TIME"
    )
    (tmp_path / "a.AT2").write_bytes(content)
    (record,) = read(tmp_path / "a.AT2")
    assert (record.azimuth, record.component, record.station_name) == (310.0, "FN 310", "A STATION")
    assert any("scale factor of 2" in note for note in record.warnings)


def test_a_vertical_name_is_not_assessed_as_the_horizontal_title_says(tmp_path):
    (tmp_path / "PIC-UP.AT2").write_bytes(at2("EQ 01/01/99, A STATION, E"))
    (record,) = read(tmp_path / "PIC-UP.AT2")
    assert record.orientation == "vertical"
    assert any("disagree on whether the channel is vertical" in note for note in record.warnings)
    (tmp_path / "PIC-UP.AT2").write_bytes(at2("no title at all"))
    assert read(tmp_path / "PIC-UP.AT2")[0].orientation == "vertical"


@pytest.mark.parametrize(
    "prose",
    [
        "components: E N Z\n",
        "Column 1: E-W component\nColumn 2: N/S component\nColumn 3: U/D component\n",
        "Channels = EW, NS, UD\n",
    ],
)
def test_prose_names_the_columns(tmp_path, prose):
    table = "".join(f"{value:.5f} {2 * value:.5f} {3 * value:.5f}\n" for value in pulse())
    (tmp_path / "a.txt").write_text(f"units: cm/s^2\nsampling rate: 100 Hz\n{prose}\n{table}", encoding="ascii")
    records = read(tmp_path / "a.txt")
    assert [(one.orientation, one.azimuth) for one in records[:2]] == [("horizontal", 90.0), ("horizontal", 0.0)]
    assert [records[2].orientation, records[0].dt, records[0].source_unit] == ["vertical", 0.01, "cm/s2"]


@pytest.mark.parametrize(
    ("prose", "orientation"),
    [
        ("Component: U-D", "vertical"),
        ("Direction = N-S", "horizontal"),
        ("Vertical component of a station", "vertical"),
    ],
)
def test_prose_states_the_direction_of_one_column(tmp_path, prose, orientation):
    table = "".join(f"{value:.5f}\n" for value in pulse())
    (tmp_path / "a.txt").write_text(f"units: gal\ndt = 0.01 s\n{prose}\n{table}", encoding="ascii")
    assert read(tmp_path / "a.txt")[0].orientation == orientation


def test_a_file_name_and_prose_that_differ_leave_the_direction_unknown_or_vertical(tmp_path):
    table = "".join(f"{value:.5f}\n" for value in pulse())
    for name, orientation in (("a_E.txt", "horizontal"), ("a_Z.txt", "vertical")):
        (tmp_path / name).write_text(f"units: gal\ndt = 0.01 s\ncomponent: N\n{table}", encoding="ascii")
        (record,) = read(tmp_path / name)
        assert record.orientation == orientation
        assert np.isnan(record.azimuth)
        assert any("another statement says" in note for note in record.warnings)


def test_two_columns_of_one_axis_and_copies_are_told(tmp_path):
    values = pulse()
    cells = (f"{0.01 * at:.2f},{one},{0.5 * one},{-one}\n" for at, one in enumerate(values))
    (tmp_path / "a.csv").write_text("t [s],N [g],S [g],E [g]\n" + "".join(cells), encoding="ascii")
    north, south, east = read(tmp_path / "a.csv")
    assert any("the same direction" in note for note in south.warnings)
    assert any("opposite sign" in note for note in north.warnings)
    assert any("opposite sign" in note for note in east.warnings)


@pytest.mark.parametrize("heading", ["Absolute acceleration (m/s^2)", "aT (m/s^2)", "|a| (m/s2)", "Toplam ivme (m/s2)"])
def test_the_size_of_a_vector_is_no_component(tmp_path, heading):
    rng = np.random.default_rng(1)
    parts = rng.normal(size=(300, 3))
    size = np.linalg.norm(parts, axis=1)
    text = "".join(
        f"{0.01 * at:.2f},{x:.5f},{y:.5f},{z:.5f},{r:.5f}\n"
        for at, ((x, y, z), r) in enumerate(zip(parts, size, strict=True))
    )
    (tmp_path / "a.csv").write_text(f"t (s),ax (m/s2),ay (m/s2),az (m/s2),{heading}\n{text}", encoding="utf-8")
    records = read(tmp_path / "a.csv")
    assert [one.channel for one in records] == ["ax", "ay", "az"]
    assert all("left out" in one.warnings[0] for one in records)


def test_an_absolute_acceleration_with_a_sign_is_a_motion(tmp_path):
    text = "".join(f"{0.01 * at:.2f},{value:.5f}\n" for at, value in enumerate(pulse()))
    (tmp_path / "a.csv").write_text(f"t (s),Absolute acceleration (g)\n{text}", encoding="ascii")
    assert len(read(tmp_path / "a.csv")) == 1


def test_of_two_sines_none_is_the_integral_of_the_other(tmp_path):
    phase = 2.0 * np.pi * 1.5 * STEP * np.arange(2000)
    for name, values in (("x1", np.sin(phase)), ("x2", np.cos(phase))):
        (tmp_path / f"{name}.txt").write_text(rows(values), encoding="ascii")
    assert len(read_all(tmp_path, units="m/s2")[0]) == 2


@pytest.mark.parametrize(
    "heading", ["relative acceleration N", "PGA-normalised acc N", "acc N (normalized)", "accelerazione relativa N"]
)
def test_an_acceleration_that_is_not_of_the_ground_is_left_out(tmp_path, heading):
    path = tmp_path / "a.csv"
    rows = "".join(f"{0.01 * i:.2f},{value:.4f},{-value:.4f}\n" for i, value in enumerate(pulse(200)))
    path.write_text(f"time [s],{heading} [m/s2],acc E [m/s2]\n{rows}", encoding="utf-8")
    (record,) = read(path)
    assert record.component == "E" or record.azimuth == 90.0
    assert any("columns left out because they are no accelerations" in text for text in record.warnings)
