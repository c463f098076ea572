"""Whether a file that no reader knows gets a line of its own: nothing that may be data is hidden."""

import pytest

from rockpulse.errors import RecordFormatError
from rockpulse.readers.no_record import advice, is_quiet, may_be_record
from rockpulse.readers.source import HEAD, SourceFile

VALUES = [-300.12, -299.87, 0.1132, -4821.02, 12.5, -0.5] * 20
PROSE = "The strong-motion data are distributed by the agency as they are\n"


def opened(name, content):
    content = content.encode() if isinstance(content, str) else content
    return SourceFile(name, content[:HEAD], lambda: content)


def catalogue(template):
    """Rows of a table of other things: their words change from one to the next."""
    names = [f"{first}{second}" for first in "abcdefgh" for second in "mnopqrst"]
    return "".join(template.format(name=name, k=k, x=k / 7.0) for k, name in enumerate(names))


def rows(template, count=None):
    return "".join(template.format(t=0.01 * k, a=a) for k, a in enumerate(VALUES[:count]))


#: Contents that may be a record; one row, word or digit less, and they are none.
HALF = "0.1234 0.5678 0.9\nsome words here about it\n" * 9
AS_MANY_DIGITS = ("0.123456789 " * 11 + "\n") * 2 + ("a" * 44 + "\n") * 5
CODED = "WID2 2019/07/06 03:19:53.000 CCC   HNE      CM6    12000  100.000000\nDAT2\n" + "KJkVkOkHkJ\n" * 90


def in_turn(channels):
    return "".join(f"HN{letter} 0.1234567 0.7654321\n" for letter in "ENZXY"[:channels]) * 5


@pytest.mark.parametrize(
    "content",
    [
        "Station X\nUNITS CM/S/S\n" + "-300.12-299.87-411.32\n" * 30,  # columns that run together
        "-300-299-411-123\n" * 30,
        "date,acc\n" + rows("2019-07-06T03:19:{t:05.2f},{a}\n"),
        rows("{t:.2f} {a}\n").replace("-", "\u2212"),
        rows("{a}g\n"),
        rows("t={t:.2f} s a={a} m/s2\n"),
        rows('{{"time in seconds": {t:.2f}, "acceleration in gravity": {a}}},\n'),
        rows("{t:.2f} 1,131.57\n"),
        rows("sample {t:.0f} counts 4711\n"),
        "".join(f"{0.01 * k:.2f} {a * 1e-3 ** (k % 3):g} {'NaN' if k % 5 else a}\n" for k, a in enumerate(VALUES)),
        "".join(f"2019-07-06T03:19:{k:02} HN{'NEZ'[k % 3]} {a:.4f} {a:.3f}\n" for k, a in enumerate(VALUES)),
        "time,record\n" + rows("{t:.2f},{a}\n"),
        "event,NS,EW\n" + rows("{t:.2f},{a},{a}\n"),
        "record,a1,a2\n" + rows("{t:.2f},{a},{a}\n"),
        rows("{a:.5E}{a:.5E}\n").replace("E", "D"),
        PROSE * 200 + "-300.12-299.87\n" * 12,  # a long heading
        PROSE * 15 + "".join(f"{a:9.2f}" for a in VALUES * 3),  # all in one line
        "\u0660\u0661 \u0662\u0663\n" * 50,  # digits of another script
        bytes(range(256)),
        b"\x01\x02abc def ghi",
        PROSE * 40 + rows("{t:.2f} {a:.2f} {a:.3f}\n", 10) + PROSE * 40,  # ten rows together
        "0.5\n" * 20,  # forty groups of digits
        HALF,
        AS_MANY_DIGITS,
        in_turn(4),
        CODED,
    ],
)
def test_numbers_and_binary_data_may_be_a_record_whatever_they_are_called(content):
    for name in ("noext", "a.txt", "a.csv", "b.zip!sub/a.json", "a.xml", "a.yaml", "a.log", "a.ini"):
        assert may_be_record(opened(name, content)), name


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("notes.txt", "hello world\nthis is prose\n"),
        ("notes.txt", PROSE * 3 + "42\n" + PROSE * 3 + "version 1.2 of 2019\n\x1a"),
        ("notes.txt", "Erdbeben f\u00fcr M\u00fcnchen\n".encode("latin-1")),
        ("Readme.txt", "0.01 0.02\n" * 20),
        ("z.zip!DISCLAIMER.TXT", PROSE),
        ("_SearchResults.csv", "0.01,0.02,0.03\n" * 20),
        ("costs.csv", "item,pieces,price\nanchor,4,120.5\nbolt,16,2.25\n"),  # a handful of numbers
        ("stations.csv", "code,latitude,longitude\n" + catalogue("{name},{x:.4f},{x:.3f}\n")),
        ("events.tsv", catalogue("{k}.txt\t{name}\t1994-01-17\t6.7\t0.0100\t3000\t0.4158\n")),
        ("flatfile.csv", catalogue("{name}," + "{x:.3f}," * 60 + "\n")),
        ("list.txt", catalogue("{k:08}{name}{k:024}  sub/{name}.AT2\n")),
        ("table.csv", "record,block,pga,safety_factor\n" + "CI.CCC..360@20190706T031937,wall-1,1.2,3.4\n" * 40),
        ("weights.csv", "record,weight\n" + "h.1,0.5\n" * 40),
        ("events.csv", "\ufeffrecord, event\n" + "h.1,38457511\n" * 40),
        ("capacities.csv", "block,limit_state,measure,median\n" + "wall,overturning,pga,1.25\n" * 40),
        ("failures.csv", "file,stage,reason,kind\n" + "m01.asc,read,cut at 1.25,failed\n" * 40),
        ("tool.ini", "[view]\nsize = 12\nlanguage = en\n"),
        ("setup.log", PROSE * 20),
        ("search.csv", " -- Summary of Metadata of Selected Records --\n" + "0.01,0.02,0.03\n" * 40),
        ("_SearchResults (1).csv", "0.01,0.02,0.03\n" * 20),
        ("all.log", "2026-11-22 10:00:00,123 ERROR m01.asc: cut\n" * 40),
        ("run.txt", "2026-11-22 10:00:00,123 ERROR m01.asc: cut\n" * 40),
        ("CI.CCC.stationxml", "<?xml version='1.0'?>\n<FDSNStationXML>\n" + "<Value>1.25</Value>\n" * 40),
        ("RESP.CI.CCC..HNE", "# response\nB050F03     Station:     CCC\n" + "B053F09  0  1.2E+00  2.3E-01\n" * 40),
        ("study.ipynb", rows('"{t:.2f} {a}",\n')),
        ("plan.dat", b"%PDF-1.4\x00\x01"),
        ("map.bin", b"\x89PNG\r\n\x1a\n" + bytes(range(256))),
        ("guide.pdf", b"%PDF-1.4\x00\x01"),
        ("plot.png", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"),
        ("station.xml", "<a>\n<b>text</b>\n</a>\n"),
        ("a.txt", PROSE * 40 + rows("{t:.2f} {a:.2f} {a:.3f}\n", 9) + PROSE * 40),
        ("a.txt", "0.5\n" * 19 + "7\n"),
        ("a.txt", HALF + "some words here about it\n"),
        ("a.txt", AS_MANY_DIGITS + "b"),
        ("a.txt", in_turn(5)),
        ("a.txt", CODED.replace("WID2", "what")),
    ],
)
def test_texts_tables_and_pictures_are_no_records(name, content):
    assert not may_be_record(opened(name, content))


