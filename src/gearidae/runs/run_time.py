"""How long a run will take, before it is run: a count of the solver's steps, and what a step costs.

A solver that keeps to its tolerance takes a number of steps for each oscillation of the contact, so that the fastest
oscillation decides. Its frequency follows from the contact's stiffness: where the teeth rest under the mean torque, and
where they are at the start; without a drive, where adhesion or the load that slows the gear down holds them. Of real
asperities, few of which touch at a time, the stiffness of a single one decides.
Measured on the shipped cases, on presets with 0 to 100 % of the monolayer, and on twenty drawn scenes the estimate is
within a factor of three; a run that sticks, flies freely, or whose teeth stop vibrating, takes fewer steps than it
says.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from gearidae.asperities.tip import asperity_of
from gearidae.laws.law import LOAD
from gearidae.laws.shafts import slowing
from gearidae.mesh.pair_contact import PairContact, asperity_stiffness
from gearidae.progress import in_words
from gearidae.runs.estimates import Rest, balanced_speed, mean_drive_torque, rest_of
from gearidae.scene import GearScene, is_long_train
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
_TRIED: Final = 8
"""Runs of a sweep whose time is estimated."""
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
    """

    steps: float
    seconds: float
    frequency: float

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
        Runs, or a sample of them; eight at most are estimated, spread over all.
    runs : int
        How many runs there are.
    workers : int or None
        Number of simultaneous runs; None for one after the other.

    Returns
    -------
    str
        Empty of trains of several meshes, whose run time is not estimated.
    """
    if any(map(is_long_train, scenes)):
        return ""
    tried, at_a_time = scenes[:: -(-len(scenes) // _TRIED)], min(workers or 1, runs)
    seconds = runs / at_a_time * sum(run_time(scene).seconds for scene in tried) / len(tried)
    if seconds < 1.0:
        return "less than a second"
    side_by_side = f" with {at_a_time} at a time" if at_a_time > 1 else ""
    return f"some {in_words(seconds)}{side_by_side}, within a factor of about three"


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
