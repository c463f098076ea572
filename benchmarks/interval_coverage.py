"""Coverage of the 90 % interval of a mean probability over earthquakes, `rockpulse.earthquakes.probability_interval`.

    ROCKPULSE_RECORDS=FOLDER python benchmarks/interval_coverage.py [--resamples 1000]

The probability of overturning of twelve bodies (slenderness 4, 6, 8, 12; R 1, 2, 4 m) is computed under all records of
a set, as recorded and scaled to six demands, and averaged for each earthquake. The earthquakes of a set are the
population: its mean is the truth, and samples of 5, 8 and 13 earthquakes are drawn with replacement. One line for each
set and number of earthquakes gives the mean and the smallest coverage over bodies and demands with a true mean from
0.02 to 0.98, the share of intervals that lie below the truth, and the mean distance from the truth to the upper end.
Beside it stands the interval of Clopper and Pearson (1934) that takes the mean probability for a share. The sets are
FEMA P-695 and the channels above 0.1 g of the other folders.
"""

import argparse
import os
import zipfile
from io import TextIOWrapper
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.special import betaincinv

import rockpulse as rp
from rockpulse.earthquakes import members, probability_interval
from rockpulse.errors import RockpulseError
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.selection.events import UNKNOWN

COUNTS, BETWEEN, LEAST_PGA = (5, 8, 13), (0.02, 0.98), 0.1 * STANDARD_GRAVITY
#: Folders whose formats state unit and interval.
OTHERS = "at2 bhrc cosmos csmip_v1 csmip_v2 csmip_v3 cwb dyna_asc dyna_asc_afad geonet smc unam_asa usc_v1 usc_v2"


def config() -> rp.Config:
    """The bodies and demands."""
    bodies = []
    for slenderness in (4, 6, 8, 12):
        alpha = np.arctan(1.0 / slenderness)
        for radius in (1, 2, 4):
            size = {"width": 2.0 * radius * np.sin(alpha), "height": 2.0 * radius * np.cos(alpha)}
            bodies.append(rp.BlockSettings(f"slenderness {slenderness}, R {radius} m", **size))
    demands = [rp.DemandSettings(value=f"{value} g") for value in (0.2, 0.35, 0.5)]
    demands += [rp.DemandSettings(measure="pgv", value=f"{value} m/s") for value in (0.2, 0.4, 0.6)]
    models = rp.ModelSettings(use=("nonlinear",))
    return rp.Config(bodies=bodies, demands=demands, records=rp.RecordSettings(store="none"), models=models)


def p695(folder: Path) -> list[rp.Record]:
    """The records of FEMA P-695, each with its earthquake."""
    table, found = pd.read_csv(folder / "events.tsv", sep="\t").set_index("file"), []
    with zipfile.ZipFile(folder / "records.zip") as archive:
        for name in sorted(one for one in archive.namelist() if one.endswith(".txt")):
            row = table.loc[Path(name).name]
            with archive.open(name) as file:
                values = np.loadtxt(TextIOWrapper(file, "ascii"))[:, 1] * STANDARD_GRAVITY
            facts = {"event": str(row["event"]), "processed": True, "orientation": "horizontal"}
            found.append(rp.Record(values, dt=float(row["dt_s"]), id=Path(name).stem, **facts))
    return found


def others(folder: Path) -> list[rp.Record]:
    """The strong horizontal channels of the other folders."""
    found = []
    for record in rp.read_all([folder / name for name in OTHERS.split()])[0]:
        try:
            strong = rp.condition(record).pga >= LEAST_PGA
        except RockpulseError:
            continue
        if strong and record.orientation not in ("vertical", "structural"):
            found.append(record)
    return found


def population(records: list[rp.Record]) -> np.ndarray:
    """Mean probability of each earthquake (earthquakes, cases), NaN if no record can be scaled to the demand."""
    summary = rp.assess(records, config())["summary"].to_dataset()
    scaled = summary["demand_probability"].transpose("record", ...).values.reshape(len(records), -1)
    recorded = summary["overturning_probability"].values.reshape(len(records), -1)
    every, events = np.hstack([scaled, recorded]), summary["event"].values.astype(str)
    kept = events != UNKNOWN
    with np.errstate(invalid="ignore"):
        groups = [every[kept][own] for own in members(events[kept])]
    return np.array([np.nanmean(np.where(np.isnan(one).all(axis=0), np.nan, one), axis=0) for one in groups])


def clopper_pearson(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The interval that takes a mean probability for a share."""
    count = len(values)
    hit = values.sum(axis=0)
    low = betaincinv(np.maximum(hit, 1e-9), count - hit + 1.0, 0.05)
    return np.where(hit > 0.0, low, 0.0), betaincinv(hit + 1.0, np.maximum(count - hit, 1e-9), 0.95)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--resamples", type=int, default=1000)
    resamples, folder = parser.parse_args().resamples, Path(os.environ["ROCKPULSE_RECORDS"])
    print(
        "set          earthquakes  cases  coverage  smallest  below  to the upper end | Clopper-Pearson: coverage, to"
    )
    for name, records in (("FEMA P-695", p695(folder / "fema_p695")), ("others", others(folder))):
        pool, rng = population(records), np.random.default_rng(38)
        for count in COUNTS:
            rows = []
            for column in pool.T:
                known = column[~np.isnan(column)]
                truth = known.mean() if known.size >= max(COUNTS[:2]) else np.nan
                if BETWEEN[0] <= truth <= BETWEEN[1]:
                    drawn = rng.choice(known, size=(count, resamples))
                    for interval in (probability_interval, clopper_pearson):
                        low, high = interval(drawn)
                        inside = (low <= truth + 1e-9) & (truth <= high + 1e-9)
                        rows.append((np.mean(inside), np.mean(high < truth), np.mean(high - truth)))
            own, other = np.array(rows[::2]), np.array(rows[1::2])
            mean, least = own.mean(axis=0), own[:, 0].min()
            line = f"{name:12} {count:11} {len(own):6} {mean[0]:9.3f} {least:9.2f} {mean[1]:6.3f} {mean[2]:17.2f} |"
            print(f"{line} {other[:, 0].mean():25.3f}, {other[:, 2].mean():.2f}", flush=True)


if __name__ == "__main__":
    main()
