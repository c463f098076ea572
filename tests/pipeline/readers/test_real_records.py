"""Every file of the folder of real records, as its MANIFEST describes it."""

import csv
import os
from pathlib import Path

import numpy as np
import pytest

from rockpulse.errors import RecordRefused
from rockpulse.readers import ReadOptions, read, read_source
from rockpulse.readers.source import Archive, NotAcceleration
from rockpulse.record.record import STANDARD_GRAVITY

FOLDER = os.environ.get("ROCKPULSE_RECORDS")
MANIFEST = Path(FOLDER, "MANIFEST.tsv") if FOLDER else None
ROWS: list[dict[str, str]] = []
if MANIFEST and MANIFEST.is_file():
    with MANIFEST.open(encoding="utf-8", newline="") as stream:
        ROWS = list(csv.DictReader(stream, delimiter="\t"))

#: The reader of each folder.
OF_THEIR_NAME = "at2 bhrc columns cosmos csmip_v1 csmip_v2 csmip_v3 cwb geonet renadic sac smc usc_v1 usc_v2"
READERS = {name: name for name in OF_THEIR_NAME.split()}
READERS |= {"dyna_asc": "dyna", "dyna_asc_afad": "dyna", "afad_nsmn": "nsmn"}
READERS |= {"sigma_itaca": "sigma", "unam_asa": "asa"}
READERS |= dict.fromkeys(("mseed_clipped", "mseed_xml", "tricky_obspy"), "miniseed")

#: What the files do not say, by folder or file.
OPTIONS = {"sac": {"units": "m/s2"}, "columns": {"units": "g"}, "columns/ARL360.g3": {"units": "g", "dt": 0.02}}

REFUSED = {
    "csmip_v3/CE89146.V3": (NotAcceleration, "response and Fourier spectra"),
    "mseed_xml/AV.CKT..EHZ__20181130T172859Z__20181130T173629Z.mseed": (NotAcceleration, r"AV.CKT..EHZ records M/S"),
    "mseed_clipped/HV.HSSD..HHE__20190414T030832Z__20190414T031602Z.mseed": (RecordRefused, "in counts and no sens"),
    "tricky_obspy/gaps.mseed": (RecordRefused, "3 gaps or overlaps"),
}

#: Folders with a list of their own; their archives hold two columns.
OWN_LIST = {"fema_p695"}

#: Unequal steps, resampled at their median: other numbers of samples than the (time, acceleration) pairs in the file.
RESAMPLED = {
    "csmip_v1/LA116TH.RAW": [12000, 12000, 12000],
    "smc/891018_1.cra-1.0210j.smc": [34656],
    "usc_v1/017m30lw.e0a": [7504],
}
#: Raw records with an offset: the MANIFEST lists the peak of the record less its mean.
OFFSET = {"mseed_xml/CI.WCS2..HNE.mseed", "mseed_xml/CI.WCS2..HNN.mseed", "unam_asa/CUP50401.012"}
#: Peaks [g] that the MANIFEST leaves open: counts with a gain in the header; the header's own words for the SAC file.
PEAKS = {
    "cosmos/NP8040-n.1000hyfh.HNE.01.V0c": 0.2453,
    "sac/20190706031952.CJ.T001230.HNE.sac": 0.043384 / STANDARD_GRAVITY,
}
#: The MANIFEST has 0.005 s, the interval of the raw record (header value 34); value 62 says 0.01 s for the series,
#: which with 7000 samples makes the 70 s that the text states.
INTERVALS = {"cosmos/Cosmos12TimeSeriesTest2.v1": 0.01}
#: The fourth channel is dead and is left out with a warning on the others.
LEFT_OUT = {"renadic/curico1002271parte1.v1": [0, 1, 2]}

