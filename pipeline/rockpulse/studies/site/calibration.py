"""Calibration of the design spectrum or design sequence of a site on its records, with uncertainties."""

import math
import os
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from pathlib import Path

import numpy as np
import xarray as xr

from rocking.body.block import Block
from rocking.impulses.impulse_sequence import ImpulseSequence
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
from rockpulse.studies.site.sequence_design import sequence_design
from rockpulse.studies.site.site_records import block_family, empty_site_record, site_record
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
    """Calibrate the design spectrum or design sequence of a site on a set of records.

    By default the design is a quantile over earthquakes of the records' overturning spectra, with a sequence for every
    body; ``[calibration] method`` can select one sequence for all bodies, derived from statistics of the half-waves.

    Parameters
    ----------
    records : path, Record, or iterable of either
        Paths or all channels; read, selected, rotated and conditioned as in :func:`rockpulse.assess`, in any order.
    config : Config or path, optional
        Configuration with the sections records, conditioning, half_waves, intense_phase, sequence, calibration, run and
        the bodies.
    bodies : mapping of str to (width, height), Block or BlockSettings, or sequence of BlockSettings, optional
        The bodies, in place of the bodies of the configuration. Without bodies, only the spectrum is stored,
        and one sequence covers a family of 100 (:func:`rockpulse.studies.site.site_records.block_family`).
    failures, progress, units, dt
        As for :func:`rockpulse.assess`.

    Returns
    -------
    xarray.DataTree
        /site, /failures and, for a design spectrum, /spectra, see docs/schema.md. Numbers that too few records or
        events cannot determine are NaN, inf or a wide interval, with the reason in `site_warnings`.

    Raises
    ------
    ConfigError
        For two records with the same id, or tables of events or weights that do not match the records.
    RecordRefused
        If no record could be calibrated, or the records give no design sequence: nothing rocks, or a single record has
        no quantile. Too few earthquakes for a quantile of the spectrum give a line of `site_warnings`.

    Examples
    --------
    >>> site = rp.calibrate(records, rp.Config(calibration=rp.CalibrationSettings(method="statistics")))
    >>> site["site"]["parameter"].values.tolist(), site["site"]["design"].values.round(2).tolist()
    (['main', 'ratio', 'interval', 'main_count', 'duration'], [0.83, 0.76, 0.49, 4.0, 1.83])
    """
    return run(SiteCalibration(given_config(config, units, dt), bodies), records, failures, progress)


class NothingCalibrated(RecordRefused):
    """Error: no record could be calibrated; ``failures`` has a row for each record."""

    def __init__(self, message: str, failures: Sequence[Failure]) -> None:
        super().__init__(message)
        self.failures = failures


