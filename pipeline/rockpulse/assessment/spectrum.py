"""The rocking spectrum of a record: how far blocks of all sizes and slendernesses rock (Makris & Konstantinidis 2003).

.. note:: Two blocks of equal p, alpha and C rock in the same way, whatever their mass: the spectrum is drawn over p and
   alpha. It stands beside the response spectrum of an oscillator, which says nothing about rocking.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from rocking.arguments import ArrayLike
from rocking.body.block import Block
from rocking.march.recorded import recorded_response
from rockpulse.record.record import STANDARD_GRAVITY, Record
from rockpulse.storage.variables.bodies import BLOCK, CASE
from rockpulse.storage.variables.summary import ANSWER

if TYPE_CHECKING:
    import xarray as xr


#: Default frequency parameters [1/s]: R from 7.4 m to 0.2 m.
P = tuple(np.linspace(1.0, 6.0, 101).round(10).tolist())

#: Default critical angles [rad]: slenderness from 20 to 2.4.
ALPHAS = tuple(np.linspace(0.05, 0.4, 71).round(10).tolist())

#: What the spectrum holds of each answer.
ANSWERED = ("peak_rotation_ratio", "outcome")


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
    """Largest rotation of blocks of every p and alpha under one record, by the nonlinear equation.

    Parameters
    ----------
    record : Record
        Conditioned.
    p : sequence of float, length a
        Frequency parameters [1/s].
    alpha : sequence of float, length b
        Critical angles [rad].
    restitution : float or "housner"
        Velocity ratio C of an impact; Housner's goes with alpha.
    scale : float
        Factor on the record [-].
    vertical : (n,) array_like, optional
        Vertical ground acceleration on the record's samples [m/s2].
    gravity : float
        At the blocks [m/s2].
    threads : int, optional
        Threads that share the blocks; None for all available cores. The answer does not depend on it.

    Returns
    -------
    xarray.Dataset
        `peak_rotation_ratio` (theta_max/alpha_c; inf overturned, 0 at rest, NaN unresolved) and `outcome` over
        (alpha_c, p), `restitution` over alpha_c, with units and long names; attributes `record`, `scale`, `gravity`.

    Raises
    ------
    ValueError
        For a p, alpha or restitution that no block has.

    References
    ----------
    Makris, N., Konstantinidis, D. (2003), Earthq. Eng. Struct. Dyn. 32(2), 265-289, doi:10.1002/eqe.223.

    Examples
    --------
    >>> sine = Record(3.0 * np.sin(2.0 * np.pi * np.arange(0.0, 1.005, 0.01)), dt=0.01, id="one sine")
    >>> spectrum = rocking_spectrum(sine, p=[1.0, 4.0], alpha=[0.1, 0.4])
    >>> spectrum["outcome"].values.tolist()
    [[1, 2], [0, 0]]
    """
    import xarray as xr

    rates, angles = np.asarray(p, dtype=float), np.asarray(alpha, dtype=float)
    grid = [values.ravel() for values in np.meshgrid(angles, rates, indexing="ij")]
    # The grid is no body of the user's, so no remark on one is logged.
    block = Block.from_parameters(p=grid[1], alpha=grid[0], restitution=restitution, gravity=gravity, log=False)
    response = recorded_response(block, record.acceleration, record.dt, scale=scale, vertical=vertical, threads=threads)
    shape, dims = (angles.size, rates.size), ("alpha_c", "p")
    restitutions = np.reshape(np.broadcast_to(block.restitution, grid[0].shape), shape)[:, 0]
    variables = {
        **{name: ANSWER[name].variable(np.reshape(getattr(response, name), shape), dims) for name in ANSWERED},
        "restitution": CASE["restitution"].variable(restitutions, ("alpha_c",)),
    }
    coords = {"alpha_c": BLOCK["alpha_c"].variable(angles, ("alpha_c",)), "p": BLOCK["p"].variable(rates, ("p",))}
    spectrum = xr.Dataset(variables, coords)
    spectrum.attrs.update(record=record.id, scale=float(scale), gravity=float(gravity))
    return spectrum
