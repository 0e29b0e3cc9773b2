"""``gearidae assess``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import gearidae as gd
from gearidae.cli.codes import DONE
from gearidae.cli.machine import say_json
from gearidae.cli.output import say
from gearidae.cli.selection import selected
from gearidae.cli.values import quantity

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["assess_signal"]


def assess_signal(
    signal: Path,
    chart: Path,
    history: str,
    anti_alias_filter: str | None,
    *,
    select: Sequence[str],
    line: Sequence[str],
    as_json: bool = False,
) -> int:
    """Print what a signal says about the coating.

    Parameters
    ----------
    signal : Path
        CSV or netCDF file.
    chart : Path
        Coating map.
    history : str
        ``auto``, ``start`` or ``unknown``.
    anti_alias_filter : str or None
        Cut-off frequency of a filter before the sampling, in hertz or with a unit.
    select, line : sequence of str
        ``dimension=value``: which run of a file with several, and which line of a map with several.
    as_json : bool, optional
        Whether to print one JSON object in place of a sentence.

    Returns
    -------
    int
        Exit code: `DONE`, also where the signal cannot tell; that is an answer.
    """
    cutoff = None if anti_alias_filter is None else quantity("--anti-alias-filter", anti_alias_filter, "Hz")
    mapped = gd.analysis.open_map(chart)
    record = gd.analysis.read_signal(signal)
    record = selected(record, select, "--select", _dims(record["gear_speed"], "time"))
    mapped = selected(mapped, line, "--line", _dims(mapped["characteristic_frequency"], "sam_fraction"))
    found = gd.analysis.assess(record, mapped, history=history, anti_alias_filter=cutoff)
    if as_json:
        say_json({**asdict(found), "uncertainty": found.uncertainty, "conclusive": found.conclusive})
    else:
        say(f"{found.verdict}: {found.explanation}")
    return DONE


def _dims(array: xr.DataArray, own: str) -> list[str]:
    """Dimensions of an array beside its own."""
    return [str(dim) for dim in array.dims if dim != own]
