"""The overturning spectrum S(p, C), which is the effective impulse of a record on a block, and the rocking spectrum."""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
import xarray as xr

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.body.limits import RATES
from rocking.march.recorded import recorded_response
from rocking.spectrum.overturning import LEAST_SLENDERNESS, OverturningSpectrum, covered_range
from rocking.spectrum.probability import Uncertainty, factor_at, mean_capacity, rising
from rocking.spectrum.slender_lanes import SpectrumLanes, spectrum_lanes
from rockpulse.record.half_wave import half_waves
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.sequences.design_spectrum import at_blocks, within
from rockpulse.sequences.rule import load_rule
from rockpulse.storage.variables.bodies import BLOCK, CASE
from rockpulse.storage.variables.probability import AXIS_SIZES, LEVELS, RESTITUTIONS, ROTATIONS, SPECTRUM, SPECTRUM_AXES
from rockpulse.storage.variables.summary import ANSWER

#: Critical angle of the blocks that represent all slender blocks [rad]; capacity/(g tan(alpha)/p) is independent of it.
ALPHA = 0.1


#: Function that computes blocks at scale factors under a record, for each `method`; the rule can use known half-waves.
LANES: dict[str, Callable[..., SpectrumLanes]] = {
    "nonlinear": lambda record, rates=RATES, threads=None, waves=None, rotations=True: spectrum_lanes(
        record.acceleration, record.dt, rates, threads, rotations=rotations
    ),
    "rule": lambda record, rates=RATES, threads=None, waves=None, rotations=True: load_rule().spectrum_lanes(
        waves or half_waves(record), rates, threads, rotations=rotations
    ),
}


def overturning_spectrum(
    record: Record,
    p: Sequence[float] | np.ndarray = RATES,
    restitution: Sequence[float] | np.ndarray = RESTITUTIONS,
    method: Literal["nonlinear", "rule"] = "nonlinear",
    uncertainty: Uncertainty | None = None,
    threads: int | None = None,
    *,
    rotations: bool = True,
) -> xr.Dataset:
    """Compute the overturning spectrum of a record, with the probability of overturning.

    Parameters
    ----------
    record : Record
        Conditioned record, not all zeros.
    p : sequence of float, length a
        Frequency parameters [1/s], ascending.
    restitution : sequence of float, length c
        Nominal restitutions C [-], 0.75 to 1 with the default uncertainty.
    method : {"nonlinear", "rule"}
        The nonlinear equation, or the rule of :func:`rockpulse.load_rule`, which uses only the record's half-waves.
    uncertainty : Uncertainty, optional
        Uncertainty of scale factor, restitution and geometry; by default that of
        :class:`rockpulse.models.Uncertainty`. The rule accepts no other.
    threads : int, optional
        Threads that share the work; None for all available cores. The result does not depend on it.
    rotations : bool
        False to leave out `rotation_spectrum`, in about half the time.

    Returns
    -------
    xarray.Dataset
        `spectrum`, `spectrum_low`, `spectrum_high` [m/s] over (p, restitution), `probability` over (p, restitution,
        level) with the level, a scale factor divided by the mean capacity, and `rotation_spectrum` [m/s] over
        (rotation, p, restitution); attributes `record` and `method`.

    Raises
    ------
    ValueError
        For an unknown method, a record of zeros, or a p or restitution that the method does not cover.

    References
    ----------
    Dimitrakopoulos, E. G., DeJong, M. J. (2012), Proc. R. Soc. A 468(2144), doi:10.1098/rspa.2012.0026 (similarity of
    slender blocks).

    Examples
    --------
    >>> spectrum = overturning_spectrum(record, p=[1.5, 1.7, 1.9], restitution=[0.9])
    >>> dict(spectrum.sizes)
    {'p': 3, 'restitution': 1, 'rotation': 4, 'level': 65}
    """
    rates, nominal = np.atleast_1d(np.asarray(p, dtype=float)), np.atleast_1d(np.asarray(restitution, dtype=float))
    if method not in LANES:
        raise ValueError(f"method: expected one of {', '.join(LANES)}, got {method!r}")
    if method == "rule" and uncertainty not in (None, Uncertainty()):
        raise ValueError("uncertainty: method 'rule' was fitted with the default, and accepts no other; leave it out")
    lanes = LANES[method](record, rates, threads, rotations=rotations)
    values = stored_spectrum_values(OverturningSpectrum(lanes, uncertainty), nominal)
    axes = {"p": rates, "restitution": nominal, "level": LEVELS, "rotation": ROTATIONS}
    found = xr.Dataset(
        {name: SPECTRUM[name].variable(array) for name, array in values.items()},
        {name: SPECTRUM_AXES[name].variable(array) for name, array in axes.items()},
    )
    found.attrs.update(record=record.id, method=method)
    return found if rotations else found.drop_dims("rotation")


