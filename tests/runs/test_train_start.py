"""Runs of trains that go on from the end of another: their state, histories and energies, in both drivers."""

from __future__ import annotations

import base64
import zlib
from functools import cache

import numpy as np
import pytest
from tests.engine.train.test_train_motion import adhering, stopping
from tests.reference.trains import chain, split

import gearidae as gd
from gearidae.cli import main
from gearidae.scene import Scene, dump_case

OVER_TIME = ("shaft_speed", "shaft_angle", "mesh_force", "hub_load", "transmission_error")
WORKS = ("drive_work", "load_work", "hub_loss", "damping_loss", "adhesion_loss", "work_in", "work_out")
COUNTS = ("largest_mesh_force", "smallest_separation", "mesh_exits", "min_speed", "max_speed", "rest_time")
FAST = {"gear_speed": 1400.0, "gap": "36 nm", "mesh_phase": 0.3}
CASES = {
    "hubs": (chain(hubs=0.3), "70 us", 150e-6, "native", {}),
    "closed loop": (split(), "70 us", 150e-6, "native", {}),
    # the middle mesh, coated in part, adheres with stretched asperities
    "adhesion": (adhering(), "90 us", 150e-6, "native", {"run.rtol": 1e-9}),
    # the output is held from 86.2 us on, the input sticks at 92.3 us, slips again and sticks at 95.2 us
    "held shafts": (stopping(), "94 us", 120e-6, "native", {}),
    "turns": (chain(hubs=0.3, initial=FAST), "6 ms", 8e-3, "native", {}),
    "portable": (chain(hubs=0.3), "25 us", 60e-6, "sksundae", {"run.rtol": 1e-6}),
}


@cache
def runs(case):
    """A whole run, and its two parts."""
    tables, cut, end, backend, changes = CASES[case]
    scene = Scene.from_dict(tables).replace(
        {"run.duration": end, "run.samples": 31, "run.rtol": 1e-8, **changes}
    )
    first = gd.simulate(scene.replace({"run.duration": cut, "run.samples": 15}), backend=backend)
    # what the scene says of its start is of no effect
    other = scene.replace({"initial.gap": "1 nm", "initial.gear_speed": 7.0})
    second = gd.simulate(other, start=first, t_end=end, samples=17, backend=backend)
    return gd.simulate(scene, backend=backend), first, second


@pytest.mark.parametrize("case", CASES)
def test_continued_is_whole(case):
    """Up to the tolerance: a run that goes on takes other steps than one that has not ended there.

    Forces follow gaps of some nanometres, steeply: of the mesh that adheres the most.
    """
    whole, first, second = runs(case)
    rtol = whole.attrs["rtol"]
    assert second["time"][0] == first["time"][-1] == first["reached"]
    assert float(second["time"][-1]) == pytest.approx(float(whole["time"][-1]), rel=1e-15, abs=0.0)
    for name in OVER_TIME:
        near, scale = second[name][..., -1], np.abs(whole[name]).max("time")
        allowed = (1e4 if name in ("mesh_force", "hub_load") else 1e2) * rtol
        assert (np.abs(near - whole[name][..., -1]) <= allowed * scale).all(), name
    for name in (*WORKS, *COUNTS):
        np.testing.assert_allclose(second[name], whole[name], rtol=1e3 * rtol, err_msg=name)
    assert abs(float(second["residual"])) < float(second["residual_bound"])
    # turning points of contacts that ring out come from rounding
    rows = [ds.gearidae.events().query("kind != 'turning_point'") for ds in (whole, first, second)]
    events = [table[["kind", "mesh", "shaft"]].astype(str).values.tolist() for table in rows]
    assert len(events[0]) > 2
    assert events[1] + events[2] == events[0]