def test_what_is_passed_over_without_a_row():
    def xml(content):
        return lambda: opened("a.xml", content)

    def failing(error):
        def fail():
            raise error

        return fail

    assert is_quiet("sub/notes.MD", failing(AssertionError))
    assert is_quiet("a.zip!plot.png", failing(AssertionError))
    assert not is_quiet("a.AT2", failing(AssertionError))
    assert is_quiet("a.XML", xml("<?xml version='1.0'?>\n<FDSNStationXML>\n"))
    assert not is_quiet("a.xml", xml("<samples>\n"))
    assert not is_quiet("a.xml", failing(RecordFormatError("damaged")))
    assert not is_quiet("a.xml", failing(FileNotFoundError("gone")))


@pytest.mark.parametrize("name", ["readme.v2", "notes.AT2", "a.xls", "a.XLSX", "a.ods"])
def test_the_suffix_of_a_record_or_a_spreadsheet_speaks_for_one(name):
    assert may_be_record(opened(name, PROSE))


@pytest.mark.parametrize("name", ["a.xls", "a.xlsx", "x.zip!a.ods"])
def test_a_spreadsheet_is_to_be_saved_as_csv(name):
    assert "save it as CSV" in advice(opened(name, b"\xd0\xcf\x11\xe0"))
    assert "CSV" not in advice(opened("a.txt", "1"))


@pytest.mark.sweep
def test_every_record_of_the_samples_is_known_for_one_by_its_content_alone(samples):
    paths = [path for path in sorted((samples.parent / "formats").iterdir()) if path.suffix != ".xml"]
    assert len(paths) > 30
    assert [path.name for path in paths if not may_be_record(opened("anything.txt", path.read_bytes()))] == []
