"""From a scene's drive, load and run to torques, schedules, stops and the load that the scene is about."""

from __future__ import annotations

import math

import numpy as np

from gearidae.engine.model.state import DRIVE, LOAD, SPEED, STOPS, Floats, Record
from gearidae.engine.setup.tables import Tables
from gearidae.laws.frictions import LAWS_OF_SHAFTS, largest_limit
from gearidae.laws.law import number_of
from gearidae.laws.shaft.harmonic import common_period, pack_harmonics
from gearidae.laws.shaft.own import largest_torque, law_knots, shortest_sector
from gearidae.laws.shaft.schedule import LEAST_CUBIC, fastest_schedule, pack_schedule, steep_knots
from gearidae.laws.shafts import ACTING, SHAFT_LAWS, has_law, is_held, sampled_laws
from gearidae.scene import Drive, GearScene, Knots, Load, Scene
from gearidae.torques import torque_law

QUADRATURE_STEPS = 6  # accepted steps near contact that the energy balance integrates over at once
QUADRATURE_TIME = 8.0  # over which they may last, over tau; and half a radian of the fastest torque at most
KNOT_SPACING = 1e-12  # what knots must be apart, over the time itself
ROOT_LIMIT = 1_000  # more roots than this in close succession is chatter
ROOT_SPACING = 1e-12  # what is close, over the time itself
LOOKS_PER_PERIOD = 32  # of the fastest harmonic, at the torques of what is held
LAW_LOOKS = 100_000  # in a run, at the registered laws of what is held


def _largest(shaft: Drive | Load, speed: float, duration: float) -> float:
    """Bound of a shaft's prescribed torque [N m]; of its law, up to a speed [rad/s]."""
    steady = abs(shaft.torque) + sum(abs(h.amplitude) for h in shaft.harmonic)
    if isinstance(shaft, Load):
        steady += shaft.viscous * abs(speed)
    if shaft.law is not None:
        steady += largest_torque(shaft.law.name, shaft.law.numbers(), speed, duration)
    return steady + max((abs(value) for _, value in shaft.schedule), default=0.0)


def _largest_held(scene: GearScene, speed: float, ratio: float) -> float:
    """Bound of the torque [N m] that holds a speed: of the first difference, and to carry both gears along."""
    knots = np.array(scene.drive.speed_knots().cycle())
    inertia = scene.gears.pinion_inertia + scene.gears.gear_inertia / ratio**2
    slopes = np.abs(np.diff(knots[:, 1]) / np.diff(knots[:, 0]))
    most = scene.drive.speed_gain * float(np.ptp(knots[:, 1]))
    return scene.drive.speed_gain * abs(float(knots[0, 1]) - speed) + min(
        inertia * float(slopes.max(initial=0.0)), most
    )


def reference_force(scene: GearScene, mass: float) -> float:
    """Load along the line of action that this scene is about [N]: from the torques, else from the motion."""
    geometry, speed, duration = scene.geometry, scene.initial.gear_speed, scene.run.duration
    ratio = geometry.base_radius_gear / geometry.base_radius_pinion
    drive = _largest(scene.drive, speed * ratio, duration)
    if scene.drive.speed is not None:
        drive += _largest_held(scene, speed * ratio, ratio)
        speed = max([abs(speed), *(abs(value) / ratio for _, value in scene.drive.speed_knots())])
    drive += largest_limit(scene, DRIVE)
    load = _largest(scene.load, speed, duration) + largest_limit(scene, LOAD)
    force = max(
        drive / geometry.base_radius_pinion,
        (load + scene.load.drag * speed**2) / geometry.base_radius_gear,
    )
    if force == 0.0:
        force = mass * (speed * geometry.base_radius_gear) ** 2 / geometry.base_pitch
    return force if force > 0.0 else mass * scene.surface.roughness * (1e3 / scene.run.duration) ** 2