class SiteCalibration(Analysis):
    """The calibration of a site: computes the spectrum or sequence of every record, and from them the design."""

    name = "calibrate"
    doing = "calibrating"
    kind = SITE_KIND

    def __init__(self, config: Config, bodies: Blocks | None = None) -> None:
        super().__init__(config)
        self.block_names, self.lanes = self._bodies(config.bodies if bodies is None else bodies)
        rule = config.calibration.weighting
        self.weights = None if rule in WEIGHTS else read_weight_table(located(rule, config.folder))

    @property
    def work(self) -> Work:
        """The function that computes the spectrum or the sequence of one record."""
        if self.lanes is None or self.by_spectrum:
            return partial(site_spectrum_record, config=self.config)
        return partial(site_record, blocks=self.lanes, config=self.config)

    @property
    def by_spectrum(self) -> bool:
        """True if the design is an overturning spectrum instead of a sequence."""
        return self.config.calibration.method == "spectrum"

    @cached_property
    def empty_part(self) -> Part:
        """Empty arrays in place of the results of a record, for records without results."""
        if self.lanes is None or self.by_spectrum:
            return empty_spectrum_record()
        return empty_site_record(self.lanes)

    def _bodies(self, blocks: Blocks) -> tuple[list[str], Block | None]:
        """Return names and blocks of the bodies; without bodies, a sequence is designed for 100 standard blocks."""
        if not blocks and self.by_spectrum:
            return [], None
        if not blocks:
            lanes = block_family()
            named = np.column_stack([lanes.p, lanes.alpha_c, lanes.restitution])
            return [f"p {p:.3g} alpha {alpha:.3g} C {c:.3g}" for p, alpha, c in named], lanes
        bodies = gather_bodies(blocks)
        refuse_floors(bodies, "a site is calibrated on the motion of its ground")
        names, lanes, _ = bodies.apart()
        others = [name for name, free in zip(names, np.asarray(lanes.free), strict=True) if not free]
        if others and not self.by_spectrum:
            raise ConfigError(
                f"[[block]] {', '.join(others)}: a sequence for all bodies is calibrated on free-standing symmetric "
                'ones; leave them out, or set [calibration] method = "spectrum"'
            )
        return names, lanes

    def plan(self, records: Iterable[Record], failures: Iterable[Failure] = ()) -> Plan:
        """Return the plan of the calibration; raise ConfigError before any processing if a record has no weight."""
        plan = super().plan(records, failures)
        known = [name for one in plan.planned for name in planned_ids(one, self.config)]
        if self.weights is not None and known:
            record_weights(known, [], self.config.calibration.weighting, self.weights)
        return plan

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Compute the design of the site from the results of all records."""
        if not parts:
            rows = [row for row in failures if row.kind != "vertical"]
            reasons = "".join(f"\n  {reasons_in_words(group)}" for group in alike(rows))
            what = f"no record could be calibrated, so there is no site to describe{reasons}"
            raise NothingCalibrated(what, failures)
        done = joined(parts)
        ids, events = done["record"].tolist(), done["event"].tolist()
        weights = record_weights(ids, events, self.config.calibration.weighting, self.weights)
        rows = sorted(failures, key=lambda row: row.stage == "events")
        warnings = [row.reason for row in rows if row.stage == "events"]
        if self.lanes is None or self.by_spectrum:
            nodes = spectrum_design(done, weights, self.block_names, self.lanes, self.config, warnings)
            title = "Overturning spectrum of a site"
        else:
            nodes = sequence_design(done, weights, self.block_names, self.lanes, self.config, warnings)
            title = "Design sequence of impulses of a site"
        settings = self.config.calibration
        nodes["/site"].attrs |= {
            "method": settings.method,
            "scaled_to": settings.scale_to if settings.target is None else f"{settings.scale_to} {settings.target:g}",
            "weights": settings.weighting,
        }
        return self.described(xr.DataTree.from_dict({**nodes, "/failures": failure_table(rows)}), title)


def load_design(path: str | Path) -> DesignSpectrum | ImpulseSequence:
    """Read the design from a site file of ``rockpulse calibrate``: a design spectrum, or one sequence for all bodies.

    Parameters
    ----------
    path : str or Path
        A site file.

    Returns
    -------
    DesignSpectrum or ImpulseSequence

    Raises
    ------
    ResultsError
        For a file of another kind, or a site file with too few earthquakes for a design.
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


def design_of(tree: xr.DataTree, name: str = "site") -> DesignSpectrum | ImpulseSequence:
    """Return the design in a site tree in memory, as :func:`load_design` does for a file; messages call it `name`."""
    site = tree["site"].to_dataset()
    if site.attrs["method"] == "spectrum":
        spectra = tree["spectra"].to_dataset()
        if np.isnan(spectra["spectrum_design"].values).any():
            raise ResultsError(f"{name}: no design: {str(site['site_warnings'].item()).splitlines()[0]}")
        return DesignSpectrum(
            spectra["p"].values,
            spectra["restitution"].values,
            spectra["spectrum_design"].values,
            spectra["ratio"].values,
            spectra["main_count"].values.astype(int),
        )
    value = dict(zip(site["parameter"].values.tolist(), site["design"].values.tolist(), strict=True))
    return ImpulseSequence(
        main=value["main"],
        secondary=min(value["ratio"] * value["main"], value["main"]),
        interval=value["interval"],
        duration=math.inf if math.isnan(value["duration"]) else value["duration"],
        main_count=None if math.isnan(value["main_count"]) else int(value["main_count"]),
        spacing=str(site.attrs["spacing"]),
    )
