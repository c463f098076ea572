"""The variables of a site file by the overturning spectrum, and every variable of site files of both kinds."""

from __future__ import annotations

from dataclasses import replace

from rockpulse.storage.site_variables import COORDINATES, OF_RECORDS, VARIABLES
from rockpulse.storage.spectrum_variables import SPECTRUM_AXES
from rockpulse.storage.variables import FAILURE, Declared, StoredVariable, along, real, whole

__all__ = ["SITE", "SITE_AXES", "SITE_GROUPS", "SPECTRA", "SPECTRA_AXES"]


def _with_interval(name: str, units: str, meaning: str, explanation: str = "") -> dict[str, StoredVariable]:
    """A variable and both ends of its interval."""
    return {
        name: real(units, meaning, explanation=explanation),
        **{
            f"{name}_{end}": real(units, f"{end} end of its interval, events resampled; NaN with one event")
            for end in ("lower", "upper")
        },
    }


#: Of a site by the overturning spectra of its records. What rests on too few earthquakes is NaN, and said in `remarks`.
SITE: Declared = {
    "quantile": real("1", "share of the weight of the records at or below the design spectrum"),
    **{name: VARIABLES[name] for name in ("confidence", "resamples", "record_count", "event_count")},
    **{name: VARIABLES[name] for name in ("remarks", "remark_values")},
    **OF_RECORDS,
    **{name: VARIABLES[name] for name in ("alpha_c", "p", "restitution", "critical_impulse")},
    **along(
        ("block",),
        {
            **_with_interval(
                "effective_impulse",
                "m s-1",
                "I_eff, the design spectrum at the p and C of the block",
                "the block overturns where it reaches g tan(alpha_c)/p; NaN for a block outside the spectrum",
            ),
            **_with_interval(
                "design_factor", "1", "factor on the design at which the block overturns, g tan(alpha_c)/(p I_eff)"
            ),
            **_with_interval(
                "main",
                "m s-1",
                "main impulse I of the sequence of that effect with the ratio and main_count of the block",
                "I = I_eff (alpha_c/sin(alpha_c))/[(1 - sigma) S_N + sigma/2], S_N = (1 - C^N)/(1 - C), so that the "
                "sequence model, with I_1c = g alpha_c/(p cos(alpha_c)), has the same factor; ends: ratio and "
                "main_count kept",
            ),
            **_with_interval("ratio", "1", "I_s/I, weighted median of the records on the time scale of the block"),
            **_with_interval("main_count", "1", "number of main impulses, weighted median of the records likewise"),
            "overturned_share": real("1", "share of the weight of the records whose own spectrum overturns the block"),
        },
    ),
    "event_records": VARIABLES["event_records"],
}

SITE_AXES: Declared = {name: COORDINATES[name] for name in ("record", "block", "site_event")}

#: The spectra of the records, and their quantiles.
SPECTRA: Declared = {
    **along(
        ("p", "restitution"),
        {
            **_with_interval("spectrum_50", "m s-1", "weighted median of the overturning spectra, a value that occurs"),
            **_with_interval("spectrum_84", "m s-1", "weighted 84 % quantile of the spectra, a value that occurs"),
            **_with_interval(
                "spectrum_design", "m s-1", "design spectrum: the weighted quantile of `quantile` in /site"
            ),
        },
    ),
    **along(
        ("p",),
        {
            **_with_interval("ratio", "1", "I_s/I on the time scale 1/p, weighted median of the records"),
            **_with_interval("main_count", "1", "number of main impulses on that time scale, likewise"),
        },
    ),
    "spectrum": real(
        "m s-1",
        "overturning spectrum of the scaled record, the effective impulse that a slender block takes from it",
        dims=("record", "p", "restitution"),
    ),
    **along(
        ("record", "p"),
        {
            "record_ratio": real("1", "I_s/I of the half-waves of the record on the time scale 1/p"),
            "record_main_count": whole("number of main impulses of the record on that time scale"),
        },
    ),
}

SPECTRA_AXES: Declared = {
    "record": COORDINATES["record"],
    "p": replace(SPECTRUM_AXES["p"], take=None),
    "restitution": real("1", "restitution C of the blocks", dims=("restitution",)),
}

#: Every variable of a site file, by its group.
SITE_GROUPS: dict[str, Declared] = {
    "/site, by the response or the statistics": {**COORDINATES, **VARIABLES},
    "/site, by the spectrum": {**SITE_AXES, **SITE},
    "/spectra, by the spectrum": {**SPECTRA_AXES, **SPECTRA},
    "/failures": FAILURE,
}
