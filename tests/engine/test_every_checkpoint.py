"""Every checkpoint that a run takes is one that a run can go on from, whatever the tolerance."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import portable
from gearidae.engine.backend import run_blocks
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics

LOW = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5, "run.duration": 1e-3})
HIGH = gd.preset("teodorescu2009").replace({"coating.sam_fraction": 0.3, "run.duration": 1e-5})
SCENES = {
    "vibrating": LOW.replace({"initial.gap": 5.2 * 6e-9}),
    "rattling": HIGH.replace({"initial.gap": 3e-8, "load.torque": 1e-11}),
    "impact": gd.preset("roller_slow").replace({"contact.bodies": "rigid"}),
    "elastic impact": gd.preset("roller_slow").replace({"contact.bodies": "elastic"}),
}


STEPS = {1e-3: 9, 1e-4: 29, 1e-6: 61}
"""Between checkpoints of a long run, by its tolerance, so that all of it is seen in some hundred checkpoints."""


@pytest.mark.parametrize("rtol", STEPS)
@pytest.mark.parametrize("name", SCENES)
def test_every_checkpoint_is_taken_back(name, rtol, monkeypatch):
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", 9 if "impact" in name else STEPS[rtol])
    scene = SCENES[name].replace({"run.rtol": rtol, "run.samples": 57})
    problem = make_problem(scene)
    taken = [
        b.checkpoint
        for b in run_blocks(problem, rtol, 57, "sksundae", Statistics())
        if b.checkpoint is not None
    ]
    assert len(taken) >= 10
    again, prepared = make_problem(scene), None
    for checkpoint in taken:
        resumed = again.of_checkpoint(checkpoint)
        if resumed is not prepared:
            resumed.prepare(rtol, 57)
            prepared = resumed
        resumed.restore(checkpoint, np.empty(resumed.start.size))
