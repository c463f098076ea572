"""The annual frequency of a limit state at a site, from its hazard and fragility curves or overturning spectra."""

import os
from dataclasses import replace
from pathlib import Path

import xarray as xr

from rockpulse.config.configuration import Config, config_from_text, given_config
from rockpulse.config.study_settings import OVERTURNING
from rockpulse.errors import ConfigError
from rockpulse.storage.hdf5.results_file import given_results
from rockpulse.studies.risk.frequency import fragility_frequency
from rockpulse.studies.risk.hazard import Hazard
from rockpulse.studies.risk.hazard_files import hazard_of, site_hazards_of
from rockpulse.studies.risk.inventory import Inventory, inventory_frequency, read_inventory


def risk(
    fragility: xr.DataTree | str | os.PathLike[str],
    hazard: Hazard | str | os.PathLike[str] | None = None,
    limit_state: str = OVERTURNING,
    years: float | None = None,
    confidence: float | None = None,
    resamples: int = 500,
    seed: int = 0,
    *,
    config: Config | str | os.PathLike[str] | None = None,
    site: tuple[float, float] | None = None,
    soil_factor: float | None = None,
    bodies: Inventory | str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """Compute the annual frequency at which each body reaches a limit state.

    Parameters
    ----------
    fragility : xarray.DataTree or path
        Result of :func:`rockpulse.fragility` with the measure of the hazard; with `bodies`, result of
        :func:`rockpulse.assess` with ``[uncertainty] spectrum = "all"``.
    hazard : PowerLawHazard, HazardCurve or path, optional
        Annual rate of exceedance of that measure at the ground below the bodies, or the file of a hazard curve
        (:func:`rockpulse.load_hazard`); by default from [hazard].
    limit_state : str
        Limit state of the fragility.
    years : float, optional
        Exposure time for `probability` and `survival` [years]; by default from [hazard].
    confidence : float, optional
        Confidence level of the bands; by default from the fragility.
    resamples, seed : int
        Number of bootstrap samples of the earthquakes for the bands, 0 for no band; seed of the random numbers.
    config : Config or path, optional
        Configuration with a section [hazard]; by default from the fragility.
    site : (float, float), optional
        Longitude and latitude [degrees], for a hazard file of several points.
    soil_factor : float, optional
        Factor on the levels of a hazard file on rock [-]; by default from [hazard].
    bodies : path or Inventory, optional
        A table (CSV) of free bodies, for :func:`rockpulse.inventory_frequency`.

    Returns
    -------
    xarray.Dataset
        Over (block): `frequency` [1/year] with `frequency_low` and `frequency_high`, `probability` in `years` with its
        limits, `survival` = exp(-frequency years), `below` and `above`, the shares of the frequency from levels beyond
        those of the records or of the hazard, `events`, `status`, `statement` and `warning`; over (block, bin)
        `bin_low`, `bin_high` [unit of the measure in SI] and `share` of the frequency. In PGA, the frequency of uplift
        of a body on the ground needs no fit: it is the rate of exceedance of its uplift PGA. With `bodies`, the same as
        from :func:`rockpulse.inventory_frequency`.

    Raises
    ------
    ResultsError
        For results of another kind, or if these have no such limit state or measure.
    ConfigError
        If there is no hazard or more than one, for invalid numbers, or for `bodies` with another limit state.

    References
    ----------
    Cornell, C. A. (1968), Bull. Seismol. Soc. Am. 58(5), 1583-1606.

    Examples
    --------
    >>> found = rp.risk(fragility, rp.PowerLawHazard(k0=1e-4, k=2.5), years=100.0)
    >>> (1e6 * found["frequency"].values).round(1).tolist(), found["survival"].values.round(4).tolist()
    ([24.5, 1.8], [0.9976, 0.9998])
    """
    tree = given_results(fragility)
    if hazard is not None and config is not None:
        raise ConfigError("hazard, config: expected one source of the hazard, found both")
    asked = config_from_text(str(tree.attrs.get("configuration", ""))) if config is None else given_config(config)
    settings, folder = asked.hazard, asked.folder
    given = None if isinstance(hazard, str | os.PathLike) else hazard
    if given is not None and (site is not None or soil_factor is not None):
        raise ConfigError("site, soil_factor: can be given only with a hazard file; a hazard object contains both")
    if isinstance(hazard, str | os.PathLike):
        settings = replace(settings, file=os.fspath(hazard), k0=None, k=None, longitude=None, latitude=None)
        folder = Path()
    if site is not None:
        settings = replace(settings, longitude=site[0], latitude=site[1])
    if soil_factor is not None:
        settings = replace(settings, soil_factor=soil_factor)
    years = settings.years if years is None else years
    if bodies is None:
        known = given or hazard_of(settings, folder)
        return fragility_frequency(tree, known, limit_state, years, confidence, resamples, seed)
    if limit_state != OVERTURNING:
        raise ConfigError(
            f"limit_state: with bodies only {OVERTURNING!r} is possible, found {limit_state!r}; leave limit_state out"
        )
    table = bodies if isinstance(bodies, Inventory) else read_inventory(Path(bodies))
    count, level = len(table.names), 0.9 if confidence is None else confidence
    hazards = given or site_hazards_of(settings, table.sites, table.soil_factor, count, folder)
    return inventory_frequency(tree, table.block, hazards, years, level).assign_coords(body=table.names)
