"""The variables of a site file, with a design sequence or a design spectrum."""

from dataclasses import replace

from rockpulse.record.measures import STORED_LEVELS
from rockpulse.storage.variables import FAILURE, Declared, StoredVariable, along, flag, real, text, whole
from rockpulse.storage.variables.probability import SPECTRUM_AXES
from rockpulse.storage.variables.summary import FACTS

#: Root attribute `kind` of a site file.
SITE_KIND = "site calibration"

#: Unit and description of each parameter of a sequence.
PARAMETER: dict[str, tuple[str, str]] = {
    "main": ("m s-1", "main impulse I"),
    "ratio": ("1", "secondary impulse over main impulse, I_s/I"),
    "interval": ("s", "interval dT of the secondary impulses"),
    "main_count": ("1", "number of main impulses; NaN without a limit"),
    "duration": ("s", "time within which main impulses act; NaN without a limit"),
}

#: Text in place of a unit, for values whose unit depends on the parameter.
_OF_PARAMETER = "parameter_unit"

#: Variables of every record, for both methods.
OF_RECORDS: Declared = along(
    ("record",),
    source=text("file the record was read from"),
    source_sha256=text("SHA-256 of the source file"),
    event=text("earthquake of the record, from the user's table, the title or the time"),
    weight=real("weight of the record, of mean one"),
    scale_factor=real("scale factor on the conditioned record"),
    **{one.name: real(f"{one.meaning} of the scaled record", one.unit) for one in STORED_LEVELS},
    largest_impulse=real("largest half-wave impulse of the scaled record", "m s-1"),
    warnings=text("warnings on the record"),
    processing=text("conditioning steps in their order, and the scaling"),
    **FACTS,
)

#: Variables of a design sequence: of the site, its parameters, records, blocks and events, in the order of the file.
VARIABLES: Declared = {
    "quantile": real("share of the recorded rotations that the design has to cover"),
    "confidence": real("confidence of all intervals"),
    "resamples": whole("number of bootstrap resamples of the earthquakes"),
    "record_count": whole("number of records with a weight above zero"),
    "event_count": whole("number of earthquakes of these records"),
    "lifting_events": whole("number of these earthquakes with a record that lifts a block"),
    "lifted_share": real("share of the pairs of record and block that are counted because the record lifts the block"),
    "unresolved_share": real("share of the pairs of record and block without a result, which count as overturned"),
    "design_set_by": text(
        "blocks whose overturning limits I: just below this I they survive and the quantile is not covered; empty if "
        "larger rotations reach the quantile"
    ),
    "coverage": real(
        "share of the counted pairs, on blocks that survive the design, whose recorded rotation is covered by the "
        "design made without the earthquake of the record; NaN if no earthquake can be left out or no block survives"
    ),
    "coverage_lower": real("lower end of the interval, clustered by earthquake"),
    "coverage_upper": real("upper end of the interval, clustered by earthquake"),
    "judged_pairs": whole("number of pairs of record and block on which the coverage is based"),
    "judged_events": whole("number of earthquakes on which the coverage is based"),
    "coverage_in_sample": real("coverage by the design made from all records, which is not a test of it"),
    "coverage_all": real("coverage including the blocks that the design overturns, which it always covers"),
    "standing_share": real("share of the counted pairs on blocks that survive the design"),
    "site_warnings": text("warnings on the calibration, one per line", explanation="the most serious first"),
    "site_warning_values": text("the same warnings by their codes and values, as JSON"),
    **along(
        ("parameter",),
        median=real("lognormal median", _OF_PARAMETER),
        median_lower=real("lower end of the interval, clustered by earthquake; NaN with one earthquake", _OF_PARAMETER),
        median_upper=real("upper end of the interval, clustered by earthquake; NaN with one earthquake", _OF_PARAMETER),
        dispersion=real("standard deviation of the logarithm over records of different earthquakes"),
        dispersion_lower=real("lower end of the interval, clustered by earthquake; NaN with one earthquake"),
        dispersion_upper=real(
            "upper end of the interval, clustered by earthquake; inf if unbounded, NaN with one earthquake"
        ),
        quantile_16=real("weighted 16 % quantile of the records, an observed value", _OF_PARAMETER),
        quantile_50=real("weighted median of the records, an observed value", _OF_PARAMETER),
        quantile_84=real("weighted 84 % quantile of the records, an observed value", _OF_PARAMETER),
        design=real("design sequence", _OF_PARAMETER),
        design_lower=real(
            "lower end of the interval of I of the design, for a constant shape, from resamples on a grid of about "
            "2 %; NaN if not known, and for the other parameters",
            _OF_PARAMETER,
        ),
        design_upper=real(
            "upper end of the interval of I of the design, for a constant shape, from resamples on a grid of about "
            "2 %; inf if I is bounded only by the overturning of a block, NaN for the other parameters",
            _OF_PARAMETER,
        ),
    ),
    **OF_RECORDS,
    **along(
        ("record",),
        misfit=real("RMS of ln(sequence/recorded) of the peak rotations of blocks that rock in both; NaN if none does"),
        unsafe_share=real(
            "share of the lifted blocks whose rotation under the record's own sequence is below the recorded one"
        ),
        left_out_main=real(
            "main impulse I of the design made without the earthquake of the record; NaN if none", "m s-1"
        ),
    ),
    **along(("record", "parameter"), value=real("parameter of the record's own sequence", _OF_PARAMETER)),
    **along(
        ("block",),
        alpha_c=real("critical angle", "rad"),
        p=real("frequency parameter", "s-1"),
        restitution=real("velocity ratio C of an impact"),
        critical_impulse=real("critical impulse I_1c, which overturns the block at rest", "m s-1"),
        design_rotation_ratio=real("theta_max/alpha_c under the design sequence; inf if the block overturns"),
        block_coverage=real("coverage of each block, including designs that overturn it; NaN if not known"),
    ),
    **along(
        ("site_event",),
        event_records=whole("number of records of the earthquake"),
        event_coverage=real(
            "coverage of the records of the earthquake by the design made without it, on blocks that survive"
        ),
    ),
    "correlation": real(
        "weighted correlation of the logarithms; NaN if one of the two does not vary",
        dims=("parameter", "other_parameter"),
    ),
    **along(
        ("record", "block"),
        rotation_ratio=real("recorded theta_max/alpha_c; inf overturned, 0 at rest, NaN unresolved"),
        covered=flag(
            ("not_counted", "not_covered", "covered", "overturned_by_the_design"),
            "whether the design made without the earthquake of the record covers the recorded rotation",
            first=-1,
        ),
    ),
}

