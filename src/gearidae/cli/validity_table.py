"""Table of the limits of the model for a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table
from rich.text import Text

from gearidae.cli.output import show

if TYPE_CHECKING:
    from gearidae.scene.validity_row import ValidityRow


def show_validity(rows: Sequence[ValidityRow], *, about: str = "") -> None:
    """Print the limits of the model; an exclamation mark marks a limit that is exceeded.

    Parameters
    ----------
    about : str, optional
        Contact that they are computed for, for the caption.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for heading in ("How far the model holds", "value", "", "limit", "what follows"):
        table.add_column(heading)
    for row in rows:
        mark = "" if row.holds else "!"
        table.add_row(*(Text(cell) for cell in (row.quantity, row.value, mark, row.limit, row.verdict)))
    if about:
        table.caption, table.caption_justify = f"Contact {about}. ! marks a limit that is exceeded.", "left"
    show(table)