def test_a_seam_is_continuous():
    _, first, second = runs("adhesion")
    for name in ("shaft_speed", "shaft_angle"):
        np.testing.assert_array_equal(second[name][:, 0], first[name][:, -1])
    for name in ("mesh_force", "hub_load"):  # of the last look at the meshes, and of the first one
        np.testing.assert_allclose(second[name][:, 0], first[name][:, -1], rtol=1e-6)


def test_a_rest_goes_on_over_the_seam():
    whole, _, second = runs("held shafts")
    (ended,), (at_once,) = (ds.gearidae.verdicts().to_dict("records") for ds in (whole, second))
    assert ended["verdict"] == at_once["verdict"] == "stops"
    assert at_once["stick_time"] == pytest.approx(86.247604e-6, abs=1e-11, rel=0.0)
    assert at_once["stick_exits"] == ended["stick_exits"]


@pytest.mark.parametrize(
    "changes",
    [
        {"drive.torque": 1.5e-11, "load.torque": 4e-10},
        {"coating.sam_fraction": 0.4, "coating.energy": 0.03},
        {"meshes.m2.coating.sam_fraction": 0.9},
    ],
)
def test_other_torques_and_coatings(changes):
    """Energies go on, and what other materials store is no part of them: the balance closes over both runs."""
    scene = Scene.from_dict(adhering()).replace({"run.samples": 7, "run.rtol": 1e-8, "run.duration": "60 us"})
    first = gd.simulate(scene)
    second = gd.simulate(scene.replace(changes), start=first)
    assert abs(float(second["residual"])) < float(second["residual_bound"])
    assert float(second["drive_work"]) > float(first["drive_work"])
    np.testing.assert_array_equal(second["shaft_speed"][:, 0], first["shaft_speed"][:, -1])
    same = gd.simulate(scene, start=first)
    assert not np.allclose(second["shaft_speed"][:, -1], same["shaft_speed"][:, -1], rtol=1e-6)


def test_a_balance_may_begin_with_a_later_run():
    scene = Scene.from_dict(adhering()).replace({"run.samples": 7, "run.rtol": 1e-8, "run.duration": "60 us"})
    without = gd.simulate(scene.replace({"run.balance": False}))
    assert np.isnan(without["residual"])
    second, both = gd.simulate(scene, start=without), gd.simulate(scene, start=gd.simulate(scene))
    assert abs(float(second["residual"])) < float(second["residual_bound"])
    assert 0.0 < float(second["drive_work"]) < float(both["drive_work"])
    np.testing.assert_allclose(second["shaft_speed"], both["shaft_speed"], rtol=1e-9)


def test_more_torque_lets_a_held_train_go():
    """Hubs hold the chain at rest below 8.05e-12 N m."""
    rest = {"gear_speed": 0.0, "gap": "36 nm", "mesh_phase": 0.3}
    scene = Scene.from_dict(chain("0 deg", hubs=0.3, drive={"torque": 7.9e-12}, initial=rest))
    held = gd.simulate(scene.replace({"run.duration": "1 ms", "run.samples": 21}))
    more = gd.simulate(held.gearidae.scene.replace({"drive.torque": 8.2e-12}), start=held)
    still = gd.simulate(held.gearidae.scene, start=held)
    assert more["shaft_speed"].sel(shaft="output")[-1] > 50.0
    assert (still["shaft_speed"][:, 1:] == 0.0).all()
    np.testing.assert_allclose(still["rest_time"], held["rest_time"] + 1e-3, rtol=1e-9)


def standing():
    """A chain whose hubs hold it until the drive rises, and that its dry load stops."""
    knots = [[0.0, 0.0], [0.1e-3, 7.9e-12], [1.2e-3, 7.9e-12], [1.4e-3, 1e-11], [1.8e-3, 0.0], [2.6e-3, 0.0]]
    rest = {"gear_speed": 0.0, "gap": "30 nm", "mesh_phase": 0.3}
    scene = Scene.from_dict(chain(hubs=0.3, drive={"torque": 0.0, "schedule": knots}, initial=rest))
    return scene.replace({"run.rtol": 1e-8, "run.samples": 27})


