"""Code checks of the bodies of a configuration, and of the largest rotations in results.

.. note:: Circolare 7/2019, C8.7.1.2.1.9 (nonlinear dynamic analysis): no displacement exceeds d_0, and the mean of the
   largest displacements does not exceed d_SLV or d_SLC of C8.7.1.2.1.6. NTC 2018, 7.3.5, and EN 1998-1, 4.3.3.4.3: the
   mean is used with seven records or more, and the most unfavourable value with three to six; fewer are not sufficient
   (EN 1998-1, 3.2.3.1.2). The rotation |theta|/alpha_c is converted to the displacement d = (|theta|/alpha_c)
   tan(alpha_c) L, with the ratio L of spectral displacement to rotation, so that a free body reaches d_0 at alpha_c.
"""

import math
import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import nominal_motion, too_far, verdicts, weak
from rockpulse.config import CODES
from rockpulse.config.block_settings import BlockSettings
from rockpulse.config.configuration import Config, config_from_text, given_config
from rockpulse.config.restraint_settings import FloorSettings
from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.option import hint
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.hdf5.results_file import given_results
from rockpulse.storage.variables.risk import CHECK
from rockpulse.studies.check.code_spectra import DemandSpectrum, TableEnds, spectrum_of
from rockpulse.studies.check.codes import CHECKS, STATES, Checked, allowed_displacement, worst
from rockpulse.studies.check.mechanism import Mechanism, mechanisms

#: Smallest number of records for a check, and smallest number of records of which the mean is used.
FEWEST, FOR_MEAN = 3, 7


class Rotations(NamedTuple):
    """The largest rotations of a body, divided by alpha_c, under the records scaled to a demand."""

    records: int  #: number of records; a pair of channels counts once, with its worst direction
    unknown: int  #: number of records under which the rotation is unknown
    compared: float  #: mean, or with few records the largest [-]; inf if one overturns the body, NaN if unknown
    largest: float  #: largest over the records [-]


def rotations_of(peaks: np.ndarray) -> Rotations:
    """Return the rotations to compare with the limits, from the largest |theta|/alpha_c under each record (n,).

    Examples
    --------
    >>> rotations_of(np.array([0.1, 0.2, 0.6]))
    Rotations(records=3, unknown=0, compared=0.6, largest=0.6)
    """
    unknown, overturns = int(np.isnan(peaks).sum()), bool(np.isinf(peaks).any())
    largest = math.inf if overturns else float(peaks.max(initial=-math.inf)) if peaks.size else math.nan
    if peaks.size < FEWEST:
        return Rotations(peaks.size, unknown, math.nan, largest)
    mean = peaks.size >= FOR_MEAN and not overturns
    return Rotations(peaks.size, unknown, float(peaks.mean()) if mean else largest, largest)


def rotations_at(answers: Answers, demand: str) -> dict[str, Rotations]:
    """Return the rotations of each body at a demand; of several restitutions, the worst one is used."""
    motions, far = answers.motions, too_far(answers, demand)
    kept = motions.kept(far | weak(answers, demand)[:, np.newaxis])
    fallen, rotation = nominal_motion(answers, demand)
    peaks = motions.over(np.where(far, -np.inf, np.where(fallen, np.inf, rotation)), -np.inf).max(axis=1)
    peaks[motions.in_any_direction(fallen & ~far)] = np.inf
    found: dict[str, Rotations] = {}
    for lane, body in enumerate(answers.bodies):
        one = rotations_of(peaks[kept[:, lane], lane])
        if body.block not in found or one.compared > found[body.block].compared or math.isnan(one.compared):
            found[body.block] = one
    return found


