"""The criterion of Circolare 7/2019 on rotations under records (C8.7.1.2.1.9) beside the probability of overturning.

.. note:: Channels and bodies are those of :mod:`laboratory.ensemble`. A demand is a PGA, to which each channel is
   scaled by a factor of 0.25 to 4. The criterion is applied to all channels, and to random sets of seven (their mean)
   and of three (their largest), each channel of a set from another earthquake. The probability is the mean over
   earthquakes of the mean over their channels, from the overturning spectrum at the p of the bodies.
"""

import numpy as np
import pandas as pd

from laboratory.ensemble import StrongMotion, blocks
from laboratory.tables import plain
from rocking.march.recorded import recorded_response
from rocking.spectrum.overturning import OverturningSpectrum
from rockpulse.assessment.site_demands import FARTHEST
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.studies.check.check import check_records, rotations_of
from rockpulse.studies.check.mechanism import senses_of

#: PGA to which every channel is scaled [g], numbers of records of random sets, and how many sets are drawn.
DEMANDS, SETS, DRAWS = (0.2, 0.35, 0.5), (7, 3), 500
#: Probabilities from which a body may overturn, and overturns [-].
GRADES = {"may_overturn": 0.05, "overturns": 0.5}
STATES = ("slv", "slc")


def demand_cases(motion: StrongMotion, spectrum: OverturningSpectrum) -> pd.DataFrame:
    """A row for each demand [g] and body under a channel: the largest `rotation` over alpha_c, and the probability.

    A demand that a factor of 0.25 to 4 does not reach has no rows.
    """
    bodies, record, found = blocks(), motion.record, []
    for demand in DEMANDS:
        factor = demand * STANDARD_GRAVITY / record.pga
        if not FARTHEST[0] <= factor <= FARTHEST[1]:
            continue
        response = recorded_response(bodies, factor * record.acceleration, record.dt)
        own = {"record": record.id, "event": motion.event, "demand": demand, "lane": np.arange(bodies.shape[0])}
        chance = spectrum.overturning(bodies, np.full((bodies.shape[0], 1), factor))[:, 0]
        found.append(pd.DataFrame({**own, "rotation": response.peak_rotation_ratio, "probability": chance}))
    return pd.concat(found, ignore_index=True) if found else pd.DataFrame()


def record_verdicts(cases: pd.DataFrame, seed: int = 0, sizes: tuple[int, ...] = SETS) -> pd.DataFrame:
    """A row for each demand and body: `probability`, and the share of sets of records that fail SLV or SLC [-].

    `slv_all` is 1 or 0, for all records; `slv_7` and `slv_3` are shares of the random sets of seven and three.
    """
    bodies, rows = blocks(), []
    for (demand, lane), own in cases.groupby(["demand", "lane"]):
        senses, rng = senses_of(bodies.lane(int(lane))), np.random.default_rng(seed)
        peaks, events = own["rotation"].to_numpy(), pd.factorize(own["event"])[0]
        members = [np.flatnonzero(events == one) for one in range(events.max() + 1)]
        row = {"demand": demand, "slenderness": bodies.slenderness[int(lane)], "radius": bodies.radius[int(lane)]}
        row |= {"records": peaks.size, "probability": own.groupby("event")["probability"].mean().mean()}
        for size in (0, *sizes):
            sets = [np.arange(peaks.size)] if size == 0 else [_drawn(rng, members, size) for _ in range(DRAWS)]
            for state in STATES:
                found = [check_records(senses, rotations_of(peaks[one]), state, "").displacement_ratio for one in sets]
                row[f"{state}_{size or 'all'}"] = np.mean(np.array(found) < 1.0)
        rows.append(row)
    return pd.DataFrame(rows)


def _drawn(rng: np.random.Generator, members: list[np.ndarray], size: int) -> np.ndarray:
    """One channel of each of `size` earthquakes."""
    chosen = rng.choice(len(members), size=size, replace=False)
    return np.array([rng.choice(members[one]) for one in chosen])


def verdict_counts(verdicts: pd.DataFrame) -> pd.DataFrame:
    """How many bodies may overturn and overturn at each demand, and how many the criterion fails (in the mean of sets).

    The rows of `demand` NaN are of all demands together.
    """
    kinds = [f"{state}_{size}" for size in ("all", *SETS) for state in STATES]
    rows = []
    for demand in (*DEMANDS, np.nan):
        own = verdicts if np.isnan(demand) else verdicts[verdicts["demand"] == demand]
        counts = {name: int((own["probability"] >= least).sum()) for name, least in GRADES.items()}
        rows.append({"demand": demand, "bodies": len(own), **counts, **own[kinds].sum().to_dict()})
    return pd.DataFrame(rows)


def verdict_overview(counts: pd.DataFrame) -> str:
    """The counts as a table."""
    title = (
        "Criterion on rotations under records (C8.7.1.2.1.9): number of bodies with P of 5 % and 50 % or more, and "
        "number that fail SLV and SLC, by all records, and by random sets of 7 (mean) and of 3 (largest) on average"
    )
    shown = counts.assign(demand=["all" if np.isnan(one) else f"{one:g} g" for one in counts["demand"]])
    formats = dict.fromkeys(("demand", "bodies", *GRADES), str)
    formats |= {name: ("{:.0f}" if name.endswith("all") else "{:.1f}").format for name in counts if name[:2] == "sl"}
    return f"{title}\n{plain(shown, formats)}"