@cache
def stood():
    return gd.simulate(standing().replace({"run.duration": "2.6 ms"}))


@pytest.mark.parametrize(
    "cuts", [(0.6e-3,), (0.3e-3, 0.6e-3, 2.3e-3), (1.5e-3,)], ids=["standing", "thrice", "just let go"]
)
def test_a_chain_has_the_standstills_of_the_whole_run(cuts):
    """A standstill may begin in one run, let go in the next and be left in a third; free gears go on with it.

    Distances are those at looks, 2001 a run.
    """
    whole, parts, before = stood(), [], 0.0
    for end in (*cuts, 2.6e-3):
        start = parts[-1] if parts else None
        parts.append(gd.simulate(standing().replace({"run.duration": end - before}), start=start))
        before = end
    joined = gd.concat(parts, dim="time")
    expected, found = (ds.gearidae.standstills() for ds in (whole, joined))
    assert found.verdict.tolist() == expected.verdict.tolist() == ["sticks", "stops"]
    assert found.held_by.tolist() == expected.held_by.tolist()
    for name in ("begin", "end", "rest_time"):
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-8, err_msg=name)
    for name in ("advance", "free_advance", "held_torque"):
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-2, err_msg=name)
    for name in (
        "standing_time",
        "start_time",
        "breakaway_torque",
        "stick_time",
        "stick_exits",
        "mesh_exits",
    ):
        assert joined[name].values == pytest.approx(whole[name].values, rel=1e-8), name
    for name in ("settled_gear_speed", "late_gear_speed", "settled_spread", "speed_fall"):
        assert float(joined[name]) == pytest.approx(float(whole[name]), rel=2e-2), name
    (once,), (pieces,) = (gd.outcomes(ds) for ds in (whole, joined))
    assert pieces.words == once.words


def test_what_a_verdict_has_of_earlier_runs_may_be_damaged_or_missing():
    """Without it, as in an archive of before, the chain of the verdict begins with the run."""
    first = gd.simulate(standing().replace({"run.duration": "0.6 ms"}))
    more = standing().replace({"run.duration": "0.9 ms"})
    words = np.frombuffer(zlib.decompress(base64.b64decode(first.attrs["end_verdict"])), np.float64).copy()
    for damaged in (words[:-1], np.append(words, 0.0), np.where(np.arange(words.size) == 1, -1.0, words)):
        text = base64.b64encode(zlib.compress(damaged.tobytes())).decode()
        with pytest.raises(gd.SceneError, match=r"start = end_verdict: is damaged"):
            gd.simulate(more, start=first.assign_attrs(end_verdict=text))
    with pytest.raises(gd.SceneError, match=r"start = end_verdict: is damaged"):
        gd.simulate(more, start=first.assign_attrs(end_verdict="?"))
    before = first.copy()
    before.attrs.pop("end_verdict")
    short, whole = (gd.simulate(more, start=start) for start in (before, first))
    np.testing.assert_array_equal(short["shaft_speed"], whole["shaft_speed"])
    assert whole.gearidae.standstills().free_advance[0] > short.gearidae.standstills().free_advance[0]


