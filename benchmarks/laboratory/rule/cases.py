"""The cases for fitting and testing the rule: strong channels on blocks, with their nonlinear capacity.

.. note:: A case is one pair of record and block of :mod:`laboratory.ensemble`. It has the capacity of the nonlinear
   equation under the default uncertainty (:mod:`laboratory.rule.truth`), and the verdicts at scale factors 0.5 and 1
   without uncertainty.
"""

import numpy as np
import pandas as pd

from laboratory.ensemble import StrongMotion, blocks
from laboratory.rule.measures import other_measures
from laboratory.rule.truth import nonlinear_capacity
from rocking.march.recorded import recorded_response
from rocking.response import Outcome
from rocking.spectrum.half_waves import demand_of_half_waves
from rockpulse.record.half_wave import half_waves

__all__ = ["SCALES", "motion_cases"]

#: Factors on each record at which verdicts are compared [-], by name.
SCALES = {"half": 0.5, "one": 1.0}


def motion_cases(motion: StrongMotion) -> pd.DataFrame:
    """The cases of one motion, one row a body.

    Columns: record, event, source (the file of the record), slenderness, radius [m]; the demands [-] of
    :data:`laboratory.rule.measures.MEASURES`; the capacities of
    :func:`~laboratory.rule.truth.nonlinear_capacity`; `overturns_half` and `overturns_one`, the nonlinear
    verdicts at the factors :data:`SCALES`. Raises ValueError where a model refuses the numbers of the record.
    """
    bodies, record = blocks(), motion.record
    waves = half_waves(record)
    asked = demand_of_half_waves(bodies, waves.start, waves.centroid, waves.end, waves.impulse)
    verdict = recorded_response(bodies, record.acceleration, record.dt, scale=np.array(list(SCALES.values()))).outcome
    return pd.DataFrame(
        {
            "record": record.id,
            "event": motion.event,
            "source": record.source,
            "slenderness": bodies.slenderness,
            "radius": bodies.radius,
            "march": asked.march,
            "march_10": asked.march_10,
            **other_measures(bodies, record, waves),
            **nonlinear_capacity(bodies, record.acceleration, record.dt),
            **{
                f"overturns_{name}": (row == Outcome.OVERTURNS) | (row == Outcome.UNRESOLVED)
                for name, row in zip(SCALES, np.asarray(verdict), strict=True)
            },
        }
    )
