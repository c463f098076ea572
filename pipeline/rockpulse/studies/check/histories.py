"""What time histories say of the bodies that a code checks: P and f_50 of the same bodies in a file of results."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import BodyVerdict, verdicts
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import Config, config_from_text

if TYPE_CHECKING:
    import xarray as xr


#: Settings of a body that no code asks for: with others it is still the same body.
NOT_OF_A_CODE = {"name", "restitution", "rebound", "facing", "azimuth", "friction", "confirm_size"}


def of_histories(results: xr.DataTree, config: Config, names: Sequence[str]) -> dict[str, np.ndarray]:
    """`probability`, `factor_50` and `beside`, why they are NaN, of the bodies of these names, (m,) each.

    The probability is that which the verdict rests on: under the records brought to the demands of the site where
    there are some. A body whose geometry, restraints or floors are others in the results than in the configuration is
    another body.
    """
    answers = answers_of(results)
    assessed = dict(_bodies(config_from_text(str(results.attrs.get("configuration", "")))))
    checked = dict(_bodies(config))
    beside = [_why_not(name, answers, assessed.get(name), checked[name]) for name in names]
    probability, factor = np.full((2, len(names)), math.nan)
    if answers.probable:
        every, median = verdicts(answers), _median_factors(answers)
        for place, name in enumerate(names):
            lanes = [lane for lane, one in enumerate(every) if one.body.block == name]
            if beside[place] or not lanes:
                continue
            factor[place] = np.fmin.reduce(median[lanes])
            if few := [one for one in (every[lane].deciding for lane in lanes) if one is not None and one.few]:
                beside[place] = f"records of {few[0].earthquakes} earthquakes can be brought to {few[0].name}: no P"
            else:
                probability[place] = np.fmax.reduce([_probability(every[lane]) for lane in lanes])
    return {"probability": probability, "factor_50": factor, "beside": np.array(beside, dtype=object)}


def _probability(verdict: BodyVerdict) -> float:
    return verdict.decides.value


def _median_factors(answers: Answers) -> np.ndarray:
    """The median of f_50 over the motions, of every body [-]; NaN without one."""
    found = np.full(len(answers.bodies), math.nan)
    for lane, column in enumerate(answers.motions.over(answers["factor_50"], np.nan).T):
        known = column[~np.isnan(column)]
        found[lane] = np.median(known) if known.size else math.nan
    return found


def _bodies(config: Config) -> Iterator[tuple[str, BlockSettings]]:
    """The bodies of a configuration by their names, also as one with their pedestals."""
    for body in config.blocks:
        yield body.name, body
        for name in body.with_pedestals():
            yield name, body


def _why_not(name: str, answers: Answers, there: BlockSettings | None, here: BlockSettings) -> str:
    if name not in answers.blocks:
        return "the results have no body of this name"
    if not answers.probable:
        return "the results hold no probability"
    if there is None:
        return "the results do not tell the geometry of their bodies"
    others = [key for key in sorted({*here.keys()} - NOT_OF_A_CODE) if here[key] != there[key]]
    if not others:
        return ""
    told = ", ".join(f"{key} {_short(there[key])} there, {_short(here[key])} here" for key in others)
    return f"the results have another body of this name ({told})"


def _short(value: object) -> str:
    return "none" if value is None or value == () else f"{value:g}" if isinstance(value, float) else "given"
