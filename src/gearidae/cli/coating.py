"""``gearidae assess``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gearidae as gd
from gearidae.cli.case import selected
from gearidae.cli.codes import DONE
from gearidae.cli.machine import print_json
from gearidae.cli.output import print_line
from gearidae.scene.pairs import quantity

if TYPE_CHECKING:
    import xarray as xr


def assess_signal(
    signal: Path,
    chart: Path,
    sensor: Mapping[str, str | None],
    reading: Mapping[str, Any],
    *,
    select: Sequence[str],
    line: Sequence[str],
    as_json: bool = False,
) -> int:
    """Print what a signal says about the coating.

    Parameters
    ----------
    signal : Path
        Text or netCDF file.
    chart : Path
        Coating map.
    sensor : mapping of str to str
        What is known of the record: ``history``, ``anti_alias_filter`` in hertz or with a unit, ``calibration`` and
        ``offset``; None where nothing is.
    reading : mapping of str to object
        How to read it, as for `gearidae.analysis.read_signal`; None where it is to be recognised.
    select, line : sequence of str
        ``dimension=value``: which run of a file with several, and which line of a map with several.
    as_json : bool, optional
        Whether to print one JSON object in place of a sentence.

    Returns
    -------
    int
        Exit code: `DONE`, also where the signal cannot tell; that is an answer.
    """
    known: dict[str, Any] = {name: value for name, value in sensor.items() if value is not None}
    if "anti_alias_filter" in known:
        known["anti_alias_filter"] = quantity("--anti-alias-filter", known["anti_alias_filter"], "Hz")
    for name, unit in (("calibration", "1"), ("offset", "rad/s")):
        if name in known:
            known[name] = quantity(f"--{name}", known[name], unit)
    if reading.get("interval") is not None:
        reading = {**reading, "interval": quantity("--interval", str(reading["interval"]), "s")}
    mapped = gd.analysis.open_map(chart)
    record = gd.analysis.read_signal(
        signal, **{name: value for name, value in reading.items() if value is not None}
    )
    record = selected(record, select, "--select", _dims(record["gear_speed"], "time"))
    mapped = selected(mapped, line, "--line", _dims(mapped["characteristic_frequency"], "sam_fraction"))
    assessment = gd.analysis.assess(record, mapped, **known)
    if as_json:
        derived = {"uncertainty": assessment.uncertainty, "conclusive": assessment.conclusive}
        print_json({**asdict(assessment), **derived})
        return DONE
    if assessment.reading:
        print_line(f"{signal}: {assessment.reading}")
    print_line(f"{assessment.verdict}: {assessment.explanation}")
    return DONE


def _dims(array: xr.DataArray, axis: str) -> list[str]:
    """Dimensions of an array beside its own."""
    return [str(dim) for dim in array.dims if dim != axis]
