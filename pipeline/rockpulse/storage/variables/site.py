"""The variables of a site file, which contains the results of a site calibration."""

from dataclasses import replace

from rockpulse.record.measures import STORED_LEVELS
from rockpulse.storage.variables import FAILURE, Declared, StoredVariable, along, real, text, whole, with_ends
from rockpulse.storage.variables.probability import SPECTRUM_AXES
from rockpulse.storage.variables.summary import FACTS

#: Root attribute `kind` of a site file.
SITE_KIND = "site calibration"

#: Variables of each record of the site.
OF_RECORDS: Declared = along(
    ("record",),
    source=text("file the record was read from"),
    source_sha256=text("SHA-256 of the source file"),
    event=text("earthquake of the record, from the user's table, the title or the time"),
    weight=real("weight of the record, of mean one"),
    scale_factor=real("scale factor on the conditioned record"),
    **{one.name: real(f"{one.meaning} of the scaled record", one.unit) for one in STORED_LEVELS},
    largest_impulse=real("largest half-wave impulse of the scaled record", "m s^-1"),
    warnings=text("warnings on the record"),
    processing=text("conditioning steps in their order, and the scaling"),
    **FACTS,
)


def _with_interval(name: str, units: str, meaning: str, explanation: str = "") -> dict[str, StoredVariable]:
    lower, upper = (
        f"{end} end of the interval of `{name}`, from resampled earthquakes; NaN with one earthquake"
        for end in ("lower", "upper")
    )
    return with_ends(name, real(meaning, units, explanation=explanation), lower=lower, upper=upper)


#: Variables of the site, its records, bodies and earthquakes. Values from too few earthquakes are NaN.
SITE: Declared = {
    "quantile": real("probability that a further earthquake is at or below the design spectrum"),
    "confidence": real("confidence of all intervals"),
    "resamples": whole("number of bootstrap resamples of the earthquakes"),
    "record_count": whole("number of records with a weight above zero"),
    "event_count": whole("number of earthquakes of these records"),
    "site_warnings": text("warnings on the calibration, one per line", explanation="the most serious first"),
    "site_warning_values": text("the same warnings by their codes and values, as JSON"),
    **_with_interval("ratio", "1", "I_s/I of the sequence, weighted median of the records"),
    **_with_interval("interval", "s", "interval dT of the secondary impulses, weighted median of the records"),
    **_with_interval("main_count", "1", "number N of main impulses, weighted median of the records"),
    **OF_RECORDS,
    **along(
        ("record",),
        record_ratio=real("I_s/I of the half-waves in the intense phase of the record; NaN for fewer than three"),
        record_interval=real("interval dT of these half-waves", "s"),
        record_main_count=real("number of main impulses of these half-waves"),
    ),
    **along(
        ("block",),
        alpha_c=real("critical angle", "rad"),
        p=real("frequency parameter", "s^-1"),
        restitution=real("velocity ratio C of an impact"),
        critical_impulse=real("critical impulse I_1c, which overturns the block at rest", "m s^-1"),
        critical_impulse_2=real("I_2c, size of two impulses at resonance that overturn the block (Eq. 9)", "m s^-1"),
        **_with_interval(
            "effective_impulse",
            "m s^-1",
            "I_eff, the design spectrum at the p and C of the block",
            "the block overturns if I_eff is g tan(alpha_c)/p or more; NaN for a block outside the spectrum",
        ),
        **_with_interval(
            "design_factor", "1", "scale factor on the design at which the block overturns, g tan(alpha_c)/(p I_eff)"
        ),
        **_with_interval(
            "main",
            "m s^-1",
            "main impulse I with which the sequence model, with the ratio, interval and main_count of the site, "
            "overturns the block at the design_factor",
            "ends of the interval: with the same ratio, interval and main_count",
        ),
        rotation_ratio=real("theta_max/alpha_c of the block under its sequence; inf where it overturns"),
        half_cycle=whole("half-cycle in which its sequence without end overturns the block; 0 if it never does"),
        stabilised_rotation=real("theta_max/alpha_c under its sequence without end; inf where it overturns"),
        least_count=whole("number n of secondary impulses in the first half-cycle; 0 if it overturns"),
        most_count=whole("largest number n of secondary impulses in a half-cycle; 0 if it overturns in the first"),
        overturned_share=real("share of the weight of the records whose own spectrum overturns the block"),
    ),
    **along(("site_event",), event_records=whole("number of records of the earthquake")),
}

SITE_AXES: Declared = {
    "record": text("record id", dims=("record",)),
    "block": text("name of the body", dims=("block",), explanation="one for each restitution of a body"),
    "site_event": text("earthquake", dims=("site_event",)),
}

#: The spectra of the records, and their quantiles.
SPECTRA: Declared = {
    **along(
        ("p", "restitution"),
        **_with_interval("spectrum_50", "m s^-1", "median of the overturning spectra over earthquakes"),
        **_with_interval("spectrum_84", "m s^-1", "predictive 84 % quantile of the spectra over earthquakes"),
        **_with_interval("spectrum_design", "m s^-1", "design spectrum: predictive quantile of `quantile` in /site"),
    ),
    "spectrum": real(
        "overturning spectrum of the scaled record: its effective impulse for a slender block",
        "m s^-1",
        dims=("record", "p", "restitution"),
    ),
}

SPECTRA_AXES: Declared = {
    "record": SITE_AXES["record"],
    "p": replace(SPECTRUM_AXES["p"], take=None),
    "restitution": real("restitution C of the blocks", dims=("restitution",)),
}

#: Every variable of a site file, by group.
SITE_GROUPS: dict[str, Declared] = {
    "/site": {**SITE_AXES, **SITE},
    "/spectra": {**SPECTRA_AXES, **SPECTRA},
    "/failures": FAILURE,
}
