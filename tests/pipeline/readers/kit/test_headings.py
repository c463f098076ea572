"""Words in the prose above plain columns: the motions, units, intervals and counts that they state."""

import contextlib
import math
import re
import time

import numpy as np
import pytest
from record_writers import pulse
from record_writers.columns import columns

from rockpulse.errors import RecordFormatError, RockpulseError, UnitError
from rockpulse.readers import read
from rockpulse.readers.format import ReadOptions
from rockpulse.readers.formats.columns import is_columns, read_columns
from rockpulse.readers.kit.headings import column_headings
from rockpulse.readers.kit.motion_kinds import kinds_of
from rockpulse.readers.kit.number_table import Layout
from rockpulse.readers.kit.prose import stated_counts, stated_kinds, stated_steps, stated_units
from rockpulse.readers.source import NotAcceleration, SourceFile


@pytest.mark.parametrize(
    ("line", "kinds", "units", "steps", "counts"),
    [
        ("# velocity (cm/s)", ["velocity"], [], [], []),
        ("accelerogram of the main shock, spectrally matched", [], [], [], []),
        ("shear wave velocity 360 m/s", [], [], [], []),
        ("Acceleration in g, dt = 0.02, N = 400", ["acceleration"], ["g"], [0.02], [400]),
        ("Beschleunigung in mm/s², 100 Hz", ["acceleration"], ["mm/s2"], [0.01], []),
        *[(f"dt = 5 {unit}", [], [], [0.005], []) for unit in ("ms", "msec", "millisec", "milliseconds")],
        ("dt = 500 us", [], [], [5e-4], []),
        *[(f"dt = 2 {unit}", [], [], [120.0], []) for unit in ("min", "minutes")],
        ("500 Hz filter, 2000 samples per second", [], [], [], []),
        ("with 2 numbers", [], [], [], []),
        ("response spectrum", ["spectrum"], [], [], []),
        ("target spectrum", [], [], [], []),
        ("time of the velocity", ["velocity"], [], [], []),
        ("dt (ms) = 3/4", [], [], [7.5e-4], []),
        ("dt = 2.5e-2 s", [], [], [0.025], []),
        ("dt = 0,25e+1", [], [], [2.5], []),
        ("sampling rate: 0", [], [], [math.inf], []),
        ("sampling rate 250, dt = 0.02, 500 hz", [], [], [0.02, 0.004], []),
        ("300 points and 40 values", [], [], [], [300, 40]),
    ],
)
def test_words_of_a_header(line, kinds, units, steps, counts):
    assert list(stated_kinds([line])) == kinds
    assert sorted({unit.wording for unit in stated_units([line])}) == units
    assert [step.value for step in stated_steps([line])] == pytest.approx(steps)
    assert [count.value for count in stated_counts([line])] == counts


def test_statements_tell_their_lines_and_words():
    header = ["Station", "Acceleration", "Velocity [cm/s]", "acceleration [Gal]", "sampling rate = 50", "NPTS = 7"]
    assert stated_kinds(header) == {"acceleration": 2, "velocity": 3}
    assert {(one.line, one.wording, one.value) for one in stated_units(header)} == {(4, "Gal", 0.0)}
    assert [(one.line, one.wording, one.value) for one in stated_steps(header)] == [(5, "sampling rate = 50", 0.02)]
    assert [(one.line, one.wording, one.value) for one in stated_counts(header)] == [(6, "npts = 7", 7.0)]
    (bare,) = stated_steps(["x", "recorded with 40 hz"])
    assert (bare.line, bare.wording, bare.value) == (2, "40 hz", 0.025)
    (named,) = stated_steps(["resampled to dt = 0.5", "dt = 0.25"])
    assert (named.line, named.wording, named.value) == (2, "dt = 0.25", 0.25)


