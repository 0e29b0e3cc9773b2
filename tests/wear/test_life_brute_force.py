"""Cycle jump against mesh cycles simulated one after another, with a law some million times as fast.

Whole lives are compared by ``python -m gearidae_pages.life_check``; here are parts of them, which take seconds.
"""

import numpy as np
import pytest

import gearidae as gd
from gearidae.wear.lives.coverage import coverage_of
from gearidae.wear.lives.window import Cycles, run_window, window_scene
from gearidae_pages.life_check import PLACES, brute_force, compared, fast_life


def test_a_life_of_independent_sides():
    """The gear's side, whose teeth pass four times less often, against the pinion's."""
    scene, law = fast_life(120, "independent")
    scene = scene.replace({"coating.pinion_fraction": 0.9, "coating.gear_fraction": 0.7})
    brute = brute_force(scene, law, 133, "uniform")
    assert not brute.sticks
    settings = {"passages": 7.0, "cycles": 3, "settle": 6, "starts": 1, "frequency": False, "jobs": 1}
    life = gd.studies.life(scene, law, **settings)
    assert life.attrs["mesh_cycles_direct"] < 100
    seen = compared(scene, "uniform", life, brute)
    lost = life.coverage[0] - life.coverage[-1]
    assert float(lost.min()) > 0.01
    # brute force begins with the start of the scene, which wears less: 0.0015 of 0.11
    assert seen.place < 3e-3
    assert seen.mean < 2e-3


@pytest.mark.parametrize(
    ("resolved", "pairing"), [("place", "independent"), ("tooth", "patches"), ("tooth", "independent")]
)
def test_rates_are_what_a_turn_costs(resolved, pairing):
    """Every tooth passes once in a turn of the pinion, one in each mesh cycle; the barer ones lose more."""
    scene, law = fast_life(100_000, pairing)
    if resolved == "tooth":
        scene = scene.replace({"coating.pinion_table": np.linspace(0.75, 0.9, 19)[:, None].tolist()})
    brute = brute_force(scene, law, 38, resolved)
    turn = brute.states[38] - brute.states[19]  # the first turn begins with the start of the scene
    coverage = coverage_of(scene, resolved, PLACES)
    cycles = Cycles(19, 19)
    window = window_scene(scene, cycles, PLACES).replace(coverage.changes(coverage.start))
    solution, word = run_window(window, cycles, "native")
    assert word == "turns"
    rate = law.rate(coverage.start, coverage.exposure(window, solution, 19, coverage.start))
    lost = turn < 0.0  # in the other places asperities have joined before: none join anew
    assert lost.sum() >= len(turn) // 4
    assert (rate[lost] < 0.0).all()
    # shares change by less than 2e-4 in a turn, and the motion in the second one is steady to about as much
    np.testing.assert_allclose(turn, rate, rtol=2e-3, atol=2e-4 * np.abs(rate).max())
    if resolved == "tooth":
        by_tooth = coverage.split(rate)[0].mean(axis=1)
        assert np.ptp(by_tooth) > 0.05 * np.abs(by_tooth).max()
