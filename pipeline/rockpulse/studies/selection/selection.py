"""Selection of records whose mean spectrum matches a target spectrum, and the tree of its results.

.. note:: Each spectrum is scaled so that its ratio to the target, averaged over the periods, is 1; all members are then
   about as strong as the target. Sets are built by greedy choice from several starts and improved by exchange of single
   members, so that the spread of their mean ratio to the target, its largest value over the periods divided by the
   smallest, is as small as possible. Finally, multiplying all scale factors by one number centres the deviations.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from rockpulse.config.configuration import Config, given_config, located
from rockpulse.errors import ConfigError, Failure, some
from rockpulse.record.components import find_pairs
from rockpulse.record.intensity import spectral_acceleration
from rockpulse.run.analysis import Analysis, Part, Records, Watch, Work, joined, run
from rockpulse.selection.directions import Motion, PlannedMotion
from rockpulse.selection.events import UNKNOWN
from rockpulse.storage.variables import Declared, along, failure_table, real, text, with_values
from rockpulse.studies.check.code_spectra import read_spectrum, spectrum_of

#: Number of periods, equally spaced in their logarithm, at which spectra are compared.
PERIODS = 60
#: The variables of the results.
SELECTION: Declared = {
    **along(("record",), factor=real("scale factor of the record"), event=text("earthquake of the record")),
    **along(("record", "period"), spectrum=real("5 % damped pseudo-acceleration of the scaled record", "m s^-2")),
    **along(
        ("period",),
        period=real("period of the oscillator", "s"),
        mean=real("mean of the spectra of the scaled records", "m s^-2"),
        target=real("target spectrum", "m s^-2"),
    ),
}


def select(
    records: Records,
    config: Config | str | os.PathLike[str] | None = None,
    failures: Iterable[Failure] = (),
    progress: Callable[[Sequence[PlannedMotion]], Iterable[PlannedMotion]] | None = None,
    *,
    units: str | None = None,
    dt: float | None = None,
) -> xr.DataTree:
    """Select records and scale factors so that their mean spectrum fits a target spectrum.

    Parameters
    ----------
    records : path, Record, or iterable of either
        Paths or all channels; read, selected, rotated and conditioned as in :func:`rockpulse.assess`.
    config : Config or path, optional
        Configuration with the sections records, conditioning, selection and, without a table of the target, check.
    failures, progress, units, dt
        As for :func:`rockpulse.assess`.

    Returns
    -------
    xarray.DataTree
        /selection over (record): `factor` [-] and `event`; over (record, period): `spectrum`, the scaled 5 % damped
        pseudo-acceleration [m/s2]; over (period): `mean` and `target` [m/s2]. The mean is that of the records or, for
        pairs, of the geometric means of both channels. Its attributes `lowest`, `highest`, `mean_deviation` and
        `mean_absolute_deviation` are deviations of the mean, as fractions of the target; `compatible` is 1 if the first
        two are within `tolerance`. Records that are not used are rows of /failures.

    Raises
    ------
    ConfigError
        Without a target spectrum, for a target that does not cover the periods, or if fewer records of different
        earthquakes can be used than are requested.

    Notes
    -----
    The scale factor of a record makes the mean over the periods of its spectrum divided by the target equal to 1. Then
    all scale factors are multiplied by one number, which centres the deviations of the mean. Sets are searched by
    greedy choice and exchange.

    Examples
    --------
    >>> spectrum = rp.CheckSettings(spectrum="en_1998_1", ag=0.2, ground="B")
    >>> asked = rp.SelectionSettings(records=1, factors=(0.1, 10.0))
    >>> tree = rp.select(record, rp.Config(selection=asked, check=spectrum))
    >>> tree["selection"].sizes["record"], tree["selection"].attrs["compatible"]  # one pulse is no wide spectrum
    (1, 0)
    """
    return run(SelectionAnalysis(given_config(config, units, dt)), records, failures, progress)


class SelectionAnalysis(Analysis):
    """The selection: computes the spectrum of every record, and searches for the set that matches the target best."""

    name = "select"
    doing = "computing spectra"
    kind = "selection"

    def __init__(self, config: Config) -> None:
        super().__init__(config)
        if config.records.components == "strongest":
            raise ConfigError(
                '[records] components: "strongest" gives records whose ids are known only after the run; use '
                '"horizontal", "azimuth" or "sweep"'
            )
        if config.selection.components == "pairs" and config.records.components != "horizontal":
            raise ConfigError(
                '[selection] components: "pairs" needs the channels as recorded, found [records] components = '
                f'"{config.records.components}"; use "horizontal" there, or "channels" here'
            )
        self.periods = np.geomspace(*config.selection.periods, PERIODS)
        self.target, self.target_words = target_spectrum(config, self.periods)

    @property
    def work(self) -> Work:
        """The function that computes the spectrum of one record."""
        return partial(record_spectrum, periods=self.periods)

    @property
    def empty_part(self) -> Part:
        """The arrays of :func:`record_spectrum`, and "event", with no rows."""
        none = np.zeros(0, dtype=str)
        return {"record": none, "event": none, "spectrum": np.zeros((0, PERIODS))}

    def collect(self, parts: Sequence[Part], planned: Sequence[PlannedMotion], failures: list[Failure]) -> xr.DataTree:
        """Search for the set of records, and return the tree of results."""
        asked, rows = self.config.selection, joined([self.empty_part, *parts])
        place = {str(name): row for row, name in enumerate(rows["record"])}
        groups = [[row] for row in place.values()]
        if asked.components == "pairs":
            pairs, alone = find_pairs([one.channels[0] for one in planned if one.name in place])
            groups = [[place[channel.id] for channel in pair.channels] for pair in pairs]
            if alone:
                reason = f"channels without a known partner ({len(alone)}): {some([row.reason for row in alone], 1)}"
                failures = [*failures, Failure("[selection] components", "pair", reason, "skipped")]
        spectra = rows["spectrum"]
        with np.errstate(divide="ignore"):
            ratios = np.array([np.exp(np.log(spectra[group]).mean(axis=0)) for group in groups]) / self.target
        events = [str(rows["event"][group[0]]) for group in groups]
        ratios = ratios.reshape(-1, PERIODS)
        self._require_enough(own_factors(ratios, asked.factors), events)
        found = fitting_set(ratios, events, asked.records, asked.factors, asked.per_earthquake, asked.tolerance)
        chosen = [row for member in found.members for row in groups[member]]
        factor = np.repeat(found.factors, [len(groups[member]) for member in found.members])
        deviation = found.ratio - 1.0
        values = {
            "factor": factor,
            "event": rows["event"][chosen],
            "spectrum": factor[:, None] * spectra[chosen],
            "target": self.target,
            "mean": found.ratio * self.target,
        }
        coords = {"record": rows["record"][chosen].tolist(), "period": SELECTION["period"].variable(self.periods)}
        low, high = float(deviation.min()), float(deviation.max())
        attrs = {
            "target": self.target_words,
            "candidates": len(groups),
            "components": asked.components,
            "tolerance": list(asked.tolerance),
            "lowest": low,
            "highest": high,
            "mean_deviation": float(deviation.mean()),
            "mean_absolute_deviation": float(np.abs(deviation).mean()),
            "compatible": int(low >= -asked.tolerance[0] and high <= asked.tolerance[1]),
        }
        whole = xr.Dataset(with_values({name: SELECTION[name] for name in values}, values), coords, attrs)
        tree = xr.DataTree.from_dict({"/selection": whole, "/failures": failure_table(failures)})
        return self.described(tree, "Selection of records by their mean spectrum")

    def _require_enough(self, factors: np.ndarray, events: Sequence[str]) -> None:
        """Raise ConfigError if fewer records of different earthquakes can be used than were requested."""
        asked = self.config.selection
        usable = Counter(event for event, factor in zip(events, factors, strict=True) if np.isfinite(factor))
        enough = sum(min(asked.per_earthquake, count) for count in usable.values())
        if enough >= asked.records:
            return
        unknown = "; name the earthquakes of the records in the table [records] events" if usable[UNKNOWN] else ""
        raise ConfigError(
            f"[selection] records: expected {asked.records} {asked.components} that can be selected, at most "
            f"{asked.per_earthquake} of each earthquake, found {enough}. Of {len(events)} {asked.components}, "
            f"{usable.total()} (of {len(usable)} earthquake{'s' * (len(usable) != 1)}) have a scale "
            f"factor from {asked.factors[0]:g} to {asked.factors[1]:g}. Give more record files, or change the keys "
            f"records, factors or per_earthquake{unknown}"
        )


def record_spectrum(motion: Motion, watch: Watch, periods: np.ndarray) -> Part:
    """Return id and 5 % damped pseudo-acceleration [m/s2] of one record at the periods [s], as arrays of one row."""
    with watch("solve"):
        spectrum = [spectral_acceleration(motion.record, period) for period in periods.tolist()]
    return {"record": np.array([motion.record.id]), "spectrum": np.array([spectrum])}


def target_spectrum(config: Config, periods: np.ndarray) -> tuple[np.ndarray, str]:
    """Return the target spectrum [m/s2] at the periods [s], from [selection] or else [check], and its name."""
    if config.selection.target is None:
        if not config.check.given:
            raise ConfigError(
                "[selection] target: no target spectrum is given; state target, a CSV table, or the spectrum of [check]"
            )
        spectrum = spectrum_of(config.check, config.folder)
        return np.array([spectrum(period) for period in periods.tolist()]), spectrum.words
    path = located(config.selection.target, config.folder)
    period, acceleration = read_spectrum(path)
    if period.size < 2 or period[0] > periods[0] or period[-1] < periods[-1]:
        ends = f"{period[0]:g} to {period[-1]:g} s" if period.size else "no period"
        raise ConfigError(
            f"{path}: expected a target from {periods[0]:g} to {periods[-1]:g} s, as [selection] periods, found {ends}"
            "; extend the table, or change periods"
        )
    return np.interp(periods, period, acceleration), str(path)


#: Largest number of spectra from which a search begins: the spectra with the shapes nearest to the target.
STARTS = 40


class SpectrumSet(NamedTuple):
    """A set of spectra: their indices in ascending order, their scale factors, and their mean."""

    members: np.ndarray  #: (n,) indices
    factors: np.ndarray  #: (n,) scale factors [-]
    ratio: np.ndarray  #: (k,) mean of the scaled spectra divided by the target [-]


def own_factors(ratios: np.ndarray, bounds: tuple[float, float]) -> np.ndarray:
    """Return the scale factor that makes the mean of each row of `ratios` 1; NaN for scale factors outside `bounds`."""
    with np.errstate(divide="ignore"):
        factors = 1.0 / ratios.mean(axis=1)
    return np.where((factors >= bounds[0]) & (factors <= bounds[1]), factors, np.nan)


def fitting_set(
    ratios: np.ndarray,
    events: Sequence[str],
    count: int,
    bounds: tuple[float, float],
    per_event: int = 1,
    tolerance: tuple[float, float] = (0.1, 0.3),
) -> SpectrumSet:
    """Return the set of `count` spectra whose mean is nearest to the target, from (m, k) `ratios` of spectra to it.

    At least `count` spectra, at most `per_event` of each earthquake, must have a scale factor within the bounds. All
    scale factors are multiplied by the number that centres the deviations from the target, or by the nearest number
    with which all deviations are within the `tolerance` (below and above the target), if there is such a number.
    """
    own = own_factors(ratios, bounds)
    usable = np.flatnonzero(np.isfinite(own))
    shapes, codes = ratios[usable] * own[usable, None], np.unique(np.asarray(events)[usable], return_inverse=True)[1]
    starts = np.argsort(_spread(shapes), kind="stable")[:STARTS].tolist()
    found = [_exchanged(shapes, codes, _greedy(shapes, codes, start, count, per_event), per_event) for start in starts]
    members = np.sort(min(found, key=lambda one: float(_spread(shapes[one].sum(axis=0)))))
    ratio, factors = shapes[members].mean(axis=0), own[usable[members]]
    low, high = float(ratio.min()), float(ratio.max())
    common, least, most = 2.0 / (low + high), (1.0 - tolerance[0]) / low, (1.0 + tolerance[1]) / high
    if least <= most:
        common = min(max(common, least), most)
    common = min(max(common, bounds[0] / factors.min()), bounds[1] / factors.max())
    return SpectrumSet(usable[members], common * factors, common * ratio)


def _spread(ratios: np.ndarray) -> np.ndarray:
    """Return the largest ratio over the periods divided by the smallest."""
    return np.asarray(ratios.max(axis=-1) / ratios.min(axis=-1))


def _best(shapes: np.ndarray, codes: np.ndarray, others: list[int], per_event: int) -> tuple[float, int]:
    """Find the spectrum that, added to the others, gives the smallest spread; return this spread and its index."""
    taken = np.bincount(codes[others], minlength=codes.max() + 1)[codes] >= per_event
    taken[others] = True
    spread = np.where(taken, np.inf, _spread(shapes[others].sum(axis=0) + shapes))
    place = int(np.argmin(spread))
    return float(spread[place]), place


def _greedy(shapes: np.ndarray, codes: np.ndarray, start: int, count: int, per_event: int) -> list[int]:
    members = [start]
    while len(members) < count:
        members.append(_best(shapes, codes, members, per_event)[1])
    return members


def _exchanged(shapes: np.ndarray, codes: np.ndarray, members: list[int], per_event: int) -> list[int]:
    """Exchange one member at a time for the smallest spread, until no exchange reduces it; return the members."""
    spread = float(_spread(shapes[members].sum(axis=0)))
    while True:
        others = [members[:place] + members[place + 1 :] for place in range(len(members))]
        found = [(*_best(shapes, codes, rest, per_event), rest) for rest in others if rest]
        best = min(found, key=lambda one: one[0], default=(np.inf, 0, []))
        if not best[0] < spread * (1.0 - 1e-12):
            return members
        spread, members = best[0], [*best[2], best[1]]