@pytest.mark.parametrize(
    ("line", "quantities"),
    [
        *[
            (line, ["acceleration"])
            for line in ("in g", "units: (g)", "unit = g(980)", "# g", "[g]", "values of 3 as gal")
        ],
        *[(line, ["velocity"]) for line in ("in kine", "cm/s", "[m/s]")],
        *[(line, ["displacement"]) for line in ("# cm", "units: cm")],
        *[(line, []) for line in ("in cm", "[cm]", "units: s", "# ms", "peak [g]", "converted, in g")],
        *[(line, []) for line in ("trigger=3 gal", "trigger 3(gal", "٣gal")],
    ],
)
def test_units_of_prose(line, quantities):
    assert list(stated_kinds([line])) == quantities
    assert bool(stated_units([line])) == ("acceleration" in quantities)


def test_kinds_of_motion_come_before_acceleration_and_time():
    assert kinds_of("Time, Acc, PSA, Disp, VEL") == ["velocity", "displacement", "spectrum", "acceleration", "time"]
    assert kinds_of("Acceleration, target spectrum") == ["acceleration"]
    assert kinds_of("Ivme, Hız") == ["velocity", "acceleration"]


@pytest.mark.parametrize(("length", "counts"), [(1000, [12.0]), (1001, [])])
def test_a_line_is_looked_at_up_to_its_thousandth_letter(length, counts):
    words = " 12 points"
    assert [one.value for one in stated_counts(["x" * (length - len(words)) + words])] == counts


COUNT, STEP = 1000, 0.005
TIMES = np.arange(COUNT) * STEP
VALUES = np.round(pulse(COUNT, peak=3.0) + 0.01 * np.sin(300.0 * TIMES), 6)
VELOCITY = np.cumsum(VALUES) * STEP
PAIR = np.column_stack([TIMES, VALUES])


def series(header: str, *more: np.ndarray, separator: str = " ") -> bytes:
    """Time, acceleration and more columns below a header."""
    return columns(np.column_stack([TIMES, VALUES, *more]), header, separator)


@pytest.mark.parametrize(
    ("header", "separator"),
    [
        ("Time [sec]\tAcceleration [cm/sec2]\tVelocity [cm/sec]\tDisplacement [cm]\n", "\t"),
        ("Time [sec] Acceleration [cm/sec2] Velocity [cm/sec] Displacement [cm]\n", " "),
        ("# Time (s)   Acc. NS (cm/s2)   Velocity NS (cm/s)   Displ. NS (cm)\n", " "),
        ("t a v d\n", "\t"),
        *(
            (f"{words}\n", ",")
            for words in ("Tiempo (s), Aceleración, Velocidad, Desplazamiento", "Zaman,İvme,Hız,Deplasman")
        ),
        *(
            (f"Tempo;{words}\n", ";")
            for words in ("Accelerazione;Velocità;Spostamento", "Aceleração;Velocidade;Deslocamento")
        ),
        ("Zeit;Beschleunigung;Geschwindigkeit;Verschiebung\n", ";"),
        ("Temps\tAccélération\tVitesse\tDéplacement\n", "\t"),
        ("Time,Acc,Vel,Disp\ns,cm/s2,cm/s,cm\n", ","),
        ("Time,x,y,z\n(s),(cm/s2),(cm/s),(cm)\n", ","),
    ],
)
def test_velocity_and_displacement_are_known_by_their_headings(write, header, separator):
    (record,) = read(write(series(header, VELOCITY, np.cumsum(VELOCITY), separator=separator)), units="cm/s2")
    assert record.acceleration == pytest.approx(VALUES / 100.0, abs=1e-12)
    assert "columns left out because they are no accelerations: " in record.warnings[0]


@pytest.mark.parametrize("units", ["g", None])
@pytest.mark.parametrize(
    "header",
    [
        "Time [sec]\tAcceleration [cm/sec2]\n",
        "Time (s) Acc NS (cm/s2)\n",
        "Time,Acc\ns,cm/s2\n",
        "time\tacc_cm_s2\n",
        "time,acceleration in gal\n",
        "time,Acceleration cm/s^2\n",
        "time,Acceleration cm s-2\n",
    ],
)
def test_the_unit_of_a_heading_is_believed_and_held_against_the_caller(write, header, units):
    path = write(series(header, separator="\t" if "\t" in header else ","))
    if units is None:
        assert read(path)[0].acceleration == pytest.approx(VALUES / 100.0, abs=1e-12)
        return
    with pytest.raises(UnitError, match=r"column '.*' states (cm/s2|gal), but the option units says g"):
        read(path, units=units)


