"""A result's files: everything as JSON, all points as CSV, tables as Markdown, a picture of each scene."""

from __future__ import annotations

from pathlib import Path

from gearidae_bench.benchmark import Result
from gearidae_bench.picture import draw_scene
from gearidae_bench.tables import markdown, write_points

__all__ = ["write_result"]


def write_result(result: Result, folder: Path, images: Path | None = None) -> None:
    """Write ``benchmark.json``, ``points.csv``, ``benchmark.md`` and ``work_precision_SCENE.png``.

    Parameters
    ----------
    result : Result
    folder : Path
        Made if missing.
    images : Path, optional
        Where the pictures go; by default ``images`` in the folder.
    """
    pictures = images or folder / "images"
    for place in (folder, pictures):
        place.mkdir(parents=True, exist_ok=True)
    result.save(folder / "benchmark.json")
    write_points(result, folder / "points.csv")
    (folder / "benchmark.md").write_text(markdown(result))
    for scene in result.scenes:
        draw_scene(result, scene, pictures / f"work_precision_{scene}.png")
