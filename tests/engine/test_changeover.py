"""What a change from the asperity model to the elastic one carries over."""

import numpy as np

import gearidae as gd
from gearidae.engine.changeover import change_over
from gearidae.engine.model.record_types import HELD_GEAR
from gearidae.engine.model.state import STATE, W
from gearidae.engine.setup.build import make_problem

SCENE = gd.preset("teodorescu2009").replace(
    {"load.torque": 1e-11, "coating.sam_fraction": 0.5, "initial.gap": 1.5e-8, "run.samples": "off"}
)
NOT_CARRIED = {
    "bound_exceeded",
    "deep_exits",
    "energy",
    "history",
}  # cleared, begun, continued, moved to other slots


def carried(change, speed=0.0):
    """Elastic problem and state vector that go on from an asperity problem whose state has been changed."""
    rigid = make_problem(SCENE)
    assert rigid.depth == 0
    y = rigid.start.copy()
    y[W] = speed
    change(rigid.model.state)
    bodies = rigid.elastic()
    resume = change_over(rigid, bodies, rigid.checkpoint(0.0, y))
    state = np.empty(bodies.start.size)
    bodies.restore(resume, state)
    return rigid, bodies, state


def test_all_of_the_state_is_carried_over():
    def mark(state):
        state.hold, state.last_flank, state.roots, state.last_root = HELD_GEAR, 1, 7, -0.25
        for place, name in enumerate(
            STATE["energy"].names, 1
        ):  # apart from each other, and as they can be together
            state.energy[name] += place / 16
        state.progress.steps, state.progress.flight_steps = 11, 5
        state.whole_pitches = 64.0

    rigid, bodies, _ = carried(mark)
    old, new = rigid.model.state, bodies.model.state
    for name in set(STATE.names) - NOT_CARRIED:
        np.testing.assert_array_equal(new[name], old[name], err_msg=name)
    for name in set(STATE["energy"].names) - {"model_change"}:
        np.testing.assert_array_equal(new.energy[name], old.energy[name], err_msg=name)
    pairs = [{int(h.pair) for h in m.state.history[: m.scene.histories]} for m in (rigid.model, bodies.model)]
    assert pairs[0] == pairs[1]
    assert len(pairs[0]) > 1
