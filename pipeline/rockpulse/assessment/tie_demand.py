"""Forces and elongations of the ties of every body under the records scaled to a demand."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rocking.body.restraint import Restraints, Tie, TieState
from rockpulse.assessment.answers import Answers, Body
from rockpulse.assessment.verdict import BodyVerdict, too_far, weak


class TieFinding(NamedTuple):
    """The results for one tie under all records at a demand, for the nominal body by the nonlinear model."""

    body: Body
    demand: str
    deciding: bool  #: whether the demand determines the verdict on the body
    number: int  #: number of the tie, from 1
    tie: Tie
    motions: int  #: number of counted motions
    elongation: float  #: largest elongation under the records that do not overturn the body [m]; NaN without any
    force: float  #: largest force under all counted records [N]
    yielded: int  #: number of motions under which the force reaches the yield force
    broken: int  #: number of motions under which the tie breaks
    governing: int  #: row of the record with the largest elongation in /summary; -1 if the tie never acts

    @property
    def share(self) -> float:
        """Largest elongation divided by the ultimate elongation [-]; NaN if the tie has no ultimate elongation."""
        return self.elongation / self.tie.ultimate if math.isfinite(self.tie.ultimate) else math.nan


def tie_findings(answers: Answers, found: Sequence[BodyVerdict]) -> list[TieFinding]:
    """Return the results for every tie at every demand of the site; empty without ties or demands."""
    if "demand_tie_elongation" not in answers.summary or not answers.motions.names:
        return []
    motions, rows = answers.motions, []
    for demand in answers.demands:
        left_out = too_far(answers, demand) | weak(answers, demand)[:, np.newaxis]
        kept = motions.kept(left_out)
        tables = [answers.of_demand(f"demand_tie_{name}", demand) for name in ("elongation", "force", "state")]
        for lane, verdict in enumerate(found):
            text = str(answers.summary["restraints"].values[verdict.body.place])
            held = Restraints.from_text(text)
            for place, tie in enumerate(held.ties if held else ()):
                elongation, force, state = (np.where(left_out[:, lane], -1.0, one[:, lane, place]) for one in tables)
                alive = np.where(np.isfinite(elongation) & (state >= 0), elongation, -1.0)
                hits = (force >= tie.yield_force, state == TieState.BROKEN)
                yielded, broken = (int((motions.in_any_direction(hit) & kept[:, lane]).sum()) for hit in hits)
                most = float(alive.max())
                finding = TieFinding(
                    body=verdict.body,
                    demand=demand,
                    deciding=demand == verdict.deciding.demand,
                    number=place + 1,
                    tie=tie,
                    motions=int(kept[:, lane].sum()),
                    elongation=math.nan if most < 0.0 else most,
                    force=float(np.nanmax(np.maximum(force, 0.0), initial=0.0)),
                    yielded=yielded,
                    broken=broken,
                    governing=int(alive.argmax()) if most > 0.0 else -1,
                )
                rows.append(finding)
    return rows
