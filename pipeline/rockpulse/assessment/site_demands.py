"""The demands of a site, and the scale factors that scale a record to them."""

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rockpulse.config.configuration import Config
from rockpulse.record.half_wave import half_waves
from rockpulse.record.measures import ROWS, RecordOnBodies
from rockpulse.record.record import Record
from rockpulse.selection.tables import demand_selections

#: Range of scale factors in which a scaled record represents an earthquake of the demand (docs/limits.md).
FARTHEST = (0.25, 4.0)


class SiteDemand(NamedTuple):
    """A demand of the site for a limit state; `words` states measure and value as text."""

    value: float
    limit_state: str
    words: str
    title: str  # title of the measure


def stored_demands(summary: xr.Dataset) -> dict[str, SiteDemand]:
    """Return the demands that are stored in /summary, by name."""
    if "demand" not in summary.dims:
        return {}
    found = {}
    for place, name in enumerate(summary["demand"].values):
        own = summary.isel(demand=place)
        period, value = float(own["demand_period"]), float(own["demand_value"])
        measure = ROWS[str(own["demand_measure"].values)].at(None if math.isnan(period) else period)
        words = f"{measure.title} {value:.4g} {measure.shown_unit}".rstrip()
        words = "factors of a selection of records" if math.isnan(value) else words
        found[str(name)] = SiteDemand(value, str(own["limit_state"].values), words, measure.title)
    return found


def demand_factors(channels: Sequence[Record], blocks: Block, config: Config, record: str = "") -> np.ndarray:
    """Return scale factors (blocks, demands) with which the channels' geometric mean intensity equals each demand.

    For a demand with a table of selected records, the scale factor is read from the row `record` of the table or,
    without such a row, from the row of the first channel; NaN if the table has neither row.
    """
    on = [RecordOnBodies.slender(one, partial(half_waves, one, **config.half_waves), blocks) for one in channels]
    found = np.empty((*blocks.shape, len(config.demands)))
    chosen = demand_selections(config)
    for place, demand in enumerate(config.demands):
        if demand.name in chosen:
            factors = chosen[demand.name]
            found[:, place] = factors.get(record, factors.get(channels[0].id, math.nan))
            continue
        measure = ROWS[demand.measure].at(demand.period)
        of_channels = np.stack([np.atleast_1d(measure.value(one)) for one in on], axis=1).tolist()
        strength = [math.exp(np.mean([math.log(value) for value in values])) for values in of_channels]
        found[:, place] = demand.strength / np.array(strength)
    return found
