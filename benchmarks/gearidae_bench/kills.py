"""Kills at random moments: run, sweep and coating-map are ended by SIGKILL, resumed, and compared with whole ones."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

import gearidae as gd

__all__ = ["Killed", "difference", "run_kills"]

_COMMANDS = {
    "run": ("run", "teodorescu2009", "--set", "run.duration=30 ms", "run.samples=200001"),
    "sweep": (
        "sweep", "teodorescu2009_low_speed", "--over", "coating.sam_fraction=1:0.5:-0.1",
        "--set", "run.duration=40 ms", "run.samples=2001", "--jobs", "1",
    ),
    "coating-map": (
        "coating-map", "teodorescu2009_low_speed", "--jobs", "1", "--set", "run.samples=4001",
        "--over", "coating.sam_fraction=1:0.8:-0.1", "drive.torque=4e-18,5e-18",
    ),
}  # fmt: skip
"""Each takes a few seconds, of which its start is one."""
_TIMES = ("date_created", "wall_time", "history")
_MOST_KILLS = 4  # of one archive, after which it is left to reach its end


@dataclass(frozen=True, slots=True)
class Killed:
    """What came of the archives of one command.

    Attributes
    ----------
    command : str
    kills : int
        How often it was killed.
    complaint : str
        The first thing that differs, or that went wrong; empty if nothing did.
    """

    command: str
    kills: int = 0
    complaint: str = ""


def run_kills(kills: int, seed: int, report: Callable[[int], object] | None = None) -> list[Killed]:
    """Kill so many times, taking turns with the commands.

    Parameters
    ----------
    kills, seed : int
        How many, and which moments.
    report : callable, optional
        Told the number of kills so far.

    Returns
    -------
    list of Killed
        One for each command.
    """
    rng = np.random.default_rng(seed)
    found = {name: Killed(name) for name in _COMMANDS}
    with tempfile.TemporaryDirectory(prefix="kills") as name:
        folder = Path(name)
        whole: dict[str, tuple[Path, float]] = {}
        for command, arguments in _COMMANDS.items():
            target = folder / f"{command}.nc"
            _begin(arguments, target).wait()  # once for what is compiled and cached
            target.unlink()
            began = time.perf_counter()
            _begin(arguments, target).wait()
            whole[command] = target, time.perf_counter() - began
        done = 0
        while done < kills and not any(one.complaint for one in found.values()):
            for command, (expected, lasts) in whole.items():
                killed, complaint = _one(command, folder / f"killed_{command}.nc", expected, lasts, rng)
                done += killed
                found[command] = replace(
                    found[command],
                    kills=found[command].kills + killed,
                    complaint=found[command].complaint or complaint,
                )
                if report is not None:
                    report(done)
    return list(found.values())


def _one(
    command: str, target: Path, expected: Path, lasts: float, rng: np.random.Generator
) -> tuple[int, str]:
    """Kill one run or sweep a few times, let it end, and compare; how often it was killed, and what is wrong."""
    killed = 0
    for _ in range(_MOST_KILLS):
        process = _begin(_COMMANDS[command], target, "--resume")
        try:
            process.wait(timeout=float(rng.uniform(0.1, lasts)))
            break  # it was quicker
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            killed += 1
    process = _begin(_COMMANDS[command], target, "--resume")
    message = process.communicate()[1].decode(errors="replace").strip()
    if process.returncode != 0:
        complaint = f"exit code {process.returncode}: {message[-300:]}"
    else:
        read = gd.analysis.open_map if command == "coating-map" else gd.open_archive
        complaint = difference(read(expected), read(target))
    left = [
        path.name for path in target.parent.iterdir() if path.name.startswith(target.name) and path != target
    ]
    target.unlink(missing_ok=True)
    return killed, complaint or (f"left behind: {', '.join(left)}" if left else "")


def _begin(arguments: tuple[str, ...], target: Path, *more: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "gearidae", "--quiet", *arguments, "-o", str(target), *more]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def difference(one: xr.Dataset, other: xr.Dataset) -> str:
    """Name the first thing in which two archives differ but times of day and of work; empty if nothing.

    Parameters
    ----------
    one, other : xarray.Dataset

    Returns
    -------
    str
    """
    try:
        xr.testing.assert_identical(_without_times(one), _without_times(other))
    except AssertionError as error:
        return " ".join(str(error).split())[:300]
    finally:
        one.close()
        other.close()
    return ""


def _without_times(ds: xr.Dataset) -> xr.Dataset:
    left = ds.load().drop_vars([name for name in _TIMES if name in ds.variables])
    left.attrs = {key: value for key, value in left.attrs.items() if key not in _TIMES}
    return left
