"""Makes the report sections on a site file and a fragility file, after checking that they match the results."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from rockpulse.assessment.answers import Answers, Body, bodies_of
from rockpulse.config.configuration import stored_sections
from rockpulse.errors import ResultsError, some
from rockpulse.model_table import MODELS, SEQUENCE_MODELS
from rockpulse.record.measures import PGA
from rockpulse.storage.variables.fragility import FRAGILITY
from rockpulse.storage.variables.site import SITE_KIND
from rockpulse.views.shared.files_used import files_used
from rockpulse.views.shared.table import Cell, Heading, Table, number_cell
from rockpulse.views.shared.table_columns import tabulated, titled
from rockpulse.views.shared.words import body_name, counted_words, listed, say
from rockpulse.views.text import fragility as curves_text
from rockpulse.views.text.site import about_records, coverage, sequence_words, site_tables, site_warnings

#: Relative tolerance within which sizes are equal.
TOLERANCE = 1e-6
#: Relative tolerance of scale factors on a sequence, which are found by a search.
SEARCHED = 0.02
#: Name of each kind of file, and the command that makes it.
_MADE_BY = {FRAGILITY: ("fragility file", "rockpulse fragility"), SITE_KIND: ("site file", "rockpulse calibrate")}
#: Pattern of the name that these files give to a body with several restitutions.
_WITH_RESTITUTION = re.compile(r"(?P<block>.+) C [0-9.e+-]+")
#: Settings that change the ground motion of a channel.
_OF_THE_MOTION = {
    "records": ("components", "azimuth", "azimuth_step", "units", "dt", "response", "include_vertical"),
    "conditioning": None,
}

_ASSESS_AGAIN = "run 'rockpulse assess --sequence' with this site file, or give the one that it was run with"
#: Largest number of names in a sentence.
NAMED = 6


@dataclass(frozen=True, eq=False)
class MatchedFile:
    """A site or fragility file in the report: its data for bodies of the results, and differences from the results."""

    tree: xr.DataTree
    missing: tuple[str, ...]  # bodies only in the results
    foreign: tuple[str, ...]  # bodies only in the other file
    same: int  # records of both: with equal id and PGA, or equal id if the file has no PGA
    unchecked: int  # number of these compared only by id
    changed: tuple[str, ...]  # records with equal id and different PGA
    settings: tuple[str, ...]  # different settings of the motions: "[conditioning] order = 2, here 4"

    def other_motions(self, subject: str, assessed: int) -> list[str]:
        """Return warnings if the file was made from other records; empty if a design sequence was assessed."""
        if not assessed:
            return []
        conditions = {
            f"{subject}.other_motions": not self.same,
            "matched_file.unchecked": self.unchecked,
            "matched_file.changed": self.changed,
            "matched_file.settings": self.settings,
        }
        fields = {"records": listed(self.changed), "settings": "; ".join(self.settings)}
        return [say(key, **fields) for key, there in conditions.items() if there]


def matched_file(results: xr.DataTree, other: xr.DataTree, kind: str, name: str) -> MatchedFile:
    """Compare a site or fragility file with the results; raise ResultsError if bodies or design spectra differ."""
    summary = results["summary"].to_dataset()
    site = other["site" if kind == SITE_KIND else FRAGILITY].to_dataset()
    kept, missing, foreign = _bodies(summary, site, kind, name)
    if kind == SITE_KIND:
        if Answers(summary).motions.kind == "sequence":
            _check_factors(summary, site, name)
        ids, pga = site["record"].values, (site["pga"] / site["scale_factor"]).values
    else:
        if not kept:
            raise ResultsError(
                f"{name}: none of its bodies ({some(foreign, NAMED)}) is a body of the results "
                f"({some(missing, NAMED)}); run 'rockpulse fragility' with the configuration of these results"
            )
        nodes = other.children.items()
        own = {place: node.to_dataset().isel(block=kept, missing_dims="ignore") for place, node in nodes}
        other = type(other).from_dict({"/": other.to_dataset(), **own})
        ids, pga = _of_capacities(other["capacities"].to_dataset())
    assessed = dict(zip(map(str, summary["record"].values), summary["pga"].values.tolist(), strict=True))
    common = {str(record): float(peak) for record, peak in zip(ids, pga, strict=True) if str(record) in assessed}
    changed = tuple(record for record, peak in common.items() if not _close((assessed[record],), (peak,)))
    unchecked = sum(np.isnan(peak) for peak in common.values())
    settings = _other_settings(results, other)
    return MatchedFile(other, missing, foreign, len(common) - len(changed), unchecked, changed, settings)


def _bodies(
    summary: xr.Dataset, other: xr.Dataset, kind: str, name: str
) -> tuple[list[int], tuple[str, ...], tuple[str, ...]]:
    """Return the block indices of common bodies, the names only in the results, and the names only in the file."""
    bodies = bodies_of(summary)
    found: dict[Body, int] = {}
    foreign = []
    for place, label in enumerate(str(label) for label in other["block"].values):
        numbers = tuple(float(other[key].values[place]) for key in ("p", "alpha_c", "restitution"))
        own = [body for body in bodies if body.block == label]
        named = None if own else _WITH_RESTITUTION.fullmatch(label)
        if named:
            own = [body for body in bodies if body.block == named["block"]]
        of_results = [summary[key].values for key in ("p", "alpha_c")]
        every = {body: (*(float(values[body.place]) for values in of_results), body.restitution) for body in own}
        same = [body for body in own if _close(every[body], numbers)]
        if same:
            found.setdefault(same[0], place)
        elif own and not (named and any(_close(one[:2], numbers[:2]) for one in every.values())):
            words, verb = _MADE_BY[kind]
            raise ResultsError(
                f'{name}: this {words} has another body of the name "{own[0].block}": {_size(numbers)}; in the results '
                f"it has {' or '.join(map(_size, every.values()))}; run '{verb}' again with the configuration of these "
                "results, or give the other body another name"
            )
        elif label not in foreign:  # also in the results, but with another restitution
            foreign.append(label)
    missing = tuple(body.name for body in bodies if body not in found)
    return sorted(found.values()), missing, tuple(foreign)


def _of_capacities(capacities: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return the record ids of a fragility file and the PGA of each record, NaN if the file does not contain it."""
    ids = capacities["record"].values
    if PGA not in capacities["measure"].values or not capacities.sizes["block"]:
        return ids, np.full(ids.size, np.nan)
    return ids, capacities["measure_value"].sel(measure=PGA).isel(block=0).values