#: Warnings of all channels together; the other files have none.
WARNINGS = {
    "columns/ARL360.g3": 1,  # rows of five read as one series
    "cosmos/Cosmos12TimeSeriesTest2.v1": 5,  # two intervals, of both channels; a direction that contradicts itself
    "csmip_v1/LA116TH.RAW": 3,  # unequal steps
    "dyna_asc/20101114230825_3104_ap_RawAcc_E.asc": 1,  # processing without corner frequencies
    "dyna_asc_afad/20230206011732_0201_ap_AAD_Acc_E.asc": 1,  # the peak of the header is 2 % off
    "renadic/curico1002271parte1.v1": 9,  # a dead channel; part 1 alone; times of peaks that are 20 s too early
    "renadic/cuya0911131.v1": 3,  # a clock that was never set
    "smc/891018_1.cra-1.0210j.smc": 2,  # unequal steps; a row too many
    "unam_asa/CUP50401.012": 3,  # a count that is not that of the rows
    "usc_v1/017m30lw.e0a": 1,  # unequal steps
}

#: Id of the first channel, azimuths of all, station and earthquake, processed, as one finds them in the files.
FIELDS = {
    "afad_nsmn/20170720223109_0921.txt": (
        *(".0921..NS@20170720T223058", [0.0, 90.0, None]),
        *("AYDıN GERMENCIK DEVLET HASTANESI", "2017/07/20 22:31:09 (GMT) M 6.5 Mw", False),
    ),
    "bhrc/5520-1.V1": ("5520-1.L", [352.0, None, 82.0], "Ahar", "2012/08/11 12:23:16", False),
    "cosmos/CE23837.V1C": (
        *("CE.23837..HNN@20180829T023300", [0.0, None, 90.0]),
        *("Pomona - Orange Grove & Fairplex", "Tue Aug 28, 2018 19:33:00.0 PDT", False),
    ),
    "csmip_v2/ce36456p_CE36456.V2": (
        *(".36456..90@19830502T234248", [90.0, None, 0.0], "PARKFIELD FAULT ZONE 14", "COALINGA EARTHQUAKE", True),
    ),
    "cwb/2-EGF.dat": (".EGF..U@20180206T155029", [None, 0.0, 90.0], "Guangfu", "2018/02/06-23:50:42", False),
    "dyna_asc/HI.ARS1..HNE.D.20190728.160908.C.ACC.ASC": (
        *("HI.ARS1..HNE@20190728T160919", [90.0], "Town Hall,Argos,Argolis,Peloponnese", "GREECE", True),
    ),
    # The name says raw, the header 'Automatic': its spectrum is flat to 45 Hz, no filter was applied.
    "dyna_asc/20101114230825_3104_ap_RawAcc_E.asc": (
        *("TK.3104..HNE@20101114T230919", [90.0], "HATAY_HASSA_AKTEPE_SALYK_OCAY_BAHCESI", "201011142308", None),
    ),
    "geonet/20161113_110313_THZ_20.V2A": (
        *(".THZ.20.S90E@20161113T110233", [90.0, 0.0, None], "Top House", "5 km south-west of Waiau", True),
    ),
    "sigma_itaca/16837_H2.cor.acc": (
        *("16837_H2.cor.WE", [90.0], "L Aquila - V. Aterno - Centro Valle, Italy", "2009-04-06 01:32:39", True),
    ),
    "unam_asa/CUP50401.012": (
        *(".CUP5..V@20040102T000001", [None, 90.0, 0.0]),
        *("IDEI PATIO 5", "2004/01/01 23:58:02.7 Mb=5.2/Ms=5.8/Mc=5.0/Ma=5.6/Me=5.7", False),
    ),
    "usc_v1/017m30lw.e0a": (
        *("017m30lw.S05W", [185.0], "8510 WONDERLAND AVE., LOS ANGELES, CA"),
        *("NORTHRIDGE EARTHQUAKE JAN 17, 1994 -1230 GMT", False),
    ),
    "usc_v2/274o42pv.s0a": (
        *("274o42pv.S58W", [238.0], "2161 VIA OLIVERA, PALOS VERDES ESTATES, CA"),
        *("WHITTIER NARROWS EARTHQUAKE OCT 01, 1987 -1442 GMT", True),
    ),
}

#: Files of `OWN_LIST` that print their times of 0.0025 s to three decimals, in steps that are all equal.
PRINTED_STEPS = {"120921.txt": 0.003, "120922.txt": 0.003}

RECORDS = [row["file"] for row in ROWS if row["npts"]]
READABLE = [name for name in RECORDS if name not in REFUSED]
LISTED = {row["file"]: row for row in ROWS}

