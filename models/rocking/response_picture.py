"""What a terminal and a notebook show of a response: how it ends, and its rotation or the peaks of its lanes."""

from __future__ import annotations

import math

import numpy as np

from rocking.outcome import Outcome
from rocking.quantities import Booleans, Floats, Integers
from rocking.svg_lines import BLUE, GREY, INK, RED, Picture, Shown, brief, thinned

__all__ = ["ResponsePicture"]


#: Words and colours of the outcomes, in their order.
WORDS = np.array([outcome.word for outcome in Outcome])
COLOURS = (GREY, BLUE, RED, INK)

#: Lanes whose peaks are drawn, and the largest theta/alpha_c that is shown [-].
DRAWN, TOP = 200, 1.2


class ResponsePicture(Shown):
    """What a response says and shows of its outcomes."""

    peak_rotation_ratio: Floats
    outcome: Integers
    overturning_time: Floats
    impacts: Integers
    time: np.ndarray | None
    rotation: np.ndarray | None

    @property
    def overturned(self) -> Booleans:
        """Whether the block overturned; False where the outcome is UNRESOLVED."""
        found = np.asarray(self.outcome) == Outcome.OVERTURNS
        return bool(found) if found.ndim == 0 else found

    @property
    def outcome_name(self) -> str | np.ndarray:
        """The outcome in a word: "at_rest", "rocks", "overturns" or "unresolved"; an array of texts for several lanes.

        Examples
        --------
        >>> from rocking import Block, resonance
        >>> resonance(Block(width=0.5, height=2.0), [0.1, 1.0], half_cycles=2).outcome_name.tolist()
        ['rocks', 'overturns']
        """
        found = WORDS[np.asarray(self.outcome)]
        return str(found) if found.ndim == 0 else found

    def _facts(self) -> dict[str, str]:
        if np.ndim(self.outcome) == 0:
            by = "" if np.isnan(self.overturning_time) else f" by {float(self.overturning_time):.4g} s"
            facts = {"": f"{self.outcome_name}{by}"}
            peak = float(self.peak_rotation_ratio)
            facts |= {"peak": f"{peak:.4g} alpha_c"} if math.isfinite(peak) and peak > 0.0 else {}
            facts |= {} if int(self.impacts) < 0 else {"impacts": str(int(self.impacts))}
        else:
            codes = np.asarray(self.outcome)
            facts = {"of": f"{' x '.join(map(str, codes.shape))} lanes"}
            for outcome in Outcome:
                count = int(np.count_nonzero(codes == outcome))
                facts |= {outcome.word: str(count)} if count else {}
            moving = np.asarray(self.peak_rotation_ratio)[codes == Outcome.ROCKS]
            facts |= {"peak of those that rock": f"{brief(moving)} alpha_c"} if moving.size else {}
        return facts | ({} if self.time is None else {"history": f"of {self.time.size} samples"})

    def _picture(self) -> Picture:
        if self.time is None or self.rotation is None:
            return self._peaks()
        return self._history(self.time, self.rotation.reshape(-1, self.time.size)[0])

    def _history(self, time: np.ndarray, rotation: np.ndarray) -> Picture:
        """The rotation in time; of several lanes that of the first."""
        known = np.isfinite(rotation)
        x, y = thinned(time[known], rotation[known])
        reach = max(float(np.max(np.abs(y), initial=0.0)), 1e-12)
        picture = Picture((float(time[0]), float(time[-1])), (-reach, reach))
        picture.line([time[0], time[-1]], [0.0, 0.0], GREY, 0.5)
        picture.line(x, y, RED if bool(np.ravel(self.overturned)[0]) else BLUE)
        picture.words(f"{reach:.3g} rad", float(time[0]), reach, "start")
        picture.words(f"{time[-1]:.4g} s", float(time[-1]), -reach, "end")
        return picture

    def _peaks(self) -> Picture:
        """The peak of each lane as a bar, in the colour of its outcome; one that overturns reaches beyond alpha_c."""
        peaks, codes = np.ravel(self.peak_rotation_ratio)[:DRAWN], np.ravel(self.outcome)[:DRAWN]
        # A lane without a value has a stub, so that it is seen.
        heights = np.nan_to_num(np.minimum(peaks, TOP), nan=0.05)
        picture = Picture((-0.5, peaks.size - 0.5), (0.0, TOP), height=90.0)
        picture.line([-0.5, peaks.size - 0.5], [0.0, 0.0], GREY, 0.5)
        picture.line([-0.5, peaks.size - 0.5], [1.0, 1.0], GREY, 0.5, "4 3")
        picture.words("alpha_c", peaks.size - 0.5, 1.05, "end", GREY)
        for outcome, colour in zip(Outcome, COLOURS, strict=True):
            own = np.flatnonzero(codes == outcome)
            if own.size:
                picture.stems(own, np.maximum(heights[own], 0.01), colour, max(1.0, min(40.0, 250.0 / peaks.size)))
        return picture