def check_records(
    senses: Sequence[Mechanism],
    rotations: Rotations,
    limit_state: str,
    rule: str,
    assessed: Sequence[Mechanism] | None = None,
) -> Checked:
    """Check the rotations of a body according to C8.7.1.2.1.9; the worse direction of rotation determines the result.

    The limits are those of the mechanisms `senses`, one for each direction of rotation. `assessed` are the mechanisms
    whose rotations were computed, by default `senses`. `rule` is the clause on the number of records, for messages.
    """
    statement = ""
    if rotations.records < FEWEST:
        statement = f"{rotations.records} records at the demand, but {rule} requires three or more"
    elif math.isnan(rotations.compared):
        statement = f"{rotations.unknown} of {rotations.records} records have no rotation at the demand"
    every = zip(senses, senses if assessed is None else assessed, strict=True)
    return worst([_checked(one, of, rotations, limit_state) for one, of in every])._replace(
        records=rotations.records, statement=statement, activation_sense=""
    )


def _checked(body: Mechanism, assessed: Mechanism, rotations: Rotations, limit_state: str) -> Checked:
    allowed, unit = allowed_displacement(body, limit_state), assessed.slope * assessed.lever
    demand = rotations.compared * unit
    if math.isnan(demand):
        return Checked(displacement=allowed)
    ratios = (
        math.inf if moved == 0.0 else limit / moved
        for limit, moved in ((allowed, demand), (body.collapse_displacement, rotations.largest * unit))
    )
    return Checked(displacement=allowed, displacement_demand=demand, displacement_ratio=min(ratios))


#: Settings in which checked and assessed bodies may differ, as the codes or the time histories do not use them.
NOT_SHARED = {"name", "restitution", "rebound", "facing", "azimuth", "friction", "confirm_size"}
NOT_SHARED |= {"elastic_modulus", "kappa"}
UNLIMITED = "a tie has no ultimate elongation: its displacement at break is unknown, and d_0 is computed without ties"
#: The code that uses the rotations of the results, and the code that is checked only if it is named.
RECORDS, FRAME = "circolare_2019_records", "circolare_2019_frame"


