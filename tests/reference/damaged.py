"""Checkpoints that a test has damaged, run on from by a process of their own: one word a checkpoint says how it ended.

``python damaged.py scene file.npy``.
"""

import itertools
import sys

import numpy as np

import gearidae as gd
from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics

__all__ = ["BUDGET", "SCENES", "UNREADY"]

BUDGET = 3
"""Blocks of output after which a run is left alone: tens of thousands of steps, where a sound one takes hundreds."""
UNREADY = "unready"
"""Ending of a run whose forged state asks for code that its scene has not had compiled, which Python says."""

_RIGID = {"contact.bodies": "rigid", "run.samples": 101}
SCENES = {
    "dry gears": gd.preset("teodorescu2009").replace(
        _RIGID
        | {
            "coating.sam_fraction": 0.5,
            "drive.torque": 0.0,
            "drive.harmonic": [],
            "drive.schedule": [[0.0, 0.0], [2e-5, 1e-11], [6e-5, 2.4e-11]],
            "mesh.damping": 1e-6,
            "initial.gear_speed": 0.0,
            "initial.gap": 2e-8,
            "run.duration": 8e-5,
        }
    ),
    "roller": gd.preset("roller_slow").replace(_RIGID),
    "elastic roller": gd.preset("roller_slow").replace({"contact.bodies": "elastic", "run.samples": 101}),
}


def ending(name, checkpoint):
    """Name of a run's ending."""
    scene, statistics = SCENES[name], Statistics()
    blocks = run_blocks(
        make_problem(scene), scene.run.rtol, scene.run.sample_count, "native", statistics, checkpoint
    )
    try:
        if sum(1 for _ in itertools.islice(blocks, BUDGET)) == BUDGET and next(blocks, None) is not None:
            return f"{BUDGET}_blocks"
    except RuntimeError as error:
        if "has not been made ready" not in str(error):
            raise
        return UNREADY
    return statistics.ending.status


if __name__ == "__main__":
    for row in np.load(sys.argv[2]):
        sys.stdout.write(ending(sys.argv[1], row) + "\n")
        sys.stdout.flush()
