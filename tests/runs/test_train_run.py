"""Runs of trains: of one mesh as a pair, of several with verdict and work, against an independent prototype."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from tests.reference.trains import chain

import gearidae as gd
from gearidae.cli import main
from gearidae.scene import Scene, dump_case, preset


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


@pytest.fixture(scope="module")
def run():
    return gd.simulate(Scene.from_dict(chain(hubs=0.3)).replace({"run.samples": 151, "run.rtol": 1e-9}))


def test_a_train_of_several_meshes_runs(run):
    """Speeds and forces of an independent prototype at 50 and 150 us."""
    at = run.sel(time=[50e-6, 150e-6], method="nearest")
    speeds = [[4015.933091, 4530.490142], [2011.210885, 2264.200614], [1015.084236, 1128.926403]]
    assert at["shaft_speed"].values == pytest.approx(np.array(speeds), rel=1e-7)
    forces = [[3.176108e-7, 3.313306e-7], [2.633059e-7, 3.047051e-7]]
    assert at["mesh_force"].values == pytest.approx(np.array(forces), rel=1e-5, abs=0.0)
    assert run["hub_load"].sel(shaft="idler").values[-1] == pytest.approx(4.863789e-7, rel=1e-5, abs=0.0)


def test_its_work_adds_up(run):
    work = run.gearidae.work()
    assert work["share"].sum() == pytest.approx(1.0, abs=1e-12)
    assert abs(float(run["residual"])) < float(run["residual_bound"])
    passed = run["work_out"] / run["work_in"]
    np.testing.assert_allclose(run["mesh_efficiency"], passed)


def test_the_output_sticks_and_is_judged():
    """At 86.247604 us, held by its dry load, while the input rocks for a while."""
    start = {"gear_speed": 400.0, "gap": "36 nm", "mesh_phase": 0.3}
    scene = Scene.from_dict(chain(hubs=0.3, drive={"torque": 2e-12}, initial=start))
    ds = gd.simulate(scene)
    (verdict,) = ds.gearidae.verdicts().to_dict("records")
    assert verdict["verdict"] == "stops"
    assert verdict["stick_time"] == pytest.approx(86.247604e-6, abs=1e-11, rel=0.0)
    assert verdict["words"] == "came to rest at 86.2 us (0 mesh exits), held by dry load of output"
    assert ds["rest_time"].sel(shaft="input") < ds["rest_time"].sel(shaft="output")
    rocking = gd.simulate(scene.replace({"run.judged": "input"}))
    # it has turned back before, and rocks from then on: zeros are found between samples
    assert rocking.gearidae.verdicts().stick_time[0] == pytest.approx(86.082323e-6, abs=5e-9, rel=0.0)


def test_hubs_hold_a_chain_at_rest_and_more_torque_starts_it():
    rest = {"gear_speed": 0.0, "gap": "36 nm", "mesh_phase": 0.3}
    chained = Scene.from_dict(chain("0 deg", hubs=0.3, drive={"torque": 7.9e-12}, initial=rest))
    ds = gd.simulate(chained.replace({"run.duration": 1e-3}))
    (verdict,) = ds.gearidae.verdicts().to_dict("records")
    assert verdict["verdict"] == "sticks"
    assert verdict["advance"] == pytest.approx(0.0184, abs=5e-4)
    assert verdict["free_advance"] == pytest.approx(1.799573, abs=2e-3)
    assert ds.attrs["held_by"] == "hub friction of input, hub friction of idler, hub friction of output"
    more = gd.simulate(chained.replace({"run.duration": 1e-3, "drive.torque": 8.2e-12}))
    assert float(more["gear_speed"][-1]) == pytest.approx(119.6117, rel=1e-3)
    assert float(more["gear_angle"][-1]) * 76 / (2.0 * np.pi) == pytest.approx(0.857, abs=1e-3)


def test_an_archive_and_what_is_said_of_it(tmp_path, capfd):
    case = tmp_path / "train.toml"
    case.write_text(dump_case(Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "20 us"})))
    assert main(["run", str(case), "-o", str(tmp_path / "out.nc")]) == 0
    out = " ".join(capfd.readouterr().out.split())
    assert "Work of the drive" in out
    assert "hub of idler" in out
    assert main(["info", str(tmp_path / "out.nc")]) == 0
    assert "mesh second" in " ".join(capfd.readouterr().out.split())
    for command, name in (("plot", "out.png"), ("report", "out.html")):
        assert main([command, str(tmp_path / "out.nc"), "-o", str(tmp_path / name)]) == 0
    page = (tmp_path / "out.html").read_text(encoding="utf-8")
    assert "hub of idler" in page
    assert page.count("<figure") == 2  # of its work, and the gears
    assert gd.open(tmp_path / "out.nc").attrs["judged_shaft"] == "output"


def test_a_run_without_its_balance_has_no_works(tmp_path, capfd):
    scene = Scene.from_dict(chain()).replace(
        {"run.balance": False, "run.duration": "1 us", "run.samples": 11}
    )
    case = tmp_path / "train.toml"
    case.write_text(dump_case(scene))
    assert main(["run", str(case), "-o", str(tmp_path / "out.nc")]) == 0
    assert "nan" not in capfd.readouterr().out
    assert main(["plot", str(tmp_path / "out.nc"), "-o", str(tmp_path / "out.png")]) == 0
    with pytest.raises(gd.SceneError, match="has not followed its balance"):
        gd.plot.work(gd.open(tmp_path / "out.nc"))


def test_a_run_that_ends_by_its_turns_says_for_how_long_it_was():
    scene = Scene.from_dict(chain()).replace(
        {"run.stop": "turns 1e-4", "run.duration": "1 ms", "run.samples": "off"}
    )
    ds = gd.simulate(scene)
    assert ds.attrs["t_end"] == float(ds["reached"]) < 1e-6
    assert ds.gearidae.verdicts().words[0].endswith("in 0.671 us")
    assert gd.simulate(scene, start=ds).attrs["t_end"] < 2e-6


def test_a_refused_run_touches_no_archive(tmp_path, monkeypatch):
    """Whatever the engine refuses is an error of the scene, and no full disk."""

    def refuses(*_, **__):
        raise gd.SceneError("drive.law.name", "mine", "does not compile")

    monkeypatch.setattr("gearidae.engine.train.solve_train", refuses)
    with pytest.raises(gd.SceneError, match=r"^drive\.law\.name = mine"):
        gd.simulate(Scene.from_dict(chain()), archive=tmp_path / "out.nc")
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("out")]


def test_what_trains_do_not_have_is_refused():
    scene = Scene.from_dict(chain())
    with pytest.raises(gd.SceneError, match="needs the archive to go on from"):
        gd.simulate(scene, resume=True)
    with pytest.raises(gd.SceneError, match="must be a number or a rate"):
        gd.simulate(scene, samples="ringing")


def test_the_picture_of_its_work(run):
    ax = gd.plot.work(run)
    labels = [tick.get_text() for tick in ax.get_yticklabels()]
    assert labels == list(run.gearidae.work().index)
    widths = [bar.get_width() for bar in ax.patches]
    assert sum(widths) == pytest.approx(100.0)
