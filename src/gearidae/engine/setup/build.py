"""From a scene to the numbers that the compiled residual reads."""

from __future__ import annotations

import json
import math

import numpy as np

from gearidae.engine.compiling import (
    ELASTIC,
    EXPOSURES,
    FRICTION,
    IMPACTS,
    POPULATION,
    SOLVER,
    make_part_ready,
)
from gearidae.engine.elastic.layout import DEPTH_HIGH, ContactBounds
from gearidae.engine.elastic.node_rows import scratch_size
from gearidae.engine.events.histories import begin
from gearidae.engine.events.mesh_marks import MARKS
from gearidae.engine.laws.pairs import laws_of_mesh
from gearidae.engine.model.scene_record import MESH_CONSTANTS
from gearidae.engine.model.state import (
    COAST,
    DRIVE,
    GEARS,
    LOAD,
    MATERIALS,
    MOTION,
    ROLLER,
    SCENE,
    SCHEDULES,
    Floats,
    Model,
    Record,
    blank_model,
)
from gearidae.engine.motion.static_solve import settle_nodes
from gearidae.engine.observers.balance import open_balance
from gearidae.engine.observers.exposures.bins import ROWS
from gearidae.engine.pairs.mesh_error import NO_ERROR, error_at
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.tooth_pairs import length_at
from gearidae.engine.setup.build_contact import Nodes, add_attraction, add_contact, add_nodes, choose_model
from gearidae.engine.setup.build_friction import add_friction
from gearidae.engine.setup.build_population import add_population, population_rows
from gearidae.engine.setup.build_torques import add_torques, reference_force, set_run, set_stop
from gearidae.engine.setup.checkpoint import scene_digest
from gearidae.engine.setup.problem import Problem
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.engine.setup.tables import Tables
from gearidae.laws.frictions import FRICTION_LAWS, has_friction_law
from gearidae.laws.pairs import number_of_mesh
from gearidae.laws.shaft.own import law_address, switch_address
from gearidae.laws.shaft.schedule import (
    segment_ends,
)
from gearidae.mesh.involute import Geometry
from gearidae.records.quantity import Unit
from gearidae.scene import MATERIAL_NAMES, GearScene, RollerScene, Scene, require_gears
from gearidae.scene.combinations import may_deflect
from gearidae.scene.limits import check_reach, pairs_within_reach, relief_in_reach
from gearidae.scene.orbit import fastest_rotation, has_orbit
from gearidae.scene.pitch_errors import error_on_path, errors_of_teeth, extreme_sums, has_pitch_errors
from gearidae.scene.sampled import columns_of

ORBIT_STEP = 0.01
"""Angle by which the force of the drive turns at most between two values of its direction [rad]: a polynomial through
six of them then has the second derivative to 4e-10."""
_STANDS = 1e-9
"""Speed of its direction below which that stands still [rad/s]."""
LIGHTER = 0.25
"""Roughnesses above the bound of the asperity model; below, contacts count as deep while bodies are elastic."""


