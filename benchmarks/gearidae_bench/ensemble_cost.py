"""What an ensemble of the low-speed case costs beside its solver: processor time a run, memory, use of the cores.

Of members that share their surface, and with it the tables of the force law::

    python -m gearidae_bench.ensemble_cost 10000 2
"""

from __future__ import annotations

import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import gearidae as gd
from gearidae import engine
from gearidae_bench.long import peak_memory

__all__ = ["Cost", "cost_table", "ensemble_cost"]

VARY: Final = {"coating.sam_fraction": "uniform(0.5, 1)", "drive.torque": "normal(4.5e-18, 1e-19)"}


@dataclass(frozen=True, slots=True)
class Cost:
    """Cost of one ensemble.

    Attributes
    ----------
    members : int
    wall : float
        Wall time [s].
    processor : float
        Processor time [s].
    solving : float
        Processor time of the engine, its model included [s].
    peak : float
        Largest resident memory of the process so far [MB].
    """

    members: int
    wall: float
    processor: float
    solving: float
    peak: float

    @property
    def beside(self) -> float:
        """Processor time beside the engine, a run [s]."""
        return (self.processor - self.solving) / self.members

    @property
    def cores(self) -> float:
        """Processor time over wall time: the number of cores in use."""
        return self.processor / self.wall


def ensemble_cost(scene: gd.Scene, members: int, jobs: int, archive: Path | None = None) -> Cost:
    """Measure one ensemble.

    Parameters
    ----------
    scene : Scene
    members, jobs : int
        Runs, and runs at a time.
    archive : Path, optional
        Where to write it, with its finished runs beside it meanwhile.

    Returns
    -------
    Cost
    """
    gd.studies.ensemble(scene, VARY, jobs, jobs=jobs)  # compiles, and makes the tables that are shared
    inner, solving, busy = engine.solve, [0.0], threading.Lock()

    def timed(*arguments: Any, **settings: Any) -> Any:
        began = time.thread_time()
        try:
            return inner(*arguments, **settings)
        finally:
            with busy:
                solving[0] += time.thread_time() - began

    began, processor = time.perf_counter(), time.process_time()
    with patch.object(engine, "solve", timed):
        gd.studies.ensemble(scene, VARY, members, jobs=jobs, archive=archive, overwrite=True)
    used = time.process_time() - processor
    return Cost(members, time.perf_counter() - began, used, solving[0], 1e-6 * peak_memory())


def cost_table(costs: dict[str, Cost]) -> str:
    """Write costs as lines of text.

    Parameters
    ----------
    costs : dict of str to Cost

    Returns
    -------
    str
    """
    lines = ["                     members    wall s   engine ms/run   beside ms/run   cores   peak MB"]
    for name, each in costs.items():
        engine = 1e3 * each.solving / each.members
        lines.append(
            f"{name:20s} {each.members:7d} {each.wall:9.1f} {engine:15.2f} {1e3 * each.beside:15.2f} "
            f"{each.cores:7.2f} {each.peak:9.0f}"
        )
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Measure with and without an archive, and print."""
    members = int(arguments[0]) if arguments else 1000
    jobs = int(arguments[1]) if len(arguments) > 1 else 2
    scene = gd.preset("teodorescu2009_low_speed")
    with tempfile.TemporaryDirectory() as folder:
        costs = {
            "in memory": ensemble_cost(scene, members, jobs),
            "into an archive": ensemble_cost(scene, members, jobs, Path(folder) / "ensemble.nc"),
        }
    sys.stdout.write(f"{cost_table(costs)}\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
