"""Find the scene that the command line names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gearidae.cli.values import assignments
from gearidae.errors import SceneError

if TYPE_CHECKING:
    from gearidae.scene import Scene

SHIPPED: Final = {"low_speed": "teodorescu2009_low_speed", "high_speed": "teodorescu2009"}
"""Shipped cases that are presets under another name."""


def read_scene(case: str, settings: Sequence[str]) -> Scene:
    """Load a case file, or a preset if there is no such file, and change the keys given by ``--set``.

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

    path = Path(case)
    known = dict(zip(PRESETS, PRESETS, strict=True)) | SHIPPED
    if case in known and not path.exists():
        scene = preset(known[case]).replace({"name": case})
    else:
        meant = "" if path.exists() or path.suffix else did_you_mean(case, known)
        if meant:
            raise SceneError("case", case, f"is neither a file nor a preset; {meant}")
        scene = load_case(case)
    changes = assignments(settings)
    return scene.replace(changes) if changes else scene


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
