"""The start of a train's run: histories of its meshes, directions of its shafts, and a first step."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.events.cutoff import begin_within, watches_cutoff
from gearidae.engine.events.histories import begin
from gearidae.engine.events.law_switches import set_law_sides, set_law_window
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import U
from gearidae.engine.observers import adhesion_loss
from gearidae.engine.train.events import train_way_left
from gearidae.engine.train.flanks import NO_CONVERGENCE
from gearidae.engine.train.layout import TrainModel
from gearidae.engine.train.motion import mesh_state, motion
from gearidae.engine.train.observe import begin_extremes, kinetic_energy_of
from gearidae.engine.train.rest import begin_rest
from gearidae.engine.train.sticking import begin_sticking

FIRST: Final = 1e-3
"""First step, of the fastest time of the meshes."""
ANEW: Final = 0.1
"""First step of a run that goes on from another, where forces may jump, of that time at most."""


@compiled(makes_arrays=True)
def begin_train(tm: TrainModel) -> None:
    """Set a train to the start of a run, at the state ``tm.y``."""
    train, y = tm.train[0], tm.y
    t = train.time = train.start
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m = model_at(mesh.address)
        e = mesh_state(tm, k, m, y, tm.own)
        m.state.initial_pinion_lead = tm.own[U] + e.value
        begin(mesh.address, t / mesh.time_unit, tm.own)
        energy = m.state.energy
        energy.adhesion_loss = energy.radius_work = 0.0
    take_up(tm)
    begin_rest(tm, t, y)
    if train.flanks != 0 and not begin_sticking(tm, t, y):
        train.error = NO_CONVERGENCE
    motion(tm, t, y, tm.rates[0])
    begin_extremes(tm, t, y)
    train.kinetic = train.peak_kinetic = train.throughput = kinetic_energy_of(tm, y)
    train.step = FIRST * train.tau


@compiled
def take_up(tm: TrainModel) -> None:
    """Set what follows from the state of a train, at its start or where it has been taken back."""
    train = tm.train[0]
    for k in range(len(tm.meshes)):
        mesh = tm.meshes[k]
        m, time = model_at(mesh.address), train.time / mesh.time_unit
        mesh_state(tm, k, m, tm.y, tm.own)
        set_law_window(m)
        if m.scene.law_switches != 0:
            set_law_sides(m, time, tm.own)
        if watches_cutoff(m):
            begin_within(m, tm.own)
        adhesion_loss.begin(m, time)
    train.fresh = 1
    if train.time >= train.end or train_way_left(tm, tm.y) <= 0.0:
        train.done = 1  # interrupted behind its last block


def begin_anew(tm: TrainModel) -> None:
    """Begin with a short step, as a run does that goes on from another; in Python."""
    train = tm.train[0]
    train.step = min(float(train.step), ANEW * float(train.tau))


@compiled
def write_own_state(tm: TrainModel, k: int) -> None:
    """Write the state of a mesh's pair in its own units to ``tm.own``."""
    mesh_state(tm, k, model_at(tm.meshes[k].address), tm.y, tm.own)