def stored_spectrum_values(
    spectrum: OverturningSpectrum, restitution: np.ndarray = RESTITUTIONS
) -> dict[str, np.ndarray]:
    """Return the arrays of a spectrum that a file stores, by name of the variable, at nominal restitutions.

    `rotation_spectrum` is NaN if the spectrum was computed without rotations.
    """
    if np.any(outside := ~covered_range(restitution, spectrum.uncertainty, spectrum.lanes.between)):
        # The spectrum covers neither wide ranges around a low C, nor narrow ranges.
        sizes = {**AXIS_SIZES, "p": spectrum.p.size, "restitution": restitution.size}
        found = {name: np.full([sizes[dim] for dim in one.dims], np.nan) for name, one in SPECTRUM.items()}
        if not np.all(outside):
            for name, inner in stored_spectrum_values(spectrum, restitution[~outside]).items():
                axis = SPECTRUM[name].dims.index("restitution")
                np.moveaxis(found[name], axis, 0)[~outside] = np.moveaxis(inner, axis, 0)
        return found
    shape = (spectrum.p.size, restitution.size)
    rates, nominal = (values.ravel() for values in np.meshgrid(spectrum.p, restitution, indexing="ij"))
    blocks = Block.from_parameters(p=rates, alpha=ALPHA, restitution=nominal, log=False)
    speed = blocks.gravity * np.tan(ALPHA) / rates
    read = spectrum.factors(blocks)
    capacity = (speed / read.factor_mean).reshape(shape)
    marched = [] if np.any(np.isnan(spectrum.lanes.peak)) else [*ROTATIONS]
    states = spectrum.probability(restitution, [*marched, np.inf])
    rotation = np.full((len(ROTATIONS), *shape), np.nan)
    rotation[: len(marched)] = 1.0 / mean_capacity(spectrum.level, states[:-1])
    levels = zip(capacity.ravel(), states[-1].reshape(-1, spectrum.level.size), strict=True)
    logs, relative = np.log(spectrum.level), np.log(LEVELS)
    return {
        "spectrum": capacity,
        "spectrum_low": (speed / read.factor_mean_high).reshape(shape),
        "spectrum_high": (speed / read.factor_mean_low).reshape(shape),
        "rotation_spectrum": rotation,
        "probability": np.reshape(
            [np.interp(relative - np.log(value), logs, row) for value, row in levels], (*shape, LEVELS.size)
        ),
    }


def overturning_factors(spectrum: xr.Dataset, block: Block) -> dict[str, np.ndarray]:
    """Read the probability of overturning of blocks, and their scale factors, from an overturning spectrum.

    Parameters
    ----------
    spectrum : xarray.Dataset
        Result of :func:`overturning_spectrum`, or one record of /spectra of a results file.
    block : Block
        One block (then m = 1), or m blocks; slender, free-standing, inside the p and C of the spectrum.

    Returns
    -------
    dict of str to (m,) ndarray
        `overturning_probability` under the unscaled record, `factor_10`, `factor_50` and `factor_mean` [-], named as
        in /summary. ln S and P are linear in ln p and in C between the values of the spectrum.

    Raises
    ------
    ValueError
        For a block outside the spectrum.

    Examples
    --------
    >>> spectrum = overturning_spectrum(record, p=[1.8, 2.0], restitution=[0.85, 0.9])
    >>> read = overturning_factors(spectrum, Block(half_width=0.5, half_height=1.9365, restitution=0.9))
    >>> bool(read["factor_10"][0] < read["factor_50"][0])
    True
    """
    block, level = block.lanes(), spectrum["level"].values
    axes = spectrum["p"].values, spectrum["restitution"].values
    inside = within(block, *axes)
    if not np.all(inside):
        raise ValueError(
            f"block: the spectrum covers free blocks of slenderness {LEAST_SLENDERNESS:g} or more within its ranges of "
            f"p and C, but not {np.count_nonzero(~inside)} of {inside.size} blocks, the first at index "
            f"{int(np.argmin(inside))}"
        )
    speed = block.gravity * np.tan(block.alpha_c) / block.p
    capacity = speed / np.exp(at_blocks(block, *axes, np.log(spectrum["spectrum"].values)))
    probability = at_blocks(block, *axes, spectrum["probability"].values)  # at `level` times the mean capacity
    fitted = rising(probability)
    at_one = [np.interp(-np.log(one), np.log(level), row) for one, row in zip(capacity, probability, strict=True)]
    return {
        "overturning_probability": np.array(at_one),
        "factor_10": factor_at(0.1, level, fitted) * capacity,
        "factor_50": factor_at(0.5, level, fitted) * capacity,
        "factor_mean": capacity,
    }


