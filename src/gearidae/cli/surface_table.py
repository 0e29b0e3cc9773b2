"""Table of a measured surface against the cut-off wavelength."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.table import Table

from gearidae.cli.machine import print_json
from gearidae.cli.output import print_line, show
from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.surfaces import MeasuredSurface

_MOST_ROWS = 9
_HEADINGS = (
    "cut-off",
    "rms height",
    "roughness",
    "density",
    "radius",
    "roughness",
    "density",
    "radius",
    "summits",
)


def show_library(*, as_json: bool = False) -> None:
    """Print the library of named surfaces: a row a number, with its source; or as one JSON object."""
    from gearidae.surfaces import library

    if as_json:
        print_json({"surfaces": library().reset_index().to_dict("records")})
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for heading in ("name", "key", "value", "source"):
        table.add_column(heading, no_wrap=heading != "source")
    before = ""
    for (name, key), row in library().iterrows():
        source = f"assumed: {row['source']}" if row["assumed"] else row["source"]
        table.add_row("" if name == before else name, key, with_prefix(row["value"], row["unit"]), source)
        before = name
    show(table)
    print_line(
        'surface = "polysilicon, OTS" in a case file takes a solid and a monolayer; friction is not set by a name.'
    )


def show_surface(surface: MeasuredSurface) -> None:
    """Print asperities by summits and by moments for some cut-off wavelengths, and the remarks.

    Parameters
    ----------
    surface : MeasuredSurface
        A chosen cut-off has a row, marked by an arrow.
    """
    ds = surface.statistics
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.title, table.title_justify = (
        "Asperities of one flank by summits (left) and by moments (right)",
        "left",
    )
    for heading in _HEADINGS:
        table.add_column(heading, justify="right", no_wrap=True)
    count = ds.sizes["cutoff"]
    rows = set(np.linspace(0, count - 1, min(count, _MOST_ROWS)).round().astype(int).tolist())
    if surface.cutoff is not None:
        rows.add(int(np.flatnonzero(ds["cutoff"].values == surface.cutoff)[0]))
    for index in sorted(rows):
        row = ds.isel(cutoff=index)
        chosen = float(row["cutoff"]) == surface.cutoff
        table.add_row(*_cells(row, "> " if chosen else ""))
    show(table)
    for remark in surface.remarks:
        print_line(f"Note: {remark}")
    if surface.cutoff is not None:
        print_line(surface.planes)


def _cells(row: xr.Dataset, mark: str) -> list[str]:
    cells = [mark + with_prefix(float(row["cutoff"]), "m"), with_prefix(float(row["rms_height"]), "m")]
    for way in row["by"].values.tolist():
        at = row.sel(by=way)
        cells += [
            with_prefix(float(at["roughness"]), "m"),
            "-" if np.isnan(at["asperity_density"]) else f"{1e-12 * float(at['asperity_density']):.3g}/um2",
            with_prefix(float(at["asperity_radius"]), "m"),
        ]
    return [*cells, str(int(row["summit_count"]))]