def test_a_train_that_turns_back_turns_back_in_its_chain():
    """By how far, since when, and by how far free gears have: from a farthest place in the first run."""
    back = {"torque": 1e-11, "schedule": [[0.0, 0.0], [0.1e-3, -2.2e-11], [1e-3, -2.2e-11]]}
    tables = chain(drive=back, load={"torque": 0.0, "drag": 8e-18})
    scene = Scene.from_dict(tables).replace({"run.rtol": 1e-8, "run.samples": 11})
    whole = gd.simulate(scene.replace({"run.duration": "0.6 ms"}))
    turned = float(whole["back_time"])
    first = gd.simulate(scene.replace({"run.duration": 1.2 * turned}))
    assert float(first["turned_back"]) == 0.0
    second = gd.simulate(scene.replace({"run.duration": 0.6e-3 - 1.2 * turned}), start=first)
    assert float(whole["turned_back"]) > 1.0
    for name in ("turned_back", "free_turned_back", "back_time"):
        assert float(second[name]) == pytest.approx(float(whole[name]), rel=1e-3), name
    assert gd.outcomes(second)[0].words == gd.outcomes(whole)[0].words


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shafts.upper.inertia": 1e-19}, "shafts.upper.inertia = 1e-19: must be 1.536e-19"),
        ({"shafts.upper.hub_radius": "4 um"}, "shafts.upper.hub_radius = 4e-06: must be 0.0"),
        ({"meshes.one.phase": 0.1}, "meshes.one.phase = 0.1: must be left out"),
        ({"meshes.two.backlash": "0.51 um"}, "meshes.two.backlash = 5.1e-07: must be left out"),
        ({"load.shaft": "upper"}, "load.shaft = upper: must be output"),
    ],
)
def test_other_trains_are_refused(changes, message):
    _, first, _ = runs("closed loop")
    with pytest.raises(gd.SceneError, match=message):
        gd.simulate(Scene.from_dict(split()).replace(changes), start=first)


def test_other_names_and_another_order_are_refused():
    _, first, _ = runs("closed loop")
    tables = split()
    for key in ("shafts", "meshes"):
        names = list(tables[key])
        names[1], names[2] = names[2], names[1]
        other = tables | {key: {name: tables[key][name] for name in names}}
        with pytest.raises(gd.SceneError, match=f"{key} = .*: must be .*, as in the run to go on from"):
            gd.simulate(Scene.from_dict(other), start=first)
    tables = chain(hubs=0.3)
    tables["shafts"]["input"]["teeth"] = 20
    with pytest.raises(gd.SceneError, match=r"shafts\.input\.teeth = 20: must be 19"):
        gd.simulate(Scene.from_dict(tables), start=runs("hubs")[1])
    with pytest.raises(gd.SceneError, match="as in the run to go on from"):
        gd.simulate(gd.preset("teodorescu2009"), start=first)


@pytest.mark.parametrize("place", [0, 3, 6, 20, 40, 60, 500, 5_000, 10_000])
def test_a_damaged_state_is_refused(place):
    _, first, second = runs("adhesion")
    words = np.frombuffer(zlib.decompress(base64.b64decode(first.attrs["end_state"])), np.float64).copy()
    assert words.size > place
    short = first.assign_attrs(end_state=base64.b64encode(zlib.compress(words[:-1].tobytes())).decode())
    words[place] = np.nan
    damaged = first.assign_attrs(end_state=base64.b64encode(zlib.compress(words.tobytes())).decode())
    with pytest.raises(gd.SceneError, match="checkpoint"):
        gd.simulate(second.gearidae.scene, start=damaged)
    with pytest.raises(gd.SceneError, match="not as many as this scene has"):
        gd.simulate(second.gearidae.scene, start=short)


def test_from_archives_and_on_the_command_line(tmp_path, capfd):
    case = tmp_path / "train.toml"
    case.write_text(dump_case(Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "20 us"})))
    first, second = tmp_path / "first.nc", tmp_path / "second.nc"
    assert main(["run", str(case), "-o", str(first)]) == 0
    assert main(["run", str(case), "--start", str(first), "-o", str(second)]) == 0
    capfd.readouterr()
    ds, before = gd.open(second), gd.open(first)
    assert float(ds["reached"]) == pytest.approx(40e-6, rel=1e-12)
    assert ds.attrs["started_from"] == before.attrs["end_state_name"]
    assert ds.attrs["start_time"] == float(before["reached"])
    third = gd.simulate(ds.gearidae.scene, start=second)
    assert float(third["reached"]) == pytest.approx(60e-6, rel=1e-12)
