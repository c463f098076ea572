"""Where the checks of codes are unsafe and where they are dear: against time histories of recorded strong motion.

.. note:: Strong channels and bodies by the protocol of the rule (:mod:`rockpulse.studies.rule.cases`). Each channel is
   its own code: its PGA stands for a_g S and its spectrum of 5 % damping for S_e. The ratio of a check falls as the
   factor on the record grows, so one number a case tells the largest factor that it allows. A case at a factor
   overturns where the probability of overturning is 0.5 or more (from f_50 on). Missed: cases that overturn and pass;
   false: cases that stand and do not. Earthquakes are resampled for the intervals (BCa).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from rockpulse.assessment.overturning import overturning_factors, overturning_spectrum
from rockpulse.config.check_settings import CheckSettings
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.storage.study_variables import CODE_CASES, CODE_RATES, STATEMENTS, STUDY, VERDICTS, described_set
from rockpulse.storage.variables import with_values
from rockpulse.studies.accuracy.model_form import blocks
from rockpulse.studies.check.codes import circolare_2009, circolare_2019
from rockpulse.studies.check.mechanism import senses_of
from rockpulse.studies.check.spectra import damping_factor, displacement_of
from rockpulse.studies.rule.cases import StrongMotion

if TYPE_CHECKING:
    import xarray as xr


#: Factors on each record at which cases are counted [-].
LEVELS = (0.5, 1.0, 2.0)

#: Checks by the columns that hold the largest factor they allow, and what they are called.
ALLOWED = {
    "linear": "the linear check of Circolare 617/2009 and 7/2019",
    "nonlinear": "the nonlinear check of Circolare 617/2009",
    "both": "the linear and the nonlinear check of Circolare 617/2009",
    "displacement": "the displacement check of Circolare 7/2019 (SLV)",
}

#: Periods at which the displacement spectrum of a record is looked at [s].
PERIODS = np.geomspace(0.05, 8.0, 120)

#: Fewest earthquakes of an interval, its confidence, and the draws.
FEWEST, CONFIDENCE, RESAMPLES = 4, 0.9, 1000


class _OwnSpectrum:
    """The spectrum of a record; other dampings by eta."""

    def __init__(self, record: Record) -> None:
        self.record, self.ground, self.words = record, record.pga, record.id
        moved = [displacement_of(one, spectral_acceleration(record, one)) for one in PERIODS.tolist()]
        self.largest = np.maximum.accumulate(moved)

    def __call__(self, period: float, damping: float = 0.05) -> float:
        return spectral_acceleration(self.record, period) * damping_factor(damping)

    def displacement(self, period: float, damping: float = 0.05) -> float:
        """The largest S_De [m] up to a period [s], which may be one of those in between."""
        before = int(np.searchsorted(PERIODS, period))
        own = displacement_of(period, self(period, damping))
        return max(own, damping_factor(damping) * float(self.largest[before - 1])) if before else own


def _cases_of(motion: StrongMotion, settings: CheckSettings) -> pd.DataFrame:
    bodies, spectrum = blocks(), _OwnSpectrum(motion.record)
    factors = overturning_factors(overturning_spectrum(motion.record), bodies)
    rows = []
    for lane in range(bodies.shape[0]):
        (mechanism,) = senses_of(bodies.lane(lane))  # free blocks, whose senses are alike
        older, newer = (check(mechanism, spectrum, (), settings) for check in (circolare_2009, circolare_2019))
        rows.append(
            {
                "linear": older.activation_ratio,
                "nonlinear": older.displacement_ratio,
                "both": min(older.activation_ratio, older.displacement_ratio),
                "displacement": newer.displacement_ratio,
            }
        )
    return pd.DataFrame(
        {
            "record": motion.record.id,
            "event": motion.event,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            "uplift_factor": STANDARD_GRAVITY * np.tan(bodies.alpha_c) / motion.record.pga,
            "factor_10": factors["factor_10"],
            "factor_50": factors["factor_50"],
        }
    ).join(pd.DataFrame(rows))


def check_cases(
    motions: Sequence[StrongMotion],
    settings: CheckSettings | None = None,
    progress: Callable[[Sequence[StrongMotion]], Iterable[StrongMotion]] | None = None,
) -> pd.DataFrame:
    """A row for each strong motion and body.

    Parameters
    ----------
    motions : sequence of StrongMotion
        Of :func:`rockpulse.studies.rule.cases.strong_motions`.
    settings : CheckSettings, optional
        q and FC; FC is 1 without.
    progress : callable, optional
        Wraps the list of motions, as ``tqdm.tqdm`` does.

    Returns
    -------
    pandas.DataFrame
        `record`, `event`, `slenderness`, `radius` [m], `uplift_factor`, above which the record lifts the body,
        `factor_10` and `factor_50`, at which the body overturns with a probability of 0.1 and 0.5, and by the names of
        :data:`ALLOWED` the largest factor on the record that each check allows [-].
    """
    settings = CheckSettings(confidence_factor=1.0) if settings is None else settings
    frames = [_cases_of(one, settings) for one in (motions if progress is None else progress(motions))]
    columns = [*CODE_CASES]
    return pd.concat(frames, ignore_index=True)[columns] if frames else pd.DataFrame(columns=columns)


def check_rates(cases: pd.DataFrame, seed: int = 0) -> pd.DataFrame:
    """What each check misses and fails wrongly at each factor of :data:`LEVELS`, and over all of them (factor NaN).

    Parameters
    ----------
    cases : pandas.DataFrame
        Of :func:`check_cases`.
    seed : int
        Of the draws.

    Returns
    -------
    pandas.DataFrame
        `factor`, `check`, `overturned`, `standing`, `missed`, `missed_10` (that pass with a probability of 0.1 or
        more), `passed`, `passed_lifted` (that pass and lift off) and `false` cases, and `missed_share` and
        `false_share` with limits of 90 % over earthquakes; NaN for fewer than four of them.
    """
    levels, codes = np.array(LEVELS), pd.factorize(cases["event"])[0]
    falls, may_fall = (levels >= cases[name].to_numpy()[:, np.newaxis] for name in ("factor_50", "factor_10"))
    lifts = levels > cases["uplift_factor"].to_numpy()[:, np.newaxis]
    rows = []
    for name in ALLOWED:
        passes = cases[name].to_numpy()[:, np.newaxis] >= levels
        counts = np.stack([falls & passes, falls, ~falls & ~passes, ~falls])  # (4, cases, levels)
        of_passing = {"missed_10": may_fall & passes, "passed": passes, "passed_lifted": lifts & passes}
        for place, factor in enumerate((*LEVELS, np.nan)):
            part = slice(None) if place == levels.size else slice(place, place + 1)
            of_cases = counts[:, :, part].sum(axis=2)
            of_events = np.stack([np.bincount(codes, one) for one in of_cases])
            missed, overturned, false, standing = (int(one) for one in of_events.sum(axis=1))
            shares: dict[str, float] = {}
            for share, (top, bottom) in {"missed": (0, 1), "false": (2, 3)}.items():
                low, high = _interval(of_events[top], of_events[bottom], seed)
                total = of_events[bottom].sum()
                value = of_events[top].sum() / total if total else np.nan
                shares |= {f"{share}_share": value, f"{share}_low": low, f"{share}_high": high}
            rows.append(
                {
                    "factor": factor,
                    "check": name,
                    "overturned": overturned,
                    "standing": standing,
                    "missed": missed,
                    **{name: int(one[:, part].sum()) for name, one in of_passing.items()},
                    "false": false,
                    **shares,
                }
            )
    return pd.DataFrame(rows)


def _interval(top: np.ndarray, bottom: np.ndarray, seed: int) -> tuple[float, float]:
    """Limits of sum(top)/sum(bottom) over earthquakes; NaN for few, or a share of 0 or 1."""
    from scipy.stats import bootstrap

    if top.size < FEWEST or not 0.0 < top.sum() < bottom.sum():
        return np.nan, np.nan

    def share(above: np.ndarray, below: np.ndarray) -> float:
        total = float(np.sum(below))
        return float(np.sum(above)) / total if total else 0.0

    found = bootstrap(
        (top, bottom),
        share,
        paired=True,
        vectorized=False,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="BCa",
        rng=np.random.default_rng(seed),
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)


def check_study(cases: pd.DataFrame, settings: CheckSettings | None = None, seed: int = 0) -> xr.DataTree:
    """The cases of :func:`check_cases` with their rates and what they say, as a study that can be stored.

    Raises
    ------
    ValueError
        Without a case.
    """
    import xarray as xr

    if cases.empty:
        raise ValueError("cases: expected at least one strong motion, found none")
    settings = CheckSettings(confidence_factor=1.0) if settings is None else settings
    rates = check_rates(cases, seed)
    tree = xr.DataTree.from_dict(
        {
            "/code_check": xr.Dataset(with_values(CODE_CASES, {name: cases[name] for name in CODE_CASES})),
            "/rates": xr.Dataset(with_values(CODE_RATES, {name: rates[name] for name in CODE_RATES})),
            "/statements": _statements(rates),
        }
    )
    records, events = cases["record"].nunique(), cases["event"].nunique()
    tree.attrs |= {
        "kind": STUDY,
        "title": f"Checks of codes against time histories: {records} channels of {events} earthquakes, "
        f"{len(cases) // records} bodies, factors {', '.join(f'{one:g}' for one in LEVELS)}; q {settings.q:g}, FC "
        f"{settings.confidence_factor:g}",
    }
    return tree


def _statements(rates: pd.DataFrame) -> xr.Dataset:
    rows = []
    for one in rates[rates["factor"].isna()].to_dict("records"):
        name, words = one["check"], ALLOWED[one["check"]]
        overturned, missed, false = (one[what] for what in ("overturned", "missed", "false"))
        passed, failed = one["passed"], overturned - missed + false
        safe = _statement(f"{name}: safe", f"what passes {words} stands", passed, passed - missed)
        safe["numbers"] = (
            f"{safe['numbers']}; {one['passed_lifted']} of these lift off, {one['missed_10']} overturn with a "
            "probability of 10 % or more"
        )
        rows += [
            safe,
            _statement(f"{name}: not dear", f"what fails {words} overturns", failed, failed - false),
        ]
    values: dict[str, Any] = {name: (("statement",), [row[name] for row in rows]) for name in STATEMENTS}
    return described_set(values, {"statement": [row["statement"] for row in rows]}, STATEMENTS)


def _statement(name: str, words: str, cases: int, held: int) -> dict[str, object]:
    verdict = "not_examined" if not cases else "holds" if held == cases else "fails" if not held else "holds_in_part"
    return {
        "statement": name,
        "words": words,
        "verdict": VERDICTS.index(verdict),
        "cases": cases,
        "held": held,
        "where": "",
        "numbers": f"{held} of {cases} cases ({held / cases:.1%})" if cases else "",
    }
