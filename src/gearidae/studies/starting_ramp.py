"""Runs that find whether and where a gear with real asperities starts: laid together, then driven from rest.

A run begins at rest at a place drawn from its seed, with the gap at which the first asperity is about to join. A small
torque lays the flanks together until the motion has died; then the torque of the drive rises, or is there at once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gearidae.archive.dataset import reached
from gearidae.arrays import Floats
from gearidae.asperities.tip import asperity_of
from gearidae.errors import SolverError
from gearidae.laws.pairs import number_of_mesh
from gearidae.mesh.pair_contact import asperity_stiffness
from gearidae.populations.first_touch import first_touch
from gearidae.runs.estimates import effective_mass
from gearidae.runs.running import FAILS, solve_to_end, unfinished, unsolved
from gearidae.studies.specimens import POPULATION
from gearidae.studies.starting_parts import WITHOUT_FLANKS, Starting

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import GearScene

DAMPING: Final = 0.03
"""Least mesh damping of these runs, over the critical one of one asperity without load."""
PACE: Final = 0.005
"""Rise of the torque, over the scale of the starting torques, in the time of a pitch at that torque."""
_PILOT_PACE: Final = 0.02
"""Rise of the torque of a pilot, over each of its torques, in the time of a pitch."""
_PILOT_TORQUE: Final = 1e-5
"""Torque with which a pilot begins, over that of the smallest pull-off load at the pinion's base circle."""
_OCTAVES: Final = 30
"""Times that a pilot doubles its torque."""
_LAYING: Final = 1e-3
"""Torque that lays the flanks together, over the scale of the starting torques."""
_SETTLING: Final = 100.0
"""Time for that, over the time of a pitch at the scale: the speed has fallen to some 0.4 % of the one of that pitch."""
_HIGHEST: Final = 8.0
"""Where the ramp ends, over the scale."""
_PATIENCE: Final = 50.0
"""Time that a constant torque gets for a pitch, over the time without adhesion."""
_SAMPLES: Final = 20_001
_AT_REST: Final = 0.01
"""Speed of a gear at rest at most, over the largest of its first pitch."""

_TIGHTER: Final = (1.0, 0.1, 0.01)
"""Tolerances to try, over the scene's: creeping over the end of a flank, where the force jumps, may need one."""
_TIGHTEST: Final = 1e-12

RESTS = "rests"
"""Word of a run in which the gear has not turned a pitch."""
Knots = list[tuple[float, float]]


class Pitch(NamedTuple):
    """What it takes to turn the gear by one pitch.

    Attributes
    ----------
    angle : float
        One pitch of the gear [rad].
    inertia : float
        Of both gears, at the gear [kg m^2].
    ratio : float
        R2 over R1.
    dry : float
        Torque on the pinion that dry resistance and joints take without friction of the flanks [N m].
    viscous, drag : float
        Drags of the load [N m s, N m s^2].
    """

    angle: float
    inertia: float
    ratio: float
    dry: float
    viscous: float
    drag: float

    def time(self, torque: float) -> float:
        """Time of one pitch from rest, without adhesion, at a torque beyond the dry resistance [s]."""
        return math.sqrt(2.0 * self.angle * self.inertia / (torque * self.ratio))


def pitch_of(scene: GearScene) -> Pitch:
    """Return the pitch of a scene with gears."""
    gears, geometry = scene.gears, scene.geometry
    ratio = geometry.base_radius_gear / geometry.base_radius_pinion
    inertia = gears.gear_inertia + gears.pinion_inertia * ratio**2
    dry = Starting(scene, WITHOUT_FLANKS).torque()
    return Pitch(2.0 * math.pi / gears.gear_teeth, inertia, ratio, dry, scene.load.viscous, scene.load.drag)


def least_damping(scene: GearScene) -> float:
    """Mesh damping of the runs: the scene's own, or `DAMPING` of the critical one if that is more [N s/m].

    The stiffness is `asperity_stiffness`.
    """
    critical = 2.0 * math.sqrt(asperity_stiffness(scene) * effective_mass(scene))
    return max(number_of_mesh(scene, "damping"), DAMPING * critical)


def seated(scene: GearScene, seeds: Mapping[str, int]) -> GearScene:
    """Scene of a gear at rest, about to touch, at the place that its ``contact.seed`` draws."""
    seed = seeds[POPULATION]
    at = scene.replace(
        {
            **seeds,
            "initial.mesh_phase": phase_of_seed(scene, seed),
            "initial.gear_speed": 0.0,
            "mesh.damping": least_damping(scene),
            "run.stop": f"turns {1.0 / scene.gears.gear_teeth!r}",
            "run.asperity_events": False,
            "run.balance": False,
            "run.exposures": 0,
            "run.checkpoints": [],
        }
    )
    return at.replace({"initial.gap": first_touch(at)})


def phase_of_seed(scene: GearScene, seed: int) -> float:
    """Place at which a gear of a seed starts, in pitches of the pinion."""
    return float(np.random.default_rng([seed, 99]).random() * scene.gears.pinion_teeth)