def _check_factors(summary: xr.Dataset, site: xr.Dataset, name: str) -> None:
    """Raise ResultsError if the scale factors of the bodies do not follow from the design spectrum of the site."""
    designed = dict(zip(map(str, site["block"].values), site["design_factor"].values.tolist(), strict=True))
    model = next(name for name in map(str, summary["model"].values) if MODELS[name].paired)
    factors = summary["safety_factor"].isel(record=0).sel(model=model)
    for body in bodies_of(summary):
        here = float(factors.isel(block=body.place).isel(case=body.case, missing_dims="ignore"))
        there = designed.get(body.name, np.nan)
        if np.isfinite(here) and abs(here / there - 1.0) > SEARCHED:
            raise ResultsError(
                f"{name}: the assessed design spectrum is not from this file: the scale factor of {body.name} is "
                f"{here:.7g} in the results, {there:.7g} in the site file; {_ASSESS_AGAIN}"
            )


def _other_settings(results: xr.DataTree, other: xr.DataTree) -> tuple[str, ...]:
    here, there = (stored_sections(str(one.attrs.get("configuration", ""))) for one in (results, other))
    said = []
    for section, keys in _OF_THE_MOTION.items():
        own, others = here.get(section, {}), there.get(section, {})
        for key in keys or sorted({*own, *others}):
            if own.get(key) != others.get(key):
                said.append(f"[{section}] {key} = {_set(others.get(key))}, here {_set(own.get(key))}")
    own, others = ({block.get("gravity") for block in one.get("block", [])} for one in (here, there))
    if own and others and own != others:
        said.append(f"[[block]] gravity = {', '.join(map(_set, others))}, here {', '.join(map(_set, own))}")
    return tuple(said)


