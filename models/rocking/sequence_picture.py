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

    def _picture(self) -> Picture:
        """Two half-cycles of the sequence, the first of several."""
        main, secondary = float(np.ravel(self.main)[0]), float(np.ravel(self.secondary)[0])
        count = min(self.intermediate_count or SHOWN, MOST)
        end = float(count + (self.spacing == "open"))
        reach = max(main, 1e-12)
        picture = Picture((-0.5, 2.0 * end + 0.5), (-1.2 * reach, 1.2 * reach))
        picture.line([-0.5, 2.0 * end + 0.5], [0.0, 0.0], GREY, 0.5)
        for half, sign in ((0, 1.0), (1, -1.0)):
            start = half * end
            if self.spacing in FIRST and secondary > 0.0:
                number = np.arange(count)
                # The first of them opposes the main impulse, then they alternate.
                sizes = sign * secondary * np.where(number % 2 == 0, -1.0, 1.0)
                picture.stems(start + FIRST[self.spacing] + number, sizes, BLUE, 2.0)
            elif secondary > 0.0:
                low, high = -secondary, secondary
                picture.polygon([start, start + end, start + end, start], [low, low, high, high], BLUE)
            picture.stems(start, sign * main, RED, 3.0)
        picture.words(f"I = {main:.3g} m/s", 0.15, 1.05 * main, "start", RED)
        if secondary > 0.0:
            interval = float(np.ravel(self.interval)[0])
            every = "" if math.isnan(interval) or self.spacing == "continuous" else f" every {interval:.3g} s"
            picture.words(f"I_s = {secondary:.3g} m/s{every}", 2.0 * end, 1.05 * main, "end", BLUE)
        return picture
