"""From a scene to the numbers that the compiled residual reads."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.contact.asperities import law_of
from gearidae.contact.kernels.energy import energy_table, joining_energy, number_table
from gearidae.contact.kernels.law import (
    GAP_HIGH,
    GAP_LOW,
    H_STRETCH,
    HEADER,
    N_LOADING,
    Kernel,
    branch_length,
    check_reach,
    force_scale,
    law_table,
    law_value,
)
from gearidae.contact.tip import asperity_of
from gearidae.engine.elastic.calls import service
from gearidae.engine.elastic.layout import DEPTH_HIGH, Footing, deepest_gap, node_grid, rigid_limit
from gearidae.engine.elastic.nodes import history_size
from gearidae.engine.elastic.static_solve import settle_nodes
from gearidae.engine.energy.balance import follow, kinetic_energy, open_ledger, stored_energy
from gearidae.engine.events.events import begin
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import footprint, material_stretch
from gearidae.engine.model.torque import fastest_harmonic, pack_torque
from gearidae.errors import SceneError
from gearidae.mesh.involute import Geometry
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS, Ledger
from gearidae.scene import Drive, Load, Scene

__all__ = ["Problem", "make_problem"]

Floats = NDArray[np.float64]
Layout: TypeAlias = tuple[float, int | None]

FORCE_FLOOR = 1e-13  # of the reference load: contact forces below it are taken as zero
CONTACT_FORCE = 1e-3  # of the reference load: what counts as contact in onset and separation events
STRIDE = 6  # accepted steps near contact that the ledger integrates over at once
SPAN = 8.0  # over which they may last, over tau; and half a radian of the fastest torque at most
DOUBTS = 5.0  # in relative tolerances: where it may be out by more, it integrates over single steps
PARTS_RTOL = 1e-6  # relative tolerance below which it divides those in flight
FELT = 0.1  # of the tolerance of a speed
ROOT_LIMIT = 1_000  # more roots than this in close succession is chatter
ROOT_SPACING = 1e-12  # what is close, over the time itself

_LAWS = ((at.DRIVE_AT, at.PINION_SHARE), (at.LOAD_AT, at.GEAR_SHARE))


@dataclass(slots=True)
class Problem:
    """One scene, scaled and ready to run; a driver changes `data` in place.

    Attributes
    ----------
    data : ndarray
        See `layout`.
    start : ndarray, shape (n,)
        Scaled state at time 0.
    tolerance_scale : ndarray, shape (n,)
        What an error of 1 means for each state: times rtol, the absolute tolerances.
    end : float
        Duration over tau.
    knots : ndarray
        Times of the schedules' points inside the run, over tau, increasing.
    columns : tuple of str
        What `observe` writes.
    skipped : dict
        What this scene does not need.
    elastic : callable, optional
        Makes the elastic problem that takes over when the asperity model, chosen automatically, no longer will do.
    deeper : callable, optional
        Makes the same elastic problem with nodes laid out for deeper contacts, if there can be any.
    """

    data: Floats
    start: Floats
    tolerance_scale: Floats
    end: float
    knots: Floats
    columns: tuple[str, ...]
    skipped: dict[str, int]
    elastic: Callable[[], Problem] | None = None
    deeper: Callable[[], Problem] | None = None

    @property
    def time_unit(self) -> float:
        """The scene's tau [s]."""
        return float(self.data[at.TAU])

    def set_tolerance(self, rtol: float) -> None:
        """Let every state's error count in absolute tolerances, `rtol` times its scale.

        At tight ones the ledger divides steps in flight: the error of its quadrature goes with the fourth power of a
        step, and a step with no more than the eighth root of the tolerance. Torques that shake a gear by less than a
        share of the tolerance need not be followed.
        """
        d, first = self.data, int(self.data[at.WEIGHTS_AT])
        d[first : first + self.start.size] = 1.0 / (rtol * self.tolerance_scale)
        d[at.LEDGER_DOUBT] = DOUBTS * rtol
        d[at.LEDGER_PARTS] = math.ceil((PARTS_RTOL / rtol) ** (1.0 / 8.0))
        if d[at.KIND] == at.GEARS:
            felt = FELT * rtol * self.tolerance_scale[at.V]
            d[at.TORQUE_WAVE] = max(fastest_harmonic(d, int(d[law]), felt / d[share]) for law, share in _LAWS)

    def ledger(self, time: float, state: Floats, rates: Floats) -> Ledger:
        """The energy ledger at an accepted time.

        Parameters
        ----------
        time : float
            Over tau.
        state, rates : ndarray, shape (n,)
            Scaled state there, and its rate.
        """
        d = self.data
        kept = d[at.SUMS : at.LEDGER_END].copy()  # steps still to be gathered are not to be split by a look
        follow(d, time, state, rates, True)
        ledger = self._in_joules(time, state)
        d[at.SUMS : at.LEDGER_END] = kept
        return ledger

    def _in_joules(self, time: float, state: Floats) -> Ledger:
        d = self.data
        unit = float(d[at.FORCE] * d[at.SIGMA])
        stored, pending = stored_energy(d, state)
        return Ledger(
            time=time * self.time_unit,
            drive_work=unit * float(d[at.DRIVE_WORK]),
            radius_work=unit * float(d[at.RADIUS_WORK]),
            model_change=unit * float(d[at.MODEL_CHANGE]),
            drag_loss=unit * float(d[at.DRAG_LOSS]),
            dry_loss=unit * float(d[at.DRY_LOSS]),
            damping_loss=unit * float(d[at.DAMPING_LOSS]),
            adhesion_loss=unit * float(d[at.ADHESION_LOSS] + pending),
            stored_change=unit * float(stored - pending - d[at.START_STORED]),
            kinetic_change=unit * float(kinetic_energy(d, state) - d[at.START_KINETIC]),
            throughput=unit * float(d[at.THROUGHPUT]),
        )

    def checkpoint(self, time: float, state: Floats, counters: NDArray[np.int64]) -> Floats:
        """Everything that changes in a run, as one array of fixed length.

        Parameters
        ----------
        time : float
            Time reached, over tau.
        state : ndarray, shape (n,)
            Scaled state there.
        counters : ndarray of int64
            The driver's own counters.
        """
        changing = self.data[: int(self.data[at.LOADING_AT])]
        return np.concatenate([[time], state, counters, changing])

    def fits(self, checkpoint: Floats, counters: int) -> bool:
        """Whether a checkpoint with so many counters has this problem's size."""
        return checkpoint.size == 1 + self.start.size + counters + int(self.data[at.LOADING_AT])

    def at_depth(self, checkpoint: Floats, counters: int) -> Problem:
        """Lay this elastic problem's nodes out as they were for a checkpoint with so many counters."""
        problem = self
        while problem.deeper is not None and problem.fits(checkpoint, counters):
            lowest = checkpoint[checkpoint.size - int(problem.data[at.LOADING_AT]) + at.LOWEST_GAP]
            if lowest >= problem.data[at.LOWEST_GAP]:
                break
            problem = problem.deeper()
        return problem

    def outgrown(self, checkpoint: Floats) -> bool:
        """Whether a checkpoint of this problem stands where the model's bound has been passed."""
        changing = checkpoint[-int(self.data[at.LOADING_AT]) :]
        return changing.size > at.PASSED and bool(changing[at.PASSED] != 0.0)

    def restore(self, checkpoint: Floats, state: Floats, counters: NDArray[np.int64]) -> float:
        """Take a checkpoint back, in place, and return its time over tau.

        Raises
        ------
        SceneError
            If the checkpoint is not of this problem.
        """
        changing = int(self.data[at.LOADING_AT])
        if not self.fits(checkpoint, counters.size):
            raise SceneError("checkpoint", f"{checkpoint.size} numbers", "is not of this scene")
        ends = np.cumsum([1, state.size, counters.size])
        state[:] = checkpoint[ends[0] : ends[1]]
        counters[:] = checkpoint[ends[1] : ends[2]]
        self.data[:changing] = checkpoint[ends[2] :]
        return float(checkpoint[0])