def _close(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Return whether all pairs of numbers agree within the tolerance; NaN agrees with every number."""
    known = ~np.isnan(np.add(one, other))
    return bool(np.allclose(np.array(one)[known], np.array(other)[known], rtol=TOLERANCE, atol=0.0))


def _size(numbers: tuple[float, ...]) -> str:
    return "p {:.7g} 1/s, alpha_c {:.7g} rad, C {:.7g}".format(*numbers)


def _set(value: Any) -> str:
    return "not set" if value is None else str(value)


@dataclass(frozen=True)
class ReportSection:
    """A report section; curves of ``blocks`` are drawn; ``banded`` is False if no curve has a confidence band."""

    warnings: tuple[str, ...]
    statements: tuple[str, ...]
    tables: tuple[Table, ...]
    blocks: tuple[str, ...] = ()
    banded: bool = True


def describe_site(of: MatchedFile, assessed: int) -> ReportSection:
    """Return the section on the site; `assessed` is the number of assessed records, 0 for a design sequence."""
    site = of.tree["site"].to_dataset()
    said, tables = [sequence_words(site), coverage(site)], [*site_tables(site), _every_record(site)]
    common = [say("site.common" if assessed else "site.judged_here", same=of.same, assessed=assessed)]
    if of.foreign:
        bodies, names = counted_words(site.sizes["block"], "body"), listed(of.foreign)
        common.append(say("site.foreign", bodies=bodies, count=len(of.foreign), names=names))
    warnings = (*_not_used(of), *of.other_motions("site", assessed), *site_warnings(site))
    return ReportSection(warnings, (*about_records(site), *common, *said), tuple(tables))


def _not_used(of: MatchedFile) -> list[str]:
    """Describe the input files that the site or the curves do not use; empty if all files were used."""
    files = files_used(of.tree)
    return [f"{files.counted or say('warning.files.none')}: {files.reasons}."] if files.line else []


def _every_record(site: xr.Dataset) -> Table:
    selected = (
        titled(say("head.record"), Cell, "record"),
        titled(say("head.earthquake"), Cell, "event"),
        titled(say("site.weight"), number_cell, "weight"),
        titled(say("site.factor"), number_cell, "scale_factor"),
        titled("PGA", number_cell, "pga", unit="m/s2"),
        titled("PGV", number_cell, "pgv", unit="m/s"),
        titled("I_s/I", number_cell, "record_ratio"),
        titled("dT", number_cell, "record_interval", unit="s"),
        titled("N", number_cell, "record_main_count"),
    )
    return tabulated("site-records", say("site.caption.records"), selected, site)


def describe_fragility(of: MatchedFile, assessed: int, model: str) -> ReportSection:
    """Return the section on fragility; `assessed` is the number of assessed records, 0 for a design sequence."""
    tree = of.tree
    curves = tree["fragility"].to_dataset()
    own = curves.sel(measure=curves_text.displayed_measure(curves))
    common = say("fragility.common" if assessed else "fragility.sequence", same=of.same, assessed=assessed)
    data = say(f"fragility.{tree.attrs['data']}")
    said = say("fragility.from", records=curves_text.records_words(tree), common=common, data=data)
    warnings = [*_not_used(of), *of.other_motions("fragility", assessed)]
    equation = stored_sections(str(tree.attrs.get("configuration", ""))).get("fragility", {}).get("equation", model)
    if equation != model and model not in SEQUENCE_MODELS:
        warnings.append(say("fragility.equation", equation=say(f"models.{equation}"), model=say(f"models.{model}")))
    named = {"missing": of.missing, "foreign": of.foreign}
    warnings += [say(f"fragility.{key}", names=listed(names)) for key, names in named.items() if names]
    of_measures = curves_text.sufficiency_tables(tree["efficiency"].to_dataset())
    tables = tuple(one for one in (curves_text.median_table(tree), _warning_table(own), *of_measures) if one.rows)
    banded = bool(own["median_low"].notnull().any())
    return ReportSection(tuple(warnings), (said,), tables, tuple(own["block"].values.tolist()), banded)


def _warning_table(own: xr.Dataset) -> Table:
    rows = []
    for block in own["block"].values.tolist():
        found: dict[str, list[str]] = {}
        for state in own["limit_state"].values.tolist():
            if said := curves_text.statement(own.sel(block=block, limit_state=state)):
                found.setdefault(said, []).append(curves_text.state_words(state))
        rows += [(Cell(body_name(block)), Cell(", ".join(states)), Cell(said)) for said, states in found.items()]
    headings = tuple(Heading(say(key)) for key in ("head.body", "fragility.limit_states", "fragility.warning"))
    return Table("fragility-warnings", say("fragility.warnings"), headings, tuple(rows))
