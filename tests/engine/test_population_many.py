"""Real asperities over many events: none missed and none twice, memory, and the closed forms of large numbers."""

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from gearidae.contact.psi import psi
from gearidae.engine.backend import follow, solve
from gearidae.engine.events.asperity_events import (
    asperity_guard,
    join_at_start,
    record_switches,
    switch_asperities,
)
from gearidae.engine.events.histories import accept
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.engine.laws.discrete import asperity_force
from gearidae.engine.model.state import EMPTY
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.population.contact_point import pair_now
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.scene import preset
from reference.population import Contact, Tip

GEARS = preset("teodorescu2009").replace({"contact.roughness": "discrete", "run.samples": "off"})


@cache
def events_of(fraction, longest):
    """Steps of a damped run, and its events of asperities: kind, pair, flank and asperity, and times [s]."""
    scene = GEARS.replace(
        {
            "coating.sam_fraction": fraction,
            "mesh.damping": 7e-6,
            "run.duration": 100e-6,
            "run.rtol": 1e-9,
        }
    )
    with pytest.MonkeyPatch.context() as patch:
        prepare = Problem.prepare

        def limited(self, rtol, samples, *, as_ida=False):
            m = prepare(self, rtol, samples, as_ida=as_ida)
            m.scene.longest_step = longest
            return m

        patch.setattr(Problem, "prepare", limited)
        solution = solve(scene)
    e = solution.events
    single = e.asperity >= 0
    what = np.column_stack([e.kind, e.pair, e.flank, e.asperity])[single]
    return solution.statistics.steps, what, e.time[single], solution.reached / _tau(scene)


def _tau(scene):
    return float(make_problem(scene).model.scene.time_unit)


@pytest.mark.parametrize("fraction", [1.0, 0.5, 0.0])
def test_steps_four_times_shorter_find_the_same_events_in_the_same_order(fraction):
    """With damping no coverage is chaotic: what differs is the order of events closer than the error of their times."""
    steps, what, times, duration = events_of(fraction, 0.0)
    more, other, later, _ = events_of(fraction, 0.2 * duration / steps)
    assert more > 4 * steps
    assert len(what) > 100
    np.testing.assert_array_equal(what, other)
    np.testing.assert_allclose(times, later, rtol=0, atol=1e-11)


@pytest.mark.slow
def test_memory_stays_the_same_over_many_events():
    """Resident memory between the first tenth of some 1e5 events and their end: a block of output is 4 MB."""
    scene = GEARS.replace({"coating.sam_fraction": 0.5, "run.rtol": 1e-4, "run.duration": 15e-3})
    count, resident = 0, []

    def discard(block, *_):
        nonlocal count
        count += len(block.events)
        resident.append((count, _resident()))

    ended = follow(scene, discard)
    assert ended.extremes.asperity_onsets + ended.extremes.asperity_detachments > 95_000
    assert count > 95_000
    early = next(size for events, size in resident if events > 0.1 * count)
    assert resident[-1][1] - early < 4e6


def _resident():
    return 4096 * int(Path("/proc/self/statm").read_text().split()[1])


