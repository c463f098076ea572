"""A figure that shows itself on the last line of a notebook's cell."""

from __future__ import annotations

from matplotlib.figure import Figure

from rockpulse.views.plots.picture import picture_bytes

__all__ = ["NotebookFigure"]


class NotebookFigure(Figure):
    """A figure that belongs to no window: pyplot, by which notebooks show all others, does not know it."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """The picture, and the width at which it has the size of other pictures [px]."""
        return picture_bytes(self, "png"), {"width": round(self.get_figwidth() * self.get_dpi())}