def make_problem(
    scene: Scene,
    nodes: Nodes | None = None,
    digest: tuple[float, ...] | None = None,
    columns: tuple[str, ...] | None = None,
    start: Start = AT_ONCE,
    light_gap: float = math.inf,
) -> Problem:
    """Scale a scene and tabulate its force laws.

    Parameters
    ----------
    nodes : Nodes, optional
        Layout of an elastic contact's nodes, in place of the one that is estimated.
    digest : tuple of four floats, optional
        Of the scene whose checkpoints these are, if it is not this one.
    columns : tuple of str, optional
        What that scene samples.
    start : Start, optional
        Of a run that goes on from another; the problem's own start is then of no use.
    light_gap : float, optional
        Gap in the middle of elastic contacts, in roughnesses, above which the asperity model would do.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    make_part_ready(SOLVER)
    if isinstance(scene, RollerScene):
        problem = _roller_problem(scene, nodes, start)
    else:
        problem = _gear_problem(require_gears(scene), nodes, start)
    problem.columns = columns or problem.columns
    problem.method = scene.run.method
    problem.digest = digest or scene_digest(json.dumps(scene.to_dict(), sort_keys=True, default=str))
    # handed on by value: a problem that referred to itself would wait for the garbage collector with all its tables
    same = (problem.digest, problem.columns, start)
    problem.model.scene.light_gap = light_gap
    count, lowest = int(problem.model.scene.nodes), float(problem.model.scene.lowest_gap)
    if count > 0:
        problem.depth = 1 if nodes is None else nodes.depth
        if lowest > -DEPTH_HIGH:
            deeper = Nodes(max(2.0 * lowest - 4.0, -DEPTH_HIGH), count, problem.depth + 1)
            problem.deeper = lambda: make_problem(scene, deeper, *same, light_gap)
    elif may_deflect(scene):
        light = lowest + LIGHTER
        problem.elastic = lambda: make_problem(
            scene.replace({"contact.bodies": "elastic"}), None, *same, light
        )
    return problem


def _gear_problem(scene: GearScene, nodes: Nodes | None, begin: Start) -> Problem:
    gears, mesh, start, drive, load = scene.gears, scene.mesh, scene.initial, scene.drive, scene.load
    geometry, sigma = scene.geometry, scene.surface.roughness
    s, tables = np.zeros(1, SCENE)[0], Tables()
    _set_units(s, scene)
    speed = sigma / float(s.time_unit)
    _set_geometry(s, geometry, mesh.tip_relief_radius)
    s.clearance = s.nearest = 0.5 * mesh.backlash / sigma
    s.marks = MARKS
    s.bins = scene.run.exposures
    s.bins_per_pitch = scene.run.exposures / float(s.contact_ratio)
    s.pitch_point = 0.5 * (float(s.coast_phase) - 0.5)
    s.sliding_pinion, s.sliding_gear = (
        geometry.base_pitch / float(s.pinion_radius),
        geometry.base_pitch / float(s.gear_radius),
    )
    s.curvature_force = int(mesh.radius_force)
    _set_mesh_constants(s, scene)
    grid = choose_model(s, scene, _gear_bounds(s, scene), nodes)
    widest = math.sqrt(0.25 / float(s.sum_curvature))
    unit_length = math.sqrt(2.0 * geometry.base_pitch * sigma)
    if scene.contact.is_discrete:
        s.curvature_force = 1  # the asperities' own, which pays for all that changes along the path
        add_population(s, tables, scene, float(1.0 / s.phase_rate), math.pi / gears.pinion_teeth)
    else:
        add_contact(s, tables, scene, gears.face_width, unit_length, widest)
    add_attraction(s, tables, scene, gears.face_width, unit_length, widest)
    s.reach = math.sqrt(2.0 * relief_in_reach(scene, float(s.cutoff)) / float(s.relief_curvature))
    add_friction(s, scene)
    _set_slots(s, scene)
    add_torques(s, tables, scene, begin.time)
    set_stop(s, scene, start.mesh_phase if begin.position is None else begin.position)
    _add_orbit(s, scene, begin.time)
    _add_errors(s, tables, scene)
    _add_pitch_errors(s, tables, scene)
    s.orbit_nearest = s.nearest[COAST] - s.clearance[COAST]
    add_nodes(s, tables, grid)
    # an error in the phase matters by the gap it opens where tip relief is steepest
    steepest = float(s.relief_curvature * s.reach)
    model = _model(s, tables, [1.0, 1.0, 1.0 / steepest if steepest > 0.0 else 1.0, 1.0])
    model.state.slip = 1.0
    for which in range(SCHEDULES):
        ends = segment_ends(s.schedule[which], model.tables)
        model.state.segment[which] = int((ends <= s.start).sum())
    for shaft, law in ((DRIVE, drive), (LOAD, load)):
        if law.law is not None:
            model.work.torque_law[shaft] = law_address(law.law.name)
            model.work.torque_switch[shaft] = switch_address(law.law.name)
    whole, phase = divmod(start.mesh_phase, 1.0)  # the solver's phase stays small: whole pitches are turns
    outside = phase - min(phase, float(s.contact_ratio))
    relief = float(0.5 * s.relief_curvature * outside**2)
    nearest = error_on_path(scene, coast=False)
    u = float(s.clearance[DRIVE]) + relief - (start.gap - nearest) / sigma
    w = start.gear_speed * geometry.base_radius_gear / speed
    model.state.whole_pitches, model.state.first_position = whole, start.mesh_phase
    model.state.ageing.age[:] = start.rest_time / float(s.time_unit)
    if s.orbit != 0.0:  # asked here as well: a call from Python takes 50 us
        follow_orbit(model, 0.0)
    error = error_at(model, u, phase) if s.has_error != 0 else NO_ERROR
    model.state.initial_pinion_lead = u + error.value
    skipped = {
        "static_error": int(not mesh.static_error),
        "harmonics": int(not drive.harmonic and not load.harmonic),
        **{law.holders[0].name: int(not has_friction_law(scene, LOAD, law)) for law in FRICTION_LAWS},
    }
    return _begun(model, scene, [u, -float(error.rate), phase, w], skipped)


def _roller_problem(scene: RollerScene, nodes: Nodes | None, begin: Start) -> Problem:
    roller = scene.roller
    sigma = scene.surface.roughness
    speed = roller.speed if roller.speed != 0.0 else 1e3 * sigma / scene.run.duration
    s, tables = np.zeros(1, SCENE)[0], Tables()
    s.kind, s.length_unit = ROLLER, sigma
    s.time_unit, s.force_unit = sigma / abs(speed), roller.mass * speed**2 / sigma
    # the gear is held: its pair stays at one point, where its contact has the length 1, of a path without length
    s.pinion_inverse_mass = s.phase_rate = s.start_radius = 1.0
    s.clearance = s.nearest = (0.0, math.inf)
    s.coast_phase = 0.25
    energy = 0.5 * roller.mass * roller.speed**2
    bounds = ContactBounds(roller.width, roller.radius, 1.0, 1.0, energy, energy, 0.0, roller.height / sigma)
    grid = choose_model(s, scene, bounds, nodes)
    unit_length = math.sqrt(2.0 * roller.radius * sigma)
    if scene.contact.is_discrete:
        add_population(s, tables, scene, roller.radius / sigma, 0.0)
    else:
        add_contact(s, tables, scene, roller.width, unit_length, 1.0)
    add_attraction(s, tables, scene, roller.width, unit_length, 1.0)
    s.slots = s.histories = 1
    set_run(s, tables, scene, set(), begin.time)
    add_nodes(s, tables, grid)
    model = _model(s, tables, [1.0] * MOTION)
    model.state.slip = 1.0
    start = [-roller.height / sigma, roller.speed * float(s.time_unit) / sigma, 0.0, 0.0]
    return _begun(model, scene, start, {})


# -- constants -------------------------------------------------------------------------------------------------------


def _set_units(s: Record, scene: GearScene) -> None:
    """Set the units of a gear pair and its inverse masses."""
    gears, geometry = scene.gears, scene.geometry
    pinion_mass = gears.pinion_inertia / geometry.base_radius_pinion**2
    gear_mass = gears.gear_inertia / geometry.base_radius_gear**2
    mass = 1.0 / (1.0 / pinion_mass + 1.0 / gear_mass)
    force = reference_force(scene, mass)
    s.kind, s.length_unit = GEARS, scene.surface.roughness
    s.time_unit, s.force_unit = math.sqrt(mass * scene.surface.roughness / force), force
    s.pinion_inverse_mass, s.gear_inverse_mass = mass / pinion_mass, mass / gear_mass


def _set_mesh_constants(s: Record, scene: Scene) -> None:
    """Set the constants of laws of the mesh that a key of the scene says."""
    for constant in MESH_CONSTANTS:
        unit = Unit("", force=constant.force, length=constant.length, time=constant.time)
        s[constant.name] = number_of_mesh(scene, constant.name) / unit.in_si(s)


def _set_geometry(s: Record, geometry: Geometry, tip_relief_radius: float) -> None:
    """Set the constants of a gear pair that geometry alone decides."""
    pitch, sigma = geometry.base_pitch, float(s.length_unit)
    s.base_pitch = pitch
    s.pinion_radius, s.gear_radius = geometry.base_radius_pinion, geometry.base_radius_gear
    s.pinion_teeth, s.gear_teeth = geometry.pinion_teeth, geometry.gear_teeth
    s.phase_rate = sigma / pitch
    s.contact_ratio = geometry.contact_ratio
    s.coast_phase = 2.0 * geometry.approach / pitch + 0.5
    s.relief_curvature = pitch**2 / (tip_relief_radius * sigma)
    s.relief_slope = pitch / tip_relief_radius
    s.start_radius = (geometry.tangent_pinion - geometry.approach) / pitch
    s.sum_curvature = pitch / (geometry.tangent_pinion + geometry.tangent_gear)


def _gear_bounds(s: Record, scene: GearScene) -> ContactBounds:
    """Where the contacts of a gear pair take place."""
    gears, mesh, start = scene.gears, scene.mesh, scene.initial
    # the radius is largest where both radii of curvature are the same, if that is on the path
    ratio = float(s.contact_ratio)
    equal = 0.5 / float(s.sum_curvature) - float(s.start_radius)
    first, curvature = float(s.start_radius), float(s.sum_curvature)
    lengths = [length_at(first + x, curvature) for x in (0.0, ratio, min(max(equal, 0.0), ratio))]
    # the load pushing through the whole backlash, twice for good measure
    force = float(s.force_unit)
    energy = 2.0 * force * mesh.backlash
    nearest = min(start.gap, mesh.backlash - start.gap) / float(s.length_unit)
    pitch = float(s.base_pitch)
    return ContactBounds(gears.face_width, pitch, min(lengths), max(lengths), energy, 0.0, force, nearest)


def _set_slots(s: Record, scene: GearScene) -> None:
    """Set how many histories each flank keeps: at least as many as pairs can be within reach."""
    check_reach(scene, float(s.cutoff))
    slots = 2 ** math.ceil(math.log2(pairs_within_reach(scene, float(s.cutoff))))
    s.slots, s.histories = slots, 2 * slots


# -- tables ----------------------------------------------------------------------------------------------------------


def _add_errors(s: Record, tables: Tables, scene: GearScene) -> None:
    """Lay out the harmonics of the pinion's angle, static error and runout, and set the runout of the gear."""
    mesh, sigma = scene.mesh, float(s.length_unit)
    harmonics: list[tuple[float, float, float]] = [
        (h.order, h.amplitude / sigma, h.phase) for h in mesh.static_error
    ]
    if mesh.pinion_runout is not None:
        harmonics.append((1, mesh.pinion_runout.amplitude / sigma, mesh.pinion_runout.phase))
    if mesh.gear_runout is not None:
        s.gear_runout, s.gear_runout_phase = mesh.gear_runout.amplitude / sigma, mesh.gear_runout.phase
    s.error_count, s.error_at = len(harmonics), tables.add([x for harmonic in harmonics for x in harmonic])
    s.has_error = int(s.error_count > 0 or s.gear_runout != 0.0 or s.orbit != 0.0)
    order = max((order for order, _, _ in harmonics), default=0)
    # two fractions of a table are half a period
    positions = max(len(table[0]) for table in scene.coating.tables)
    if positions > 1:
        order = max(order, 0.5 * positions / float(s.contact_ratio) * float(s.pinion_teeth))
    s.mesh_omega = 2.0 * math.pi * max(1.0, order / float(s.pinion_teeth))


