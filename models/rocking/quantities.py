"""Types of the quantities that models take and give: a number for one lane, an array for several.

.. note:: A lane is one block under one factor on the input. What models take is anything that numpy makes a number or
   an array of; what they give is a Python number where the caller gave scalars, else an array of the lanes' shape.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["ArrayLike", "Booleans", "Floats", "Integers"]

#: A number for one lane, an array of them for several.
Floats: TypeAlias = float | NDArray[np.float64]
Integers: TypeAlias = int | NDArray[np.integer[Any]]
Booleans: TypeAlias = bool | NDArray[np.bool_]
