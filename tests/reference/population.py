"""Real asperities as their equations stand, one by one and in SI units: the slow twin of the compiled forces.

`population.json` holds numbers of a prototype that shares nothing with gearidae.
"""

import json
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import contact_modulus, make_tip

NUMBERS = json.loads((Path(__file__).parent / "population.json").read_text())


class Tip:
    """One asperity: load [N], energy from free surfaces [J] and the distances at which it joins and lets go [m]."""

    def __init__(self, surface, radius, law="jkr"):
        modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
        tip = make_tip(modulus, radius, 2.0 * surface.energy)
        self.law, self.factor = law_of_tip(law, tip, 1e-9), tip.hertz_factor * 1e-9**1.5
        self.join, self.detach = self.law.join * 1e-9, self.law.detach * 1e-9
        self.joining = (self.law.loss - self.law.detachment_energy) * self.factor * 1e-9
        self.letting_go = self.law.detachment_energy * self.factor * 1e-9

    def load(self, delta):
        return self.factor * self.law.load(delta / 1e-9)

    def energy(self, delta):
        return self.factor * 1e-9 * (self.law.energy(delta / 1e-9) + self.law.detachment_energy)


class Contact:
    """Arc, radii and tip relief of a pair at a place along the path of contact [m], by the equations."""

    def __init__(self, scene):
        g = scene.geometry
        self.base, self.total, self.length = (
            g.base_radius_pinion,
            g.tangent_pinion + g.tangent_gear,
            g.path_length,
        )
        self.first, self.relief = g.tangent_pinion - g.approach, scene.mesh.tip_relief_radius

    def at(self, xi):
        inside = min(max(xi, 0.0), self.length)
        r1 = self.first + inside
        r2 = self.total - r1
        radius, outside = r1 * r2 / (r1 + r2), xi - inside
        moves = float(outside == 0.0)
        return {
            "arc": r1**2 / (2.0 * self.base),
            "radius": radius,
            "arc_rate": moves * r1 / self.base,
            "radius_rate": moves * (r2 - r1) / (r1 + r2),
            "opening": outside**2 / (2.0 * self.relief),
            "slope": outside / self.relief,
        }

    def overlap(self, xi, gap, arc, height):
        """Overlap of an asperity, and its derivative along the path at fixed gap."""
        c = self.at(xi)
        x = arc - c["arc"]
        along = x * c["arc_rate"] / c["radius"] + x**2 * c["radius_rate"] / (2.0 * c["radius"] ** 2)
        return height - gap - c["opening"] - x**2 / (2.0 * c["radius"]), along


def drop(tips, places, heights, radius, mass, speed, height):
    """Drop a roller on asperities: its events (time, kind, asperity, speed), and the state after the last.

    Parameters
    ----------
    tips : list of Tip
    places, heights : sequence of float
        [m].
    radius, mass, speed, height : float
        Of the roller.
    """
    level = np.asarray(heights) - np.asarray(places) ** 2 / (
        2.0 * radius
    )  # height at which each overlap is zero
    joined, t, state, events, loss = set(), 0.0, np.array([height, -speed]), [], 0.0
    while True:
        held = frozenset(joined)

        def motion(_, y, held=held):
            return [y[1], sum(float(tips[a].load(level[a] - y[0])) for a in held) / mass]

        solved = solve_ivp(
            motion,
            (t, t + 1.0),
            state,
            "DOP853",
            rtol=1e-12,
            atol=[1e-20, 1e-15],
            events=[*(_reaches(tip, level[a], a in held) for a, tip in enumerate(tips)), _far(height)],
        )
        t, state = solved.t[-1], solved.y[:, -1]
        fallen = [a for a, times in enumerate(solved.t_events[:-1]) if len(times)]
        if not fallen:
            return events, state, loss
        for a in fallen:
            kind = "off" if a in joined else "join"
            joined ^= {a}
            loss += tips[a].letting_go if kind == "off" else tips[a].joining
            events.append((t, kind, a, state[1]))


def _reaches(tip, level, held):
    """Root function of an asperity that joins, or lets go just before its fold."""
    bound = level + (tip.detach * (1.0 - 1e-12) if held else tip.join)

    def distance(_, y):
        return (y[0] - bound) / 1e-9

    distance.terminal, distance.direction = True, 1.0 if held else -1.0
    return distance


def _far(height):
    def away(_, y):
        return y[0] - height

    away.terminal, away.direction = True, 1.0
    return away


def stored(scene, tips, pairs):
    """Energy of joined asperities [J]: `pairs` lists (xi, gap without relief, [(arc, height, tip), ...])."""
    contact = Contact(scene)
    return sum(
        float(tip.energy(contact.overlap(xi, gap, arc, height)[0]))
        for xi, gap, asperities in pairs
        for arc, height, tip in asperities
    )