@pytest.mark.parametrize(
    "header",
    [
        "# units: cm/s2\n# t a\n",
        "UNIT  = gal(cm/s/s)\n",
        "Accelerations in cm/s²\n",
        "# [Gal]\n",
        "# cm/sec**2\n",
        "Unidades: cm/s2\nt,a\n",
    ],
)
def test_the_unit_of_the_prose_has_to_agree_and_answers_only_with_the_word_for_it(write, header):
    path = write(series(header))
    found = r"record.txt:1: the header says '.*', but the option units says g; correct the wrong one"
    with pytest.raises(UnitError, match=found) as caught:
        read(path, units="g")
    (hint,) = re.findall(r"(?s)if the header is right, give --units (\S+), or .*units = \"\1\"", str(caught.value))
    assert read(path, units=hint)[0].source_unit == hint
    if "uni" in header.lower():  # the word "unit" makes it a statement
        assert read(path)[0].source_unit in ("gal", "cm/s2")
    else:
        with pytest.raises(UnitError, match="do not state their unit; line 1 of its header mentions"):
            read(path)
    assert read(path, units="gal")[0].acceleration == pytest.approx(VALUES / 100.0, abs=1e-12)


@pytest.mark.parametrize("header", ["t [s],a [mg]\n", "t,a\ns,%g\n", "units: mg\n", "t,a (furlong/s2)\n"])
def test_a_unit_that_is_not_read_is_refused(write, header):
    with pytest.raises(UnitError, match="unknown unit of acceleration"):
        read(write(series(header, separator=",")), units="g")


@pytest.mark.parametrize(
    ("header", "step"),
    [
        *((words, 0.005) for words in ("# dt = 0.005 s, 200 Hz", "dt= .005 SEC", "DT(ms) = 5", "dt = 1/200 s")),
        *((words, 0.005) for words in ("sampling interval: 5 ms", "Intervalo de muestreo: 0,005", "200 Hz, NS")),
        *((f"{words} 200", 0.005) for words in ("SAMPLING RATE=", "Sampling frequency (Hz):")),
        ("200 samples per second", 0.005),
        *((words, None) for words in ("band-pass 0.1-25 Hz", "M 5 at 25 km")),
    ],
)
def test_the_interval_of_the_header_is_believed_and_held_against_the_caller(write, header, step):
    path = write(columns(VALUES[:, None], f"{header}\n"))
    if step is None:
        assert read(path, units="g", dt=0.01)[0].dt == 0.01
        return
    assert read(path, units="g")[0].dt == pytest.approx(step, rel=1e-12)
    with pytest.raises(RecordFormatError, match=r"intervals disagree: 0.005 s \(line 1: .*, 0.01 s \(option dt\)"):
        read(path, units="g", dt=0.01)


@pytest.mark.parametrize(
    "header",
    [
        *("# Accelerograph station ABC\n# velocity (cm/s)\n", "time,velocidad_NS\n", "Zeit,Geschwindigkeit\n"),
        *("time,hız\n", "time,v\n", "Period(s),PSA(g)\n", "period [s],SA [g]\n", "T,Sa\n", "T [s],Sd [cm]\n"),
        *("# response spectrum 5% damping\nT [s],SA [g]\n", "Freq (Hz),acc NS (cm/s2)\n", "Frequency (Hz),FAS\n"),
        *("# PGV 12 cm/s\n# cm/s\n", "# velocity (cm/s)\nt,NS\n", "t [s],NS [cm]\n", "units: cm/s\n"),
    ],
)
def test_what_is_no_acceleration_is_refused(write, header):
    with pytest.raises(NotAcceleration, match=r"record.txt:\d: expected .*acceleration"):
        read(write(series(header, separator=",")), units="cm/s2")


