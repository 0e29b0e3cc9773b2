"""What arguments of the command line name: a scene, the part of a dataset, a result."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import xarray as xr

import gearidae
from gearidae.errors import SceneError
from gearidae.scene.pairs import assignments

if TYPE_CHECKING:
    from gearidae.scene import Scene

_ALSO_PRESETS: Final = {"low_speed": "teodorescu2009_low_speed", "high_speed": "teodorescu2009"}
"""Shipped cases that are presets under another name: these have no units to be read."""
_MOST_SHOWN: Final = 20
"""Values of a dimension that an error lists."""


def shipped_cases() -> dict[str, Path]:
    """Return the case files that come with the package, by their names."""
    package = Path(gearidae.__file__).parent
    # installed, and in a tree of the sources
    for folder in (package / "cases", package.parents[1] / "cases"):
        if cases := {path.stem: path for path in sorted(folder.glob("*.toml"))}:
            return cases
    return {}


def read_scene(case: str, settings: Sequence[str]) -> Scene:
    """Load a case file, or a preset or shipped case if there is no such file, and change the keys given by ``--set``.

    Parameters
    ----------
    case : str
        Path of a case file, or the name of a preset or of a shipped case.
    settings : sequence of str
        ``key=value`` pairs.

    Raises
    ------
    SceneError
        If there is neither, or the scene or a change is not allowed.
    """
    from gearidae.scene import PRESETS, load_case, preset
    from gearidae.scene.group import did_you_mean

    path, shipped = Path(case), shipped_cases()
    presets = dict(zip(PRESETS, PRESETS, strict=True)) | _ALSO_PRESETS
    if path.exists() or case not in presets | shipped:
        meant = "" if path.exists() or path.suffix else did_you_mean(case, presets | shipped)
        if not path.exists() and (beside := path.with_name(f"{path.name}.toml")).is_file():
            meant = f"did you mean {beside}?"
        if meant:
            raise SceneError("case", case, f"is no file, no preset and no shipped case; {meant}")
        scene = load_case(case)
    elif case in presets:
        scene = preset(presets[case]).replace({"name": case})
    else:
        scene = load_case(shipped[case])
    changes = assignments(settings)
    return scene.replace(changes) if changes else scene


def selected(ds: xr.Dataset, pairs: Sequence[str], option: str, dims: Sequence[str]) -> xr.Dataset:
    """Pick a part of a dataset.

    Parameters
    ----------
    pairs : sequence of str
        ``dimension=value``.
    option : str
        That they were given with, for errors.
    dims : sequence of str
        Dimensions that a value may be picked of.

    Returns
    -------
    xarray.Dataset
        Without the dimensions of `pairs`.

    Raises
    ------
    SceneError
        If there is no such dimension or value, naming those that there are.
    """
    if not pairs:
        return ds
    for dim, value in assignments(pairs, option, "sam_fraction=0.5").items():
        if dim not in dims:
            known = f"must be one of {', '.join(dims)}" if dims else "there is nothing to select from"
            raise SceneError(option, dim, known)
        labels = ds[dim].values
        numeric = np.issubdtype(labels.dtype, np.number) and isinstance(value, int | float)
        # a value as it is printed is not always the same float
        matches = (
            np.isclose(labels, value, rtol=1e-9, atol=0.0) if numeric else labels.astype(str) == str(value)
        )
        if not matches.any():
            shown = ", ".join(f"{label:g}" if numeric else str(label) for label in labels[:_MOST_SHOWN])
            raise SceneError(f"{option} {dim}", value, f"must be one of {shown}")
        ds = ds.isel({dim: int(np.flatnonzero(matches)[0])})
    return ds


def default_output(case: str, suffix: str) -> Path:
    """Name a result after its case, in the current folder."""
    return Path(f"{Path(case).stem}{suffix}")


def check_dask(dask: str | None, jobs: int | None) -> None:
    """Refuse a number of simultaneous runs beside a cluster.

    Raises
    ------
    SceneError
        If both are given.
    """
    if dask is not None and jobs is not None:
        raise SceneError(
            "--jobs",
            jobs,
            "cannot be combined with --dask: the cluster decides the number of simultaneous runs",
        )
