"""Gears that rub, as their equations stand: Coulomb's set-valued law, Gauss's principle at rest, located events.

The slow twin of the engine's friction: SI units, the two angles as coordinates, DOP853, no regularisation. What slips
feels its limit; what rests is decided by the accelerations of least constraint. The contacts are in
`reference.rubbing_contacts`.

Each pair of teeth, the dry resistance with the gear's hub, and the pinion's hub is an element with a row J: its sliding
velocity is J . (w1, w2), its friction f acts with the generalised force -f J, and abs(f) <= limit.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

_RESTS = 1e-11
"""Sliding velocities below this are zero [m/s]; rounding leaves 1e-14, and a flip passes in 1e-15 s."""
_RUBS = 1e-15
"""Friction with a limit up to this is none, and has no direction [N]; one that begins has twice this."""


def least_constraint(inertia, force, rows, drift, limits):
    """Accelerations of two bodies with elements at rest: Gauss's principle, all candidates tried.

    Minimises ``sum I (a - Q/I)^2 / 2 + sum l abs(J . a + J' . w)``, which is strictly convex. Its minimum is where
    every element slips (one candidate for each choice of signs), one sticks, or two stick.

    Parameters
    ----------
    inertia, force : array_like, shape(2)
    rows : array_like, shape(n, 2)
    drift, limits : array_like, shape(n)

    Returns
    -------
    a : ndarray, shape(2)
    stuck : tuple of int
        Elements that stick.
    """
    inertia, free = np.asarray(inertia, float), np.asarray(force, float) / inertia
    rows, drift = np.asarray(rows, float).reshape(-1, 2), np.asarray(drift, float)
    n, candidates = len(rows), []
    for stuck in itertools.chain([()], ((k,) for k in range(n)), itertools.combinations(range(n), 2)):
        others = [k for k in range(n) if k not in stuck]
        held = rows[list(stuck)]
        if len(stuck) == 2:
            if abs(np.linalg.det(held)) > 1e-12 * np.prod(np.linalg.norm(held, axis=1)):
                candidates.append((np.linalg.solve(held, -drift[list(stuck)]), stuck))
            continue
        for signs in itertools.product((-1.0, 1.0), repeat=len(others)):
            a = free - (np.array(signs) * limits[others]) @ rows[others] / inertia
            if stuck:
                row, k = held[0], stuck[0]
                a = a - (row @ a + drift[k]) / (row**2 @ (1.0 / inertia)) * row / inertia
            candidates.append((a, stuck))
    return min(candidates, key=lambda candidate: constraint(inertia, free, rows, drift, limits, candidate[0]))


def constraint(inertia, free, rows, drift, limits, a):
    """What `least_constraint` minimises."""
    return 0.5 * inertia @ (a - free) ** 2 + limits @ np.abs(rows @ a + drift)


@dataclass
class Touch:
    """A pair that touches: flank (+1 drive, -1 coast) and number, force, force along the path, friction limit, arms."""

    key: tuple
    load: float
    along: float
    limit: float
    row: np.ndarray
    drift: float  # J' over w2 (w1 + w2)

    @property
    def side(self):
        return self.key[0]


class RubbingGears:
    """Equations of motion of a scene whose flanks, hubs and dry resistance rub.

    Parameters
    ----------
    scene : Scene
        Constant coating; torques of constants and harmonics.
    law : MeanLaw or ListedAsperities
    friction : dict
        ``hub``, ``pinion_hub``, ``gear_hub``: coefficient and radii of the hubs [m]; none by default.
    """

    def __init__(self, scene, law, friction=None):
        self.scene, self.law, self.g = scene, law, scene.geometry
        hubs = {"hub": 0.0, "pinion_hub": 0.0, "gear_hub": 0.0} | (friction or {})
        self.hub_arms = hubs["hub"] * hubs["pinion_hub"], hubs["hub"] * hubs["gear_hub"]
        self.inertia = np.array([scene.gears.pinion_inertia, scene.gears.gear_inertia])
        self.r1, self.r2 = self.g.base_radius_pinion, self.g.base_radius_gear
        self.total = self.g.tangent_pinion + self.g.tangent_gear
        self.first = self.g.tangent_pinion - self.g.approach
        start = scene.initial
        pitch = self.g.base_pitch
        phase = start.mesh_phase * pitch
        u = 0.5 * scene.mesh.backlash - start.gap
        self.t, self.y = 0.0, np.array([u, 0.0, phase / self.r2, start.gear_speed, 0.0, 0.0])
        self.known, self.signs, self.stuck, self.flips, self.sticks, self.stick_time = (
            set(),
            {},
            (),
            0,
            0,
            0.0,
        )
        self._at = None

    # -- geometry and forces -----------------------------------------------------------------------------------------

    def places(self, angle):
        """(side, pair, xi) of every pair whose teeth may touch."""
        pitch, length, reach = self.g.base_pitch, self.g.path_length, 1.5e-6
        for side in (1, -1):
            # xi = along - i pitch (drive), 2 approach - (along - (i + 1/2) pitch) (coast)
            along = self.r2 * angle
            for i in range(
                math.floor((along - length - reach) / pitch) - 2, math.ceil((along + reach) / pitch) + 3
            ):
                xi = along - i * pitch if side > 0 else 2.0 * self.g.approach - along + (i + 0.5) * pitch
                if -reach < xi < length + reach:
                    yield side, i, xi

    def touches(self, u, angle):
        """All pairs that touch at a state."""
        touches = []
        for side, i, xi in self.places(angle):
            inside = min(max(xi, 0.0), self.g.path_length)
            outside = xi - inside
            relief = self.scene.mesh.tip_relief_radius
            gap = 0.5 * self.scene.mesh.backlash - side * u + outside**2 / (2.0 * relief)
            a1 = self.first + inside
            a2 = self.total - a1
            load, limit, along = self.law.touching((side, i), gap, a1, a2, outside == 0.0, self.r1)
            if load == 0.0 and limit == 0.0:
                continue
            slope = load * outside / relief + along
            drift = side * self.r2 if outside == 0.0 else 0.0
            touches.append(Touch((side, i), load, slope, limit, np.array([a1, -a2]), drift))
        return touches

    def speeds(self, y):
        return np.array([(y[1] + self.r2 * y[3]) / self.r1, y[3]])

    def evaluate(self, t, y):
        """Everything at a state; the last one is kept, since roots and rates ask for the same."""
        key = (t, y.tobytes())
        if self._at is not None and self._at[0] == key:
            return self._at[1]
        w, pairs = self.speeds(y), self.touches(y[0], y[2])
        force = sum(p.side * p.load for p in pairs)
        along = sum(p.side * p.along for p in pairs)
        scene = self.scene
        drive = self.drive(t)
        mesh = force + scene.mesh.damping * y[1]
        q = np.array(
            [
                drive - self.r1 * mesh,
                self.r2 * (mesh + along) - scene.load.drag * w[1] * abs(w[1]) - scene.load.viscous * w[1],
            ]
        )
        state = {"w": w, "pairs": pairs, "q": q, "drive": drive, "force": force}
        self.resolve(state)
        self._at = key, state
        return state

    def elements(self, pairs, friction):
        """Rows, drifts and limits of the pairs, the gear's dry resistance and the pinion's hub."""
        dry = self.scene.load.torque
        normal = self.bearing(pairs, friction) if any(self.hub_arms) else 0.0
        keys, rows, drifts, limits = [], [], [], []
        for p in pairs:
            if p.key in self.known and p.limit > 0.0:
                keys.append(p.key)
                rows.append(p.row)
                drifts.append(p.drift)
                limits.append(p.limit)
        for key, row, limit in (
            ("gear", (0.0, 1.0), dry + self.hub_arms[1] * normal),
            ("pinion", (1.0, 0.0), self.hub_arms[0] * normal),
        ):
            if limit > 0.0:
                keys.append(key)
                rows.append(np.array(row))
                drifts.append(0.0)
                limits.append(limit)
        return keys, np.array(rows).reshape(-1, 2), np.array(drifts), np.array(limits)

    def bearing(self, pairs, friction):
        """Force that a hub carries: the vector sum of the forces of both flanks."""
        w = {s: sum(p.load for p in pairs if p.side == s) for s in (1, -1)}
        f = {s: sum(friction.get(p.key, 0.0) for p in pairs if p.side == s) for s in (1, -1)}
        angle = math.atan(self.g.tangent_pinion / self.r1)
        square = w[1] ** 2 + f[1] ** 2 + w[-1] ** 2 + f[-1] ** 2
        square -= 2.0 * math.cos(2.0 * angle) * (w[1] * w[-1] + f[1] * f[-1])
        square += 2.0 * math.sin(2.0 * angle) * (w[1] * f[-1] - f[1] * w[-1])
        return math.sqrt(max(square, 0.0))

    def resolve(self, state):
        """Friction of every element and the accelerations, in the present modes."""
        friction, pairs = {}, state["pairs"]
        for _ in range(60 if any(self.hub_arms) and self.stuck else 2 if any(self.hub_arms) else 1):
            keys, rows, drifts, limits = self.elements(pairs, friction)
            drift = drifts * state["w"][1] * state["w"].sum()
            stuck = [k for k, key in enumerate(keys) if key in self.stuck]
            f = np.array(
                [
                    0.0
                    if key in self.stuck
                    else self.signs.get(key, math.copysign(1.0, row @ state["w"])) * limit
                    for key, row, limit in zip(keys, rows, limits, strict=True)
                ]
            )
            a = (state["q"] - f @ rows) / self.inertia
            if len(stuck) == 1:
                row = rows[stuck[0]]
                f[stuck[0]] = (row @ a + drift[stuck[0]]) / (row**2 @ (1.0 / self.inertia))
                a = a - f[stuck[0]] * row / self.inertia
            elif len(stuck) > 1:
                a = np.zeros(2)
            friction = dict(zip(keys, f, strict=True))
        state |= {"keys": keys, "rows": rows, "drift": drift, "limits": limits, "f": f, "a": a}

    # -- modes -------------------------------------------------------------------------------------------------------

    def decide(self):
        """Signs of what slips, and what of the elements at rest sticks."""
        self._at, self.stuck = None, ()
        w = self.speeds(self.y)
        self.known = {p.key for p in self.touches(self.y[0], self.y[2]) if p.limit > 1.5 * _RUBS}
        self.signs, friction = {}, {}
        state = self.evaluate(self.t, self.y)
        for _ in range(60 if any(self.hub_arms) else 1):  # a hub's limit depends on the frictions
            keys, rows, drifts, limits = self.elements(state["pairs"], friction)
            v = rows @ w
            scale = np.array([self.r2 if isinstance(k, str) else 1.0 for k in keys])
            here = np.flatnonzero(np.abs(v) * scale < _RESTS)
            f = np.sign(v) * limits
            f[here] = 0.0
            q, drift = state["q"] - f @ rows, drifts * w[1] * w.sum()
            a, stuck = least_constraint(self.inertia, q, rows[here], drift[here], limits[here])
            stuck = here[list(stuck)]
            others = np.setdiff1d(here, stuck)
            f[others] = np.sign(rows[others] @ a + drift[others]) * limits[others]
            left = state["q"] - f @ rows - self.inertia * a
            f[stuck] = np.linalg.lstsq(rows[stuck].T, left, rcond=None)[0] if stuck.size else 0.0
            friction = dict(zip(keys, f, strict=True))
        way = np.where(np.isin(np.arange(len(keys)), here), rows @ a + drift, v)
        self.signs = {k: math.copysign(1.0, slip) for k, slip in zip(keys, way, strict=True)}
        if stuck.size == 2:
            self.stuck = tuple(keys[k] for k in here)  # the train rests: all that could slip
            self.y[1] = self.y[3] = 0.0
        elif stuck.size:
            self.stuck = (keys[stuck[0]],)
            self.sticks += 1
            self.project(rows[stuck[0]])
        self._at = None

    def rest(self, time):
        """Stay at rest until the drive's torque leaves the zonotope of the frictions, or to a time."""
        state = self.evaluate(self.t, self.y)
        rows, limits, q = state["rows"], state["limits"], state["q"]
        across = np.column_stack([-rows[:, 1], rows[:, 0]])
        bounds, first = np.abs(across @ rows.T) @ limits, self.drive(self.t)

        def margin(t):
            now = np.array([q[0] + self.drive(t) - first, q[1]])
            return (1.0 - np.abs(across @ now) / bounds).min()

        fastest = max((h.frequency for h in self.scene.drive.harmonic if h.amplitude != 0.0), default=0.0)
        grid = np.linspace(self.t, time, 2 + int(400e-6 * fastest * (time - self.t)))
        leaves = np.flatnonzero([margin(t) < 0.0 for t in grid])
        if not leaves.size:
            self.t = time
            return
        k = max(int(leaves[0]), 1)
        self.t = brentq(margin, grid[k - 1], grid[k], xtol=1e-15) + 1e-10
        self.decide()

    def drive(self, t):
        return self.scene.drive.torque + sum(
            h.amplitude * math.cos(2e-6 * math.pi * h.frequency * t + h.phase)
            for h in self.scene.drive.harmonic
        )

    def release(self, key):
        """Let an element slip that has stuck up to its limit."""
        state = self.evaluate(self.t, self.y)
        if key in state["keys"]:
            self.signs[key] = math.copysign(1.0, state["f"][state["keys"].index(key)])
        self.stuck, self._at = (), None

    def project(self, row):
        """Take the small sliding velocity of an element that sticks away, from the rate of u (or the gear's speed)."""
        # J . w = (row0 / R1) u' + (row0 R2 / R1 + row1) w2
        if row[0] != 0.0:
            self.y[1] = -(self.r2 + row[1] * self.r1 / row[0]) * self.y[3]
        else:
            self.y[3] = 0.0

    # -- integration -------------------------------------------------------------------------------------------------

    def rates(self, t, y):
        """Derivatives; the integrator counts in microseconds, since scipy locates a root to 1e-15 of its unit."""
        state = self.evaluate(t, y)
        a, w = state["a"], state["w"]
        rubbed = state["f"] @ (state["rows"] @ w) if len(state["keys"]) else 0.0
        return 1e-6 * np.array(
            [y[1], self.r1 * a[0] - self.r2 * a[1], w[1], a[1], rubbed, state["drive"] * w[0]]
        )

    def roots(self):
        """Root functions: flips, the ends of sticking, pairs that cross an end of the path, and the law's own."""
        state = self.evaluate(self.t, self.y)
        functions = []

        def add(value, direction=-1.0):
            value.terminal, value.direction = True, direction
            functions.append(value)

        for key in state["keys"]:
            if key in self.stuck:
                if len(self.stuck) == 1:
                    add(lambda t, y, key=key: self.margin(t, y, key))
            else:
                add(lambda t, y, key=key: self.sliding(t, y, key))
        for side, i, xi in self.places(self.y[2]):
            for end in (0.0, self.g.path_length):
                if abs(xi - end) > 1e-14:
                    add(lambda t, y, s=side, i=i, end=end: self.end(y, s, i, end), 0.0)
        centre = self.y[2]
        add(lambda t, y: (0.5 * self.g.base_pitch - self.r2 * abs(y[2] - centre)) / self.g.base_pitch)
        for side, i, _ in self.places(self.y[2]):
            add(lambda t, y, key=(side, i): self.rubs(t, y, key))
        for value in self.law.roots(self):
            add(value)
        return functions

    def sliding(self, t, y, key):
        state = self.evaluate(t, y)
        if key not in state["keys"]:
            return 1.0
        v = state["rows"][state["keys"].index(key)] @ state["w"]
        v = self.signs.get(key, math.copysign(1.0, v)) * v * (self.r2 if isinstance(key, str) else 1.0)
        return v + 0.1 * _RESTS  # one that has just begun to slip is above its root

    def margin(self, t, y, key):
        state = self.evaluate(t, y)
        if key not in state["keys"]:
            return -1.0
        k = state["keys"].index(key)
        return 1.0 - abs(state["f"][k]) / state["limits"][k]

    def rubs(self, t, y, key):
        limit = next((p.limit for p in self.evaluate(t, y)["pairs"] if p.key == key), 0.0)
        return (limit - _RUBS if key in self.known else 2.0 * _RUBS - limit) / 1e-9

    def end(self, y, side, i, end):
        along, pitch = self.r2 * y[2], self.g.base_pitch
        xi = along - i * pitch if side > 0 else 2.0 * self.g.approach - along + (i + 0.5) * pitch
        return (xi - end) / pitch

    def run(self, times, rtol=1e-10):
        """State (u, u', angle, speed, friction work, drive work) at the given times, shape (6, n)."""
        sigma, speed = self.scene.surface.roughness, max(abs(self.y[3]), 1e-3)
        atol = rtol * np.array([sigma, 1e-2 * speed * self.r2, sigma / self.r2, 1e-2 * speed, 1e-16, 1e-14])
        times, out = 1e6 * np.asarray(times), np.full((6, len(times)), np.nan)
        self.law.begin(self)
        self.decide()
        for k, time in enumerate(times):
            while self.t < time:
                self.advance(time, rtol, atol)
            out[:, k] = self.y
        return out

    def advance(self, time, rtol, atol):
        """Integrate to the next event, or to a time."""
        if len(self.stuck) > 1:
            self.rest(time)
            return
        leg = solve_ivp(
            self.rates,
            (self.t, time),
            self.y,
            "DOP853",
            rtol=rtol,
            atol=atol,
            events=self.roots(),
            max_step=0.02,  # a tenth of a contact's period: no two roots in a step
        )
        self.stick_time += (leg.t[-1] - self.t) * bool(self.stuck)
        before = dict(self.signs)
        self.t, self.y = leg.t[-1], leg.y[:, -1].copy()
        if leg.status == 1:
            if len(self.stuck) == 1 and self.margin(self.t, self.y, self.stuck[0]) < 1e-9:
                self.release(self.stuck[0])
                return
            self.law.pass_events(self)
            self.decide()
            self.flips += sum(self.signs[k] != s for k, s in before.items() if k in self.signs)
