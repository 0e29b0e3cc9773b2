"""Arguments that are no keys of a scene: what cannot be meant is refused in one line, and names the argument."""

import math

import pytest

import gearidae as gd
from gearidae.runs.equilibrium import contact_resonance

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3})
ENGINE = gd.load_case("cases/microengine.toml").replace({"run.duration": 1e-4})


@pytest.fixture(scope="module")
def drawn():
    return gd.studies.pull_off(LOW, seeds=2)


@pytest.mark.parametrize(
    ("key", "call"),
    [
        (
            "clearance",
            lambda: gd.studies.hub_life(ENGINE, coefficient=1e-16, threshold=1e-9, clearance="abc"),
        ),
        ("seeds", lambda: gd.studies.hub_life(ENGINE, coefficient=1e-16, threshold=1e-9, seeds=-1)),
        ("progress", lambda: gd.simulate(LOW, progress="1 kg")),
        ("progress", lambda: gd.sweep(LOW, {"coating.sam_fraction": [1.0]}, progress="1 kg")),
        ("joined", lambda: contact_resonance(LOW, math.nan)),
        ("load", lambda: gd.studies.pull_off(LOW, seeds=1, load=3.5)),
        ("accuracy", lambda: gd.studies.sensitivity(LOW, "drive.torque", of="mesh_exits", accuracy="abc")),
        ("accuracy", lambda: gd.studies.sensitivity(LOW, "drive.torque", of="mesh_exits", accuracy=math.nan)),
        ("scale", lambda: gd.studies.sensitivity(LOW, "load.torque", of="mesh_exits", scale="abc")),
        ("tolerance", lambda: gd.studies.starting_torque(LOW, tolerance="abc")),
        ("simulated", lambda: gd.studies.starting_torque(LOW, simulated="abc")),
        ("lowest", lambda: gd.studies.static_starting_torque(LOW, lowest="abc")),
        (
            "width",
            lambda: gd.studies.sticking_threshold(
                LOW, over="coating.sam_fraction", between=(0.4, 0.6), width="abc"
            ),
        ),
        ("width", lambda: gd.analysis.coating_map(LOW, [0.5], width="abc")),
        ("gear_teeth", lambda: gd.analysis.impact_windows(gd.simulate(LOW, samples=201), gear_teeth=0)),
    ],
)
def test_what_cannot_be_meant_is_refused(key, call):
    with pytest.raises(gd.SceneError) as error:
        call()
    assert error.value.key == key


@pytest.mark.parametrize("function", [gd.outcomes, gd.plot.teeth, lambda ds: ds.gearidae.verdicts()])
def test_a_study_is_no_run(drawn, function):
    with pytest.raises(gd.SceneError, match="no run"):
        function(drawn)


def test_a_place_in_a_list_names_no_dimension():
    scheduled = LOW.replace({"drive.schedule": [[0.0, 0.0], [1e-3, 1e-18]], "run.samples": 2})
    ds = gd.sweep(scheduled, {"drive.schedule.1.0": [1e-3, 2e-3]})
    assert ds.sizes["drive_schedule_1_0"] == 2


def test_a_coefficient_of_hubs_serves_a_pin_or_dimples_alone():
    no_hubs = {"gears.pinion_hub_radius": 0.0, "gears.gear_hub_radius": 0.0}
    assert ENGINE.replace(no_hubs).drive.pin_radius > 0.0
    with pytest.raises(gd.SceneError, match="a hub, a dimple or the pin must have a radius"):
        ENGINE.replace({**no_hubs, "drive.pin_radius": 0.0})


def test_a_time_beyond_all_records_is_refused():
    ds = gd.simulate(LOW.replace({"run.samples": 3}))
    with pytest.raises(gd.SceneError, match="must lie in the record"):
        gd.plot.teeth(ds, time=10**30)


def test_gears_of_another_size_with_the_inertias_of_the_presets_are_named(caplog):
    gd.simulate(LOW.replace({"gears.gear_teeth": 200, "run.samples": 2}))
    assert "gears.gear_inertia" in caplog.text
    assert "gears.density" in caplog.text
    caplog.clear()
    gd.simulate(LOW.replace({"run.samples": 2}))
    assert caplog.text == ""


def test_attraction_of_bare_flanks_under_a_whole_coating_is_named(caplog):
    gd.simulate(LOW.replace({"surface.hamaker": 5e-20, "contact.bodies": "rigid", "run.samples": 2}))
    assert "surface.hamaker = 50 zJ has no effect" in caplog.text
