"""
How do I chain a start-up, running and braking?
===============================================

Each run goes on from the end of the one before (``start``), with its motion, the memory of its contacts, its energy
balance and its time. The torques of a run are those of the time that goes on.
"""

import matplotlib.pyplot as plt

import gearidae as gd

short = {"run.samples": "1 MHz", "coating.sam_fraction": 0.8}
full = 2.43e-11  # N m
start_up = gd.load_case("cases/start_up.toml").replace(
    short | {"drive.schedule": [["0 ms", 0.0], ["4 ms", full]], "run.duration": "6 ms"}
)
running = start_up.replace({"drive.torque": full, "drive.schedule": None, "run.duration": "2 ms"})
braking = start_up.replace({"drive.schedule": [["8 ms", full], ["10 ms", 0.0]], "run.duration": "3 ms"})

run, parts = None, {}
for name, scene in (("start_up", start_up), ("running", running), ("braking", braking)):
    run = gd.simulate(scene, start=run, archive=f"{name}.nc", overwrite=True)
    parts[name] = run
    print(
        f"{name}: {float(run.time[0]) * 1e3:.2f} to {run.attrs['t_end'] * 1e3:.2f} ms, "
        f"{float(run.final_speed):.0f} rad/s"
    )
balance = run.gearidae.energy_balance
print(f"the drive has done {balance['drive_work'] * 1e15:.0f} fJ since the start")
print(f"balance closes: {abs(balance['residual']) <= balance['residual_bound']}")

# %%
# The three parts in one picture.

figure, ax = plt.subplots(layout="constrained")
for name, part in parts.items():
    ax.plot(part.time * 1e3, part.gear_speed, label=name)
ax.set(xlabel="time (ms)", ylabel="gear speed (rad/s)")
ax.legend()
