"""Find the scene that the command line names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearidae.cli.values import assignments

if TYPE_CHECKING:
    from gearidae.scene import Scene

__all__ = ["read_scene"]


def read_scene(case: str, settings: Sequence[str]) -> Scene:
    """Load a case file, or a preset if there is no such file, and change the keys given by ``--set``.

    Parameters
    ----------
    case : str
        Path of a case file, or the name of a preset.
    settings : sequence of str
        ``key=value`` pairs.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If there is neither, or the scene or a change is not allowed.
    """
    from gearidae.scene import PRESETS, load_case, preset

    scene = preset(case) if case in PRESETS and not Path(case).exists() else load_case(case)
    changes = assignments(settings)
    return scene.replace(changes) if changes else scene