def make_problem(scene: Scene, layout: Layout | None = None) -> Problem:
    """Scale a scene and tabulate its force laws.

    Parameters
    ----------
    scene : Scene
    layout : tuple of float and int, optional
        Lowest gap and number of nodes of an elastic contact, in place of those that are estimated.

    Raises
    ------
    SceneError
        If the scene is beyond what the engine can do.
    """
    problem = _gear_problem(scene, layout) if scene.roller is None else _roller_problem(scene, layout)
    nodes, lowest = int(problem.data[at.NODES]), float(problem.data[at.LOWEST_GAP])
    if nodes > 0 and lowest > -DEPTH_HIGH:
        deeper = max(2.0 * lowest - 4.0, -DEPTH_HIGH)
        problem.deeper = lambda: make_problem(scene, (deeper, nodes))
    elif nodes == 0 and scene.contact.model == "auto":
        problem.elastic = lambda: make_problem(scene.replace({"contact.model": "elastic"}))
    return problem


def _gear_problem(scene: Scene, layout: Layout | None) -> Problem:
    gears, mesh, start, drive, load = scene.gears, scene.mesh, scene.initial, scene.drive, scene.load
    assert gears
    assert mesh
    assert start
    assert drive
    assert load
    geometry, sigma = scene.geometry, scene.surface.roughness
    r1, r2, pitch = geometry.base_radius_pinion, geometry.base_radius_gear, geometry.base_pitch
    pinion_mass, gear_mass = gears.pinion_inertia / r1**2, gears.gear_inertia / r2**2
    mass = 1.0 / (1.0 / pinion_mass + 1.0 / gear_mass)
    force = _reference_force(scene, mass)
    tau = math.sqrt(mass * sigma / force)
    speed = sigma / tau

    head = _geometry_constants(geometry, mesh.tip_relief_radius, sigma)
    head[[at.TAU, at.FORCE]] = tau, force
    head[[at.PINION_SHARE, at.GEAR_SHARE]] = mass / pinion_mass, mass / gear_mass
    head[at.HALF_BACKLASH] = 0.5 * mesh.backlash / sigma
    head[at.DAMPING] = mesh.damping * speed / force
    head[at.DRAG] = load.drag / r2**3 * speed**2 / force
    # the radius is largest where both radii of curvature are the same, if that is on the path
    equal = 0.5 / head[at.SUM_CURVATURE] - head[at.START_RADIUS]
    places = (0.0, head[at.PATH], min(max(equal, 0.0), head[at.PATH]))
    lengths = [footprint(head, inside) for inside in places]
    # the load pushing through the whole backlash, twice for good measure
    energy = 2.0 * force * mesh.backlash
    nearest = min(start.gap, mesh.backlash - start.gap) / sigma
    footing = Footing(gears.face_width, pitch, min(lengths), max(lengths), energy, 0.0, force, nearest)
    grid = _bodies(head, scene, footing, layout)
    head[at.DRY] = float(load.torque != 0.0 or bool(load.harmonic) or bool(load.schedule))
    fastest = max((h.frequency for shaft in (drive, load) for h in shaft.harmonic), default=0.0)
    head[at.LEDGER_STRIDE] = STRIDE
    head[at.LEDGER_SPAN] = 1.0 / (1.0 / SPAN + 4.0 * math.pi * fastest * tau)
    head[at.SLIP] = np.sign(start.gear_speed) if head[at.DRY] else 1.0
    head[at.REST_SPEED] = 10.0 * scene.run.rtol
    contact = _contact(
        head,
        scene,
        gears.face_width,
        math.sqrt(2.0 * pitch * sigma),
        math.sqrt(0.25 / head[at.SUM_CURVATURE]),
    )
    head[at.REACH] = math.sqrt(2.0 * (head[at.CUTOFF] - GAP_LOW) / head[at.RELIEF])
    slots = 2 ** math.ceil(math.log2(head[at.PATH] + 2.0 * head[at.REACH]))

    errors = [x for h in mesh.static_error for x in (h.order, h.amplitude / sigma, h.phase)]
    head[at.ERROR_ORDERS] = len(mesh.static_error)
    order = max((h.order for h in mesh.static_error), default=0)
    head[at.MESH_WAVE] = 2.0 * math.pi * max(1.0, order / head[at.PINION_TEETH])
    laws = (_torque(drive, tau, force * r1), _torque(load, tau, force * r2))
    data = _assemble(head, 2, slots, contact, np.array(errors), *laws, grid)
    knots = {t / tau for shaft in (drive, load) for t, _ in shaft.schedule if 0.0 < t < scene.run.duration}

    relief = _relief(head, start.mesh_phase)
    u = head[at.HALF_BACKLASH] + relief - start.gap / sigma
    y0 = _with_nodes(data, [u, 0.0, start.mesh_phase, start.gear_speed * r2 / speed])
    begin(data, 0.0, y0)
    open_ledger(data, y0)
    # an error in the phase matters by the gap it opens where tip relief is steepest
    scale = _scale(data, [1.0, 1.0, 1.0 / (head[at.RELIEF] * head[at.REACH]), 1.0])
    skipped = _skipped(data, scene) | {
        "static_error": int(not errors),
        "harmonics": int(not drive.harmonic and not load.harmonic),
        "dry_resistance": int(head[at.DRY] == 0.0),
    }
    end = scene.run.duration / tau
    return Problem(data, y0, scale, end, np.array(sorted(knots)), GEAR_COLUMNS, skipped)