def add_torques(s: Record, tables: Tables, scene: GearScene, begin: float) -> None:
    """Lay out the torques of both shafts and the times of their knots, and set what the run follows from them."""
    tau, force = float(s.time_unit), float(s.force_unit)
    shafts = ((DRIVE, scene.drive, float(s.pinion_radius)), (LOAD, scene.load, float(s.gear_radius)))
    knots: set[float] = set()
    waves: list[Floats] = []
    fastest = 0.0
    for shaft, law, radius in shafts:
        torque, unit = s.torque[shaft], force * radius
        harmonics = [(h.amplitude, h.frequency, h.phase) for h in law.harmonic if h.frequency is not None]
        waves.append(np.array(pack_harmonics(harmonics, tau, unit)))
        orders = [(h.amplitude / unit, h.order, h.phase) for h in law.harmonic if h.order is not None]
        torque.constant = law.torque / unit
        _add_coefficients(s, scene, shaft, law, radius)
        torque.harmonic_count, torque.harmonics_at = len(harmonics), tables.add(waves[-1])
        torque.law_torque, torque.law_speed = unit, float(s.length_unit) / tau / radius
        torque.order_count, torque.orders_at = len(orders), tables.add([x for term in orders for x in term])
        torque.angle_unit = float(s.length_unit) / radius
        highest = max((order for amplitude, order, _ in orders if amplitude != 0.0), default=0.0)
        if law.law is not None:
            numbers = law.law.numbers()
            torque.law_count, torque.law_at = len(numbers), tables.add(numbers)
            declared = torque_law(law.law.name)
            if declared.takes_angle or declared.switch is not None:
                torque.takes_angle, highest = 1, max(highest, 1.0)
            torque.law_unknown = int(not declared.is_declared)
            s.law_switches |= int(declared.switch is not None)
            s.law_watched |= int(torque.law_unknown or s.law_switches)
            end = begin + scene.run.duration
            knots |= {t / tau for t in law_knots(law.law.name, numbers, begin, end)}
            torque.law_sector = shortest_sector(law.law.name, numbers, begin, end)
        torque.takes_angle = int(torque.takes_angle or bool(orders))
        s.angle_omega = max(float(s.angle_omega), highest * float(s.base_pitch) / radius)
        fastest = max([fastest, *(frequency for _, frequency, _ in harmonics)])
    speed = float(s.length_unit) / tau / float(s.pinion_radius)
    schedules = (
        (DRIVE, "drive.schedule", scene.drive.schedule, force * float(s.pinion_radius)),
        (LOAD, "load.schedule", scene.load.schedule, force * float(s.gear_radius)),
        (SPEED, "drive.speed", scene.drive.speed_knots(), speed),
    )
    for which, key, schedule, unit in schedules:
        known = schedule.during(begin, begin + scene.run.duration, key)
        knots |= _add_schedule(s, tables, which, known, unit)
        if s.schedule[which].cubic:
            omega = fastest_schedule(s.schedule[which], tables.whole(), 0.0)
            fastest = max(fastest, omega / (2.0 * math.pi * tau))
    s.tied = int(is_held(scene))
    s.law_columns = len(sampled_laws(scene))
    set_run(s, tables, scene, knots, begin)
    _set_rest_search_step(s, waves, scene)
    # a torque that knows the motion vibrates with it, and is looked at in each step
    laws = scene.drive.law is not None or scene.load.law is not None
    knows_motion = laws or s.torque["speed_gain"].any() or s.torque["takes_angle"].any()
    s.quadrature_steps = 1 if knows_motion else QUADRATURE_STEPS
    s.quadrature_time = 1.0 / (1.0 / QUADRATURE_TIME + 4.0 * math.pi * fastest * tau)


