"""Tables printed by the commands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import xarray as xr
from rich import box
from rich.table import Table
from rich.text import Text

from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.table import cells, headings
from gearidae.archive.select import scene_of, swept_dims
from gearidae.archive.specimen import specimen_note
from gearidae.archive.summary_rows import summary_rows
from gearidae.archive.value_text import label_cells
from gearidae.cli.output import print_error, print_line, show, show_rows
from gearidae.scene.validity_row import ATTRIBUTE, mean_note, rows_from_json

if TYPE_CHECKING:
    from gearidae.scene.validity_row import ValidityRow


_NAMED = 3
"""Failed members that are named."""


def show_outcomes(ds: xr.Dataset) -> None:
    """Print the outcome of each run of a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    """
    judged = outcomes(ds)
    rtol = scene_of(ds)["run"]["rtol"]
    dims = swept_dims(ds)
    table = Table(box=box.SIMPLE, pad_edge=False)
    for heading in (*dims, *headings(judged[0])):
        if heading == "outcome":
            table.add_column(heading)  # a long one is wrapped; numbers are whole
        else:
            table.add_column(heading, justify="right", no_wrap=True)
    for outcome in judged:
        table.add_row(*label_cells(ds, outcome.label), *cells(outcome, rtol))
    show(table)
    if specimen := specimen_note(ds):
        print_line(specimen)
        return
    if note := mean_note(rows_from_json(ds.attrs.get(ATTRIBUTE))):
        print_line(f"{'Verdicts are a' if len(judged) > 1 else 'The verdict is a'} {note}")


def show_summary(ds: xr.Dataset) -> None:
    """Print the run summary and the energy balance of a single run; nothing of a sweep."""
    if rows := summary_rows(ds):
        show_rows(rows)


def name_failures(ds: xr.Dataset) -> int:
    """Say which members of an ensemble could not be finished, and why.

    Parameters
    ----------
    ds : xarray.Dataset
        With ``status`` and ``message`` along ``member``.

    Returns
    -------
    int
        How many.
    """
    failed = [number for number, word in enumerate(ds["status"].values.tolist()) if word != "finished"]
    for number in failed[:_NAMED]:
        member = ds.isel(member=number)
        print_error(f"member {number}: {member['message'].item() or member['status'].item()}")
    if len(failed) > _NAMED:
        print_error(f"{len(failed) - _NAMED} more members could not be finished")
    return len(failed)


def label_text(ds: xr.Dataset, label: dict[str, Any]) -> str:
    """Write a run's label as text, ``sam_fraction = 0.5``, with the units of the sweep."""
    return ", ".join(f"{dim} = {cell}" for dim, cell in zip(label, label_cells(ds, label), strict=True))


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