@pytest.mark.slow
def test_rolling_at_a_fixed_gap_costs_what_each_asperity_loses():
    """A thousand asperities above a gap, at stratified heights and places, roll through the contact.

    The engine's force along the path is integrated from one event to the next, with events where the plain equations
    have them. Over the arc that passes, it is 0.93550 Pc dc N L Q(g/sigma).
    """
    count, gap, low, high = 1000, 11e-9, 1.2e-6, 5.4e-6
    sigma, pitch, tail = GEARS.surface.roughness, GEARS.geometry.base_pitch, float(ndtr(-11.0 / 6.0))
    shares = (np.random.default_rng(2).permutation(count) + 0.5) / count
    heights, arcs = -sigma * ndtri(shares * tail), low + (np.arange(count) + 0.5) * (high - low) / count
    listed = {"arc": arcs.tolist(), "height": heights.tolist(), "tooth": [0] * count}
    scene = GEARS.replace({"coating.sam_fraction": 0.0, "contact.asperities": listed, "initial.gap": gap})
    tip, problem = Tip(scene.surface, scene.surface.asperity_radius), make_problem(scene)
    m, y, room, work = problem.model, problem.start, np.empty((2000, EVENT_NUMBERS)), 0.0
    m.state.mesh_mark_below, m.state.mesh_mark_above = 0.0, 1.0  # between which pair 0 is on its path
    times = np.sort(
        np.concatenate([_places(scene, arcs, heights - gap + out, out > 0.0) for out in (0.0, tip.detach)])
    )
    nodes, weights = np.polynomial.legendre.leggauss(5)
    nodes, weights = 0.5 + 0.5 * nodes, 0.5 * weights
    for start, end in pairwise([0.05, *(times / pitch + 1e-12), 1.6]):
        for node, weight in zip(nodes, weights, strict=True):
            y[2] = end - (end - start) * node**2  # a load changes as the root of the way to its detachment
            work -= 2.0 * node * weight * (end - start) * mesh_forces(m, 0.0, y, False)[1]
        y[2] = end
        if asperity_guard(m, y) < 0.0:
            switch_asperities(m, y)
            record_switches(m, 0.0, y, room, 0)
    assert m.state.asperity_onsets == m.state.asperity_detachments == count
    force = work * pitch * float(m.scene.force_unit) / (high - low)
    density = count / tail / (high - low)  # N L
    assert force == pytest.approx((tip.joining + tip.letting_go) * density * tail, rel=1e-6, abs=0)


def _places(scene, arcs, depth, behind):
    """Places along the path, before or behind asperities, where the contact is as far from them as they reach."""
    contact = Contact(scene)
    middle = np.sqrt(2.0 * contact.base * arcs) - contact.first
    near, far = middle.copy(), middle + (2e-6 if behind else -2e-6)
    for _ in range(60):
        place = 0.5 * (near + far)
        r1 = contact.first + place
        radius = r1 * (contact.total - r1) / contact.total
        inside = depth > (arcs - r1**2 / (2.0 * contact.base)) ** 2 / (2.0 * radius)
        near, far = np.where(inside, place, near), np.where(inside, far, place)
    return far if behind else near


@pytest.mark.parametrize(("fraction", "gap", "kappa"), [(1.0, 2.0, 1.726), (0.0, 2.0, 3.020)])
def test_forces_of_many_pairs_scatter_about_the_mean_law(fraction, gap, kappa):
    """Standard deviation over mean is kappa over the root of the expected number, whatever the radius.

    Three times the preset's density, pairs of all teeth at places that share no asperity.
    """
    scene = GEARS.replace({"coating.sam_fraction": fraction, "surface.asperity_density": 5.07e14})
    contact, sigma = Contact(scene), scene.surface.roughness
    tip = Tip(scene.coated_surface if fraction else scene.surface, scene.surface.asperity_radius)
    x = np.linspace(0.0, 8.0, 160_001)[1:] ** 2 / 8.0
    weight, load = psi(gap + x), tip.load(sigma * x)
    mean, number = np.trapezoid(load * weight, x), np.trapezoid(weight, x)  # over all places and heights
    squares, sums = [], []
    for seed in range(20):
        problem = make_problem(scene.replace({"contact.seed": seed}))
        m, y = problem.model, problem.start
        y[0] = m.scene.clearance[0] - gap
        for tooth in range(19):
            for place in np.linspace(0.02, 0.98, 8) * float(m.scene.contact_ratio):
                y[2] = tooth + place
                m.state.mesh_mark_below, m.state.mesh_mark_above = y[2] - 1e-3, y[2] + 1e-3
                for k in range(int(m.scene.histories)):  # nothing is joined yet
                    m.state.history[k].pair = EMPTY
                accept(m, 0.0, y)
                join_at_start(m, y)
                radius = contact.at(place * scene.geometry.base_pitch)["radius"]
                scale = (
                    scene.surface.asperity_density * scene.gears.face_width * np.sqrt(2.0 * radius * sigma)
                )
                force = asperity_force(m, pair_now(m, 0, tooth, y)).load * float(m.scene.force_unit)
                sums.append(force / (scale * mean))
                squares.append(scale * number * (sums[-1] - 1.0) ** 2)
    assert np.mean(sums) == pytest.approx(1.0, abs=0.03)
    assert np.sqrt(np.mean(squares)) == pytest.approx(kappa, rel=0.02)