def _geometry_constants(geometry: Geometry, tip_relief_radius: float, sigma: float) -> Floats:
    """The constants of a gear pair that geometry alone decides."""
    pitch = geometry.base_pitch
    head = np.zeros(at.CONSTANTS)
    head[at.KIND] = at.GEARS
    head[at.SIGMA], head[at.BASE_PITCH] = sigma, pitch
    head[[at.PINION_RADIUS, at.GEAR_RADIUS]] = geometry.base_radius_pinion, geometry.base_radius_gear
    head[at.PINION_TEETH] = geometry.pinion_teeth
    head[at.PHASE_RATE] = sigma / pitch
    head[at.PATH] = geometry.contact_ratio
    head[at.COAST_PHASE] = 2.0 * geometry.approach / pitch + 0.5
    head[at.RELIEF] = pitch**2 / (tip_relief_radius * sigma)
    head[at.RELIEF_SLOPE] = pitch / tip_relief_radius
    head[at.START_RADIUS] = (geometry.tangent_pinion - geometry.approach) / pitch
    head[at.SUM_CURVATURE] = pitch / (geometry.tangent_pinion + geometry.tangent_gear)
    head[at.LAST_FLANK] = -1.0
    return head


def _roller_problem(scene: Scene, layout: Layout | None) -> Problem:
    roller = scene.roller
    assert roller is not None
    sigma = scene.surface.roughness
    speed = roller.speed if roller.speed != 0.0 else 1e3 * sigma / scene.run.duration
    force = roller.mass * speed**2 / sigma
    tau = sigma / abs(speed)
    head = np.zeros(at.CONSTANTS)
    head[at.KIND] = at.ROLLER
    head[at.SIGMA], head[at.TAU], head[at.FORCE] = sigma, tau, force
    head[at.GEAR_SHARE] = 1.0
    head[at.LAST_FLANK] = -1.0
    energy = 0.5 * roller.mass * roller.speed**2
    nearest = roller.height / sigma
    footing = Footing(roller.width, roller.radius, 1.0, 1.0, energy, energy, 0.0, nearest)
    grid = _bodies(head, scene, footing, layout)
    contact = _contact(head, scene, roller.width, math.sqrt(2.0 * roller.radius * sigma), 1.0)
    none = np.zeros(at.LAW_BODY)
    data = _assemble(head, 1, 1, contact, np.zeros(0), none, none, grid)
    y0 = _with_nodes(data, [roller.height / sigma, -roller.speed * tau / sigma])
    begin(data, 0.0, y0)
    open_ledger(data, y0)
    end = scene.run.duration / tau
    return Problem(
        data, y0, _scale(data, [1.0, 1.0]), end, np.zeros(0), ROLLER_COLUMNS, _skipped(data, scene)
    )


