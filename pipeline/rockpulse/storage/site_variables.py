"""The variables of a site file: type, unit and meaning of each (docs/schema.md)."""

from __future__ import annotations

import numpy as np

from rockpulse.storage.variables import Meaning

__all__ = ["BLOCK", "EVENT", "PAIR", "PARAMETER", "PARAMETER_MEANING", "PER_PARAMETER", "RECORD", "SITE", "SITE_KIND"]

#: Root attribute `kind` of a site file.
SITE_KIND = "site calibration"

#: Unit and meaning of the parameters of a sequence.
PARAMETER: dict[str, tuple[str, str]] = {
    "main": ("m s-1", "main impulse I"),
    "ratio": ("1", "secondary impulse over main impulse, I_s/I"),
    "interval": ("s", "interval dT of the secondary impulses"),
    "main_count": ("1", "number of main impulses; NaN without a limit"),
    "duration": ("s", "time within which main impulses act; NaN without a limit"),
}

#: What stands for the unit where it differs from parameter to parameter.
_OF_PARAMETER = "parameter_unit"

PARAMETER_MEANING: dict[str, Meaning] = {
    "parameter_unit": (str, "1", "unit of the parameter"),
    "parameter_name": (str, "1", "meaning of the parameter"),
}

RECORD: dict[str, Meaning] = {
    "source": (str, "1", "file the record was read from"),
    "source_sha256": (str, "1", "SHA-256 of the source file"),
    "event": (str, "1", "event that the record belongs to, by the user's table, the title or the time"),
    "weight": (float, "1", "weight of the record, of mean one"),
    "scale_factor": (float, "1", "factor on the conditioned record"),
    "pga": (float, "m s-2", "peak ground acceleration of the scaled record"),
    "pgv": (float, "m s-1", "peak ground velocity of the scaled record"),
    "largest_impulse": (float, "m s-1", "largest half-wave impulse of the scaled record"),
    "misfit": (
        float,
        "1",
        "root mean square of ln(sequence/recorded) of the peak rotations where both rock; NaN where nothing does",
    ),
    "unsafe_share": (
        float,
        "1",
        "share of the blocks that the record lifts whose rotation under its own sequence is below the recorded one",
    ),
    "left_out_main": (
        float,
        "m s-1",
        "main impulse of the design sequence made without the event of the record; NaN without such a design",
    ),
    "calibration_remarks": (str, "1", "what the calibration of its sequence says of itself, one remark a line"),
    "warnings": (str, "1", "remarks on the record"),
    "processing": (str, "1", "conditioning steps in their order, and the scaling"),
}

BLOCK: dict[str, Meaning] = {
    "alpha_c": (float, "rad", "critical angle"),
    "p": (float, "s-1", "frequency parameter"),
    "restitution": (float, "1", "velocity ratio C of an impact"),
    "critical_impulse": (float, "m s-1", "I_1c, the impulse that overturns the resting block at once"),
    "design_rotation_ratio": (float, "1", "theta_max/alpha_c under the design sequence; inf where it overturns"),
    "block_coverage": (
        float,
        "1",
        "coverage by block, events left out, overturning designs included; NaN where not known",
    ),
}

EVENT: dict[str, Meaning] = {
    "event_records": (int, "1", "records of the event"),
    "event_coverage": (float, "1", "coverage of its records by the design made without it, on blocks left standing"),
}

PER_PARAMETER: dict[str, Meaning] = {
    "median": (float, _OF_PARAMETER, "lognormal median"),
    "median_lower": (float, _OF_PARAMETER, "lower end of its interval, clustered by event; NaN with one event"),
    "median_upper": (float, _OF_PARAMETER, "upper end of its interval, clustered by event; NaN with one event"),
    "dispersion": (float, "1", "standard deviation of the logarithm, of records of different events"),
    "dispersion_lower": (float, "1", "lower end of its interval, clustered by event; NaN with one event"),
    "dispersion_upper": (
        float,
        "1",
        "upper end of its interval, clustered by event; inf where too few events bound it, NaN with one event",
    ),
    "quantile_16": (float, _OF_PARAMETER, "weighted 16 % quantile of the records, a value that occurs"),
    "quantile_50": (float, _OF_PARAMETER, "weighted median of the records, a value that occurs"),
    "quantile_84": (float, _OF_PARAMETER, "weighted 84 % quantile of the records, a value that occurs"),
    "design": (float, _OF_PARAMETER, "design sequence"),
    "design_lower": (
        float,
        _OF_PARAMETER,
        "lower end of the interval of the design's I, its shape kept, by resamples on a grid of about 2 %; NaN where "
        "not known and of the other parameters",
    ),
    "design_upper": (
        float,
        _OF_PARAMETER,
        "upper end of the interval of the design's I, its shape kept, by resamples on a grid of about 2 %; inf where "
        "the overturning of a block is all that bounds I, NaN of the other parameters",
    ),
}

SITE: dict[str, Meaning] = {
    "quantile": (float, "1", "share of the recorded rotations that the design is to cover"),
    "confidence": (float, "1", "confidence of all intervals"),
    "resamples": (int, "1", "bootstrap resamples of the events"),
    "record_count": (int, "1", "records of a weight above zero"),
    "event_count": (int, "1", "events of such records"),
    "lifting_events": (int, "1", "those of these events that have a record which lifts a block"),
    "lifted_share": (
        float,
        "1",
        "share of the pairs of record and block that count, for the record lifts the block",
    ),
    "unresolved_share": (
        float,
        "1",
        "share of the pairs of record and block whose answer is not known; they count as overturned",
    ),
    "design_set_by": (
        str,
        "1",
        "blocks whose overturning sets I: just below it they stand and the quantile is not covered; empty where "
        "larger rotations reach the quantile",
    ),
    "coverage": (
        float,
        "1",
        "share of the pairs that count, on blocks left standing, whose recorded rotation is covered by the design made "
        "without the event of the record; NaN where nothing can be left out or nothing is left standing",
    ),
    "coverage_lower": (float, "1", "lower end of its interval, clustered by event"),
    "coverage_upper": (float, "1", "upper end of its interval, clustered by event"),
    "judged_pairs": (int, "1", "pairs of record and block that the coverage rests on"),
    "judged_events": (int, "1", "events that the coverage rests on"),
    "coverage_in_sample": (float, "1", "the same share by the design made of all records: no test of it"),
    "coverage_all": (
        float,
        "1",
        "as coverage, with the blocks that the design overturns, which it covers whatever the records do",
    ),
    "standing_share": (float, "1", "share of the pairs that count on blocks that the design leaves standing"),
    "remarks": (str, "1", "what the numbers of this file do not say by themselves, one remark a line"),
}

#: Of each pair of record and block.
PAIR: dict[str, Meaning] = {
    "rotation_ratio": (float, "1", "recorded theta_max/alpha_c; inf overturned, 0 at rest, NaN unresolved"),
    "covered": (np.int8, "1", "whether the design made without the event of the record covers the recorded rotation"),
}