def _add_orbit(s: Record, scene: GearScene, begin: float) -> None:
    """Set where the centre of the pinion stands under the force of the drive."""
    if not has_orbit(scene):
        return
    clearance, turned = scene.gears.pinion_hub_clearance / float(s.length_unit), scene.drive.orientation
    pressure = scene.geometry.pressure_angle
    s.orbit, s.orbit_play = clearance, 2.0 * clearance * math.sin(pressure)
    s.orbit_sine, s.orbit_cosine = math.sin(pressure + turned), math.cos(pressure + turned)
    s.orbit_x, s.orbit_y = math.cos(turned), -math.sin(turned)
    # a power of two, so that what rounding makes of the speed changes nothing in a run that goes on
    longest = ORBIT_STEP / max(fastest_rotation(scene, begin), _STANDS)
    s.orbit_step = 2.0 ** math.floor(math.log2(longest)) / float(s.time_unit)
    s.noting = 1


def _add_pitch_errors(s: Record, tables: Tables, scene: GearScene) -> None:
    """Lay out the errors of single teeth, and set the gaps of those that stand out farthest."""
    if not has_pitch_errors(scene):
        return
    pinion, gear = errors_of_teeth(scene)
    sigma, ((drive, _), (_, coast)) = float(s.length_unit), extreme_sums(scene)
    s.pitch_errors = 1
    s.pinion_errors_at, s.gear_errors_at = tables.add(pinion / sigma), tables.add(gear / sigma)
    s.nearest = float(s.clearance[DRIVE]) + drive / sigma, float(s.clearance[COAST]) - coast / sigma


