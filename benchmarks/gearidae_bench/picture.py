"""Work-precision pictures: run time over error, one curve a contender."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from gearidae_bench.benchmark import Result

__all__ = ["draw_scene"]

# Okabe and Ito's colours, by kind of peer; markers tell the members of a kind apart, in grey as well.
_COLOURS: Final = {"gearidae": "#0072B2", "compiled": "#D55E00", "python": "#009E73"}
_MARKERS: Final = "osD^v<>PX*hd"


def draw_scene(result: Result, scene: str, path: Path) -> None:
    """Draw one scene of a result.

    Parameters
    ----------
    result : Result
    scene : str
        Name of the scene.
    path : Path
        PNG file to write.
    """
    figure = Figure(figsize=(7.5, 4.8), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    seen = dict.fromkeys(_COLOURS, 0)
    for key, label in result.labels.items():
        points = [
            p for p in result.points if p.scene == scene and p.contender == key and np.isfinite(p.error)
        ]
        if not points:
            continue
        peer = result.peers[key]
        axes.plot(
            [p.error for p in points],
            [1e3 * p.time for p in points],
            color=_COLOURS[peer],
            marker=_MARKERS[seen[peer]],
            markersize=4.5,
            markerfacecolor="white" if seen[peer] % 2 else _COLOURS[peer],
            linewidth=2.0 if key == "native" else 1.0,
            linestyle="-" if peer != "python" else "--",
            label=label,
        )
        seen[peer] += 1
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.invert_xaxis()
    axes.set_xlabel("largest error over the run, of scale (more accurate to the right)")
    axes.set_ylabel("run time (ms)")
    axes.set_title(result.scenes[scene], fontsize="medium", loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    figure.savefig(path, metadata={"Software": None})
