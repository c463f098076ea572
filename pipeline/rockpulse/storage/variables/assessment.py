"""The variables of an assessment file by group, each with the function that returns its values."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from rockpulse.storage.variables import FAILURE, NO_YES, Declared, StoredVariable, along, flag, real, text, whole
from rockpulse.storage.variables.probability import SPECTRA
from rockpulse.storage.variables.summary import LANES, SUMMARY

#: Dimensions whose size increases with each record that is assessed.
GROWING = frozenset({"record", "row", "interval", "wave", "sample", "history", "instant"})


def _column(table: str, pick: Callable[[Any], np.ndarray]) -> Callable[[Any], np.ndarray]:
    """Return a function that reads one column of a table of an assessed record, joined over all models."""

    def taken(one: Any) -> np.ndarray:
        found = [pick(rows) for rows in getattr(one, table)]
        return np.concatenate(found) if found else np.zeros(0)

    return taken


def _first_record(rows: Any) -> np.ndarray:
    return np.zeros(rows.lane.size, dtype=int)


def _model(rows: Any) -> np.ndarray:
    return np.full(rows.lane.size, rows.model)


def _pointers(table: str) -> dict[str, StoredVariable]:
    """Declare the index columns of a table of one record; the record index in these columns is 0."""
    return {
        "record_index": whole("index of the record in /summary", _column(table, _first_record)),
        "block_index": whole("index of the block in /summary", _column(table, lambda rows: rows.block)),
        "case_index": whole("index of the restitution of the block", _column(table, lambda rows: rows.case)),
        "model_index": whole("index of the model in /summary", _column(table, _model)),
    }


HALF_CYCLE = along(
    ("row",),
    lambda name: _column("half_cycles", lambda rows: getattr(rows.source, name)[rows.cycle, rows.lane]),
    **_pointers("half_cycles"),
    half_cycle=whole("number of the half-cycle, from 1", _column("half_cycles", lambda rows: rows.cycle + 1)),
    start_velocity=real("u = theta'/(p alpha_c) at the start of the half-cycle"),
    peak=real("largest theta/alpha_c of the half-cycle; inf if the block overturns"),
    duration=real("time to the next impact; inf without a further impact", "s"),
    impulse_count=whole("number of secondary impulses in the half-cycle; -1 for infinitely many", explanation="n_i"),
    interval=real("corrected interval of the secondary impulses; NaN if there are none", "s", explanation="dT_i"),
    impact_speed=real("velocity before the next impact divided by p alpha_c; NaN if there is no impact"),
)

OVERTURNING = along(
    ("interval",),
    lambda name: _column("intervals", lambda rows: getattr(rows.source, name)),
    **_pointers("intervals"),
    lower=real("smallest scale factor of this interval, on the model's input"),
    upper=real("largest scale factor of this interval; the end of the search if open"),
    open=flag(NO_YES, "whether the block overturns at the end of the search"),
    resolved=flag(
        NO_YES,
        "whether the model gives a result at the lower end",
        explanation="no: from `lower` on it gives none (in free flight, for example), which counts as overturning",
    ),
)

#: Variables of each pair of channels in a sweep over direction, computed from the variables of /summary.
DIRECTIONS: Declared = {
    "pair": text("the two channels that were rotated", dims=("pair",)),
    "direction_azimuth": real(
        "azimuth of the direction, clockwise from north",
        "degree",
        dims=("direction",),
        explanation="from 0 up to 180 degrees: the motion of the opposite direction is the mirror image",
    ),
    "record_index": whole("index of the record in /summary; -1 if not assessed", dims=("pair", "direction")),
    **along(
        ("pair",),
        pga_median=real("median over directions of the peak ground acceleration", "m s^-2"),
        pga_largest=real("largest value over directions of the peak ground acceleration", "m s^-2"),
        pga_azimuth=real("azimuth of the largest peak ground acceleration", "degree"),
        main_impulse_median=real("median over directions of the main impulse I", "m s^-1"),
        main_impulse_largest=real("largest value over directions of the main impulse I", "m s^-1"),
        main_impulse_azimuth=real("azimuth of the largest main impulse I", "degree"),
    ),
    **along(
        ("pair", *LANES[1:], "model"),
        median_rotation_ratio=real(
            "median over directions of the largest rotation over alpha_c; inf if half of the directions "
            "overturn, NaN if directions without a result could change it"
        ),
        largest_rotation_ratio=real(
            "largest value over directions of the largest rotation over alpha_c; inf if a direction overturns, "
            "otherwise NaN if one has no result"
        ),
        largest_azimuth=real("azimuth of the largest rotation; if several directions overturn, of the first", "degree"),
        overturning_share=real("share of all directions that overturn"),
        unanswered_count=whole("number of directions without a result"),
        smallest_safety_factor=real(
            "smallest value over directions of the safety factor; NaN if one is not known",
            explanation="inf: no overturning in any direction up to the end of the search; a lower bound if "
            '`factor_resolved` of that direction is "no"',
        ),
        safety_factor_azimuth=real("azimuth of the smallest safety factor; NaN if none is finite", "degree"),
    ),
    "overturning_probability_mean": real(
        "mean over directions of the probability of overturning; NaN if one is not known",
        dims=("pair", *LANES[1:]),
        explanation="for a body whose direction is not known; only with `[uncertainty] azimuth = true`",
        stored=lambda config: config.uncertainty.azimuth,
    ),
}

WAVES = along(
    ("wave",),
    lambda name: lambda one: getattr(one.scene.waves, name),
    impulse=real("signed impulse of the half-wave", "m s^-1"),
    centroid=real("time of the centroid of the half-wave from the first sample", "s"),
    start=real("start of the half-wave", "s"),
    end=real("end of the half-wave", "s"),
    peak=real("signed peak acceleration of the half-wave", "m s^-2"),
)

_SAMPLES = {
    "row_size": whole(
        "number of samples of each record", lambda one: one.record.npts, dims=("record",), sample_dimension="sample"
    ),
    "acceleration": real(
        "conditioned ground acceleration", "m s^-2", lambda one: one.record.acceleration, dims=("sample",)
    ),
}

_HISTORIES = along(
    ("history",),
    history_row_size=whole(
        "number of instants of each history",
        _column("histories", lambda rows: np.full(rows.lane.size, rows.source.rotation.shape[1])),
        sample_dimension="instant",
    ),
    history_record_index=whole("index of the record", _column("histories", _first_record)),
    history_lane_index=whole(
        "index of the combination of block and case in /summary; the case changes fastest",
        _column("histories", lambda rows: rows.lane),
    ),
    history_model_index=whole("index of the model in /summary", _column("histories", _model)),
) | along(
    ("instant",),
    lambda name: _column("histories", lambda rows: getattr(rows.source, name).ravel()),
    rotation=real("rotation at the record's samples", "rad"),
    velocity=real("angular velocity at the record's samples", "rad s^-1"),
)

#: Variables of /records, as ragged arrays: the values of all records one after the other, and their number per record.
_RECORDS: Declared = {
    "record": SUMMARY["record"],
    "half_wave_row_size": whole(
        "number of half-waves of each record",
        lambda one: one.scene.waves.impulse.size,
        dims=("record",),
        sample_dimension="wave",
    ),
    **{f"half_wave_{name}": variable for name, variable in WAVES.items()},
    **{name: replace(one, stored=lambda config: config.records.store == "all") for name, one in _SAMPLES.items()},
    **{name: replace(one, stored=lambda config: config.models.histories) for name, one in _HISTORIES.items()},
}

#: Every variable of an assessment, by group, in the order of the file.
ASSESSMENT_GROUPS: dict[str, Declared] = {
    "/summary": SUMMARY,
    "/half_cycles": HALF_CYCLE,
    "/overturning_intervals": OVERTURNING,
    "/spectra": {"record": replace(SUMMARY["record"], stored=SPECTRA["spectrum"].stored), **SPECTRA},
    "/failures": FAILURE,
    "/directions": DIRECTIONS,
    "/records": {
        name: replace(one, stored=one.stored or (lambda config: config.records.store != "none"))
        for name, one in _RECORDS.items()
    },
}
