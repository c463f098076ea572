"""The code checks of the bodies of a configuration, compared with time histories of the same bodies."""

import math
import os
from collections.abc import Sequence

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, answers_of
from rockpulse.assessment.verdict import verdicts
from rockpulse.config import CODES
from rockpulse.config.block_settings import BlockSettings, FloorSettings
from rockpulse.config.configuration import Config, config_from_text, given_config
from rockpulse.config.study_settings import CheckSettings
from rockpulse.errors import ConfigError, ResultsError
from rockpulse.option import hint
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.hdf5.results_file import given_results
from rockpulse.storage.variables.risk import CHECK
from rockpulse.studies.check.code_spectra import DemandSpectrum, TableEnds, spectrum_of
from rockpulse.studies.check.codes import CHECKS, Checked, worst
from rockpulse.studies.check.mechanism import Mechanism, mechanisms

#: Settings of a body that the codes do not use.
NOT_OF_A_CODE = {"name", "restitution", "rebound", "facing", "azimuth", "friction", "confirm_size"}


def check(
    results: xr.DataTree | str | os.PathLike[str] | None = None,
    config: Config | str | os.PathLike[str] | None = None,
    code: str | Sequence[str] = CODES,
) -> xr.Dataset:
    """Check the bodies of a configuration according to codes, from their geometry and the demand of [check].

    Parameters
    ----------
    results : xarray.DataTree or path, optional
        Results of :func:`rockpulse.assess` for the same bodies, for comparison.
    config : Config or path, optional
        Configuration with [[block]] and [check]; by default from the results.
    code : str or sequence of str
        Codes to check: "circolare_2009", "circolare_2019", "en_1998".

    Returns
    -------
    xarray.Dataset
        Over (block): `multiplier` alpha_0 [-] and `share` e* [-]. Over (block, code): `activation` and
        `activation_demand` [m/s2] and their `activation_ratio`; `displacement` and `displacement_demand` [m], their
        `period` [s] and `displacement_ratio`; and `statement`, the reason for NaN. A ratio of 1 or more passes; it is
        for the worse direction of rotation, named in `activation_sense` and `displacement_sense`. If results are given,
        over (block), for the worst of several restitutions: `probability` of overturning; `factor_50`, the median over
        the records; and `beside`, the reason for NaN in these.

    Raises
    ------
    ConfigError
        If there are no bodies or no demand, or for an unknown code.
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
    codes = [code] if isinstance(code, str) else list(code)
    if unknown := [one for one in codes if one not in CHECKS]:
        raise ConfigError(f"code: expected some of {', '.join(CODES)}, found {unknown[0]!r}{hint(unknown[0], CODES)}")
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
    found: dict[str, tuple[Sequence[Mechanism], list[Checked]]] = {}
    for body in config.bodies:
        try:
            of_body = mechanisms(body)
        except ConfigError:
            raise
        except ValueError as error:
            found[body.name] = (), [Checked(statement=str(error))] * len(codes)
            continue
        for name, senses in of_body.items():
            found[name] = senses, [_checked(one, senses, spectrum, body.floors, config.check) for one in codes]
    names = list(found)
    weakest = [min(senses, key=lambda one: one.multiplier) if senses else None for senses, _ in found.values()]
    values = {
        **{name: np.array([getattr(one, name, math.nan) for one in weakest]) for name in ("multiplier", "share")},
        **({} if tree is None else history_results(tree, config, names)),
        **{
            name: np.array([[getattr(one, name) for one in row] for _, row in found.values()])
            for name in (*Checked._fields, "activation_ratio")
        },
    }
    factors = {name: config.check[name] for name in ("q", "confidence_factor", "q_a", "gamma_a")}
    return xr.Dataset(
        {name: CHECK[name].variable(values[name]) for name in CHECK if name in values},
        {"block": names, "code": list(codes)},
        {"spectrum": spectrum.words, "limit_state": config.check.limit_state, **factors},
    )


def _checked(
    code: str,
    senses: Sequence[Mechanism],
    spectrum: DemandSpectrum,
    floors: Sequence[FloorSettings],
    settings: CheckSettings,
) -> Checked:
    try:
        return worst([CHECKS[code](one, spectrum, floors, settings) for one in senses])
    except TableEnds as error:
        return Checked(statement=str(error))


def history_results(results: xr.DataTree, config: Config, names: Sequence[str]) -> dict[str, np.ndarray]:
    """Return `probability`, `factor_50` and `beside` (the reason for missing values) of m bodies, from the results."""
    answers = answers_of(results)
    assessed, checked = _bodies(config_from_text(str(results.attrs.get("configuration", "")))), _bodies(config)
    beside = [_why_not(name, answers, assessed.get(name), checked[name]) for name in names]
    probability, factor = np.full((2, len(names)), math.nan)
    if answers.probable:
        every, motions = verdicts(answers), answers.motions.over(answers["factor_50"], np.nan)
        for place, name in enumerate(names):
            lanes = [lane for lane, one in enumerate(every) if one.body.block == name]
            if beside[place] or not lanes:
                continue
            medians = [np.nanmedian(column) for column in motions.T[lanes] if not np.isnan(column).all()]
            factor[place] = min(medians, default=math.nan)
            probability[place] = np.fmax.reduce([every[lane].share.value for lane in lanes])
    return {"probability": probability, "factor_50": factor, "beside": np.array(beside, dtype=object)}


def _bodies(config: Config) -> dict[str, BlockSettings]:
    """Return the bodies of a configuration by name; a body with pedestals also has an entry for each pedestal."""
    return {name: body for body in config.bodies for name in (body.name, *body.with_pedestals())}


def _why_not(name: str, answers: Answers, there: BlockSettings | None, here: BlockSettings) -> str:
    if name not in answers.blocks:
        return "the results have no body of this name"
    if not answers.probable:
        return "the results contain no probability"
    if there is None:
        return "the results do not contain the geometry of their bodies"
    others = [key for key in sorted({*here.keys()} - NOT_OF_A_CODE) if here[key] != there[key]]
    differences = ", ".join(f"{key} {_short(there[key])} there, {_short(here[key])} here" for key in others)
    return f"the results have another body of this name ({differences})" if others else ""


def _short(value: object) -> str:
    return "none" if value is None or value == () else f"{value:g}" if isinstance(value, float) else "given"
