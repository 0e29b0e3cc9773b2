"""
How do I resume a long run after an interruption?
=================================================

With ``archive`` samples and events go to the disk as they come. Whatever ends the run, the same call with ``resume``
goes on from the last checkpoint and gives the same numbers as if nothing had happened.
"""

import gearidae as gd

scene = gd.load_case("cases/start_up.toml").replace({"run.duration": "15 ms", "run.samples": "1 MHz"})


def press_ctrl_c(time: float, events: int) -> None:
    """Stand in for somebody who stops the run half way."""
    if time > 7e-3:
        raise KeyboardInterrupt


try:
    gd.simulate(scene, archive="start_up.nc", overwrite=True, progress=press_ctrl_c)
except KeyboardInterrupt:
    kept = gd.open_archive("start_up.nc")
    print(f"{kept.attrs['status']} after {kept.sizes['time']} samples, {kept.sizes['event']} events")
    kept.close()

# %%
# The same call goes on, and the record has no seam. Checkpoints are some seconds apart: this run had none yet, and
# begins anew.

run = gd.simulate(scene, archive="start_up.nc", resume=True)
print(f"{run.attrs['status']} after {run.sizes['time']} samples, {run.sizes['event']} events")
moving = run.time.values[run.gear_speed.values > 1.0]
print(f"the gear is moving from {moving[0] * 1e3:.2f} ms on")
ax = gd.plot.gear_speed(run)