def _add_coefficients(s: Record, scene: GearScene, shaft: int, table: Drive | Load, radius: float) -> None:
    """Set the coefficients of the laws of a shaft from the tables of gears, drive and load, and which laws act."""
    torque, speed, force = s.torque[shaft], float(s.length_unit) / float(s.time_unit), float(s.force_unit)
    for constant in (constant for law in LAWS_OF_SHAFTS for constant in law.coefficients):
        of_gears = constant.key is not None
        value = number_of(scene, shaft, constant.name) if of_gears else getattr(table, constant.name, 0.0)
        torque[constant.name] = constant.scaled(value, radius, speed, force)
    for law in SHAFT_LAWS:
        if has_law(scene, shaft, law):
            s.guarded |= int(law.guard is not None)
            torque.takes_angle |= int(law.by_angle is not None)
    for k, law in enumerate(ACTING):
        if any(torque[constant.name] != 0.0 for constant in law.coefficients):
            torque.acts |= 1 << k


def _set_rest_search_step(s: Record, waves: list[Floats], scene: GearScene) -> None:
    """Set how often the torques of what is held are looked at, and what is known of their packed harmonics."""
    fastest = 0.0
    for harmonics in waves:
        amplitudes, frequencies = abs(harmonics[0::3]), abs(harmonics[1::3])
        fastest = max(fastest, float(frequencies.max(initial=0.0)))
        s.rest_margin_curvature += float((amplitudes * frequencies**2).sum())
    s.rest_search_step = 2.0 * math.pi / (LOOKS_PER_PERIOD * fastest) if fastest > 0.0 else math.inf
    if scene.drive.law is not None or scene.load.law is not None:
        s.rest_search_step, s.rest_margin_curvature = (
            min(float(s.rest_search_step), float(s.end - s.start) / LAW_LOOKS),
            math.inf,
        )
    both = (*scene.drive.harmonic, *scene.load.harmonic)
    period = common_period(h.frequency for h in both if h.frequency is not None)
    s.common_period = period / float(s.time_unit)


def _add_schedule(s: Record, tables: Tables, which: int, schedule: Knots, unit: float) -> set[float]:
    """Lay out a schedule of values in a unit; return the times over tau at which the solver has to stop for it."""
    tau, record = float(s.time_unit), s.schedule[which]
    cubic = schedule.interpolation == "cubic" and len(schedule) >= LEAST_CUBIC
    record.knot_count, record.cubic = len(schedule), int(cubic)
    record.knots_at = tables.add(pack_schedule(schedule, tau, unit, cubic=cubic))
    if cubic:
        return {t / tau for t in (schedule[0][0], *steep_knots(schedule), schedule[-1][0])}
    return {t / tau for t, _ in schedule}


def set_run(s: Record, tables: Tables, scene: Scene, knots: set[float], begin: float) -> None:
    """Set start and end of the run, its knots and checkpoints, and what counts as chatter."""
    tau = float(s.time_unit)
    start, end = begin / tau, (begin + scene.run.duration) / tau
    s.start, s.end = start, end
    s.largest_step = (scene.run.largest_step or 0.0) / tau
    kept = {t / tau for t in scene.run.checkpoints}
    times = sorted(t for t in knots | kept if start < t < end)
    # of knots that the solver cannot tell apart the last one serves for all: schedules enter every segment up to it
    following = [*times[1:], end]
    apart: list[float] = []
    marks: list[float] = []
    marked = False
    for t, after in zip(times, following, strict=False):
        marked |= t in kept
        if after - t > KNOT_SPACING * after:
            apart.append(t)
            marks.append(float(marked))
            marked = False
    s.knot_count, s.knots_at, s.checkpoints_at = len(apart), tables.add(apart), tables.add(marks)
    s.root_limit, s.root_spacing = ROOT_LIMIT, ROOT_SPACING


def set_stop(s: Record, scene: GearScene, position: float) -> None:
    """Set what ends the run before its time."""
    word, _, turns = scene.run.stop.partition(" ")
    s.stop, s.stop_from = STOPS.index(word), position
    s.stop_pitches = float(turns or 0.0) * scene.gears.gear_teeth
