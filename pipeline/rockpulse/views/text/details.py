"""One record or one block of an assessment as text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rocking.response import Outcome
from rockpulse.record.record import STANDARD_GRAVITY
from rockpulse.storage.selection import Selection, unknown
from rockpulse.views.shared.record_marks import doubt
from rockpulse.views.shared.terminal import ABSENT, aligned, figure, paragraph, restitution
from rockpulse.views.text.capacity import capacities
from rockpulse.views.text.large_overview import is_large
from rockpulse.views.text.lists import answers, case_list, distinct, worst_first
from rockpulse.views.text.overview import (
    answered_by,
    cases,
    factor_table,
    fullest_model,
    peak_velocity,
    value,
    verdict_table,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["block_details", "record_details"]

_UNLIMITED = -1

#: Cases of a record or block that are shown where there are too many for all.
WORST = 20


def record_details(summary: xr.Dataset, record: str) -> str:
    """Everything known about one record: measures, sequence, processing, warnings, verdicts and safety factors.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    record : str
        Its id.

    Raises
    ------
    ResultsError
        For an id that is not in the results.
    """
    summary = _only(summary, "record", record)

    def number(name: str, unit: str) -> str:
        found = value(summary, name, record=record)
        return ABSENT if found is None else figure(float(found), unit)

    def words(name: str) -> str:
        return value(summary, name, record=record) or ABSENT

    pga, codes = (value(summary, name, record=record) for name in ("pga", "warning_codes"))
    rows = [
        ["source", words("source")],
        ["sha256 of the source", words("source_sha256")],
        ["station, component", f"{words('station')}, {words('component')} (azimuth {number('azimuth', 'degrees')})"],
        ["name of the station", words("station_name")],
        ["earthquake", words("event")],
        ["start", words("start_time")],
        ["samples", f"{value(summary, 'npts', record=record)} at {number('dt', 's')}"],
        ["PGA", f"{figure(pga, 'm/s2')} ({figure(pga / STANDARD_GRAVITY, 'g')}){doubt(pga, codes)}"],
        ["PGV", peak_velocity(summary, record)],
        ["Arias intensity", number("arias_intensity", "m/s")],
        ["intense phase", f"{number('intense_start', 's')} to {number('intense_end', 's')}"],
        ["half-waves in all", str(value(summary, "half_wave_count", record=record))],
        ["main impulse I", number("main_impulse", "m/s")],
        ["secondary impulse I_s", number("secondary_impulse", "m/s")],
        ["interval dT", number("secondary_interval", "s")],
        ["duration of the sequence", number("sequence_duration", "s")],
        ["main impulses", _main_count(summary, record)],
        *(["processing", step] for step in _steps(summary, record, "processing")),
        *(["warning", warning] for warning in _steps(summary, record, "warnings")),
    ]
    return _page(record, rows, summary, records=[record])


def block_details(summary: xr.Dataset, block: str) -> str:
    """Everything known about one block: size, parameters, restitution, warnings, verdicts, safety factors.

    Parameters
    ----------
    summary : xarray.Dataset
        The node /summary.
    block : str
        Its name.

    Raises
    ------
    ResultsError
        For a name that is not in the results.
    """
    summary = _only(summary, "block", block)

    def number(name: str, unit: str) -> str:
        if name not in summary:
            return ABSENT
        return figure(float(summary[name].sel(block=block)), unit)

    cases = dict.fromkeys(summary["restitution"].sel(block=block).values.ravel().tolist())
    by_p = math.isnan(value(summary, "width", block=block))
    warnings = [str(text) for text in summary["block_warnings"].sel(block=block).values.ravel()]
    rows = [
        ["width, height", f"{number('width', 'm')}, {number('height', 'm')}"],
        ["half the diagonal R", number("radius", "m") + (" (of the rectangle with this p)" if by_p else "")],
        ["critical angle alpha_c", number("alpha_c", "rad")],
        ["frequency parameter p", number("p", "1/s")],
        ["slenderness", number("slenderness", "")],
        ["restitution C", ", ".join(restitution(c) for c in cases)],
        ["critical impulse I_1c", number("critical_impulse", "m/s")],
        *(["warning", warning] for text in dict.fromkeys(warnings) for warning in _split(text)),
    ]
    return _page(block, rows, summary, blocks=[block])


def _page(title: str, rows: list[list[str]], summary: xr.Dataset, **which: Any) -> str:
    width = max(len(name) for name, _ in rows)
    lines = [paragraph(text, " " * (width + 4), f"  {name.ljust(width)}  ") for name, text in rows]
    head = [title, *lines, ""]
    if is_large(summary):
        model = fullest_model(summary)
        worst = case_list(summary, worst_first(summary, model, Selection(limit=WORST)))
        return "\n".join([*head, f"{_counts(summary, model)}.", "", worst])
    return "\n".join(
        [
            *head,
            verdict_table(summary, **which),
            "",
            *_answers_of_auto(summary, **which),
            *capacities(summary, fullest_model(summary), **which),
            "Safety factors: the smallest factor on the input of the model at which the block overturns",
            factor_table(summary, **which),
        ]
    )


def _counts(summary: xr.Dataset, model: str) -> str:
    """How the verdicts of a model are spread."""
    outcome = answers(summary, "outcome", model)
    assert outcome is not None
    found = outcome[:, distinct(summary)]
    told = [f"{int((found == one).sum())} {one.name.lower().replace('_', ' ')}" for one in Outcome]
    return f"{found.size} verdicts by the {model} model: {', '.join(told)}"


def _answers_of_auto(
    summary: xr.Dataset, records: list[str] | None = None, blocks: list[str] | None = None
) -> list[str]:
    """Lines that name, for every body under a record or every record on a body, the model that answered."""
    if "auto" not in summary["model"].values:
        return []
    rows = []
    for record in summary["record"].values.tolist() if records is None else records:
        for block in summary["block"].values.tolist() if blocks is None else blocks:
            for case in cases(summary, block):
                where = {"record": record, "block": block, "case": case}
                c = restitution(value(summary, "restitution", **where))
                rows.append(
                    [record if records is None else block, f"C {c}", answered_by(summary, model="auto", **where)]
                )
    return ["The model that answered for auto:", *("  " + line for line in aligned(rows, left=3)), ""]


def _main_count(summary: xr.Dataset, record: str) -> str:
    if math.isnan(value(summary, "main_impulse", record=record)):
        return ABSENT
    count = value(summary, "main_count", record=record)
    return "as many as fit into the duration" if count == _UNLIMITED else str(count)


def _steps(summary: xr.Dataset, record: str, name: str) -> list[str]:
    return _split(str(value(summary, name, record=record) or ""))


def _split(joined: str) -> list[str]:
    return [part for part in joined.split("\n") if part]


def _only(summary: xr.Dataset, dimension: str, label: str) -> xr.Dataset:
    """The summary of one record or block, read."""
    known = [str(item) for item in summary[dimension].values]
    if label not in known:
        raise unknown(label, known, dimension)
    return summary.isel({dimension: [known.index(label)]}).load()
