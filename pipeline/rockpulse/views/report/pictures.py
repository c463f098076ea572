"""The pictures of the page: drawn when the template asks for them, each with ids of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from rockpulse.assessment.answers import Answers, answers_of, fullest_model
from rockpulse.errors import ResultsError
from rockpulse.views.plots.selection import plain_bodies
from rockpulse.views.report.record_strip import strip
from rockpulse.views.report.wording import Words
from rockpulse.views.shared.answer_cells import NAMES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from rockpulse.views.report.content import Content
    from rockpulse.views.report.pairing import Paired

__all__ = ["Picture", "Pictures"]

#: Records that are drawn with their half-waves and impulses: all, or of more those that govern a body.
IN_FULL = 20

#: Records in the map of a body: those of the smallest factors.
IN_A_MAP = 20


@dataclass(frozen=True)
class Picture:
    """An element `<svg>` with its caption; where there is no picture, an empty one and the reason."""

    svg: Markup
    words: str


class Pictures:
    """The pictures of one report, by row of /summary and place of the block."""

    def __init__(
        self, words: Words, tree: xr.DataTree, site: Paired | None, fragility: Paired | None, content: Content
    ) -> None:
        self._words, self._tree = words, tree
        self._site, self._fragility = (None if other is None else other.tree for other in (site, fragility))
        self._summary = tree["summary"].to_dataset()
        stored = tree["records"].to_dataset() if "records" in tree.children else None
        self._stored = None if stored is None or "acceleration" not in stored else stored
        self._ends = None if self._stored is None else np.cumsum(self._stored["row_size"].values)
        count = self._summary.sizes["record"]
        self._found = content.found
        governing = {one.governing for one in content.found if one.governing >= 0}
        self._in_full = set(range(count)) if count <= IN_FULL else set(sorted(governing)[:IN_FULL])

    def strip(self, record: int) -> Picture:
        """The accelerogram of a record, small."""
        if self._stored is None or self._ends is None:
            return Picture(Markup(""), self._words("picture.not_stored"))
        end = int(self._ends[record])
        acceleration = self._stored["acceleration"].values[end - int(self._stored["row_size"].values[record]) : end]
        if acceleration.size < 2:
            return Picture(Markup(""), self._words("picture.not_stored"))
        one = self._summary.isel(record=record)
        drawn = strip(acceleration, float(one["dt"]), (float(one["intense_start"]), float(one["intense_end"])))
        return Picture(Markup(drawn), self._words("picture.strip"))

    def in_full(self, record: int) -> Picture | None:
        """The accelerogram with half-waves and impulses; None for a record that is shown as a strip."""
        if self._stored is None or record not in self._in_full:
            return None
        from rockpulse.views.plots.ground_motion import accelerogram
        from rockpulse.views.plots.motion import stored_motion

        name = str(self._summary["record"].values[record])
        return _drawn(
            lambda: accelerogram(stored_motion(self._tree, name))[0],
            f"record{record}",
            self._words("picture.in_full"),
        )

    def body(self, block: int, name: str = "body") -> Picture:
        """Factors on the records at which a body overturns, and the windows between them."""
        from rockpulse.views.plots.critical_factors import overturning_map

        body = str(self._summary["block"].values[block])
        answers = Answers(self._summary)
        if not answers.probable and "overturning_intervals" not in self._tree.children:
            return Picture(Markup(""), self._words("picture.no_factors"))
        lowest = answers.by_block(np.fmin, answers[answers.factor])[:, block]
        # The map counts the records without a factor.
        many = np.count_nonzero(np.isfinite(lowest)) > IN_A_MAP
        rows = np.sort(
            np.argsort(np.where(np.isnan(lowest), np.inf, lowest), kind="stable")[: IN_A_MAP if many else None]
        )
        factor = self._words.shared(NAMES[answers.factor])
        few = self._words("picture.map_few", count=rows.size, factor=factor) if rows.size < lowest.size else ""
        return _drawn(
            lambda: overturning_map(_of_records(self._tree, rows), block=body),
            f"{name}{block}",
            self._words("picture.map", few=few),
        )

    def motion(self, block: int) -> Picture | None:
        """The rotation of a body in time under the record that comes nearest to overturning it, or beyond it.

        By the model of the verdict alone: another one that overturns would hide it. None where the accelerograms are
        not stored, for many bodies, where no record stands out, and where the model has no motion in time.
        """
        own = [one for one in self._found if one.body.place == block and one.governing >= 0]
        from rockpulse.views.plots.model_histories import DRAWN, histories

        model = fullest_model(self._summary)
        if self._stored is None or not own or self._summary.sizes["block"] > IN_FULL or model not in DRAWN:
            return None
        from rockpulse.views.plots.rotation import rotation_history

        worst = min(own, key=lambda one: one.margin.smallest)
        record, body = str(self._summary["record"].values[worst.governing]), worst.body

        def draw() -> Axes:
            found = histories(self._tree, record, body.block, [model], body.case + 1)
            if not found[0].time.size:
                raise ResultsError(f"{body.name} under {record}, {model} model: {found[0].remark}.")
            ax: Axes = rotation_history(found)[0]
            return ax

        return _drawn(
            draw,
            f"motion{block}",
            self._words("picture.rotation", body=body.name, record=record, model=self._words.shared(model)),
        )

    def explaining(self) -> list[Picture]:
        """The pictures that explain the verdict: the overturning spectra of the records with the bodies as points.

        Of bodies that no spectrum stands for, as one that is tied, the factors that overturn the one of the worst
        verdict; of a design sequence the spectrum of its site.
        """
        if answers_of(self._tree).motions.kind == "sequence":
            return [] if self._site is None else [self.site()]
        found, plain = [], []
        spectra = self._tree["spectra"].to_dataset() if "spectra" in self._tree.children else None
        if spectra is not None and np.isfinite(spectra["spectrum"].values).any():
            plain = plain_bodies(self._summary)
        if spectra is not None and plain:
            draw = partial(_spectra, self._words, self._tree, spectra)
            found.append(_drawn(draw, "spectra", self._words("picture.spectra")))
        others = [one for one in self._found if one.body.block not in plain]
        if others:
            worst = max(others, key=lambda one: (one.overall, one.decides.value))
            found.append(self.body(worst.body.place, "front"))
        return found

    def site(self) -> Picture:
        """The records of the site, and its design; only asked for with a site."""
        from rockpulse.views.plots.site import calibration

        tree = self._site
        assert tree is not None
        return _drawn(
            lambda: calibration(tree).flat[0],
            "site",
            self._words(f"picture.site_{'spectrum' if tree['site'].attrs['method'] == 'spectrum' else 'parameters'}"),
        )

    def fragility(self, block: str) -> Picture:
        """The curves of a body; only asked for with a fragility file."""
        from rockpulse.views.plots.fragility_curves import fragility_panels

        tree = self._fragility
        assert tree is not None
        place = tree["fragility"].to_dataset().get_index("block").get_loc(block)
        return _drawn(
            lambda: fragility_panels(tree, block)[0],
            f"fragility{place}",
            self._words("picture.fragility"),
        )


def _spectra(words: Words, tree: xr.DataTree, spectra: xr.Dataset) -> Axes:
    """The stored spectra at the C of most bodies; straight between the bodies where only these were marched."""
    from rockpulse.views.plots.overturning_curves import spectra_of_results

    ax = spectra_of_results(tree, spectra)
    ax.set_xlabel(words("picture.spectra_x"))
    ax.set_ylabel(words("picture.spectra_y"))
    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.supxlabel("")  # the page has words of its own below it
    return ax


def _of_records(tree: xr.DataTree, rows: np.ndarray) -> xr.DataTree:
    """The groups that a map of overturning takes, of some records only."""
    summary = tree["summary"].to_dataset().isel(record=rows)
    nodes = {"/summary": summary}
    if "overturning_intervals" in tree.children:
        nodes["/overturning_intervals"] = _of_rows(tree["overturning_intervals"].to_dataset(), rows)
    found = type(tree).from_dict(nodes)
    found.attrs = tree.attrs
    return found


def _of_rows(intervals: xr.Dataset, rows: np.ndarray) -> xr.Dataset:
    index = intervals["record_index"]
    kept = np.isin(index.values, rows)
    place = index[kept].copy(data=np.searchsorted(rows, index.values[kept]))
    return intervals.isel(interval=kept).assign(record_index=place)


def _drawn(draw: Callable[[], Axes], name: str, words: str) -> Picture:
    """A picture of rockpulse.views.plots; what it refuses to draw is said in its place."""
    from rockpulse.views.plots.picture import svg

    try:
        figure = draw().get_figure(root=True)
    except ResultsError as reason:
        return Picture(Markup(""), str(reason))
    assert figure is not None
    return Picture(Markup(svg(figure, name)), words)
