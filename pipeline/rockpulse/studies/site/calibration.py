"""Calibration of a site from its records: the design spectrum, and the design sequences of bodies."""

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from pathlib import Path

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rockpulse.config.bodies import gather_bodies, refuse_floors
from rockpulse.config.configuration import Config, given_config, located
from rockpulse.config.settings import WEIGHTS
from rockpulse.errors import ConfigError, Failure, RecordRefused, ResultsError, alike, reasons_in_words
from rockpulse.record.record import Record
from rockpulse.run.analysis import Analysis, Blocks, Part, Plan, Records, Work, joined, run
from rockpulse.selection.directions import PlannedMotion, planned_ids
from rockpulse.selection.tables import read_weight_table, record_weights
from rockpulse.sequences.design_spectrum import DesignSpectrum
from rockpulse.storage.hdf5.atomic import ASSESSMENT, kind_in_words
from rockpulse.storage.hdf5.results_file import load_tree
from rockpulse.storage.variables import failure_table
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.studies.site.spectrum_design import empty_spectrum_record, site_spectrum_record, spectrum_design


def calibrate(
    records: Records,
    config: Config | str | os.PathLike[str] | None = None,
    bodies: Blocks | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
    *,
    units: str | None = None,
    dt: float | None = None,
) -> xr.DataTree:
    """Derive the design spectrum of a site, and the design sequence of each body, from a set of records.

    The design spectrum is a predictive quantile over earthquakes of the records' overturning spectra. The sequence has
    the median I_s/I, interval dT and number of main impulses N of the half-waves in the intense phases (section
    sequence), and the main impulse I with which the sequence model overturns the body at the scale factor of the
    spectrum.

    Parameters
    ----------
    records : path, Record, or iterable of either
        Paths or all channels; read, selected, rotated and conditioned as in :func:`rockpulse.assess`, in any order.
    config : Config or path, optional
        Configuration with the sections records, conditioning, half_waves, intense_phase, sequence, calibration, run and
        the bodies.
    bodies : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of the bodies of the configuration. Without bodies, only the spectrum is stored.
    failures, progress, units, dt
        As for :func:`rockpulse.assess`.

    Returns
    -------
    xarray.DataTree
        /site, /spectra and /failures, see docs/schema.md. Numbers that too few earthquakes cannot determine are NaN,
        with the reason in `site_warnings`.

    Raises
    ------
    ConfigError
        For two records with the same id, tables of events or weights that do not match the records, or ``[sequence]
        main_count = "none"``.
    RecordRefused
        If no record could be calibrated, or no record has the three half-waves that a sequence needs.

    Examples
    --------
    >>> site = rp.calibrate(records, config)["site"].dataset  # [calibration] quantile = 0.5
    >>> [round(float(site[name]), 3) for name in ("ratio", "interval", "main_count")]
    [0.767, 0.492, 4.0]
    >>> site["main"].values.round(3).tolist()
    [0.574, 0.398]
    """
    return run(SiteCalibration(given_config(config, units, dt), bodies), records, failures, progress)


class NothingCalibrated(RecordRefused):
    """Error: no record could be used for the calibration; ``failures`` has a row for each record."""

    def __init__(self, message: str, failures: Sequence[Failure]) -> None:
        super().__init__(message)
        self.failures = failures


class SiteCalibration(Analysis):
    """The calibration of a site: derives the design spectrum and sequence from the spectra and sequences of records."""

    name = "calibrate"
    doing = "calibrating"
    kind = SITE_KIND

    def __init__(self, config: Config, bodies: Blocks | None = None) -> None:
        super().__init__(config)
        if config.sequence.main_count == "none":
            raise ConfigError(
                '[sequence] main_count: "none" gives no design sequence; expected "half-largest" or a number'
            )
        blocks = config.bodies if bodies is None else bodies
        self.block_names: list[str] = []
        self.lanes: Block | None = None
        if blocks:
            gathered = gather_bodies(blocks)
            refuse_floors(gathered, "a calibration uses the ground motion at the site")
            self.block_names, self.lanes, _ = gathered.apart()
        rule = config.calibration.weights
        self.weights = None if rule in WEIGHTS else read_weight_table(located(rule, config.folder))

    @property
    def work(self) -> Work:
        """The function that computes the spectrum and the sequence of one record."""
        return partial(site_spectrum_record, config=self.config)

    @cached_property
    def empty_part(self) -> Part:
        """Arrays with no rows that have the names, types and other dimensions of the arrays of a part."""
        return empty_spectrum_record()

    def plan(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Plan:
        """Return the plan of the calibration; raise ConfigError before any computation if a record has no weight."""
        plan = super().plan(records, failures)
        known = [name for one in plan.planned for name in planned_ids(one, self.config)]
        if self.weights is not None and known:
            record_weights(known, [], self.config.calibration.weights, self.weights)
        return plan

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Compute the design spectrum and the design sequence of the site from the results of all records."""
        if not parts:
            rows = [row for row in failures if row.kind != "vertical"]
            reasons = "".join(f"\n  {reasons_in_words(group)}" for group in alike(rows))
            what = f"no record could be calibrated, so there is no site to describe{reasons}"
            raise NothingCalibrated(what, failures)
        done = joined(parts)
        ids, events = done["record"].tolist(), done["event"].tolist()
        weights = record_weights(ids, events, self.config.calibration.weights, self.weights)
        rows = sorted(failures, key=lambda row: row.stage == "events")
        warnings = [row.reason for row in rows if row.stage == "events"]
        nodes = spectrum_design(done, weights, self.block_names, self.lanes, self.config, warnings)
        settings = self.config.calibration
        nodes["/site"].attrs |= {
            "scaled_to": settings.scale_to if settings.target is None else f"{settings.scale_to} {settings.target:g}",
            "weights": settings.weights,
        }
        return self.described(xr.DataTree.from_dict({**nodes, "/failures": failure_table(rows)}), "Design of a site")


def load_design(path: str | Path) -> DesignSpectrum:
    """Read the design spectrum from a site file of ``rockpulse calibrate``.

    Parameters
    ----------
    path : str or Path
        A site file.

    Returns
    -------
    DesignSpectrum

    Raises
    ------
    ResultsError
        For a file of another kind, or a site file with too few earthquakes for a design spectrum.
    OSError
        If the file cannot be opened.

    Examples
    --------
    >>> design = rp.load_design("site.h5")
    >>> design.p.size, design.restitution.tolist()
    (24, [0.75, 0.8, 0.85, 0.9, 0.95, 1.0])
    """
    tree = load_tree(path)
    kind = tree.attrs.get("kind", ASSESSMENT)
    if kind != SITE_KIND:
        raise ResultsError(f"{path}: expected a site file of 'rockpulse calibrate', found {kind_in_words(kind)}")
    return design_of(tree, str(path))


def design_of(tree: xr.DataTree, name: str = "site") -> DesignSpectrum:
    """Return the design spectrum of a site tree, as :func:`load_design` does for a file; `name` is used in messages."""
    site, spectra = tree["site"].to_dataset(), tree["spectra"].to_dataset()
    if np.isnan(spectra["spectrum_design"].values).any():
        raise ResultsError(f"{name}: no design spectrum: {str(site['site_warnings'].item()).splitlines()[0]}")
    return DesignSpectrum(
        spectra["p"].values,
        spectra["restitution"].values,
        spectra["spectrum_design"].values,
        float(site["ratio"]),
        float(site["interval"]),
        int(site["main_count"]),
        str(site.attrs["spacing"]),
    )
