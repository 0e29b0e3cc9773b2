r"""Free motion of a train: its shafts under their torques, joined without backlash, adhesion and friction of hubs.

With the speeds :math:`\rho_i` of the shafts over that of the judged one,

.. math::

    \sum I_i \rho_i^2\, \dot w = \rho_d M_d - \rho_l M_l - \sum \rho_i (h_i + c_i \rho_i w + d_i \rho_i^2 w^2),

where dry resistances, that of the load and those of the shafts, hold up to their sum. The torques of drive and load are
those of the engine's own laws, at any time of the run.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.integrate import solve_ivp

from gearidae.arrays import Floats
from gearidae.compiled import compiled
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import DRIVE, LOAD
from gearidae.engine.observers.standing.free_gears import torque_knots
from gearidae.engine.observers.standing.torques import enter_piece, go_back
from gearidae.engine.setup.start import Start
from gearidae.engine.train.build import TrainProblem, make_train
from gearidae.engine.train.layout import TrainModel
from gearidae.laws.frictions import law_limit, resists
from gearidae.laws.shafts import acting, driving_force
from gearidae.scene.judged import judged_shaft

if TYPE_CHECKING:
    from gearidae.scene import TrainScene

_RTOL: Final = 1e-9
_LOOKS: Final = 2000
"""Times, besides knots, at which the torques on a train at rest are compared with its dry resistance."""


@compiled
def _at_shaft(
    tm: TrainModel, mesh: int, shaft: int, piece: tuple[float, float], t: float, angle: float, speed: float
) -> tuple[float, float]:
    """Torque that acts on a shaft of a mesh, and limit of the laws that resist its turning [N m]."""
    record = tm.meshes[mesh]
    m, tau = model_at(record.address), record.time_unit
    radius = record.driver_radius if shaft == DRIVE else record.driven_radius
    time, turning = t / tau, radius * speed * tau / record.length_unit
    kept = enter_piece(m, piece[0] / tau, piece[1] / tau)
    m.work.elsewhere = 1  # laws have no memory of this shaft
    force = driving_force(m, DRIVE, time, angle, turning) if shaft == DRIVE else 0.0
    if m.scene.torque[shaft].acts != 0:
        force = acting(m, shaft, time, angle, turning, force)
    limit = law_limit(m, shaft, time, angle, turning) if resists(m, shaft) else 0.0
    m.work.elsewhere = 0
    go_back(m, kept)
    unit = record.force_unit * radius
    return force * unit, limit * unit


@compiled
def torques_of(
    tm: TrainModel,
    piece: tuple[float, float],
    t: float,
    angles: tuple[float, float],
    speeds: tuple[float, float],
) -> tuple[float, float, float]:
    """Torques [N m] at a time [s] between two knots: on the shaft of the drive, on that of the load, the dry load.

    Angles [rad] and speeds [rad/s] are those of the two shafts.
    """
    train = tm.train[0]
    drive, _ = _at_shaft(tm, train.drive_mesh, DRIVE, piece, t, angles[0], speeds[0])
    load, limit = _at_shaft(tm, train.load_mesh, LOAD, piece, t, angles[1], speeds[1])
    return drive, load, limit


class FreeTrain:
    """A train under its torques and resistances alone; angles and speeds are those of its judged shaft.

    Parameters
    ----------
    scene : Scene
    start : float, optional
        Time [s] at which its run begins.
    """

    def __init__(self, scene: TrainScene, start: float = 0.0) -> None:
        train, shafts = scene.train, list(scene.shafts.values())
        judged = train.shafts[judged_shaft(scene)].ratio
        ratio = np.array([float(shaft.ratio / judged) for shaft in train.shafts])
        self.inertia = float(np.array([shaft.inertia for shaft in train.shafts]) @ ratio**2)
        self._ratios = float(ratio[train.drive]), float(ratio[train.load])
        own = {
            name: np.array([getattr(shaft, name) for shaft in shafts])
            for name in ("resistance", "viscous", "drag")
        }
        self._dry = float(own["resistance"] @ ratio)
        self._viscous, self._drag = float(own["viscous"] @ ratio**2), float(own["drag"] @ ratio**3)
        self._scene, self._start = scene, Start(start)

    @cached_property
    def _problem(self) -> TrainProblem:
        """The train at its start; most runs never ask for torques beside their own."""
        return make_train(self._scene, self._start)

    @cached_property
    def _knots(self) -> list[float]:
        """Times [s] at which torques begin another piece, in order; the last is the end of the run."""
        problem = self._problem
        units = problem.model.meshes["time_unit"]
        of_meshes = [
            np.array(torque_knots(pair.model)) * unit
            for pair, unit in zip(problem.problems, units, strict=True)
        ]
        return np.unique(np.concatenate(of_meshes)).tolist()

    def push(self, t: float, angle: float, speed: float) -> float:
        """Torque that drives the train at the judged shaft [N m], against its dry resistance."""
        return self._torques(t, angle, speed)[0]

    def dry(self, t: float, angle: float, speed: float) -> float:
        """Dry resistance of the whole train at the judged shaft [N m]."""
        return self._torques(t, angle, speed)[1]

    def dry_load(self, t: float, angle: float) -> float:
        """Dry resistance of the load at its own shaft [N m], at rest."""
        return (self.dry(t, angle, 0.0) - self._dry) / self._ratios[1]

    def _torques(self, t: float, angle: float, speed: float) -> tuple[float, float]:
        """Both."""
        driven, loaded = self._ratios
        i = bisect_right(self._knots, t)
        piece = self._knots[i - 1] if i > 0 else 0.0, self._knots[min(i, len(self._knots) - 1)]
        angles, speeds = (driven * angle, loaded * angle), (driven * speed, loaded * speed)
        push, drags, dry = torques_of(self._problem.model, piece, float(t), angles, speeds)
        drags -= (self._viscous + self._drag * abs(speed)) * speed / loaded
        return driven * push + loaded * drags, loaded * dry + self._dry

    def positions(self, begin: float, angle: float, times: Floats) -> Floats:
        """Angles of the judged shaft [rad] of a train that is at rest at a time and an angle."""
        return self.follow(begin, angle, 0.0, times)[0]

    def follow(self, begin: float, angle: float, speed: float, times: Floats) -> tuple[Floats, float]:
        """Angles of the judged shaft [rad] from a time, an angle and a speed on, and its speed at the last [rad/s]."""
        where = np.full(len(times), angle)
        now, at = begin, angle
        end = float(times[-1]) if len(times) else begin
        while now < end:
            way = self._let_go(now, at) if speed == 0.0 else math.copysign(1.0, speed)
            if way == 0.0:
                now = self._waits(now, end, at)
                where[times >= now] = at
                continue

            def rates(t: float, state: Floats, way: float = way) -> list[float]:
                turned, turning = state
                push, dry = self._torques(t, turned, turning)
                return [turning, (push - way * dry) / self.inertia]

            def stops(_: float, state: Floats, way: float = way) -> float:
                return way * float(state[1])

            stops.terminal, stops.direction = True, -1.0  # type: ignore[attr-defined]
            longest = (end - now) / 50.0
            later = times[times > now]
            solved = solve_ivp(
                rates, (now, end), [at, speed], "DOP853", later, rtol=_RTOL, atol=1e-12, max_step=longest,
                events=stops,
            )  # fmt: skip
            count = len(solved.t)
            first = len(times) - len(later)
            if count:  # it may have stopped before the first of these times
                where[first : first + count] = solved.y[0]
            if solved.status != 1:
                return where, float(solved.y[1][-1]) if count else speed
            now, at, speed = float(solved.t_events[0][0]), float(solved.y_events[0][0][0]), 0.0
            where[times >= now] = at
        return where, speed

    def onset(self, begin: float, angle: float, end: float) -> float:
        """Time at which a train begins to move that is at rest at a time and an angle, or the end."""
        return begin if self._let_go(begin, angle) != 0.0 else self._waits(begin, end, angle)

    def _let_go(self, t: float, angle: float) -> float:
        """Direction in which the torques move a train at rest; 0 if dry resistance holds it."""
        push, dry = self._torques(t, angle, 0.0)
        return math.copysign(1.0, push) if abs(push) > dry else 0.0

    def _waits(self, begin: float, end: float, angle: float) -> float:
        """Time at which a train at rest begins to move, or the end."""
        knots = [knot for knot in self._knots if begin < knot < end]
        sampled_times = np.union1d(np.linspace(begin, end, _LOOKS + 1), knots)
        for before, t in pairwise(sampled_times):
            if self._let_go(float(t), angle) != 0.0:
                low, high = float(before), float(t)
                for _ in range(50):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if self._let_go(middle, angle) else (middle, high)
                return high
        return end
