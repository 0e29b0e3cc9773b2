"""A train of two shafts and one mesh runs as its short form."""

from __future__ import annotations

import xarray as xr

import gearidae as gd
from gearidae.scene import Scene, preset


def test_a_train_of_one_mesh_gives_the_numbers_of_its_pair():
    scene = preset("teodorescu2009").replace({"run.duration": "20 us", "run.samples": 11})
    data, gears = scene.to_dict(), scene.gears
    del data["gears"]
    data["shafts"] = {
        "engine": {"teeth": gears.pinion_teeth, "inertia": gears.pinion_inertia},
        "wheel": {"teeth": gears.gear_teeth, "inertia": gears.gear_inertia},
    }
    data["mesh"] |= {
        "driver_base_radius": gears.pinion_base_radius,
        "pressure_angle": gears.pressure_angle,
        "face_width": gears.face_width,
    }
    data["meshes"] = {"only": {"driver": "engine", "driven": "wheel", "angle": 0.7}}
    run, pair = gd.simulate(Scene.from_dict(data)), gd.simulate(scene)
    xr.testing.assert_equal(run, pair)
    assert run.attrs["scene"] == pair.attrs["scene"]
