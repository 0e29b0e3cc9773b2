"""Sweeps over trains: members equal single runs, in threads and in processes, in memory and in files."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from tests.reference.trains import chain

import gearidae as gd
from gearidae.archive.train.variables import OF_JUDGED
from gearidae.cli import main
from gearidae.records.train_results import TrainSolution
from gearidae.runs import batch
from gearidae.runs.run_cache import RunCache
from gearidae.runs.run_result import solve_and_leave
from gearidae.scene import Scene, dump_case

COVERAGE, HUB = "meshes.second.coating.sam_fraction", "shafts.idler.hub_radius"
OVER = {COVERAGE: [1.0, 0.5], HUB: [3e-6, 5e-6]}


@pytest.fixture(scope="module")
def scene():
    return Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "60 us", "run.samples": 61})


@pytest.fixture(scope="module")
def swept(scene):
    return gd.sweep(scene, OVER, jobs=1, progress=False)


def same(run, single):
    xr.testing.assert_equal(run, single)
    changing = {"wall_time", "history", "date_created", "end_state", "end_sha256", "keep"}
    mine, its = ({k: v for k, v in ds.attrs.items() if k not in changing} for ds in (run, single))
    for name in mine.keys() & its.keys():
        assert mine[name] == its[name], name
    assert {"judged_shaft", "judged_mesh", "drive_shaft", "status", "scene", "steps"} <= mine.keys()


def test_each_member_is_the_run_of_its_scene(scene, swept):
    assert swept["shaft_speed"].dims == ("meshes_second_coating_sam_fraction", "hub_radius", "shaft", "time")
    for fraction in OVER[COVERAGE]:
        for radius in OVER[HUB]:
            run = swept.gearidae.run(meshes_second_coating_sam_fraction=fraction, hub_radius=radius)
            single = gd.simulate(scene.replace({COVERAGE: fraction, HUB: radius}), progress=False)
            same(run, single)
            assert run.gearidae.scene == single.gearidae.scene
            assert run.gearidae.verdicts().words[0] == single.gearidae.verdicts().words[0]
            xr.testing.assert_equal(run.gearidae.work().to_xarray(), single.gearidae.work().to_xarray())


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_jobs_and_files_give_the_same(scene, swept, tmp_path, backend):
    """Two threads of the compiled loop, two processes of the portable driver."""
    short = scene if backend == "native" else scene.replace({"run.duration": "5 us"})
    over = OVER if backend == "native" else {COVERAGE: [1.0, 0.5]}
    path = tmp_path / "sweep.nc"
    gd.sweep(short, over, jobs=2, backend=backend, progress=False, archive=path)
    read = gd.open_archive(path)
    whole = swept if backend == "native" else gd.sweep(short, over, jobs=1, backend=backend, progress=False)
    xr.testing.assert_equal(read.drop_vars("wall_time"), whole.drop_vars("wall_time"))
    assert read.attrs["swept"] == whole.attrs["swept"]
    assert [*read.gearidae.verdicts().words] == [*whole.gearidae.verdicts().words]


def test_zipped_keys_and_ratios_that_differ(scene):
    over = {"shafts.output.teeth": [76, 95], "shafts.output.inertia": [4.2e-18, 1e-17]}
    ds = gd.sweep(scene.replace({"run.duration": "5 us"}), over, zipped=True, jobs=1, progress=False)
    np.testing.assert_array_equal(ds["mesh_ratio"].sel(mesh="second"), [2.0, 2.5])
    assert ds["inertia"].dims == ("teeth",)
    run = ds.gearidae.run(inertia=1e-17)
    assert run["mesh_ratio"].dims == ("mesh",)
    assert run.gearidae.scene.shafts["output"].teeth == 95
    same(run, gd.simulate(run.gearidae.scene, progress=False))


def test_who_holds_is_kept_of_each_run(scene):
    rest = scene.replace({"initial.gear_speed": 0.0, "run.duration": "1 ms"})
    ds = gd.sweep(rest, {"drive.torque": [7e-12, 1.2e-11]}, jobs=1, progress=False)
    single = gd.simulate(rest.replace({"drive.torque": 7e-12}), progress=False)
    assert ds["held_by"].values.tolist() == [single.attrs["held_by"], ""]
    assert ds.gearidae.run(torque=7e-12).attrs["held_by"] == single.attrs["held_by"]
    assert ds.gearidae.verdicts().words[0] == single.gearidae.verdicts().words[0]


def test_a_sweep_that_was_cut_off_goes_on(scene, swept, tmp_path, monkeypatch):
    """The first run is kept, read back from the journal, and stands beside those that are computed later."""
    ran = []

    def one_alone(member_scene, backend, keep, on_progress=None):
        if ran:
            raise KeyboardInterrupt
        ran.append(member_scene)
        return solve_and_leave(member_scene, backend, keep, on_progress)

    path = tmp_path / "sweep.nc"
    with monkeypatch.context() as patched:
        patched.setattr(batch, "solve_and_leave", one_alone)
        with pytest.raises(gd.Interrupted, match="resume"):
            gd.sweep(scene, OVER, jobs=1, progress=False, archive=path, backend="native")
    read = gd.open_archive(path)
    assert read["status"].values.ravel().tolist() == ["finished", *["interrupted"] * 3]
    assert read.gearidae.verdicts().verdict.tolist() == ["turns smoothly", *["unfinished"] * 3]
    first = {"meshes_second_coating_sam_fraction": 1.0, "hub_radius": 3e-6}
    xr.testing.assert_equal(read.gearidae.run(**first), swept.gearidae.run(**first))
    assert np.isnan(read["shaft_speed"][1, 1]).all()
    read.close()
    with monkeypatch.context() as patched:
        patched.setattr(batch, "solve_and_leave", lambda s, *rest: ran.append(s) or solve_and_leave(s, *rest))
        whole = gd.sweep(scene, OVER, jobs=1, progress=False, archive=path, resume=True)
    assert len(ran) == 4
    xr.testing.assert_equal(whole.drop_vars("wall_time"), swept.drop_vars("wall_time"))


def test_parts_of_runs_are_those_of_whole_runs(scene, swept):
    asked = ["gear_speed", "mesh_exits", "adhesion_loss", "scene"]
    ds = gd.sweep(scene, OVER, jobs=1, progress=False, keep=asked)
    for name in asked[:3]:
        xr.testing.assert_equal(ds[name], swept[name])
    assert {"shaft_speed", "event_time", "hub_loss"}.isdisjoint(ds.variables)
    assert [*ds.gearidae.verdicts().words] == [*swept.gearidae.verdicts().words]
    with pytest.raises(gd.SceneError, match="keep = exposures: is nothing that a run of this scene leaves"):
        gd.sweep(scene, OVER, progress=False, keep=["exposures"])


@pytest.mark.parametrize("samples", ["off", 2, 61])
def test_no_verdict_depends_on_the_samples(scene, samples):
    rest = scene.replace({"initial.gear_speed": 0.0, "run.duration": "1 ms", "drive.torque": 7.9e-12})
    run, other = (gd.simulate(rest, samples=count, progress=False) for count in (samples, 501))
    assert run.gearidae.verdicts().words[0] == other.gearidae.verdicts().words[0]
    assert run.attrs["held_by"] == other.attrs["held_by"]
    for name in (*OF_JUDGED, "standstill_list"):
        np.testing.assert_array_equal(run[name], other[name])


def test_pictures_and_report_of_a_sweep(swept, tmp_path):
    for draw in (gd.plot.overview, gd.plot.gear_speed, gd.plot.outcome, gd.plot.orders):
        assert draw(swept) is not None
    page = gd.write_report(swept, tmp_path / "report.html").read_text()
    assert "turned smoothly" in page
    with pytest.raises(gd.SceneError, match="must be a single run of a train"):
        gd.plot.work(swept)


@pytest.mark.parametrize(
    ("over", "options", "message"),
    [
        ({COVERAGE: [1.0]}, {"resume": True}, "resume = True: needs an archive"),
        ({"run.judged": ["idler", "output"]}, {}, "over = run.judged: must leave the shafts"),
    ],
)
def test_what_trains_do_not_have_is_refused(scene, over, options, message):
    with pytest.raises(gd.SceneError, match=message):
        gd.sweep(scene, over, progress=False, **options)


def test_runs_of_trains_are_not_joined(scene, swept):
    run = swept.gearidae.run(meshes_second_coating_sam_fraction=1.0, hub_radius=3e-6)
    with pytest.raises(gd.SceneError, match="are of trains of several meshes"):
        gd.concat([run, run], COVERAGE)


def test_the_command_line_sweeps_a_train(scene, tmp_path, capfd):
    case, path = tmp_path / "train.toml", tmp_path / "out.nc"
    case.write_text(dump_case(scene.replace({"run.duration": "5 us"})))
    assert main(["sweep", str(case), "--over", f"{COVERAGE}=1,0.5", "-o", str(path)]) == 0
    assert "2 runs" in capfd.readouterr().out
    assert main(["info", str(path)]) == 0
    assert gd.open_archive(path).sizes["meshes_second_coating_sam_fraction"] == 2


@pytest.mark.parametrize("count", [0, 1, 5])
def test_a_run_is_kept_with_as_many_samples_as_it_has(scene, tmp_path, count):
    """Studies run trains without any."""
    rows = np.arange(6.0 * count).reshape(6, count)
    samples = {"shaft_speed": rows[:3], "mesh_force": rows[3:5], "drive_torque": rows[5]}
    none = TrainSolution.none(["a", "b", "c"], ["first", "second"], "finished", "")
    run = replace(none, time=np.arange(float(count)), samples=samples)
    with closing(RunCache(tmp_path / "a.nc", scene, "native")) as cache:
        cache.store(scene, run)
        taken = cache.take(scene)
    assert taken is not None
    assert list(taken[0].samples) == list(samples)
    np.testing.assert_array_equal(taken[0].time, run.time)
    for name, values in samples.items():
        np.testing.assert_array_equal(taken[0].samples[name], values)
