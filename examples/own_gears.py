"""
How do my own gears behave, with a coating of my own?
=====================================================

Teeth, radii, backlash and surfaces are keys of the scene. Inertias are inputs of their own; here those of solid discs
of silicon.
"""

import math
from pathlib import Path

import gearidae as gd

teeth = 22, 44
radius = 25e-6  # base circle of the pinion [m]; that of the gear follows
width, density = 2.5e-6, 2330.0
inertia = [0.5 * math.pi * density * width * r**4 for r in (radius, radius * teeth[1] / teeth[0])]
drag, speed = 8e-18, 2.0

scene = gd.preset("teodorescu2009_low_speed").replace(
    {
        "name": "own_gears",
        "gears.pinion_teeth": teeth[0],
        "gears.gear_teeth": teeth[1],
        "gears.pinion_base_radius": radius,
        "gears.pinion_inertia": inertia[0],
        "gears.gear_inertia": inertia[1],
        "gears.face_width": width,
        "mesh.backlash": "0.3 um",
        "surface.roughness": "8 nm",
        "coating.energy": "0.05 J/m^2",
        "coating.sam_fraction": 0.7,
        "drive.torque": teeth[0] / teeth[1] * drag * speed**2,  # holds the speed against the drag
        "initial.gear_speed": speed,
        "initial.gap": "48 nm",  # six times the roughness
        "run.duration": "150 ms",
        "run.samples": 15001,
    }
)
print(f"contact ratio {scene.geometry.contact_ratio:.3f}, module {scene.geometry.module * 1e6:.3f} um")
for name, surface in (("bare", scene.surface), ("coated", scene.coated_surface)):
    print(f"Tabor parameter, {name}: {gd.contact.tabor_parameter(surface):.2f}")

# %%
# The run goes to a file, and the scene to a case file for the command line.

run = gd.simulate(scene, archive="own_gears.nc", overwrite=True)
(did,) = gd.outcomes(run)
print(f"{did.verdict}, {did.min_speed:.3g} to {did.max_speed:.3g} rad/s, {did.impacts} impacts")
Path("own_gears.toml").write_text(gd.dump_case(scene), encoding="utf-8")
ax = gd.plot.gear_speed(run)