@pytest.mark.parametrize(
    "header",
    ["Acceleration and velocity of the same site\n", "Response spectrum\n", "Velocity from acceleration\nt,NS\n"],
)
def test_a_header_that_names_more_than_one_motion_asks_for_headings(write, header):
    with pytest.raises(RecordFormatError, match=r"record.txt:1: expected a statement of which .* name the columns"):
        read(write(series(header)), units="g")


def test_a_column_that_is_headed_as_time_is_time_wherever_it_stands(write):
    (record,) = read(write(columns(PAIR[:, ::-1], "acc,time\n", ",")), units="m/s2")
    assert (record.dt, record.channel) == (STEP, "acc")
    with pytest.raises(
        RecordFormatError, match="column 2, which increases like times; write the times as the first column"
    ):
        read(write(columns(PAIR[:, ::-1])), units="m/s2", dt=STEP)


@pytest.mark.parametrize(
    "unit",
    [
        *(pytest.param(unit, marks=pytest.mark.sweep) for unit in (b"[g] ", b"(", b"in ", b"1,")),
        *(
            pytest.param(unit, marks=pytest.mark.slow)
            for unit in (b"1", b"a", b" ", b"1 ", b"1.", b"cm/s ", b"dt=", b";", b'"')
        ),
    ],
)
def test_hostile_lines_cost_no_more_than_their_length(unit):
    rows = columns(PAIR)
    long, short = unit * (300_000 // len(unit)) + b"x\n", unit * (900 // len(unit)) + b"x\n"
    for content in (long, long + rows, rows + long + rows, short * 50 + rows, short * 600, rows + short * 600):
        began = time.process_time()
        is_columns(content[:65536], "a.txt")
        with contextlib.suppress(RockpulseError):
            read_columns(SourceFile("a.txt", content[:65536], lambda content=content: content), ReadOptions("g", 0.005))
        assert time.process_time() - began < 2.0


@pytest.mark.parametrize(("words", "count"), [("time 360 90", 2), ("time 361 90", 0)])
def test_numbers_up_to_360_are_headings_that_name_directions(write, words, count):
    table = columns(np.column_stack([TIMES, VALUES, VALUES[::-1]])).decode()
    records = read(write(f"{words}\n{table}".encode()), units="g")
    assert sum(record.orientation == "horizontal" for record in records) == count


def test_a_column_without_a_heading_in_front_of_tabs_keeps_its_place(write):
    table = np.column_stack([np.arange(COUNT), 1e3 * TIMES, VALUES])
    (record,) = read(write(columns(table, "\tTime [ms]\tAcc [m/s2]\n", "\t", field="{:.9g}")), units="m/s2")
    assert record.acceleration == pytest.approx(VALUES)
    assert record.dt == pytest.approx(STEP)
    (record,) = read(write(columns(PAIR, "# Time [s], Acc [m/s2] #\n", ",")), units="m/s2")
    assert record.acceleration == pytest.approx(VALUES)


@pytest.mark.parametrize(
    ("header", "delimiter", "width", "found", "above"),
    [
        # letters that are motions, and letters that are directions
        (["t a v d"], None, 4, ["t|T|", "a|A|", "v|V|", "d|D|"], 0),
        (["prose of a kind", "t v u"], None, 3, ["t|T|", "v|V|", "u|D|"], 1),
        (["t,x,d"], ",", 3, ["t|T|", "x||", "d||"], 0),
        (["t,a,n,v"], ",", 4, ["t|T|", "a||", "n||", "v||"], 0),
        (["e,v"], ",", 2, ["e||", "v||"], 0),
        (["time,acc,V"], ",", 3, ["time|T|", "acc|A|", "V|V|"], 0),
        (["v"], None, 1, ["v||"], 0),
        # units in a row of their own, in brackets, in words
        (["x", "t,a", "[s],(g)"], ",", 2, ["t|T|s", "a|A|g"], 1),
        (["What is known of it", "s, g"], ",", 2, ["|T|s", "|A|g"], 1),
        (["t\ta", "s\tg"], None, 2, ["t|T|s", "a|A|g"], 0),
        (["t,vel of acc"], ",", 2, ["t|T|", "vel of acc|V|"], 0),
        (["x, acc"], None, 1, ["x, acc|A|"], 0),
        (["t,a", "s,s"], ",", 2, ["s||", "s||"], 1),
        (["t,a", "s,g,g"], ",", 2, [], 2),
        (
            ["t [ms],a (x1) [g],v (furlong) (x1) (y2)"],
            ",",
            3,
            ["t [ms]|T|ms", "a (x1) [g]|A|g", "v (furlong) (x1) (y2)|V|x1"],
            0,
        ),
        (["t,a (main shock),a (12),a (up)"], ",", 4, ["t|T|", "a (main shock)|A|", "a (12)|A|", "a (up)|A|"], 0),
        (
            ["t,a (of main),a (volt),a (raw)"],
            ",",
            4,
            ["t|T|", "a (of main)|A|of main", "a (volt)|A|volt", "a (raw)|A|raw"],
            0,
        ),
        (
            ["t_us,acc_cm_s2,acc g,ch g,x [Hz]"],
            ",",
            5,
            ["t_us|T|us", "acc_cm_s2|A|cm_s2", "acc g|A|g", "ch g||", "x [Hz]|spectrum|Hz"],
            0,
        ),
        # ways to split a line
        (['time,"acc, NS","acc, EW"'], ",", 3, ["time|T|", "acc  NS|A|", "acc  EW|A|"], 0),
        (["Time (s) Acc NS (g)"], None, 2, ["Time (s)|T|s", "Acc NS (g)|A|g"], 0),
        (["t acc (m / s2) vel (cm/s)"], None, 3, ["t|T|", "acc (m / s2)|A|m / s2", "vel (cm/s)|V|cm/s"], 0),
        (["Time of it  Acc of it"], None, 2, ["Time of it|T|", "Acc of it|A|"], 0),
        (["\tTime\tAcc"], "\t", 2, ["Time|T|", "Acc|A|"], 0),
        (["\tTime\tAcc"], "\t", 3, ["||", "Time|T|", "Acc|A|"], 0),
        (["# Time;Acc"], None, 2, ["Time|T|", "Acc|A|"], 0),
        # prose
        (["acc NS (g)"], None, 1, ["acc NS (g)|A|g"], 0),
        (["acc of NS"], None, 1, ["acc of NS|A|"], 0),
        (["acc of main NS"], None, 1, [], 1),
        (["motion [g]"], None, 1, ["motion [g]|A|g"], 0),
        (["motion [cm/s]"], None, 1, [], 1),
        (["acc: NS"], None, 1, [], 1),
        (["dt=0.01"], None, 1, [], 1),
        (["NPTS=5,acc"], ",", 2, ["NPTS=5||", "acc|A|"], 0),
        (["time NPTS=5"], None, 2, [], 1),
        (["time a1 b2 c3 d4 e5 f6 ; x"], ",", 2, [], 1),
        (["acc time"], None, 2, ["acc|A|", "time|T|"], 0),
        (["acc nothing"], None, 2, [], 1),
        (["nothing time"], None, 2, [], 1),
        (["time nothing"], None, 2, ["time|T|", "nothing||"], 0),
        (["ch 1  ch 2"], None, 2, ["ch 1||", "ch 2||"], 0),
        (["time of one or more days  acc"], None, 2, ["time of one or more days|T|", "acc|A|"], 0),
        (["time of one or even more days  acc"], None, 2, [], 1),
        (["t a", "12 13", "-----"], None, 2, ["t|T|", "a|A|"], 0),
        (["12 13", "----"], None, 2, [], 2),
        ([], None, 2, [], 0),
    ],
)
def test_the_headings_of_columns(header, delimiter, width, found, above):
    """Of each column its name, the first letter of its kind of motion (or "spectrum"), and its unit."""
    headings, lines = column_headings(header, Layout(len(header), delimiter, ".", width))
    kinds = {"acceleration": "A", "velocity": "V", "displacement": "D", "time": "T"}
    assert [f"{one.name}|{kinds.get(one.kind, one.kind)}|{one.unit}" for one in headings] == found
    assert lines == above