def _skipped(data: Floats, scene: Scene) -> dict[str, int]:
    """What the contact of this scene does not need."""
    fraction = scene.coating.sam_fraction
    return {
        "bare_surface": int(fraction == 1.0),
        "coated_surface": int(fraction == 0.0),
        "bare_hysteresis": int(material_stretch(data, 0) == 0.0),
        "coated_hysteresis": int(material_stretch(data, 1) == 0.0),
        "elastic_deflection": int(data[at.NODES] == 0.0),
    }


def _torque(shaft: Drive | Load, tau: float, unit: float) -> Floats:
    """A shaft's torque law as the residual reads it."""
    harmonics = [(h.amplitude, h.frequency, h.phase) for h in shaft.harmonic]
    return pack_torque(shaft.torque, harmonics, list(shaft.schedule), tau, unit)


def _largest(shaft: Drive | Load) -> float:
    """Bound of a shaft's prescribed torque [N m]."""
    steady = abs(shaft.torque) + sum(abs(h.amplitude) for h in shaft.harmonic)
    return steady + max((abs(value) for _, value in shaft.schedule), default=0.0)


def _reference_force(scene: Scene, mass: float) -> float:
    """Load along the line of action that this scene is about [N]: from the torques, else from the motion."""
    assert scene.drive
    assert scene.load
    assert scene.initial
    geometry, speed = scene.geometry, scene.initial.gear_speed
    force = max(
        _largest(scene.drive) / geometry.base_radius_pinion,
        (_largest(scene.load) + scene.load.drag * speed**2) / geometry.base_radius_gear,
    )
    if force == 0.0:
        force = mass * (speed * geometry.base_radius_gear) ** 2 / geometry.base_pitch
    return force if force > 0.0 else mass * scene.surface.roughness * (1e3 / scene.run.duration) ** 2