def probe(at: GearScene) -> GearScene:
    """Add a torque that doubles again and again to a scene from `seated`: it finds the scale of its starting torque."""
    pitch, surfaces = pitch_of(at), [material.surface for material in at.materials() if material.share > 0.0]
    tips = [asperity_of(surface) for surface in surfaces]
    pulls = [tip.pull_off for tip in tips if tip.pull_off > 0.0]
    force = min(pulls, default=tips[0].hertz_factor * at.surface.roughness**1.5)
    torque = _PILOT_TORQUE * force * at.geometry.base_radius_pinion
    knots = _laying(pitch, torque, pitch.time(torque))
    for _ in range(_OCTAVES):
        time = knots[-1][0] + pitch.time(torque) / _PILOT_PACE
        torque *= 2.0
        knots.append((time, pitch.dry + torque))
    return _driven(at, knots, 2)


def ramp_rate(pitch: Pitch, scale: float, halvings: int) -> float:
    """Rise of the torque [N m/s] for starting torques of a scale [N m] beyond the dry resistance."""
    return PACE * scale / pitch.time(scale) / 2.0**halvings


def ramp_end(pitch: Pitch, scale: float) -> float:
    """Torque at which the ramp ends [N m]."""
    return pitch.dry + _HIGHEST * scale


def ramp(at: GearScene, scale: float, halvings: int) -> GearScene:
    """Add a torque that rises linearly to a scene from `seated`."""
    return _driven(at, _rising(pitch_of(at), scale, halvings), _SAMPLES)


def ramp_time(pitch: Pitch, scale: float, halvings: int, torques: Floats) -> Floats:
    """Times at which the torque of a `ramp` reaches given ones [s]; of those beyond it the time of its end."""
    times, rising = np.array(_rising(pitch, scale, halvings)[1:]).T
    return np.asarray(np.interp(torques, rising, times))


def _rising(pitch: Pitch, scale: float, halvings: int) -> Knots:
    knots = _laying(pitch, _LAYING * scale, _SETTLING * pitch.time(scale))
    time, torque = knots[-1]
    end = ramp_end(pitch, scale)
    return [*knots, (time + (end - torque) / ramp_rate(pitch, scale, halvings), end)]


def constant(at: GearScene, scale: float, torque: float) -> GearScene:
    """Add a torque that is there at once, after the flanks have been laid together, to a scene from `seated`."""
    pitch = pitch_of(at)
    beyond = torque - pitch.dry
    time = _SETTLING * pitch.time(scale)
    knots = [(0.0, small := min(_LAYING * scale, 0.1 * beyond)), (time, small)]
    knots.append((time + 1e-3 * pitch.time(beyond), torque))
    knots.append((time + _PATIENCE * pitch.time(beyond), torque))
    return _driven(at, knots, 2)


def run_from_rest(at: GearScene, backend: str) -> tuple[Solution, str]:
    """Run a scene of this module.

    Returns
    -------
    Solution, str
        Without samples, and the torque [N m] at the last moment of rest before the gear had turned one pitch, as text;
        without many samples, the torque at which it had. `RESTS` if it has not turned, `FAILS` and a message if the
        run could not be finished: one gear does not end a study of many.
    """
    for factor in _TIGHTER:
        solution = solve_to_end(at.replace({"run.rtol": max(factor * at.run.rtol, _TIGHTEST)}), backend)
        if solution.status == "finished":
            break
    if solution.status != "finished":
        return solution, f"{FAILS}{unfinished(solution, f'the run of seed {at.contact.seed}')}"
    times, torques = np.array(list(at.drive.schedule)).T
    speed, angle, end = solution.samples["gear_speed"], solution.samples["gear_angle"], reached(solution)
    word = RESTS
    if end < at.run.duration and angle[-1] >= angle[0]:
        if speed.size > 2:
            end = float(solution.time[np.flatnonzero(speed <= _AT_REST * speed.max())[-1]])
        word = repr(float(np.interp(end, times, torques)))
    none = unsolved("", "")
    return replace(solution, time=none.time, samples=none.samples, events=none.events), word


def nothing_followed(what: str, last: str) -> SolverError:
    """Error of a study of which no run could be finished, with the message of the last."""
    return SolverError(
        f"no {what} could be followed; the last one: {last}",
        time=0.0,
        state={},
        last_event="none",
        advice="tighten run.rtol, or reduce the torque",
    )


def _laying(pitch: Pitch, torque: float, time: float) -> Knots:
    """Knots that lay the flanks together, and take up the dry resistance in as much time again."""
    knots = [(0.0, torque), (time, torque)]
    return knots if pitch.dry == 0.0 else [*knots, (2.0 * time, pitch.dry + torque)]


def _driven(at: GearScene, knots: Knots, samples: int) -> GearScene:
    return at.replace(
        {"drive": {"torque": 0.0, "schedule": knots}, "run.duration": knots[-1][0], "run.samples": samples}
    )
