"""Spectra that many bodies share under one record, so that each of them needs no samples of its own."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from rocking.body.block import Block
from rocking.spectrum.overturning import covered
from rocking.spectrum.probability import Uncertainty
from rocking.spectrum.slender_lanes import FIRST, LEAST_RESTITUTION, RATES, REBOUNDS, upper_end

#: A shared spectrum (docs/decisions/018): its frequency parameters [1/s], smallest number of bodies,
#: and the model error as a standard deviation of ln f [-].
SHARED_RATES = np.geomspace(RATES[0], RATES[-1], 47)
FEWEST_SHARING, SHARED_INTERPOLATION = 64, 0.005
#: Sides of the bodies that share a spectrum, and the range of C that it covers: a body uses the first that
#: covers it and that enough bodies share.
SHARED_RANGES = ((0, (0.84, 1.0)), (0, (LEAST_RESTITUTION, 1.0)), (1, REBOUNDS), (-1, REBOUNDS))


def shared_groups(
    block: Block, uncertainty: Uncertainty, own: int, density: float
) -> Iterator[tuple[np.ndarray, dict[str, Any]]]:
    """Yield the indices of blocks that share a spectrum, and the arguments of :func:`spectrum_lanes` for this spectrum.

    Without a spectrum each block needs `own` samples; a spectrum has `density` samples per unit of C in the second
    stage at each frequency parameter. A group is omitted if it has
    fewer than FEWEST_SHARING blocks, or if sharing a spectrum would not reduce the number of samples.
    """
    rest = np.ones(block.shape, dtype=bool)
    for side, between in SHARED_RANGES:
        inside = np.flatnonzero(rest & covered(block, uncertainty, side=side, between=between))
        p, second = np.asarray(block.weaker.p)[inside], round(density * (upper_end(between) - between[0]))
        above = np.clip(np.searchsorted(SHARED_RATES, p), 1, SHARED_RATES.size - 1)
        places = np.union1d(above - 1, above)
        if inside.size >= FEWEST_SHARING and places.size * (FIRST + second) < inside.size * own:
            rest[inside] = False
            random = np.multiply.outer(uncertainty.restitution, np.asarray(block.restitution)[inside])
            needed = max(float(np.min(random)), between[0]), min(float(np.max(random)), between[1])
            limits = {"between": between, "needed": needed}
            yield inside, {"p": SHARED_RATES[places], "side": side, "second": second, **limits}