def _bodies(head: Floats, scene: Scene, footing: Footing, layout: Layout | None) -> Floats:
    """Choose the contact model, note how deep it reaches, and lay out its nodes if it has any."""
    model = scene.contact.model
    head[at.LOWEST_GAP] = GAP_LOW  # where the tables of the force law end
    if model == "auto":
        lowest, enough = rigid_limit(scene, footing)
        model = "asperity" if enough else "elastic"
        head[at.LOWEST_GAP] = lowest
    if model == "asperity":
        return np.zeros(0)
    deepest, nodes = layout or (min(deepest_gap(scene, footing), 0.0), None)
    grid = node_grid(scene, footing, head[at.FORCE], deepest, nodes)
    head[[at.NODES, at.ORDERS]] = grid.nodes, grid.orders
    head[[at.LENGTH_MIDDLE, at.LENGTH_HALF]] = grid.middle, grid.half
    head[at.LOWEST_GAP] = deepest
    return grid.body


def _with_nodes(data: Floats, motion: list[float]) -> Floats:
    """State of the motion, and the deflections of all pairs, none of which has a history yet."""
    nodes = int(data[at.NODES])
    state = np.concatenate([motion, np.zeros(nodes * int(data[at.TOTAL_SLOTS]))])
    if nodes > 0:
        for k in range(int(data[at.TOTAL_SLOTS])):
            data[int(data[at.HISTORIES] + data[at.HISTORY] * k) + at.PAIR] = math.nan
        settle_nodes(data, 0.0, state)
    return state


def _scale(data: Floats, motion: list[float]) -> Floats:
    """What an error of 1 means for each state.

    The solver's norm is a mean over all states. Factors make it that of the motion alone, however many
    nodes there are, with the nodes of one pair counting as one more state.
    """
    n, blocks = int(data[at.NODES]), int(data[at.TOTAL_SLOTS])
    share = math.sqrt(len(motion) / (len(motion) + n * blocks))
    nodes = np.full(n * blocks, share * math.sqrt(max(n, 1)))
    return np.concatenate([share * np.array(motion), nodes])