# -- the start -------------------------------------------------------------------------------------------------------


def _model(s: Record, tables: Tables, scale: list[float]) -> Model:
    """Put the model together, and note where its changing rows are; `scale` weighs the motion's states."""
    nodes, histories = int(s.nodes), int(s.histories)
    s.pair_laws = laws_of_mesh(s)
    s.states = MOTION + nodes * histories
    moving = MOTION if s.gear_inverse_mass > 0.0 else 2
    s.scale_at = tables.add(_scale(nodes, histories, scale, moving))
    rows = Tables()
    s.branches_at = rows.add(np.zeros(2 * MATERIALS * int(s.branch_length) * histories))
    s.node_rows_at = rows.add(np.zeros(int(s.node_row_length) * histories))
    s.error_weights_at = rows.add(np.zeros(int(s.states)))
    s.exposure_rows = ROWS.per_tooth(rubs=s.friction.flanks != 0)
    s.exposures = 2 * int(s.pinion_teeth) * int(s.exposure_rows) * int(s.bins)
    s.exposures_at = rows.add(np.zeros(int(s.exposures)))
    branches = MATERIALS * int(s.points * s.point_branch_length) * histories
    s.point_branches_at = rows.add(np.zeros(branches))
    s.scratch_at = rows.add(np.zeros(scratch_size(nodes) if nodes else 0))
    s.trial_at = rows.add(np.zeros(int(s.states) if nodes else 0))
    s.population.rows_at = rows.add(population_rows(s))
    return blank_model(s, tables.whole(), rows.size)