pytestmark = pytest.mark.skipif(not ROWS, reason="ROCKPULSE_RECORDS is not set, or names no folder with a MANIFEST.tsv")


def options(name):
    return OPTIONS.get(name) or OPTIONS.get(name.partition("/")[0], {})


def listed(name, column):
    return [float(text) for text in LISTED[name][column].split(";") if text.strip() != "-"]


@pytest.mark.sweep
@pytest.mark.parametrize("name", READABLE)
def test_counts_intervals_and_peaks_are_those_of_the_manifest(records_folder, name):
    records = read(records_folder / name, **options(name))
    kept = LEFT_OUT.get(name, slice(None))
    counts, steps, peaks = (np.array(listed(name, column)) for column in ("npts", "dt_s", "pga_g"))
    if name in RESAMPLED:
        assert all("unequal steps" in note for record in records for note in record.warnings[-1:])
        counts = np.array(RESAMPLED[name], dtype=float)
    assert [record.npts for record in records] == list(counts[kept])
    expected = np.full(len(records), INTERVALS[name]) if name in INTERVALS else steps[kept]
    assert [record.dt for record in records] == pytest.approx(expected, rel=1e-6)
    means = [record.acceleration.mean() if name in OFFSET else 0.0 for record in records]
    found = [np.max(np.abs(record.acceleration - mean)) for record, mean in zip(records, means, strict=True)]
    expected = np.array([PEAKS[name]]) if name in PEAKS else peaks[kept]
    assert np.array(found) / STANDARD_GRAVITY == pytest.approx(expected, rel=2e-3)
    assert {record.format for record in records} == {READERS[name.partition("/")[0]]}
    notes = [note for record in records for note in record.warnings]
    assert len(notes) == WARNINGS.get(name, 0), notes


@pytest.mark.parametrize("name", FIELDS)
def test_the_fields_of_real_files(records_folder, name):
    records = read(records_folder / name)
    first, azimuths = records[0], [None if np.isnan(record.azimuth) else record.azimuth for record in records]
    assert (first.id, azimuths, first.station_name, first.event, first.processed) == FIELDS[name]
    # Headers print the peaks with four digits or more; these records keep their means.
    stated = [record for record in records if np.isfinite(record.header_peak)]
    assert [one.pga for one in stated] == pytest.approx([one.header_peak for one in stated], rel=2e-3, abs=5.1e-5)


@pytest.mark.parametrize("name", REFUSED)
def test_what_holds_no_usable_acceleration_is_refused(records_folder, name):
    error, words = REFUSED[name]
    with pytest.raises(error, match=words) as refusal:
        read(records_folder / name)
    assert type(refusal.value) is error
    assert name.rpartition("/")[2] in str(refusal.value)


def test_every_row_of_the_manifest_is_tested(records_folder):
    others = {row["file"] for row in ROWS} - set(READABLE) - set(REFUSED)
    assert {Path(name).suffix for name in others} <= {".xml", ".zip"}
    assert set(REFUSED) <= set(LISTED)
    paths = [path.relative_to(records_folder) for path in records_folder.rglob("*") if path.is_file()]
    on_disk = {str(path) for path in paths if path.parts[0] not in OWN_LIST}
    assert on_disk - {"MANIFEST.tsv"} == set(LISTED)


@pytest.mark.sweep
def test_the_far_field_set_is_read_as_its_own_list_says(records_folder):
    folder = records_folder / "fema_p695"
    with (folder / "events.tsv").open(encoding="utf-8", newline="") as stream:
        rows = {row["file"]: row for row in csv.DictReader(stream, delimiter="\t")}
    with Archive(folder / "records.zip") as opened:
        archive = {name.rpartition("!")[2]: opened.member(number) for number, name in enumerate(opened.names)}
    found = {name: read_source(member, ReadOptions(units="g"))[0] for name, member in archive.items()}
    assert set(rows) == set(found)
    for name, row in rows.items():
        record = found[name]
        step = PRINTED_STEPS.get(name, float(row["dt_s"]))
        assert (record.npts, record.dt) == (int(row["npts"]), pytest.approx(step, rel=1e-6)), name
        assert record.pga / STANDARD_GRAVITY == pytest.approx(float(row["pga_g"]), rel=2e-3), name
