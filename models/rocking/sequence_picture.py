"""What a terminal and a notebook show of an impulse sequence: its numbers, and two of its half-cycles.

.. note:: How long a half-cycle lasts, and with it the number of intermediate impulses, depends on the block. The
   picture shows the number that the sequence prescribes, four where it prescribes none.
"""

from __future__ import annotations

import math

import numpy as np

from rocking.quantities import Floats, Integers
from rocking.svg_lines import BLUE, GREY, RED, Picture, Shown, brief

__all__ = ["SequencePicture"]

#: Number of intermediate impulses in a half-cycle of the picture, and the most of them.
SHOWN, MOST = 4, 12

#: Place of the first intermediate impulse after the main one, in intervals.
FIRST = {"end": 1.0, "middle": 0.5, "start": 0.0, "open": 1.0}


class SequencePicture(Shown):
    """What an impulse sequence shows of itself."""

    main: Floats
    secondary: Floats
    interval: Floats
    duration: Floats
    main_count: Integers | None
    intermediate_count: int | None
    spacing: str

    def _facts(self) -> dict[str, str]:
        facts = {"of": f"{np.size(self.main)} sequences"} if np.ndim(self.main) else {}
        facts |= {"I": brief(self.main, "m/s"), "I_s": brief(self.secondary, "m/s")}
        if not np.all(np.isnan(self.interval)):
            facts["dT"] = brief(self.interval, "s")
        if self.intermediate_count is not None:
            facts["n"] = str(self.intermediate_count)
        facts["duration"] = brief(self.duration, "s")
        facts |= {} if self.main_count is None else {"main impulses": brief(self.main_count)}
        return facts | {"spacing": self.spacing}

    def two_half_cycles(self) -> tuple[np.ndarray, np.ndarray]:
        """The impulses of two half-cycles, the first of several sequences, as (k, 2) places and sizes.

        Places are in intervals after the first main impulse [-], sizes in m/s with the sign of the ground's change of
        velocity. The main impulses come first, then the intermediate ones: none of spacing "continuous".
        """
        main, secondary = float(np.ravel(self.main)[0]), float(np.ravel(self.secondary)[0])
        number = np.arange(min(self.intermediate_count or SHOWN, MOST))
        length = float(number.size + (self.spacing == "open"))
        mains = np.array([[0.0, main], [length, -main]])
        if secondary == 0.0 or self.spacing not in FIRST:
            return mains, np.empty((0, 2))
        # The first of them opposes the main impulse, then they alternate.
        own = np.column_stack([FIRST[self.spacing] + number, np.where(number % 2 == 0, -secondary, secondary)])
        return mains, np.concatenate([own, own * [1.0, -1.0] + [length, 0.0]])

    def _picture(self) -> Picture:
        """Two half-cycles of the sequence, the first of several."""
        mains, others = self.two_half_cycles()
        main, secondary = float(mains[0, 1]), float(np.ravel(self.secondary)[0])
        end, reach = 2.0 * float(mains[1, 0]), main or 1.0
        picture = Picture((-0.5, end + 0.5), (-1.2 * reach, 1.2 * reach))
        picture.line([-0.5, end + 0.5], [0.0, 0.0], GREY, 0.5)
        if secondary > 0.0 and not others.size:
            picture.polygon([0.0, end, end, 0.0], [-secondary, -secondary, secondary, secondary], BLUE)
        picture.stems(others[:, 0], others[:, 1], BLUE, 2.0)
        picture.stems(mains[:, 0], mains[:, 1], RED, 3.0)
        picture.words(f"I = {main:.3g} m/s", 0.15, 1.05 * reach, "start", RED)
        if secondary > 0.0:
            interval = float(np.ravel(self.interval)[0])
            every = "" if math.isnan(interval) or self.spacing == "continuous" else f" every {interval:.3g} s"
            picture.words(f"I_s = {secondary:.3g} m/s{every}", end, 1.05 * reach, "end", BLUE)
        return picture
