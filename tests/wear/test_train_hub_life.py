"""Lives of hubs of trains: what joints of all shafts slide in a turn of the drive's shaft."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.engine.train.test_train_ageing import as_pair
from tests.mesh.test_slow_train import MICROENGINE, idle
from tests.reference.trains import HUBS, chain

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.products import answer, open_product
from gearidae.wear.declared.hub_life import STUDY

WEAR = {"coefficient": "1e-16 m^2/N", "threshold": "1e-21 m^3"}
SHORT = {**WEAR, "turns": 1, "tolerance": 1.0}
"""The second turn is the measured one, settled or not."""
SETTLING = 150e-6
CHAIN = gd.Scene.from_dict(chain(hubs=0.1))
CASE = "cases/transmission.toml"


@pytest.fixture(scope="module")
def lives():
    return gd.studies.hub_life(CHAIN, **SHORT, clearance=True)


def engine_alone():
    """A microengine and the gear that it drives, beside a light shaft whose second mesh touches now and then."""
    tables = {**idle(), "drive": MICROENGINE}
    for shaft, radius in zip(tables["shafts"].values(), HUBS, strict=True):
        shaft |= {"hub_friction": 0.2, "hub_radius": radius}
    tables["shafts"]["output"] = {"teeth": 76, "inertia": 1e-21}
    return gd.Scene.from_dict(tables).replace({"drive.law.phase": 1.2, "run.duration": 1e-3})


def test_one_mesh_of_a_train_has_the_lives_of_the_pair():
    """The light shaft has a hundredth of the inertia of the gear: its knocks change loads by 2e-5."""
    scene = engine_alone()
    train, pair = (gd.studies.hub_life(each, **SHORT) for each in (scene, as_pair(scene)))
    assert train.joint.values.tolist() == ["hub of input", "hub of idler", "pin"]
    assert pair.joint.values.tolist() == ["pinion hub", "gear hub", "pin"]
    np.testing.assert_allclose(train.turns, pair.turns, rtol=1e-4)
    np.testing.assert_allclose(train.frequency, pair.frequency, rtol=1e-5)
    # the pin carries the force of its law: 2 pi r F0 in a turn, from its loss over its coefficient
    way = 2.0 * math.pi * 1.25e-6 * 10e-6
    assert train.sliding.sel(joint="pin").item() == pytest.approx(way, rel=1e-6, abs=0)


def test_a_train_of_one_mesh_is_its_pair():
    scene = as_pair(engine_alone())
    tables = {key: value for key, value in scene.to_dict().items() if key != "gears"}
    shafts, mesh = scene.shafts, scene.meshes["mesh"]
    assert shafts is not None
    tables["shafts"] = {name: shaft.model_dump(exclude_none=True) for name, shaft in shafts.items()}
    tables["meshes"] = {"only": mesh.model_dump(exclude_none=True)}
    train, pair = (gd.studies.hub_life(each, **SHORT) for each in (gd.Scene.from_dict(tables), scene))
    np.testing.assert_allclose(train.turns, pair.turns, rtol=1e-12)


def test_hubs_of_a_chain_slide_as_load_and_speed_of_its_samples_say(lives):
    """Trapezoids over 12 ns, far below the 100 ns and more of a contact, are off by 3e-6 at most."""
    run = gd.simulate(CHAIN, t_end=SETTLING + 2.3e-3, samples=200_001)
    time, output = run.time.values, run.shaft_angle.sel(shaft="output").values
    # a turn of the input is a quarter of one of the output, 19:76; the second from the end of the settling on
    begin = np.interp(SETTLING, time, output)
    first, last = np.interp(begin + 2.0 * math.pi * np.array([0.25, 0.5]), output, time)
    inside = np.flatnonzero((time > first) & (time < last))
    share = (time[inside[-1]] - time[inside[0]]) / (last - first)
    for name, radius in zip(CHAIN.shafts, HUBS, strict=True):
        shaft = run.sel(shaft=name)
        power = shaft.hub_load.values * np.abs(shaft.shaft_speed.values) * radius
        expected = float(np.trapezoid(power[inside], time[inside])) / share
        assert lives.sliding.sel(joint=f"hub of {name}").item() == pytest.approx(expected, rel=2e-5, abs=0)
    assert lives.frequency.item() == pytest.approx(1.0 / (last - first), rel=1e-6)


def test_lives_follow_from_what_hubs_slide(lives):
    """Archard's law, and depths of the hubs with the face width of the meshes for their length."""
    np.testing.assert_allclose(lives.turns, 1e-21 / (1e-16 * lives.sliding), rtol=1e-12)
    name = lives.joint.values[int(lives.turns.argmin("joint").item())]
    depth = lives.worn_depth.sel(joint=name).item()
    radius = CHAIN.shafts[name.removeprefix("hub of ")].hub_radius
    assert depth == pytest.approx(1e-21 / (2.0 * math.pi * radius * 2.25e-6), rel=1e-12, abs=0)
    np.testing.assert_array_equal(lives.added_backlash, 2.0 * lives.worn_depth)
    sentence = STUDY.sentence(lives)
    assert sentence.startswith(f"The {name} fails first, after ")
    assert "turns of input (" in sentence


def test_what_lives_of_trains_need_is_named():
    engine = gd.Scene.from_dict(chain(hubs=0.1, drive=MICROENGINE))
    ages = {"drive.pin_friction_rise": 0.1, "drive.pin_ageing_time": 1e-3, "drive.pin_memory_length": 5e-8}
    bare = gd.Scene.from_dict(chain())
    for scene, message in (
        (bare, r"must have a hub or a pin with a radius \(shafts.NAME.hub_radius"),
        (engine.replace({"drive.pin_friction": 0.0}), r"drive.pin_friction = 0.*must be above 0"),
        (engine.replace(ages), r"drive.pin_friction_rise = 0.1.*must be 0"),
        (CHAIN.replace({"meshes.second.face_width": 3e-6}), "length.*is required where meshes differ"),
    ):
        with pytest.raises(gd.SceneError, match=message):
            gd.studies.hub_life(scene, **SHORT)


def test_a_train_that_stands_names_its_shaft(caplog):
    heavy = CHAIN.replace({"load.torque": 3e-10})
    with pytest.raises(gd.SolverError, match="no run gives a life"):
        gd.studies.hub_life(heavy, **SHORT)
    assert caplog.messages[-1] == "one frequency has no life: output does not turn on at 0.00015 s"


def test_the_command_follows_a_transmission(tmp_path, capsys):
    path = tmp_path / "lives.nc"
    quick = ["--set", "run.duration=1.5 ms", "run.rtol=1e-5"]
    words = ["hub-life", CASE, "--coefficient", "1e-16 m^2/N", "--threshold", "1e-21 m^3"]
    assert main([*words, "--length", "2 um", "-o", str(path), *quick]) == 0
    ds, kind = open_product(path)
    assert kind == "hub_life"
    assert ds.joint.values.tolist() == [*(f"hub of {name}" for name in gd.load_case(CASE).shafts), "pin"]
    out = " ".join(capsys.readouterr().out.split())
    assert answer(ds, kind).sentence in out
    assert "turns/s of engine" in out
    assert gd.plot.hub_life(ds).get_xlabel() == "turns of engine in a second"
