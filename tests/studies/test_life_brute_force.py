"""Cycle jump against all mesh cycles simulated one after another, with a law some million times as fast.

Whole lives are compared by ``python -m gearidae_bench.life_check``; here are parts of them, which take seconds.
"""

import numpy as np
import pytest

import gearidae as gd
from gearidae_bench.life_check import brute_force, compared, fast_life

PLACES = 8
RIGID = {"contact.model": "asperity"}


def both(scene, law, resolved, mesh_cycles, **settings):
    brute = brute_force(scene, law, mesh_cycles, resolved)
    assert not brute.sticks
    found = gd.studies.life(
        scene,
        law,
        passages=mesh_cycles / 19,
        resolved=resolved,
        places=PLACES,
        frequency=False,
        jobs=1,
        **settings,
    )
    assert found.attrs["mesh_cycles_direct"] < mesh_cycles / 2
    return found, compared(scene, resolved, found, brute)


def test_independent_sides():
    """The gear's side, whose teeth pass four times less often, against the pinion's."""
    scene, law = fast_life(120, "independent")
    scene = scene.replace({"coating.pinion_fraction": 0.9, "coating.gear_fraction": 0.7})
    found, seen = both(scene, law, "uniform", 133, cycles=3, settle=6, starts=1)
    lost = found.coverage[0] - found.coverage[-1]
    assert float(lost.min()) > 0.01
    assert seen.place < 3e-3
    # of what is lost: settling from the start of the scene, which brute force has in its first cycles
    assert 3e-3 * float(found.coverage.max()) < 0.2 * float(lost.min())


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["patches", "independent"])
def test_by_tooth(pairing):
    """Teeth that are covered differently lose differently; each is exposed in one mesh cycle of 19."""
    scene, law = fast_life(1000, pairing)
    table = np.linspace(0.7, 0.85, 19)[:, None].tolist()
    scene = scene.replace({**RIGID, "coating.pinion_table": table})
    found, seen = both(scene, law, "tooth", 19 * 13, settle=0, starts=1)
    pinion = found.coverage_by_place.isel(side=0)
    lost = (pinion[0] - pinion[-1]).mean("place")
    assert float(lost.max()) > 0.01
    assert float(lost[0]) > 1.2 * float(lost[-1])  # the barer tooth, which adheres more
    assert seen.mean < 2e-3
    assert seen.place < 0.01
