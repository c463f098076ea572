"""The variables of the results: type, unit and meaning of each (docs/schema.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "ANSWER",
    "BLOCK",
    "CAPACITY_RATIO",
    "CASE",
    "DEMAND",
    "DIRECTION",
    "DIRECTION_ANSWER",
    "FAILURE",
    "HALF_CYCLE",
    "OVERTURNING",
    "PAIR",
    "RECORD",
    "SITE_DEMAND",
    "WAVES",
    "Meaning",
    "described",
]

#: Type, unit, long name.
Meaning = tuple[type, str, str]

RECORD: dict[str, Meaning] = {
    "source": (str, "1", "file the record was read from"),
    "source_sha256": (str, "1", "SHA-256 of the source file"),
    "format": (str, "1", "file format"),
    "event": (str, "1", "earthquake that the record is counted to, by the user's table, the title or the time"),
    "event_title": (str, "1", "event as the file names it"),
    "network": (str, "1", "network code"),
    "station": (str, "1", "station code"),
    "station_name": (str, "1", "name of the station in words"),
    "component": (str, "1", "component as the file names it"),
    "azimuth": (float, "degree", "azimuth of the component, clockwise from north"),
    "start_time": (str, "1", "UTC time of the first sample, ISO 8601"),
    "npts": (int, "1", "number of samples"),
    "dt": (float, "s", "sampling interval"),
    "pga": (float, "m s-2", "peak ground acceleration after conditioning"),
    "pgv": (float, "m s-1", "peak ground velocity after conditioning, from rest at the first sample"),
    "pgv_drift": (
        np.int8,
        "1",
        "whether the ground velocity does not come back to zero, so that the PGV may be off by as much",
    ),
    "arias_intensity": (float, "m s-1", "Arias intensity"),
    "intense_start": (float, "s", "start of the intense phase from the first sample"),
    "intense_end": (float, "s", "end of the intense phase from the first sample"),
    "main_impulse": (float, "m s-1", "main impulse I of the calibrated sequence"),
    "secondary_impulse": (float, "m s-1", "secondary impulse I_s of the calibrated sequence"),
    "secondary_interval": (float, "s", "interval dT of the secondary impulses"),
    "sequence_duration": (float, "s", "duration within which main impulses act"),
    "main_count": (int, "1", "number of main impulses; -1 where the duration alone limits them"),
    "half_wave_count": (int, "1", "number of half-waves of the whole record"),
    "warnings": (str, "1", "remarks on the record"),
    "warning_codes": (str, "1", "codes of these remarks in their order; plain: a text without one"),
    "processing": (str, "1", "conditioning steps in their order"),
    "vertical_channel": (str, "1", "id of the vertical channel whose acceleration acts too; empty without one"),
}

BLOCK: dict[str, Meaning] = {
    "width": (float, "m", "full width in the plane of rocking; NaN where only p and alpha are known"),
    "height": (float, "m", "full height; NaN where only p and alpha are known"),
    "radius": (float, "m", "R, half the diagonal; for a body given by p that of the rectangle with the same p"),
    "alpha_c": (float, "rad", "critical angle"),
    "p": (float, "s-1", "frequency parameter"),
    "slenderness": (float, "1", "height over width"),
    "critical_impulse": (float, "m s-1", "I_1c, the impulse that overturns the resting block at once"),
    "block_warnings": (str, "1", "remarks on the block"),
}

CASE: dict[str, Meaning] = {
    "restitution": (float, "1", "velocity ratio C of an impact"),
}

DEMAND: dict[str, Meaning] = {
    "uplift_ratio": (float, "1", "PGA/(g tan alpha_c)"),
    "velocity_ratio": (float, "1", "p PGV/(g tan alpha_c)"),
    "impulse_ratio": (float, "1", "I/I_1c; NaN where the record gave no sequence"),
}

ANSWER: dict[str, Meaning] = {
    "peak_rotation_ratio": (float, "1", "largest rotation over alpha_c; inf where the block overturns, 0 at rest"),
    "outcome": (np.int8, "1", "how the motion ends"),
    "reason": (np.int8, "1", "why a model cannot say"),
    "overturning_time": (float, "s", "time at which overturning is certain, from the start of the model's input"),
    "overturning_half_cycle": (int, "1", "1 + impacts before overturning; -1 where it does not overturn"),
    "impacts": (int, "1", "impacts faster than 1e-3 p alpha_c; -1 where they never end or are not known"),
    "safety_factor": (float, "1", "smallest factor on the model's input that overturns; NaN where not computed"),
    "factor_resolved": (
        np.int8,
        "1",
        "whether the model answers at safety_factor; no: a lower bound, from there on it cannot answer",
    ),
    "safe_up_to": (float, "1", "factor on the model's input up to which the search found no overturning"),
    "interval_count": (int, "1", "intervals of the factor in which the block overturns; -1 where not computed"),
    "search_step": (float, "1", "ratio of neighbouring factors of the search; 1: nothing to miss, NaN: no search"),
    "capacity_pga": (float, "m s-2", "safety factor times PGA; NaN where not computed"),
    "predictable": (np.int8, "1", "whether the answer stays when C or the record changes in the ninth digit"),
    "model_used": (np.int8, "1", "model that gave the answer"),
    "applicable": (np.int8, "1", "whether the block is within the range of the model"),
}

SITE_DEMAND: dict[str, Meaning] = {
    "demand_acceleration": (float, "m s-2", "ground acceleration that the site asks for, a_g S"),
    "limit_state": (str, "1", "limit state of the demand"),
}

CAPACITY_RATIO: Meaning = (float, "1", "capacity_pga over demand_acceleration; NaN where not computed")

DIRECTION: dict[str, Meaning] = {
    "direction_azimuth": (float, "degree", "azimuth of the direction, clockwise from north"),
    "record_index": (int, "1", "index into record of /summary; -1 where the direction was not assessed"),
}

PAIR: dict[str, Meaning] = {
    "pga_median": (float, "m s-2", "median over direction of the peak ground acceleration"),
    "pga_largest": (float, "m s-2", "largest over direction of the peak ground acceleration"),
    "pga_azimuth": (float, "degree", "azimuth of the largest peak ground acceleration"),
    "main_impulse_median": (float, "m s-1", "median over direction of the main impulse I"),
    "main_impulse_largest": (float, "m s-1", "largest over direction of the main impulse I"),
    "main_impulse_azimuth": (float, "degree", "azimuth of the largest main impulse I"),
}

DIRECTION_ANSWER: dict[str, Meaning] = {
    "median_rotation_ratio": (
        float,
        "1",
        "median over direction of the largest rotation over alpha_c; inf where half of the directions overturn, NaN "
        "where directions without an answer could change it",
    ),
    "largest_rotation_ratio": (
        float,
        "1",
        "largest over direction of the largest rotation over alpha_c; inf where a direction overturns, else NaN where "
        "one has no answer",
    ),
    "largest_azimuth": (
        float,
        "degree",
        "azimuth of the largest rotation; where several directions overturn, of the one that does so first",
    ),
    "overturning_share": (float, "1", "share of all directions that overturn"),
    "unanswered_count": (int, "1", "directions without an answer"),
    "smallest_safety_factor": (
        float,
        "1",
        "smallest over direction of the safety factor; NaN where one is not known",
    ),
    "safety_factor_azimuth": (float, "degree", "azimuth of the smallest safety factor; NaN without a finite one"),
}

HALF_CYCLE: dict[str, Meaning] = {
    "record_index": (int, "1", "index into record of /summary"),
    "block_index": (int, "1", "index into block of /summary"),
    "case_index": (int, "1", "index of the restitution of the block"),
    "model_index": (int, "1", "index into model of /summary"),
    "half_cycle": (int, "1", "number of the half-cycle, from 1"),
    "start_velocity": (float, "1", "u = theta'/(p alpha_c) at its start"),
    "peak": (float, "1", "largest theta/alpha_c in it; inf where the block overturns"),
    "duration": (float, "s", "time to the next impact; inf where there is none"),
    "impulse_count": (int, "1", "intermediate impulses in it; -1 where n -> infinity"),
    "interval": (float, "s", "corrected interval of the intermediate impulses; NaN without"),
    "impact_speed": (float, "1", "speed right before the next impact over p alpha_c; NaN without"),
}

OVERTURNING: dict[str, Meaning] = {
    "record_index": (int, "1", "index into record of /summary"),
    "block_index": (int, "1", "index into block of /summary"),
    "case_index": (int, "1", "index of the restitution of the block"),
    "model_index": (int, "1", "index into model of /summary"),
    "lower": (float, "1", "smallest factor on the model's input that overturns in this interval"),
    "upper": (float, "1", "largest one; the end of the search where open"),
    "open": (np.int8, "1", "whether the block still overturns at the end of the search"),
    "resolved": (np.int8, "1", "whether the model can answer at the lower end"),
}

FAILURE: dict[str, Meaning] = {
    "file": (str, "1", "file"),
    "stage": (str, "1", "step at which it was left"),
    "reason": (str, "1", "why, and what to do"),
    "kind": (str, "1", "failed, skipped, duplicate, vertical or structural"),
}

WAVES: dict[str, Meaning] = {
    "impulse": (float, "m s-1", "signed impulse of the half-wave"),
    "centroid": (float, "s", "time of its centroid from the first sample"),
    "start": (float, "s", "its start"),
    "end": (float, "s", "its end"),
    "peak": (float, "m s-2", "its signed peak acceleration"),
}


def described(dims: tuple[str, ...], values: Any, meaning: Meaning) -> xr.Variable:
    """A variable of the results with its unit and long name.

    Parameters
    ----------
    dims : tuple of str
        Its dimensions.
    values : array_like
        Its values.
    meaning : Meaning
        Type, unit, long name.
    """
    import xarray as xr

    kind, units, long_name = meaning
    return xr.Variable(dims, np.asarray(values, dtype=kind), {"units": units, "long_name": long_name})
