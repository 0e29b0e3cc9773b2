"""How long a run will take, before it is run: a count of the solver's steps, and what a step costs.

A solver that keeps to its tolerance takes a number of steps for each oscillation of the contact, so that the fastest
oscillation decides. Its frequency follows from the contact's stiffness: where the teeth rest under the mean torque, and
where they are at the start; without a drive, where adhesion or the load that slows the gear down holds them. Of real
asperities, few of which touch at a time, the stiffness of a single one decides.
Measured on the shipped cases, on presets with 0 to 100 % of the monolayer, and on twenty drawn scenes the estimate is
within a factor of three; a run that sticks, flies freely, or whose teeth stop vibrating, takes fewer steps than it
says.

Of a train its highest natural frequency decides, about the gaps under the mean torques or those of the start. Its
bodies are rigid, and its solver takes fewer and longer steps than that of a pair. Measured on ten drawn trains of two
to four meshes over 2 ms the estimate is 0.5 to 1.8 times the steps; teeth that come apart and strike under a
microengine, as in the shipped case, take four times as many as it says.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.asperities.tip import asperity_of
from gearidae.errors import SolverError
from gearidae.laws.law import LOAD
from gearidae.laws.shafts import slowing
from gearidae.mesh.pair_contact import PairContact, asperity_stiffness, pair_contact
from gearidae.mesh.train_modes import frequencies_at
from gearidae.progress import in_words
from gearidae.runs.estimates import Rest, balanced_speed, mean_drive_torque, rest_of
from gearidae.runs.train_statics import mesh_forces
from gearidae.scene import GearScene, TrainScene, is_long_train, require_gears
from gearidae.scene.combinations import may_deflect
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.joints import has_joint_friction

if TYPE_CHECKING:
    from gearidae.scene import Scene

_STEPS_A_PERIOD: Final = 15.0
"""Steps for each oscillation on approaching flanks at a relative tolerance of 1e-6, turning points included."""
_STEPS_A_BOUNCE: Final = 2.5
"""Steps for each oscillation of gears that start pressed together and fly to and fro: 1 to 6 in drawn scenes."""
_STEPS_OF_ONE: Final = 30.0
"""Steps for each oscillation of gears on real asperities: 16 to 40 in drawn scenes."""
_STEPS_A_PASSAGE: Final = 50.0
"""Steps to bring a pair into mesh and out of it."""
_STEPS_AN_IMPACT: Final = 50.0
"""Steps of one impact with elastic bodies."""
_TRAIN_STEPS_A_PERIOD: Final = 6.0
"""Steps for each oscillation of a train at its highest natural frequency, mesh exits included: 3 to 11 in drawn."""
_EVENTS_A_STEP: Final = 0.12
"""Events for each step that is estimated: 0.08 to 0.15 in the shipped cases, 0.03 where the gears rest for long."""
_WEIGHTLESS: Final = 1e-20
"""Force of teeth that adhesion alone holds together: less than any that a scene has, and more than none [N]."""
_GAP_ERROR: Final = 0.02
"""Error of the gap at rest, in roughnesses: 5 % of the frequency."""
_ORDER: Final = 0.125
"""Steps grow as the tolerance to the power of minus this."""
_RIGID_STEP, _ELASTIC_STEP, _POPULATION_STEP, _FRICTION_STEP = 1e-6, 20e-6, 3e-6, 4e-6
"""Wall time of a step without and with elastic bodies, with real asperities, and with friction [s]."""
_MESH_STEP, _TRAIN_SETUP = 9e-6, 0.02
"""Wall time of a step of a train for each of its meshes, and of a run beside its steps [s]."""
_TRIED, _TRAINS_TRIED = 8, 2
"""Runs of a sweep whose time is estimated; the forces of a loop take a tenth of a second."""
_SETUP, _ELASTIC_SETUP = 0.04, 0.1
"""Wall time of a run beside its steps: tables of the force law, the verdict [s]; with elastic bodies."""


@dataclass(frozen=True, slots=True)
class RunTime:
    """What a run is expected to take.

    Attributes
    ----------
    steps : float
        Steps of the solver.
    seconds : float
        Wall time on one core [s], without compiling, setting up included.
    frequency : float
        Frequency of the oscillation that decides [Hz].
    within : str
        Factor within which steps and time lie, as a word.
    """

    steps: float
    seconds: float
    frequency: float
    within: str = "three"

    @property
    def events(self) -> float:
        """Number of events, most of them turning points; as uncertain as the steps."""
        return _EVENTS_A_STEP * self.steps


def run_time(scene: Scene) -> RunTime:
    """Estimate how long a scene takes to simulate.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    RunTime
    """
    if is_long_train(scene):
        return _train_time(scene)
    if isinstance(scene, TrainScene):
        scene = require_gears(scene)
    rest = rest_of(scene, _GAP_ERROR)
    steps, oscillations = _STEPS_AN_IMPACT, [_rate(rest.contact, rest.gap, rest.mass)]
    if isinstance(scene, GearScene):
        # a start within the flanks' reach is an oscillation too, and nothing but adhesion takes its energy away
        gap = min(scene.initial.gap, scene.mesh.backlash - scene.initial.gap)
        rate, frequency, load = _rate(rest.contact, gap, rest.mass)
        has_play = scene.mesh.backlash > scene.surface.roughness
        bounces = has_play and load > rest.load and float(rest.contact.force(gap)) > 0.0
        if not rest.load > 0.0:
            oscillations.append(_undriven(scene, rest))
        oscillations.append((rate * _STEPS_A_BOUNCE / _STEPS_A_PERIOD if bounces else rate, frequency, load))
        steps = _STEPS_A_PASSAGE * _passages(scene)
    rate, frequency, load = max(oscillations)
    cost, setup = _RIGID_STEP, _SETUP
    if has_flank_friction(scene) or has_joint_friction(scene):
        cost = _FRICTION_STEP
    if _is_elastic(scene, rest.contact, load):
        cost, setup = max(cost, _ELASTIC_STEP), _ELASTIC_SETUP
    if scene.contact.is_discrete:
        stiffness = asperity_stiffness(scene)
        frequency = max(
            math.sqrt(stiffness / rest.mass) / (2.0 * math.pi),
            *(oscillation[1] for oscillation in oscillations),
        )
        rate, cost = _STEPS_OF_ONE * frequency, max(cost, _POPULATION_STEP)
    steps = (steps + rate * scene.run.duration) * (scene.run.rtol / 1e-6) ** -_ORDER
    return RunTime(steps, setup + steps * cost, frequency)


def time_in_words(scenes: Sequence[Scene], runs: int, workers: int | None) -> str:
    """Say how long runs will take, side by side on some cores: ``"some 3 min with 2 at a time, ..."``.

    Parameters
    ----------
    scenes : sequence of Scene
        Runs, or a sample of them; eight at most are estimated, of trains two, spread over all.
    runs : int
        How many runs there are.
    workers : int or None
        Number of simultaneous runs; None for one after the other.

    Returns
    -------
    str
        Empty of trains with a loop that shares its load in a way that is not found.
    """
    most = _TRAINS_TRIED if any(map(is_long_train, scenes)) else _TRIED
    tried, at_a_time = scenes[:: -(-len(scenes) // most)], min(workers or 1, runs)
    try:
        expected = [run_time(scene) for scene in tried]
    except SolverError:  # forces of a loop that are not found; the runs themselves do not need them
        return ""
    seconds = runs / at_a_time * sum(each.seconds for each in expected) / len(tried)
    if seconds < 1.0:
        return "less than a second"
    side_by_side = f" with {at_a_time} at a time" if at_a_time > 1 else ""
    return f"some {in_words(seconds)}{side_by_side}, within a factor of about {expected[0].within}"


def _train_time(scene: TrainScene) -> RunTime:
    train, initial = scene.train, scene.initial
    at_rest, at_start = np.zeros(len(train.meshes)), np.zeros(len(train.meshes))
    for k, (mesh, force) in enumerate(zip(train.meshes, mesh_forces(scene), strict=True)):
        contact = pair_contact(scene.pair(mesh.name))
        # what nothing presses together adhesion holds, and what drives backwards presses the coast flanks
        gap = contact.resting_gap(max(abs(float(force)), _WEIGHTLESS), _GAP_ERROR)
        at_rest[k] = (
            0.0 if math.isnan(gap) else max(contact.joined_stiffness(gap), contact.stiffness(gap), 0.0)
        )
        gap = min(initial.gap, mesh.mesh.backlash - initial.gap)
        at_start[k] = max(contact.stiffness(gap), 0.0)
    frequency = max(frequencies_at(train, at_rest) + frequencies_at(train, at_start), default=0.0)
    steps = _TRAIN_STEPS_A_PERIOD * frequency * scene.run.duration + _STEPS_A_PASSAGE * len(train.meshes)
    steps *= (scene.run.rtol / 1e-6) ** -_ORDER
    return RunTime(steps, _TRAIN_SETUP + steps * len(train.meshes) * _MESH_STEP, frequency, "five")


def _rate(contact: PairContact, gap: float, mass: float) -> tuple[float, float, float]:
    """Steps per second of simulated time, frequency [Hz] and force [N] of an oscillation about a gap."""
    if math.isnan(gap):
        return 0.0, 0.0, 0.0
    stiffness = contact.stiffness(gap)
    if not stiffness > 0.0:
        return 0.0, 0.0, 0.0
    # Flanks that have joined are stiffer when they part. The steps go with that stiffness itself and not with its
    # root: worn flanks are pressed ever deeper by their impacts, and ring faster than about the resting gap.
    joined = max(contact.joined_stiffness(gap), stiffness)
    frequency = math.sqrt(joined / mass) / (2.0 * math.pi)
    return (
        _STEPS_A_PERIOD * frequency * math.sqrt(joined / stiffness),
        frequency,
        abs(float(contact.force(gap))),
    )


def _undriven(scene: GearScene, rest: Rest) -> tuple[float, float, float]:
    """Oscillation of gears that nothing drives: the load slows the gear down, and the pinion follows it."""
    gears, geometry = scene.gears, scene.geometry
    linear, quadratic = slowing(scene, LOAD)
    speed = abs(scene.initial.gear_speed)
    force = speed * (linear + quadratic * speed) / geometry.base_radius_gear
    force *= rest.mass / (
        gears.gear_inertia / geometry.base_radius_gear**2
    )  # the pinion's share of what moves
    return _rate(rest.contact, rest.contact.resting_gap(max(force, _WEIGHTLESS), _GAP_ERROR), rest.mass)


def _passages(scene: GearScene) -> float:
    """Teeth that pass, and periods of the harmonic torques."""
    speed = balanced_speed(scene, mean_drive_torque(scene))
    speed = max(abs(scene.initial.gear_speed), speed if math.isfinite(speed) else 0.0)
    harmonics = (*scene.drive.harmonic, *scene.load.harmonic)
    fastest = max(
        (harmonic.frequency or 0.0 for harmonic in harmonics if harmonic.amplitude != 0.0), default=0.0
    )
    return scene.run.duration * (speed * scene.gears.gear_teeth / (2.0 * math.pi) + fastest)


def _is_elastic(scene: Scene, contact: PairContact, load: float) -> bool:
    """Whether the bodies deflect, or in ``auto`` will: by more than a fiftieth of the roughness under the load."""
    if scene.contact.bodies != "auto" or not may_deflect(scene):
        return scene.contact.bodies == "elastic"
    modulus = asperity_of(contact.surface).modulus
    deflection = (
        6.0 * load / (math.pi * modulus * contact.width)
    )  # a line load; the logarithm is about 6 here
    return deflection > 0.02 * contact.surface.roughness
