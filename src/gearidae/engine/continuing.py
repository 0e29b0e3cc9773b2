"""Going on from the end of another run: its state in the units, contacts and torques of a new scene.

Gears and mesh are the same; drive, load, coating and settings may differ. Time, motion, histories, energy balance and
extremes go on. Where nothing but settings of the run differ, all units are the same and every number is kept to the
last bit. A new torque changes the units of time and force, a new coating what asperities do:

- Joined heights are heights on the surface, and stay; asperities beyond the new stretch limit have detached.
  A material that remembers nothing so far, or has not been there, starts with nothing stretched.
- What the contacts store with the new materials less what they stored is booked as change of the model. An energy
  balance that the other run has not kept begins here.
- Where the contact was elastic it stays so, with its nodes carried to those of the new scene.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.engine.changeover import (
    carry_nodes,
    join_anew,
    join_as_pairs,
    note_gaps,
    remember,
    take_over,
)
from gearidae.engine.events.asperity_events import join_at_start
from gearidae.engine.events.histories import accept
from gearidae.engine.events.law_switches import set_shaft_sides
from gearidae.engine.events.sliding import begin_sliding, settle_start
from gearidae.engine.integrate.start import rebase
from gearidae.engine.laws.pairs import stored_energy
from gearidae.engine.model.record_types import FREE
from gearidae.engine.model.state import (
    EMPTY,
    EXTREMES,
    HISTORY,
    MOTION,
    PHASE,
    STATE,
    STATE_FIELDS,
    Floats,
    Model,
    V,
    W,
    assign,
)
from gearidae.engine.motion.static_solve import settle_nodes
from gearidae.engine.observers.balance import open_balance
from gearidae.engine.observers.exposures.bins import ROWS, exposure_table, exposures_of
from gearidae.engine.observers.extremes.windows import begin_parts_before
from gearidae.engine.population.restore import take_joined
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.build_torques import KNOT_SPACING
from gearidae.engine.setup.kept_asperities import joined_asperities
from gearidae.engine.setup.problem import Problem
from gearidae.engine.setup.start import Start
from gearidae.errors import SceneError
from gearidae.laws.shaft.schedule import segment_ends
from gearidae.records import EventKind, Events, Flank
from gearidae.records.quantity import convert
from gearidae.scene import Scene, TrainScene, require_gears
from gearidae.scene.differences import first_difference, may_change

_SAME: Final = 1e-12
"""Relative difference of forces below which materials are the same: units of other torques round their last digits."""


def end_of(scene: Scene, words: Floats, began: float) -> Start:
    """Check a checkpoint against the scene of its run, and return the start of a run that goes on from there.

    Parameters
    ----------
    scene : Scene
        Of the run.
    words : ndarray of 8-byte words
        Its checkpoint.
    began : float
        When it began [s].

    Raises
    ------
    SceneError
        If the checkpoint is not of this scene, or damaged.
    """
    problem, y = _restored(scene, words, began)
    s = problem.model.state
    end = began + scene.run.duration
    time = end if s.time == problem.model.scene.end else float(s.time) * problem.time_unit
    return Start(time, float(y[PHASE] + s.whole_pitches), scene, words, began)


def problem_from(scene: Scene, start: Start) -> Problem:
    """Make the problem of a scene that goes on from another run, or begins by itself."""
    if start.scene is not None:
        refuse_other_bodies(start.scene, scene)
    return make_problem(scene, start=start)


def checkpoint_of_start(scene: Scene, start: Start) -> Floats:
    """Return the checkpoint of a scene's problem from which a run begins that goes on from another.

    Raises
    ------
    SceneError
        If the scenes differ in what may not.
    """
    assert start.scene is not None
    assert start.words is not None
    old, old_y = _restored(start.scene, start.words, start.began)
    if old.model.scene.follow.gear != 0 and _torques_differ(start.scene, scene):
        old.judge.settle(float(old.model.state.time), old_y)
    new = problem_from(scene, start)
    new.prepare(scene.run.rtol, scene.run.sample_count)
    new = _same_contact(old, new)
    new.prepare(scene.run.rtol, scene.run.sample_count)
    y = new.start.copy()
    carry_over(old, old_y, new, y, population=start.scene.coating != scene.coating)
    source, m = old.model, new.model
    time = float(m.state.time)
    _hold_or_slip(source, m, time, y)
    if m.scene.guarded != 0:
        set_shaft_sides(m, y)
    if source.scene.follow.balance != m.scene.follow.balance:
        _begin_balance(new.addresses.base, m, y)
    if source.scene.follow.passages != m.scene.follow.passages:
        m.state.passage[:] = np.zeros((), STATE["passage"])  # nothing is known of what has been before
    if source.scene.follow.impacts != m.scene.follow.impacts:
        m.state.history["impact"] = np.zeros((), HISTORY["impact"])
    rebase(m, y)
    m.state.progress.restarts = 1
    return new.checkpoint(time, y)


def carry_over(old: Problem, old_y: Floats, new: Problem, y: Floats, *, population: bool = False) -> None:
    """Carry time, motion, histories, energies and extremes of a problem over to another, which is prepared.

    Parameters
    ----------
    old, new : Problem
        Of the same gears; `new` may have other torques and materials.
    old_y, y : ndarray, shape (n,)
        Scaled states; `y` is written.
    population : bool
        Whether the asperities of a population, if there is one, have another coating.
    """
    source, m = old.model, new.model
    units = _Units(source, m)
    units.convert_motion(old_y, y)
    take_over(source, m)
    convert(STATE_FIELDS, m.state, units.force, units.time)
    changed = not _same_materials(source, m)
    changed |= m.scene.population.flanks > 0 and population
    if changed:  # what other materials have been exposed to says nothing of these
        exposures_of(m)[:] = 0.0
    else:
        units.convert_exposures(m)
    same = float(source.scene.time_unit) == float(m.scene.time_unit)
    m.state.time = float(source.state.time) if same else float(m.scene.start)
    _carry_contacts(old, old_y, new, y, changed=changed)
    _begin_stretch(m)


def _torques_differ(old: Scene, new: Scene) -> bool:
    """Whether the new run does not know the torques of the old one: other ones, or schedules of its own time only."""
    before, after = require_gears(old), require_gears(new)
    if (before.drive, before.load) != (after.drive, after.load):
        return True
    drive, load = before.drive, before.load
    if drive.law is not None or load.law is not None:  # whose knots are those of one run
        return True
    return any(schedule.moves for schedule in (drive.schedule, drive.speed_knots(), load.schedule))


def knots_at_start(problem: Problem) -> Floats:
    """Return the event of a schedule that has a knot where a continued run begins; the run before ended just there.

    A knot that the solver could not distinguish from the end has been left out there.

    Returns
    -------
    ndarray, shape (0 or 1, columns)
        Table of `Events`.
    """
    s, tables = problem.model.scene, problem.model.tables
    ends = np.concatenate([segment_ends(schedule, tables) for schedule in s.schedule])
    if not ((ends <= s.start) & (s.start - ends <= KNOT_SPACING * s.start)).any():
        return Events.no_table()
    time, kind = float(s.start * s.time_unit), EventKind.SCHEDULE_KNOT
    return Events(*np.array([[time], [kind], [0], [Flank.NONE], [0.0]])).table()


def _restored(scene: Scene, words: Floats, began: float) -> tuple[Problem, Floats]:
    """Return the problem of a run where it ended, with its state; what is read is checked."""
    problem = make_problem(scene, start=Start(began, 0.0)).of_checkpoint(words)
    problem.prepare(scene.run.rtol, scene.run.sample_count)
    return problem, problem.restored(words)[1]


def refuse_other_bodies(old: Scene, new: Scene) -> None:
    """Refuse a scene that differs in what may not."""
    before, after = old.to_dict(), new.to_dict()
    difference = first_difference(before, after, ignored=may_change(before))
    if difference is None and isinstance(old, TrainScene) and isinstance(new, TrainScene):
        mine, theirs = _order_of(old), _order_of(new)
        key = next((key for key in mine if mine[key] != theirs[key]), None)
        difference = None if key is None else (key, mine[key], theirs[key])
    if difference is not None:
        name, first, second = difference
        value = "(missing)" if second is None else "(given)" if isinstance(second, dict) else second
        wanted = "left out" if first is None else "given" if isinstance(first, dict) else first
        raise SceneError(name, value, f"must be {wanted}, as in the run to go on from")


def _order_of(scene: TrainScene) -> dict[str, str]:
    """What of a train counts besides its keys: the order of shafts and meshes, which shaft is driven and loaded."""
    train = scene.train
    return {
        "shafts": ", ".join(scene.shafts),
        "meshes": ", ".join(scene.meshes),
        "drive.shaft": train.shafts[train.drive].name,
        "load.shaft": train.shafts[train.load].name,
    }


def _same_contact(old: Problem, new: Problem) -> Problem:
    """Return the new problem with nodes if the old one has some, in the same layout if there is one."""
    if old.depth > 0 and new.elastic is not None:
        new = new.elastic()
    while 0 < new.depth < old.depth and new.deeper is not None:
        new = new.deeper()
    return new


class _Units:
    """Ratios of the units of two models."""

    def __init__(self, old: Model, new: Model) -> None:
        self.time = float(old.scene.time_unit / new.scene.time_unit)
        self.force = float(old.scene.force_unit / new.scene.force_unit)
        self.speed = 1.0 / self.time
        self.energy = self.force  # lengths are in roughnesses in both

    def convert_motion(self, old: Floats, new: Floats) -> None:
        """Write the motion's states; deflections stay zero."""
        new[:MOTION] = old[:MOTION]
        for index in (V, W):
            new[index] = old[index] * self.speed

    def convert_exposures(self, m: Model) -> None:
        """Put what the flanks have been exposed to into the new units, in place; numbers of asperities have none."""
        if m.scene.bins:
            table = exposure_table(m)
            table[:, ROWS.adhesion :] *= (
                self.energy
            )  # forces have the same unit, as lengths are in roughnesses