def _contact(head: Floats, scene: Scene, width: float, footprint: float, widest: float) -> list[Floats]:
    """Force scales, stretch limits, and the gaps where contact begins to count and to exist at all.

    Returns
    -------
    list of ndarray
        The loading branch of both materials together, and the force law of each; the stored energy likewise, and
        the number of asperities above a height.
    """
    fraction = scene.coating.sam_fraction
    reach = {FORCE_FLOOR: GAP_LOW, CONTACT_FORCE: GAP_LOW}
    kernel: Kernel = "plane" if head[at.NODES] > 0.0 else "line"
    loading, potential = np.zeros(8 * N_LOADING), np.zeros(8 * N_LOADING)
    tables, energies, joins = [], [], set()
    for material, (surface, share) in enumerate(
        ((scene.surface, 1.0 - fraction), (scene.coated_surface, fraction))
    ):
        tip = asperity_of(surface)
        law = law_of(scene.contact.asperity, surface)
        check_reach(law, surface.roughness)
        # a copy: numba compiles everything a second time for arrays that are read-only
        table = law_table(law, kernel).copy() if share > 0.0 else np.zeros(HEADER)
        scale = force_scale(surface.roughness, tip.hertz_factor, surface.asperity_density, width)
        force = share * scale * footprint / head[at.FORCE]
        record = at.MATERIALS + at.MATERIAL * material
        head[record + at.M_FORCE] = force
        head[record + at.M_STRETCH] = table[H_STRETCH]
        tables.append(table)
        energy = energy_table(law, kernel) if share > 0.0 else table
        energies.append(energy)
        joining = joining_energy(law) if share > 0.0 else 0.0
        head[at.ENERGIES + at.ENERGY * material + at.E_JOINING] = joining
        if joining != 0.0:
            joins.add(law.join)
        if share > 0.0:
            loading += force * table[HEADER : HEADER + loading.size]
            potential += force * energy[HEADER : HEADER + potential.size]
            for floor, gap in reach.items():
                reach[floor] = max(gap, _outermost(table, force * widest, floor))
    head[at.CUTOFF], head[at.ENGAGE] = reach[FORCE_FLOOR], reach[CONTACT_FORCE]
    if len(joins) > 1:  # one table of numbers serves both materials
        raise SceneError(
            "contact.asperity", scene.contact.asperity, "must join coated and bare asperities at one distance"
        )
    return [loading, *tables, potential, *energies, number_table(kernel, max(joins, default=0.0))]


def _outermost(table: Floats, scale: float, floor: float) -> float:
    """Widest gap at which this surface's force still exceeds `floor`, on a grid of an eighth."""
    for gap in np.arange(GAP_HIGH + table[H_STRETCH], GAP_LOW, -0.125):
        largest = max(abs(law_value(table, gap, joined)[0]) for joined in (gap, -math.inf))
        if scale * largest > floor:
            return float(gap)
    return GAP_LOW


def _assemble(
    head: Floats,
    flanks: int,
    slots: int,
    contact: list[Floats],
    errors: Floats,
    drive: Floats,
    load: Floats,
    grid: Floats,
) -> Floats:
    """Put the flat array together and note where its parts are."""
    head[at.SLOTS], head[at.TOTAL_SLOTS] = slots, flanks * slots
    head[at.ROOT_LIMIT], head[at.ROOT_SPACING] = ROOT_LIMIT, ROOT_SPACING
    if head[at.NODES] > 0.0:
        head[at.HISTORY] = history_size(int(head[at.NODES]))
    else:
        head[at.BRANCH] = max(branch_length(table) for table in contact[1:3])
        head[at.HISTORY] = at.BRANCHES + 4 * head[at.BRANCH]
    histories = np.zeros(int(head[at.HISTORY]) * flanks * slots)
    head[at.STATES] = (2 if head[at.KIND] == at.ROLLER else 4) + head[at.NODES] * head[at.TOTAL_SLOTS]
    weights, address = np.zeros(int(head[at.STATES])), np.zeros(1)
    if head[at.NODES] > 0.0:
        address[0] = service()
    parts = [head, histories, errors, drive, load, *contact, grid, weights, address]
    starts = np.cumsum([0] + [part.size for part in parts])
    head[[at.HISTORIES, at.ERROR_AT, at.DRIVE_AT, at.LOAD_AT, at.LOADING_AT]] = starts[1:6]
    for material in range(2):
        head[at.MATERIALS + at.MATERIAL * material + at.M_TABLE] = starts[6 + material]
        head[at.ENERGIES + at.ENERGY * material + at.E_TABLE] = starts[9 + material]
    head[[at.POTENTIAL_AT, at.NUMBER_AT]] = starts[[8, 11]]
    head[[at.GRID_AT, at.WEIGHTS_AT]] = starts[12:14]
    return np.concatenate(parts)


def _relief(head: Floats, phase: float) -> float:
    """Tip relief of pair 0 at the start, over sigma."""
    outside = phase - min(max(phase, 0.0), head[at.PATH])
    return float(0.5 * head[at.RELIEF] * outside**2)
