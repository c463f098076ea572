"""PEER's list of a search beside AT2 files: magnitude, Vs30 and names for the files of its rows."""

import io
import math

import pytest
from record_writers import at2, pulse
from source_files import make_zip

from rockpulse.readers import read
from rockpulse.readers.folders import read_all

HEADS = (
    "Result ID, Spectral Ordinate, Record Sequence Number, MSE, Scale Factor, Tp-Pulse (s), Arias Intensity (m/sec), "
    "Earthquake Name, Year, Station Name, Magnitude, Mechanism, Rjb (km), Rrup (km), Vs30 (m/sec), "
    "Lowest Useable Frequency (Hz), Horizontal-1 Acc. Filename, Horizontal-2 Acc. Filename, Vertical Acc. Filename"
)
ROWS = (
    '1, SRSS, 763, 0.1, 1, -, 1.0, "Loma Prieta", 1989, "Gilroy - Gavilan Coll.", 6.93, Reverse Oblique, 9.19, 9.96, '
    "729.65, 0.25, RSN763_LOMAP_GIL067.AT2, RSN763_LOMAP_GIL337.AT2, RSN763_LOMAP_GIL-UP.AT2",
    '2, SRSS, 1, 0.1, 1, -, 1.0, "Helena, Montana-01", 1935, "Carroll College", 6, strike slip, 2.07, 2.86, -999, '
    "0.2, RSN1_HELENA.A_A-HMC180.AT2, RSN1_HELENA.A_A-HMC270.AT2, ---",
)


def table(*rows, heads=HEADS):
    before = "PEER Ground Motion Database\n\n -- Summary of Metadata of Selected Records --\n"
    after = (
        "\n\n -- Scaled Spectra used in Search & Scaling --\nPeriod (sec), RSN-763 Horizontal-1 pSa (g)\n0.01,0.36\n"
    )
    return (before + "\n".join([heads, *rows]) + after).encode()


def test_rows_serve_the_files_they_name(tmp_path):
    (tmp_path / "_SearchResults.csv").write_bytes(table(*ROWS))
    title = "Loma Prieta, 10/18/1989, Gilroy - Gavilan Coll., 67"
    (tmp_path / "RSN763_LOMAP_GIL067.AT2").write_bytes(at2(pulse(), title=title))
    (tmp_path / "rsn1_helena.a_a-hmc180.at2").write_bytes(at2(pulse(peak=0.2), title=""))
    (tmp_path / "RSN2.AT2").write_bytes(at2(pulse(peak=0.1)))
    (record,) = read(tmp_path / "RSN763_LOMAP_GIL067.AT2")
    assert (record.magnitude, record.vs30, record.event) == (6.93, 729.65, "Loma Prieta, 10/18/1989")
    # Rjb and Rrup are no epicentral distances, and the list does not say which scale the magnitude has.
    assert math.isnan(record.epicentral_distance)
    assert record.magnitude_type == ""
    (record,) = read(tmp_path / "rsn1_helena.a_a-hmc180.at2")
    assert (record.event, record.station_name) == ("Helena, Montana-01 1935", "Carroll College")
    assert record.magnitude == 6.0
    assert math.isnan(record.vs30)
    (record,) = read(tmp_path / "RSN2.AT2")
    assert math.isnan(record.magnitude)
    assert record.warnings == ()


def test_the_list_is_found_in_archives_and_beside_open_files(tmp_path):
    files = {"in__RSN763_LOMAP_GIL067_dot_AT2": at2(pulse()), "in___SearchResults_dot_csv": table(*ROWS)}
    archive = make_zip(tmp_path / "PEER.zip", **files, out__RSN763_LOMAP_GIL337_dot_AT2=at2(pulse(peak=0.2)))
    records, failures = read_all(archive)
    assert [record.magnitude for record in records] == pytest.approx([6.93, math.nan], nan_ok=True)
    assert [(row.file.rpartition("/")[2], row.kind) for row in failures] == [("_SearchResults.csv", "skipped")]
    (tmp_path / "_SearchResults.csv").write_bytes(table(*ROWS))
    path = tmp_path / "RSN763_LOMAP_GIL337.AT2"
    path.write_bytes(at2(pulse()))
    with path.open("rb") as stream:
        assert read(stream)[0].vs30 == 729.65
    assert math.isnan(read(io.BytesIO(at2(pulse())))[0].vs30)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no list at all",
        table(*ROWS, heads="Result ID, Year"),
        table(ROWS[0].rpartition(",")[0]),
        table(ROWS[1]) + ROWS[0].encode(),
    ],
    ids=["empty", "text", "other headings", "a row cut short", "behind the table"],
)
def test_a_list_without_the_file_tells_nothing(tmp_path, content):
    (tmp_path / "_SearchResults.csv").write_bytes(content)
    path = tmp_path / "RSN763_LOMAP_GIL067.AT2"
    path.write_bytes(at2(pulse()))
    (record,) = read(path)
    assert math.isnan(record.magnitude)
    assert record.warnings == ()


def test_a_list_that_cannot_be_read_is_a_warning(tmp_path):
    (tmp_path / "_SearchResults.csv").write_bytes(b'"' + 200_000 * b"x" + b'"\n')
    path = tmp_path / "RSN763_LOMAP_GIL067.AT2"
    path.write_bytes(at2(pulse()))
    (record,) = read(path)
    (warning,) = record.warnings
    assert warning.startswith("_SearchResults.csv beside the file cannot be read, magnitude and Vs30 stay unknown: ")