def _same_materials(old: Model, new: Model) -> bool:
    """Whether contacts of two models are of the same materials."""
    before, after = _materials(old), _materials(new)
    return len(before) == len(after) and bool(np.allclose(before, after, rtol=_SAME, atol=0.0))


def _materials(m: Model) -> Floats:
    """What of the materials contacts depend on, in roughnesses and newtons, and fractions by tooth and position."""
    numbers: list[float] = []
    for record in m.scene.coverage:
        numbers += [
            record.teeth,
            *m.tables[record.values_at : record.values_at + record.teeth * record.positions],
        ]
    for record in m.scene.material:
        force = record.force_scale * m.scene.force_unit
        pull = record.attraction * m.scene.force_unit
        numbers += [force, record.stretch_limit, record.joining_energy, record.gap_offset, pull]
    return np.array(numbers)


def _carry_contacts(old: Problem, old_y: Floats, new: Problem, y: Floats, *, changed: bool) -> None:
    """Carry what contacts remember to the new materials and nodes, and book the change of the stored energy."""
    source, m = old.model, new.model
    if changed and m.scene.attracts != 0:
        accept(m, float(m.state.time), y)  # pairs that have not been within reach
    if m.scene.population.flanks > 0:
        take_joined(m, y, joined_asperities(source))
        if changed:
            join_at_start(m, y)
            _note_change(source, old_y, m, y)
        return
    for k in range(int(m.scene.histories)):
        if m.state.history[k].pair != EMPTY and changed:
            remember(source, m, k)
    same_nodes = _carry_deflections(source, old_y, m, y)
    if m.scene.nodes > 0 and (changed or not same_nodes):
        if changed and source.scene.nodes > 0:
            join_anew(m, y, tuple(float(material.stretch_limit) == 0.0 for material in source.scene.material))
        else:
            settle_nodes(m, float(m.state.time), y)
        note_gaps(m, y)
    if changed or not same_nodes:
        _note_change(source, old_y, m, y)


