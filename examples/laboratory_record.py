"""
What does the record of a laboratory say about drive and coating?
=================================================================

Four steps: read the files of the logger, calibrate the drive torque with a record of new gears, assess the coating from
a record of worn gears, and write a report of the run that explains it.
"""

import numpy as np

import gearidae as gd

scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "150 ms", "run.samples": 15001})


def log(name: str, **state: float) -> None:
    """Write what a logger would have written: here a simulated speed with noise, in its own units and headings."""
    run = gd.simulate(scene.replace({"drive.torque": 4.8e-18, **state}))
    speed = run.gear_speed.values + np.random.default_rng(1).normal(0.0, 5e-3, run.sizes["time"])
    table = np.column_stack([1e3 * run.time.values, 30.0 / np.pi * speed])
    np.savetxt(name, table, delimiter=";", header="Time [ms];Gear [1/min]", comments="")


log("new.csv")
log("worn.csv", **{"coating.sam_fraction": 0.66})

# %%
# Read: units and separators are recognised, and the dataset is in SI units.

columns = ("Time [ms]", "Gear [1/min]")
new = gd.analysis.read_signal("new.csv", columns=columns)
steady = new.gear_speed.where(new.time > 0.05, drop=True)

# %%
# Calibrate: the steady speed of new gears gives the drive torque; the sensor is good to 1 %.

seen = gd.studies.Observation(
    of=gd.studies.steady_speed, value=float(steady.mean()), uncertainty=0.01 * float(steady.mean())
)
known = gd.studies.calibrate(scene, {"drive.torque": "uniform(4e-18, 6e-18)"}, [seen])
torque = known.sel(parameter="drive.torque")
print(f"drive torque: {float(torque['mean']):.3g} +- {float(torque.standard_deviation):.1g} N m")
scene = scene.replace({"drive.torque": float(torque["mean"])})

# %%
# Assess: the ringing of the worn gears, compared with a map at that torque.

chart = gd.analysis.coating_map(scene, np.round(np.arange(1.0, 0.555, -0.04), 4))
assessment = gd.analysis.assess("worn.csv", chart, columns=columns)
print(
    f"{assessment.verdict}: {assessment.sam_fraction:.2f} of the monolayer is left "
    f"({assessment.low:.3f} to {assessment.high:.3f})"
)
ax = gd.plot.coating_map(chart, assessment=assessment)

# %%
# Report: the run with this torque and coating, as one page.

run = gd.simulate(
    scene.replace({"name": "worn_gears", "coating.sam_fraction": float(assessment.sam_fraction)})
)
print(f"report: {gd.write_report(run, 'worn.html', overwrite=True)}")
