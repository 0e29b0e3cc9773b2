"""
How do I test my gears with pytest?
===================================

A scene in the repository of a design deserves tests: that the gear reaches its speed, that the tolerance is fine
enough, and that nothing has changed. These functions run as they stand in a file ``test_my_gears.py``.
"""

import matplotlib.pyplot as plt

import gearidae as gd
from gearidae.testing import assert_runs_close, solutions

SCENE = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.03, "run.samples": 3001})


def test_the_gear_settles_at_its_steady_speed():
    """The late speed is the one at which drag balances the drive."""
    assert abs(gd.simulate(SCENE).late_gear_speed / solutions.steady_speed(SCENE) - 1) < 0.01


def test_the_tolerance_is_fine_enough():
    """A thousand times the accuracy changes nothing that matters."""
    assert_runs_close(gd.simulate(SCENE), gd.simulate(SCENE, rtol=1e-9), rtol=1e-3)


test_the_gear_settles_at_its_steady_speed()
test_the_tolerance_is_fine_enough()

# %%
# Where a run differs from another, a table says.

fine = gd.simulate(SCENE, rtol=1e-9)
gd.compare(gd.simulate(SCENE), fine).filter(["gear_speed", "mesh_force", "adhesion_loss", "events"], axis=0)

# %%
# The error of the speed falls with the tolerance.

figure, ax = plt.subplots(layout="constrained")
for rtol in (1e-4, 1e-5, 1e-6):
    run = gd.simulate(SCENE, rtol=rtol)
    ax.semilogy(run.time * 1e3, abs(run.gear_speed - fine.gear_speed), label=f"rtol = {rtol:g}")
ax.set(xlabel="time (ms)", ylabel="error of the gear's speed (rad/s)")
ax.legend()