COORDINATES: Declared = {
    "record": text("record id", dims=("record",)),
    "block": text("name of the body", dims=("block",), explanation="one for each restitution of a body"),
    "site_event": text("earthquake", dims=("site_event",)),
    "parameter": text("parameter of the impulse sequence", dims=("parameter",)),
    "other_parameter": text("second parameter of a correlation", dims=("other_parameter",)),
    "parameter_unit": text("unit of the parameter", dims=("parameter",)),
    "parameter_name": text("meaning of the parameter", dims=("parameter",)),
}


def _with_interval(name: str, units: str, meaning: str, explanation: str = "") -> dict[str, StoredVariable]:
    """Declare a variable and the two ends of its confidence interval."""
    return {
        name: real(meaning, units, explanation=explanation),
        **{
            f"{name}_{end}": real(
                f"{end} end of the interval of `{name}`, from resampled earthquakes; NaN with one earthquake", units
            )
            for end in ("lower", "upper")
        },
    }


#: Variables of a design spectrum. Values from too few earthquakes are NaN; see `site_warnings`.
SITE: Declared = {
    "quantile": real("share of the weight of the records at or below the design spectrum"),
    **{name: VARIABLES[name] for name in ("confidence", "resamples", "record_count", "event_count")},
    **{name: VARIABLES[name] for name in ("site_warnings", "site_warning_values")},
    **OF_RECORDS,
    **{name: VARIABLES[name] for name in ("alpha_c", "p", "restitution", "critical_impulse")},
    **along(
        ("block",),
        **_with_interval(
            "effective_impulse",
            "m s-1",
            "I_eff, the design spectrum at the p and C of the block",
            "the block overturns if I_eff is g tan(alpha_c)/p or more; NaN for a block outside the spectrum",
        ),
        **_with_interval(
            "design_factor", "1", "scale factor on the design at which the block overturns, g tan(alpha_c)/(p I_eff)"
        ),
        **_with_interval(
            "main",
            "m s-1",
            "main impulse I of the sequence with this I_eff and with the ratio and main_count of the block",
            "I = I_eff (alpha_c/sin(alpha_c))/[(1 - sigma) S_N + sigma/2], S_N = (1 - C^N)/(1 - C), so that the "
            "sequence model, with I_1c = g alpha_c/(p cos(alpha_c)), has the same factor; interval for "
            "constant ratio and main_count",
        ),
        **_with_interval("ratio", "1", "I_s/I, weighted median of the records on the time scale of the block"),
        **_with_interval(
            "main_count", "1", "number of main impulses, weighted median of the records on this time scale"
        ),
        overturned_share=real("share of the weight of the records whose own spectrum overturns the block"),
    ),
    "event_records": VARIABLES["event_records"],
}

SITE_AXES: Declared = {name: COORDINATES[name] for name in ("record", "block", "site_event")}

#: The spectra of the records, and their quantiles.
SPECTRA: Declared = {
    **along(
        ("p", "restitution"),
        **_with_interval("spectrum_50", "m s-1", "weighted median of the overturning spectra, an observed value"),
        **_with_interval("spectrum_84", "m s-1", "weighted 84 % quantile of the spectra, an observed value"),
        **_with_interval(
            "spectrum_design", "m s-1", "design spectrum: the weighted quantile given by `quantile` in /site"
        ),
    ),
    **along(
        ("p",),
        **_with_interval("ratio", "1", "I_s/I on the time scale 1/p, weighted median of the records"),
        **_with_interval(
            "main_count", "1", "number of main impulses on this time scale, weighted median of the records"
        ),
    ),
    "spectrum": real(
        "overturning spectrum of the scaled record: its effective impulse for a slender block",
        "m s-1",
        dims=("record", "p", "restitution"),
    ),
    **along(
        ("record", "p"),
        record_ratio=real("I_s/I of the half-waves of the record on the time scale 1/p"),
        record_main_count=whole("number of main impulses of the record on this time scale"),
    ),
}

SPECTRA_AXES: Declared = {
    "record": COORDINATES["record"],
    "p": replace(SPECTRUM_AXES["p"], take=None),
    "restitution": real("restitution C of the blocks", dims=("restitution",)),
}

#: Every variable of a site file, by group.
SITE_GROUPS: dict[str, Declared] = {
    "/site, by the statistics": {**COORDINATES, **VARIABLES},
    "/site, by the spectrum": {**SITE_AXES, **SITE},
    "/spectra, by the spectrum": {**SPECTRA_AXES, **SPECTRA},
    "/failures": FAILURE,
}
