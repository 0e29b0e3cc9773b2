"""Pictures of the pages that show runs of shipped cases: ``python -m gearidae_pages.page_pictures docs/images``.

Each is what the page's own commands draw; together they take about a minute. Pictures of a study have a script of their
own, as do those of the benchmark.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from matplotlib.figure import Figure, SubFigure

import gearidae as gd

__all__ = ["PICTURES", "draw"]

_DPI: Final = 200.0


def _low_speed() -> Figure | SubFigure:
    """As ``make run`` does it."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "0.6 s"})
    return gd.plot.overview(gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.8, 0.6, 0.5, 0.47, 0.45]}))


def _overview(case: str) -> Callable[[], Figure | SubFigure]:
    """Draw a shipped case as it is."""
    return lambda: gd.plot.overview(gd.simulate(gd.load_case(f"cases/{case}.toml")))


def _teeth() -> Figure | SubFigure:
    """Draw a tooth that leaves the mesh at 50 % coverage."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
    return gd.plot.teeth(gd.simulate(scene), time=77.4e-3)


def _impact_forces() -> Figure | SubFigure:
    """Draw the rattle of the page on impacts."""
    scene = gd.preset("alternating").replace(
        {
            "coating.sam_fraction": 1.0,
            "drive.harmonic": [{"amplitude": "60 pN m", "frequency": "2 kHz"}],
            "mesh.radius_force": True,
            "run.duration": "4 ms",
            "run.samples": "off",
            "run.impacts": True,
        }
    )
    return gd.plot.impact_forces(gd.simulate(scene)).figure


PICTURES: Final[Mapping[str, Callable[[], Figure | SubFigure]]] = {
    "low_speed": _low_speed,
    "start_up": _overview("start_up"),
    "braking": _overview("braking"),
    "alternating": _overview("alternating"),
    "microengine": _overview("microengine"),
    "teeth": _teeth,
    "impact_forces": _impact_forces,
}
"""Functions that draw, by the names of the files."""


def draw(folder: Path) -> None:
    """Draw all pictures into a folder."""
    for name, picture in PICTURES.items():
        gd.plot.write(picture(), folder / f"{name}.png", overwrite=True, dpi=_DPI)


if __name__ == "__main__":
    draw(Path(sys.argv[1]))