#: Default frequency parameters [1/s] (R from 7.4 m to 0.2 m) and critical angles [rad] (slenderness from 20 to 2.4).
P = tuple(np.linspace(1.0, 6.0, 101).round(10).tolist())
ALPHAS = tuple(np.linspace(0.05, 0.4, 71).round(10).tolist())


def rocking_spectrum(
    record: Record,
    p: Sequence[float] = P,
    alpha: Sequence[float] = ALPHAS,
    restitution: float | Literal["housner"] = "housner",
    scale: float = 1.0,
    vertical: ArrayLike | None = None,
    gravity: float = STANDARD_GRAVITY,
    threads: int | None = None,
) -> xr.Dataset:
    """Compute the largest rotation of blocks of every p and alpha under one record, from the nonlinear equation.

    Parameters
    ----------
    record : Record
        Conditioned record.
    p : sequence of float, length a
        Frequency parameters [1/s].
    alpha : sequence of float, length b
        Critical angles [rad].
    restitution : float or "housner"
        Velocity ratio C of an impact; "housner" depends on alpha.
    scale : float
        Scale factor on the record [-].
    vertical : (n,) array_like, optional
        Vertical ground acceleration on the record's samples [m/s2].
    gravity : float
        Acceleration of gravity at the blocks [m/s2].
    threads : int, optional
        Threads that share the blocks; None for all available cores. The result does not depend on it.

    Returns
    -------
    xarray.Dataset
        `peak_rotation_ratio` (theta_max/alpha_c; inf if overturned, 0 at rest, NaN if unresolved) and `outcome` over
        (alpha_c, p), `restitution` over alpha_c, with units and long names; attributes `record`, `scale`, `gravity`.

    Raises
    ------
    ValueError
        For a p, alpha or restitution that no block can have.

    References
    ----------
    Makris, N., Konstantinidis, D. (2003), Earthq. Eng. Struct. Dyn. 32(2), 265-289, doi:10.1002/eqe.223.

    Examples
    --------
    >>> spectrum = rocking_spectrum(record, p=[1.0, 4.0], alpha=[0.1, 0.4])
    >>> spectrum["outcome"].values.tolist()
    [[1, 2], [0, 0]]
    """
    rates, angles = np.asarray(p, dtype=float), np.asarray(alpha, dtype=float)
    grid = [values.ravel() for values in np.meshgrid(angles, rates, indexing="ij")]
    # The blocks of the grid are not the user's bodies, so their warnings are not logged.
    block = Block.from_parameters(p=grid[1], alpha=grid[0], restitution=restitution, gravity=gravity, log=False)
    response = recorded_response(block, record.acceleration, record.dt, scale=scale, vertical=vertical, threads=threads)
    shape, dims = (angles.size, rates.size), ("alpha_c", "p")
    restitutions = np.reshape(np.broadcast_to(block.restitution, grid[0].shape), shape)[:, 0]
    answers = {name: np.reshape(getattr(response, name), shape) for name in ("peak_rotation_ratio", "outcome")}
    variables = {name: ANSWER[name].variable(values, dims) for name, values in answers.items()}
    variables["restitution"] = CASE["restitution"].variable(restitutions, ("alpha_c",))
    coords = {"alpha_c": BLOCK["alpha_c"].variable(angles, ("alpha_c",)), "p": BLOCK["p"].variable(rates, ("p",))}
    spectrum = xr.Dataset(variables, coords)
    spectrum.attrs.update(record=record.id, scale=float(scale), gravity=float(gravity))
    return spectrum
