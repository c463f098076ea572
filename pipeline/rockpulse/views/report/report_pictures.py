"""The pictures of the report; a picture is drawn when a template needs it, and its SVG has unique ids."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from markupsafe import Markup
from matplotlib.axes import Axes

from rockpulse.assessment.answers import Answers, answers_of, fullest_model
from rockpulse.assessment.verdict import BodyVerdict
from rockpulse.errors import ResultsError
from rockpulse.model_table import DRAWN
from rockpulse.storage.variables.probability import RESTITUTIONS
from rockpulse.views.plots.selection import plain_bodies
from rockpulse.views.report.body_drawings import strip
from rockpulse.views.report.site_and_fragility import MatchedFile
from rockpulse.views.report.verdict import by_severity
from rockpulse.views.shared.formatting import three_digits
from rockpulse.views.shared.words import body_name, result_text, say
from rockpulse.warning_text import PLAIN

#: Number of records up to which all are drawn with half-waves and impulses; of more, only governing records.
IN_FULL = 20
#: Largest number of records in the map of a body, which are those with the smallest scale factors.
IN_A_MAP = 20


@dataclass(frozen=True)
class PageElement:
    """A picture as an `<svg>` element with its caption; if it cannot be drawn, ``words`` states the reason."""

    svg: Markup
    words: str


class Pictures:
    """Draws the pictures of a report; a record is given by its row in /summary, a body by its index along block."""

    def __init__(
        self,
        tree: xr.DataTree,
        site: MatchedFile | None,
        fragility: MatchedFile | None,
        found: list[BodyVerdict],
        progress: Callable[[Sequence[int]], Iterable[int]] | None = None,
    ) -> None:
        self._tree = tree
        self._site, self._fragility = (None if other is None else other.tree for other in (site, fragility))
        self._summary = tree["summary"].to_dataset()
        axes = ("record", "block")
        self._records, self._blocks = ([str(name) for name in self._summary[axis].values] for axis in axes)
        stored = tree["records"].to_dataset() if "records" in tree.children else None
        self._stored = None if stored is None or "acceleration" not in stored else stored
        self._found = found
        governing = {one.recorded.governing for one in found if one.recorded.governing >= 0}
        few = len(self._records) <= IN_FULL
        planned = range(2 * len(self._blocks) + len(self._records))  # calls of `body`, `motion` and `in_full`
        self._steps = iter(planned if progress is None else progress(planned))
        self._in_full = set(range(len(self._records))) if few else set(sorted(governing)[:IN_FULL])

    def strip(self, record: int) -> PageElement:
        """Return the small accelerogram of a record."""
        acceleration = self._acceleration(record)
        if acceleration.size < 2:
            return PageElement(Markup(""), say("picture.not_stored"))
        one = self._summary.isel(record=record)
        phase = float(one["intense_start"]), float(one["intense_end"])
        return PageElement(Markup(strip(acceleration, float(one["dt"]), phase)), say("picture.strip"))

    def _acceleration(self, record: int) -> np.ndarray:
        if self._stored is None:
            return np.zeros(0)
        last = int(self._stored["row_size"].values[: record + 1].sum())
        return np.asarray(self._stored["acceleration"].values)[last - int(self._stored["row_size"][record]) : last]

    def in_full(self, record: int) -> PageElement | None:
        """Return the large accelerogram of a record with half-waves and impulses, or None if it is not drawn."""
        next(self._steps, None)
        if self._stored is None or record not in self._in_full:
            return None
        from rockpulse.views.plots.ground_motion import accelerogram, stored_motion

        motion = partial(stored_motion, self._tree, self._records[record])
        return self._drawn(lambda: _bare(accelerogram(motion())[0]), f"record{record}", say("picture.in_full"))

    def body(self, block: int, name: str = "body") -> PageElement:
        """Return the picture of the scale factors at which the records overturn a body."""
        next(self._steps, None)
        from rockpulse.views.plots.critical_factors import overturning_map

        if not Answers(self._summary).probable and "overturning_intervals" not in self._tree.children:
            return PageElement(Markup(""), say("picture.no_factors"))
        draw = partial(overturning_map, self._tree, block=self._blocks[block], most=IN_A_MAP)
        return self._drawn(draw, f"{name}{block}", say("picture.map"))

    def motion(self, block: int) -> PageElement | None:
        """Return the rotation of a body under its worst record, in the model of the verdict; None if unknown."""
        next(self._steps, None)
        own = [one for one in self._found if one.body.place == block and one.recorded.governing >= 0]
        from rockpulse.views.plots.model_histories import histories

        model = fullest_model(self._summary)
        if self._stored is None or not own or len(self._blocks) > IN_FULL or model not in DRAWN:
            return None
        from rockpulse.views.plots.rotation_panels import rotation_history

        worst = min(own, key=lambda one: one.recorded.margin.smallest)
        record, body = self._records[worst.recorded.governing], worst.body

        def draw() -> Axes:
            found = histories(self._tree, record, body.block, [model], body.case + 1)
            if not found[0].time.size:
                why = found[0].warning
                raise ResultsError(say("explorer.no_motion", body=body.name, record=record, reason=why))
            ax: Axes = rotation_history(found)[0]
            return ax

        caption = say("picture.rotation", body=body_name(body.name), record=record, model=say(f"models.{model}"))
        return self._drawn(draw, f"motion{block}", caption)

    def explaining(self) -> list[PageElement]:
        """Return the main pictures: overturning spectra, and the scale factors of the worst body without a spectrum."""
        if answers_of(self._tree).motions.kind == "sequence":
            return [] if self._site is None else [self.site()]
        from rockpulse.views.plots.drawing import has_spectra

        found, plain = [], []
        if has_spectra(self._tree) and (plain := plain_bodies(self._summary)):
            c = float(self._summary["restitution"].median())
            nearest = float(RESTITUTIONS[np.argmin(np.abs(RESTITUTIONS - c))])
            caption = say("picture.spectra", c=three_digits(nearest))
            found.append(self._drawn(partial(_spectra, self._tree, c), "spectra", caption))
        if others := [one for one in self._found if one.body.block not in plain]:
            worst = min(others, key=by_severity)
            found.append(self.body(worst.body.place, "front"))
        return found

    def site(self) -> PageElement:
        """Return the picture of the site; use only if a site file was given."""
        from rockpulse.views.plots.site import calibration

        tree = self._site
        assert tree is not None
        return self._drawn(lambda: _bare(calibration(tree).flat[0]), "site", say("picture.site_spectrum"))

    def fragility(self, block: str) -> PageElement:
        """Return the fragility curves of a body; use only if a fragility file was given."""
        from rockpulse.views.plots.fragility_curves import fragility_panels

        tree = self._fragility
        assert tree is not None
        place = tree["fragility"].to_dataset().get_index("block").get_loc(block)
        return self._drawn(lambda: fragility_panels(tree, block)[0], f"fragility{place}", say("picture.fragility"))

    def _drawn(self, draw: Callable[[], Axes], name: str, caption: str) -> PageElement:
        """Return the picture made by `draw`, with ids that start with `name`, or the error if drawing fails."""
        from rockpulse.views.plots.style import svg

        try:
            figure = draw().get_figure(root=True)
        except ResultsError as reason:
            return PageElement(Markup(""), result_text(str(reason), PLAIN))
        assert figure is not None
        return PageElement(Markup(svg(figure, name)), caption)


def _spectra(tree: xr.DataTree, restitution: float) -> Axes:
    from rockpulse.views.plots.drawing import spectra_of_records
    from rockpulse.views.plots.spectra import spectra_of_results

    ax = spectra_of_results(tree, spectra_of_records(tree, restitution), restitution)
    ax.set_xlabel(say("picture.spectra_x"))
    ax.set_ylabel(say("picture.spectra_y"))
    return _bare(ax)


def _bare(ax: Axes) -> Axes:
    """Remove title and small print from the figure of the Axes, because the page shows both as text."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.suptitle("")
    figure.supxlabel("")
    return ax
