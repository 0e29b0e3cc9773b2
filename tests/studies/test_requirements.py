"""Studies that need constant torques and speeds name the schedule that is in the way, and the way out."""

from __future__ import annotations

import pytest

import gearidae as gd

LOW = gd.preset("teodorescu2009_low_speed")
LAW = gd.wear.loss_law("adhesion_work", energy=1.0)
RAMP = [[0.0, 0.0], [0.1, 1e-18]]
SCHEDULES = {
    "drive.schedule": {"drive.schedule": RAMP},
    "load.schedule": {"load.schedule": RAMP},
    "drive.speed": {"drive": {"speed": [[0.0, 6.0], [0.1, 7.0]], "speed_gain": 1e-17}},
}


def threshold(scene):
    return gd.studies.sticking_threshold(scene, between=(0.4, 0.7))


def life(scene):
    return gd.studies.life(scene, LAW)


@pytest.mark.parametrize("key", SCHEDULES)
@pytest.mark.parametrize("study", [life])
def test_a_schedule_is_named_with_the_way_out(study, key):
    with pytest.raises(gd.SceneError, match=r"needs (a )?constant.*use sweep") as error:
        study(LOW.replace(SCHEDULES[key]))
    assert (error.value.key, error.value.value) == (key, "a schedule")


def test_a_starting_torque_needs_one_load_and_replaces_the_drive():
    with pytest.raises(gd.SceneError, match="needs constant torques") as error:
        gd.studies.starting_torque(LOW.replace(SCHEDULES["load.schedule"]), [1.0])
    assert error.value.key == "load.schedule"
    driven = LOW.replace({"drive.torque": 0.0, **SCHEDULES["drive.schedule"]})
    with pytest.raises(gd.SceneError, match=r"--lowest.*drive\.schedule"):
        gd.studies.starting_torque(driven, [1.0], simulated=False)
    torques = gd.studies.starting_torque(driven, [1.0], simulated=False, lowest=1e-21)
    alone = gd.studies.starting_torque(LOW, [1.0], simulated=False, lowest=1e-21)
    assert float(torques.static_torque[0]) == float(alone.static_torque[0])


@pytest.mark.parametrize("study", [threshold, life, gd.studies.starting_torque, gd.studies.coating_map])
def test_rollers_are_refused(study):
    with pytest.raises(gd.SceneError, match="must be a scene with gears"):
        study(gd.preset("roller_slow"))
