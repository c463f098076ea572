"""A table of many rows, which the browser sorts and shows in pages without the server."""

from typing import Any

from nicegui import ui

#: Number of rows on a page.
PAGE = 10


class Table(ui.table):
    """A table in pages.

    NiceGUI stores the order and the page of a table on the server, and redraws the whole window if either changes.
    Here only the browser stores the order and the page.
    """

    pagination: Any = None  # what the browser reports; not a property of the table in the browser, as in the base class

    def __init__(self, label: str, columns: list[dict[str, Any]], rows: list[dict[str, Any]]) -> None:
        super().__init__(columns=columns, rows=rows)
        several = " hide-pagination" if len(rows) > PAGE else ""
        self.props(f"dense flat rows-per-page-options=[{PAGE},50,0]", remove=f"pagination{several}").classes("list")
        self.props(f'aria-label="{label}"')