def _note_change(source: Model, old_y: Floats, m: Model, y: Floats) -> None:
    """Book by how much contacts store more with the new materials than they did with the old ones."""
    was = stored_energy(source, old_y)[0] * float(source.scene.force_unit / m.scene.force_unit)
    m.state.energy.model_change += stored_energy(m, y)[0] - was


def _carry_deflections(source: Model, old_y: Floats, m: Model, y: Floats) -> bool:
    """Carry deflections and histories of nodes; whether they are the same to the last bit."""
    if m.scene.nodes == 0:
        return source.scene.nodes == 0
    if source.scene.nodes == 0:
        join_as_pairs(m, y)
        return False
    return carry_nodes(source, old_y, m, y)


def _begin_stretch(m: Model) -> None:
    """Begin the counters of the run and its schedules, and the parts of the chain over which speeds are judged."""
    s, time = m.state, float(m.state.time)
    if m.scene.nodes == 0:
        s.deep_exits = -1
    assign(s.progress, np.zeros(1, STATE["progress"])[0])
    s.next_knot = 0
    s.roots = 0
    blank = np.zeros(1, EXTREMES)[0]
    s.extremes["part"] = blank["part"]
    s.extremes.fall = s.extremes.rise = 0.0
    s.extremes.top = s.extremes.bottom = 0.0
    begin_parts_before(m, time)
    for which in range(len(m.scene.schedule)):
        ends = segment_ends(m.scene.schedule[which], m.tables)
        s.segment[which] = int((ends <= time).sum())


def forget_balance(m: Model) -> None:
    """Leave out what an energy balance has summed up so far."""
    assign(m.state.energy, np.zeros(1, STATE["energy"])[0])
    for name in ("adhesion_lag", "adhesion_lag_power", "adhesion_lag_power_rate"):
        m.state.history[name] = 0.0


def _begin_balance(address: int, m: Model, y: Floats) -> None:
    """Begin an energy balance that the other run has not kept, or leave out the one that it has."""
    forget_balance(m)
    if m.scene.follow.balance:
        open_balance(address, y)


def _hold_or_slip(source: Model, m: Model, time: float, y: Floats) -> None:
    """Set the directions of slip where other elements resist than before, or what holds the gears no longer does."""
    if m.scene.friction.may_stick == 0:
        m.state.hold, m.state.slip = FREE, 1.0
    elif (
        m.scene.friction.any_friction == source.scene.friction.any_friction
        and (m.scene.torque["resists"] == source.scene.torque["resists"]).all()
    ):
        settle_start(m, time, y, False)
    else:
        begin_sliding(m, time, y)