def _scale(nodes: int, histories: int, motion: list[float], moving: int) -> Floats:
    """What an error of 1 means for each state.

    The solver's norm is a mean over all states. Factors make it that of the motion alone, of the states that are
    `moving`, however many nodes there are, with the nodes of one pair counting as one more state.
    """
    share = math.sqrt(moving / (len(motion) + nodes * histories))
    return np.concatenate(
        [share * np.array(motion), np.full(nodes * histories, share * math.sqrt(max(nodes, 1)))]
    )


def _begun(m: Model, scene: Scene, motion: list[float], skipped: dict[str, int]) -> Problem:
    """Set the histories and the energy balance for the start."""
    s = m.scene
    y = np.concatenate([motion, np.zeros(int(s.nodes * s.histories))])
    parts = (
        (ELASTIC, s.nodes > 0),
        (EXPOSURES, s.bins > 0),
        (POPULATION, s.population.flanks > 0),
        (FRICTION, s.friction.may_stick != 0 or s.orbit != 0.0),
        (IMPACTS, scene.run.impacts),
    )
    for part, wanted in parts:
        if wanted:
            make_part_ready(part)
    if s.nodes > 0:
        settle_nodes(m, 0.0, y)
    scale = m.tables[s.scale_at : s.scale_at + s.states]
    problem = Problem(m, y, scale, columns_of(scene), _skipped(m, scene) | skipped)
    begin(problem.addresses.base, 0.0, y)
    s.follow.balance, s.follow.extremes, s.follow.exposures = scene.run.balance, 1, s.bins > 0
    s.follow.gear = int(s.gear_inverse_mass > 0.0)
    s.follow.passages = int(scene.run.passages and s.follow.gear)
    s.follow.impacts = int(scene.run.impacts)
    s.follow.friction = int(scene.run.balance and s.friction.any_friction != 0)
    if s.follow.balance != 0:
        open_balance(problem.addresses.base, y)
    return problem


def _skipped(m: Model, scene: Scene) -> dict[str, int]:
    """What the contact of this scene does not need."""
    skipped = {"elastic_deflection": int(m.scene.nodes == 0)}
    shares = {material.name: material.share for material in scene.materials()}
    for record, name in zip(m.scene.material, MATERIAL_NAMES, strict=True):
        skipped[f"{name}_surface"] = int(shares.get(name, 0.0) == 0.0)
        without = record.stretch_limit == 0.0 and m.scene.population.flanks == 0
        skipped[f"{name}_hysteresis"] = int(without or shares.get(name, 0.0) == 0.0)
    return skipped