def check(
    results: xr.DataTree | str | os.PathLike[str] | None = None,
    config: Config | str | os.PathLike[str] | None = None,
    code: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Check the bodies of a configuration according to codes, from their geometry and the demand of [check].

    Parameters
    ----------
    results : xarray.DataTree or path, optional
        Results of :func:`rockpulse.assess` for the same bodies, for comparison and for the check of the rotations under
        the records at each [[demand]] (C8.7.1.2.1.9).
    config : Config or path, optional
        Configuration with [[block]] and [check]; by default from the results.
    code : str or sequence of str, optional
        Codes to check: "circolare_2009", "circolare_2019", "en_1998", "circolare_2019_records" (for results with a
        demand) and "circolare_2019_frame" (formula C7.2.11, elements of framed buildings; only if named).

    Returns
    -------
    xarray.Dataset
        Over (block): `multiplier` alpha_0 [-], `share` e* [-] and `initial_period` T_0 [s], 0 if the body is rigid
        until its mechanism opens. Over (block, code): `records`, the number of records; `activation` and
        `activation_demand` [m/s2] and their `activation_ratio`; `displacement` and `displacement_demand` [m], their
        `period` [s] and `displacement_ratio`; and `statement`, the reason for NaN. A ratio of 1 or more passes. Ratios
        are for the worse direction of rotation, named in `activation_sense` and `displacement_sense`. The code
        "circolare_2019_records" has two columns, "records_slv" and "records_slc", followed by the name of the demand if
        there are several. If results are given, over (block), for the worst of several restitutions: `probability` of
        overturning; `factor_50`, the median over the records of the scale factor at P = 50 % (of a pair of channels, in
        the direction where it is smallest); and `beside`, the reason if these two are NaN.

    Raises
    ------
    ConfigError
        If there are no bodies or no demand, for an unknown code, or for "circolare_2019_records" without results at a
        demand.
    ResultsError
        For results of another kind.

    Examples
    --------
    >>> wall = rp.BlockSettings(name="wall", width=0.4, height=4.0)
    >>> config = rp.Config(bodies=(wall,), check=rp.CheckSettings(spectrum="en_1998_1", ag=0.15, confidence_factor=1.0))
    >>> found = check(config=config, code="circolare_2009")
    >>> [round(found[name].item(), 3) for name in ("multiplier", "activation_ratio", "period", "displacement_ratio")]
    [0.1, 1.333, 1.238, 1.734]
    """
    codes = [code] if isinstance(code, str) else [one for one in CODES if one != FRAME] if code is None else list(code)
    if unknown := [one for one in codes if one not in CODES]:
        raise ConfigError(f"code: expected one of {', '.join(CODES)}, found {unknown[0]!r}{hint(unknown[0], CODES)}")
    if isinstance(results, Config):
        raise ConfigError("results: expected the results of assess, found a Config; give it as config=")
    if results is None and config is None:
        raise ConfigError("expected a results file or --config with the bodies and a section [check], found none")
    tree = None if results is None else given_results(results)
    if tree is not None and (kind := str(tree.attrs.get("kind", ASSESSMENT))) != ASSESSMENT:
        name = "results" if isinstance(results, xr.DataTree) else results
        raise ResultsError(f"{name}: expected {kind_in_words(ASSESSMENT)}, found {kind_in_words(kind)}")
    stored = "" if tree is None else str(tree.attrs.get("configuration", ""))
    config = config_from_text(stored) if config is None else given_config(config)
    if not config.bodies:
        raise ConfigError("no body to check: give [[block]] entries in the configuration")
    spectrum = spectrum_of(config.check, config.folder)
    answers = None if tree is None else answers_of(tree)
    rule = "EN 1998-1, 4.3.3.4.3" if config.check.spectrum.startswith("en_1998") else "NTC 2018, 7.3.5"
    found = _mechanisms(config, config.check.confidence_factor)
    others = {} if answers is None else _others(answers, stored, config)
    columns = {
        one: [_by_code(one, *own, spectrum, config.check) for own in found.values()] for one in codes if one != RECORDS
    }
    if RECORDS in codes:
        of_records = {} if answers is None else _of_records(answers, found, _mechanisms(config), others, rule)
        if code is not None and not of_records:
            raise ConfigError(f"code {RECORDS}: expected results with a [[demand]], found none; assess with --demand")
        columns |= of_records
    weakest = [min(senses, key=lambda one: one.multiplier) if senses else None for senses, _, _ in found.values()]
    of_body = ("multiplier", "share", "initial_period")
    values = {
        **{name: np.array([getattr(one, name, math.nan) for one in weakest]) for name in of_body},
        **({} if answers is None else history_results(answers, others)),
        **{
            name: np.array([[getattr(one, name) for one in row] for row in zip(*columns.values(), strict=True)])
            for name in (*Checked._fields, "activation_ratio")
        },
    }
    factors = {name: config.check[name] for name in ("q", "confidence_factor", "q_a", "gamma_a")}
    return xr.Dataset(
        {name: CHECK[name].variable(values[name]) for name in CHECK if name in values},
        {"block": list(found), "code": list(columns)},
        {"spectrum": spectrum.words, "limit_state": config.check.limit_state, "rule": rule, **factors},
    )


#: For each body, by name: its mechanisms, the reason why it has none, and the floors below it.
_Mechanisms: TypeAlias = Mapping[str, tuple[Sequence[Mechanism], str, Sequence[FloorSettings]]]


def _mechanisms(config: Config, confidence_factor: float = 1.0) -> _Mechanisms:
    """Return the mechanisms of all bodies, whose compressive strength is divided by the confidence factor."""
    found: dict[str, tuple[Sequence[Mechanism], str, Sequence[FloorSettings]]] = {}
    for body in config.bodies:
        try:
            own = mechanisms(body, confidence_factor)
            found |= {name: (senses, "", body.floors) for name, senses in own.items()}
        except ConfigError:
            raise
        except ValueError as error:
            found[body.name] = (), str(error), ()
    return found


def _by_code(
    code: str,
    senses: Sequence[Mechanism],
    why: str,
    floors: Sequence[FloorSettings],
    spectrum: DemandSpectrum,
    settings: CheckSettings,
) -> Checked:
    if why:
        return Checked(statement=why)
    try:
        found = worst([CHECKS[code](one, spectrum, floors, settings) for one in senses])
        if not math.isnan(found.displacement) and any(one.unlimited for one in senses):
            found = found._replace(statement="; ".join(filter(None, (found.statement, UNLIMITED))))
        return found
    except TableEnds as error:
        return Checked(statement=str(error))


def _of_records(
    answers: Answers, found: _Mechanisms, assessed: _Mechanisms, others: Mapping[str, str], rule: str
) -> dict[str, list[Checked]]:
    """Return the checks of the rotations of all bodies, by column; each demand and limit state has its own column.

    A demand whose name contains SLV or SLC is checked only for this limit state. The limits are those of the mechanisms
    `found`. The rotations are those of `assessed`, whose strength is not divided by the confidence factor.
    """
    columns: dict[str, list[Checked]] = {}
    for demand in answers.demands:
        rotations = rotations_at(answers, demand)
        for state in [one for one in STATES if one in demand.lower()] or STATES:
            columns[f"records_{state}" + f", {demand}" * (len(answers.demands) > 1)] = [
                Checked(statement=why or others[name])
                if why or others[name]
                else check_records(senses, rotations[name], state, rule, assessed[name][0])
                for name, (senses, why, _) in found.items()
            ]
    return columns


def history_results(answers: Answers, others: Mapping[str, str]) -> dict[str, np.ndarray]:
    """Return `probability`, `factor_50` and `beside` (the reason if these two are NaN) of m bodies, from the results.

    `others` states for each body why the results describe a different body; the text is empty for the same body.
    """
    beside = [why or ("" if answers.probable else "the results contain no probability") for why in others.values()]
    probability, factor = np.full((2, len(beside)), math.nan)
    if answers.probable:
        every = verdicts(answers)
        motions = np.fmin.reduce(answers.motions.over(answers["factor_50"], np.nan), axis=1)  # weakest direction
        for place, name in enumerate(others):
            lanes = [lane for lane, one in enumerate(every) if one.body.block == name]
            if beside[place] or not lanes:
                continue
            medians = [np.nanmedian(column) for column in motions.T[lanes] if not np.isnan(column).all()]
            factor[place] = min(medians, default=math.nan)
            probability[place] = np.fmax.reduce([every[lane].share.value for lane in lanes])
    return {"probability": probability, "factor_50": factor, "beside": np.array(beside, dtype=object)}


def _bodies(config: Config) -> dict[str, BlockSettings]:
    """Return the bodies of a configuration by name; a body with pedestals has an additional entry for each pedestal."""
    return {name: body for body in config.bodies for name in (body.name, *body.with_pedestals())}


def _others(answers: Answers, stored: str, config: Config) -> dict[str, str]:
    """Return, for each body of a configuration, why the results describe a different body; empty for the same body."""
    assessed = _bodies(config_from_text(stored))
    return {name: _why_not(name, answers, assessed.get(name), body) for name, body in _bodies(config).items()}


def _why_not(name: str, answers: Answers, there: BlockSettings | None, here: BlockSettings) -> str:
    if name not in answers.blocks:
        return "the results have no body of this name"
    if there is None:
        return "the results do not contain the geometry of their bodies"
    others = [key for key in sorted({*here.keys()} - NOT_SHARED) if here[key] != there[key]]
    differences = ", ".join(f"{key} {_short(there[key])} there, {_short(here[key])} here" for key in others)
    return f"the results have another body of this name ({differences})" if others else ""


def _short(value: object) -> str:
    return "none" if value is None or value == () else f"{value:g}" if isinstance(value, float) else "given"
