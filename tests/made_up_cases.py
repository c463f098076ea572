"""An ensemble of made-up cases that the rule is fitted on and judged by."""

import numpy as np
import pandas as pd

from rockpulse.studies.rule.measures import MEASURES


def made_up(seed=0, events=6, records=10):
    """A march that scatters by 0.1 about 0.8 of the truth, and 30 % lower in one earthquake; other measures by 0.5."""
    random = np.random.default_rng(seed)
    size = events * records * 12
    capacity = np.exp(random.normal(0.3, 0.7, size))
    event = np.repeat([f"event {k}" for k in range(events)], records * 12)
    own = np.where(event == "event 0", 0.7, 1.0)
    cases = pd.DataFrame({"record": np.repeat([f"record {k}" for k in range(size // 12)], 12), "event": event})
    return cases.assign(
        slenderness=np.tile(np.repeat([4.0, 6.0, 8.0, 12.0], 3), size // 12),
        radius=np.tile([1.0, 2.0, 4.0], size // 3),
        **{name: np.exp(random.normal(0.0, 0.5, size)) / capacity for name in MEASURES},
    ).assign(
        march=0.8 * own * np.exp(random.normal(0.0, 0.1, size)) / capacity,
        march_10=1.2 * np.exp(random.normal(0.0, 0.1, size)) / capacity,
        uplift_ratio=10.0,
        capacity_mean=capacity,
        capacity_mean_low=capacity,
        factor_10=0.8 * capacity,
        factor_50=capacity,
        probability_half=1.0 / (1.0 + capacity**8 / 0.5**8),
        probability_one=1.0 / (1.0 + capacity**8),
        overturns_half=capacity < 0.5,
        overturns_one=capacity < 1.0,
    )
