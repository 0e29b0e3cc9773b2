"""``gearidae coating-map`` and ``gearidae assess``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import gearidae as gd
from gearidae.cli.case import check_dask, read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.machine import say_json
from gearidae.cli.output import is_quiet, say
from gearidae.cli.selection import selected
from gearidae.cli.tables import show_rows
from gearidae.cli.values import default_output, quantity, sweep_values
from gearidae.errors import SceneError
from gearidae.runs.executors import check_jobs, dask_executor

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["assess_signal", "map_case"]

_FRACTION = "coating.sam_fraction"
_TORQUE = "drive.torque"
_MOST_ROWS = 13


def map_case(
    case: str,
    over: Sequence[str],
    output: Path | None,
    settings: Sequence[str],
    jobs: int | None,
    dask: str | None = None,
    *,
    resume: bool,
    overwrite: bool,
) -> int:
    """Make a coating map of a case, keep it, show some of it.

    Parameters
    ----------
    case : str
        Case file or preset.
    over : sequence of str
        ``key=values`` pairs: the fractions, and further keys for several lines; ``drive.torque`` alone for torques
        around that of the case.
    output : Path or None
        File to write; None for the case's name with ``_map.nc``.
    settings : sequence of str
        ``key=value`` pairs.
    jobs : int or None
        Runs at a time; None for one per core.
    dask : str or None
        Address of the scheduler of a Dask cluster that computes the runs; None for this machine.
    resume : bool
        Whether to reuse the finished runs of an interrupted map.
    overwrite : bool
        Whether the map may replace a file.

    Returns
    -------
    int
        Exit code.
    """
    target = output or default_output(case, "_map.nc")
    values = sweep_values([pair for pair in over if pair.strip() != _TORQUE])
    fractions = values.pop(_FRACTION, None)
    usual_torques = any(pair.strip() == _TORQUE for pair in over)
    if usual_torques and values:
        raise SceneError("--over", _TORQUE, f"needs values beside {', '.join(values)}: {_TORQUE}=4e-18,5e-18")
    further = _TORQUE if usual_torques else values
    check_dask(dask, jobs)
    workers = check_jobs(jobs)
    scene = read_scene(case, settings)
    with dask_executor(dask) as executor:
        chart = gd.analysis.coating_map(
            scene,
            fractions,
            over=further,
            executor=executor,
            jobs=workers,
            progress=not is_quiet(),
            archive=target,
            overwrite=overwrite,
            resume=resume,
        )
    show_rows(_rows(chart))
    say(f"Map: {target}")
    return DONE


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
    mapped = gd.analysis.open_map(chart)
    record = gd.analysis.read_signal(
        signal, **{name: value for name, value in reading.items() if value is not None}
    )
    record = selected(record, select, "--select", _dims(record["gear_speed"], "time"))
    mapped = selected(mapped, line, "--line", _dims(mapped["characteristic_frequency"], "sam_fraction"))
    found = gd.analysis.assess(record, mapped, **known)
    if as_json:
        derived = {"uncertainty": found.uncertainty, "conclusive": found.conclusive}
        say_json({**asdict(found), **derived})
        return DONE
    if found.reading:
        say(f"{signal}: {found.reading}")
    say(f"{found.verdict}: {found.explanation}")
    return DONE


def _dims(array: xr.DataArray, own: str) -> list[str]:
    """Dimensions of an array beside its own."""
    return [str(dim) for dim in array.dims if dim != own]


def _rows(chart: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Frequencies at some of the fractions, line by line."""
    # without the impacts, of which there may be none
    chart = chart[["characteristic_frequency", "uncertainty", "min_gear_speed"]]
    frequency = chart["characteristic_frequency"]
    further = [dim for dim in frequency.dims if dim != "sam_fraction"]
    lines = chart.stack(line=further) if further else chart.expand_dims("line")
    count = chart.sizes["sam_fraction"]
    picked = np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).round().astype(int))
    for number in range(lines.sizes["line"]):
        line = lines.isel(line=number)
        held = ", ".join(f"{dim} = {line[dim].item():g}" for dim in further)
        yield held or "Frequency of the first impact response", "", ""
        for place in picked:
            one = line.isel(sam_fraction=int(place))
            value, spread = float(one["characteristic_frequency"]), float(one["uncertainty"])
            text = f"{value:.0f} +- {spread:.0f} Hz" if np.isfinite(value) else "-"
            stops = "" if float(one["min_gear_speed"]) > 0.0 else "the gear stops within the run"
            yield f"SAM {100 * float(one['sam_fraction']):g} %", text, stops
